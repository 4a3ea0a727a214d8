//! Exact comparison of two pictures.

use crate::picture::raster::canvas;
use crate::picture::{Color, Picture};

/// The difference of two pictures of the same size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The number of pixels that differ.
    pub count: u64,
    /// Column and row of the first differing pixel in row order.
    pub first: [u32; 2],
    /// The bounding box of all differing pixels: first column and row, last column and row.
    pub bounds: [u32; 4],
}

/// The result of an exact comparison of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// All pixels are equal.
    Same,
    /// The sizes differ; pixels were not compared.
    Size {
        /// Expected width and height, px.
        expected: [u32; 2],
        /// Actual width and height, px.
        actual: [u32; 2],
    },
    /// Some pixels differ.
    Pixels(Difference),
}

/// Compares decoded pixels without tolerance.
pub fn compare(expected: &Picture, actual: &Picture) -> Comparison {
    if expected.size != actual.size {
        return Comparison::Size { expected: expected.size, actual: actual.size };
    }
    let width = expected.size[0] as usize;
    let pairs = expected.pixels.iter().zip(&actual.pixels).enumerate();
    let mut differing = pairs.filter(|(_, (a, b))| a != b).map(|(at, _)| [at % width, at / width]);
    let Some(first) = differing.next() else { return Comparison::Same };
    let first = first.map(|at| at as u32);
    let [x, y] = first;
    let initial = Difference { count: 1, first, bounds: [x, y, x, y] };
    Comparison::Pixels(differing.fold(initial, |difference, at| extend(difference, at.map(|at| at as u32))))
}

fn extend(difference: Difference, [x, y]: [u32; 2]) -> Difference {
    let [left, top, right, bottom] = difference.bounds;
    let bounds = [left.min(x), top.min(y), right.max(x), bottom.max(y)];
    Difference { count: difference.count + 1, bounds, ..difference }
}

impl std::fmt::Display for Comparison {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Comparison::Same => write!(out, "same"),
            Comparison::Size { expected, actual } => {
                write!(out, "{}×{} pixels, expected {}×{}", actual[0], actual[1], expected[0], expected[1])
            }
            Comparison::Pixels(Difference { count: 1, first, .. }) => {
                write!(out, "1 pixel differs, at ({}, {})", first[0], first[1])
            }
            Comparison::Pixels(Difference { count, first, bounds }) => write!(
                out,
                "{count} pixels differ, the first at ({}, {}), all from ({}, {}) to ({}, {})",
                first[0], first[1], bounds[0], bounds[1], bounds[2], bounds[3]
            ),
        }
    }
}

/// The gap between two panels, px.
const GAP: usize = 8;

/// A picture of the expected picture, the differences and the actual picture side by side. Differing
/// pixels are red on a faded copy of the expected picture.
pub fn side_by_side(expected: &Picture, actual: &Picture) -> Picture {
    let mut difference = difference(expected, actual);
    if let Comparison::Pixels(found) = compare(expected, actual) {
        frame(&mut difference, found.bounds);
    }
    beside([expected, &difference, actual])
}

/// The differing pixels with those around them, magnified: the expected picture, the differences and the actual picture
/// side by side. Of differences that are far apart, those near the first one.
pub fn magnified(expected: &Picture, actual: &Picture, found: &Difference) -> Picture {
    const MARGIN: u32 = 8;
    const MAX_SIDE: u32 = 64;
    const SHOWN: u32 = 320;
    let [left, top, right, bottom] = found.bounds;
    let range = |first: u32, last: u32, at: u32, length: u32| {
        let (from, to) = (first.saturating_sub(MARGIN), (last + MARGIN + 1).min(length));
        if to - from <= MAX_SIDE {
            return from..to;
        }
        let from = at.saturating_sub(MAX_SIDE / 2).max(from);
        from..(from + MAX_SIDE).min(to)
    };
    let columns = range(left, right, found.first[0], expected.size[0]);
    let rows = range(top, bottom, found.first[1], expected.size[1]);
    let factor = (SHOWN / columns.len().max(rows.len()) as u32).max(1);
    let part = |picture: &Picture| {
        let size = [columns.len() as u32 * factor, rows.len() as u32 * factor];
        let pixel = |x: u32, y: u32| {
            let (column, row) = (columns.start + x / factor, rows.start + y / factor);
            picture.pixels[row as usize * picture.size[0] as usize + column as usize]
        };
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        Picture { size, pixels: pixels.map(|(x, y)| pixel(x, y)).collect() }
    };
    let [expected, difference, actual] = [&part(expected), &part(&difference(expected, actual)), &part(actual)];
    beside([expected, difference, actual])
}

/// Draws a frame around a part of a picture, so that even a single pixel in it is found.
fn frame(picture: &mut Picture, [left, top, right, bottom]: [u32; 4]) {
    const DISTANCE: i64 = 6;
    const WIDTH: i64 = 2;
    let [width, height] = picture.size.map(i64::from);
    let [left, top, right, bottom] = [left, top, right, bottom].map(i64::from);
    for y in (top - DISTANCE - WIDTH).max(0)..(bottom + DISTANCE + WIDTH + 1).min(height) {
        for x in (left - DISTANCE - WIDTH).max(0)..(right + DISTANCE + WIDTH + 1).min(width) {
            let is_outside = x < left - DISTANCE || x > right + DISTANCE || y < top - DISTANCE || y > bottom + DISTANCE;
            if is_outside {
                picture.pixels[(y * width + x) as usize] = canvas::pixel(Color::hex(0xd000d0));
            }
        }
    }
}

