use super::{Body, BodyId, Restitution, Vector};

/// The bodies alive and what acts on all of them.
#[derive(Clone, Debug)]
pub struct World {
    /// In creation order, which is also the order of their ids.
    pub bodies: Vec<Body>,
    /// m/s²; absent means that nothing is computed for it.
    pub gravity: Option<Vector>,
    /// The coefficient of restitution of each pair of materials.
    pub restitution: Restitution,
}

impl World {
    /// The place of a body in [`World::bodies`], if it is alive.
    pub fn place(&self, id: BodyId) -> Option<usize> {
        self.bodies.binary_search_by_key(&id, |body| body.id).ok()
    }

    /// The body of that number, if it is alive.
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.place(id).map(|place| &self.bodies[place])
    }
}
