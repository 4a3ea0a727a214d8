//! A vector of two doubles, which compilers map to one SIMD register.

use super::double_double::{DoubleDouble, Lanes};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Two doubles; operations apply to each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct F64x2(pub [f64; 2]);

impl Add for F64x2 {
    type Output = F64x2;

    #[inline]
    fn add(self, F64x2(other): F64x2) -> F64x2 {
        F64x2([self.0[0] + other[0], self.0[1] + other[1]])
    }
}

impl Sub for F64x2 {
    type Output = F64x2;

    #[inline]
    fn sub(self, F64x2(other): F64x2) -> F64x2 {
        F64x2([self.0[0] - other[0], self.0[1] - other[1]])
    }
}

impl Mul for F64x2 {
    type Output = F64x2;

    #[inline]
    fn mul(self, F64x2(other): F64x2) -> F64x2 {
        F64x2([self.0[0] * other[0], self.0[1] * other[1]])
    }
}

impl Div for F64x2 {
    type Output = F64x2;

    #[inline]
    fn div(self, F64x2(other): F64x2) -> F64x2 {
        F64x2([self.0[0] / other[0], self.0[1] / other[1]])
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

impl DoubleDouble<F64x2> {
    /// Combines two numbers.
    #[inline]
    pub fn pack([first, second]: [DoubleDouble; 2]) -> DoubleDouble<F64x2> {
        DoubleDouble { high: F64x2([first.high, second.high]), low: F64x2([first.low, second.low]) }
    }

    /// Returns the two numbers.
    #[inline]
    pub fn unpack(self) -> [DoubleDouble; 2] {
        let [high, low] = [self.high.0, self.low.0];
        [DoubleDouble { high: high[0], low: low[0] }, DoubleDouble { high: high[1], low: low[1] }]
    }
}
