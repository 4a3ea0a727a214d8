use crate::physics::{BodyId, Spawn};

use super::Change;

/// A body as its spawn told it: all that never changes.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownBody {
    /// Its number in creation order.
    pub id: BodyId,
    /// Its constants; position and velocity are those of its first moment.
    pub spawn: Spawn,
    /// What the scene wants it drawn in.
    pub color: Option<String>,
}

/// The bodies alive, in creation order, kept up to date from events.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyTable {
    bodies: Vec<KnownBody>,
}

impl BodyTable {
    /// The bodies alive, ids ascending.
    pub fn bodies(&self) -> &[KnownBody] {
        &self.bodies
    }

    /// The body of that number, if it is alive.
    pub fn body(&self, id: BodyId) -> Option<&KnownBody> {
        self.place(id).ok().map(|place| &self.bodies[place])
    }

    /// Follows one event.
    pub fn apply(&mut self, change: &Change) {
        match change {
            Change::Spawn { id, spawn, color } => {
                if let Err(place) = self.place(*id) {
                    self.bodies.insert(place, KnownBody { id: *id, spawn: spawn.clone(), color: color.clone() });
                }
            }
            Change::Delete { id } => {
                if let Ok(place) = self.place(*id) {
                    self.bodies.remove(place);
                }
            }
        }
    }

    fn place(&self, id: BodyId) -> Result<usize, usize> {
        self.bodies.binary_search_by_key(&id, |body| body.id)
    }
}
