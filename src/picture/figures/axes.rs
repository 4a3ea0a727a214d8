//! The axes of diagrams.

use super::diagram::dot;
use super::panels::outline;
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::layers::dashes::DashPattern;
use crate::picture::number::{ScaledUnit, Unit, log10, multiples_within, nice_spacing, tick_label};
use crate::picture::text::Line;
use crate::picture::{DrawingMetrics, Ink, Shape};

/// The axes of a diagram.
pub struct Axes {
    /// The plot area inside the frame, px.
    pub plot_area: Rect,
    /// The area of the plot, its labels and titles, px.
    panel: Rect,
    /// The horizontal scale, from left to right.
    pub x: Scale,
    /// The vertical scale, from the lower to the upper border.
    pub y: Scale,
}

/// Maps the values of an axis to positions between its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Equal differences have equal lengths.
    Linear {
        /// The values at both ends, in SI units.
        range: Range,
        /// The unit of the labels.
        unit: ScaledUnit,
    },
    /// Equal ratios have equal lengths.
    Log {
        /// The exponents of ten at both ends.
        decades: Range,
        /// True if zero is shown, at a separate position before the first decade.
        has_zero: bool,
    },
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
        let range = Range::spanned(values)?;
        let size = larger(range.from.abs(), range.to.abs());
        // Ticks are distinct numbers of at most twelve decimals.
        Some(if range.to - range.from < size * 1e-11 || size == 0.0 { range.around(size) } else { range })
    }

    /// The range of the finite values, or `None` without any.
    fn spanned(values: impl Iterator<Item = f64>) -> Option<Range> {
        let mut finite = values.filter(|value| value.is_finite());
        let first = finite.next()?;
        Some(finite.fold(Range { from: first, to: first }, Range::including))
    }

    /// A tenth of the size of the values at both ends, or 1 of the unit in all if that is 0.
    fn around(self, size: f64) -> Range {
        let margin = if size > 0.0 { size / 10.0 } else { 0.5 };
        Range { from: self.from - margin, to: self.to + margin }
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

/// The fraction of a logarithmic scale reserved for zero.
const ZERO_FRACTION: f64 = 0.12;

impl Scale {
    /// The linear scale of a quantity, with the prefix of its unit that suits the range.
    pub fn linear(range: Range, unit: Unit) -> Scale {
        Scale::Linear { range, unit: unit.for_size(larger(range.from.abs(), range.to.abs())) }
    }

    /// The title of an axis: the symbol of its quantity, divided by the unit of a linear scale.
    pub fn title(self, symbol: &str) -> String {
        match self {
            Scale::Linear { unit, .. } => match unit.to_string() {
                product if product.contains(['·', '/']) => format!("{symbol} / \"({product})\""),
                unit => format!("{symbol} / \"{unit}\""),
            },
            Scale::Log { .. } => symbol.to_owned(),
        }
    }

    /// The logarithmic scale of the whole decades that contain the positive values, at least two decades long.
    pub fn log(values: impl Iterator<Item = f64> + Clone) -> Scale {
        let has_zero = values.clone().any(|value| value == 0.0);
        // A power of ten alone is within two decades.
        let margin = |range: &Range| if range.from == range.to { 1e-12 } else { 0.0 };
        let range = Range::spanned(values.map(log10)).unwrap_or(Range { from: -1.0, to: 1.0 });
        let mut decades = Range { from: (range.from - margin(&range)).floor(), to: (range.to + margin(&range)).ceil() };
        while decades.to - decades.from < 2.0 {
            decades = Range { from: decades.from, to: decades.to + 1.0 };
        }
        Scale::Log { decades, has_zero }
    }

    /// The position of a value between the ends, 0 to 1.
    fn fraction(self, value: f64) -> f64 {
        match self {
            Scale::Linear { range, .. } => range.fraction(value),
            Scale::Log { decades, has_zero } => {
                let start = if has_zero { ZERO_FRACTION } else { 0.0 };
                if value == 0.0 { start / 2.0 } else { start + (1.0 - start) * decades.fraction(log10(value)) }
            }
        }
    }

    /// Ticks at round values, approximately `max_count` at most.
    fn ticks(self, max_count: f64) -> Vec<Tick> {
        match self {
            Scale::Linear { range, unit } => linear_ticks(range, unit, max_count),
            Scale::Log { decades, has_zero } => {
                let zero = has_zero.then(|| Tick { value: 0.0, label: "0".to_owned() });
                zero.into_iter().chain(decade_ticks(decades, max_count)).collect()
            }
        }
    }
}

impl Axes {
    /// Creates axes in `panel`, which also contains tick labels and titles, with `right` px left free on the right.
    pub fn within(panel: &Rect, x: Scale, y: Scale, right: f64, metrics: &DrawingMetrics) -> Axes {
        let (below, above) = (2.4 * metrics.font_size, 1.5 * metrics.font_size);
        let height = panel.height() - above - below;
        let max_ticks = match y {
            Scale::Linear { .. } => height,
            Scale::Log { .. } => panel.height(),
        } / (TICK_HEIGHT * metrics.font_size);
        let widths = y.ticks(max_ticks).into_iter().map(|tick| tick.line(metrics).width);
        let left = (widths.fold(2.0 * metrics.font_size, larger) + 0.8 * metrics.font_size).ceil();
        let near = panel.origin.add(Vector::new(left, above));
        let far = near.add(Vector::new(panel.width() - left - right - 0.5 * metrics.font_size, height));
        let near = Vector::new(near.x.round(), near.y.round());
        Axes { plot_area: Rect::new(near, far.x.round() - near.x, far.y.round() - near.y), panel: *panel, x, y }
    }

    /// The axes with the left border of the plot area moved to `left`, px.
    pub fn with_left(self, left: f64) -> Axes {
        let (near, far) = (Vector::new(left, self.plot_area.origin.y), self.plot_area.far_corner());
        Axes { plot_area: Rect::new(near, far.x - near.x, far.y - near.y), ..self }
    }

    /// The page position of a point, px.
    pub fn point(&self, x: f64, y: f64) -> Vector {
        let across = self.x.fraction(x) * self.plot_area.width();
        let up = self.y.fraction(y) * self.plot_area.height();
        Vector::new(self.plot_area.origin.x + across, self.plot_area.far_corner().y - up)
    }

    /// Draws grid lines, tick labels, titles and the frame.
    pub fn draw(&self, titles: &AxisTitles, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        let (area, far) = (self.plot_area, self.plot_area.far_corner());
        let (font_size, thin) = (metrics.font_size, (metrics.line_width / 2.0).ceil());
        let [grid, muted] = [metrics.palette.grid, metrics.palette.muted].map(Ink::from);
        // Powers of ten are narrower than decimal numbers, and the titles of logarithmic axes are longer.
        let (tick_width, title_size) = match self.x {
            Scale::Linear { .. } => (5.0, metrics.text(0.9)),
            Scale::Log { .. } => (4.0, metrics.text(0.85)),
        };
        let mut free_from = self.panel.origin.x;
        for tick in self.x.ticks(area.width() / (tick_width * font_size)) {
            let x = (area.origin.x + self.x.fraction(tick.value) * area.width()).round();
            shapes.push(Shape::Rect { rect: Rect::new(Vector::new(x, area.origin.y), thin, area.height()), ink: grid });
            let line = tick.line(metrics);
            // A label at the end of the axis stays within the panel, and none covers another one.
            let left = smaller(x - line.width / 2.0, self.panel.far_corner().x - line.width);
            if left >= free_from {
                free_from = left + line.width + 0.3 * font_size;
                shapes.push(Shape::Text { line, at: Vector::new(left, far.y + 1.1 * font_size), ink: muted });
            }
        }
        let mut last = f64::INFINITY;
        for tick in self.y.ticks(area.height() / (TICK_HEIGHT * font_size)) {
            let y = (far.y - self.y.fraction(tick.value) * area.height()).round();
            shapes.push(Shape::Rect { rect: Rect::new(Vector::new(area.origin.x, y), area.width(), thin), ink: grid });
            let line = tick.line(metrics);
            let at = Vector::new(area.origin.x - line.width - 0.5 * font_size, y + line.height() / 2.0);
            if (y - last).abs() > 1.3 * line.height() {
                last = y;
                shapes.push(Shape::Text { line, at, ink: muted });
            }
        }
        shapes.extend(outline(&area, thin, metrics.palette.wall_edge.into()));
        let ink = metrics.palette.ink.into();
        let line = Line::math(titles.x, title_size);
        let below = Vector::new((far.x - line.width).round(), (far.y + 2.2 * font_size).round());
        shapes.push(Shape::Text { line, at: below, ink });
        let line = Line::math(titles.y, title_size);
        let above = Vector::new(area.origin.x, (area.origin.y - 0.5 * font_size).round());
        shapes.push(Shape::Text { line, at: above, ink });
    }

    /// Draws a note above the right end of the plot area, beside the title of the vertical axis.
    pub fn draw_note(&self, note: Line, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        let baseline = (self.plot_area.origin.y - 0.5 * metrics.font_size).round();
        let at = Vector::new((self.plot_area.far_corner().x - note.width).round(), baseline);
        shapes.push(Shape::Text { line: note, at, ink: metrics.palette.ink.into() });
    }

    /// A solid curve through points, clipped to the plot area.
    pub fn curve(&self, points: impl Iterator<Item = [f64; 2]>, width: f64, ink: Ink) -> Shape {
        self.dashed_curve(points, DashPattern::SOLID, width, ink)
    }

    /// A curve through points, clipped to the plot area.
    pub fn dashed_curve(
        &self,
        points: impl Iterator<Item = [f64; 2]>,
        dashes: DashPattern,
        width: f64,
        ink: Ink,
    ) -> Shape {
        let mut vertices: Vec<Vector> = points.map(|[x, y]| self.point(x, y)).filter(|at| at.is_finite()).collect();
        vertices.dedup();
        // A line of one point would not be visible.
        let shapes = match vertices.as_slice() {
            [at] => vec![dot(*at, DOT_RADIUS * width, ink)],
            _ => dashes.draw(vertices, width, ink),
        };
        Shape::Clip { window: self.plot_area, shapes }
    }
}

/// The radius of the dot in place of a curve of one point, in line widths.
const DOT_RADIUS: f64 = 2.0;

/// Minimum distance of the ticks of a vertical axis, in font sizes.
const TICK_HEIGHT: f64 = 2.0;

struct Tick {
    value: f64,
    label: String,
}

impl Tick {
    fn line(&self, metrics: &DrawingMetrics) -> Line {
        Line::math(&metrics.language.decimal(self.label.clone()), metrics.text(0.8))
    }
}

/// Ticks at multiples of 1, 2 or 5 × 10ⁿ within a range.
fn linear_ticks(range: Range, unit: ScaledUnit, max_count: f64) -> Vec<Tick> {
    let (low, high) = (smaller(range.from, range.to), larger(range.from, range.to));
    let mut spacing = nice_spacing((high - low) / larger(max_count, 2.0));
    // One tick gives no scale. Within a range there are always two multiples of a quarter of it.
    while multiples_within([low, high], spacing, 0.0).nth(1).is_none() && spacing > (high - low) / 4.0 {
        let finer = nice_spacing(spacing / 2.5);
        if finer >= spacing {
            break; // The range is as short as the least positive numbers.
        }
        spacing = finer;
    }
    let scaled_spacing = unit.scaled(spacing);
    let power = PowerOfTen::of(unit.scaled(larger(low.abs(), high.abs())), scaled_spacing);
    let tick = |value| Tick { value, label: power.label(unit.scaled(value), scaled_spacing) };
    multiples_within([low, high], spacing, 0.0).take(100).map(tick).collect()
}

/// Ticks at every power of ten, or at every second, third, fifth … one.
fn decade_ticks(decades: Range, max_count: f64) -> impl Iterator<Item = Tick> {
    let length = decades.to - decades.from;
    let spacing = [1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|spacing| length / spacing <= max_count);
    let exponents: Vec<f64> = multiples_within([decades.from, decades.to], spacing.unwrap_or(100.0), 0.0).collect();
    // One tick gives no scale.
    let exponents = if exponents.len() < 2 { vec![decades.from, decades.to] } else { exponents };
    exponents.into_iter().map(|exponent| Tick { value: power_of_ten(exponent), label: power_label(exponent) })
}

fn power_label(exponent: f64) -> String {
    match exponent {
        0.0 => "1".into(),
        1.0 => "10".into(),
        2.0 => "100".into(),
        exponent => format!("10^{{{exponent}}}"),
    }
}

fn power_of_ten(exponent: f64) -> f64 {
    let count = exponent.abs() as u32;
    let power = (0..count).fold(1.0, |power, _| power * 10.0);
    if exponent < 0.0 { 1.0 / power } else { power }
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
