//! Swept AABBs: axis-aligned rectangles around all positions of a body for some time.

use super::body_state::BodyState;
use super::pair_event::{Sample, tolerance};
use crate::physics::{Axis, larger, smaller};

/// Enlargement relative to the magnitude of the coordinates: more than the rounding to single precision.
const MARGIN: f64 = 1.0 / (1_u64 << 22) as f64;

/// Maximum time, s: longer than any run, with a finite square.
const MAX_SECONDS: f64 = 1e150;

/// A rectangle around a box, or around all its positions for some time, rounded outwards to single precision.
///
/// If the rectangles of two bodies are disjoint, the bodies do not touch in that time, so no prediction is needed for
/// the pair. Single precision suffices and halves the memory.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub struct SweptAabb {
    /// Lower x, lower y, −upper x, −upper y, m.
    borders: [f32; 4],
}

impl SweptAabb {
    /// The whole plane: the rectangle of a body without a valid prediction.
    pub const EVERYWHERE: SweptAabb = SweptAabb { borders: [f32::NEG_INFINITY; 4] };

    /// The rectangle that covers a body for a number of seconds from the sample on.
    ///
    /// A parabola leaves the span of p and p + v·t by at most ½·a·t², and only on the side towards
    /// which it accelerates.
    #[inline]
    pub fn new(sample: &Sample, seconds: f64) -> SweptAabb {
        let body: &BodyState = sample.body;
        let seconds = smaller(seconds, MAX_SECONDS);
        let from = sample.position;
        let to = Axis::BOTH.map(|axis| from[axis] + sample.velocity[axis] * seconds);
        let mut low = Axis::BOTH.map(|axis| smaller(from[axis], to[axis]));
        let mut high = Axis::BOTH.map(|axis| larger(from[axis], to[axis]));
        let mut magnitudes = Axis::BOTH.map(|axis| low[axis].abs() + high[axis].abs() + body.size[axis]);
        if body.trajectory.acceleration != [0.0; 2] {
            let deflection = body.trajectory.acceleration.map(|acceleration| 0.5 * acceleration * (seconds * seconds));
            let end = Axis::BOTH.map(|axis| to[axis] + deflection[axis]);
            // The comparisons select `end` if it is NaN.
            low = Axis::BOTH.map(|axis| if end[axis] >= low[axis] { low[axis] } else { end[axis] });
            high = Axis::BOTH.map(|axis| if end[axis] <= high[axis] { high[axis] } else { end[axis] });
            magnitudes = Axis::BOTH.map(|axis| magnitudes[axis] + deflection[axis].abs());
        }
        let margins = Axis::BOTH.map(|axis| magnitudes[axis] * MARGIN + tolerance(sample.magnitude[axis]));
        let lower = Axis::BOTH.map(|axis| (low[axis] - margins[axis]) as f32);
        let upper = Axis::BOTH.map(|axis| (-(high[axis] + body.size[axis]) - margins[axis]) as f32);
        SweptAabb { borders: [lower[0], lower[1], upper[0], upper[1]] }
    }

    /// The rectangle with these borders, the upper ones negated.
    #[cfg(test)]
    pub fn of(borders: [f32; 4]) -> SweptAabb {
        SweptAabb { borders }
    }

    /// The rectangle with all borders moved outwards by a distance in m, or where it is too small for single precision,
    /// left as they are.
    #[inline]
    pub fn enlarged(&self, by: f32) -> SweptAabb {
        SweptAabb { borders: self.borders.map(|border| border - by) }
    }

    /// Returns true if `other` does not extend beyond this rectangle; false if a border is NaN.
    #[inline]
    pub fn contains(&self, other: &SweptAabb) -> bool {
        let [a, b] = [self.borders, other.borders];
        (a[0] <= b[0]) & (a[1] <= b[1]) & (a[2] <= b[2]) & (a[3] <= b[3])
    }

    /// The lower and the upper corner, m.
    #[inline]
    pub fn corners(&self) -> [[f64; 2]; 2] {
        let [left, top, right, bottom] = self.borders.map(f64::from);
        [[left, top], [-right, -bottom]]
    }

