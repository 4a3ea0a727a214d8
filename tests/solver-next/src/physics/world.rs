use super::{Body, BodyId, Restitution, Vector};

/// The bodies alive, gravity and restitution.
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
