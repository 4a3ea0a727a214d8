//! Random rounding: the last digit of every inexact result is moved at random, so that two runs of the same scene
//! show by their distance how many digits are left.
//!
//! The method is that of J. Vignes, "A stochastic arithmetic for reliable scientific computation", Mathematics and
//! Computers in Simulation 35 (1993). Results that need no rounding stay as they are, so that exact coincidences
//! stay exact. The random numbers depend on the rounded numbers alone: the same numbers are always rounded in the
//! same way.

use super::axis_trajectory::StateDd;
use super::double_double::DoubleDouble;
use super::impact::Impact;
use super::instant::Instant;
use crate::physics::Side;

/// The rounding error of a few operations in double-double arithmetic, as a fraction of the result.
const UNIT: f64 = 1.0 / (1_u128 << 104) as f64;

/// The number of bits between the first of the greatest and the last of the least number in a sum that is exact.
const EXACT_BITS: i32 = 100;

/// The source of random roundings; by default there are none.
#[derive(Clone, Copy, Debug, Default)]
pub struct RandomRounding {
    seed: Option<u64>,
}

impl RandomRounding {
    /// Random rounding with numbers that follow from `seed`.
    pub fn new(seed: u64) -> RandomRounding {
        RandomRounding { seed: Some(seed) }
    }

    /// True if numbers are rounded at random.
    #[inline]
    pub fn is_random(self) -> bool {
        self.seed.is_some()
    }

    /// Rounds the state reached from `start` in `t` seconds at random.
    #[inline]
    pub fn state(self, start: StateDd, t: DoubleDouble, end: StateDd) -> StateDd {
        match self.seed {
            None => end,
            Some(seed) => StateDd {
                position: round_position(seed, start.position, start.velocity, start.acceleration, t, end.position),
                velocity: round_velocity(seed, start.velocity, start.acceleration, t, end.velocity),
                acceleration: end.acceleration,
            },
        }
    }

    /// Rounds an instant at random: the sum of `from` and the root `seconds` of an equation of motion. `is_exact`
    /// returns true if the root needed no rounding.
    #[inline]
    pub fn instant(self, from: Instant, seconds: DoubleDouble, is_exact: impl Fn() -> bool) -> Instant {
        let at = from.after_exactly(seconds);
        match self.seed {
            None => at,
            Some(seed) => round_instant(seed, from, seconds, at, is_exact()),
        }
    }

    /// Rounds the velocities after an impact at random.
    #[inline]
    pub fn velocities(self, impact: &Impact, after: [DoubleDouble; 2]) -> [DoubleDouble; 2] {
        match self.seed {
            None => after,
            Some(seed) => {
                let (impact, [first, second]) = (*impact, after);
                round_velocities(seed, &impact, first, second)
            }
        }
    }
}

#[cold]
fn round_instant(seed: u64, from: Instant, seconds: DoubleDouble, at: Instant, is_root_exact: bool) -> Instant {
    let is_sum_exact = Bits::of(from.as_number()).and(Bits::of(seconds)).is_exact();
    if at == Instant::NEVER || (is_sum_exact && is_root_exact) {
        return at;
    }
    let DoubleDouble { high, low } = moved(seed, at.as_number(), at.high);
    Instant { high, low }
}

#[cold]
fn round_velocities(
    seed: u64,
    impact: &Impact,
    first_after: DoubleDouble,
    second_after: DoubleDouble,
) -> [DoubleDouble; 2] {
    let ([first, second], after) = (impact.velocity, [first_after, second_after]);
    let speed = first.high.abs() + second.high.abs();
    let is_exact = impact.has_exact_shares()
        && Bits::of(first)
            .and(Bits::of(second))
            .times(Bits::of(impact.restitution + 1.0.into()))
            .times(Bits::of(impact.shares()[0]))
            .is_exact();
    if is_exact {
        return after;
    }
    if after[0] == after[1] {
        return [moved(seed, after[0], speed); 2];
    }
    Side::BOTH.map(|side| {
        let is_fixed = impact.mass[side].high == f64::INFINITY;
        if is_fixed { after[side] } else { moved(seed ^ side as u64, after[side], speed) }
    })
}

#[cold]
fn round_position(
    seed: u64,
    start: DoubleDouble,
    velocity: DoubleDouble,
    acceleration: DoubleDouble,
    t: DoubleDouble,
    end: DoubleDouble,
) -> DoubleDouble {
    let gain = Bits::of(acceleration).times(Bits::of(t)).times(Bits::of(0.5.into()));
    let path = Bits::of(velocity).and(gain).times(Bits::of(t));
    if Bits::of(start).and(path).is_exact() {
        return end;
    }
    let path = t.high * (velocity.high.abs() + t.high * acceleration.high.abs());
    moved(seed, end, start.high.abs() + path.abs())
}

