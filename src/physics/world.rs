use super::{Material, Rect, Restitution, Vector};

/// The bodies alive, gravity and restitution.
#[non_exhaustive]
#[derive(Clone, Debug)]
pub struct World {
    /// The bodies in creation order, which is also the order of their ids.
    pub bodies: Vec<Body>,
    /// Acceleration by gravity, m/s²; without it, no weight is computed.
    pub gravity: Option<Vector>,
    /// The coefficient of restitution of each pair of materials.
    pub restitution: Restitution,
}

impl World {
    /// The index of a body in [`World::bodies`], if it is alive.
    pub fn index_of(&self, id: BodyId) -> Option<usize> {
        self.bodies.binary_search_by_key(&id, |body| body.id).ok()
    }

    /// The body with the given id, if it is alive.
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.index_of(id).map(|index| &self.bodies[index])
    }
}

/// The id of a body: the number of bodies created before it in the run, walls included.
///
/// Ids are never reused, so bodies sorted by id are in creation order.
pub type BodyId = u32;

/// A box: a rectangle with a mass, a velocity and a force.
///
/// The fields that change in every step lie in one cache line.
#[non_exhaustive]
#[doc(alias("box", "rigid body"))]
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Body {
    /// Position and size, m.
    pub rect: Rect,
    /// Velocity, m/s.
    pub velocity: Vector,
    /// Mass, kg; infinity for a body that no impulse moves.
    pub mass: f64,
    /// 1/mass, kg⁻¹; 0 for an infinite mass.
    pub inverse_mass: f64,
    /// The sum of the forces since the last step, N (the accumulator of the handout).
    pub force: Vector,
    /// The constant force on it, N.
    pub constant_force: Vector,
    /// Its id, in creation order.
    pub id: BodyId,
    /// Its material, for the restitution table.
    pub material: Material,
    /// Its name in errors and pictures, unique among the bodies alive.
    pub name: String,
}

impl Body {
    /// True if its mass is infinite, so that its velocity never changes.
    pub const fn is_infinite(&self) -> bool {
        self.mass == f64::INFINITY
    }

    /// True unless it is static (an infinite mass at rest), so that its position or velocity can change.
    pub fn can_move(&self) -> bool {
        !self.is_infinite() || self.velocity != Vector::ZERO
    }
}
