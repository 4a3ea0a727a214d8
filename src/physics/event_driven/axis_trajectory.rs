//! The trajectory of a body along one axis: in doubles for predictions, in double-double arithmetic for collisions.
//!
//! A rounding error in one collision grows with each following one: under gravity the 16 digits of a
//! double are used up after a few hundred collisions. So trajectories are stored with 32 digits.
//! Predictions, far more frequent than events, use only the high parts.

use super::double_double::{DoubleDouble, Lanes};
use super::instant::Instant;

/// The ballistic trajectory of a body along one axis, from a reference instant on: x = p + v·t + ½·a·t².
///
/// Each axis has its own reference instant, so that an impact along x changes no bit of y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisTrajectory {
    /// Position at the reference instant, m.
    pub position: f64,
    /// Velocity at the reference instant, m/s.
    pub velocity: f64,
    /// Constant acceleration, m/s².
    pub acceleration: f64,
    /// The reference instant.
    pub since: Instant,
}

/// The time until a gap closes, s. The gap (m) shrinks at `speed` (m/s), which increases by `acceleration` (m/s²).
///
/// For the gap g, speed c and acceleration b this is the root of g − c·t − ½·b·t² = 0 at which the gap
/// is shrinking, or infinity if there is none. There the closing speed is s = √(c² + 2·b·g), so
/// t = (s − c)/b. For c > 0, t is computed as 2·g/(c + s), which avoids cancellation (the stable form of
/// the quadratic formula; Kahan, "On the cost of floating-point computation without extra-precise
/// arithmetic", 2004). A gap of exactly 0 that shrinks or starts to shrink closes at once; a negative gap
/// must open first.
#[inline]
pub fn closing_time(gap: f64, speed: f64, acceleration: f64) -> f64 {
    if acceleration == 0.0 {
        return if speed > 0.0 && gap >= 0.0 { gap / speed } else { f64::INFINITY };
    }
    let square = speed * speed + 2.0 * acceleration * gap;
    if square.abs() < SMALLEST_SQUARE || square.abs() > LARGEST_SQUARE {
        return closing_time_scaled(gap, speed, acceleration);
    }
    if square < 0.0 {
        return f64::INFINITY;
    }
    closing_root(gap, speed, acceleration, square.sqrt())
}

/// The root, given the closing speed at it.
#[inline]
fn closing_root(gap: f64, speed: f64, acceleration: f64, final_speed: f64) -> f64 {
    if speed > 0.0 {
        if gap >= 0.0 { 2.0 * gap / (speed + final_speed) } else { f64::INFINITY }
    } else if acceleration > 0.0 {
        (final_speed - speed) / acceleration
    } else {
        f64::INFINITY
    }
}

/// A square of a speed (m²/s²) below this may be rounded by underflow: it is a sum of products, and underflow rounds
/// each of them by up to 10⁻³²³.
pub const SMALLEST_SQUARE: f64 = 1e-250;

/// Partial results of a square of a speed (m²/s²) above this may overflow.
const LARGEST_SQUARE: f64 = 1e250;

/// Like [`closing_time`] where squares underflow or overflow: computed in other units of length.
#[cold]
fn closing_time_scaled(gap: f64, speed: f64, acceleration: f64) -> f64 {
    let mut greatest = 0.0;
    for number in [gap.abs(), speed.abs(), acceleration.abs()] {
        greatest = if number > greatest { number } else { greatest };
    }
    if greatest == 0.0 || !greatest.is_finite() {
        return f64::INFINITY;
    }
    let (mut scale, mut number) = (1.0, greatest);
    while number < 1.0 && scale < 1e300 {
        (scale, number) = (scale * 2.0, number * 2.0);
    }
    while number > 2.0 {
        (scale, number) = (scale * 0.5, number * 0.5);
    }
    let [gap, speed, acceleration] = [gap, speed, acceleration].map(|number| number * scale);
    let square = speed * speed + 2.0 * acceleration * gap;
    if square < 0.0 { f64::INFINITY } else { closing_root(gap, speed, acceleration, square.sqrt()) }
}

/// The low parts of the numbers of an [`AxisTrajectory`], which contains the high parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisLowParts {
    /// Low part of the position, m.
    pub position: f64,
    /// Low part of the velocity, m/s.
    pub velocity: f64,
    /// Low part of the acceleration, m/s².
    pub acceleration: f64,
    /// Low part of the size, m. It contains the change by which faces that decimal coordinates leave an ulp apart are
    /// made to coincide, so it can exceed half a unit in the last place of the size.
    pub size: f64,
}

/// The state of a body along one axis in double-double precision, or of two bodies side by side.
#[derive(Clone, Copy, Debug, Default)]
pub struct StateDd<T = f64> {
    /// Position, m.
    pub position: DoubleDouble<T>,
    /// Velocity, m/s.
    pub velocity: DoubleDouble<T>,
    /// Constant acceleration, m/s².
    pub acceleration: DoubleDouble<T>,
}

