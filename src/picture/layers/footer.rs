use super::LayoutContext;
use super::arrows::{self, Arrow, ArrowLength};
use super::bodies::Hatching;
use super::dashes::DashPattern;
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::figures::missing_area;
use crate::picture::number::{Unit, nice_spacing};
use crate::picture::raster::color::{self, SPEED_COLORS};
use crate::picture::text::{Line, truncated, wrapped};
use crate::picture::{Color, DrawingMetrics, Frame, Ink, Shape, Style};
use crate::picture::{ColorBy, Language, Overlay, TraceGap};

/// The strips below the world: clock, scale bar and legend in one row, or in rows of their own if the picture is
/// narrow; below them the caption.
pub struct Footer {
    /// Height of a strip, px.
    strip: f64,
    /// The rows of clock and scale bar.
    info: Vec<Vec<Overlay>>,
    legend: Legend,
    /// True if the legend has rows of its own.
    is_below: bool,
    legend_height: f64,
    caption: Option<Caption>,
    width: f64,
    height: f64,
    /// False if an element is wider than the picture or the strips are too high.
    is_legible: bool,
}

impl Footer {
    /// Lays out the strips of a picture.
    pub fn new(style: &Style, metrics: &DrawingMetrics) -> Footer {
        Footer::with_legend(style, metrics, Legend::of(style, metrics))
    }

    /// Lays out the strips of a picture with another legend, such as one with the arrows of smaller panels.
    pub fn with_legend(style: &Style, metrics: &DrawingMetrics, legend: Legend) -> Footer {
        let [width, height] = style.look.size.map(f64::from);
        let strip = larger((smaller(width, height) / 18.0).floor(), (1.5 * metrics.font_size).ceil());
        let free_width = width - 2.0 * metrics.font_size.round();
        let widths = [(Overlay::Clock, clock_width(style, metrics)), (Overlay::Scale, SCALE_SPACE * metrics.font_size)];
        let shown: Vec<(Overlay, f64)> = widths.into_iter().filter(|(overlay, _)| style.shows(*overlay)).collect();
        let info_width: f64 = shown.iter().map(|(_, width)| width + metrics.font_size).sum();
        let info: Vec<Vec<Overlay>> = if info_width - metrics.font_size <= free_width {
            vec![shown.iter().map(|(overlay, _)| *overlay).collect()]
        } else {
            shown.iter().map(|(overlay, _)| vec![*overlay]).collect()
        };
        let is_below = info.len() > 1 || !legend.fits(free_width - info_width, metrics);
        let legend_height = if is_below { legend.height(free_width, metrics) } else { 0.0 };
        let info = if info.iter().all(Vec::is_empty) && is_below { Vec::new() } else { info };
        let caption = Some(&style.look.caption).filter(|caption| !caption.is_empty());
        let caption = caption.map(|caption| Caption::new(caption, [width, height], metrics));
        let mut footer =
            Footer { strip, info, is_legible: true, legend, is_below, legend_height, caption, width, height };
        let is_wide =
            shown.iter().all(|(_, width)| *width <= free_width) && footer.legend.is_within(free_width, metrics);
        let [info_height, caption_height] = footer.heights(style);
        footer.is_legible = is_wide
            && footer.caption.as_ref().is_none_or(|caption| caption.is_legible)
            && info_height + caption_height <= MAX_FOOTER * height;
        footer
    }

    /// The heights of the information and of the caption, px. Without either, 0.
    pub fn heights(&self, style: &Style) -> [f64; 2] {
        let info = if style.has_footer() { self.info.len() as f64 * self.strip + self.legend_height } else { 0.0 };
        let caption = self.caption.as_ref().map_or(0.0, |caption| self.strip + caption.additional_height());
        [info, caption]
    }

    /// Returns false if an element is wider than the picture or the strips are too high.
    pub fn is_legible(&self) -> bool {
        self.is_legible
    }

