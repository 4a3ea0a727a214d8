use super::Axis;
use std::ops::Index;

/// A vector in the plane: x to the right, y down.
///
/// The methods have the names of the handout, so that the solver can be read side by side with it.
/// They compute as printed there, with one rounding for each + − × ÷ and √. Products of huge
/// components may overflow to infinity.
#[doc(alias = "vec2")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector {
    /// The component to the right.
    pub x: f64,
    /// The downward component.
    pub y: f64,
}

impl Vector {
    /// The null vector.
    pub const ZERO: Vector = Vector { x: 0.0, y: 0.0 };

    /// The vector (x, y).
    pub const fn new(x: f64, y: f64) -> Vector {
        Vector { x, y }
    }

    /// The vector of the given component along `axis`; the other component is 0.
    pub const fn along(axis: Axis, component: f64) -> Vector {
        match axis {
            Axis::X => Vector::new(component, 0.0),
            Axis::Y => Vector::new(0.0, component),
        }
    }

    /// The sum of this vector and `v`.
    pub const fn add(self, v: Vector) -> Vector {
        Vector::new(self.x + v.x, self.y + v.y)
    }

    /// The difference of this vector and `v`.
    pub const fn sub(self, v: Vector) -> Vector {
        Vector::new(self.x - v.x, self.y - v.y)
    }

    /// This vector with each component multiplied by `k`.
    pub const fn mult(self, k: f64) -> Vector {
        Vector::new(self.x * k, self.y * k)
    }

    /// The component-wise minimum of both vectors.
    pub const fn min(self, v: Vector) -> Vector {
        Vector::new(smaller(self.x, v.x), smaller(self.y, v.y))
    }

    /// The component-wise maximum of both vectors.
    pub const fn max(self, v: Vector) -> Vector {
        Vector::new(larger(self.x, v.x), larger(self.y, v.y))
    }

    /// The scalar product x·x' + y·y'.
    pub const fn dot(self, v: Vector) -> f64 {
        self.x * v.x + self.y * v.y
    }

    /// The length √(x·x + y·y).
    ///
    /// Squares that underflow give 0 and squares that overflow give infinity, as in the handout's
    /// formula.
    pub fn norm(self) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt()
    }

    /// The vector of length 1 in the same direction, v × 1/|v|.
    ///
    /// The components are NaN for the null vector, which has no direction.
    pub fn normalize(self) -> Vector {
        self.mult(1.0 / self.norm())
    }

    /// True if neither component is NaN or infinite.
    pub const fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

/// The larger of two numbers; `b` if either is NaN or they are equal.
///
/// Unlike [`f64::max`], which may return either zero of +0 and −0, the result is the same on every platform.
pub const fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers; `b` if either is NaN or they are equal. See [`larger`].
pub const fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl Index<Axis> for Vector {
    type Output = f64;

    #[inline]
    fn index(&self, axis: Axis) -> &f64 {
        match axis {
            Axis::X => &self.x,
            Axis::Y => &self.y,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computes_componentwise() {
        let v = Vector::new(3.0, 4.0);
        let w = Vector::new(-1.0, 0.5);
        assert_eq!(v.add(w), Vector::new(2.0, 4.5));
        assert_eq!(v.sub(w), Vector::new(4.0, 3.5));
        assert_eq!(v.mult(2.0), Vector::new(6.0, 8.0));
        assert_eq!(v.dot(w), -1.0);
        assert_eq!(v.norm(), 5.0);
        assert_eq!(v, Vector::new(3.0, 4.0), "operations do not change their operands");
    }

    #[test]
    fn normalize_multiplies_by_the_reciprocal_of_the_norm() {
        let v = Vector::new(3.0, 4.0).normalize();
        assert_eq!((v.x, v.y), (3.0 * (1.0 / 5.0), 4.0 * (1.0 / 5.0)));
        assert!(Vector::ZERO.normalize().x.is_nan());
    }
}