#[cold]
fn round_velocity(
    seed: u64,
    start: DoubleDouble,
    acceleration: DoubleDouble,
    t: DoubleDouble,
    end: DoubleDouble,
) -> DoubleDouble {
    if Bits::of(start).and(Bits::of(acceleration).times(Bits::of(t))).is_exact() {
        return end;
    }
    moved(!seed, end, start.high.abs() + (t.high * acceleration.high).abs())
}

/// True if the path v·t + ½·a·t² needs no rounding.
pub fn is_exact_path(velocity: DoubleDouble, acceleration: DoubleDouble, t: DoubleDouble) -> bool {
    let [velocity, acceleration, time, half] = [velocity, acceleration, t, 0.5.into()].map(Bits::of);
    velocity.and(acceleration.times(time).times(half)).times(time).is_exact()
}

/// Moves a number by up to the rounding error of numbers of a magnitude.
fn moved(seed: u64, number: DoubleDouble, magnitude: f64) -> DoubleDouble {
    // The finalizer of SplitMix64 (Steele, Lea and Flood, 2014).
    let mut bits = seed ^ number.high.to_bits() ^ number.low.to_bits().rotate_left(32);
    bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    // Multiples of 2⁻⁵² from −1 to 1.
    let random = ((bits >> 11) as f64) / (1_u64 << 52) as f64 - 1.0;
    number + DoubleDouble::from(random * magnitude * UNIT)
}

/// The range of binary digits of a number, or of all intermediate results of a computation.
#[derive(Clone, Copy)]
struct Bits {
    /// The exponent of the first digit is below this.
    first: i32,
    /// The exponent of the last digit that is not 0.
    last: i32,
}

impl Bits {
    fn of(number: DoubleDouble) -> Bits {
        if number.high == 0.0 {
            return Bits { first: i32::MIN / 4, last: i32::MAX / 4 };
        }
        let last = if number.low == 0.0 { number.high } else { number.low };
        Bits { first: exponent(number.high) + 1, last: exponent(last) - 52 + mantissa(last).trailing_zeros() as i32 }
    }

    /// The digits of a sum and of its terms.
    fn and(self, other: Bits) -> Bits {
        Bits { first: self.first.max(other.first) + 1, last: self.last.min(other.last) }
    }

    /// The digits of a product.
    fn times(self, other: Bits) -> Bits {
        Bits { first: self.first + other.first, last: self.last + other.last }
    }

    /// True if numbers with these digits need no rounding.
    fn is_exact(self) -> bool {
        self.first - self.last <= EXACT_BITS
    }
}

/// The exponent of a double that is not 0; for subnormal numbers that of the smallest normal one.
fn exponent(number: f64) -> i32 {
    let field = (number.to_bits() >> 52 & 0x7ff) as i32;
    if field == 0 { -1022 } else { field - 1023 }
}

/// The digits of a double as an integer of 53 bits.
fn mantissa(number: f64) -> u64 {
    let fraction = number.to_bits() & ((1 << 52) - 1);
    if number.to_bits() >> 52 & 0x7ff == 0 { fraction } else { fraction | 1 << 52 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(position: f64, velocity: f64, acceleration: f64) -> StateDd {
        let [position, velocity, acceleration] = [position, velocity, acceleration].map(DoubleDouble::from);
        StateDd { position, velocity, acceleration }
    }

    #[test]
    fn exact_results_stay() {
        let start = state(1.5, -0.25, 9.75);
        let t = DoubleDouble::from(0.375);
        let end = RandomRounding::new(1).state(start, t, start.after(t));
        assert_eq!((end.position, end.velocity), (start.after(t).position, start.after(t).velocity));
    }

    #[test]
    fn inexact_results_move_by_their_rounding_error() {
        let start = state(1.5, -0.25, 9.81);
        let t = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
        let exact = start.after(t);
        let [one, two] = [1, 2].map(|seed| RandomRounding::new(seed).state(start, t, exact));
        assert_ne!(one.position, two.position);
        for end in [one, two] {
            assert!((end.position - exact.position).high.abs() <= 8.0 * UNIT);
            assert!((end.velocity - exact.velocity).high.abs() <= 8.0 * UNIT);
        }
        let again = RandomRounding::new(1).state(start, t, exact);
        assert_eq!(again.position, one.position);
        assert_eq!(RandomRounding::default().state(start, t, exact).position, exact.position);
    }

    #[test]
    fn an_impact_of_equal_masses_is_exact_and_one_with_thirds_is_not() {
        let impact = |mass: f64| {
            let numbers = |a: f64, b: f64| [DoubleDouble::from(a), DoubleDouble::from(b)];
            let impact = Impact { velocity: numbers(1.0, -0.5), mass: numbers(1.0, mass), restitution: 0.5.into() };
            let after = impact.velocities_after();
            (after, RandomRounding::new(7).velocities(&impact, after))
        };
        for exact in [1.0, 3.0, f64::INFINITY] {
            assert_eq!(impact(exact).0, impact(exact).1);
        }
        assert_ne!(impact(2.0).0, impact(2.0).1);
    }
}
