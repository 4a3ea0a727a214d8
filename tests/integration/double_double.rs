//! Double-double arithmetic, independent of the solver's: numbers of 32 digits as unevaluated sums of two
//! doubles (Dekker, "A floating-point technique for extending the available precision", 1971).

use std::ops::{Add, Div, Mul, Neg, Sub};

#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

/// The sum of two doubles and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let rounded_b = high - a;
    DoubleDouble { high, low: (a - (high - rounded_b)) + (b - rounded_b) }
}

/// The product of two doubles and its rounding error (Dekker, with Veltkamp's splitting).
fn two_product(a: f64, b: f64) -> DoubleDouble {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let (high, ((ah, al), (bh, bl))) = (a * b, (split(a), split(b)));
    DoubleDouble { high, low: ((ah * bh - high) + ah * bl + al * bh) + al * bl }
}

impl DoubleDouble {
    pub fn to_f64(self) -> f64 {
        self.high
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> DoubleDouble {
        DoubleDouble { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = DoubleDouble;
    fn add(self, other: DoubleDouble) -> DoubleDouble {
        let sum = two_sum(self.high, other.high);
        let rest = two_sum(self.low, other.low);
        let sum = two_sum(sum.high, sum.low + rest.high);
        two_sum(sum.high, sum.low + rest.low)
    }
}

impl Neg for DoubleDouble {
    type Output = DoubleDouble;
    fn neg(self) -> DoubleDouble {
        DoubleDouble { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = DoubleDouble;
    fn sub(self, other: DoubleDouble) -> DoubleDouble {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = DoubleDouble;
    fn mul(self, other: DoubleDouble) -> DoubleDouble {
        let product = two_product(self.high, other.high);
        two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = DoubleDouble;
    fn div(self, other: DoubleDouble) -> DoubleDouble {
        let first = self.high / other.high;
        let rest = self - other * first.into();
        let second = rest.high / other.high;
        let rest = rest - other * second.into();
        two_sum(first, second) + (rest.high / other.high).into()
    }
}

#[test]
fn a_third_times_three_is_one_to_thirty_digits() {
    let third = DoubleDouble::from(1.0) / 3.0.into();
    let rest = third * 3.0.into() - 1.0.into();
    assert!(rest.to_f64().abs() < 1e-31 && third.low != 0.0);
}
