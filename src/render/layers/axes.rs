use super::super::text::Line;
use super::super::{Ink, Shape};
use super::LayoutContext;
use super::grid::{grid_spacing, multiples_within, tick_label};
use crate::physics::{Axis, Rect, Vector};
use crate::scene::Overlay;

/// Axes in metres, left of the viewport and below it.
pub fn draw(context: &LayoutContext, shapes: &mut Vec<Shape>) {
    if !context.view.style.shows(Overlay::Axes) {
        return;
    }
    let (viewport, line) = (context.camera.viewport, context.metrics.line_width);
    let far = viewport.far_corner();
    let ink = Ink::from(context.metrics.palette.muted);
    let bar = |x: f64, y: f64, width: f64, height: f64| Shape::Rect {
        rect: Rect::new(Vector::new(x, y), width, height),
        ink,
    };
    shapes.push(bar(viewport.origin.x - line, viewport.origin.y, line, viewport.height() + line));
    shapes.push(bar(viewport.origin.x, far.y, viewport.width(), line));
    let tick_length = (0.3 * context.metrics.font_size).round();
    for at in ticks(context, Axis::X) {
        let x = context.camera.point(Vector::new(at, 0.0)).x.round();
        shapes.push(bar(x, far.y, line, tick_length));
        label_below(at, x, context, shapes);
    }
    for at in ticks(context, Axis::Y) {
        let y = context.camera.point(Vector::new(0.0, at)).y.round();
        shapes.push(bar(viewport.origin.x - tick_length, y, tick_length, line));
        label_left(at, y, context, shapes);
    }
}

fn ticks(context: &LayoutContext, axis: Axis) -> Vec<f64> {
    multiples_within(&context.camera.visible_area(), axis, grid_spacing(context))
}

/// The label of a tick below the viewport. The last tick label includes the unit.
fn label_below(at: f64, x: f64, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let far = context.camera.viewport.far_corner();
    let is_last = x + grid_spacing(context) * context.camera.scale > far.x;
    let line = unit_label(at, if is_last { " m" } else { "" }, context);
    let baseline = Vector::new((x - line.width / 2.0).round(), (far.y + 1.15 * context.metrics.font_size).round());
    if baseline.x >= context.camera.viewport.origin.x - context.metrics.font_size
        && baseline.x + line.width <= f64::from(context.camera.size[0])
    {
        shapes.push(Shape::Text { line, at: baseline, ink: Ink::from(context.metrics.palette.muted) });
    }
}

/// The label of a tick left of the viewport. The topmost one includes the unit.
fn label_left(at: f64, y: f64, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let viewport = context.camera.viewport;
    let is_topmost = y - grid_spacing(context) * context.camera.scale < viewport.origin.y;
    let line = unit_label(at, if is_topmost { " m" } else { "" }, context);
    let baseline = Vector::new(
        (viewport.origin.x - 0.5 * context.metrics.font_size - line.width).round(),
        (y + line.height() / 2.0).round(),
    );
    if baseline.y - line.height() >= 0.0 && baseline.y <= viewport.far_corner().y && baseline.x >= 0.0 {
        shapes.push(Shape::Text { line, at: baseline, ink: Ink::from(context.metrics.palette.muted) });
    }
}

fn unit_label(at: f64, unit: &str, context: &LayoutContext) -> Line {
    Line::plain(
        &format!("{}{unit}", tick_label(at, grid_spacing(context))).replace('-', "−"),
        0.7 * context.metrics.font_size,
    )
}
