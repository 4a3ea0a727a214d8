use super::font::{Font, UNITS_PER_EM};

/// A line of text laid out: which glyphs stand where.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it says.
    pub text: String,
    /// Its glyphs, from left to right.
    pub glyphs: Vec<Glyph>,
    /// How far a text after it would stand from its start, px.
    pub width: f64,
    /// Height of the letters' em, px.
    pub size: f64,
}

/// One glyph of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glyph {
    /// Its number in the font.
    pub id: u16,
    /// From the line's start to its origin, px.
    pub x: f64,
    /// From the line's baseline down to its origin, px.
    pub y: f64,
    /// Height of its em, px.
    pub size: f64,
}

/// Height of capitals and digits over the baseline, em.
pub const CAP_HEIGHT: f64 = 0.657;

impl Line {
    /// The text in upright letters of `size` pixels to the em, as it is.
    pub fn plain(text: &str, size: f64) -> Line {
        let font = Font::embedded();
        let mut glyphs = Vec::with_capacity(text.len());
        let (mut x, mut before) = (0.0, None);
        for id in text.chars().map(|character| font.glyph(character)) {
            x += before.map_or(0.0, |before| font.kerning(before, id));
            glyphs.push(Glyph { id, x: x * size / UNITS_PER_EM, y: 0.0, size });
            x += font.advance(id);
            before = Some(id);
        }
        Line { text: text.to_owned(), glyphs, width: x * size / UNITS_PER_EM, size }
    }

    /// Height of its capitals, px.
    pub fn height(&self) -> f64 {
        CAP_HEIGHT * self.size
    }
}
