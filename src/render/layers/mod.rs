//! What a frame is made of, layer by layer, from the back to the front.

mod arrow;
mod bodies;
mod contacts;
mod footer;
mod grid;
mod names;
mod trails;
mod velocities;
mod walls;

use super::area::{larger, smaller};
use super::palette::Palette;
use super::{DisplayList, Frame, Shape, View};
use crate::scene::Overlay;

/// The shapes that show `frame`.
pub fn compose(frame: &Frame, view: &View) -> DisplayList {
    let page = Page::new(view);
    let mut shapes = vec![world(frame, &page)];
    footer::draw(frame, &page, &mut shapes);
    DisplayList {
        size: view.camera.size,
        background: page.palette.background,
        backdrop: vec![backdrop(frame, &page)],
        shapes,
    }
}

/// What does not move, seen through the page's window.
pub fn backdrop(frame: &Frame, page: &Page) -> Shape {
    let mut shapes = Vec::new();
    walls::draw(frame, page, &mut shapes);
    if page.view.style.shows(Overlay::Grid) {
        grid::draw(page, &mut shapes);
    }
    Shape::Clip { window: page.view.camera.window, shapes }
}

/// What moves, seen through the page's window.
pub fn world(frame: &Frame, page: &Page) -> Shape {
    let mut shapes = Vec::with_capacity(8 * frame.sprites.len());
    for layer in LAYERS {
        layer(frame, page, &mut shapes);
    }
    Shape::Clip { window: page.view.camera.window, shapes }
}

/// What adds its shapes to those beneath.
type Layer = fn(&Frame, &Page, &mut Vec<Shape>);

const LAYERS: [Layer; 5] = [trails::draw, bodies::draw, velocities::draw, contacts::draw, names::draw];

/// What every layer needs to know of the picture.
pub struct Page<'a> {
    /// What is seen, and how.
    pub view: &'a View,
    /// The colours of its theme.
    pub palette: Palette,
    /// Height of an em of text, px.
    pub text: f64,
    /// Width of a line, px; a whole number.
    pub line: f64,
}

impl Page<'_> {
    /// A picture with lines and text that suit its size.
    pub fn new(view: &View) -> Page<'_> {
        let [width, height] = view.camera.size.map(f64::from);
        let unit = smaller(width, height) / 720.0;
        Page {
            view,
            palette: Palette::of(view.style.theme),
            text: if unit < 0.6 { 12.0 } else { (21.0 * unit).round() },
            line: larger((2.0 * unit).round(), 1.0),
        }
    }
}
