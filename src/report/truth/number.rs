use num_bigint::BigInt;
use num_traits::{ToPrimitive, Zero};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// So many binary digits stand behind the point: 77 decimals.
const BITS: u64 = 256;

/// A number to 77 decimals behind the point and any number before it.
///
/// Sums are exact, the rest is rounded to the last place. A fixed point is what lengths want:
/// an error is so many metres, wherever the boxes are.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Number(BigInt);

impl Number {
    /// Zero.
    pub fn zero() -> Number {
        Number(BigInt::zero())
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    /// The square root; of a negative number there is none.
    pub fn square_root(&self) -> Option<Number> {
        (self.0 >= BigInt::zero()).then(|| Number((&self.0 << BITS).sqrt()))
    }

    /// The greatest whole number that is not greater.
    pub fn floor(&self) -> Number {
        Number((&self.0 >> BITS) << BITS)
    }

    /// Its size without its sign.
    pub fn abs(&self) -> Number {
        if self.0 < BigInt::zero() { -self } else { self.clone() }
    }

    /// The double next to it; a whole one is exact up to 2⁵³.
    pub fn to_f64(&self) -> f64 {
        const SCALE: f64 = f64::from_bits((1023 - BITS) << 52);
        self.0.to_f64().unwrap_or(f64::NAN) * SCALE
    }
}

impl From<f64> for Number {
    /// The number a finite double is, exactly, if it is a multiple of 2⁻²⁵⁶; else cut off there.
    fn from(value: f64) -> Number {
        const FRACTION: u64 = (1 << 52) - 1;
        let (bits, exponent) = (value.to_bits(), (value.to_bits() >> 52 & 0x7ff) as i64);
        let digits = if exponent == 0 { bits & FRACTION } else { bits & FRACTION | (1 << 52) };
        let shift = exponent.max(1) - 1075 + BITS as i64;
        let size = BigInt::from(digits);
        let size = if shift >= 0 { size << shift } else { size >> -shift };
        Number(if value < 0.0 { -size } else { size })
    }
}

impl Add for &Number {
    type Output = Number;
    fn add(self, other: &Number) -> Number {
        Number(&self.0 + &other.0)
    }
}

impl Sub for &Number {
    type Output = Number;
    fn sub(self, other: &Number) -> Number {
        Number(&self.0 - &other.0)
    }
}

impl Mul for &Number {
    type Output = Number;
    fn mul(self, other: &Number) -> Number {
        Number((&self.0 * &other.0) >> BITS)
    }
}

impl Div for &Number {
    type Output = Number;

    /// # Panics
    /// When `other` is zero.
    fn div(self, other: &Number) -> Number {
        Number((&self.0 << BITS) / &other.0)
    }
}

impl Neg for &Number {
    type Output = Number;
    fn neg(self) -> Number {
        Number(-&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: f64) -> Number {
        Number::from(value)
    }

    #[test]
    fn doubles_come_back_to_the_bit() {
        for value in [0.0, 1.0, -0.1, 1e-12, 9.81, 1e15, -7000.5, 1.0 / 3.0, 2.0_f64.sqrt() * 1e-20, 4e9] {
            assert_eq!(number(value).to_f64(), value);
        }
        assert_eq!(number(-0.0), Number::zero());
        assert_eq!(number(f64::MIN_POSITIVE), Number::zero(), "beyond the last place");
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
