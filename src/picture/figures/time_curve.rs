//! A curve over time, reduced to the points that a page can show.

use crate::physics::{larger, smaller};

/// A curve over time, whose memory is bounded by the width of the page and not by the number of its points.
///
/// Time is divided into columns. Of the points of a column, the first, the lowest, the highest and the last are kept,
/// which changes no pixel if a column is at most a pixel wide (Jugel, Jerzak, Hackenbroich, Markl: M4, PVLDB 7, 2014).
/// Points on a straight line between their neighbours are dropped, too.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeCurve {
    /// Width of a column, s; 0 keeps all points.
    column_width: f64,
    /// The parts of the curve, each without a gap: time (s) and value.
    parts: Vec<Vec<[f64; 2]>>,
    /// The points of the current column, with their numbers.
    column: Option<Column>,
    count: u64,
    has_overflow: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Column {
    number: f64,
    /// The first, lowest, highest and last point, each with its number.
    kept: [(u64, [f64; 2]); 4],
}

/// Values that deviate from a straight line by less than this part of their size are on it: some rounding errors.
const STRAIGHT: f64 = 1e-12;

impl TimeCurve {
    /// Creates an empty curve with columns of `column_width` seconds.
    pub fn new(column_width: f64) -> TimeCurve {
        TimeCurve { column_width, parts: vec![Vec::new()], column: None, count: 0, has_overflow: false }
    }

    /// Adds a point. Times must not decrease; two points at the same time are a vertical step. A value that is not
    /// finite is left out.
    pub fn push(&mut self, time: f64, value: f64) {
        if !(time.is_finite() && value.is_finite()) {
            self.has_overflow = true;
            return;
        }
        self.count += 1;
        let column = if self.column_width > 0.0 { (time / self.column_width).floor() } else { self.count as f64 };
        let (number, point) = (column, (self.count, [time, value]));
        match &mut self.column {
            Some(column) if column.number == number => {
                let [_, lowest, highest, last] = &mut column.kept;
                if value < lowest.1[1] {
                    *lowest = point;
                }
                if value > highest.1[1] {
                    *highest = point;
                }
                *last = point;
            }
            Some(_) | None => {
                self.end_column();
                self.column = Some(Column { number, kept: [point; 4] });
            }
        }
    }

    /// Ends the present part: the next point is not joined to the last one.
    pub fn interrupt(&mut self) {
        self.end_column();
        if self.parts.last().is_some_and(|part| !part.is_empty()) {
            self.parts.push(Vec::new());
        }
    }

    /// The parts of the curve, each without a gap: time (s) and value.
    pub fn parts(&self) -> Vec<Vec<[f64; 2]>> {
        let mut complete = self.clone();
        complete.end_column();
        complete.parts.retain(|part| !part.is_empty());
        complete.parts
    }

    /// The lower and the upper end of a body of this extent whose lower end is the curve, in each part. In a column in
    /// which the body moves by more than its extent, these are the lowest and the highest place that it reaches, so
    /// that the band between them has no more corners than pixels.
    pub fn bands(&self, extent: f64) -> Vec<[Vec<[f64; 2]>; 2]> {
        let column = |point: &[f64; 2]| (point[0] / self.column_width).floor();
        let is_in_one = |a: &[f64; 2], b: &[f64; 2]| self.column_width > 0.0 && column(a) == column(b);
        let band = |part: Vec<[f64; 2]>| {
            let mut ends = [Vec::new(), Vec::new()];
            for points in part.chunk_by(is_in_one) {
                let lowest = points.iter().map(|point| point[1]).fold(f64::INFINITY, smaller);
                let highest = points.iter().map(|point| point[1]).fold(f64::NEG_INFINITY, larger);
                if highest - lowest > extent {
                    let times = [points[0][0], points[points.len() - 1][0]];
                    ends[0].extend(times.map(|time| [time, lowest]));
                    ends[1].extend(times.map(|time| [time, highest + extent]));
                } else {
                    ends[0].extend(points);
                    ends[1].extend(points.iter().map(|[time, value]| [*time, value + extent]));
                }
            }
            ends
        };
        self.parts().into_iter().map(band).collect()
    }

    /// Returns true if a value was left out.
    pub fn has_overflow(&self) -> bool {
        self.has_overflow
    }