    /// Draws the strips.
    pub fn draw(self, frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
        let (style, metrics) = (&context.view.style, &context.metrics);
        let [info_height, caption_height] = self.heights(style);
        let bottom = self.height - caption_height;
        if let Some(caption) = self.caption {
            let first = Rect::new(Vector::new(0.0, bottom), self.width, self.strip);
            // The baseline does not depend on the size.
            let y = baseline(&Line::plain("", metrics.font_size), &first);
            caption.draw(self.width / 2.0, y, Ink::from(metrics.palette.ink), shapes);
        }
        if !style.has_footer() {
            return;
        }
        let margin = metrics.font_size.round();
        let mut top = bottom - info_height;
        let mut row = Rect::new(Vector::new(margin, top), self.width - 2.0 * margin, self.strip);
        let mut x = margin;
        for overlays in &self.info {
            (row, x) = (Rect::new(Vector::new(margin, top), row.width(), self.strip), margin);
            for overlay in overlays {
                x = match overlay {
                    Overlay::Clock => clock(frame.time, &row, context, shapes),
                    _ => scale_bar(x, &row, context, shapes),
                } + metrics.font_size;
            }
            top += self.strip;
        }
        if self.is_below {
            let block = Rect::new(Vector::new(margin, top), row.width(), self.legend_height);
            self.legend.draw(&block, Alignment::Center, metrics, shapes);
        } else {
            let rest = Rect::new(Vector::new(x, row.origin.y), row.far_corner().x - x, row.height());
            self.legend.draw(&rest, Alignment::Right, metrics, shapes);
        }
    }
}

/// The largest part of the height of a picture that the strips may take.
const MAX_FOOTER: f64 = 0.6;

/// A caption in one or more lines, and its height.
pub struct Caption {
    lines: Vec<Line>,
    /// Distance of baselines, px.
    spacing: f64,
    /// True if it takes at most a third of the height of the page.
    pub is_legible: bool,
}

impl Caption {
    /// Lays out a caption for a page of `size` px: as large as possible with at most a third of the page's height.
    pub fn new(text: &str, [width, height]: [f64; 2], metrics: &DrawingMetrics) -> Caption {
        let caption = |part: f64| {
            let size = metrics.text(part);
            let lines = wrapped(text, size, width - metrics.font_size);
            let spacing = (1.3 * size).ceil();
            let is_legible = lines.len() as f64 * spacing <= height / 3.0
                && lines.iter().all(|line| line.width <= width - metrics.font_size);
            Caption { lines, spacing, is_legible }
        };
        let [first, second, third, smallest] = [1.0, 0.85, 0.7, 0.6].map(caption);
        [first, second, third].into_iter().find(|caption| caption.is_legible).unwrap_or(smallest)
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

/// The space of the scale bar in a strip, in font sizes.
const SCALE_SPACE: f64 = 11.0;

/// The space of the clock, px: wide enough for four digits of seconds, so that the following elements do not move.
fn clock_width(style: &Style, metrics: &DrawingMetrics) -> f64 {
    let format = style.time_format;
    let eights = format!("8888{}", format.number(0.0).trim_start_matches('0').replace('0', "8"));
    clock_line(&eights, style, metrics).width
}

fn clock_line(number: &str, style: &Style, metrics: &DrawingMetrics) -> Line {
    Line::plain(&format!("𝑡 = {number} {}", style.time_format.unit()), metrics.font_size)
}

/// Draws the time and returns the right end of its space.
fn clock(time: f64, strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) -> f64 {
    let (style, metrics) = (&context.view.style, &context.metrics);
    let line = clock_line(&style.time_format.number(time), style, metrics);
    let width = larger(line.width, clock_width(style, metrics));
    let at = Vector::new(strip.origin.x, baseline(&line, strip));
    shapes.push(Shape::Text { line, at, ink: Ink::from(metrics.palette.ink) });
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
    let label = context.metrics.language.decimal(Unit::METRE.format(length, 1));
    let label = Line::math(&label, context.metrics.text(0.85));
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
    /// An arrow in the first colour instead of the colours.
    pub arrow: Option<KeyArrow>,
    /// A line with these dashes in the first colour instead of the colours.
    pub line: Option<DashPattern>,
}

/// The arrow of a legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyArrow {
    /// Its length, px.
    pub length: f64,
    /// The width of its shaft, px.
    pub width: f64,
    /// The meaning of its length.
    pub kind: ArrowLength,
}

/// The largest number of characters of a name in a legend.
pub const MAX_NAME_CHARS: usize = 40;

/// The largest number of materials in a legend; the others are counted.
const MAX_MATERIALS: usize = 60;

impl Entry {
    /// An entry of one colour with a plain-text name.
    pub fn new(color: Color, name: &str) -> Entry {
        let name = quoted(&truncated(name, MAX_NAME_CHARS));
        Entry { colors: vec![color], hatching: Hatching::None, prefix: String::new(), name, arrow: None, line: None }
    }
}

/// Quotes a name so that [`Line::math`] typesets it unchanged.
pub fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "″"))
}

