//! Lines of text as glyphs of one embedded font, the same on every machine.
//!
//! The outlines come from skrifa, the maintained reader of fonts, and are filled like any
//! other path; no system font, hinting or locale has a say. A line of Latin or Greek needs
//! pair kerning and no more, so there is no shaper.

mod font;
mod line;
mod math;

pub use font::{Bounds, Font, Segment, UNITS_PER_EM};
pub use line::{Glyph, Line};
