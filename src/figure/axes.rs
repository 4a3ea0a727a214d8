use super::panels::outline;
use crate::physics::{Rect, Vector};
use crate::render::area::{larger, smaller};
use crate::render::layers::grid::{nice_spacing, tick_label};
use crate::render::text::Line;
use crate::render::{Metrics, Shape};

/// The axes of a diagram with linear scales.
pub struct Axes {
    /// The plot area inside the frame, px.
    pub plot_area: Rect,
    /// The values at its left and right border.
    pub x: Range,
    /// The values at its lower and upper border.
    pub y: Range,
}

/// A range of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Value at the left or lower border.
    pub from: f64,
    /// Value at the right or upper border.
    pub to: f64,
}

impl Range {
    /// The range of the finite values, or `None` without any. A range too narrow to divide by is widened.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Range> {
        let mut finite = values.filter(|value| value.is_finite());
        let first = finite.next()?;
        let range = finite.fold(Range { from: first, to: first }, Range::including);
        let size = larger(range.from.abs(), range.to.abs());
        let min_length = if size > 0.0 { size * 1e-12 } else { 1.0 };
        if range.to - range.from >= min_length {
            return Some(range);
        }
        Some(Range { from: range.from - min_length / 2.0, to: range.to + min_length / 2.0 })
    }

    /// The range extended at both ends by a fraction of its length.
    pub fn widened(self, fraction: f64) -> Range {
        let margin = fraction * (self.to - self.from);
        Range { from: self.from - margin, to: self.to + margin }
    }

    /// The range extended to include a value.
    pub fn including(self, value: f64) -> Range {
        Range { from: smaller(value, self.from), to: larger(value, self.to) }
    }

    /// The position of a value between the ends, 0 to 1.
    fn fraction(self, value: f64) -> f64 {
        (value - self.from) / (self.to - self.from)
    }
}

/// The titles of the two axes, as markup.
pub struct AxisTitles<'a> {
    /// Title of the horizontal axis, below the diagram.
    pub x: &'a str,
    /// Title of the vertical axis, above the left border.
    pub y: &'a str,
}

impl Axes {
    /// Creates axes in `panel`, which also contains tick labels and titles, with `right` px left free on the right.
    pub fn within(panel: &Rect, x: Range, y: Range, right: f64, metrics: &Metrics) -> Axes {
        let (below, above) = (2.4 * metrics.font_size, 1.5 * metrics.font_size);
        let widths = y_ticks(y, panel.height() - above - below, metrics).map(|tick| tick.line(metrics).width);
        let left = (widths.fold(2.0 * metrics.font_size, larger) + 0.8 * metrics.font_size).ceil();
        let origin = panel.origin.add(Vector::new(left, above));
        let (width, height) = (panel.width() - left - right - 0.5 * metrics.font_size, panel.height() - above - below);
        let round_to_pixels = |rect: Rect| {
            let (near, far) = (rect.origin, rect.far_corner());
            let near = Vector::new(near.x.round(), near.y.round());
            Rect::new(near, far.x.round() - near.x, far.y.round() - near.y)
        };
        Axes { plot_area: round_to_pixels(Rect::new(origin, width, height)), x, y }
    }

    /// The page position of a point, px.
    pub fn point(&self, x: f64, y: f64) -> Vector {
        let across = self.x.fraction(x) * self.plot_area.width();
        let up = self.y.fraction(y) * self.plot_area.height();
        Vector::new(self.plot_area.origin.x + across, self.plot_area.far_corner().y - up)
    }

    /// Draws grid lines, tick labels, titles and the frame.
    pub fn draw(&self, titles: &AxisTitles, metrics: &Metrics, shapes: &mut Vec<Shape>) {
        let thin = if metrics.line_width < 2.0 { 1.0 } else { (metrics.line_width / 2.0).round() };
        for x in ticks(self.x, self.plot_area.width() / (5.0 * metrics.font_size)) {
            let at = self.point(x.value, self.y.from).x.round();
            shapes.push(grid_line(at, self.plot_area.origin.y, thin, self.plot_area.height(), metrics));
            let line = x.line(metrics);
            let baseline = Vector::new(at - line.width / 2.0, self.plot_area.far_corner().y + 1.1 * metrics.font_size);
            shapes.push(Shape::Text { line, at: baseline, ink: metrics.palette.muted.into() });
        }
        for y in y_ticks(self.y, self.plot_area.height(), metrics) {
            let at = self.point(self.x.from, y.value).y.round();
            shapes.push(grid_line(self.plot_area.origin.x, at, self.plot_area.width(), thin, metrics));
            let line = y.line(metrics);
            let baseline =
                Vector::new(self.plot_area.origin.x - line.width - 0.5 * metrics.font_size, at + line.height() / 2.0);
            shapes.push(Shape::Text { line, at: baseline, ink: metrics.palette.muted.into() });
        }
        shapes.extend(outline(&self.plot_area, thin, metrics.palette.wall_edge.into()));
        self.draw_titles(titles, metrics, shapes);
    }

