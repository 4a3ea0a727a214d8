use num_bigint::BigInt;
use num_traits::{ToPrimitive, Zero};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Binary digits after the point; 77 decimals.
const BITS: u64 = 256;

/// A fixed-point number with 77 decimals after the point and an unbounded integer part.
///
/// Sums are exact, other operations are rounded to the last digit. Fixed point suits lengths: an error
/// is an absolute distance, independent of the position.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fixed256(BigInt);

impl Fixed256 {
    /// Zero.
    pub fn zero() -> Fixed256 {
        Fixed256(BigInt::zero())
    }

    /// Returns true if the number is zero.
    pub fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    /// Returns the square root, or `None` for a negative number.
    pub fn square_root(&self) -> Option<Fixed256> {
        (self.0 >= BigInt::zero()).then(|| Fixed256((&self.0 << BITS).sqrt()))
    }

    /// Returns the greatest integer that is not greater.
    pub fn floor(&self) -> Fixed256 {
        Fixed256((&self.0 >> BITS) << BITS)
    }

    /// Returns the absolute value.
    pub fn abs(&self) -> Fixed256 {
        if self.0 < BigInt::zero() { -self } else { self.clone() }
    }

    /// Reads a number of a scene: the decimal that it states, if that has at most nine digits.
    pub fn stated(value: f64) -> Fixed256 {
        let text = format!("{value:e}");
        let Some((digits, exponent)) = text.split_once('e') else { return value.into() };
        let places = digits.split_once('.').map_or(0, |(_, fraction)| fraction.len());
        let digits: String = digits.chars().filter(|character| *character != '.').collect();
        match (digits.parse::<i32>(), exponent.parse::<i32>()) {
            (Ok(digits), Ok(exponent)) if (1..=12).contains(&(places as i32 - exponent)) => {
                let power = (0..places as i32 - exponent).fold(1.0, |power, _| power * 10.0);
                &Fixed256::from(f64::from(digits)) / &Fixed256::from(power)
            }
            _ => value.into(),
        }
    }

    /// Returns the nearest double; integers up to 2⁵³ are exact.
    pub fn to_f64(&self) -> f64 {
        const SCALE: f64 = f64::from_bits((1023 - BITS) << 52);
        self.0.to_f64().unwrap_or(f64::NAN) * SCALE
    }
}

impl From<f64> for Fixed256 {
    /// Converts a finite double exactly if it is a multiple of 2⁻²⁵⁶; otherwise lower bits are cut off.
    fn from(value: f64) -> Fixed256 {
        const FRACTION: u64 = (1 << 52) - 1;
        let (bits, exponent) = (value.to_bits(), (value.to_bits() >> 52 & 0x7ff) as i64);
        let digits = if exponent == 0 { bits & FRACTION } else { bits & FRACTION | (1 << 52) };
        let shift = exponent.max(1) - 1075 + BITS as i64;
        let size = BigInt::from(digits);
        let size = if shift >= 0 { size << shift } else { size >> -shift };
        Fixed256(if value < 0.0 { -size } else { size })
    }
}

impl Add for &Fixed256 {
    type Output = Fixed256;
    fn add(self, other: &Fixed256) -> Fixed256 {
        Fixed256(&self.0 + &other.0)
    }
}

impl Sub for &Fixed256 {
    type Output = Fixed256;
    fn sub(self, other: &Fixed256) -> Fixed256 {
        Fixed256(&self.0 - &other.0)
    }
}

impl Mul for &Fixed256 {
    type Output = Fixed256;
    fn mul(self, other: &Fixed256) -> Fixed256 {
        Fixed256((&self.0 * &other.0) >> BITS)
    }
}

impl Div for &Fixed256 {
    type Output = Fixed256;

    /// # Panics
    /// Panics if `other` is zero.
    fn div(self, other: &Fixed256) -> Fixed256 {
        Fixed256((&self.0 << BITS) / &other.0)
    }
}

impl Neg for &Fixed256 {
    type Output = Fixed256;
    fn neg(self) -> Fixed256 {
        Fixed256(-&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: f64) -> Fixed256 {
        Fixed256::from(value)
    }

    #[test]
    fn doubles_round_trip_exactly() {
        for value in [0.0, 1.0, -0.1, 1e-12, 9.81, 1e15, -7000.5, 1.0 / 3.0, 2.0_f64.sqrt() * 1e-20, 4e9] {
            assert_eq!(number(value).to_f64(), value);
        }
        assert_eq!(number(-0.0), Fixed256::zero());
        assert_eq!(&Fixed256::stated(0.1) + &Fixed256::stated(0.2), Fixed256::stated(0.3));
        assert_eq!(Fixed256::stated(1.0 / 3.0), number(1.0 / 3.0));
        assert_eq!(number(f64::MIN_POSITIVE), Fixed256::zero(), "below the last digit");
    }

    #[test]
    fn computes_to_seventy_decimals() {
        let two = number(2.0);
        let root = two.square_root().unwrap();
        let tiny = number(1e-70);
        assert!((&(&root * &root) - &two).abs() < tiny);
        let third = &number(1.0) / &number(3.0);
        assert!((&(&third * &number(3.0)) - &number(1.0)).abs() < tiny);
        assert_eq!(number(-1.0).square_root(), None);
        assert_eq!((number(-0.5).floor(), number(7.75).floor()), (number(-1.0), number(7.0)));
    }
}
