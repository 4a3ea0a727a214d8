use super::bitmap::{Bitmap, QuarterRect};
use super::coverage_mask::CoverageMask;
use super::{ClipRect, FULL_COVERAGE};
use crate::physics::Rect;
use crate::picture::{Color, Ink, Picture, color};

/// A pixel buffer. Rectangles are drawn to the nearest quarter pixel.
pub struct Canvas {
    pub width: usize,
    pub pixels: Vec<[u8; 4]>,
    /// Drawing changes only pixels inside this rectangle.
    pub clip: ClipRect,
}

impl Canvas {
    pub fn new(size: [usize; 2], background: Color) -> Canvas {
        Canvas::from_pixels(size, vec![pixel(background); size[0] * size[1]])
    }

    pub fn from_pixels([width, height]: [usize; 2], pixels: Vec<[u8; 4]>) -> Canvas {
        Canvas { width, pixels, clip: ClipRect { left: 0, top: 0, right: width, bottom: height } }
    }

    pub fn into_picture(self) -> Picture {
        let height = self.pixels.len() / self.width;
        Picture { size: [self.width as u32, height as u32], pixels: self.pixels }
    }

    /// Intersects the clip rectangle with `window`, rounded to whole pixels. Returns the previous clip rectangle.
    pub fn intersect_clip(&mut self, window: &Rect) -> ClipRect {
        let previous = self.clip;
        let far = window.far_corner();
        let clamp_pixel = |at: f64, from: usize, to: usize| (at.round() as i64).clamp(from as i64, to as i64) as usize;
        let [left, right] = [window.origin.x, far.x].map(|at| clamp_pixel(at, previous.left, previous.right));
        let [top, bottom] = [window.origin.y, far.y].map(|at| clamp_pixel(at, previous.top, previous.bottom));
        self.clip = ClipRect { left, top, right, bottom };
        previous
    }

    /// Fills a rectangle (px), its edges rounded to quarter pixels.
    pub fn fill_rect(&mut self, rect: &Rect, ink: Ink) {
        let (far, clip) = (rect.far_corner(), self.clip);
        let [left, right] = [rect.origin.x, far.x].map(|at| to_quarters(at, clip.left, clip.right));
        let [top, bottom] = [rect.origin.y, far.y].map(|at| to_quarters(at, clip.top, clip.bottom));
        if left >= right {
            return;
        }
        for row in top / 4..bottom.div_ceil(4) {
            self.fill_row(row, left, right, covered_quarters(row, top, bottom), ink);
        }
    }

    /// Fills a row between two edges in quarter pixels; `rows` quarters of its height are covered.
    fn fill_row(&mut self, row: usize, left: usize, right: usize, rows: u8, ink: Ink) {
        let pixels = &mut self.pixels[row * self.width..][..self.width];
        let (first, last) = (left.div_ceil(4), right / 4);
        let mut blend_edge =
            |at: usize| blend(&mut pixels[at], ink, corner_coverage(rows, covered_quarters(at, left, right)));
        if 4 * first > left {
            blend_edge(left / 4);
        }
        if 4 * last < right && last >= first {
            blend_edge(last);
        }
        if first >= last {
            return;
        }
        if rows * 4 == FULL_COVERAGE && ink.opacity == 255 {
            pixels[first..last].fill(pixel(ink.color));
        } else {
            pixels[first..last].iter_mut().for_each(|below| blend(below, ink, rows * 4));
        }
    }

    /// Draws a bitmap into a rectangle (px), its edges rounded to quarter pixels, with an opacity up to 255.
    pub fn draw_bitmap(&mut self, bitmap: &Bitmap, rect: &Rect, opacity: u8) {
        let Some((quarters, [left, top])) = QuarterRect::of(rect) else { return };
        let [width, height] = quarters.pixels().map(|side| side as i64);
        let clip = self.clip;
        let columns = (clip.left as i64 - left).max(0)..(clip.right as i64 - left).min(width);
        let rows = (clip.top as i64 - top).max(0)..(clip.bottom as i64 - top).min(height);
        if !columns.is_empty() && !rows.is_empty() {
            let [columns, rows] = [columns, rows].map(|range| range.start as usize..range.end as usize);
            bitmap.scaled(&quarters, columns, rows).draw(self, [left, top], opacity);
        }
    }

    /// Fills the pixels of a coverage mask.
    pub fn fill_mask(&mut self, mask: CoverageMask, ink: Ink) {
        self.fill_coverage(&mask.coverage, mask.width, mask.left, mask.top, ink);
    }

