//! Patterns of dashes, which distinguish lines of one colour.

use crate::physics::{Vector, larger};
use crate::picture::{Ink, Shape};

/// The pattern of the dashes of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DashPattern(&'static [f64]);

/// The lengths of the drawn parts and of the gaps after them, in line widths, by pattern: solid, dashed, dotted,
/// dash-dotted. The round ends of a part extend it by half a line width each.
const PATTERNS: [&[f64]; 4] = [&[], &[5.0, 4.0], &[0.01, 2.5], &[6.0, 3.0, 0.01, 3.0]];

/// The largest number of periods of a line. The dashes of a line that is very long become longer.
const MAX_PERIODS: f64 = 10_000.0;

impl DashPattern {
    /// A solid line.
    pub const SOLID: DashPattern = DashPattern(PATTERNS[0]);

    /// The pattern of the line with this number among those of one colour: the first one is solid.
    pub fn of_number(number: usize) -> DashPattern {
        DashPattern(PATTERNS[number % PATTERNS.len()])
    }

    /// The shapes of a line through points.
    pub fn draw(self, points: Vec<Vector>, width: f64, ink: Ink) -> Vec<Shape> {
        let line = |points| Shape::Polyline { points, width, ink };
        let length: f64 = points.windows(2).map(|ends| ends[1].sub(ends[0]).norm()).sum();
        let period = width * self.0.iter().sum::<f64>();
        if !(period > 0.0 && length.is_finite()) {
            return vec![line(points)];
        }
        let scale = width * larger(length / (MAX_PERIODS * period), 1.0);
        let lengths: Vec<f64> = self.0.iter().map(|part| part * scale).collect();
        drawn_parts(&points, &lengths).into_iter().map(line).collect()
    }
}

/// The parts of a line that are drawn. `lengths` are those of a part, of the gap after it, of the next part and so on,
/// px.
fn drawn_parts(points: &[Vector], lengths: &[f64]) -> Vec<Vec<Vector>> {
    let (mut parts, mut part) = (Vec::new(), points.first().copied().into_iter().collect::<Vec<Vector>>());
    let (mut number, mut left) = (0, lengths[0]);
    for ends in points.windows(2) {
        let way = ends[1].sub(ends[0]);
        let (length, mut gone) = (way.norm(), 0.0);
        while length - gone > left {
            gone += left;
            part.push(ends[0].add(way.mult(gone / length)));
            if number % 2 == 0 {
                parts.push(std::mem::take(&mut part));
            }
            number = (number + 1) % lengths.len();
            left = lengths[number];
        }
        left -= length - gone;
        if number % 2 == 0 {
            part.push(ends[1]);
        } else {
            part.clear();
        }
    }
    parts.extend((part.len() > 1).then_some(part));
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Color;

    #[test]
    fn dashes_and_gaps_alternate_around_corners() {
        let at = Vector::new;
        let parts = drawn_parts(&[at(0.0, 0.0), at(4.0, 0.0), at(4.0, 10.0)], &[3.0, 2.0]);
        let expected: [&[Vector]; 3] =
            [&[at(0.0, 0.0), at(3.0, 0.0)], &[at(4.0, 1.0), at(4.0, 4.0)], &[at(4.0, 6.0), at(4.0, 9.0)]];
        assert_eq!(parts, expected);
        let corner = drawn_parts(&[at(0.0, 0.0), at(4.0, 0.0), at(4.0, 10.0)], &[6.0, 100.0]);
        assert_eq!(corner, [[at(0.0, 0.0), at(4.0, 0.0), at(4.0, 2.0)]]);
    }

    #[test]
    fn a_line_has_a_bounded_number_of_dashes() {
        let ink = Ink::from(Color::hex(0));
        let zigzag: Vec<Vector> =
            (0..10_000).map(|at| Vector::new(0.1 * f64::from(at), f64::from(at % 2) * 1e3)).collect();
        for number in 0..8 {
            let shapes = DashPattern::of_number(number).draw(zigzag.clone(), 2.0, ink);
            assert!(shapes.len() <= 2 * MAX_PERIODS as usize + 2, "{number}: {}", shapes.len());
            assert_eq!(shapes.len() == 1, number % 4 == 0, "{number}");
        }
        let endless = vec![Vector::ZERO, Vector::new(f64::INFINITY, 0.0)];
        assert_eq!(DashPattern::of_number(1).draw(endless, 2.0, ink).len(), 1);
    }
}
