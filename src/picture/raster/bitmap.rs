use super::MAX_COORDINATE;
use super::canvas::Canvas;
use super::color::blend;
use crate::physics::{Rect, larger, smaller};

/// A picture that is drawn into boxes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    /// Width and height, px.
    pub size: [u32; 2],
    /// Rows from the top, as red, green, blue and alpha.
    pub pixels: Vec<[u8; 4]>,
}

/// A bitmap scaled to the pixels of a page.
pub(super) struct ScaledBitmap {
    /// Left and top, px, relative to the pixel of the upper-left corner of its rectangle.
    offset: [usize; 2],
    width: usize,
    /// Red, green, blue and alpha; at the border the alpha includes the coverage of the pixel.
    pixels: Vec<[u8; 4]>,
}

/// The part of the pixels of a bitmap along one axis that a pixel of the page covers.
struct Span {
    first: usize,
    /// The weights of consecutive pixels; their sum is 1.
    weights: Vec<f64>,
    /// The covered part of the pixel of the page.
    coverage: f64,
}

impl Bitmap {
    /// Scales the bitmap to a rectangle whose edges are rounded to quarter pixels: columns `columns` and rows `rows` of
    /// the page, counted from the pixel of the upper-left corner.
    ///
    /// A pixel of the page has the mean colour of the part of the bitmap that it covers. So a bitmap that is made
    /// larger keeps its sharp pixels, and one that is made smaller is smooth.
    pub(super) fn scaled(
        &self,
        quarters: &QuarterRect,
        columns: std::ops::Range<usize>,
        rows: std::ops::Range<usize>,
    ) -> ScaledBitmap {
        let [width, height] = self.size.map(|side| side as usize);
        let across: Vec<Span> = columns.clone().map(|column| quarters.span(0, column, width)).collect();
        let mut pixels = Vec::with_capacity(columns.len() * rows.len());
        let mut line = vec![[0.0; 4]; width];
        let used = across.first().map_or(0, |span| span.first)
            ..across.last().map_or(0, |span| span.first + span.weights.len());
        for row in rows.clone() {
            let down = quarters.span(1, row, height);
            line[used.clone()].fill([0.0; 4]);
            for (number, weight) in down.weights.iter().enumerate() {
                let source = &self.pixels[(down.first + number) * width..][..width];
                for (sum, pixel) in line[used.clone()].iter_mut().zip(&source[used.clone()]) {
                    add_premultiplied(sum, *pixel, *weight);
                }
            }
            pixels.extend(across.iter().map(|span| {
                let mut sum = [0.0; 4];
                for (pixel, weight) in line[span.first..].iter().zip(&span.weights) {
                    (0..4).for_each(|channel| sum[channel] += pixel[channel] * weight);
                }
                straight(sum, span.coverage * down.coverage)
            }));
        }
        ScaledBitmap { offset: [columns.start, rows.start], width: columns.len(), pixels }
    }
}

/// Adds the premultiplied colour of a pixel, and its alpha from 0 to 1.
fn add_premultiplied(sum: &mut [f64; 4], [r, g, b, alpha]: [u8; 4], weight: f64) {
    let part = weight * (f64::from(alpha) / 255.0);
    for (sum, channel) in sum.iter_mut().zip([r, g, b]) {
        *sum += part * f64::from(channel);
    }
    sum[3] += part;
}

/// The colour and opacity of a premultiplied sum.
fn straight([r, g, b, alpha]: [f64; 4], coverage: f64) -> [u8; 4] {
    if alpha <= 0.0 {
        return [0; 4];
    }
    let channel = |sum: f64| (sum / alpha + 0.5) as u8;
    [channel(r), channel(g), channel(b), (255.0 * alpha * coverage + 0.5) as u8]
}

/// A rectangle in quarters of a pixel, relative to the pixel of its upper-left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct QuarterRect {
    /// The distance of the left and upper edge from the corner of their pixel, 0 to 3.
    near: [i64; 2],
    /// The distance of the right and lower edge.
    far: [i64; 2],
}

impl QuarterRect {
    /// The rectangle and the pixel of its upper-left corner. `None` if it is empty or beyond all pages.
    pub fn of(rect: &Rect) -> Option<(QuarterRect, [i64; 2])> {
        let far = rect.far_corner();
        let edges = [rect.origin.x, rect.origin.y, far.x, far.y];
        if !edges.iter().all(|edge| edge.abs() < MAX_COORDINATE) {
            return None;
        }
        let [left, top, right, bottom] = edges.map(|edge| (edge * 4.0).round() as i64);
        let corner = [left.div_euclid(4), top.div_euclid(4)];
        let near = [left - 4 * corner[0], top - 4 * corner[1]];
        let far = [right - 4 * corner[0], bottom - 4 * corner[1]];
        (near[0] < far[0] && near[1] < far[1]).then_some((QuarterRect { near, far }, corner))
    }

    /// Width and height in pixels of the page that are at least partly covered.
    pub fn pixels(&self) -> [usize; 2] {
        self.far.map(|far| (far as usize).div_ceil(4))
    }

