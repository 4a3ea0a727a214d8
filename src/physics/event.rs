use super::{BodyId, Rect, Vector};

/// An input to the world. Only events and steps change the world.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// Creates a body.
    Spawn(Spawn),
    /// Deletes the body with this id.
    Delete(BodyId),
}

/// The constants of a new body and its initial position and velocity.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub struct Spawn {
    /// Name, unique among the bodies alive.
    pub name: String,
    /// Initial position and constant size, m. Width and height are positive.
    pub rect: Rect,
    /// Mass, kg, positive; infinity for a body that no impulse moves.
    pub mass: f64,
    /// Initial velocity, m/s.
    pub velocity: Vector,
    /// Constant force, N.
    pub force: Vector,
    /// Name of the material; empty for none.
    pub material: String,
}

impl Spawn {
    /// A body at rest, without a force and without a material.
    pub fn new(name: impl Into<String>, rect: Rect, mass: f64) -> Spawn {
        let (velocity, force) = (Vector::ZERO, Vector::ZERO);
        Spawn { name: name.into(), rect, mass, velocity, force, material: String::new() }
    }

    /// Sets the initial velocity, m/s.
    pub fn with_velocity(self, velocity: Vector) -> Spawn {
        Spawn { velocity, ..self }
    }

    /// Sets the constant force, N.
    pub fn with_force(self, force: Vector) -> Spawn {
        Spawn { force, ..self }
    }

    /// Sets the material.
    pub fn with_material(self, material: impl Into<String>) -> Spawn {
        Spawn { material: material.into(), ..self }
    }

    /// Returns true if all numbers and the acceleration by the force are valid: only the mass may be infinite, and none
    /// may be NaN, whose bits differ between processors. The mass must be large enough to divide by it.
    pub fn is_valid(&self) -> bool {
        let acceleration = Vector::new(self.force.x / self.mass, self.force.y / self.mass);
        let finite = [self.rect.origin, self.velocity, self.force, acceleration].into_iter().all(Vector::is_finite);
        let sides = [self.rect.width(), self.rect.height()].into_iter().all(|side| side.is_finite() && side > 0.0);
        finite && sides && self.mass > 0.0 && (1.0 / self.mass).is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_mass_may_be_infinite() {
        let is_valid = |mass: f64, x: f64, width: f64| {
            let (name, material) = (String::new(), String::new());
            let rect = Rect::new(Vector::new(x, 0.0), width, 1.0);
            Spawn { name, rect, mass, velocity: Vector::ZERO, force: Vector::ZERO, material }.is_valid()
        };
        assert!(is_valid(1.0, 0.0, 1.0) && is_valid(f64::INFINITY, 0.0, 1.0));
        let pushed = |mass: f64| {
            let spawn = Spawn::new("", Rect::new(Vector::ZERO, 1.0, 1.0), mass);
            spawn.with_force(Vector::new(0.0, 1e300)).is_valid()
        };
        assert!(pushed(1.0) && pushed(f64::INFINITY) && !pushed(1e-300), "the acceleration must be finite, too");
        for invalid in [f64::NAN, f64::NEG_INFINITY] {
            assert!(!is_valid(invalid, 0.0, 1.0) && !is_valid(1.0, invalid, 1.0) && !is_valid(1.0, 0.0, invalid));
        }
        assert!(
            !is_valid(0.0, 0.0, 1.0)
                && !is_valid(1e-310, 0.0, 1.0)
                && !is_valid(1.0, 0.0, 0.0)
                && !is_valid(1.0, 0.0, f64::INFINITY)
        );
    }
}