/// Joins three pictures, with gaps between them.
fn beside(panels: [&Picture; 3]) -> Picture {
    let widths = panels.map(|panel| panel.size[0] as usize);
    let height = panels.iter().map(|panel| panel.size[1]).max().unwrap_or(0);
    let width = widths.iter().sum::<usize>() + 2 * GAP;
    let mut pixels = vec![canvas::pixel(Color::hex(0x808080)); width * height as usize];
    let mut left = 0;
    for panel in panels {
        for (row, from) in panel.rows().enumerate() {
            pixels[row * width + left..][..from.len()].copy_from_slice(from);
        }
        left += panel.size[0] as usize + GAP;
    }
    Picture { size: [width as u32, height], pixels }
}

fn difference(expected: &Picture, actual: &Picture) -> Picture {
    let mut marked = expected.clone();
    marked.pixels.iter_mut().for_each(|pixel| *pixel = faded(*pixel));
    let width = expected.size[0].min(actual.size[0]) as usize;
    let rows = marked.pixels.chunks_exact_mut(expected.size[0] as usize);
    for ((row, expected), actual) in rows.zip(expected.rows()).zip(actual.rows()) {
        for column in (0..width).filter(|&column| expected[column] != actual[column]) {
            row[column] = canvas::pixel(Color::hex(0xe00000));
        }
    }
    marked
}

/// The pixel in grey, with its distance to white reduced to a quarter.
fn faded([r, g, b, _]: [u8; 4]) -> [u8; 4] {
    let gray = Color::rgb(r, g, b).luma() as u8;
    let faded = 191 + gray / 4;
    [faded, faded, faded, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(size: [u32; 2]) -> Picture {
        Picture { size, pixels: vec![[128, 128, 128, 255]; (size[0] * size[1]) as usize] }
    }

    #[test]
    fn equal_pictures_are_the_same() {
        assert_eq!(compare(&gray([4, 3]), &gray([4, 3])), Comparison::Same);
    }

    #[test]
    fn one_bit_of_one_pixel_is_a_difference() {
        let mut other = gray([4, 3]);
        other.pixels[6][2] ^= 1;
        let expected = Difference { count: 1, first: [2, 1], bounds: [2, 1, 2, 1] };
        let comparison = compare(&gray([4, 3]), &other);
        assert_eq!(comparison, Comparison::Pixels(expected));
        assert_eq!(comparison.to_string(), "1 pixel differs, at (2, 1)");
    }

    #[test]
    fn the_bounds_contain_all_differing_pixels() {
        let mut other = gray([5, 4]);
        for at in [3, 6, 17] {
            other.pixels[at][0] = 0;
        }
        let comparison = compare(&gray([5, 4]), &other);
        let expected = Difference { count: 3, first: [3, 0], bounds: [1, 0, 3, 3] };
        assert_eq!(comparison, Comparison::Pixels(expected));
        assert_eq!(comparison.to_string(), "3 pixels differ, the first at (3, 0), all from (1, 0) to (3, 3)");
    }

    #[test]
    fn pixels_of_pictures_of_different_sizes_are_not_compared() {
        let comparison = compare(&gray([4, 3]), &gray([3, 4]));
        assert_eq!(comparison.to_string(), "3×4 pixels, expected 4×3");
    }

    #[test]
    fn differing_pixels_are_red_in_the_middle_panel() {
        let mut other = gray([4, 3]);
        other.pixels[5][1] = 0;
        let panels = side_by_side(&gray([4, 3]), &other);
        assert_eq!(panels.size, [12 + 2 * GAP as u32, 3]);
        let red: Vec<usize> = (0..panels.pixels.len()).filter(|&at| panels.pixels[at] == [0xe0, 0, 0, 255]).collect();
        assert_eq!(red, [panels.size[0] as usize + 4 + GAP + 1]);
    }

    #[test]
    fn a_single_pixel_is_framed_and_magnified() {
        let mut other = gray([200, 100]);
        other.pixels[60 * 200 + 90][0] ^= 1;
        let Comparison::Pixels(found) = compare(&gray([200, 100]), &other) else { panic!("a difference") };
        let whole = side_by_side(&gray([200, 100]), &other);
        let frame = canvas::pixel(Color::hex(0xd000d0));
        let framed: Vec<usize> = (0..whole.pixels.len()).filter(|&at| whole.pixels[at] == frame).collect();
        let column = |at: usize| at % whole.size[0] as usize - 200 - GAP;
        assert!(framed.iter().all(|&at| (82..=98).contains(&column(at))), "the middle panel, around column 90");
        assert_eq!(framed.len(), 17 * 17 - 13 * 13);
        let large = magnified(&gray([200, 100]), &other, &found);
        assert_eq!(large.size, [3 * 17 * 18 + 2 * GAP as u32, 17 * 18]);
        let red = large.pixels.iter().filter(|&&pixel| pixel == [0xe0, 0, 0, 255]).count();
        assert_eq!(red, 18 * 18, "one pixel, magnified");
    }

    #[test]
    fn differences_far_apart_are_magnified_near_the_first_one() {
        let mut other = gray([400, 300]);
        for at in [3, 400 * 299 + 399] {
            other.pixels[at][0] ^= 1;
        }
        let Comparison::Pixels(found) = compare(&gray([400, 300]), &other) else { panic!("a difference") };
        assert_eq!(magnified(&gray([400, 300]), &other, &found).size, [3 * 64 * 5 + 2 * GAP as u32, 64 * 5]);
    }

    #[test]
    fn panels_may_have_different_sizes() {
        assert_eq!(side_by_side(&gray([4, 3]), &gray([2, 5])).size, [10 + 2 * GAP as u32, 5]);
    }
}
