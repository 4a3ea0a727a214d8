//! Writes display lists as SVG files, for slides and print.

use crate::physics::{Rect, Vector, larger};
use crate::picture::number::Hundredths;
use crate::picture::raster::{distinct_bitmaps, simplified};
use crate::picture::text::{Font, Glyph, Line, PathSegment, UNITS_PER_EM};
use crate::picture::{Bitmap, DisplayList, Ink, Metadata, RenderError, Shape, TextAs, png};
use crate::text::Escaped;
use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter};
use std::io::Write;
use std::sync::Arc;

/// Writes a display list as a self-contained SVG file.
///
/// Text as outlines has the same words as invisible text over the outlines, which can be selected and searched.
///
/// # Errors
/// If writing to `output` fails.
pub fn encode(
    list: &DisplayList,
    metadata: &Metadata,
    text: TextAs,
    mut output: impl Write,
) -> Result<(), RenderError> {
    let [width, height] = list.size;
    writeln!(
        output,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\" aria-labelledby=\"title\" aria-describedby=\"desc\">"
    )?;
    writeln!(output, "<title id=\"title\">{}</title>", Escaped(metadata.get(Metadata::TITLE).unwrap_or("Picture")))?;
    writeln!(output, "<desc id=\"desc\">{}</desc>", Escaped(metadata.get(Metadata::DESCRIPTION).unwrap_or("")))?;
    if !metadata.entries.is_empty() {
        writeln!(output, "<metadata>{}</metadata>", Escaped(&metadata.to_string()))?;
    }
    if text == TextAs::Outlines {
        encode_glyphs(list, &mut output)?;
    }
    let images = distinct_bitmaps(list);
    encode_images(&images, &mut output)?;
    writeln!(output, "<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", list.background)?;
    encode_shapes(list.backdrop.iter().chain(&list.shapes), text, &images, &mut output)?;
    writeln!(output, "</svg>")?;
    Ok(())
}

/// Writes a definition of every image.
fn encode_images(images: &[Arc<Bitmap>], output: &mut impl Write) -> Result<(), RenderError> {
    if images.is_empty() {
        return Ok(());
    }
    writeln!(output, "<defs>")?;
    for (number, bitmap) in images.iter().enumerate() {
        let [width, height] = bitmap.size;
        let file = png::encode_bitmap(bitmap)?;
        writeln!(
            output,
            "<image id=\"i{number}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
             href=\"data:image/png;base64,{}\"/>",
            Base64(&file)
        )?;
    }
    writeln!(output, "</defs>")?;
    Ok(())
}

/// Writes a use of an image. An enlarged one keeps its sharp pixels, as in raster files.
fn encode_image(
    number: usize,
    bitmap: &Bitmap,
    rect: &Rect,
    opacity: u8,
    output: &mut impl Write,
) -> Result<(), RenderError> {
    let [columns, rows] = bitmap.size.map(f64::from);
    let [scale_x, scale_y] = [rect.width() / columns, rect.height() / rows];
    let sharp = if scale_x >= 1.0 && scale_y >= 1.0 { " style=\"image-rendering:pixelated\"" } else { "" };
    let opacity = if opacity == 255 { String::new() } else { format!(" opacity=\"{}\"", f32::from(opacity) / 255.0) };
    let [x, y] = [rect.origin.x, rect.origin.y].map(Hundredths);
    writeln!(
        output,
        "<use href=\"#i{number}\" transform=\"translate({x} {y}) scale({scale_x} {scale_y})\"{opacity}{sharp}/>"
    )?;
    Ok(())
}

/// Binary data in the alphabet of RFC 4648. No dependency has the crate base64, of which this is a single function.
struct Base64<'a>(&'a [u8]);

impl Display for Base64<'_> {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut text = String::with_capacity(self.0.len().div_ceil(3) * 4);
        for bytes in self.0.chunks(3) {
            let at = |index: usize| u32::from(bytes.get(index).copied().unwrap_or(0));
            let bits = at(0) << 16 | at(1) << 8 | at(2);
            for digit in 0..4 {
                let is_padding = digit > bytes.len();
                let value = DIGITS[(bits >> (18 - 6 * digit) & 63) as usize];
                text.push(if is_padding { '=' } else { char::from(value) });
            }
        }
        out.write_str(&text)
    }
}