impl<T: Lanes> StateDd<T> {
    /// The state t seconds later, for zero acceleration.
    #[inline(always)]
    fn after_uniform(self, t: DoubleDouble<T>) -> StateDd<T> {
        StateDd { position: self.position + self.velocity * t, ..self }
    }

    /// The state t seconds later, for any acceleration. Always inlined: a call passes the numbers through memory.
    #[inline(always)]
    fn after_accelerated(self, t: DoubleDouble<T>) -> StateDd<T> {
        let StateDd { position, velocity, acceleration } = self;
        let gain = acceleration * t;
        StateDd { position: position + (velocity + gain.half()) * t, velocity: velocity + gain, acceleration }
    }
}

impl StateDd {
    /// Returns true if velocity and acceleration are zero.
    #[inline]
    pub fn is_at_rest(&self) -> bool {
        (self.velocity.high == 0.0) & (self.acceleration.high == 0.0)
    }

    /// The acceleration relative to another body, m/s²: most bodies have none.
    #[inline]
    pub fn acceleration_relative_to(&self, other: &StateDd) -> DoubleDouble {
        let are_uniform = (self.acceleration.high == 0.0) & (other.acceleration.high == 0.0);
        if are_uniform { DoubleDouble::ZERO } else { self.acceleration - other.acceleration }
    }

    /// The state t seconds later.
    #[inline(always)]
    pub fn after(&self, t: DoubleDouble) -> StateDd {
        if self.acceleration.high == 0.0 { self.after_uniform(t) } else { self.after_accelerated(t) }
    }

    /// The states of two bodies, each its own number of seconds later: the same numbers as those of
    /// [`after`](Self::after).
    #[inline(always)]
    pub fn both_after([first, second]: [StateDd; 2], t: [DoubleDouble; 2]) -> [StateDd; 2] {
        let are_uniform = first.acceleration.high == 0.0 && second.acceleration.high == 0.0;
        let both = StateDd {
            position: DoubleDouble::pair([first.position, second.position]),
            velocity: DoubleDouble::pair([first.velocity, second.velocity]),
            acceleration: DoubleDouble::pair([first.acceleration, second.acceleration]),
        };
        let t = DoubleDouble::pair(t);
        let later = if are_uniform { both.after_uniform(t) } else { both.after_accelerated(t) };
        let (positions, velocities) = (later.position.lanes(), later.velocity.lanes());
        // The sum with a gain of 0 would not keep the sign of a low part of 0.
        let velocity = |state: &StateDd, later: DoubleDouble| {
            if state.acceleration.high == 0.0 { state.velocity } else { later }
        };
        [
            StateDd { position: positions[0], velocity: velocity(&first, velocities[0]), ..first },
            StateDd { position: positions[1], velocity: velocity(&second, velocities[1]), ..second },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_closes_at_the_root_where_it_shrinks() {
        assert_eq!(closing_time(6.0, 2.0, 0.0), 3.0);
        assert_eq!(closing_time(6.0, -2.0, 0.0), f64::INFINITY);
        assert_eq!(closing_time(4.0, 0.0, 2.0), 2.0, "from rest: t = sqrt(2g/b)");
        assert_eq!(closing_time(0.0, -3.0, 2.0), 3.0, "thrown up from the floor: t = 2v/g");
        assert_eq!(closing_time(4.0, 5.0, -2.0), 1.0, "the first of the roots 1 and 4");
        assert_eq!(closing_time(4.0, 3.0, -2.0), f64::INFINITY, "turns back before it arrives");
        assert_eq!(closing_time(-4.0, -5.0, 2.0), 4.0, "opens at 1, closes at 4");
        assert_eq!(closing_time(-4.0, 1.0, 2.0), f64::INFINITY, "inside and going deeper");
        assert_eq!(closing_time(0.0, 0.0, 1.0), 0.0);
        assert_eq!(closing_time(4e-200, 0.0, 2e-200), 2.0, "the squares underflow");
    }

    #[test]
    fn two_states_side_by_side_are_the_same_numbers_as_one_after_the_other() {
        let mut index = 0;
        let mut number = || {
            index += 1;
            let number = DoubleDouble::from(f64::from(index * 7919 % 2003 - 1001)) / f64::from(index % 13 + 1).into();
            if index % 5 == 0 { -number } else { number }
        };
        for _ in 0..1000 {
            let mut state = || StateDd { position: number(), velocity: number(), acceleration: number() };
            let [first, second] = [state(), state()];
            let t = [number(), number()];
            let [resting, drifting] =
                [first, second].map(|state| StateDd { acceleration: DoubleDouble::ZERO, ..state });
            for pair in [[first, second], [resting, second], [first, drifting], [resting, drifting]] {
                let expected = [pair[0].after(t[0]), pair[1].after(t[1])];
                assert_eq!(format!("{:?}", StateDd::both_after(pair, t)), format!("{expected:?}"));
            }
        }
    }

    #[test]
    fn a_tiny_acceleration_causes_no_cancellation() {
        let t = closing_time(1.0, 1.0, 1e-18);
        assert_eq!(t, 1.0, "the textbook formula would give 0 or 2");
    }
}
