//! Two doubles that the processor computes at once.

use super::double_double::{Double, DoubleDouble};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Two doubles, side by side: what is done to one is done to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideBySide(pub [f64; 2]);

impl Add for SideBySide {
    type Output = SideBySide;

    #[inline]
    fn add(self, SideBySide(other): SideBySide) -> SideBySide {
        SideBySide([self.0[0] + other[0], self.0[1] + other[1]])
    }
}

impl Sub for SideBySide {
    type Output = SideBySide;

    #[inline]
    fn sub(self, SideBySide(other): SideBySide) -> SideBySide {
        SideBySide([self.0[0] - other[0], self.0[1] - other[1]])
    }
}

impl Mul for SideBySide {
    type Output = SideBySide;

    #[inline]
    fn mul(self, SideBySide(other): SideBySide) -> SideBySide {
        SideBySide([self.0[0] * other[0], self.0[1] * other[1]])
    }
}

impl Div for SideBySide {
    type Output = SideBySide;

    #[inline]
    fn div(self, SideBySide(other): SideBySide) -> SideBySide {
        SideBySide([self.0[0] / other[0], self.0[1] / other[1]])
    }
}

impl Neg for SideBySide {
    type Output = SideBySide;

    #[inline]
    fn neg(self) -> SideBySide {
        SideBySide([-self.0[0], -self.0[1]])
    }
}

impl Double for SideBySide {
    #[inline]
    fn all(number: f64) -> SideBySide {
        SideBySide([number; 2])
    }

    #[inline]
    fn finite_or_zero(self) -> SideBySide {
        SideBySide([self.0[0].finite_or_zero(), self.0[1].finite_or_zero()])
    }
}

impl DoubleDouble<SideBySide> {
    /// Puts two numbers side by side.
    #[inline]
    pub fn of([first, second]: [DoubleDouble; 2]) -> DoubleDouble<SideBySide> {
        DoubleDouble { high: SideBySide([first.high, second.high]), low: SideBySide([first.low, second.low]) }
    }

    /// The two numbers.
    #[inline]
    pub fn apart(self) -> [DoubleDouble; 2] {
        let [high, low] = [self.high.0, self.low.0];
        [DoubleDouble { high: high[0], low: low[0] }, DoubleDouble { high: high[1], low: low[1] }]
    }
}
