use super::stencil::Stencil;
use super::{Color, Ink, Picture};
use crate::physics::Rect;

/// Pixels being drawn on, in whole numbers only.
///
/// Whatever is drawn covers a pixel in sixteenths: that is what the rasteriser of paths
/// resolves, and quarters of a pixel along both sides for rectangles. So few that a frame's
/// colours seldom are more than a palette holds.
pub struct Canvas {
    pub width: usize,
    pub pixels: Vec<[u8; 4]>,
    /// Only pixels in there change.
    pub clip: Clip,
}

/// Columns `left` to before `right`, rows `top` to before `bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clip {
    pub left: usize,
    pub top: usize,
    pub right: usize,
    pub bottom: usize,
}

/// A pixel wholly covered.
pub const FULL: u8 = 16;

impl Canvas {
    pub fn new(size: [usize; 2], background: Color) -> Canvas {
        Canvas::from_pixels(size, vec![pixel(background); size[0] * size[1]])
    }

    pub fn from_pixels([width, height]: [usize; 2], pixels: Vec<[u8; 4]>) -> Canvas {
        Canvas { width, pixels, clip: Clip { left: 0, top: 0, right: width, bottom: height } }
    }

    pub fn into_picture(self) -> Picture {
        let height = self.pixels.len() / self.width;
        Picture { size: [self.width as u32, height as u32], pixels: self.pixels }
    }

    /// Lets only pixels change that lie in `window` too, and tells which could before.
    pub fn narrow(&mut self, window: &Rect) -> Clip {
        let outside = self.clip;
        let far = window.far_corner();
        let whole = |at: f64, from: usize, to: usize| (at.round() as i64).clamp(from as i64, to as i64) as usize;
        let [left, right] = [window.origin.x, far.x].map(|at| whole(at, outside.left, outside.right));
        let [top, bottom] = [window.origin.y, far.y].map(|at| whole(at, outside.top, outside.bottom));
        self.clip = Clip { left, top, right, bottom };
        outside
    }

    /// Fills a rectangle given in px, its edges rounded to quarters of a pixel.
    pub fn fill_rect(&mut self, rect: &Rect, ink: Ink) {
        let (far, clip) = (rect.far_corner(), self.clip);
        let [left, right] = [rect.origin.x, far.x].map(|at| quarters(at, clip.left, clip.right));
        let [top, bottom] = [rect.origin.y, far.y].map(|at| quarters(at, clip.top, clip.bottom));
        if left >= right {
            return;
        }
        for row in top / 4..bottom.div_ceil(4) {
            self.fill_row(row, left, right, covered(row, top, bottom), ink);
        }
    }

    /// Fills a row between two edges in quarters, of which `rows` quarters are covered.
    fn fill_row(&mut self, row: usize, left: usize, right: usize, rows: u8, ink: Ink) {
        let pixels = &mut self.pixels[row * self.width..][..self.width];
        let (first, last) = (left.div_ceil(4), right / 4);
        let mut cut = |at: usize| blend(&mut pixels[at], ink, corner(rows, covered(at, left, right)));
        if 4 * first > left {
            cut(left / 4);
        }
        if 4 * last < right && last >= first {
            cut(last);
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

    /// Draws through a stencil.
    pub fn fill_stencil(&mut self, stencil: Stencil, ink: Ink) {
        self.fill_mask(&stencil.coverage, stencil.width, stencil.left, stencil.top, ink);
    }

    /// Draws through a mask of `width` columns whose upper-left corner is at (x, y);
    /// its values are sixteenths.
    pub fn fill_mask(&mut self, mask: &[u8], width: usize, x: i64, y: i64, ink: Ink) {
        let clip = self.clip;
        let columns = (clip.left as i64 - x).max(0)..(clip.right as i64 - x).min(width as i64);
        let rows = clip.top as i64..clip.bottom as i64;
        if columns.is_empty() {
            return;
        }
        let (first, last) = (columns.start as usize, columns.end as usize);
        for (row, coverage) in (y..).zip(mask.chunks_exact(width)).filter(|(row, _)| rows.contains(row)) {
            let start = row as usize * self.width + (x + columns.start) as usize;
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

/// A coordinate in quarters of a pixel, pulled between two pixels' edges.
fn quarters(at: f64, from: usize, to: usize) -> usize {
    ((at * 4.0).round() as i64).clamp(4 * from as i64, 4 * to as i64) as usize
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Vector;

    const WHITE: Color = Color::hex(0xffffff);
    const BLACK: Color = Color::hex(0x000000);

    /// What a black rectangle leaves of white, row by row.
    fn greys(x: f64, y: f64, width: f64, height: f64) -> Vec<u8> {
        let mut canvas = Canvas::new([4, 3], WHITE);
        canvas.fill_rect(&Rect::new(Vector::new(x, y), width, height), Ink::from(BLACK));
        canvas.pixels.iter().map(|pixel| pixel[0]).collect()
    }

    #[test]
    fn whole_pixels_are_filled_whole() {
        assert_eq!(greys(1.0, 1.0, 2.0, 1.0), [255, 255, 255, 255, 255, 0, 0, 255, 255, 255, 255, 255]);
    }

    #[test]
    fn edges_cover_quarters() {
        assert_eq!(greys(0.75, 0.0, 1.5, 1.0)[..4], [191, 0, 191, 255]);
        assert_eq!(greys(1.0, 0.5, 1.0, 1.75), [255, 128, 255, 255, 255, 0, 255, 255, 255, 191, 255, 255]);
        assert_eq!(greys(1.25, 0.0, 0.5, 1.0)[..4], [255, 128, 255, 255]);
        assert_eq!(greys(1.0, 0.0, 0.5, 1.0)[..4], [255, 128, 255, 255]);
    }

    #[test]
    fn what_lies_outside_is_cut_off() {
        assert_eq!(greys(-5.0, -5.0, 50.0, 50.0), [0; 12]);
        assert_eq!(greys(-5.0, 0.0, 3.0, 3.0), [255; 12]);
        assert_eq!(greys(4.0, 0.0, 3.0, 3.0), [255; 12]);
        assert_eq!(greys(f64::NAN, 0.0, 3.0, 3.0), [255; 12]);
    }

    #[test]
    fn a_mask_is_placed_and_cut_off() {
        let mut canvas = Canvas::new([2, 2], WHITE);
        canvas.fill_mask(&[FULL, 8, 4, 0], 2, -1, -1, Ink::from(BLACK));
        canvas.fill_mask(&[FULL, 8, 4, 0], 2, 1, 0, Ink { color: BLACK, opacity: 51 });
        let greys: Vec<u8> = canvas.pixels.iter().map(|pixel| pixel[0]).collect();
        assert_eq!(greys, [255, 204, 255, 242]);
    }
}
