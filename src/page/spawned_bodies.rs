use rebond::recordings::{BodyInfo, Change, RecordedEvent};
use rebond::{BodyId, Collision};
use std::collections::BTreeMap;
use std::sync::Arc;

/// All bodies that were spawned until the present step, for their names, materials and colours.
#[derive(Default)]
pub struct SpawnedBodies(BTreeMap<BodyId, Arc<BodyInfo>>);

impl SpawnedBodies {
    /// Adds the bodies that events spawn.
    pub fn add(&mut self, events: &[RecordedEvent]) {
        self.0.extend(events.iter().filter_map(spawned).map(|info| (info.id, info)));
    }

    /// Removes the bodies from number `id` on.
    pub fn forget_from(&mut self, id: BodyId) {
        self.0.split_off(&id);
    }

    /// The body of a number.
    pub fn get(&self, id: BodyId) -> Option<&Arc<BodyInfo>> {
        self.0.get(&id)
    }

    /// The name of a body; empty if the body is unknown.
    pub fn name(&self, id: BodyId) -> &str {
        self.0.get(&id).map_or("", |info| &info.spawn.name)
    }

    /// Returns true if a body has this name.
    pub fn has_name(&self, name: &str) -> bool {
        self.0.values().any(|info| info.spawn.name == name)
    }

    /// The materials in alphabetical order.
    pub fn materials(&self) -> Vec<&str> {
        let mut materials: Vec<&str> = self.0.values().map(|info| info.spawn.material.as_str()).collect();
        materials.retain(|material| !material.is_empty());
        materials.sort_unstable();
        materials.dedup();
        materials
    }

    /// The collision with the bodies in the order of the figures: c has a finite mass, else it is the one created
    /// first.
    pub fn in_order_of_figures(&self, collision: &Collision) -> Collision {
        let is_infinite = |id: &BodyId| self.0.get(id).is_some_and(|info| info.spawn.mass.is_infinite());
        let keys = collision.bodies.each_ref().map(|id| (is_infinite(id), *id));
        let mut collision = collision.clone();
        if keys[0] > keys[1] {
            collision.bodies.reverse();
            collision.rects.reverse();
            collision.shares.reverse();
            collision.before.reverse();
            collision.after.reverse();
            collision.normal = collision.normal.mult(-1.0);
            collision.penetration = collision.penetration.mult(-1.0);
        }
        collision
    }
}

/// The body that an event spawns.
pub fn spawned(event: &RecordedEvent) -> Option<Arc<BodyInfo>> {
    match &event.change {
        Change::Spawn(info) => Some(info.clone()),
        Change::Delete { .. } => None,
    }
}
