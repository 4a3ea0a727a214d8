//! Where a body can be until it next looks around.

use super::meeting::State;
use super::mover::{AXES, Mover};

/// A reach is this part of its coordinates larger than what was computed: more than rounding,
/// also that to single precision.
const ROUNDING: f64 = 1.0 / (1_u64 << 22) as f64;

/// Longer than anything lasts, s; its square is finite.
const EVER: f64 = 1e150;

/// A rectangle that a body does not leave until it looks ahead again.
///
/// Two bodies whose reaches do not touch need not be asked when they meet: should they, it
/// is after one of them has looked ahead anew. Single precision is enough, and half the memory.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub struct Reach {
    /// Lower x, lower y, −upper x, −upper y, m.
    borders: [f32; 4],
}

impl Reach {
    /// That of a body of which nothing is known.
    pub const ANYWHERE: Reach = Reach { borders: [f32::NEG_INFINITY; 4] };

    /// What a body covers in the next so many seconds.
    ///
    /// A parabola leaves the span of p and p + v·t by no more than ½·a·t², and only to the side to
    /// which it accelerates.
    #[inline]
    pub fn new(state: &State, seconds: f64) -> Reach {
        let mover: &Mover = state.mover;
        let seconds = if seconds < EVER { seconds } else { EVER };
        let from = state.position;
        let to = AXES.map(|axis| from[axis] + state.velocity[axis] * seconds);
        let mut low = AXES.map(|axis| if from[axis] < to[axis] { from[axis] } else { to[axis] });
        let mut high = AXES.map(|axis| if from[axis] > to[axis] { from[axis] } else { to[axis] });
        let mut terms = AXES.map(|axis| low[axis].abs() + high[axis].abs() + mover.size[axis]);
        if mover.motion.acceleration != [0.0; 2] {
            let bend = mover.motion.acceleration.map(|acceleration| 0.5 * acceleration * (seconds * seconds));
            let bent = AXES.map(|axis| to[axis] + bend[axis]);
            // What is not a number counts as either.
            low = AXES.map(|axis| if bent[axis] >= low[axis] { low[axis] } else { bent[axis] });
            high = AXES.map(|axis| if bent[axis] <= high[axis] { high[axis] } else { bent[axis] });
            terms = AXES.map(|axis| terms[axis] + bend[axis].abs());
        }
        let lower = AXES.map(|axis| (low[axis] - terms[axis] * ROUNDING) as f32);
        let upper = AXES.map(|axis| (-(high[axis] + mover.size[axis]) - terms[axis] * ROUNDING) as f32);
        Reach { borders: [lower[0], lower[1], upper[0], upper[1]] }
    }

    /// Whether two have no point in common; what is not a number is apart from nothing.
    #[inline]
    pub fn is_apart_from(&self, other: &Reach) -> bool {
        let [a, b] = [self.borders, other.borders];
        let greater = |a: f32, b: f32| if a > b { a } else { b };
        let gaps = [greater(a[0] + b[2], a[2] + b[0]), greater(a[1] + b[3], a[3] + b[1])];
        greater(gaps[0], gaps[1]) > 0.0
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
        let [left, top, right, bottom] = thrown.borders;
        assert!(top <= -4.0 && -bottom >= 6.0);
        assert!(left <= 0.0 && left > -1e-5 && -right < 1.0 + 1e-5, "and goes nowhere along x");
    }

    #[test]
    fn boxes_that_touch_are_within_reach() {
        let standing = reach(&mover(0.0, 0.0), f64::INFINITY);
        let below = Reach { borders: [0.0, 1.0, -1.0, -2.0] };
        assert!(!standing.is_apart_from(&below) && !below.is_apart_from(&standing));
        let further = Reach { borders: [0.0, 1.5, -1.0, -2.0] };
        assert!(standing.is_apart_from(&further) && further.is_apart_from(&standing));
        assert!(!reach(&mover(1.0, 0.0), 0.75).is_apart_from(&further));
        assert!([standing, Reach::ANYWHERE].iter().all(|other| !Reach::ANYWHERE.is_apart_from(other)));
    }

    #[test]
    fn what_turns_back_some_day_is_everywhere_in_the_end() {
        let thrown = reach(&mover(4.0, -2.0), f64::INFINITY);
        assert!(!thrown.is_apart_from(&Reach { borders: [0.0, -1e9, -1.0, 1e9] }));
    }
}