/// Reads the metadata of an SVG file written by [`encode`].
pub fn metadata(file: &[u8]) -> Metadata {
    let text = String::from_utf8_lossy(file);
    let begin = text.split_once("<metadata>").map_or("", |(_, rest)| rest);
    let escaped = begin.split_once("</metadata>").map_or("", |(content, _)| content);
    let plain = escaped.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    Metadata::parse(&plain)
}

/// Writes a definition of every used glyph, in font units with y pointing up.
fn encode_glyphs(list: &DisplayList, output: &mut impl Write) -> Result<(), RenderError> {
    let lines = list.leaves().filter_map(|shape| match shape {
        Shape::Text { line, .. } => Some(line),
        _ => None,
    });
    let used: BTreeSet<u16> = lines.flat_map(|line| line.glyphs.iter().map(|glyph| glyph.id)).collect();
    writeln!(output, "<defs>")?;
    for id in used {
        write!(output, "<path id=\"g{id}\" d=\"")?;
        Font::embedded().outline(id).iter().try_for_each(|segment| write!(output, "{}", PathData(segment)))?;
        writeln!(output, "\"/>")?;
    }
    writeln!(output, "</defs>")?;
    Ok(())
}

/// Writes shapes. The copies of a label that are its halo precede it; with text as text they are a stroke of the label,
/// so that it can be edited.
fn encode_shapes<'a>(
    shapes: impl Iterator<Item = &'a Shape>,
    text: TextAs,
    images: &[Arc<Bitmap>],
    output: &mut impl Write,
) -> Result<(), RenderError> {
    let mut halo = None;
    for shape in shapes {
        match shape {
            Shape::Text { line, at, ink } if text == TextAs::Text => {
                if line.text.is_empty() {
                    halo = Some((*at, *ink));
                } else {
                    let stroke = halo.take().map(|(copy, ink): (Vector, Ink)| (2.0 * copy.sub(*at).norm(), ink));
                    encode_text(line, *at, *ink, stroke, output)?;
                }
            }
            shape => encode_shape(shape, text, images, output)?,
        }
    }
    Ok(())
}

fn encode_shape(
    shape: &Shape,
    text: TextAs,
    images: &[Arc<Bitmap>],
    output: &mut impl Write,
) -> Result<(), RenderError> {
    match shape {
        Shape::Rect { rect, ink } => writeln!(
            output,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>",
            Hundredths(rect.origin.x),
            Hundredths(rect.origin.y),
            Hundredths(rect.width()),
            Hundredths(rect.height()),
            Fill(*ink)
        )?,
        Shape::Polygon { points, ink } => {
            writeln!(output, "<polygon points=\"{}\"{}/>", Points(&simplified(points)), Fill(*ink))?;
        }
        Shape::Polyline { points, width, ink } => writeln!(
            output,
            "<polyline points=\"{}\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" stroke-width=\"{}\"{}/>",
            Points(&simplified(points)),
            Hundredths(*width),
            Stroke(*ink)
        )?,
        Shape::Clip { window, shapes } => encode_clip(window, shapes, text, images, output)?,
        Shape::Text { line, at, ink } => {
            encode_outlines(line, *at, *ink, output)?;
            if !line.text.is_empty() {
                encode_hidden_text(line, *at, output)?;
            }
        }
        Shape::Image { bitmap, rect, opacity } => {
            let number = images.iter().position(|image| image == bitmap).unwrap_or(0);
            encode_image(number, bitmap, rect, *opacity, output)?;
        }
    }
    Ok(())
}

/// Writes a nested `svg` element, which clips its content.
fn encode_clip(
    window: &Rect,
    shapes: &[Shape],
    text: TextAs,
    images: &[Arc<Bitmap>],
    output: &mut impl Write,
) -> Result<(), RenderError> {
    let [x, y, width, height] = [window.origin.x, window.origin.y, window.width(), window.height()].map(f64::round);
    writeln!(
        output,
        "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" viewBox=\"{x} {y} {width} {height}\">"
    )?;
    encode_shapes(shapes.iter(), text, images, output)?;
    writeln!(output, "</svg>")?;
    Ok(())
}

