//! Double-double arithmetic: numbers of 32 digits as unevaluated sums of two doubles.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The components of a [`DoubleDouble`]: a double, or a vector of doubles for parallel arithmetic.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The same double in all lanes.
    fn splat(number: f64) -> Self;

    /// Replaces each lane that is not finite by 0.
    fn finite_or_zero(self) -> Self;
}

impl Lanes for f64 {
    #[inline]
    fn splat(number: f64) -> f64 {
        number
    }

    #[inline]
    fn finite_or_zero(self) -> f64 {
        if self.is_finite() { self } else { 0.0 }
    }
}

/// Two doubles in one SIMD register.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(16))]
pub struct F64x2(pub [f64; 2]);

impl Add for F64x2 {
    type Output = F64x2;

    #[inline]
    fn add(self, other: F64x2) -> F64x2 {
        F64x2([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }
}

impl Sub for F64x2 {
    type Output = F64x2;

    #[inline]
    fn sub(self, other: F64x2) -> F64x2 {
        F64x2([self.0[0] - other.0[0], self.0[1] - other.0[1]])
    }
}

impl Mul for F64x2 {
    type Output = F64x2;

    #[inline]
    fn mul(self, other: F64x2) -> F64x2 {
        F64x2([self.0[0] * other.0[0], self.0[1] * other.0[1]])
    }
}

impl Div for F64x2 {
    type Output = F64x2;

    #[inline]
    fn div(self, other: F64x2) -> F64x2 {
        F64x2([self.0[0] / other.0[0], self.0[1] / other.0[1]])
    }
}

impl Neg for F64x2 {
    type Output = F64x2;

    #[inline]
    fn neg(self) -> F64x2 {
        F64x2([-self.0[0], -self.0[1]])
    }
}

impl Lanes for F64x2 {
    #[inline]
    fn splat(number: f64) -> F64x2 {
        F64x2([number; 2])
    }

    #[inline]
    fn finite_or_zero(self) -> F64x2 {
        F64x2([self.0[0].finite_or_zero(), self.0[1].finite_or_zero()])
    }
}

/// A number of 32 digits: the sum of two doubles, the second at most half a unit in the last place of
/// the first.
///
/// Not guaranteed: more than 30 digits after a few operations, and any result if a product of doubles
/// overflows (possible from magnitudes of about 1e150 on).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble<T = f64> {
    /// The number, rounded to a double.
    pub high: T,
    /// The rounding error of `high`.
    pub low: T,
}

impl DoubleDouble {
    /// The number 0.
    pub const ZERO: DoubleDouble = DoubleDouble { high: 0.0, low: 0.0 };

    /// True if the number is less than `other`.
    #[inline]
    pub fn is_less(self, other: DoubleDouble) -> bool {
        (self.high < other.high) | ((self.high == other.high) & (self.low < other.low))
    }

    /// The number, or 0 if its magnitude is at most `rounding`.
    #[inline]
    pub fn or_zero(self, rounding: f64) -> DoubleDouble {
        if self.high.abs() <= rounding { DoubleDouble::ZERO } else { self }
    }

    /// The number times a power of two.
    #[inline]
    pub fn scaled(self, power_of_two: f64) -> DoubleDouble {
        DoubleDouble { high: self.high * power_of_two, low: self.low * power_of_two }
    }
}

impl DoubleDouble<F64x2> {
    /// Puts two numbers side by side.
    #[inline]
    pub fn pair([first, second]: [DoubleDouble; 2]) -> DoubleDouble<F64x2> {
        DoubleDouble { high: F64x2([first.high, second.high]), low: F64x2([first.low, second.low]) }
    }

    /// The two numbers.
    #[inline]
    pub fn lanes(self) -> [DoubleDouble; 2] {
        let (high, low) = (self.high.0, self.low.0);
        [DoubleDouble { high: high[0], low: low[0] }, DoubleDouble { high: high[1], low: low[1] }]
    }
}

impl<T: Lanes> DoubleDouble<T> {
    /// The exact sum of two doubles (Knuth, TAOCP 2, 4.2.2, theorem B).
    #[inline]
    pub fn two_sum(a: T, b: T) -> DoubleDouble<T> {
        let high = a + b;
        let rounded_b = high - a;
        DoubleDouble { high, low: (a - (high - rounded_b)) + (b - rounded_b) }
    }

    /// The exact sum of two doubles, the first of greater or equal magnitude or 0 (Dekker, 1971).
    #[inline]
    fn quick_two_sum(a: T, b: T) -> DoubleDouble<T> {
        let high = a + b;
        DoubleDouble { high, low: b - (high - a) }
    }

    /// The exact product of two doubles (Dekker, "A floating-point technique for extending the
    /// available precision", 1971). A fused multiply-add would be shorter, but is slow on processors
    /// without one.
    ///
    /// Like `+` and `*` it is always inlined: a call passes two lanes through memory. That makes Galperin's billiard
    /// 1.07 times as fast (`cargo bench --bench event_driven`, rows `Galperin N`).
    #[inline(always)]
    pub fn two_product(a: T, b: T) -> DoubleDouble<T> {
        let high = a * b;
        let [a_high, a_low] = split(a);
        let [b_high, b_low] = split(b);
        let low = ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low;
        DoubleDouble { high, low: low.finite_or_zero() }
    }

