//! What a frame is made of, layer by layer, from the back to the front.

mod axes;
pub mod bodies;
pub mod contacts;
mod footer;
mod forces;
pub mod grid;
pub mod legend;
mod named_arrow;
mod names;
mod trails;
mod velocities;
mod walls;

use super::{Camera, DisplayList, Frame, Look, Shape, View};
use crate::scene::Overlay;
use named_arrow::NamedArrow;

/// The shapes that show `frame`.
pub fn compose(frame: &Frame, view: &View) -> DisplayList {
    let page = Page::new(view, view.camera_at(frame));
    let mut shapes = vec![world(frame, &page)];
    axes::draw(&page, &mut shapes);
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
    Shape::Clip { window: page.camera.window, shapes }
}

/// What moves, seen through the page's window.
pub fn world(frame: &Frame, page: &Page) -> Shape {
    let mut shapes = Vec::with_capacity(8 * frame.sprites.len());
    trails::draw(frame, page, &mut shapes);
    bodies::draw(frame, page, &mut shapes);
    contacts::draw_overlaps(frame, page, &mut shapes);
    let arrows = arrows(frame, page);
    arrows.iter().for_each(|arrow| arrow.arrow.draw(&page.look, &mut shapes));
    names::draw(frame, page, &arrows, &mut shapes);
    Shape::Clip { window: page.camera.window, shapes }
}

/// Every arrow, later ones over earlier ones.
fn arrows(frame: &Frame, page: &Page) -> Vec<NamedArrow> {
    let mut arrows = velocities::arrows(frame, page);
    arrows.extend(forces::arrows(frame, page));
    arrows.extend(contacts::arrows(frame, page));
    arrows
}

/// A picture being made: what is seen in it, and how it looks.
pub struct Page<'a> {
    /// What is seen.
    pub view: &'a View,
    /// Where it is seen from.
    pub camera: Camera,
    /// Colours and sizes.
    pub look: Look,
}

impl Page<'_> {
    /// A picture with lines and text that suit its size.
    pub fn new(view: &View, camera: Camera) -> Page<'_> {
        Page { view, camera, look: Look::new(view.style.theme, view.camera.size) }
    }
}
