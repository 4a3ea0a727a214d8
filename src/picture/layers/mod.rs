//! The layers of a frame, from back to front.

pub mod arrows;
pub mod bodies;
pub mod body_labels;
mod center_of_mass;
pub mod contacts;
pub mod dashes;
pub mod footer;
mod frame;
pub mod grid;
pub(crate) mod labels;
pub(crate) mod lanes;

pub use arrows::{Arrow, ArrowLength};
pub(super) use frame::force;
pub use frame::{Appearance, Frame, Sprite, Trails};

use crate::physics::{Rect, Vector, larger};
use crate::picture::Overlay;
use crate::picture::{Camera, DisplayList, DrawingMetrics, Shape, View};
use arrows::LabeledArrow;

/// Lays out `frame` as a display list.
pub fn compose(frame: &Frame, view: &View) -> DisplayList {
    let context = LayoutContext::new(view, view.camera_for(frame));
    let mut shapes = vec![foreground(frame, &context)];
    grid::draw_axes(&context, &mut shapes);
    footer::Footer::new(&view.style, &context.metrics).draw(frame, &context, &mut shapes);
    DisplayList {
        size: view.camera.size,
        background: context.metrics.palette.background,
        backdrop: vec![backdrop(frame, &context)],
        shapes,
    }
    .within_reach()
}

/// The layers that do not move, clipped to the viewport: walls and grid.
pub fn backdrop(frame: &Frame, context: &LayoutContext) -> Shape {
    let mut shapes = Vec::new();
    bodies::draw_walls(frame, context, &mut shapes);
    if context.view.style.shows(Overlay::Grid) {
        grid::draw(context, &mut shapes);
    }
    Shape::Clip { window: context.camera.viewport, shapes }
}

/// The layers that move, clipped to the viewport: trails, boxes, arrows, the centre of mass and labels.
pub fn foreground(frame: &Frame, context: &LayoutContext) -> Shape {
    let mut shapes = Vec::with_capacity(8 * frame.sprites.len());
    bodies::draw_trails(frame, context, &mut shapes);
    bodies::draw(frame, context, &mut shapes);
    contacts::draw_overlaps(frame, context, &mut shapes);
    let arrows = arrows(frame, context);
    arrows.iter().for_each(|arrow| arrow.arrow.draw(&context.metrics, &mut shapes));
    center_of_mass::draw(frame, context, &mut shapes);
    body_labels::draw(frame, context, &arrows, &mut shapes);
    Shape::Clip { window: context.camera.viewport, shapes }
}

/// All arrows, in drawing order.
fn arrows(frame: &Frame, context: &LayoutContext) -> Vec<LabeledArrow> {
    let mut all = arrows::of_bodies(frame, context);
    all.extend(contacts::arrows(frame, context));
    lanes::separate(&mut all, &context.view.style.lanes);
    all
}

/// The context shared by the layers of a frame.
pub struct LayoutContext<'a> {
    /// The view, whose style selects the overlays.
    pub view: &'a View,
    /// The camera of this frame.
    pub camera: Camera,
    /// Colours, font size and line width.
    pub metrics: DrawingMetrics,
}

impl LayoutContext<'_> {
    /// Creates a context with the metrics of the view's theme and size.
    pub fn new(view: &View, camera: Camera) -> LayoutContext<'_> {
        LayoutContext {
            view,
            camera,
            metrics: DrawingMetrics::new(view.style.look.theme, view.style.look.language, view.camera.size),
        }
    }

    /// The page rectangle of a body, px, if it intersects the viewport. A body that is tiny on the page is enlarged
    /// around its middle, so that it does not vanish.
    pub fn visible_rect(&self, sprite: &Sprite) -> Option<Rect> {
        let exact = self.camera.rect(&sprite.rect);
        let is_tiny = exact.width() < bodies::MIN_SIZE && exact.height() < bodies::MIN_SIZE;
        let min = if is_tiny { bodies::MIN_SIZE } else { 1.0 };
        let (width, height) = (larger(exact.width(), min), larger(exact.height(), min));
        let is_exact = (width, height) == (exact.width(), exact.height());
        let near = exact.center().sub(Vector::new(width / 2.0, height / 2.0));
        let rect = if is_exact { exact } else { Rect::new(near, width, height) };
        rect.intersection(&self.camera.viewport).map(|_| rect)
    }
}
