//! Rasterises shapes to pixels. Colours are blended with integer arithmetic, so that pixels are the same on every
//! machine.
//!
//! The coverage of a pixel is a number of sixteenths: the edges of rectangles are rounded to quarter pixels, and the
//! coverage masks of polygons, lines and glyphs to eighths. Finer steps are invisible, and each would add a colour for
//! every pair of adjacent colours. With so few levels a frame usually has at most 256 colours, so that PNG and GIF are
//! stored with a palette, which keeps them small and exact. For the same reason the camera rounds positions to quarter
//! pixels. A frame of more colours is written as RGB in PNG and reduced to 256 colours in GIF.

pub(crate) mod canvas;
pub(crate) mod color;
pub(crate) mod coverage_mask;
mod display_list;
mod painter;
mod stroke;

pub use color::{Color, Palette};
pub use display_list::{DisplayList, Ink, Shape};
pub use painter::Painter;

/// A raster image: the output of the painter, the input of the encoders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height, px.
    pub size: [u32; 2],
    /// Rows from the top, as red, green, blue and alpha; alpha is always 255.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// The rows of pixels, from the top.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, [u8; 4]> {
        self.pixels.chunks_exact(self.size[0] as usize)
    }
}

/// Columns `left..right` and rows `top..bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ClipRect {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

/// The coverage of a fully covered pixel.
pub(crate) const FULL_COVERAGE: u8 = 16;

/// Coverage from 0 to 1 in sixteenths, rounded to eighths.
pub(crate) fn quantize_coverage(coverage: f64) -> u8 {
    const STEPS: u8 = FULL_COVERAGE / 2;
    (coverage * f64::from(STEPS)).round() as u8 * 2
}