    /// Fills pixels by their coverage in sixteenths, given row by row for `width` columns, with the upper-left corner
    /// at (x, y).
    pub fn fill_coverage(&mut self, coverage: &[u8], width: usize, x: i64, y: i64, ink: Ink) {
        let clip = self.clip;
        let columns = (clip.left as i64 - x).max(0)..(clip.right as i64 - x).min(width as i64);
        let rows = clip.top as i64..clip.bottom as i64;
        if columns.is_empty() {
            return;
        }
        let (first, last) = (columns.start as usize, columns.end as usize);
        for (row, coverage) in (y..).zip(coverage.chunks_exact(width)).filter(|(row, _)| rows.contains(row)) {
            let start = row as usize * self.width + (x + columns.start) as usize;
            let below = &mut self.pixels[start..][..last - first];
            for (below, &coverage) in below.iter_mut().zip(&coverage[first..last]) {
                if coverage != 0 {
                    blend(below, ink, coverage);
                }
            }
        }
    }
}

/// An opaque pixel.
pub const fn pixel(color: Color) -> [u8; 4] {
    [color.r, color.g, color.b, 255]
}

/// A coordinate in quarter pixels, clamped to the pixels `from..to`.
fn to_quarters(at: f64, from: usize, to: usize) -> usize {
    ((at * 4.0).round() as i64).clamp(4 * from as i64, 4 * to as i64) as usize
}

/// The number of quarters of pixel `at` between two edges given in quarter pixels.
fn covered_quarters(at: usize, from: usize, to: usize) -> u8 {
    let (from, to) = (from.max(4 * at), to.min(4 * at + 4));
    (to - from) as u8
}

/// The coverage of a pixel at the corner of a rectangle, rounded to quarters: a single pixel does not justify colours
/// of its own.
const fn corner_coverage(rows: u8, columns: u8) -> u8 {
    (rows * columns + 2) / 4 * 4
}

/// Blends ink over a pixel by its coverage in sixteenths, rounded to nearest.
fn blend(below: &mut [u8; 4], ink: Ink, coverage: u8) {
    const FULL: u32 = FULL_COVERAGE as u32 * 255;
    let part = u32::from(coverage) * u32::from(ink.opacity);
    let over = pixel(ink.color);
    for (below, over) in below.iter_mut().zip(over) {
        *below = color::blend(*below, over, part, FULL);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Vector;

    const WHITE: Color = Color::hex(0xffffff);
    const BLACK: Color = Color::hex(0x000000);

    /// Draws a black rectangle on white and returns the grey levels row by row.
    fn greys(x: f64, y: f64, width: f64, height: f64) -> Vec<u8> {
        let mut canvas = Canvas::new([4, 3], WHITE);
        canvas.fill_rect(&Rect::new(Vector::new(x, y), width, height), Ink::from(BLACK));
        canvas.pixels.iter().map(|pixel| pixel[0]).collect()
    }

    #[test]
    fn a_rectangle_on_pixel_edges_fills_whole_pixels() {
        assert_eq!(greys(1.0, 1.0, 2.0, 1.0), [255, 255, 255, 255, 255, 0, 0, 255, 255, 255, 255, 255]);
    }

    #[test]
    fn edges_between_pixels_are_covered_in_quarters() {
        assert_eq!(greys(0.75, 0.0, 1.5, 1.0)[..4], [191, 0, 191, 255]);
        assert_eq!(greys(1.0, 0.5, 1.0, 1.75), [255, 128, 255, 255, 255, 0, 255, 255, 255, 191, 255, 255]);
        assert_eq!(greys(1.25, 0.0, 0.5, 1.0)[..4], [255, 128, 255, 255]);
        assert_eq!(greys(1.0, 0.0, 0.5, 1.0)[..4], [255, 128, 255, 255]);
    }

    #[test]
    fn rectangles_are_clipped_to_the_canvas() {
        assert_eq!(greys(-5.0, -5.0, 50.0, 50.0), [0; 12]);
        assert_eq!(greys(-5.0, 0.0, 3.0, 3.0), [255; 12]);
        assert_eq!(greys(4.0, 0.0, 3.0, 3.0), [255; 12]);
        assert_eq!(greys(f64::NAN, 0.0, 3.0, 3.0), [255; 12]);
    }

    #[test]
    fn a_mask_is_clipped_to_the_canvas() {
        let mut canvas = Canvas::new([2, 2], WHITE);
        canvas.fill_coverage(&[FULL_COVERAGE, 8, 4, 0], 2, -1, -1, Ink::from(BLACK));
        canvas.fill_coverage(&[FULL_COVERAGE, 8, 4, 0], 2, 1, 0, Ink { color: BLACK, opacity: 51 });
        let greys: Vec<u8> = canvas.pixels.iter().map(|pixel| pixel[0]).collect();
        assert_eq!(greys, [255, 204, 255, 242]);
    }
}
