//! Marks of a diagram over time that belong to no curve.

use super::axes::Axes;
use super::panels::{Panels, dashed};
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::layers::footer::{Entry, gap_entries, quoted};
use crate::picture::trace::TraceGap;
use crate::picture::{DrawingMetrics, Ink, Language, Shape};

/// The instants of a run at which its curves jump or are interrupted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// The times of spawns and deletes, s, in ascending order.
    pub changes: Vec<f64>,
    /// The parts that the recording lacks.
    pub gaps: Vec<TraceGap>,
}

/// Marks spawns and deletes by dashed lines, and gaps by shaded and hatched areas.
pub fn draw_timeline(timeline: &Timeline, axes: &Axes, panels: &mut Panels) {
    let (area, metrics) = (axes.plot_area, panels.metrics);
    let x = |time: f64| axes.point(time, 0.0).x;
    let mut shapes = Vec::new();
    for &time in &timeline.changes {
        let (top, bottom) = (area.origin.y, area.far_corner().y);
        let at = |y: f64| Vector::new(x(time).round(), y);
        let ink = metrics.palette.muted.into();
        shapes.extend(dashed(at(top), at(bottom), 2.0 * metrics.line_width, metrics.line_width / 2.0, ink));
    }
    for gap in &timeline.gaps {
        let [from, to] = gap.times.map(x);
        // A gap of few steps is still visible.
        let width = larger(to - from, 2.0 * metrics.line_width);
        let gap_area = Rect::new(Vector::new(from, area.origin.y), width, area.height());
        shapes.extend(missing_area(&gap_area, 6.0 * metrics.line_width, &metrics));
    }
    panels.shapes.push(Shape::Clip { window: area, shapes });
}

/// A shaded area with diagonal lines at a distance of `gap` px: a part that a recording lacks.
pub fn missing_area(area: &Rect, gap: f64, metrics: &DrawingMetrics) -> Vec<Shape> {
    let shade = Ink { color: metrics.palette.muted, opacity: 60 };
    let mut shapes = vec![Shape::Rect { rect: *area, ink: shade }];
    shapes.extend(hatched(area, gap, metrics));
    shapes
}

/// Diagonal lines at a distance of `gap` px over an area that a recording lacks.
pub fn hatched(area: &Rect, gap: f64, metrics: &DrawingMetrics) -> Vec<Shape> {
    let (near, far) = (area.origin, area.far_corner());
    let ink = Ink { color: metrics.palette.muted, opacity: 160 };
    let count = ((area.width() + area.height()) / gap).clamp(0.0, 10_000.0) as u32;
    let line = |number: u32| {
        // The line along which x − near.x + y − near.y is constant.
        let sum = f64::from(number + 1) * gap;
        let left = larger(sum - area.height(), 0.0);
        let right = smaller(sum, area.width());
        let at = |across: f64| Vector::new(near.x + across, near.y + sum - across);
        debug_assert!(right <= far.x - near.x + 1e-9);
        Shape::Polyline { points: vec![at(left), at(right)], width: metrics.line_width / 2.0, ink }
    };
    (0..count).map(line).collect()
}

/// The legend entries of the marks of all runs of a figure.
pub fn timeline_legend<'a>(
    timelines: impl Iterator<Item = &'a Timeline> + Clone,
    language: Language,
    metrics: &DrawingMetrics,
) -> Vec<Entry> {
    let mut entries = Vec::new();
    let color = metrics.palette.muted;
    if timelines.clone().any(|timeline| !timeline.changes.is_empty()) {
        entries.push(Entry {
            name: quoted(language.of("¦ spawn or delete", "¦ création ou suppression")),
            colors: Vec::new(),
            ..Entry::new(color, "")
        });
    }
    entries.extend(gap_entries(timelines.flat_map(|timeline| &timeline.gaps), language, color));
    entries
}
