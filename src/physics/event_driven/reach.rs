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
