use super::LayoutContext;
use super::bodies::Hatching;
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::number::{Unit, nice_spacing};
use crate::picture::raster::color::{self, SPEED_COLORS};
use crate::picture::text::{Line, wrapped};
use crate::picture::{Color, DrawingMetrics, Frame, Ink, Shape, Style};
use crate::picture::{ColorBy, Overlay};

/// Draws the strips below the world: clock and scale bar on the left and the legend on the right, or below them if it is
/// long; below them the caption.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let (style, metrics) = (&context.view.style, &context.metrics);
    let [width, height] = context.camera.size.map(f64::from);
    let strip = (smaller(width, height) / 18.0).floor();
    let [info_height, caption_height] = strip_heights(style, metrics);
    let bottom = height - caption_height;
    if !style.look.caption.is_empty() {
        let caption = Caption::new(&style.look.caption, [width, height], metrics.font_size);
        let first = Rect::new(Vector::new(0.0, bottom), width, strip);
        // The baseline does not depend on the size.
        let y = baseline(&Line::plain("", metrics.font_size), &first);
        caption.draw(width / 2.0, y, Ink::from(metrics.palette.ink), shapes);
    }
    if style.has_footer() {
        let margin = metrics.font_size.round();
        let info = Rect::new(Vector::new(margin, bottom - info_height), width - 2.0 * margin, strip);
        draw_info_strip(frame, &info, context, shapes);
        if let (Some(legend), height) = legend_block(style, metrics) {
            let block = Rect::new(info.origin.add(Vector::new(0.0, strip)), info.width(), height);
            legend.draw(&block, Alignment::Center, metrics, shapes);
        }
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
    if legend_block(&context.view.style, &context.metrics).0.is_none() {
        let rest = Rect::new(Vector::new(x, strip.origin.y), strip.far_corner().x - x, strip.height());
        Legend::of(&context.view.style).draw(&rest, Alignment::Right, &context.metrics, shapes);
    }
}

/// A caption in one or more lines, and its height.
pub struct Caption {
    lines: Vec<Line>,
    /// Distance of baselines, px.
    spacing: f64,
}

impl Caption {
    /// Lays out a caption for a page of `size` px: as large as possible with at most a third of the page's height.
    pub fn new(text: &str, [width, height]: [f64; 2], font_size: f64) -> Caption {
        let caption = |scale: f64| {
            let size = scale * font_size;
            Caption { lines: wrapped(text, size, width - font_size), spacing: (1.3 * size).ceil() }
        };
        let sizes = [1.0, 0.85, 0.7, 0.6].map(caption);
        let fits = |caption: &Caption| caption.lines.len() as f64 * caption.spacing <= height / 3.0;
        let [.., smallest] = &sizes;
        let at = sizes.iter().position(fits);
        let Caption { lines, spacing } = at.map_or(smallest, |at| &sizes[at]);
        Caption { lines: lines.clone(), spacing: *spacing }
    }

    /// Height of the lines after the first, px.
    pub fn additional_height(&self) -> f64 {
        self.lines.len().saturating_sub(1) as f64 * self.spacing
    }

    /// Draws the lines centred around `middle` (px), the first with its baseline at `y`.
    pub fn draw(self, middle: f64, mut y: f64, ink: Ink, shapes: &mut Vec<Shape>) {
        for line in self.lines {
            let at = Vector::new((middle - line.width / 2.0).round(), y.round());
            shapes.push(Shape::Text { line, at, ink });
            y += self.spacing;
        }
    }
}

/// The heights of the strips below the world: the information and the caption, px. Without either, 0.
pub fn strip_heights(style: &Style, metrics: &DrawingMetrics) -> [f64; 2] {
    let [width, height] = style.look.size.map(f64::from);
    let strip = (smaller(width, height) / 18.0).floor();
    let info = if style.has_footer() { strip + legend_block(style, metrics).1 } else { 0.0 };
    let caption = match style.look.caption.is_empty() {
        true => 0.0,
        false => strip + Caption::new(&style.look.caption, [width, height], metrics.font_size).additional_height(),
    };
    [info, caption]
}

/// The legend if it has rows of its own below the strip with clock and scale bar, and the height of these rows, px.
fn legend_block(style: &Style, metrics: &DrawingMetrics) -> (Option<Legend>, f64) {
    let legend = Legend::of(style);
    let width = f64::from(style.look.size[0]) - 2.0 * metrics.font_size.round();
    let clock = if style.shows(Overlay::Clock) { CLOCK_SPACE } else { 0.0 };
    let scale = if style.shows(Overlay::Scale) { SCALE_SPACE } else { 0.0 };
    if legend.fits(width - (clock + scale) * metrics.font_size, metrics) {
        return (None, 0.0);
    }
    let height = legend.height(width, metrics);
    (Some(legend), height)
}

