//! What a frame is made of, layer by layer, from the back to the front.

pub mod bodies;
pub mod contacts;
mod footer;
pub mod grid;
mod names;
mod trails;
mod velocities;
mod walls;

use super::{DisplayList, Frame, Look, Shape, View};
use crate::scene::Overlay;

/// The shapes that show `frame`.
pub fn compose(frame: &Frame, view: &View) -> DisplayList {
    let page = Page::new(view);
    let mut shapes = vec![world(frame, &page)];
    footer::draw(frame, &page, &mut shapes);
    DisplayList {
        size: view.camera.size,
        background: page.look.palette.background,
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

/// A picture being made: what is seen in it, and how it looks.
pub struct Page<'a> {
    /// What is seen.
    pub view: &'a View,
    /// Colours and sizes.
    pub look: Look,
}

impl Page<'_> {
    /// A picture with lines and text that suit its size.
    pub fn new(view: &View) -> Page<'_> {
        Page { view, look: Look::new(view.style.theme, view.camera.size) }
    }
}
