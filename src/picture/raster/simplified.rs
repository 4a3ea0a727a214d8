use crate::physics::Vector;

/// The largest distance of a dropped point from the line through the points that are kept, px. Smaller than any
/// renderer shows.
const TOLERANCE: f64 = 0.01;

/// The points of a polyline without those that are within 1/100 px of the straight line between their neighbours.
///
/// From each kept point, the directions that pass close enough to all points since then form a wedge; the line goes on
/// until a point is outside of the wedge or turns back (after Williams, "An efficient algorithm for the piecewise
/// linear approximation of planar curves", 1978). The time is proportional to the number of points.
pub fn simplified(points: &[Vector]) -> Vec<Vector> {
    let mut kept: Vec<Vector> = points.first().copied().into_iter().collect();
    let mut line: Option<Wedge> = None;
    for pair in points.windows(2) {
        let [last, next] = [pair[0], pair[1]];
        let is_straight = line.as_ref().is_none_or(|wedge| wedge.continues_to(last, next));
        if !is_straight {
            kept.push(last);
            line = None;
        }
        let wedge = line.get_or_insert(Wedge { from: last, sides: None });
        wedge.narrow(next);
    }
    kept.extend(points.get(1..).and_then(<[Vector]>::last));
    kept
}

/// The directions of lines from a point that pass all points since then within the tolerance.
struct Wedge {
    from: Vector,
    /// The bounding directions, the second one clockwise from the first on the page; `None` for all directions.
    sides: Option<[Vector; 2]>,
}

impl Wedge {
    /// Returns true if the straight line to `next` passes all points so far and does not turn back after `last`.
    fn continues_to(&self, last: Vector, next: Vector) -> bool {
        let direction = next.sub(self.from);
        let is_ahead = direction.dot(next.sub(last)) >= 0.0 && direction.dot(last.sub(self.from)) >= 0.0;
        let is_within =
            |[first, second]: [Vector; 2]| cross(first, direction) >= 0.0 && cross(direction, second) >= 0.0;
        direction.is_finite() && is_ahead && self.sides.is_none_or(is_within)
    }

    /// Excludes the directions that do not pass `point`.
    fn narrow(&mut self, point: Vector) {
        let to = point.sub(self.from);
        let distance = to.norm();
        if distance <= TOLERANCE || !distance.is_finite() {
            return;
        }
        // The tangents to the circle around the point.
        let (along, across) = ((1.0 - (TOLERANCE / distance) * (TOLERANCE / distance)).sqrt(), TOLERANCE / distance);
        let normal = Vector::new(-to.y, to.x);
        let [first, second] = [-across, across].map(|across| to.mult(along).add(normal.mult(across)));
        self.sides = Some(match self.sides {
            None => [first, second],
            Some([old_first, old_second]) => [
                if cross(old_first, first) > 0.0 { first } else { old_first },
                if cross(second, old_second) > 0.0 { second } else { old_second },
            ],
        });
    }
}

fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{larger, smaller};

    fn points(coordinates: &[[f64; 2]]) -> Vec<Vector> {
        coordinates.iter().map(|&[x, y]| Vector::new(x, y)).collect()
    }

    #[test]
    fn points_on_straight_lines_are_dropped_and_corners_are_kept() {
        let corners = points(&[[0.0, 0.0], [100.0, 50.0], [200.0, 0.0], [200.0, 80.0]]);
        let mut dense = vec![corners[0]];
        for side in corners.windows(2) {
            dense.extend((1..=100).map(|at| side[0].add(side[1].sub(side[0]).mult(f64::from(at) / 100.0))));
        }
        assert_eq!(simplified(&dense), corners);
        let back = points(&[[0.0, 0.0], [9.0, 0.0], [5.0, 0.0]]);
        assert_eq!(simplified(&back), back);
        for few in [&back[..0], &back[..1], &back[..2]] {
            assert_eq!(simplified(few), few);
        }
    }

    #[test]
    fn every_dropped_point_is_within_the_tolerance_of_the_line() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        for roughness in [0.001, 0.01, 0.1, 3.0] {
            let mut at = Vector::ZERO;
            let walk: Vec<Vector> = (0..2000)
                .map(|_| {
                    at = at.add(Vector::new(0.2 + roughness * random(), roughness * random()));
                    at
                })
                .collect();
            let kept = simplified(&walk);
            let distance = |point: &Vector| {
                let sides = kept.windows(2).map(|side| {
                    let along = side[1].sub(side[0]);
                    let part = point.sub(side[0]).dot(along) / along.dot(along);
                    point.sub(side[0].add(along.mult(smaller(larger(part, 0.0), 1.0)))).norm()
                });
                sides.fold(f64::INFINITY, smaller)
            };
            assert!(walk.iter().all(|point| distance(point) <= 1.001 * TOLERANCE), "roughness {roughness}");
            assert!(roughness > 0.01 || kept.len() < walk.len() / 4, "{} of {}", kept.len(), walk.len());
        }
    }

    #[test]
    fn extreme_points_are_kept() {
        let extreme = points(&[[0.0, 0.0], [f64::NAN, 1.0], [1e300, f64::INFINITY], [2.0, 2.0]]);
        assert_eq!(simplified(&extreme).len(), 4);
    }
}