    fn draw_titles(&self, titles: &AxisTitles, metrics: &Metrics, shapes: &mut Vec<Shape>) {
        let x = Line::math(titles.x, 0.9 * metrics.font_size);
        let far = self.plot_area.far_corner();
        let below = Vector::new((far.x - x.width).round(), (far.y + 2.2 * metrics.font_size).round());
        shapes.push(Shape::Text { line: x, at: below, ink: metrics.palette.ink.into() });
        let y = Line::math(titles.y, 0.9 * metrics.font_size);
        let above = Vector::new(self.plot_area.origin.x, (self.plot_area.origin.y - 0.5 * metrics.font_size).round());
        shapes.push(Shape::Text { line: y, at: above, ink: metrics.palette.ink.into() });
    }

    /// A curve through points, clipped to the plot area. Points closer than half a pixel to the one before are dropped.
    pub fn curve(&self, points: impl Iterator<Item = [f64; 2]>, width: f64, ink: crate::render::Ink) -> Shape {
        let mut vertices: Vec<Vector> = Vec::new();
        for [x, y] in points {
            let at = self.point(x, y);
            let is_distinct = vertices.last().is_none_or(|last| at.sub(*last).norm() >= 0.5);
            if is_distinct && at.is_finite() {
                vertices.push(at);
            }
        }
        Shape::Clip { window: self.plot_area, shapes: vec![Shape::Polyline { points: vertices, width, ink }] }
    }
}

struct Tick {
    value: f64,
    label: String,
}

impl Tick {
    fn line(&self, metrics: &Metrics) -> Line {
        Line::math(&self.label, 0.8 * metrics.font_size)
    }
}

/// The ticks of a vertical axis of `height` px.
fn y_ticks(range: Range, height: f64, metrics: &Metrics) -> impl Iterator<Item = Tick> {
    ticks(range, height / (2.0 * metrics.font_size)).into_iter()
}

/// Ticks at multiples of 1, 2 or 5 × 10ⁿ within a range, approximately `max_count` at most.
fn ticks(range: Range, max_count: f64) -> Vec<Tick> {
    let max_count = if max_count < 2.0 { 2.0 } else { max_count };
    let (low, high) = (smaller(range.from, range.to), larger(range.from, range.to));
    let spacing = nice_spacing((high - low) / max_count);
    let first = (low / spacing).ceil();
    let count = ((high / spacing).floor() - first) as i64 + 1;
    let power = PowerOfTen::of(larger(low.abs(), high.abs()), spacing);
    let tick = |index: i64| {
        let value = (first + index as f64) * spacing;
        Tick { value, label: power.label(value, spacing) }
    };
    (0..count.clamp(0, 100)).map(tick).collect()
}

/// The common power of ten of the tick labels of an axis.
struct PowerOfTen {
    value: f64,
    exponent: i32,
}

impl PowerOfTen {
    /// Selects the power of ten of the largest value, or 1 if the labels are short enough without it.
    fn of(largest: f64, spacing: f64) -> PowerOfTen {
        let mut power = PowerOfTen { value: 1.0, exponent: 0 };
        if (1e-4..1e5).contains(&spacing) && largest < 1e9 && !(largest >= 1e6 && spacing >= 1e4) {
            return power;
        }
        while power.value * 10.0 <= largest * (1.0 + 1e-9) && power.exponent < 300 {
            power = PowerOfTen { value: power.value * 10.0, exponent: power.exponent + 1 };
        }
        while power.value > largest * (1.0 + 1e-9) && power.exponent > -300 {
            power = PowerOfTen { value: power.value / 10.0, exponent: power.exponent - 1 };
        }
        power
    }

    fn label(&self, value: f64, spacing: f64) -> String {
        let plain = tick_label(value / self.value + 0.0, spacing / self.value);
        match self.exponent {
            0 => plain,
            _ if value == 0.0 => "0".to_owned(),
            exponent => format!("{plain}·10^{{{exponent}}}"),
        }
    }
}

fn grid_line(x: f64, y: f64, width: f64, height: f64, metrics: &Metrics) -> Shape {
    Shape::Rect { rect: Rect::new(Vector::new(x, y), width, height), ink: metrics.palette.grid.into() }
}
