use super::LayoutContext;
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::number::{nice_spacing, tick_label};
use crate::picture::raster::color::{self, SPEED_COLORS};
use crate::picture::text::Line;
use crate::picture::{Color, DrawingMetrics, Frame, Ink, Shape, Style};
use crate::picture::{ColorBy, Overlay};

/// Draws the strips below the world: clock and scale bar on the left and the legend on the right; below them the
/// caption.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let style = &context.view.style;
    let [width, height] = context.camera.size.map(f64::from);
    let strip = (smaller(width, height) / 18.0).floor();
    let mut bottom = height;
    if !style.look.caption.is_empty() {
        bottom -= strip;
        caption(&Rect::new(Vector::new(0.0, bottom), width, strip), context, shapes);
    }
    if style.has_footer() {
        let margin = context.metrics.font_size.round();
        let strip = Rect::new(Vector::new(margin, bottom - strip), width - 2.0 * margin, strip);
        draw_info_strip(frame, &strip, context, shapes);
    }
}

/// Draws clock, scale bar and legend.
fn draw_info_strip(frame: &Frame, strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let mut x = strip.origin.x;
    if context.view.style.shows(Overlay::Clock) {
        x = clock(frame.time, strip, context, shapes) + context.metrics.font_size;
    }
    if context.view.style.shows(Overlay::Scale) {
        x = scale_bar(x, strip, context, shapes) + context.metrics.font_size;
    }
    let rest = Rect::new(Vector::new(x, strip.origin.y), strip.far_corner().x - x, strip.height());
    Legend::of(&context.view.style).draw(&rest, Alignment::Right, &context.metrics, shapes);
}

fn caption(strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let font_size = context.metrics.font_size;
    let sizes = [1.0, 0.85, 0.7, 0.6].map(|size| size * font_size);
    let line = Line::fitting(&context.view.style.look.caption, sizes, strip.width() - font_size);
    // The baseline does not depend on the size.
    let y = baseline(&Line::plain("", font_size), strip);
    let at = Vector::new(((strip.width() - line.width) / 2.0).round(), y);
    shapes.push(Shape::Text { line, at, ink: Ink::from(context.metrics.palette.ink) });
}

/// Draws the time and returns the right end of its space, which is wide enough for four digits of seconds so that the
/// following elements do not move.
fn clock(time: f64, strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) -> f64 {
    let line = Line::plain(&format!("𝑡 = {time:.2} s"), context.metrics.font_size);
    let widest = Line::plain("𝑡 = 8888.88 s", context.metrics.font_size).width;
    let width = larger(line.width, widest);
    let at = Vector::new(strip.origin.x, baseline(&line, strip));
    shapes.push(Shape::Text { line, at, ink: Ink::from(context.metrics.palette.ink) });
    (strip.origin.x + width).round()
}

/// Minimum length of the scale bar, in font sizes.
const MIN_BAR: f64 = 3.0;

/// Draws a scale bar of a round length with its label and returns the right end of the label.
fn scale_bar(left: f64, strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) -> f64 {
    let ink = Ink::from(context.metrics.palette.ink);
    let (line, text) = (context.metrics.line_width, context.metrics.font_size);
    let length = nice_spacing(MIN_BAR * text / context.camera.scale);
    let width = (length * context.camera.scale).round();
    let (left, y, height) = (left.round(), strip.center().y.round(), (0.5 * text).round());
    let bar = |x: f64, y: f64, width: f64, height: f64| Shape::Rect {
        rect: Rect::new(Vector::new(x, y), width, height),
        ink,
    };
    let end = |x: f64| bar(x, (strip.center().y - height / 2.0).round(), line, height);
    shapes.extend([bar(left, y, width, line), end(left), end(left + width - line)]);
    let label = Line::plain(&format!("{} m", tick_label(length, length)), 0.85 * text);
    let (at, width) = (left + width + (0.4 * text).round(), label.width);
    shapes.push(Shape::Text { at: Vector::new(at, baseline(&label, strip)), line: label, ink });
    (at + width).round()
}

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
        let entries = match style.look.color_by {
            ColorBy::Body => Vec::new(),
            ColorBy::Material => {
                let entry = |name: &String| Entry::new(color::color_by_material(name, style), name);
                style.materials.iter().map(entry).collect()
            }
            ColorBy::Speed => vec![speed_scale(style.top_speed)],
        };
        Legend { entries }
    }

    /// Draws the legend in a strip, in a smaller font if necessary. The last entries are omitted if they do not fit in
    /// the smallest font.
    pub fn draw(&self, strip: &Rect, alignment: Alignment, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
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

    fn draw(&self, left: f64, size: f64, strip: &Rect, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
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