    /// The kept values.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        let in_column = self.column.iter().flat_map(|column| column.kept.iter().map(|kept| kept.1[1]));
        self.parts.iter().flatten().map(|point| point[1]).chain(in_column)
    }

    fn end_column(&mut self) {
        let Some(mut column) = self.column.take() else { return };
        column.kept.sort_by_key(|kept| kept.0);
        let mut last = 0;
        for (number, point) in column.kept {
            if number != last {
                self.keep(point);
                last = number;
            }
        }
    }

    /// Adds a point to the present part, in place of the last one if that is on the straight line to it.
    fn keep(&mut self, point: [f64; 2]) {
        if let Some(part) = self.parts.last_mut() {
            if let [.., start, last] = part.as_slice()
                && is_straight(*start, *last, point)
            {
                part.pop();
            }
            part.push(point);
        }
    }
}

/// Returns true if `middle` is on the straight line from `start` to `end`, which is not vertical.
fn is_straight(start: [f64; 2], middle: [f64; 2], end: [f64; 2]) -> bool {
    let (before, whole) = (middle[0] - start[0], end[0] - start[0]);
    let size = [start, middle, end].map(|point| point[1].abs()).into_iter().fold(0.0, larger);
    let on_line = start[1] + (end[1] - start[1]) * (before / whole);
    before > 0.0 && middle[0] < end[0] && (middle[1] - on_line).abs() <= STRAIGHT * size
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(column_width: f64, points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        let mut curve = TimeCurve::new(column_width);
        points.iter().for_each(|point| curve.push(point[0], point[1]));
        curve.parts()
    }

    #[test]
    fn every_extreme_of_every_column_is_kept_in_few_points() {
        let wave: Vec<[f64; 2]> =
            (0..100_000).map(|at| [f64::from(at) * 1e-5, f64::from(at * 7919 % 1000) * f64::from(at % 17)]).collect();
        let parts = curve(0.01, &wave);
        assert!(parts.len() == 1 && parts[0].len() <= 4 * 101, "{}", parts[0].len());
        for column in 0..100 {
            let within = |point: &&[f64; 2]| (point[0] / 0.01).floor() == f64::from(column);
            let extremes = |points: &[[f64; 2]]| {
                let values = points.iter().filter(within).map(|point| point[1]);
                (values.clone().fold(f64::INFINITY, smaller), values.fold(0.0, larger))
            };
            assert_eq!(extremes(&parts[0]), extremes(&wave), "column {column}");
        }
    }

    #[test]
    fn corners_and_vertical_steps_are_kept_exactly_and_straight_lines_have_two_points() {
        let line: Vec<[f64; 2]> = (0..=1000).map(|at| [f64::from(at), 0.1 * f64::from(at)]).collect();
        assert_eq!(curve(0.5, &line), [vec![[0.0, 0.0], [1000.0, 100.0]]]);
        let step = [[0.0, 5.0], [3.25, 5.0], [3.25, 2.0], [10.0, 2.0]];
        assert_eq!(curve(0.5, &step), [step.to_vec()]);
    }

    #[test]
    fn the_band_of_a_fast_body_is_the_range_of_each_column() {
        let mut fast = TimeCurve::new(1.0);
        let points = [[0.0, 5.0], [1.0, 5.5], [2.0, 1.0], [2.25, 9.0], [2.5, 0.5], [2.75, 4.0], [3.0, 6.0]];
        points.iter().for_each(|point| fast.push(point[0], point[1]));
        let [low, high] = &fast.bands(2.0)[0];
        assert_eq!(low, &[[0.0, 5.0], [1.0, 5.5], [2.0, 0.5], [2.75, 0.5], [3.0, 6.0]]);
        assert_eq!(high, &[[0.0, 7.0], [1.0, 7.5], [2.0, 11.0], [2.75, 11.0], [3.0, 8.0]]);
        let [low, high] = &fast.bands(10.0)[0];
        assert!(*low == points && high.iter().zip(low).all(|(high, low)| *high == [low[0], low[1] + 10.0]));
    }

    #[test]
    fn an_interrupted_curve_has_a_gap() {
        let mut gapped = TimeCurve::new(0.5);
        gapped.interrupt();
        for time in [0.0, 1.0, 5.0, 6.0] {
            if time == 5.0 {
                gapped.interrupt();
            }
            gapped.push(time, time);
        }
        gapped.push(7.0, f64::NAN);
        assert_eq!(gapped.parts(), [[[0.0, 0.0], [1.0, 1.0]], [[5.0, 5.0], [6.0, 6.0]]]);
    }
}