    /// The part of `count` pixels of a bitmap that pixel `at` of an axis covers.
    fn span(&self, axis: usize, at: usize, count: usize) -> Span {
        let (near, far) = (self.near[axis], self.far[axis]);
        let (from, to) = (near.max(4 * at as i64), far.min(4 * at as i64 + 4));
        let place = |edge: i64| (edge - near) as f64 * count as f64 / (far - near) as f64;
        let (start, end) = (place(from), place(to));
        let first = (start.floor() as usize).min(count - 1);
        let last = (end.ceil() as usize).clamp(first + 1, count);
        let part = |pixel: usize| {
            let covered = smaller(end, pixel as f64 + 1.0) - larger(start, pixel as f64);
            larger(covered, 0.0) / (end - start)
        };
        Span { first, weights: (first..last).map(part).collect(), coverage: (to - from) as f64 / 4.0 }
    }
}

impl ScaledBitmap {
    /// Draws the bitmap with the corner of its rectangle in a pixel of the canvas, with an opacity up to 255.
    pub(super) fn draw(&self, canvas: &mut Canvas, corner: [i64; 2], opacity: u8) {
        let [left, top] = [corner[0] + self.offset[0] as i64, corner[1] + self.offset[1] as i64];
        let clip = canvas.clip;
        let columns = (clip.left as i64 - left).max(0)..(clip.right as i64 - left).min(self.width as i64);
        if columns.is_empty() {
            return;
        }
        let (first, last) = (columns.start as usize, columns.end as usize);
        let rows = clip.top as i64..clip.bottom as i64;
        for (row, pixels) in (top..).zip(self.pixels.chunks_exact(self.width)).filter(|(row, _)| rows.contains(row)) {
            let start = row as usize * canvas.width + (left + columns.start) as usize;
            let below = &mut canvas.pixels[start..][..last - first];
            for (below, [r, g, b, alpha]) in below.iter_mut().zip(&pixels[first..last]) {
                let part = u32::from(*alpha) * u32::from(opacity);
                for (below, over) in below.iter_mut().zip([*r, *g, *b, 255]) {
                    *below = blend(*below, over, part, 255 * 255);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Vector;
    use crate::picture::Color;

    const WHITE: Color = Color::hex(0xffffff);

    fn draw(bitmap: &Bitmap, rect: Rect, size: [usize; 2]) -> Vec<[u8; 4]> {
        let mut canvas = Canvas::new(size, WHITE);
        canvas.draw_bitmap(bitmap, &rect, 255);
        canvas.pixels
    }

    fn checks() -> Bitmap {
        let pixels = (0..16).map(|at| if (at % 4 + at / 4) % 2 == 0 { [0, 0, 0, 255] } else { [255, 0, 0, 255] });
        Bitmap { size: [4, 4], pixels: pixels.collect() }
    }

    #[test]
    fn a_bitmap_of_its_own_size_is_copied_and_an_enlarged_one_keeps_sharp_pixels() {
        let bitmap = checks();
        assert_eq!(draw(&bitmap, Rect::new(Vector::ZERO, 4.0, 4.0), [4, 4]), bitmap.pixels);
        let large = draw(&bitmap, Rect::new(Vector::ZERO, 16.0, 16.0), [16, 16]);
        for (at, pixel) in large.iter().enumerate() {
            assert_eq!(*pixel, bitmap.pixels[at / 16 / 4 * 4 + at % 16 / 4]);
        }
    }

    #[test]
    fn a_smaller_bitmap_has_the_mean_colour_at_every_size_and_place() {
        let bitmap = checks();
        for quarters in 1..16 {
            let side = f64::from(quarters) / 4.0;
            let pixels = draw(&bitmap, Rect::new(Vector::new(1.25, 0.75), side, side), [8, 8]);
            // Red is 127.5 on average and green 0, over white.
            let covered: f64 = pixels.iter().map(|pixel| f64::from(255 - pixel[1]) / 255.0).sum();
            assert!((covered - side * side).abs() < 0.05, "{side}: {covered}");
            let dark: f64 = pixels.iter().map(|pixel| f64::from(255 - pixel[0]) / 255.0).sum();
            assert!((dark - side * side / 2.0).abs() < 0.05 + 0.02 * side * side, "{side}: {dark}");
        }
    }

    #[test]
    fn transparent_pixels_show_the_page_and_do_not_tint_their_neighbours() {
        let bitmap = Bitmap { size: [2, 1], pixels: vec![[0, 200, 0, 255], [255, 0, 0, 0]] };
        let pixels = draw(&bitmap, Rect::new(Vector::ZERO, 1.0, 1.0), [2, 1]);
        // Half of the pixel is green, without the red of the transparent half.
        assert_eq!(pixels, [[127, 227, 127, 255], [255; 4]]);
    }

    #[test]
    fn a_part_of_a_huge_bitmap_is_drawn_as_part_of_the_whole() {
        let bitmap = checks();
        let rect = Rect::new(Vector::new(-1000.0, -500.0), 4000.0, 2000.0);
        let part = draw(&bitmap, rect, [4, 3]);
        assert!(part.iter().all(|pixel| *pixel == bitmap.pixels[5]), "{part:?}");
        for beyond in [f64::NAN, f64::INFINITY, 1e300, -1e300] {
            let pixels = draw(&bitmap, Rect::new(Vector::new(beyond, 0.0), 1.0, 1.0), [2, 2]);
            assert_eq!(pixels, [[255; 4]; 4]);
        }
    }
}