/// The space of the clock in a strip, in font sizes.
const CLOCK_SPACE: f64 = 8.0;

/// The space of the scale bar in a strip, in font sizes.
const SCALE_SPACE: f64 = 11.0;

/// Draws the time and returns the right end of its space, which is wide enough for four digits of seconds so that the
/// following elements do not move.
fn clock(time: f64, strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) -> f64 {
    let format = context.view.style.time_format;
    let text = |number: &str| Line::plain(&format!("𝑡 = {number} {}", format.unit()), context.metrics.font_size);
    let line = text(&format.number(time));
    let widest = text(&format!("8888{}", format.number(0.0).trim_start_matches('0').replace('0', "8"))).width;
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
    let label = Line::math(&Unit::METRE.format(length, 1), 0.85 * text);
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
    /// The hatching of the colours.
    pub hatching: Hatching,
    /// Text before the colours; may be empty.
    pub prefix: String,
    /// Text after the colours, as markup for [`Line::math`].
    pub name: String,
}

impl Entry {
    /// An entry of one colour with a plain-text name.
    pub fn new(color: Color, name: &str) -> Entry {
        Entry { colors: vec![color], hatching: Hatching::None, prefix: String::new(), name: quoted(name) }
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
                let entry = |name: &String| {
                    let hatching = Hatching::of_material(name, style);
                    Entry { hatching, ..Entry::new(color::color_by_material(name, style), name) }
                };
                style.materials.iter().map(entry).collect()
            }
            ColorBy::Speed => vec![speed_scale(style.top_speed)],
        };
        Legend { entries }
    }

    /// Draws the legend in a strip: in one row, in a smaller font if necessary, or else in as many rows as it needs.
    pub fn draw(&self, strip: &Rect, alignment: Alignment, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        let (size, rows) = self.rows(strip.width(), metrics);
        let row_height = if rows.len() > 1 { row_height(size) } else { strip.height() };
        for (number, row) in rows.iter().enumerate() {
            let origin = strip.origin.add(Vector::new(0.0, number as f64 * row_height));
            let row_strip = Rect::new(origin, strip.width(), row_height);
            let free_width = strip.width() - row_width(row, size);
            let mut x = match alignment {
                Alignment::Right => strip.origin.x + free_width,
                Alignment::Center => strip.origin.x + free_width / 2.0,
            };
            x = if free_width < 0.0 { strip.origin.x } else { x.round() };
            for entry in *row {
                entry.draw(x, size, &row_strip, metrics, shapes);
                x += entry.width(size) + entry_gap(size);
            }
        }
    }

    /// Returns true if the legend fits in one row of `width` px.
    pub fn fits(&self, width: f64, metrics: &DrawingMetrics) -> bool {
        self.rows(width, metrics).1.len() <= 1
    }

    /// The height of the legend in rows of `width` px, px.
    pub fn height(&self, width: f64, metrics: &DrawingMetrics) -> f64 {
        let (size, rows) = self.rows(width, metrics);
        rows.len() as f64 * row_height(size)
    }

    /// The font size of the legend and its rows of at most `width` px.
    fn rows(&self, width: f64, metrics: &DrawingMetrics) -> (f64, Vec<&[Entry]>) {
        let sizes = [0.85, 0.7, 0.6].map(|size| size * metrics.font_size);
        if let Some(size) = sizes.into_iter().find(|&size| row_width(&self.entries, size) <= width) {
            return (size, vec![&self.entries]);
        }
        let (size, mut rows, mut start) = (sizes[1], Vec::new(), 0);
        for end in 1..=self.entries.len() {
            let is_full = end == self.entries.len() || row_width(&self.entries[start..=end], size) > width;
            if is_full {
                rows.push(&self.entries[start..end]);
                start = end;
            }
        }
        (size, rows)
    }
}

/// The width of entries side by side, px.
fn row_width(entries: &[Entry], size: f64) -> f64 {
    let widths: f64 = entries.iter().map(|entry| entry.width(size) + entry_gap(size)).sum();
    if widths > 0.0 { widths - entry_gap(size) } else { 0.0 }
}

/// The height of one of several rows, px.
fn row_height(size: f64) -> f64 {
    (1.5 * size).ceil()
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
    let name = Unit::METRE_PER_SECOND.format(top, 3);
    Entry { colors: SPEED_COLORS.to_vec(), hatching: Hatching::None, prefix: "0".to_owned(), name }
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
            self.hatching.draw(&rect, color, metrics, shapes);
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