/// Writes the glyphs of a line.
fn encode_outlines(line: &Line, at: Vector, ink: Ink, output: &mut impl Write) -> Result<(), RenderError> {
    writeln!(output, "<g{}>", Fill(ink))?;
    for glyph in line.glyphs.iter().filter(|glyph| !glyph.character.is_whitespace()) {
        let scale = glyph.size / UNITS_PER_EM;
        writeln!(
            output,
            "<use href=\"#g{}\" transform=\"translate({} {}) scale({scale} {})\"/>",
            glyph.id,
            Hundredths(at.x + glyph.x),
            Hundredths(at.y + glyph.y),
            -scale
        )?;
    }
    writeln!(output, "</g>")?;
    Ok(())
}

/// Writes the words of a line as transparent text of the same length, whatever font the reader has. Text without a fill
/// could not be selected.
fn encode_hidden_text(line: &Line, at: Vector, output: &mut impl Write) -> Result<(), RenderError> {
    writeln!(
        output,
        "<text x=\"{}\" y=\"{}\" font-family=\"serif\" font-size=\"{}\" textLength=\"{}\" \
         lengthAdjust=\"spacingAndGlyphs\" fill-opacity=\"0\">{}</text>",
        Hundredths(at.x),
        Hundredths(at.y),
        Hundredths(line.size),
        Hundredths(larger(line.width, 0.01)),
        Escaped(&line.text)
    )?;
    Ok(())
}

/// Fonts for text that the reader's program sets, the best one first.
const FONT_FAMILY: &str = "'STIX Two Math', 'STIX Two Text', STIXGeneral, 'Cambria Math', serif";

/// Writes a line as text, over a stroke of a width (px) and an ink if it has a halo. Glyphs of one size on one baseline
/// are one run, with its length in the font of rebond.
fn encode_text(
    line: &Line,
    at: Vector,
    ink: Ink,
    halo: Option<(f64, Ink)>,
    output: &mut impl Write,
) -> Result<(), RenderError> {
    write!(output, "<text font-family=\"{FONT_FAMILY}\" xml:space=\"preserve\"{}", Fill(ink))?;
    if let Some((width, ink)) = halo {
        let (width, stroke) = (Hundredths(width), Stroke(ink));
        write!(output, " paint-order=\"stroke\"{stroke} stroke-width=\"{width}\" stroke-linejoin=\"round\"")?;
    }
    write!(output, ">")?;
    let runs: Vec<&[Glyph]> = line.glyphs.chunk_by(|a, b| (a.size, a.y) == (b.size, b.y)).collect();
    for run in runs {
        let (Some(first), Some(last)) = (run.first(), run.last()) else { continue };
        let advance = Font::embedded().advance(last.id) * last.size / UNITS_PER_EM;
        let text: String = run.iter().map(|glyph| glyph.character).collect();
        write!(
            output,
            "<tspan x=\"{}\" y=\"{}\" font-size=\"{}\" textLength=\"{}\">{}</tspan>",
            Hundredths(at.x + first.x),
            Hundredths(at.y + first.y),
            Hundredths(first.size),
            Hundredths(larger(last.x + advance - first.x, 0.01)),
            Escaped(&text)
        )?;
    }
    writeln!(output, "</text>")?;
    Ok(())
}

struct Points<'a>(&'a [Vector]);

impl Display for Points<'_> {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        for (index, point) in self.0.iter().enumerate() {
            let space = if index == 0 { "" } else { " " };
            write!(out, "{space}{},{}", Hundredths(point.x), Hundredths(point.y))?;
        }
        Ok(())
    }
}

struct Fill(Ink);

impl Display for Fill {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        write!(out, " fill=\"{}\"", self.0.color)?;
        match self.0.opacity {
            255 => Ok(()),
            opacity => write!(out, " fill-opacity=\"{}\"", f32::from(opacity) / 255.0),
        }
    }
}

struct Stroke(Ink);

impl Display for Stroke {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        write!(out, " stroke=\"{}\"", self.0.color)?;
        match self.0.opacity {
            255 => Ok(()),
            opacity => write!(out, " stroke-opacity=\"{}\"", f32::from(opacity) / 255.0),
        }
    }
}

struct PathData<'a>(&'a PathSegment);

