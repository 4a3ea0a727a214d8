//! Where a body can be until it next looks around.

use super::meeting::State;
use super::mover::{AXES, Mover};

/// A reach is this part of its coordinates larger than what was computed: more than rounding.
const ROUNDING: f64 = 1.0 / (1_u64 << 44) as f64;

/// A rectangle that a body does not leave until it looks ahead again.
///
/// Two bodies whose reaches do not touch need not be asked when they meet: should they, it
/// is after one of them has looked ahead anew.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    low: [f64; 2],
    high: [f64; 2],
}

impl Reach {
    /// That of a body of which nothing is known.
    pub const ANYWHERE: Reach = Reach { low: [f64::NEG_INFINITY; 2], high: [f64::INFINITY; 2] };

    /// What a body covers in the next so many seconds.
    ///
    /// A parabola leaves the span of p and p + v·t by no more than ½·|a|·t².
    #[inline]
    pub fn new(state: &State, seconds: f64) -> Reach {
        let mover: &Mover = state.mover;
        let spans = AXES.map(|axis| {
            let (from, size) = (state.position[axis], mover.size[axis]);
            let acceleration = mover.motion[axis].acceleration;
            if mover.motion[axis].velocity == 0.0 && acceleration == 0.0 {
                return [from, from + size];
            }
            let to = from + state.velocity[axis] * seconds;
            let bend = 0.5 * acceleration.abs() * (seconds * seconds);
            let [low, high] = if from < to { [from, to] } else { [to, from] };
            [low - bend, (high + bend) + size]
        });
        let rounding = spans.map(|[low, high]| (low.abs() + high.abs()) * ROUNDING);
        Reach {
            low: AXES.map(|axis| spans[axis][0] - rounding[axis]),
            high: AXES.map(|axis| spans[axis][1] + rounding[axis]),
        }
    }

    /// Whether two have a point in common; what is not a number touches everything.
    #[inline]
    pub fn touches(&self, other: &Reach) -> bool {
        let apart = AXES.map(|axis| (self.low[axis] > other.high[axis]) | (other.low[axis] > self.high[axis]));
        !(apart[0] | apart[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::instant::{Clock, Instant};
    use crate::physics::event_driven::motion::Motion;

    /// A unit box at the origin: velocity and acceleration along y.
    fn mover(velocity: f64, acceleration: f64) -> Mover {
        let since = Instant::start_of(0);
        let motion = [[0.0; 3], [0.0, velocity, acceleration]].map(|[position, velocity, acceleration]| Motion {
            position,
            velocity,
            acceleration,
            since,
        });
        let held = [[false; 2]; 2];
        Mover { motion, size: [1.0; 2], since, generation: 0, place: 0, infinite: false, held, hurry: [0; 2] }
    }

    fn reach(mover: &Mover, seconds: f64) -> Reach {
        Reach::new(&State::new(&Clock::new(1.0), mover, Instant::start_of(0)), seconds)
    }

    #[test]
    fn a_thrown_box_reaches_its_highest_point_and_its_last() {
        let thrown = reach(&mover(-4.0, 2.0), 5.0);
        assert!(thrown.low[1] <= -4.0 && thrown.high[1] >= 6.0);
        assert!(thrown.low[0] <= 0.0 && thrown.low[0] > -1e-9, "and goes nowhere along x");
    }

    #[test]
    fn boxes_that_touch_are_within_reach() {
        let standing = reach(&mover(0.0, 0.0), f64::INFINITY);
        let below = Reach { low: [0.0, 1.0], high: [1.0, 2.0] };
        assert!(standing.touches(&below) && below.touches(&standing));
        assert!(!standing.touches(&Reach { low: [0.0, 1.5], ..below }));
        assert!(reach(&mover(1.0, 0.0), 0.75).touches(&Reach { low: [0.0, 1.5], ..below }));
        assert!(Reach::ANYWHERE.touches(&standing));
    }
}
