//! Text layout with one embedded font, identical on every machine.
//!
//! Glyph outlines are read with skrifa and filled like any other path; system fonts, hinting and locale have no
//! influence. Lines of Latin and Greek need only pair kerning, so there is no shaper.

mod font;
mod math;

pub use font::{Bounds, Font, PathSegment, UNITS_PER_EM};
pub use math::{plain_letter, wrapped};

/// A line of text with the positions of its glyphs.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The text in plain letters; `_` and `^` precede sub- and superscripts. Empty for decoration, such as a halo, that
    /// is not part of the text of a file.
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
    /// The character that it shows.
    pub character: char,
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
        for (character, id) in text.chars().map(|character| (character, font.glyph(character))) {
            x += previous.map_or(0.0, |previous| font.kerning(previous, id));
            glyphs.push(Glyph { id, character, x: x * size / UNITS_PER_EM, y: 0.0, size });
            x += font.advance(id);
            previous = Some(id);
        }
        Line { text: text.to_owned(), glyphs, width: x * size / UNITS_PER_EM, size }
    }

    /// Lays out plain text in the first of `sizes` (px) in which it is at most `width` px wide, or else in the last
    /// one.
    pub fn fitting<const N: usize>(text: &str, sizes: [f64; N], width: f64) -> Line {
        let lines = sizes.map(|size| Line::plain(text, size));
        let fitting = lines.iter().find(|line| line.width <= width).or(lines.last());
        fitting.expect("at least one size").clone()
    }

    /// This line, a blank and another line.
    fn followed_by(&self, next: &Line) -> Line {
        let blank = Line::plain(" ", self.size);
        self.joined(&blank).joined(next)
    }

    /// This line and directly after it another one.
    fn joined(&self, next: &Line) -> Line {
        let start = self.width;
        let shifted = next.glyphs.iter().map(|glyph| Glyph { x: start + glyph.x, ..*glyph });
        Line {
            text: format!("{}{}", self.text, next.text),
            glyphs: self.glyphs.iter().copied().chain(shifted).collect(),
            width: start + next.width,
            size: self.size,
        }
    }

    /// The same glyphs as decoration without text.
    pub fn without_text(&self) -> Line {
        Line { text: String::new(), ..self.clone() }
    }

    /// Height of the capitals, px.
    pub fn height(&self) -> f64 {
        CAP_HEIGHT * self.size
    }
}

/// A text of at most `max` characters, or else its first `max` characters and an ellipsis.
pub fn truncated(text: &str, max: usize) -> String {
    if text.chars().count() <= max {
        return text.to_owned();
    }
    let kept: String = text.chars().take(max).collect();
    format!("{}…", kept.trim_end())
}
