use super::panels::outline;
use crate::physics::{Rect, Vector};
use crate::render::area::{larger, smaller};
use crate::render::layers::grid::{number, round_spacing};
use crate::render::text::Line;
use crate::render::{Look, Shape};

/// A diagram: a frame with two scales, and where numbers lie in it.
pub struct Axes {
    /// What is within the frame, px.
    pub frame: Rect,
    /// The numbers at its left and right border.
    pub x: Range,
    /// The numbers at its lower and upper border.
    pub y: Range,
}

/// From one number to another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// At the left or lower border.
    pub from: f64,
    /// At the right or upper border.
    pub to: f64,
}

impl Range {
    /// The range of some numbers, if there are finite ones; wide enough to divide by.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Range> {
        let mut finite = values.filter(|value| value.is_finite());
        let first = finite.next()?;
        let range = finite.fold(Range { from: first, to: first }, Range::with);
        let size = larger(range.from.abs(), range.to.abs());
        let least = if size > 0.0 { size * 1e-12 } else { 1.0 };
        if range.to - range.from >= least {
            return Some(range);
        }
        Some(Range { from: range.from - least / 2.0, to: range.to + least / 2.0 })
    }

    /// The range with a part of its length added at both ends.
    pub fn widened(self, part: f64) -> Range {
        let by = part * (self.to - self.from);
        Range { from: self.from - by, to: self.to + by }
    }

    /// The range that holds a number too.
    pub fn with(self, value: f64) -> Range {
        Range { from: smaller(value, self.from), to: larger(value, self.to) }
    }

    /// Where a number lies between the ends, 0 to 1.
    fn part(self, value: f64) -> f64 {
        (value - self.from) / (self.to - self.from)
    }
}

/// What the two scales of a diagram are called, as markup.
pub struct Titles<'a> {
    /// Below the diagram.
    pub x: &'a str,
    /// Above its left border.
    pub y: &'a str,
}

impl Axes {
    /// A diagram in the given room, which also holds numbers and titles, with `right` px kept
    /// free on its right.
    pub fn within(room: &Rect, x: Range, y: Range, right: f64, look: &Look) -> Axes {
        let (below, above) = (2.4 * look.text, 1.5 * look.text);
        let widths = y_ticks(y, room.height() - above - below, look).map(|tick| tick.line(look).width);
        let left = (widths.fold(2.0 * look.text, larger) + 0.8 * look.text).ceil();
        let origin = room.origin.add(Vector::new(left, above));
        let (width, height) = (room.width() - left - right - 0.5 * look.text, room.height() - above - below);
        let whole = |rect: Rect| {
            let (near, far) = (rect.origin, rect.far_corner());
            let near = Vector::new(near.x.round(), near.y.round());
            Rect::new(near, far.x.round() - near.x, far.y.round() - near.y)
        };
        Axes { frame: whole(Rect::new(origin, width, height)), x, y }
    }

    /// Where a pair of numbers lies, px.
    pub fn point(&self, x: f64, y: f64) -> Vector {
        let across = self.x.part(x) * self.frame.width();
        let up = self.y.part(y) * self.frame.height();
        Vector::new(self.frame.origin.x + across, self.frame.far_corner().y - up)
    }

    /// Draws grid lines, numbers, titles and the frame.
    pub fn draw(&self, titles: &Titles, look: &Look, shapes: &mut Vec<Shape>) {
        let thin = if look.line < 2.0 { 1.0 } else { (look.line / 2.0).round() };
        for x in ticks(self.x, self.frame.width() / (5.0 * look.text)) {
            let at = self.point(x.value, self.y.from).x.round();
            shapes.push(line_rect(at, self.frame.origin.y, thin, self.frame.height(), look));
            let line = x.line(look);
            let place = Vector::new(at - line.width / 2.0, self.frame.far_corner().y + 1.1 * look.text);
            shapes.push(Shape::Text { line, at: place, ink: look.palette.muted.into() });
        }
        for y in y_ticks(self.y, self.frame.height(), look) {
            let at = self.point(self.x.from, y.value).y.round();
            shapes.push(line_rect(self.frame.origin.x, at, self.frame.width(), thin, look));
            let line = y.line(look);
            let place = Vector::new(self.frame.origin.x - line.width - 0.5 * look.text, at + line.height() / 2.0);
            shapes.push(Shape::Text { line, at: place, ink: look.palette.muted.into() });
        }
        shapes.extend(outline(&self.frame, thin, look.palette.wall_edge.into()));
        self.draw_titles(titles, look, shapes);
    }

