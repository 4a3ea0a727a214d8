use super::area::{larger, smaller};
use super::palette::Palette;
use crate::scene::Theme;

/// The colours of a picture, and lines and text that suit its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The colours of its theme.
    pub palette: Palette,
    /// Height of an em of text, px.
    pub text: f64,
    /// Width of a line, px; a whole number.
    pub line: f64,
}

impl Look {
    /// The look of a picture of `size` pixels: as a whole it looks the same in every size.
    pub fn new(theme: Theme, size: [u32; 2]) -> Look {
        let [width, height] = size.map(f64::from);
        let unit = smaller(width, height) / 720.0;
        Look {
            palette: Palette::of(theme),
            text: if unit < 0.6 { 12.0 } else { (21.0 * unit).round() },
            line: larger((2.0 * unit).round(), 1.0),
        }
    }
}