impl Legend {
    /// The legend of frames: the box colours, unless boxes are coloured individually, the lengths of arrows and the
    /// missing steps.
    pub fn of(style: &Style, metrics: &DrawingMetrics) -> Legend {
        let mut entries = Legend::of_colors(style).entries;
        entries.extend(marks(style, metrics));
        Legend { entries }
    }

    /// The legend of the box colours of `style`; empty if boxes are coloured individually.
    pub fn of_colors(style: &Style) -> Legend {
        let entries = match style.look.color_by {
            ColorBy::Body => Vec::new(),
            ColorBy::Material => {
                let entry = |name: &String| {
                    let hatching = Hatching::of_material(name, style);
                    Entry { hatching, ..Entry::new(color::color_by_material(name, style), name) }
                };
                let mut entries: Vec<Entry> = style.materials.iter().take(MAX_MATERIALS).map(entry).collect();
                if let Some(more) = style.materials.len().checked_sub(MAX_MATERIALS).filter(|more| *more > 0) {
                    let [and, others] = style.look.language.of(["and", "more"], ["et", "autres"]);
                    let name = quoted(&format!("{and} {more} {others}"));
                    entries.push(Entry { colors: Vec::new(), name, ..Entry::new(color::BODY_COLORS[0], "") });
                }
                entries
            }
            ColorBy::Speed => vec![speed_scale(style)],
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

    /// Returns true if no entry is wider than `width` px.
    pub fn is_within(&self, width: f64, metrics: &DrawingMetrics) -> bool {
        let (size, rows) = self.rows(width, metrics);
        rows.iter().all(|row| row_width(row, size) <= width)
    }

    /// Returns true if the legend fits in one row of `width` px.
    pub fn fits(&self, width: f64, metrics: &DrawingMetrics) -> bool {
        self.rows(width, metrics).1.len() <= 1 && self.is_within(width, metrics)
    }

    /// The height of the legend in rows of `width` px, px.
    pub fn height(&self, width: f64, metrics: &DrawingMetrics) -> f64 {
        let (size, rows) = self.rows(width, metrics);
        rows.len() as f64 * row_height(size)
    }

    /// The font size of the legend and its rows of at most `width` px.
    fn rows(&self, width: f64, metrics: &DrawingMetrics) -> (f64, Vec<&[Entry]>) {
        let sizes = [0.85, 0.7, 0.6].map(|size| metrics.text(size));
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

/// The legend entries of frames that explain arrows, the mark of the centre of mass and missing steps.
pub fn marks(style: &Style, metrics: &DrawingMetrics) -> Vec<Entry> {
    let (language, color) = (style.look.language, metrics.palette.muted);
    let mut entries = arrows::keys(style, metrics);
    if style.shows(Overlay::Com) {
        let name = quoted(language.of("⊕ centre of mass", "⊕ centre de masse"));
        entries.push(Entry { name, colors: Vec::new(), ..Entry::new(color, "") });
    }
    entries.extend(gap_entries(&style.gaps, language, color));
    entries
}

/// Maximum number of gaps with an entry of their own in a legend.
const MAX_LISTED_GAPS: usize = 3;

/// The legend entries of parts that a recording lacks.
pub fn gap_entries<'a>(gaps: impl IntoIterator<Item = &'a TraceGap>, language: Language, color: Color) -> Vec<Entry> {
    let mut gaps = gaps.into_iter();
    // The reason is never cut, unlike a name.
    let entry = |text: &str| Entry { name: quoted(text), hatching: Hatching::Missing, ..Entry::new(color, "") };
    let listed = gaps.by_ref().take(MAX_LISTED_GAPS).map(|gap| entry(&gap_text(gap, language)));
    let mut entries: Vec<Entry> = listed.collect();
    match gaps.count() {
        0 => {}
        more => entries.push(entry(&format!("{more} {}", language.of("more gaps", "autres lacunes")))),
    }
    entries
}

/// The steps of a gap and the reason.
pub fn gap_text(gap: &TraceGap, language: Language) -> String {
    let (first, last) = (gap.steps.start(), gap.steps.end());
    let [step, steps] = language.of(["step", "steps"], ["pas", "pas"]);
    let text = if first == last { format!("{step} {first}") } else { format!("{steps} {first}–{last}") };
    format!("{text} {}", gap.reason.text(language))
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

/// The colour scale from 0 to the top speed, or to a lower speed and all above it.
fn speed_scale(style: &Style) -> Entry {
    let name = match style.color_speed {
        Some(end) => format!("≥ {}", Unit::METRE_PER_SECOND.format(end, 3)),
        None => Unit::METRE_PER_SECOND.format(style.top_speed, 3),
    };
    let name = style.look.language.decimal(name);
    Entry { colors: SPEED_COLORS.to_vec(), prefix: "0".to_owned(), name, ..Entry::new(SPEED_COLORS[0], "") }
}

fn entry_gap(size: f64) -> f64 {
    (1.1 * size).round()
}

fn text_gap(size: f64) -> f64 {
    (0.4 * size).round()
}

/// The length of a line in a legend, px.
fn line_length(size: f64) -> f64 {
    (3.0 * size).round()
}

/// The width of the lines of diagrams and in their legends, in line widths.
pub const LINE_WIDTH: f64 = 1.25;

fn swatch_size(size: f64) -> f64 {
    (0.9 * size).round()
}

impl Entry {
    /// Its width with a font of `size` px, px.
    pub fn width(&self, size: f64) -> f64 {
        let prefix = if self.prefix.is_empty() { 0.0 } else { Line::plain(&self.prefix, size).width + text_gap(size) };
        let mark = match (self.arrow, self.line) {
            (Some(arrow), _) => arrow.length,
            (None, Some(_)) => line_length(size),
            (None, None) => swatch_size(size) * self.colors.len() as f64,
        };
        (prefix + mark + text_gap(size) + Line::math(&self.name, size).width).ceil()
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
        if let (Some(KeyArrow { length, width, kind }), Some(&color)) = (self.arrow, self.colors.first()) {
            let from = Vector::new(x, strip.center().y.round());
            let to = from.add(Vector::new(length, 0.0));
            Arrow { length: kind, ..Arrow::new(from, to, width, color) }.draw(metrics, shapes);
            x += length;
        } else if let (Some(dashes), Some(&color)) = (self.line, self.colors.first()) {
            let from = Vector::new(x, strip.center().y.round());
            let to = from.add(Vector::new(line_length(size), 0.0));
            shapes.extend(dashes.draw(vec![from, to], LINE_WIDTH * metrics.line_width, color.into()));
            x += line_length(size);
        }
        for &color in self.colors.iter().filter(|_| self.arrow.is_none() && self.line.is_none()) {
            let corner = Vector::new(x, (strip.center().y - swatch_size(size) / 2.0).round());
            let rect = Rect::new(corner, swatch_size(size), swatch_size(size));
            if self.hatching == Hatching::Missing {
                shapes.extend(missing_area(&rect, 3.0 * metrics.line_width, metrics));
            } else {
                shapes.push(Shape::Rect { rect, ink: Ink::from(color) });
                self.hatching.draw(&rect, color, metrics, shapes);
            }
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
