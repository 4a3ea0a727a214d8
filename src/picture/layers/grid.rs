use super::LayoutContext;
use super::labels::Label;
use crate::physics::{Axis, Rect, Vector, larger, smaller};
use crate::picture::Overlay;
use crate::picture::number::{Unit, multiples_within, nice_spacing, tick_label};
use crate::picture::text::Line;
use crate::picture::{Camera, Ink, Shape};

/// Draws grid lines every 1, 2 or 5 × 10ⁿ m, labelled with their coordinates unless axes are shown.
pub fn draw(context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let area = grid_area(&context.camera);
    let spacing = grid_spacing(context);
    for axis in Axis::BOTH {
        for at in multiples(&area, axis, spacing) {
            let extent = area.along(axis);
            // The border of the world is drawn by its walls.
            if extent[0] < at && at < extent[1] {
                shapes.push(grid_line(context, &area, axis, at));
            }
        }
    }
    labels(context).into_iter().for_each(|label| label.draw_bare(shapes));
}

/// The coordinates of the grid lines, without those that would cover another one.
pub fn labels(context: &LayoutContext) -> Vec<Label> {
    let style = &context.view.style;
    if !style.shows(Overlay::Grid) || style.shows(Overlay::Axes) {
        return Vec::new();
    }
    let (area, spacing) = (grid_area(&context.camera), grid_spacing(context));
    let mut labels: Vec<Label> = Vec::new();
    for axis in Axis::BOTH {
        let [low, _] = area.along(axis);
        for at in multiples(&area, axis, spacing).filter(|&at| at > low) {
            let label = label(context, &area, axis, at, spacing);
            let is_free = labels.iter().all(|other| other.bounds().inset(-1.0).intersection(&label.bounds()).is_none());
            if is_free && context.camera.viewport.contains(&label.bounds()) {
                labels.push(label);
            }
        }
    }
    labels
}

/// Distance between grid lines, m.
fn grid_spacing(context: &LayoutContext) -> f64 {
    nice_spacing(5.0 * context.metrics.font_size / context.camera.scale)
}

/// The area of the grid, m: the world if all of it is visible, otherwise the visible area.
fn grid_area(camera: &Camera) -> Rect {
    let (world, visible) = (Rect::new(Vector::ZERO, camera.world.x, camera.world.y), camera.visible_area());
    if visible.contains(&world) { world } else { visible }
}

/// The multiples of `spacing` along an axis within `area`, both ends included.
fn multiples(area: &Rect, axis: Axis, spacing: f64) -> impl Iterator<Item = f64> {
    multiples_within(area.along(axis), spacing, 1e-9).take(MAX_LINES)
}

/// Maximum number of grid lines per axis, so that no rounding error makes their number unbounded.
const MAX_LINES: usize = 501;

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
fn label(context: &LayoutContext, area: &Rect, axis: Axis, at: f64, spacing: f64) -> Label {
    let is_last = at + spacing > area.along(axis)[1] + 1e-9 * spacing;
    let line = coordinate(at, if is_last { WithUnit::Shown } else { WithUnit::Hidden }, context);
    let (near, point) = (context.camera.point(area.origin), context.camera.point(Vector::new(at, at)));
    let gap = 2.0 * context.metrics.line_width;
    let baseline = match axis {
        Axis::X => Vector::new(point.x - line.width - gap, near.y + line.height() + 1.5 * gap),
        Axis::Y => Vector::new(near.x + gap, point.y - gap),
    };
    Label { line, at: baseline, color: context.metrics.palette.muted }
}

