//! Text layout with one embedded font, identical on every machine.
//!
//! Glyph outlines are read with skrifa and filled like any other path; system fonts, hinting and locale have no
//! influence. Lines of Latin and Greek need only pair kerning, so there is no shaper.

mod font;
mod line;
mod math;

pub use font::{Bounds, Font, PathSegment, UNITS_PER_EM};
pub use line::{Glyph, Line};