    fn draw_titles(&self, titles: &Titles, look: &Look, shapes: &mut Vec<Shape>) {
        let x = Line::math(titles.x, 0.9 * look.text);
        let far = self.frame.far_corner();
        let below = Vector::new((far.x - x.width).round(), (far.y + 2.2 * look.text).round());
        shapes.push(Shape::Text { line: x, at: below, ink: look.palette.ink.into() });
        let y = Line::math(titles.y, 0.9 * look.text);
        let above = Vector::new(self.frame.origin.x, (self.frame.origin.y - 0.5 * look.text).round());
        shapes.push(Shape::Text { line: y, at: above, ink: look.palette.ink.into() });
    }

    /// Draws a line through pairs of numbers, as fine as can be seen.
    pub fn curve(&self, points: impl Iterator<Item = [f64; 2]>, width: f64, ink: crate::render::Ink) -> Shape {
        let mut seen: Vec<Vector> = Vec::new();
        for [x, y] in points {
            let at = self.point(x, y);
            let far = seen.last().is_none_or(|last| at.sub(*last).norm() >= 0.5);
            if far && at.is_finite() {
                seen.push(at);
            }
        }
        Shape::Clip { window: self.frame, shapes: vec![Shape::Polyline { points: seen, width, ink }] }
    }
}

struct Tick {
    value: f64,
    label: String,
}

impl Tick {
    fn line(&self, look: &Look) -> Line {
        Line::math(&self.label, 0.8 * look.text)
    }
}

/// The ticks of a vertical scale of so many px.
fn y_ticks(range: Range, height: f64, look: &Look) -> impl Iterator<Item = Tick> {
    ticks(range, height / (2.0 * look.text)).into_iter()
}

/// Multiples of 1, 2 or 5 × 10ⁿ within a range, at most about `most` of them.
fn ticks(range: Range, most: f64) -> Vec<Tick> {
    let most = if most < 2.0 { 2.0 } else { most };
    let (low, high) = (smaller(range.from, range.to), larger(range.from, range.to));
    let spacing = round_spacing((high - low) / most);
    let first = (low / spacing).ceil();
    let count = ((high / spacing).floor() - first) as i64 + 1;
    let unit = Unit::of(larger(low.abs(), high.abs()), spacing);
    let tick = |place: i64| {
        let value = (first + place as f64) * spacing;
        Tick { value, label: unit.label(value, spacing) }
    };
    (0..count.clamp(0, 100)).map(tick).collect()
}

/// The power of ten in which all numbers of a scale are written.
struct Unit {
    value: f64,
    exponent: i32,
}

impl Unit {
    /// One, where that does not take too many digits.
    fn of(largest: f64, spacing: f64) -> Unit {
        let mut unit = Unit { value: 1.0, exponent: 0 };
        if (1e-4..1e5).contains(&spacing) && largest < 1e9 && !(largest >= 1e6 && spacing >= 1e4) {
            return unit;
        }
        while unit.value * 10.0 <= largest * (1.0 + 1e-9) && unit.exponent < 300 {
            unit = Unit { value: unit.value * 10.0, exponent: unit.exponent + 1 };
        }
        while unit.value > largest * (1.0 + 1e-9) && unit.exponent > -300 {
            unit = Unit { value: unit.value / 10.0, exponent: unit.exponent - 1 };
        }
        unit
    }

    fn label(&self, value: f64, spacing: f64) -> String {
        let plain = number(value / self.value + 0.0, spacing / self.value);
        match self.exponent {
            0 => plain,
            _ if value == 0.0 => "0".to_owned(),
            exponent => format!("{plain}·10^{{{exponent}}}"),
        }
    }
}

fn line_rect(x: f64, y: f64, width: f64, height: f64, look: &Look) -> Shape {
    Shape::Rect { rect: Rect::new(Vector::new(x, y), width, height), ink: look.palette.grid.into() }
}