/// Draws axes in metres, left of the viewport and below it.
pub fn draw_axes(context: &LayoutContext, shapes: &mut Vec<Shape>) {
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
    let (area, spacing) = (context.camera.visible_area(), grid_spacing(context));
    let tick_length = (0.3 * context.metrics.font_size).round();
    // A tick at the right edge of the viewport stays on the page.
    let greatest = f64::from(context.view.style.look.size[0]) - line;
    for at in multiples(&area, Axis::X, spacing) {
        let x = smaller(context.camera.point(Vector::new(at, 0.0)).x.round(), greatest);
        shapes.push(bar(x, far.y, line, tick_length));
    }
    for (line, x) in labels_below(context) {
        let y = (far.y + 1.15 * context.metrics.font_size).round();
        shapes.push(Shape::Text { line, at: Vector::new(x, y), ink });
    }
    for at in multiples(&area, Axis::Y, spacing) {
        let y = context.camera.point(Vector::new(0.0, at)).y.round();
        shapes.push(bar(viewport.origin.x - tick_length, y, tick_length, line));
    }
    for (line, y) in labels_left(context) {
        let x = (viewport.origin.x - 0.5 * context.metrics.font_size - line.width).round();
        if x >= 0.0 {
            shapes.push(Shape::Text { line, at: Vector::new(x, y), ink });
        }
    }
}

/// The labels of the ticks below the viewport that are on the page, with their left ends, px. The last one includes the
/// unit.
fn labels_below(context: &LayoutContext) -> Vec<(Line, f64)> {
    let area = context.camera.visible_area();
    let first = context.camera.viewport.origin.x - context.metrics.font_size;
    let end = f64::from(context.camera.size[0]);
    let labels = |with_unit: WithUnit| {
        multiples(&area, Axis::X, grid_spacing(context)).map(move |at| {
            let line = coordinate(at, with_unit, context);
            let x = smaller(context.camera.point(Vector::new(at, 0.0)).x.round(), end - context.metrics.line_width);
            let left = (x - line.width / 2.0).round();
            (line, left)
        })
    };
    let is_on_page = |(line, left): &(Line, f64)| *left >= first && *left + line.width <= end;
    let mut shown: Vec<(Line, f64)> = labels(WithUnit::Hidden).filter(is_on_page).collect();
    if let Some(last) = labels(WithUnit::Shown).filter(is_on_page).last() {
        // A label that fits only without the unit would stand behind it.
        shown.retain(|(line, left)| left + line.width / 2.0 < last.1 + last.0.width / 2.0 - 1.0);
        shown.push(last);
    }
    shown
}

/// The width that the labels of the ticks left of the viewport need, px.
pub fn axis_margin(context: &LayoutContext) -> f64 {
    let widest = labels_left(context).into_iter().map(|(line, _)| line.width).fold(0.0, larger);
    (widest + 0.7 * context.metrics.font_size).ceil()
}

/// The labels of the ticks left of the viewport that are on the page, with their baselines, px. The topmost one
/// includes the unit.
fn labels_left(context: &LayoutContext) -> Vec<(Line, f64)> {
    let area = context.camera.visible_area();
    let bottom = context.camera.viewport.far_corner().y;
    let labels = |with_unit: WithUnit| {
        multiples(&area, Axis::Y, grid_spacing(context)).map(move |at| {
            let line = coordinate(at, with_unit, context);
            let y = context.camera.point(Vector::new(0.0, at)).y.round();
            let baseline = (y + line.height() / 2.0).round();
            (line, baseline)
        })
    };
    let is_on_page = |(line, baseline): &(Line, f64)| *baseline >= line.height() && *baseline <= bottom;
    let topmost = labels(WithUnit::Shown).find(is_on_page);
    let others = labels(WithUnit::Hidden).filter(is_on_page).skip(1);
    topmost.into_iter().chain(others).collect()
}

/// The unit after a coordinate.
#[derive(Clone, Copy, PartialEq, Eq)]
enum WithUnit {
    Shown,
    Hidden,
}

/// A coordinate in a unit that suits the visible area, m.
fn coordinate(at: f64, with_unit: WithUnit, context: &LayoutContext) -> Line {
    let area = context.camera.visible_area();
    let ends = [area.origin, area.far_corner()].map(|corner| larger(corner.x.abs(), corner.y.abs()));
    let unit = Unit::METRE.for_size(larger(ends[0], ends[1]));
    let number = tick_label(unit.scaled(at), unit.scaled(grid_spacing(context)));
    let suffix = if with_unit == WithUnit::Shown { format!(" {unit}") } else { String::new() };
    Line::plain(&context.metrics.language.decimal(format!("{number}{suffix}")), context.metrics.text(0.7))
}