    /// The centre, m.
    #[inline]
    pub fn centre(&self) -> [f64; 2] {
        let [low, high] = self.corners();
        Axis::BOTH.map(|axis| 0.5 * (low[axis] + high[axis]))
    }

    /// The longer side, m.
    #[inline]
    pub fn longer_side(&self) -> f64 {
        let [low, high] = self.corners();
        let [width, height] = Axis::BOTH.map(|axis| high[axis] - low[axis]);
        larger(width, height)
    }

    /// Returns true if the rectangles have no point in common; false if a border is NaN.
    #[inline]
    pub fn is_disjoint_from(&self, other: &SweptAabb) -> bool {
        let [left, top, right, bottom] = self.borders.map(|border| -border);
        let borders = other.borders;
        // Written so that it compiles to one comparison of four numbers, without arithmetic if `self` is the same
        // several times.
        (borders[0] > right) | (borders[1] > bottom) | (borders[2] > left) | (borders[3] > top)
    }

    /// Returns true if the gap between the rectangles along an axis is greater than a distance in m, negative for an
    /// overlap; false if a border is NaN.
    #[inline]
    pub fn is_farther_from(&self, other: &SweptAabb, distance: f32) -> bool {
        let [a, b] = [self.borders, other.borders];
        // Written so that it compiles to one comparison of four numbers.
        let gaps = [a[2] + b[0], a[3] + b[1], a[0] + b[2], a[1] + b[3]];
        (gaps[0] > distance) | (gaps[1] > distance) | (gaps[2] > distance) | (gaps[3] > distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::axis_trajectory::AxisTrajectory;
    use crate::physics::event_driven::body_state::Load;
    use crate::physics::event_driven::instant::Instant;
    use crate::physics::event_driven::trajectory::Trajectory;

    /// A unit box at the origin: velocity and acceleration along y.
    fn body(velocity: f64, acceleration: f64) -> BodyState {
        let since = Instant::START;
        let along = |velocity: f64, acceleration: f64| AxisTrajectory { position: 0.0, velocity, acceleration, since };
        let trajectory = Trajectory::new([along(0.0, 0.0), along(velocity, acceleration)]);
        BodyState {
            trajectory,
            size: [1.0; 2],
            since,
            generation: 0,
            world_index: 0,
            infinite: false,
            load: [Load::GravityOnly; 2],
        }
    }

    fn swept(body: &BodyState, seconds: f64) -> SweptAabb {
        SweptAabb::new(&Sample::new(body, Instant::START), seconds)
    }

    #[test]
    fn the_aabb_of_a_thrown_box_contains_its_highest_and_its_last_position() {
        let thrown = swept(&body(-4.0, 2.0), 5.0);
        let [left, top, right, bottom] = thrown.borders;
        assert!(top <= -4.0 && -bottom >= 6.0);
        assert!(left <= 0.0 && left > -1e-5 && -right < 1.0 + 1e-5, "no motion along x");
    }

    #[test]
    fn the_aabbs_of_touching_boxes_are_not_disjoint() {
        let standing = swept(&body(0.0, 0.0), f64::INFINITY);
        let below = SweptAabb { borders: [0.0, 1.0, -1.0, -2.0] };
        assert!(!standing.is_disjoint_from(&below) && !below.is_disjoint_from(&standing));
        let separate = SweptAabb { borders: [0.0, 1.5, -1.0, -2.0] };
        assert!(standing.is_disjoint_from(&separate) && separate.is_disjoint_from(&standing));
        assert!(!swept(&body(1.0, 0.0), 0.75).is_disjoint_from(&separate));
        assert!([standing, SweptAabb::EVERYWHERE].iter().all(|other| !SweptAabb::EVERYWHERE.is_disjoint_from(other)));
    }

    #[test]
    fn the_aabb_of_a_decelerating_box_extends_to_both_sides_without_limit() {
        let thrown = swept(&body(4.0, -2.0), f64::INFINITY);
        assert!(!thrown.is_disjoint_from(&SweptAabb { borders: [0.0, -1e9, -1.0, 1e9] }));
    }
}
