use super::area::{larger, smaller};
use super::palette::Palette;
use crate::scene::Theme;

/// The colours of a theme, with a font size and line width that suit the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// The colours of the theme.
    pub palette: Palette,
    /// Font size (height of the em), px.
    pub font_size: f64,
    /// Line width, px; a whole number.
    pub line_width: f64,
}

impl Metrics {
    /// The metrics of a picture of `size` pixels, in proportion to its shorter side; small pictures keep a legible
    /// font.
    pub fn new(theme: Theme, size: [u32; 2]) -> Metrics {
        let [width, height] = size.map(f64::from);
        let unit = smaller(width, height) / 720.0;
        Metrics {
            palette: Palette::of(theme),
            font_size: if unit < 0.6 { 12.0 } else { (21.0 * unit).round() },
            line_width: larger((2.0 * unit).round(), 1.0),
        }
    }
}
