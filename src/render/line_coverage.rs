//! How much of each pixel a line covers: by its distance from the pixel's middle, which is
//! many times faster than the outline of the line filled as a path, and has round ends.

use super::area::{larger, smaller};
use super::canvas::Clip;
use super::stencil::sixteenths;
use crate::physics::Vector;
use std::ops::Range;

/// The pixels that a line can touch within `clip`, if there are any.
pub fn bounds(points: &[Vector], width: f64, clip: &Clip) -> Option<Clip> {
    let first = *points.first()?;
    let low = points.iter().fold(first, |low, at| Vector::new(smaller(at.x, low.x), smaller(at.y, low.y)));
    let high = points.iter().fold(first, |high, at| Vector::new(larger(at.x, high.x), larger(at.y, high.y)));
    let reach = reach(width);
    let columns = pixels(low.x - reach, high.x + reach, clip.left..clip.right);
    let rows = pixels(low.y - reach, high.y + reach, clip.top..clip.bottom);
    let bounds = Clip { left: columns.start, top: rows.start, right: columns.end, bottom: rows.end };
    (!columns.is_empty() && !rows.is_empty()).then_some(bounds)
}

/// The sixteenths that a line covers of the pixels within `bounds`, row by row.
pub fn coverage(points: &[Vector], width: f64, bounds: &Clip) -> Vec<u8> {
    let columns = bounds.right - bounds.left;
    let mut coverage = vec![0; columns * (bounds.bottom - bounds.top)];
    let add = |from: Vector, to: Vector, coverage: &mut [u8]| {
        let piece = Piece { from, along: to.sub(from), width };
        for row in piece.rows(bounds) {
            let start = (row - bounds.top) * columns;
            piece.cover(row, bounds, &mut coverage[start..start + columns]);
        }
    };
    for pair in points.windows(2) {
        add(pair[0], pair[1], &mut coverage);
    }
    if let [only] = points {
        add(*only, *only, &mut coverage);
    }
    coverage
}

/// How far from its middle a line still touches pixels' middles, px.
fn reach(width: f64) -> f64 {
    width / 2.0 + 0.5
}

/// The pixels between two coordinates that are in a range.
fn pixels(from: f64, to: f64, range: Range<usize>) -> Range<usize> {
    let within = |at: i64| at.clamp(range.start as i64, range.end as i64) as usize;
    within(from.floor() as i64)..within((to.floor() as i64).saturating_add(1))
}

/// A straight piece of a line.
struct Piece {
    from: Vector,
    along: Vector,
    width: f64,
}

impl Piece {
    fn rows(&self, bounds: &Clip) -> Range<usize> {
        let (from, to) = (self.from.y, self.from.y + self.along.y);
        let reach = reach(self.width);
        pixels(smaller(from, to) - reach, larger(from, to) + reach, bounds.top..bounds.bottom)
    }

    /// The columns of a row that are near: a piece that is long and slanted touches few.
    fn columns(&self, middle: f64, bounds: &Clip) -> Range<usize> {
        let (from, to) = (self.from.x, self.from.x + self.along.x);
        let reach = reach(self.width);
        let (mut low, mut high) = (smaller(from, to) - reach, larger(from, to) + reach);
        if self.along.y != 0.0 {
            let x = from + (middle - self.from.y) * (self.along.x / self.along.y);
            let spread = reach * (self.along.norm() / self.along.y.abs());
            (low, high) = (larger(x - spread, low), smaller(x + spread, high));
        }
        pixels(low, high, bounds.left..bounds.right)
    }

    /// Where it covers more of a pixel than is covered already, it counts.
    fn cover(&self, row: usize, bounds: &Clip, coverage: &mut [u8]) {
        let middle = row as f64 + 0.5;
        for column in self.columns(middle, bounds) {
            let part = self.part(Vector::new(column as f64 + 0.5, middle));
            let covered = &mut coverage[column - bounds.left];
            *covered = sixteenths(part).max(*covered);
        }
    }

    /// The part of a pixel that it covers, by the distance of the pixel's middle.
    fn part(&self, at: Vector) -> f64 {
        let aside = at.sub(self.from);
        let (along, length) = (aside.dot(self.along), self.along.dot(self.along));
        let place = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
        let distance = aside.sub(self.along.mult(place)).norm();
        let most = smaller(self.width, 1.0);
        (reach(self.width) - distance).clamp(0.0, most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: Clip = Clip { left: 0, top: 0, right: 8, bottom: 5 };

    /// Sixteenths, row by row, of the whole page.
    fn drawn(points: &[[f64; 2]], width: f64) -> Vec<Vec<u8>> {
        let points: Vec<Vector> = points.iter().map(|&[x, y]| Vector::new(x, y)).collect();
        let coverage = coverage(&points, width, &PAGE);
        coverage.chunks(8).map(<[u8]>::to_vec).collect()
    }

    #[test]
    fn a_line_along_pixels_covers_them_whole() {
        let rows = drawn(&[[2.5, 2.5], [5.5, 2.5]], 1.0);
        assert_eq!(rows[2], [0, 0, 16, 16, 16, 16, 0, 0]);
        assert!(rows.iter().enumerate().all(|(row, covered)| row == 2 || covered == &[0; 8]));
    }

    #[test]
    fn a_line_between_pixels_covers_halves() {
        let rows = drawn(&[[2.5, 2.0], [5.5, 2.0]], 1.0);
        assert_eq!([&rows[1][2..6], &rows[2][2..6]], [[8; 4], [8; 4]]);
    }

    #[test]
    fn a_thin_line_is_faint() {
        assert_eq!(drawn(&[[2.5, 2.5], [5.5, 2.5]], 0.25)[2][3], 4);
    }

    #[test]
    fn pieces_that_meet_are_not_laid_over_one_another() {
        let bent = drawn(&[[1.5, 2.5], [4.5, 2.5], [6.5, 2.5]], 1.0);
        assert_eq!(bent, drawn(&[[1.5, 2.5], [6.5, 2.5]], 1.0));
    }

    #[test]
    fn a_slanted_line_covers_what_is_near_in_every_row() {
        let rows = drawn(&[[-3.0, -4.0], [10.0, 9.0]], 2.0);
        for (row, covered) in rows.iter().enumerate() {
            let expected = (0..8).map(|column| {
                let distance = (column as f64 - 1.0 - row as f64).abs() / 2.0_f64.sqrt();
                sixteenths((1.5 - distance).clamp(0.0, 1.0))
            });
            assert_eq!(*covered, expected.collect::<Vec<u8>>(), "row {row}");
        }
    }

    #[test]
    fn lines_outside_or_beyond_all_measure_are_cut_off() {
        let line = |from: [f64; 2], to: [f64; 2]| {
            let points = [from, to].map(|[x, y]| Vector::new(x, y));
            bounds(&points, 2.0, &PAGE).map(|bounds| coverage(&points, 2.0, &bounds))
        };
        assert_eq!(line([-9.0, 0.0], [-5.0, 3.0]), None);
        assert!(line([-1e9, 2.5], [1e9, 2.5]).unwrap().contains(&16));
        for strange in [f64::NAN, f64::INFINITY, 1e300] {
            line([0.0, 0.0], [strange, strange]);
            line([strange, -strange], [3.0, 3.0]);
        }
    }
}
