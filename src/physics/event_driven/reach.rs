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
        let zero_or = |number: f64, product: f64| if number == 0.0 { 0.0 } else { product };
        let spans = AXES.map(|axis| {
            let (from, velocity) = (state.position[axis], state.velocity[axis]);
            let acceleration = mover.motion.acceleration[axis];
            let to = from + zero_or(velocity, velocity * seconds);
            let bend = zero_or(acceleration, 0.5 * acceleration.abs() * (seconds * seconds));
            let [low, high] = if from < to { [from, to] } else { [to, from] };
            let [low, high] = [low - bend, (high + bend) + mover.size[axis]];
            let rounding = (low.abs() + high.abs()) * ROUNDING;
            [low - rounding, high + rounding]
        });
        Reach { low: spans.map(|[low, _]| low), high: spans.map(|[_, high]| high) }
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
    use crate::physics::event_driven::motions::Motions;

    /// A unit box at the origin: velocity and acceleration along y.
    fn mover(velocity: f64, acceleration: f64) -> Mover {
        let since = Instant::start_of(0);
        let along = |velocity: f64, acceleration: f64| Motion { position: 0.0, velocity, acceleration, since };
        let motion = Motions::new([along(0.0, 0.0), along(velocity, acceleration)]);
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
