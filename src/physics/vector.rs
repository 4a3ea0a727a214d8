/// A vector in the plane: x to the right, y down. An immutable value.
///
/// The methods carry the handout's names, so that the solver reads beside it.
/// They compute as printed, one rounding for each + − × ÷ and √, and promise
/// nothing about overflow: a product of huge components may be infinite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector {
    /// Component to the right.
    pub x: f64,
    /// Component downwards.
    pub y: f64,
}

impl Vector {
    /// The null vector.
    pub const ZERO: Vector = Vector { x: 0.0, y: 0.0 };

    /// The vector (x, y).
    pub const fn new(x: f64, y: f64) -> Vector {
        Vector { x, y }
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

    /// The scalar product x·x' + y·y'.
    pub const fn dot(self, v: Vector) -> f64 {
        self.x * v.x + self.y * v.y
    }

    /// The length √(x·x + y·y).
    ///
    /// Squares that underflow give 0 and squares that overflow give infinity:
    /// the handout's formula is kept, not a scaled one.
    pub fn norm(self) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt()
    }

    /// The vector of length 1 in the same direction, v × 1/|v|.
    ///
    /// The null vector has no direction: its components come out NaN.
    pub fn normalize(self) -> Vector {
        self.mult(1.0 / self.norm())
    }

    /// Whether neither component is NaN or infinite.
    pub const fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
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
        assert_eq!(v, Vector::new(3.0, 4.0), "operations leave their operands alone");
    }

    #[test]
    fn normalize_multiplies_by_the_reciprocal_of_the_norm() {
        let v = Vector::new(3.0, 4.0).normalize();
        assert_eq!((v.x, v.y), (3.0 * (1.0 / 5.0), 4.0 * (1.0 / 5.0)));
        assert!(Vector::ZERO.normalize().x.is_nan());
    }
}
