use super::{Color, Ink, Picture};
use crate::physics::Rect;

/// Pixels being drawn on, in whole numbers only.
///
/// Whatever is drawn covers a pixel in sixteenths: that is what the rasteriser of paths
/// resolves, and quarters of a pixel along both sides for rectangles. So few that a frame's
/// colours seldom are more than a palette holds.
pub struct Canvas {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<[u8; 4]>,
}

/// A pixel wholly covered.
pub const FULL: u8 = 16;

impl Canvas {
    pub fn new(size: [u32; 2], background: Color) -> Canvas {
        let [width, height] = size.map(|side| side as usize);
        Canvas { width, height, pixels: vec![pixel(background); width * height] }
    }

    pub fn into_picture(self) -> Picture {
        Picture { size: [self.width as u32, self.height as u32], pixels: self.pixels }
    }

    /// Fills a rectangle given in px, its edges rounded to quarters of a pixel.
    pub fn fill_rect(&mut self, rect: &Rect, ink: Ink) {
        let far = rect.far_corner();
        let (left, right) = (quarters(rect.origin.x, self.width), quarters(far.x, self.width));
        let (top, bottom) = (quarters(rect.origin.y, self.height), quarters(far.y, self.height));
        if left >= right {
            return;
        }
        for row in top / 4..bottom.div_ceil(4) {
            self.fill_row(row, left, right, covered(row, top, bottom), ink);
        }
    }

    fn fill_row(&mut self, row: usize, left: usize, right: usize, rows: u8, ink: Ink) {
        let pixels = &mut self.pixels[row * self.width..][..self.width];
        let (first, last) = (left.div_ceil(4), right / 4);
        if left % 4 != 0 {
            blend(&mut pixels[left / 4], ink, corner(rows, covered(left / 4, left, right)));
        }
        if right % 4 != 0 && (right / 4 != left / 4 || left % 4 == 0) {
            blend(&mut pixels[last], ink, corner(rows, covered(last, left, right)));
        }
        if first >= last {
            return;
        }
        if rows * 4 == FULL && ink.opacity == 255 {
            pixels[first..last].fill(pixel(ink.color));
        } else {
            pixels[first..last].iter_mut().for_each(|under| blend(under, ink, rows * 4));
        }
    }

    /// Draws through a mask of `width` columns whose upper-left corner is at (x, y);
    /// its values are sixteenths.
    pub fn fill_mask(&mut self, mask: &[u8], width: usize, x: i64, y: i64, ink: Ink) {
        let first = clamp(-x, width);
        let last = clamp(self.width as i64 - x, width);
        if first >= last {
            return;
        }
        for (row, coverage) in (y..).zip(mask.chunks_exact(width)) {
            if row < 0 || row >= self.height as i64 {
                continue;
            }
            let start = row as usize * self.width + (x + first as i64) as usize;
            let under = &mut self.pixels[start..][..last - first];
            for (under, &coverage) in under.iter_mut().zip(&coverage[first..last]) {
                if coverage != 0 {
                    blend(under, ink, coverage);
                }
            }
        }
    }
}

/// A pixel of that colour.
pub const fn pixel(color: Color) -> [u8; 4] {
    [color.r, color.g, color.b, 255]
}

/// A coordinate in quarters of a pixel, pulled into the picture.
fn quarters(at: f64, pixels: usize) -> usize {
    clamp((at * 4.0).round() as i64, 4 * pixels)
}

fn clamp(at: i64, most: usize) -> usize {
    at.clamp(0, most as i64) as usize
}

/// How many of the quarters of pixel `at` lie between two edges given in quarters.
fn covered(at: usize, from: usize, to: usize) -> u8 {
    let (from, to) = (from.max(4 * at), to.min(4 * at + 4));
    (to - from) as u8
}

/// The coverage of a pixel that is cut both ways, to the nearest quarter: a corner is one
/// pixel, not worth colours of its own.
const fn corner(rows: u8, columns: u8) -> u8 {
    (rows * columns + 2) / 4 * 4
}

/// Lays ink over `coverage` sixteenths of a pixel, rounding to nearest.
fn blend(under: &mut [u8; 4], ink: Ink, coverage: u8) {
    const WHOLE: u32 = FULL as u32 * 255;
    let part = u32::from(coverage) * u32::from(ink.opacity);
    let over = pixel(ink.color);
    for (under, over) in under.iter_mut().zip(over) {
        let sum = u32::from(*under) * (WHOLE - part) + u32::from(over) * part;
        *under = ((sum + WHOLE / 2) / WHOLE) as u8;
    }
}
