//! The decimals that numbers of a scene stand for.
//!
//! A scene states 0.1, 0.2 and 0.3, but the double nearest 0.3 is not the sum of those nearest 0.1 and 0.2: boxes that
//! are meant to fit would overlap by 3·10⁻¹⁷ or leave such a gap, and one that is meant to reach a corner would miss
//! it. In double-double precision they fit to 10⁻³³.

use super::double_double::DoubleDouble;

/// The bits of a numerator: nine decimal digits.
const NUMERATOR_BITS: u32 = 30;

/// The largest power of five in a denominator: twelve decimal places.
const MAX_POWER: u32 = 12;

/// The bits of the significand of a double.
const SIGNIFICAND_BITS: u32 = f64::MANTISSA_DIGITS;

/// Returns the number that a finite double stands for: its [`decimal`], or the double itself if there is none.
pub fn stated(number: f64) -> DoubleDouble {
    decimal(number).unwrap_or_else(|| number.into())
}

/// Returns the decimal of at most nine digits and twelve places that a finite double is nearest to, also times a power
/// of two. A double that has none was probably computed, and so rounded.
///
/// That is m·2ᵏ/5ᵖ with m < 2³⁰ and the least p ≤ 12. The power of two is arbitrary, so that a scene in other units,
/// all lengths times a power of two, has the same numbers. Of doubles of 53 random bits, one in a million is near such
/// a decimal.
pub fn decimal(number: f64) -> Option<DoubleDouble> {
    let fraction_bits = SIGNIFICAND_BITS - 1;
    let is_normal = number.is_normal();
    let significand = number.to_bits() & ((1 << fraction_bits) - 1) | 1 << fraction_bits;
    // A short double is what it says.
    if !is_normal || SIGNIFICAND_BITS - significand.trailing_zeros() <= NUMERATOR_BITS {
        return Some(number.into());
    }
    let unit = number.abs() / significand as f64;
    let mut power_of_five = 1_u64;
    for _ in 0..MAX_POWER {
        power_of_five *= 5;
        let product = u128::from(significand) * u128::from(power_of_five);
        let shift = u128::BITS - product.leading_zeros() - NUMERATOR_BITS;
        let nearest = ((product + (1 << (shift - 1))) >> shift) << shift;
        // The decimal minus the double, in units of the last place divided by the power of five.
        let rest = nearest as i128 - product as i128;
        if 2 * rest.unsigned_abs() < u128::from(power_of_five) {
            let low = rest as f64 / power_of_five as f64 * unit;
            return Some(DoubleDouble { high: number, low: if number < 0.0 { -low } else { low } });
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::pseudo_random::PseudoRandom;

    /// The decimal in double-double arithmetic, from its digits and places.
    fn quotient(digits: u64, places: i32) -> DoubleDouble {
        let power = (0..places).fold(1.0, |power, _| power * 10.0);
        DoubleDouble::from(digits as f64) / power.into()
    }

    #[test]
    fn short_decimals_are_read_to_thirty_digits() {
        let mut random = PseudoRandom(1);
        for _ in 0..100_000 {
            let digits = (random.between(0.0, 9.0).floor() as u32 + 1).min(9);
            let digits = random.between(0.0, f64::from(10_u32.pow(digits))).floor() as u64;
            let places = random.between(0.0, 12.99).floor() as i32;
            let number: f64 = format!("{digits}e-{places}").parse().unwrap();
            let (found, expected) = (stated(number), quotient(digits, places));
            let difference = (found - expected).high.abs();
            assert!(difference <= 1e-31 * number, "{number}: {found:?}, not {expected:?}");
            assert_eq!(stated(-number), -found, "{number}");
        }
    }

    #[test]
    fn decimals_that_fit_leave_neither_gap_nor_overlap() {
        for places in 1..=4 {
            let unit = quotient(1, places).high;
            for [first, second] in [[1, 2], [7, 1], [2, 1], [8, 1], [3, 4], [123, 456], [29, 71]] {
                let [a, b, sum] = [first, second, first + second].map(|digits: u64| {
                    let number: f64 = format!("{digits}e-{places}").parse().unwrap();
                    stated(number)
                });
                assert!((a + b - sum).high.abs() <= 1e-30 * unit * 1000.0, "{first} + {second} in 1e-{places}");
            }
        }
    }

    #[test]
    fn a_power_of_two_is_a_factor() {
        for digits in [1_u64, 3, 7, 137, 99_999, 123_456_789] {
            for places in 0..=12 {
                let number: f64 = format!("{digits}e-{places}").parse().unwrap();
                for factor in [0.5, 2.0, 1024.0, (1_u64 << 60) as f64, 1.0 / (1_u64 << 60) as f64] {
                    assert_eq!(stated(number * factor), stated(number).scaled(factor), "{number} times {factor}");
                }
            }
        }
    }

    #[test]
    fn other_numbers_are_themselves() {
        let bits_of_random = |random: &mut PseudoRandom| random.between(0.5, 1.0) + random.between(0.0, 1e-9);
        let mut random = PseudoRandom(2);
        let changed = (0..100_000).filter(|_| stated(bits_of_random(&mut random)).low != 0.0).count();
        assert!(changed <= 2, "{changed} of 100,000 random numbers are read as decimals");
        for number in [0.0, -0.0, 1.0, 0.375, 1e-310, f64::MAX, f64::MIN_POSITIVE, 12345.0 / 1024.0, 1e17] {
            let read = stated(number);
            assert_eq!((read.high.to_bits(), read.low), (number.to_bits(), 0.0), "{number}");
        }
    }
}
