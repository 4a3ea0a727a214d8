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

use super::palette::Palette;
use super::{DisplayList, Frame, Shape, View};
use crate::scene::Overlay;

/// The shapes that show `frame`.
pub fn compose(frame: &Frame, view: &View) -> DisplayList {
    let page = Page::new(view);
    let mut shapes = Vec::with_capacity(8 * frame.sprites.len());
    for layer in LAYERS {
        layer(frame, &page, &mut shapes);
    }
    DisplayList {
        size: view.camera.size,
        background: page.palette.background,
        backdrop: backdrop(frame, &page),
        shapes,
    }
}

/// What adds its shapes to those beneath.
type Layer = fn(&Frame, &Page, &mut Vec<Shape>);

const LAYERS: [Layer; 6] = [trails::draw, bodies::draw, velocities::draw, contacts::draw, names::draw, footer::draw];

fn backdrop(frame: &Frame, page: &Page) -> Vec<Shape> {
    let mut shapes = Vec::new();
    walls::draw(frame, page, &mut shapes);
    if page.view.style.shows(Overlay::Grid) {
        grid::draw(page, &mut shapes);
    }
    shapes
}

/// What every layer needs to know of the picture.
struct Page<'a> {
    view: &'a View,
    palette: Palette,
    /// Height of an em of text, px.
    text: f64,
    /// Width of a line, px; a whole number.
    line: f64,
}

impl Page<'_> {
    fn new(view: &View) -> Page<'_> {
        let [width, height] = view.camera.size.map(f64::from);
        let unit = (if width < height { width } else { height }) / 720.0;
        let line = (2.0 * unit).round();
        Page {
            view,
            palette: Palette::of(view.style.theme),
            text: if unit < 0.6 { 12.0 } else { (21.0 * unit).round() },
            line: if line < 1.0 { 1.0 } else { line },
        }
    }
}