impl Display for PathData<'_> {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        match self.0 {
            PathSegment::Move([x, y]) => write!(out, "M{x} {y}"),
            PathSegment::Line([x, y]) => write!(out, "L{x} {y}"),
            PathSegment::Quadratic([[cx, cy], [x, y]]) => write!(out, "Q{cx} {cy} {x} {y}"),
            PathSegment::Close => write!(out, "Z"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Color;

    fn encoded(shape: Shape, metadata: &Metadata) -> String {
        let list =
            DisplayList { size: [8, 6], background: Color::hex(0xffffff), backdrop: Vec::new(), shapes: vec![shape] };
        let mut file = Vec::new();
        encode(&list, metadata, TextAs::Outlines, &mut file).unwrap();
        String::from_utf8(file).unwrap()
    }

    #[test]
    fn a_rectangle_becomes_a_rect_element() {
        let ink = Ink { color: Color::hex(0x0072b2), opacity: 51 };
        let rect = Rect::new(Vector::new(-0.001, 2.25), 3.0, 1.0);
        let file = encoded(Shape::Rect { rect, ink }, &Metadata::default());
        assert!(
            file.contains("<rect x=\"0\" y=\"2.25\" width=\"3\" height=\"1\" fill=\"#0072b2\" fill-opacity=\"0.2\"/>"),
            "{file}"
        );
    }

    #[test]
    fn text_and_metadata_are_escaped() {
        let line = Line::plain("<\"&\u{1}\">", 10.0);
        let text = Shape::Text { line, at: Vector::ZERO, ink: Ink::from(Color::hex(0)) };
        let entries = vec![("a<b".to_owned(), "c&d".to_owned())];
        let file = encoded(text, &Metadata { entries });
        assert!(file.contains(">&lt;&quot;&amp;&quot;&gt;</text>"), "{file}");
        assert!(file.contains("<metadata>a&lt;b: c&amp;d\n</metadata>"), "{file}");
    }

    #[test]
    fn text_is_outlines_with_hidden_words_or_text_alone() {
        let line = Line::math("v_c = 5 \"m/s\"", 10.0);
        let at = Vector::new(1.0, 5.0);
        let near = at.add(Vector::new(0.0, 1.5));
        let halo = Shape::Text { line: line.without_text(), at: near, ink: Color::hex(0xffffff).into() };
        let label = Shape::Text { line, at, ink: Color::hex(0).into() };
        let list = DisplayList {
            size: [90, 20],
            background: Color::hex(0xffffff),
            backdrop: Vec::new(),
            shapes: vec![halo.clone(), halo, label.clone(), label],
        };
        let title = (Metadata::TITLE.to_owned(), "Energy & momentum".to_owned());
        let metadata = Metadata { entries: vec![title, (Metadata::DESCRIPTION.to_owned(), "Steps 0 to 9".to_owned())] };
        let file = |text| {
            let mut file = Vec::new();
            encode(&list, &metadata, text, &mut file).unwrap();
            String::from_utf8(file).unwrap()
        };
        let (outlines, text) = (file(TextAs::Outlines), file(TextAs::Text));
        for file in [&outlines, &text] {
            assert_eq!(file.matches("role=\"img\"").count(), 1);
            assert!(file.contains(">Energy &amp; momentum</title>") && file.contains(">Steps 0 to 9</desc>"), "{file}");
        }
        assert_eq!((outlines.matches("<text").count(), text.matches("<text").count()), (2, 2));
        let stroke = "paint-order=\"stroke\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\"";
        assert_eq!(text.matches(stroke).count(), 1, "{text}");
        assert!(outlines.contains("fill-opacity=\"0\">v_c = 5 m/s</text>") && outlines.contains("<use"), "{outlines}");
        assert!(text.contains(">𝑣</tspan>") && !text.contains("<use") && !text.contains("fill-opacity"), "{text}");
    }

    #[test]
    fn points_on_straight_lines_are_left_out() {
        let points = (0..=100).map(|at| Vector::new(f64::from(at), 0.5 * f64::from(at))).collect();
        let file = encoded(Shape::Polyline { points, width: 1.0, ink: Color::hex(0).into() }, &Metadata::default());
        assert!(file.contains("points=\"0,0 100,50\""), "{file}");
    }
}
