use super::font::{Font, UNITS_PER_EM};

/// A line of text with the positions of its glyphs.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The text.
    pub text: String,
    /// The glyphs, from left to right.
    pub glyphs: Vec<Glyph>,
    /// Advance width of the line, px.
    pub width: f64,
    /// Font size, px.
    pub size: f64,
}

/// One glyph of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glyph {
    /// Glyph number in the font.
    pub id: u16,
    /// Origin, px to the right of the line's start.
    pub x: f64,
    /// Origin, px below the line's baseline.
    pub y: f64,
    /// Font size, px.
    pub size: f64,
}

/// Height of capitals and digits above the baseline, em.
pub const CAP_HEIGHT: f64 = 0.657;

impl Line {
    /// Lays out plain text in upright letters with a font size of `size` px.
    pub fn plain(text: &str, size: f64) -> Line {
        let font = Font::embedded();
        let mut glyphs = Vec::with_capacity(text.len());
        let (mut x, mut previous) = (0.0, None);
        for id in text.chars().map(|character| font.glyph(character)) {
            x += previous.map_or(0.0, |previous| font.kerning(previous, id));
            glyphs.push(Glyph { id, x: x * size / UNITS_PER_EM, y: 0.0, size });
            x += font.advance(id);
            previous = Some(id);
        }
        Line { text: text.to_owned(), glyphs, width: x * size / UNITS_PER_EM, size }
    }

    /// Height of the capitals, px.
    pub fn height(&self) -> f64 {
        CAP_HEIGHT * self.size
    }
}
