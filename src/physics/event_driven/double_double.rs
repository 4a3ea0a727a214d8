use std::ops::{Add, Div, Mul, Neg, Sub};

/// What a [`DoubleDouble`] is made of: a double, or several computed side by side.
pub trait Double:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A double, in each place.
    fn all(number: f64) -> Self;

    /// 0 in place of what is not finite.
    fn finite_or_zero(self) -> Self;
}

impl Double for f64 {
    #[inline]
    fn all(number: f64) -> f64 {
        number
    }

    #[inline]
    fn finite_or_zero(self) -> f64 {
        if self.is_finite() { self } else { 0.0 }
    }
}

/// A number of 32 digits: the sum of two doubles, the second at most half a unit in the last
/// place of the first.
///
/// Not promised: more than 30 digits after a few operations, or anything where a product of
/// doubles overflows (beyond 1e150 in general).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble<T = f64> {
    /// The number, rounded to a double.
    pub high: T,
    /// What rounding it lost.
    pub low: T,
}

impl DoubleDouble {
    /// The number 0.
    pub const ZERO: DoubleDouble = DoubleDouble { high: 0.0, low: 0.0 };
}

impl<T: Double> DoubleDouble<T> {
    /// The sum of two doubles, exactly (Knuth, TAOCP 2, 4.2.2, theorem B).
    #[inline]
    pub fn sum(a: T, b: T) -> DoubleDouble<T> {
        let high = a + b;
        let part = high - a;
        DoubleDouble { high, low: (a - (high - part)) + (b - part) }
    }

    /// The sum of two doubles of which the first is the greater or 0, exactly (Dekker, 1971).
    #[inline]
    fn quick_sum(a: T, b: T) -> DoubleDouble<T> {
        let high = a + b;
        DoubleDouble { high, low: b - (high - a) }
    }

    /// The product of two doubles, exactly (Dekker, "A floating-point technique for extending
    /// the available precision", 1971): a fused multiply-add would be shorter, but is slow
    /// where the processor has none.
    #[inline]
    pub fn product(a: T, b: T) -> DoubleDouble<T> {
        let high = a * b;
        let [a_high, a_low] = halves(a);
        let [b_high, b_low] = halves(b);
        let low = ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low;
        DoubleDouble { high, low: low.finite_or_zero() }
    }

    /// Half of it, exactly.
    #[inline]
    pub fn half(self) -> DoubleDouble<T> {
        DoubleDouble { high: T::all(0.5) * self.high, low: T::all(0.5) * self.low }
    }
}

/// The upper and the lower 26 bits of a double (Veltkamp, 1968).
#[inline]
fn halves<T: Double>(number: T) -> [T; 2] {
    let shifted = T::all(134_217_729.0) * number;
    let high = shifted - (shifted - number);
    [high, number - high]
}

impl<T: Double> From<T> for DoubleDouble<T> {
    #[inline]
    fn from(high: T) -> DoubleDouble<T> {
        DoubleDouble { high, low: T::all(0.0) }
    }
}

impl<T: Double> Add for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    #[inline]
    fn add(self, other: DoubleDouble<T>) -> DoubleDouble<T> {
        let sum = DoubleDouble::sum(self.high, other.high);
        let rest = DoubleDouble::sum(self.low, other.low);
        let sum = DoubleDouble::quick_sum(sum.high, sum.low + rest.high);
        DoubleDouble::quick_sum(sum.high, sum.low + rest.low)
    }
}

impl<T: Double> Neg for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    #[inline]
    fn neg(self) -> DoubleDouble<T> {
        DoubleDouble { high: -self.high, low: -self.low }
    }
}

impl<T: Double> Sub for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    #[inline]
    fn sub(self, other: DoubleDouble<T>) -> DoubleDouble<T> {
        self + -other
    }
}

impl<T: Double> Mul for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    #[inline]
    fn mul(self, other: DoubleDouble<T>) -> DoubleDouble<T> {
        let product = DoubleDouble::product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        DoubleDouble::quick_sum(product.high, product.low + cross)
    }
}

impl<T: Double> Div for DoubleDouble<T> {
    type Output = DoubleDouble<T>;

    /// Long division, a double at a time.
    #[inline]
    fn div(self, other: DoubleDouble<T>) -> DoubleDouble<T> {
        let first = self.high / other.high;
        let rest = self - other * first.into();
        let second = rest.high / other.high;
        let rest = rest - other * second.into();
        let third = rest.high / other.high;
        DoubleDouble::quick_sum(first, second) + third.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(high: f64) -> DoubleDouble {
        high.into()
    }

    #[test]
    fn sums_and_products_of_doubles_lose_nothing() {
        assert_eq!(DoubleDouble::sum(1e16, 0.75), DoubleDouble { high: 1e16, low: 0.75 });
        let odd = 1.0 + f64::EPSILON;
        let square = DoubleDouble::product(odd, odd);
        assert_eq!(square, DoubleDouble { high: 1.0 + 2.0 * f64::EPSILON, low: f64::EPSILON * f64::EPSILON });
    }

    #[test]
    fn a_third_times_three_is_one_to_thirty_digits() {
        let third = number(1.0) / number(3.0);
        assert_eq!(third.high, 1.0 / 3.0);
        let rest = third * number(3.0) - number(1.0);
        assert!(rest.high.abs() < 1e-31);
        let seventh = number(22.0) / number(7.0) * number(7.0) - number(22.0);
        assert!(seventh.high.abs() < 1e-30);
    }

    #[test]
    fn a_mirrored_number_stays_the_mirror_image() {
        let [a, b] = [number(0.1) / number(7.0), number(-3.3) / number(1.7)];
        assert_eq!(-a + -b, -(a + b));
        assert_eq!(-a * b, -(a * b));
        assert_eq!(-a / b, -(a / b));
    }

    #[test]
    fn what_overflows_stays_a_plain_double() {
        assert_eq!(DoubleDouble::product(1e300, 2.0), DoubleDouble::from(2e300));
    }
}
