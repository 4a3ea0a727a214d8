use super::super::palette::{self, SPEEDS};
use super::super::text::Line;
use super::super::{Color, Ink, Look, Shape, Style};
use super::grid::number;
use crate::physics::{Rect, Vector};
use crate::scene::ColorBy;

/// What colours mean, in a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Legend {
    /// From left to right.
    pub entries: Vec<Entry>,
}

/// One thing colours mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Side by side.
    pub colors: Vec<Color>,
    /// Written before them; may be empty.
    pub before: String,
    /// Written behind them, as markup for [`Line::math`].
    pub name: String,
}

impl Entry {
    /// A colour and its name.
    pub fn new(color: Color, name: &str) -> Entry {
        Entry { colors: vec![color], before: String::new(), name: quoted(name) }
    }
}

/// A name as markup that leaves it as it is.
pub fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "″"))
}

impl Legend {
    /// What the colours of boxes mean; nothing where each box has its own.
    pub fn of(style: &Style) -> Legend {
        let entries = match style.color_by {
            ColorBy::Body => Vec::new(),
            ColorBy::Material => {
                let entry = |name: &String| Entry::new(palette::material_color(name, style), name);
                style.materials.iter().map(entry).collect()
            }
            ColorBy::Speed => vec![speeds(style.top_speed)],
        };
        Legend { entries }
    }

    /// Draws the row at the right end of a strip, or in its middle, smaller where it must be; the
    /// last entries are left out where nothing helps.
    pub fn draw(&self, strip: &Rect, place: Place, look: &Look, shapes: &mut Vec<Shape>) {
        let sizes = [0.85, 0.7, 0.6].map(|size| size * look.text);
        let fitting = sizes.into_iter().find(|&size| self.width(size) <= strip.width());
        let size = fitting.unwrap_or(sizes[2]);
        let room = strip.width() - self.width(size);
        let mut x = match place {
            Place::Right => strip.origin.x + room,
            Place::Middle => strip.origin.x + room / 2.0,
        };
        x = if room < 0.0 { strip.origin.x } else { x.round() };
        for entry in &self.entries {
            if x + entry.width(size) > strip.far_corner().x + 1.0 {
                return;
            }
            entry.draw(x, size, strip, look, shapes);
            x += entry.width(size) + gap_between(size);
        }
    }

    fn width(&self, size: f64) -> f64 {
        let widths: f64 = self.entries.iter().map(|entry| entry.width(size) + gap_between(size)).sum();
        if widths > 0.0 { widths - gap_between(size) } else { 0.0 }
    }
}

/// Where in its strip a legend stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// At its right end.
    Right,
    /// In its middle.
    Middle,
}

/// A bar of the scale's colours between 0 and the top speed.
fn speeds(top: f64) -> Entry {
    let name = format!("\"{} m/s\"", number(top, top / 10.0));
    Entry { colors: SPEEDS.to_vec(), before: "0".to_owned(), name }
}

fn gap_between(size: f64) -> f64 {
    (1.1 * size).round()
}

fn gap(size: f64) -> f64 {
    (0.4 * size).round()
}

fn swatch(size: f64) -> f64 {
    (0.9 * size).round()
}

impl Entry {
    fn width(&self, size: f64) -> f64 {
        let before = if self.before.is_empty() { 0.0 } else { Line::plain(&self.before, size).width + gap(size) };
        (before + swatch(size) * self.colors.len() as f64 + gap(size) + Line::math(&self.name, size).width).ceil()
    }

    fn draw(&self, left: f64, size: f64, strip: &Rect, look: &Look, shapes: &mut Vec<Shape>) {
        let ink = Ink::from(look.palette.muted);
        let mut x = left;
        if !self.before.is_empty() {
            let line = Line::plain(&self.before, size);
            let width = line.width;
            shapes.push(Shape::Text { at: Vector::new(x, baseline(&line, strip)), line, ink });
            x += width + gap(size);
        }
        x = x.round();
        for &color in &self.colors {
            let corner = Vector::new(x, (strip.center().y - swatch(size) / 2.0).round());
            let rect = Rect::new(corner, swatch(size), swatch(size));
            shapes.push(Shape::Rect { rect, ink: Ink::from(color) });
            x += swatch(size);
        }
        let line = Line::math(&self.name, size);
        shapes.push(Shape::Text { at: Vector::new(x + gap(size), baseline(&line, strip)), line, ink });
    }
}

/// Where a line stands in the middle of a strip's height.
pub fn baseline(line: &Line, strip: &Rect) -> f64 {
    (strip.center().y + line.height() / 2.0).round()
}
