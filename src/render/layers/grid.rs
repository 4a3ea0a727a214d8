use super::super::text::Line;
use super::super::{Camera, Ink, Shape};
use super::LayoutContext;
use crate::physics::{Axis, Rect, Vector};
use crate::render::area::contains;
use crate::scene::Overlay;

/// Draws grid lines every 1, 2 or 5 × 10ⁿ m, labelled with their coordinates unless axes are shown.
pub fn draw(context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let area = grid_area(&context.camera);
    let spacing = grid_spacing(context);
    for axis in Axis::BOTH {
        for at in multiples_within(&area, axis, spacing) {
            let extent = extent_along(&area, axis);
            // The border of the world is drawn by its walls.
            if extent[0] < at && at < extent[1] {
                shapes.push(grid_line(context, &area, axis, at));
            }
            if !context.view.style.shows(Overlay::Axes) && at > extent[0] {
                shapes.push(label(context, &area, axis, at, spacing));
            }
        }
    }
}

/// Distance between grid lines, m.
pub fn grid_spacing(context: &LayoutContext) -> f64 {
    nice_spacing(5.0 * context.metrics.font_size / context.camera.scale)
}

/// The area of the grid, m: the world if all of it is visible, otherwise the visible area.
fn grid_area(camera: &Camera) -> Rect {
    let (world, visible) = (Rect::new(Vector::ZERO, camera.world.x, camera.world.y), camera.visible_area());
    if contains(&visible, &world) { world } else { visible }
}

/// Start and end of a rectangle along an axis.
fn extent_along(area: &Rect, axis: Axis) -> [f64; 2] {
    let far = area.far_corner();
    [[area.origin.x, far.x], [area.origin.y, far.y]][axis]
}

/// Maximum number of grid lines per axis, so that no rounding error makes their number unbounded.
const MAX_LINES: u64 = 500;

/// The multiples of `spacing` along an axis within `area`, both ends included.
pub fn multiples_within(area: &Rect, axis: Axis, spacing: f64) -> Vec<f64> {
    let [from, to] = extent_along(area, axis);
    let (first, last) = ((from / spacing - 1e-9).ceil(), (to / spacing + 1e-9).floor());
    let count = if last >= first { (last - first) as u64 } else { return Vec::new() };
    (0..=count.min(MAX_LINES)).map(|index| (first + index as f64) * spacing + 0.0).collect()
}

/// The smallest number of the form 1, 2 or 5 × 10ⁿ that is at least `min`.
///
/// Found by multiplying and dividing by 10, because the logarithms of the standard library differ between platforms.
pub fn nice_spacing(min: f64) -> f64 {
    let mut power = 1.0;
    while power < min {
        power *= 10.0;
    }
    while power / 10.0 >= min && power > f64::MIN_POSITIVE {
        power /= 10.0;
    }
    [power / 5.0, power / 2.0].into_iter().find(|&candidate| candidate >= min).unwrap_or(power)
}

/// The grid line at coordinate `at` (m) of an axis, across the area.
fn grid_line(context: &LayoutContext, area: &Rect, axis: Axis, at: f64) -> Shape {
    let width = if context.metrics.line_width < 2.0 { 1.0 } else { (context.metrics.line_width / 2.0).round() };
    let (near, far) = (context.camera.point(area.origin), context.camera.point(area.far_corner()));
    let point = context.camera.point(Vector::new(at, at));
    let rect = match axis {
        Axis::X => Rect::new(Vector::new(point.x.round(), near.y), width, far.y - near.y),
        Axis::Y => Rect::new(Vector::new(near.x, point.y.round()), far.x - near.x, width),
    };
    Shape::Rect { rect, ink: Ink::from(context.metrics.palette.grid) }
}

/// The label of a grid line, inside the area at its upper or left border. The last label includes the unit.
fn label(context: &LayoutContext, area: &Rect, axis: Axis, at: f64, spacing: f64) -> Shape {
    let unit = if at + spacing > extent_along(area, axis)[1] + 1e-9 * spacing { " m" } else { "" };
    let line = Line::plain(&format!("{}{unit}", tick_label(at, spacing)), 0.7 * context.metrics.font_size);
    let (near, point) = (context.camera.point(area.origin), context.camera.point(Vector::new(at, at)));
    let gap = 2.0 * context.metrics.line_width;
    let baseline = match axis {
        Axis::X => Vector::new(point.x - line.width - gap, near.y + line.height() + 1.5 * gap),
        Axis::Y => Vector::new(near.x + gap, point.y - gap),
    };
    Shape::Text { line, at: baseline, ink: Ink::from(context.metrics.palette.muted) }
}

/// Formats a multiple of `spacing` with as many decimals as the spacing has, at most 12.
pub fn tick_label(value: f64, spacing: f64) -> String {
    let mut decimals = 0;
    let mut unit = 1.0;
    while spacing < unit * (1.0 - 1e-9) && decimals < 12 {
        unit /= 10.0;
        decimals += 1;
    }
    format!("{value:.decimals$}")
}
