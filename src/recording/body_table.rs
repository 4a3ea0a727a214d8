use std::sync::Arc;

use crate::physics::{BodyId, Spawn, Vector};

use super::{Change, RecordedState};

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

impl KnownBody {
    /// Position (m) and velocity (m/s) of its first moment: x, y, vx, vy.
    pub fn first_numbers(&self) -> [f64; 4] {
        let (position, velocity) = (self.spawn.rect.origin, self.spawn.velocity);
        [position.x, position.y, velocity.x, velocity.y]
    }

    /// Whether x, y, vx, vy are still those of its first moment, to the bit, and at rest.
    pub fn stands_at(&self, numbers: [f64; 4]) -> bool {
        self.spawn.velocity == Vector::ZERO && self.first_numbers().map(f64::to_bits) == numbers.map(f64::to_bits)
    }
}

/// The bodies alive, in creation order, kept up to date from events.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyTable {
    bodies: Vec<Arc<KnownBody>>,
}

impl FromIterator<Arc<KnownBody>> for BodyTable {
    /// The bodies must come in creation order.
    fn from_iter<T: IntoIterator<Item = Arc<KnownBody>>>(bodies: T) -> BodyTable {
        BodyTable { bodies: bodies.into_iter().collect() }
    }
}

impl BodyTable {
    /// The bodies alive, ids ascending.
    pub fn bodies(&self) -> &[Arc<KnownBody>] {
        &self.bodies
    }

    /// The body of that number, if it is alive.
    pub fn body(&self, id: BodyId) -> Option<&Arc<KnownBody>> {
        self.place(id).ok().map(|place| &self.bodies[place])
    }

    /// Follows one event.
    pub fn apply(&mut self, change: &Change) {
        match change {
            Change::Spawn { id, spawn, color } => {
                if let Err(place) = self.place(*id) {
                    let known = KnownBody { id: *id, spawn: spawn.clone(), color: color.clone() };
                    self.bodies.insert(place, Arc::new(known));
                }
            }
            Change::Delete { id } => {
                if let Ok(place) = self.place(*id) {
                    self.bodies.remove(place);
                }
            }
        }
    }

    /// The bodies alive in creation order, each with its x, y, vx, vy if `state` lists it.
    pub fn with_state(&self, state: &RecordedState) -> impl Iterator<Item = (&Arc<KnownBody>, Option<[f64; 4]>)> {
        let mut next = 0;
        self.bodies.iter().map(move |known| {
            while state.id.get(next).is_some_and(|id| *id < known.id) {
                next += 1;
            }
            let listed = state.id.get(next) == Some(&known.id);
            (known, listed.then(|| state.numbers(next)))
        })
    }

    fn place(&self, id: BodyId) -> Result<usize, usize> {
        self.bodies.binary_search_by_key(&id, |body| body.id)
    }
}
