use super::super::palette::{self, SPEED_COLORS};
use super::super::text::Line;
use super::super::{Color, Ink, Metrics, Shape, Style};
use super::grid::tick_label;
use crate::physics::{Rect, Vector};
use crate::scene::ColorBy;

/// A legend: a row of colours with their meanings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Legend {
    /// From left to right.
    pub entries: Vec<Entry>,
}

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Colours, drawn side by side.
    pub colors: Vec<Color>,
    /// Text before the colours; may be empty.
    pub prefix: String,
    /// Text after the colours, as markup for [`Line::math`].
    pub name: String,
}

impl Entry {
    /// An entry of one colour with a plain-text name.
    pub fn new(color: Color, name: &str) -> Entry {
        Entry { colors: vec![color], prefix: String::new(), name: quoted(name) }
    }
}

/// Quotes a name so that [`Line::math`] typesets it unchanged.
pub fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "″"))
}

impl Legend {
    /// The legend of the box colours of `style`; empty if boxes are coloured individually.
    pub fn of(style: &Style) -> Legend {
        let entries = match style.color_by {
            ColorBy::Body => Vec::new(),
            ColorBy::Material => {
                let entry = |name: &String| Entry::new(palette::color_by_material(name, style), name);
                style.materials.iter().map(entry).collect()
            }
            ColorBy::Speed => vec![speed_scale(style.top_speed)],
        };
        Legend { entries }
    }

    /// Draws the legend in a strip, in a smaller font if necessary. The last entries are omitted if they do not fit in
    /// the smallest font.
    pub fn draw(&self, strip: &Rect, alignment: Alignment, metrics: &Metrics, shapes: &mut Vec<Shape>) {
        let sizes = [0.85, 0.7, 0.6].map(|size| size * metrics.font_size);
        let largest_fitting = sizes.into_iter().find(|&size| self.width(size) <= strip.width());
        let size = largest_fitting.unwrap_or(sizes[2]);
        let free_width = strip.width() - self.width(size);
        let mut x = match alignment {
            Alignment::Right => strip.origin.x + free_width,
            Alignment::Center => strip.origin.x + free_width / 2.0,
        };
        x = if free_width < 0.0 { strip.origin.x } else { x.round() };
        for entry in &self.entries {
            if x + entry.width(size) > strip.far_corner().x + 1.0 {
                return;
            }
            entry.draw(x, size, strip, metrics, shapes);
            x += entry.width(size) + entry_gap(size);
        }
    }

    fn width(&self, size: f64) -> f64 {
        let widths: f64 = self.entries.iter().map(|entry| entry.width(size) + entry_gap(size)).sum();
        if widths > 0.0 { widths - entry_gap(size) } else { 0.0 }
    }
}

/// The alignment of a legend in its strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// At the right end.
    Right,
    /// In the middle.
    Center,
}

/// The colour scale from 0 to the top speed.
fn speed_scale(top: f64) -> Entry {
    let name = format!("\"{} m/s\"", tick_label(top, top / 10.0));
    Entry { colors: SPEED_COLORS.to_vec(), prefix: "0".to_owned(), name }
}

fn entry_gap(size: f64) -> f64 {
    (1.1 * size).round()
}

fn text_gap(size: f64) -> f64 {
    (0.4 * size).round()
}

fn swatch_size(size: f64) -> f64 {
    (0.9 * size).round()
}

impl Entry {
    fn width(&self, size: f64) -> f64 {
        let prefix = if self.prefix.is_empty() { 0.0 } else { Line::plain(&self.prefix, size).width + text_gap(size) };
        (prefix + swatch_size(size) * self.colors.len() as f64 + text_gap(size) + Line::math(&self.name, size).width)
            .ceil()
    }

    fn draw(&self, left: f64, size: f64, strip: &Rect, metrics: &Metrics, shapes: &mut Vec<Shape>) {
        let ink = Ink::from(metrics.palette.muted);
        let mut x = left;
        if !self.prefix.is_empty() {
            let line = Line::plain(&self.prefix, size);
            let width = line.width;
            shapes.push(Shape::Text { at: Vector::new(x, baseline(&line, strip)), line, ink });
            x += width + text_gap(size);
        }
        x = x.round();
        for &color in &self.colors {
            let corner = Vector::new(x, (strip.center().y - swatch_size(size) / 2.0).round());
            let rect = Rect::new(corner, swatch_size(size), swatch_size(size));
            shapes.push(Shape::Rect { rect, ink: Ink::from(color) });
            x += swatch_size(size);
        }
        let line = Line::math(&self.name, size);
        shapes.push(Shape::Text { at: Vector::new(x + text_gap(size), baseline(&line, strip)), line, ink });
    }
}

/// The baseline of a line that is vertically centred in a strip.
pub fn baseline(line: &Line, strip: &Rect) -> f64 {
    (strip.center().y + line.height() / 2.0).round()
}