    /// Exactly half the number.
    #[inline]
    pub fn half(self) -> DoubleDouble<T> {
        DoubleDouble { high: T::splat(0.5) * self.high, low: T::splat(0.5) * self.low }
    }
}

/// Splits a double into its upper and lower 26 bits (Veltkamp, 1968).
#[inline]
fn split<T: Lanes>(number: T) -> [T; 2] {
    let shifted = T::splat(134_217_729.0) * number;
    let high = shifted - (shifted - number);
    [high, number - high]
}

impl<T: Lanes> From<T> for DoubleDouble<T> {
    #[inline]
    fn from(high: T) -> DoubleDouble<T> {
        DoubleDouble { high, low: T::splat(0.0) }
    }
}

impl<T: Lanes> Add for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    #[inline(always)]
    fn add(self, other: DoubleDouble<T>) -> DoubleDouble<T> {
        let sum = DoubleDouble::two_sum(self.high, other.high);
        let rest = DoubleDouble::two_sum(self.low, other.low);
        let sum = DoubleDouble::quick_two_sum(sum.high, sum.low + rest.high);
        DoubleDouble::quick_two_sum(sum.high, sum.low + rest.low)
    }
}

impl<T: Lanes> Neg for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    #[inline]
    fn neg(self) -> DoubleDouble<T> {
        DoubleDouble { high: -self.high, low: -self.low }
    }
}

impl<T: Lanes> Sub for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    #[inline]
    fn sub(self, other: DoubleDouble<T>) -> DoubleDouble<T> {
        self + -other
    }
}

impl<T: Lanes> Mul for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    #[inline(always)]
    fn mul(self, other: DoubleDouble<T>) -> DoubleDouble<T> {
        let product = DoubleDouble::two_product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        DoubleDouble::quick_two_sum(product.high, product.low + cross)
    }
}

impl<T: Lanes> Div for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    /// Long division with three double quotients.
    #[inline]
    fn div(self, other: DoubleDouble<T>) -> DoubleDouble<T> {
        // The high parts of a dividend and of a product with its quotient are so close that their difference is exact.
        let rest = |dividend: DoubleDouble<T>, product: DoubleDouble<T>| {
            let rest = DoubleDouble::two_sum(dividend.low, -product.low);
            let sum = DoubleDouble::quick_two_sum(dividend.high - product.high, rest.high);
            DoubleDouble::quick_two_sum(sum.high, sum.low + rest.low)
        };
        let first = self.high / other.high;
        let first_rest = rest(self, other * first.into());
        let second = first_rest.high / other.high;
        let third = rest(first_rest, other * second.into()).high / other.high;
        let quotient = DoubleDouble::quick_two_sum(first, second);
        // The same number as with `+`, because the third quotient is less than the sum of the first two, with fewer
        // operations that wait for each other.
        let sum = DoubleDouble::quick_two_sum(quotient.high, third);
        DoubleDouble::quick_two_sum(sum.high, sum.low + (quotient.low + T::splat(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(high: f64) -> DoubleDouble {
        high.into()
    }

    #[test]
    fn sums_and_products_of_doubles_are_exact() {
        assert_eq!(DoubleDouble::two_sum(1e16, 0.75), DoubleDouble { high: 1e16, low: 0.75 });
        let odd = 1.0 + f64::EPSILON;
        let square = DoubleDouble::two_product(odd, odd);
        assert_eq!(square, DoubleDouble { high: 1.0 + 2.0 * f64::EPSILON, low: f64::EPSILON * f64::EPSILON });
    }

    #[test]
    fn a_quotient_times_its_divisor_is_the_dividend_to_thirty_digits() {
        let third = number(1.0) / number(3.0);
        assert_eq!(third.high, 1.0 / 3.0);
        let rest = third * number(3.0) - number(1.0);
        assert!(rest.high.abs() < 1e-31);
        let seventh = number(22.0) / number(7.0) * number(7.0) - number(22.0);
        assert!(seventh.high.abs() < 1e-30);
    }

    #[test]
    fn the_rests_of_a_division_are_differences_of_double_doubles() {
        let mut bits = 1_u64;
        let mut random = || {
            bits = bits.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let exponent = [1e-200, 1e-9, 1.0, 1.0, 1e12, 1e140][(bits >> 20) as usize % 6];
            let high = ((bits >> 11) as f64 - (1_u64 << 52) as f64) * exponent;
            DoubleDouble::two_sum(high, high * f64::from((bits >> 30) as u16) * 1e-21)
        };
        for _ in 0..100_000 {
            let [a, b] = [random(), random()];
            let first = a.high / b.high;
            let rest = a - b * first.into();
            let second = rest.high / b.high;
            let third = (rest - b * second.into()).high / b.high;
            let expected = DoubleDouble::quick_two_sum(first, second) + third.into();
            assert_eq!(format!("{:?}", a / b), format!("{expected:?}"), "{a:?} / {b:?}");
        }
    }

    #[test]
    fn operations_commute_with_negation() {
        let [a, b] = [number(0.1) / number(7.0), number(-3.3) / number(1.7)];
        assert_eq!(-a + -b, -(a + b));
        assert_eq!(-a * b, -(a * b));
        assert_eq!(-a / b, -(a / b));
    }

    #[test]
    fn a_product_whose_error_overflows_has_no_low_part() {
        assert_eq!(DoubleDouble::two_product(1e300, 2.0), DoubleDouble::from(2e300));
    }
}
