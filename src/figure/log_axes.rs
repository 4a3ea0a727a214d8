use super::axes::Range;
use super::logarithm::logarithm;
use super::panels::outline;
use crate::physics::{Rect, Vector};
use crate::render::area::larger;
use crate::render::text::Line;
use crate::render::{Look, Shape};

/// A frame with two logarithmic scales, in which zero has a place of its own below the vertical one.
pub struct LogAxes {
    /// What is within the frame, px.
    pub frame: Rect,
    x: Scale,
    y: Scale,
}

/// The powers of ten at both ends of a scale, and whether zero stands before them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    decades: Range,
    has_zero: bool,
}

/// The part of a scale that zero takes.
const ZERO: f64 = 0.12;

impl Scale {
    /// The whole decades that hold some values; at least two.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Scale {
        let has_zero = values.clone().any(|value| value == 0.0);
        let logarithms = values.map(logarithm);
        let range = Range::of(logarithms).unwrap_or(Range { from: -1.0, to: 1.0 });
        let mut decades = Range { from: range.from.floor(), to: range.to.ceil() };
        while decades.to - decades.from < 2.0 {
            decades = Range { from: decades.from, to: decades.to + 1.0 };
        }
        Scale { decades, has_zero }
    }

    /// Where a value lies between the ends, 0 to 1.
    fn part(&self, value: f64) -> f64 {
        let begin = if self.has_zero { ZERO } else { 0.0 };
        if value == 0.0 {
            return begin / 2.0;
        }
        let part = (logarithm(value) - self.decades.from) / (self.decades.to - self.decades.from);
        begin + (1.0 - begin) * part
    }

    /// The value at each tick and its label, at most about `most`.
    fn ticks(&self, most: f64) -> Vec<(f64, String)> {
        let length = self.decades.to - self.decades.from;
        let spacing = [1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|spacing| length / spacing <= most);
        let spacing = spacing.unwrap_or(100.0);
        let first = (self.decades.from / spacing).ceil() * spacing;
        let count = ((self.decades.to - first) / spacing).floor() as u32;
        let zero = self.has_zero.then(|| (0.0, "0".to_owned()));
        let power = |number: u32| {
            let exponent = first + f64::from(number) * spacing;
            (ten_to(exponent), label(exponent))
        };
        zero.into_iter().chain((0..=count).map(power)).collect()
    }
}

fn label(exponent: f64) -> String {
    match exponent {
        0.0 => "1".into(),
        1.0 => "10".into(),
        2.0 => "100".into(),
        exponent => format!("10^{{{exponent}}}"),
    }
}

fn ten_to(exponent: f64) -> f64 {
    let count = exponent.abs() as u32;
    let power = (0..count).fold(1.0, |power, _| power * 10.0);
    if exponent < 0.0 { 1.0 / power } else { power }
}

impl LogAxes {
    /// Axes in a room that also holds numbers and titles.
    pub fn within(room: &Rect, x: Scale, y: Scale, look: &Look) -> LogAxes {
        let (below, above) = (2.4 * look.text, 1.5 * look.text);
        let widths =
            y.ticks(room.height() / (2.0 * look.text)).into_iter().map(|(_, label)| number(&label, look).width);
        let left = (widths.fold(2.0 * look.text, larger) + 0.8 * look.text).ceil();
        let near = Vector::new((room.origin.x + left).round(), (room.origin.y + above).round());
        let far = Vector::new(room.far_corner().x - look.text, room.far_corner().y - below);
        LogAxes { frame: Rect::new(near, far.x.round() - near.x, far.y.round() - near.y), x, y }
    }

    /// Where a pair of values lies, px.
    pub fn point(&self, x: f64, y: f64) -> Vector {
        let across = self.x.part(x) * self.frame.width();
        let up = self.y.part(y) * self.frame.height();
        Vector::new(self.frame.origin.x + across, self.frame.far_corner().y - up)
    }

    /// Draws grid lines, numbers, titles and the frame.
    pub fn draw(&self, [x_title, y_title]: [&str; 2], look: &Look, shapes: &mut Vec<Shape>) {
        let thin = (look.line / 2.0).ceil();
        let (near, far) = (self.frame.origin, self.frame.far_corner());
        let muted = look.palette.muted.into();
        for (value, label) in self.x.ticks(self.frame.width() / (4.0 * look.text)) {
            let at = (near.x + self.x.part(value) * self.frame.width()).round();
            shapes.push(rule(Rect::new(Vector::new(at, near.y), thin, self.frame.height()), look));
            let line = number(&label, look);
            let place = Vector::new(at - line.width / 2.0, far.y + 1.1 * look.text);
            shapes.push(Shape::Text { line, at: place, ink: muted });
        }
        for (value, label) in self.y.ticks(self.frame.height() / (2.0 * look.text)) {
            let at = (far.y - self.y.part(value) * self.frame.height()).round();
            shapes.push(rule(Rect::new(Vector::new(near.x, at), self.frame.width(), thin), look));
            let line = number(&label, look);
            let place = Vector::new(near.x - line.width - 0.5 * look.text, at + line.height() / 2.0);
            shapes.push(Shape::Text { line, at: place, ink: muted });
        }
        shapes.extend(outline(&self.frame, thin, look.palette.wall_edge.into()));
        let ink = look.palette.ink.into();
        let line = Line::math(x_title, 0.85 * look.text);
        let below = Vector::new((far.x - line.width).round(), (far.y + 2.2 * look.text).round());
        shapes.push(Shape::Text { line, at: below, ink });
        let line = Line::math(y_title, 0.85 * look.text);
        let above = Vector::new(near.x, (near.y - 0.5 * look.text).round());
        shapes.push(Shape::Text { line, at: above, ink });
    }
}

fn number(label: &str, look: &Look) -> Line {
    Line::math(label, 0.8 * look.text)
}

fn rule(rect: Rect, look: &Look) -> Shape {
    Shape::Rect { rect, ink: look.palette.grid.into() }
}
