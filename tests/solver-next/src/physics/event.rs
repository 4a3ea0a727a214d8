use super::{BodyId, Rect, Vector};

/// One change of the world from outside. There is no other way in.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A body comes into being.
    Spawn(Spawn),
    /// The body of that number goes.
    Delete(BodyId),
}

/// All constants of a new body, and its first position and velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Spawn {
    /// Unique among the bodies alive.
    pub name: String,
    /// First position and lifelong size, m; both extents positive.
    pub rect: Rect,
    /// kg, positive; infinity for what is never pushed.
    pub mass: f64,
    /// First velocity, m/s.
    pub velocity: Vector,
    /// Constant force, N.
    pub force: Vector,
    /// Name of its material; empty for none.
    pub material: String,
}

impl Spawn {
    /// Whether there can be such a body: only the mass may be infinite, and none is NaN, whose
    /// bits are not the same on every processor.
    pub fn is_possible(&self) -> bool {
        let finite = [self.rect.origin, self.velocity, self.force].into_iter().all(Vector::is_finite);
        let sides = [self.rect.width(), self.rect.height()].into_iter().all(|side| side.is_finite() && side > 0.0);
        finite && sides && self.mass > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_but_a_mass_may_be_infinite() {
        let possible = |mass: f64, x: f64, width: f64| {
            let (name, material) = (String::new(), String::new());
            let rect = Rect::new(Vector::new(x, 0.0), width, 1.0);
            Spawn { name, rect, mass, velocity: Vector::ZERO, force: Vector::ZERO, material }.is_possible()
        };
        assert!(possible(1.0, 0.0, 1.0) && possible(f64::INFINITY, 0.0, 1.0));
        for strange in [f64::NAN, f64::NEG_INFINITY] {
            assert!(!possible(strange, 0.0, 1.0) && !possible(1.0, strange, 1.0) && !possible(1.0, 0.0, strange));
        }
        assert!(!possible(0.0, 0.0, 1.0) && !possible(1.0, 0.0, 0.0) && !possible(1.0, 0.0, f64::INFINITY));
    }
}
