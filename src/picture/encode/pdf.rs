//! Writes display lists as PDF files, for Beamer and print.

use crate::physics::Vector;
use crate::picture::raster::{distinct_bitmaps, simplified};
use crate::picture::text::{Font, Glyph, Line, UNITS_PER_EM, plain_letter};
use crate::picture::{Bitmap, Color, DisplayList, Ink, Metadata, RenderError, Shape};
use pdf_writer::types::{CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::sync::Arc;
use subsetter::GlyphRemapper;

/// A pixel is 1/96 inch, as in SVG; a point is 1/72 inch.
const POINTS_PER_PIXEL: f32 = 0.75;

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const INFO: Ref = Ref::new(5);
const FONT: Ref = Ref::new(6);
const CID_FONT: Ref = Ref::new(7);
const FONT_DESCRIPTOR: Ref = Ref::new(8);
const FONT_FILE: Ref = Ref::new(9);
const CHARACTERS: Ref = Ref::new(10);

/// The name of the font in the resources of the page.
const FONT_NAME: Name = Name(b"F");

/// Writes a display list as a PDF file of one page. Text is text in an embedded font, which contains the glyphs in use.
///
/// # Errors
/// If writing to `output` fails.
pub fn encode(list: &DisplayList, metadata: &Metadata, mut output: impl Write) -> Result<(), RenderError> {
    let [width, height] = list.size.map(|side| side as f32 * POINTS_PER_PIXEL);
    let opacities = opacities(list);
    let font = EmbeddedFont::of(list);
    let mut pdf = Pdf::new();
    let mut catalog = pdf.catalog(CATALOG);
    catalog.pages(PAGES).lang(TextStr("en"));
    catalog.viewer_preferences().display_doc_title(true);
    catalog.finish();
    pdf.pages(PAGES).kids([PAGE]).count(1);
    let mut page = pdf.page(PAGE);
    page.parent(PAGES).media_box(Rect::new(0.0, 0.0, width, height)).contents(CONTENT);
    let mut resources = page.resources();
    let mut states = resources.ext_g_states();
    for &opacity in &opacities {
        let alpha = f32::from(opacity) / 255.0;
        states
            .insert(Name(opacity_name(opacity).as_bytes()))
            .start::<pdf_writer::writers::ExtGraphicsState>()
            .non_stroking_alpha(alpha)
            .stroking_alpha(alpha);
    }
    states.finish();
    if !font.is_empty() {
        resources.fonts().pair(FONT_NAME, FONT);
    }
    let images = distinct_bitmaps(list);
    if !images.is_empty() {
        let mut objects = resources.x_objects();
        for number in 0..images.len() {
            objects.pair(Name(image_name(number).as_bytes()), image_refs(number)[0]);
        }
        objects.finish();
    }
    resources.finish();
    page.finish();
    let compressed = compress(&content(list, height, &font, &images));
    pdf.stream(CONTENT, &compressed).filter(Filter::FlateDecode);
    if !font.is_empty() {
        font.write(&mut pdf);
    }
    for (number, bitmap) in images.iter().enumerate() {
        write_image(&mut pdf, image_refs(number), bitmap);
    }
    let mut info = pdf.document_info(INFO);
    for (key, value) in &metadata.entries {
        info.insert(Name(key.as_bytes())).primitive(TextStr(value));
    }
    info.finish();
    output.write_all(&pdf.finish())?;
    Ok(())
}

/// The objects of an image and of its opacity, after all others.
fn image_refs(number: usize) -> [Ref; 2] {
    let first = CHARACTERS.get() + 1 + 2 * number as i32;
    [Ref::new(first), Ref::new(first + 1)]
}

fn image_name(number: usize) -> String {
    format!("I{number}")
}

/// Writes an image and its opacity.
fn write_image(pdf: &mut Pdf, [image, mask]: [Ref; 2], bitmap: &Bitmap) {
    let [width, height] = bitmap.size.map(|side| side as i32);
    let colors: Vec<u8> = bitmap.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let opacities: Vec<u8> = bitmap.pixels.iter().map(|pixel| pixel[3]).collect();
    let (colors, opacities) = (compress(&colors), compress(&opacities));
    let mut object = pdf.image_xobject(image, &colors);
    object.width(width).height(height).bits_per_component(8).filter(Filter::FlateDecode);
    object.color_space().device_rgb();
    object.s_mask(mask);
    object.finish();
    let mut object = pdf.image_xobject(mask, &opacities);
    object.width(width).height(height).bits_per_component(8).filter(Filter::FlateDecode);
    object.color_space().device_gray();
    object.finish();
}

/// Compresses to a zlib stream. The encoder is called directly, so the bytes do not depend on the deflate
/// library that other crates select.
fn compress(content: &[u8]) -> Vec<u8> {
    const LEVEL: u8 = 6;
    miniz_oxide::deflate::compress_to_vec_zlib(content, LEVEL)
}

/// Reads the metadata of a PDF file written by [`encode`], in its order.
///
/// That is one dictionary of strings. Of the crates that parse PDF, lopdf 0.47 would add 39 dependencies, and
/// hayro-syntax 0.9 requires Rust 1.92 and sorts the entries by key.
pub fn metadata(file: &[u8]) -> Metadata {
    let begin = format!("{} 0 obj\n<<", INFO.get());
    let found = file.windows(begin.len()).rposition(|bytes| bytes == begin.as_bytes());
    let mut rest = found.map_or(&file[..0], |at| &file[at + begin.len()..]);
    let mut entries = Vec::new();
    while let Some((key, after)) = name(rest)
        && let Some((value, after)) = text(after)
    {
        entries.push((key, value));
        rest = after;
    }
    Metadata { entries }
}

/// Parses a name, with escapes such as `#20`, and returns it with the rest of the text.
fn name(text: &[u8]) -> Option<(String, &[u8])> {
    let mut rest = text.trim_ascii_start().strip_prefix(b"/")?;
    let mut name = Vec::new();
    while let [byte, after @ ..] = rest {
        (rest, _) = match *byte {
            b' ' | b'(' | b'<' | b'\n' => break,
            b'#' => {
                name.extend(hexadecimal(after.get(..2)?)?);
                (&after[2..], ())
            }
            other => {
                name.push(other);
                (after, ())
            }
        };
    }
    Some((String::from_utf8(name).ok()?, rest))
}

/// Parses a literal or hexadecimal string and returns it with the rest of the text.
fn text(text: &[u8]) -> Option<(String, &[u8])> {
    let rest = text.trim_ascii_start();
    if let Some(digits) = rest.strip_prefix(b"<") {
        let end = digits.iter().position(|&byte| byte == b'>')?;
        return Some((unicode(&hexadecimal(&digits[..end])?)?, &digits[end + 1..]));
    }
    let (bytes, rest) = literal_string(rest.strip_prefix(b"(")?)?;
    Some((unicode(&bytes)?, rest))
}

/// Parses a literal string after its opening parenthesis.
fn literal_string(mut rest: &[u8]) -> Option<(Vec<u8>, &[u8])> {
    let (mut bytes, mut depth) = (Vec::new(), 0_u32);
    loop {
        let [byte, after @ ..] = rest else { return None };
        rest = after;
        match *byte {
            b')' if depth == 0 => return Some((bytes, rest)),
            b'\\' => {
                let (&escaped, after) = rest.split_first()?;
                rest = after;
                bytes.push(match escaped {
                    b'n' => b'\n',
                    b'r' => b'\r',
                    b't' => b'\t',
                    b'b' => 8,
                    b'f' => 12,
                    other => other,
                });
            }
            other => {
                depth = if other == b'(' { depth + 1 } else { depth - u32::from(other == b')') };
                bytes.push(other);
            }
        }
    }
}

/// Decodes a text string: UTF-16 after a byte order mark, else ASCII.
fn unicode(bytes: &[u8]) -> Option<String> {
    match bytes.strip_prefix(b"\xfe\xff") {
        Some(pairs) => {
            let units: Vec<u16> = pairs.as_chunks::<2>().0.iter().map(|pair| u16::from_be_bytes(*pair)).collect();
            String::from_utf16(&units).ok()
        }
        None => String::from_utf8(bytes.to_vec()).ok(),
    }
}

fn hexadecimal(digits: &[u8]) -> Option<Vec<u8>> {
    let text = std::str::from_utf8(digits).ok()?;
    (0..text.len() / 2).map(|at| u8::from_str_radix(text.get(2 * at..2 * at + 2)?, 16).ok()).collect()
}

/// The subset of the font that a page uses. Its glyphs are numbered in the order of their numbers in the font.
struct EmbeddedFont {
    /// The character of each glyph.
    characters: BTreeMap<u16, char>,
    numbers: GlyphRemapper,
}

impl EmbeddedFont {
    fn of(list: &DisplayList) -> EmbeddedFont {
        let lines = list.leaves().filter_map(|shape| match shape {
            Shape::Text { line, .. } => Some(line),
            _ => None,
        });
        let glyphs = lines.flat_map(|line| &line.glyphs);
        let characters: BTreeMap<u16, char> = glyphs.map(|glyph| (glyph.id, plain_letter(glyph.character))).collect();
        let numbers = GlyphRemapper::new_from_glyphs_sorted(&characters.keys().copied().collect::<Vec<u16>>());
        EmbeddedFont { characters, numbers }
    }

    fn is_empty(&self) -> bool {
        self.characters.is_empty()
    }

    /// The number of a glyph in the subset, as text of a content stream.
    fn code(&self, glyph: u16) -> [u8; 2] {
        self.numbers.get(glyph).unwrap_or(0).to_be_bytes()
    }

    /// Writes the font: its glyphs, their widths and the characters that they show.
    fn write(&self, pdf: &mut Pdf) {
        const NAME: Name = Name(b"RBNDAA+STIXTwoMath-Regular");
        const CODES: Name = Name(b"RBND-Characters");
        let system = || SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
        let mut font = pdf.type0_font(FONT);
        font.base_font(NAME).encoding_predefined(Name(b"Identity-H"));
        font.descendant_font(CID_FONT).to_unicode(CHARACTERS);
        font.finish();
        let mut cid_font = pdf.cid_font(CID_FONT);
        cid_font.subtype(CidFontType::Type2).base_font(NAME).system_info(system());
        cid_font.font_descriptor(FONT_DESCRIPTOR).default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
        let advances = self.numbers.remapped_gids().map(|glyph| Font::embedded().advance(glyph) as f32);
        cid_font.widths().consecutive(0, advances);
        cid_font.finish();
        let mut descriptor = pdf.font_descriptor(FONT_DESCRIPTOR);
        descriptor.name(NAME).flags(FontFlags::SYMBOLIC | FontFlags::SERIF);
        descriptor.bbox(Rect::new(-500.0, -300.0, 2000.0, 1000.0)).italic_angle(0.0);
        descriptor.ascent(762.0).descent(-238.0).cap_height(657.0).stem_v(68.0).font_file2(FONT_FILE);
        descriptor.finish();
        let subset = subsetter::subset(Font::FILE, 0, &self.numbers).expect("the embedded font is valid");
        pdf.stream(FONT_FILE, &compress(&subset))
            .filter(Filter::FlateDecode)
            .pair(Name(b"Length1"), subset.len() as i32);
        let mut characters: UnicodeCmap = UnicodeCmap::new(CODES, system());
        for (&glyph, &character) in &self.characters {
            characters.pair(self.numbers.get(glyph).unwrap_or(0), character);
        }
        pdf.stream(CHARACTERS, &compress(characters.finish().as_slice())).filter(Filter::FlateDecode);
    }
}

fn opacities(list: &DisplayList) -> BTreeSet<u8> {
    let inks = list.leaves().filter_map(|shape| match shape {
        Shape::Rect { ink, .. } | Shape::Polygon { ink, .. } => Some(ink),
        Shape::Polyline { ink, .. } | Shape::Text { ink, .. } => Some(ink),
        Shape::Clip { .. } | Shape::Image { .. } => None,
    });
    let of_images = list.leaves().filter_map(|shape| match shape {
        Shape::Image { opacity, .. } => Some(*opacity),
        _ => None,
    });
    inks.map(|ink| ink.opacity).chain(of_images).chain([255]).collect()
}

fn opacity_name(opacity: u8) -> String {
    format!("a{opacity}")
}

/// The content stream. Its first matrix changes the coordinates to pixels with y pointing down.
fn content(list: &DisplayList, height: f32, font: &EmbeddedFont, images: &[Arc<Bitmap>]) -> Vec<u8> {
    let mut content = Content::new();
    content.transform([POINTS_PER_PIXEL, 0.0, 0.0, -POINTS_PER_PIXEL, 0.0, height]);
    content.set_line_join(LineJoinStyle::RoundJoin).set_line_cap(LineCapStyle::RoundCap);
    let mut last = None;
    set_ink(&mut content, Ink::from(list.background), &mut last);
    content.rect(0.0, 0.0, list.size[0] as f32, list.size[1] as f32).fill_nonzero();
    for shape in list.backdrop.iter().chain(&list.shapes) {
        draw_shape(&mut content, shape, font, images, &mut last);
    }
    content.finish().to_vec()
}

fn draw_shape(
    content: &mut Content,
    shape: &Shape,
    font: &EmbeddedFont,
    images: &[Arc<Bitmap>],
    last: &mut Option<Ink>,
) {
    match shape {
        Shape::Rect { rect, ink } => {
            set_ink(content, *ink, last);
            let [x, y, width, height] =
                [rect.origin.x, rect.origin.y, rect.width(), rect.height()].map(|length| length as f32);
            content.rect(x, y, width, height).fill_nonzero();
        }
        Shape::Polygon { points, ink } => {
            set_ink(content, *ink, last);
            draw_points(content, &simplified(points));
            content.close_path().fill_nonzero();
        }
        Shape::Polyline { points, width, ink } => {
            set_ink(content, *ink, last);
            content.set_line_width(*width as f32);
            draw_points(content, &simplified(points));
            content.stroke();
        }
        Shape::Clip { window, shapes } => draw_clip(content, window, shapes, font, images, last),
        Shape::Text { line, at, ink } => {
            set_ink(content, *ink, last);
            if line.text.is_empty() {
                // Decoration: readers and searches find no text here.
                content.begin_marked_content_with_properties(Name(b"Span")).properties().actual_text(TextStr(""));
                show_line(content, line, *at, font);
                content.end_marked_content();
            } else {
                show_line(content, line, *at, font)
            }
        }
        Shape::Image { bitmap, rect, opacity } => {
            let number = images.iter().position(|image| image == bitmap).unwrap_or(0);
            let [x, y, width, height] =
                [rect.origin.x, rect.origin.y, rect.width(), rect.height()].map(|length| length as f32);
            content.save_state();
            content.set_parameters(Name(opacity_name(*opacity).as_bytes()));
            // An image fills the unit square with its first row at the top, at y = 1.
            content.transform([width, 0.0, 0.0, -height, x, y + height]);
            content.x_object(Name(image_name(number).as_bytes()));
            content.restore_state();
        }
    }
}

fn draw_clip(
    content: &mut Content,
    window: &crate::physics::Rect,
    shapes: &[Shape],
    font: &EmbeddedFont,
    images: &[Arc<Bitmap>],
    last: &mut Option<Ink>,
) {
    let [x, y, width, height] =
        [window.origin.x, window.origin.y, window.width(), window.height()].map(|length| length.round() as f32);
    content.save_state();
    content.rect(x, y, width, height).clip_nonzero().end_path();
    let outer = *last;
    shapes.iter().for_each(|shape| draw_shape(content, shape, font, images, last));
    content.restore_state();
    *last = outer;
}

/// Sets the colour and opacity of the following shapes unless they are already set.
fn set_ink(content: &mut Content, ink: Ink, last: &mut Option<Ink>) {
    if *last == Some(ink) {
        return;
    }
    let [r, g, b] = components(ink.color);
    content.set_fill_rgb(r, g, b).set_stroke_rgb(r, g, b);
    content.set_parameters(Name(opacity_name(ink.opacity).as_bytes()));
    *last = Some(ink);
}

fn components(color: Color) -> [f32; 3] {
    [color.r, color.g, color.b].map(|component| f32::from(component) / 255.0)
}

fn draw_points(content: &mut Content, points: &[Vector]) {
    for (index, point) in points.iter().enumerate() {
        let (x, y) = (point.x as f32, point.y as f32);
        if index == 0 {
            content.move_to(x, y)
        } else {
            content.line_to(x, y)
        };
    }
}

/// Shows a line as text. Glyphs of one size on one baseline are one string, whose positions are corrected where they
/// differ from the advance widths.
fn show_line(content: &mut Content, line: &Line, at: Vector, font: &EmbeddedFont) {
    content.begin_text();
    for run in line.glyphs.chunk_by(|a, b| (a.size, a.y) == (b.size, b.y)) {
        let Some(first) = run.first() else { continue };
        let size = first.size as f32;
        content.set_font(FONT_NAME, 1.0);
        content.set_text_matrix([size, 0.0, 0.0, -size, (at.x + first.x) as f32, (at.y + first.y) as f32]);
        let mut shown = content.show_positioned();
        let mut items = shown.items();
        let mut string: Vec<u8> = Vec::new();
        let mut next = first.x;
        for Glyph { id, x, size, .. } in run {
            // Thousandths of the font size, to the left.
            let correction = (next - x) * UNITS_PER_EM / size;
            if correction.abs() > 0.5 {
                items.show(Str(&std::mem::take(&mut string))).adjust(correction.round() as f32);
                next -= correction.round() * size / UNITS_PER_EM;
            }
            string.extend(font.code(*id));
            next += Font::embedded().advance(*id) * size / UNITS_PER_EM;
        }
        items.show(Str(&string));
    }
    content.end_text();
}

#[cfg(test)]
mod tests {
    use super::*;
    use skrifa::instance::{LocationRef, Size};
    use skrifa::{FontRef, GlyphId, MetadataProvider};

    fn list(markup: &str) -> DisplayList {
        let line = Line::math(markup, 20.0);
        let ink = Color::hex(0).into();
        let at = Vector::new(5.0, 30.0);
        let halo = Shape::Text { line: line.without_text(), at, ink };
        let background = Color::hex(0xffffff);
        DisplayList { size: [300, 60], background, backdrop: vec![halo], shapes: vec![Shape::Text { line, at, ink }] }
    }

    #[test]
    fn the_embedded_font_has_the_glyphs_in_use_and_maps_them_to_plain_letters() {
        let list = list("v⃗_c = 5 \"m/s\", ΔE");
        let font = EmbeddedFont::of(&list);
        let file = subsetter::subset(Font::FILE, 0, &font.numbers).unwrap();
        assert!(file.len() < Font::FILE.len() / 10, "{} bytes", file.len());
        let subset = FontRef::new(&file).unwrap();
        let advances = subset.glyph_metrics(Size::unscaled(), LocationRef::default());
        for (&glyph, &character) in &font.characters {
            let number = u16::from_be_bytes(font.code(glyph));
            assert!(number > 0, "{character}");
            let advance = advances.advance_width(GlyphId::from(number)).map(f64::from);
            assert_eq!(advance, Some(Font::embedded().advance(glyph)), "{character}");
        }
        let characters: BTreeSet<char> = font.characters.values().copied().collect();
        assert_eq!(characters, "v\u{20d7}c =5m/s,ΔE".chars().collect());
    }

    #[test]
    fn the_text_of_a_page_is_shown_once_and_its_halo_has_none() {
        let list = list("abc");
        let font = EmbeddedFont::of(&list);
        let content = content(&list, 45.0, &font, &[]);
        let count = |word: &[u8]| content.windows(word.len()).filter(|bytes| *bytes == word).count();
        assert_eq!([count(b"BT"), count(b"/ActualText"), count(b"EMC")], [2, 1, 1]);
    }

    #[test]
    fn a_page_without_text_has_no_font() {
        let mut file = Vec::new();
        let empty = DisplayList { backdrop: Vec::new(), shapes: Vec::new(), ..list("") };
        encode(&empty, &Metadata::default(), &mut file).unwrap();
        assert!(!file.windows(5).any(|bytes| bytes == b"/Font"));
    }

    #[test]
    fn metadata_is_read_back() {
        let entries = [("rebond steps", "0 to 600"), (Metadata::TITLE, "v⃗ = (−Δx/Δt)"), ("a b", "\\")];
        let metadata = Metadata { entries: entries.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec() };
        let mut written = Vec::new();
        encode(&list("abc"), &metadata, &mut written).unwrap();
        assert_eq!(super::metadata(&written), metadata);
    }
}
