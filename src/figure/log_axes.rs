use super::axes::Range;
use super::log10::log10;
use super::panels::outline;
use crate::physics::{Rect, Vector};
use crate::render::area::larger;
use crate::render::text::Line;
use crate::render::{Metrics, Shape};

/// The axes of a diagram with logarithmic scales. Zero is shown at a separate position before the first decade.
pub struct LogAxes {
    /// The plot area inside the frame, px.
    pub plot_area: Rect,
    x: Scale,
    y: Scale,
}

/// A logarithmic scale: the exponents at both ends, and whether zero is shown before the first decade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    decades: Range,
    has_zero: bool,
}

/// The fraction of a scale reserved for zero.
const ZERO_FRACTION: f64 = 0.12;

impl Scale {
    /// The scale of the whole decades that contain the positive values, at least two decades long.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Scale {
        let has_zero = values.clone().any(|value| value == 0.0);
        let logarithms = values.map(log10);
        let range = Range::of(logarithms).unwrap_or(Range { from: -1.0, to: 1.0 });
        let mut decades = Range { from: range.from.floor(), to: range.to.ceil() };
        while decades.to - decades.from < 2.0 {
            decades = Range { from: decades.from, to: decades.to + 1.0 };
        }
        Scale { decades, has_zero }
    }

    /// The position of a value between the ends, 0 to 1.
    fn fraction(&self, value: f64) -> f64 {
        let start = if self.has_zero { ZERO_FRACTION } else { 0.0 };
        if value == 0.0 {
            return start / 2.0;
        }
        let fraction = (log10(value) - self.decades.from) / (self.decades.to - self.decades.from);
        start + (1.0 - start) * fraction
    }

    /// The value and label of each tick, approximately `max_count` at most.
    fn ticks(&self, max_count: f64) -> Vec<(f64, String)> {
        let length = self.decades.to - self.decades.from;
        let spacing = [1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|spacing| length / spacing <= max_count);
        let spacing = spacing.unwrap_or(100.0);
        let first = (self.decades.from / spacing).ceil() * spacing;
        let count = ((self.decades.to - first) / spacing).floor() as u32;
        let zero = self.has_zero.then(|| (0.0, "0".to_owned()));
        let power = |number: u32| {
            let exponent = first + f64::from(number) * spacing;
            (power_of_ten(exponent), power_label(exponent))
        };
        zero.into_iter().chain((0..=count).map(power)).collect()
    }
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

impl LogAxes {
    /// Creates axes in `panel`, which also contains tick labels and titles.
    pub fn within(panel: &Rect, x: Scale, y: Scale, metrics: &Metrics) -> LogAxes {
        let (below, above) = (2.4 * metrics.font_size, 1.5 * metrics.font_size);
        let widths = y
            .ticks(panel.height() / (2.0 * metrics.font_size))
            .into_iter()
            .map(|(_, label)| label_line(&label, metrics).width);
        let left = (widths.fold(2.0 * metrics.font_size, larger) + 0.8 * metrics.font_size).ceil();
        let near = Vector::new((panel.origin.x + left).round(), (panel.origin.y + above).round());
        let far = Vector::new(panel.far_corner().x - metrics.font_size, panel.far_corner().y - below);
        LogAxes { plot_area: Rect::new(near, far.x.round() - near.x, far.y.round() - near.y), x, y }
    }

    /// The page position of a point, px.
    pub fn point(&self, x: f64, y: f64) -> Vector {
        let across = self.x.fraction(x) * self.plot_area.width();
        let up = self.y.fraction(y) * self.plot_area.height();
        Vector::new(self.plot_area.origin.x + across, self.plot_area.far_corner().y - up)
    }

    /// Draws grid lines, tick labels, titles and the frame.
    pub fn draw(&self, [x_title, y_title]: [&str; 2], metrics: &Metrics, shapes: &mut Vec<Shape>) {
        let thin = (metrics.line_width / 2.0).ceil();
        let (near, far) = (self.plot_area.origin, self.plot_area.far_corner());
        let muted = metrics.palette.muted.into();
        for (value, label) in self.x.ticks(self.plot_area.width() / (4.0 * metrics.font_size)) {
            let at = (near.x + self.x.fraction(value) * self.plot_area.width()).round();
            shapes.push(grid_line(Rect::new(Vector::new(at, near.y), thin, self.plot_area.height()), metrics));
            let line = label_line(&label, metrics);
            let baseline = Vector::new(at - line.width / 2.0, far.y + 1.1 * metrics.font_size);
            shapes.push(Shape::Text { line, at: baseline, ink: muted });
        }
        for (value, label) in self.y.ticks(self.plot_area.height() / (2.0 * metrics.font_size)) {
            let at = (far.y - self.y.fraction(value) * self.plot_area.height()).round();
            shapes.push(grid_line(Rect::new(Vector::new(near.x, at), self.plot_area.width(), thin), metrics));
            let line = label_line(&label, metrics);
            let baseline = Vector::new(near.x - line.width - 0.5 * metrics.font_size, at + line.height() / 2.0);
            shapes.push(Shape::Text { line, at: baseline, ink: muted });
        }
        shapes.extend(outline(&self.plot_area, thin, metrics.palette.wall_edge.into()));
        let ink = metrics.palette.ink.into();
        let line = Line::math(x_title, 0.85 * metrics.font_size);
        let below = Vector::new((far.x - line.width).round(), (far.y + 2.2 * metrics.font_size).round());
        shapes.push(Shape::Text { line, at: below, ink });
        let line = Line::math(y_title, 0.85 * metrics.font_size);
        let above = Vector::new(near.x, (near.y - 0.5 * metrics.font_size).round());
        shapes.push(Shape::Text { line, at: above, ink });
    }
}

fn label_line(label: &str, metrics: &Metrics) -> Line {
    Line::math(label, 0.8 * metrics.font_size)
}

fn grid_line(rect: Rect, metrics: &Metrics) -> Shape {
    Shape::Rect { rect, ink: metrics.palette.grid.into() }
}
