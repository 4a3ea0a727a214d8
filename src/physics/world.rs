use super::{Axis, Material, Rect, Restitution, Vector, larger, smaller};

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

    /// The kinetic energy of the bodies of finite mass, Σ ½·m·v², J.
    pub fn kinetic_energy(&self) -> f64 {
        self.finite_bodies().fold(0.0, |sum, body| sum + 0.5 * body.mass * body.velocity.dot(body.velocity))
    }

    /// The potential energy of gravity and the constant forces on the bodies of finite mass, −Σ (m·g + F)·x at the
    /// centres, J. Exactly 0 if neither gravity nor a force acts on any body.
    pub fn potential_energy(&self) -> f64 {
        let gravity = self.gravity.unwrap_or(Vector::ZERO);
        let force = |body: &Body| gravity.mult(body.mass).add(body.constant_force);
        // Adding to 0 instead of summing from −0, and skipping bodies without force, keeps the sum from being −0.
        let subject = self.finite_bodies().filter(|body| force(body) != Vector::ZERO);
        subject.fold(0.0, |sum, body| sum - force(body).dot(body.rect.center()))
    }

    /// The momentum of the bodies of finite mass, Σ m·v, kg·m/s.
    pub fn momentum(&self) -> Vector {
        self.finite_bodies().fold(Vector::ZERO, |sum, body| sum.add(body.velocity.mult(body.mass)))
    }

    /// The deepest overlap of any two boxes, m: the shorter side of their intersection. 0 if none overlap.
    ///
    /// Pairs of infinite masses are excluded. The boxes are sorted along x (sweep and prune), so that only
    /// pairs that overlap on x are compared.
    pub fn deepest_overlap(&self) -> f64 {
        let mut sorted: Vec<&Body> = self.bodies.iter().collect();
        sorted.sort_by(|a, b| a.rect.origin.x.total_cmp(&b.rect.origin.x));
        let mut deepest = 0.0;
        for (index, a) in sorted.iter().enumerate() {
            let right = a.rect.far_corner().x;
            for b in sorted[index + 1..].iter().take_while(|b| b.rect.origin.x < right) {
                if !(a.is_infinite() && b.is_infinite()) {
                    let [x, y] = Axis::BOTH.map(|axis| a.rect.overlap_along(axis, &b.rect));
                    deepest = larger(smaller(x, y), deepest);
                }
            }
        }
        deepest
    }

    fn finite_bodies(&self) -> impl Iterator<Item = &Body> {
        self.bodies.iter().filter(|body| !body.is_infinite())
    }
}

/// The id of a body: the number of bodies created before it in the run, walls included.
///
/// Ids are never reused, so bodies sorted by id are in creation order.
pub type BodyId = u32;

/// A box: a rectangle with a mass, a velocity and a force.
///
/// Position and velocity, which the event-driven solver writes in every step, lie in one cache line.
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
