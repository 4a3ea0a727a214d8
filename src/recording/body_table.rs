use std::sync::Arc;

use crate::physics::{BodyId, Spawn, Vector};

use super::{Change, Paint, RecordedState};

/// The constants of a body and its initial state, from its spawn.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyInfo {
    /// The id; ids ascend in creation order.
    pub id: BodyId,
    /// The constants, and the position and velocity at the spawn.
    pub spawn: Spawn,
    /// The colour that the scene gives it, and its image.
    pub paint: Paint,
}

impl BodyInfo {
    /// Creates a body without a colour of its own or an image.
    pub fn new(id: BodyId, spawn: Spawn) -> BodyInfo {
        BodyInfo { id, spawn, paint: Paint::default() }
    }

    /// Returns x, y (m), vx, vy (m/s) at the spawn.
    pub fn initial_state(&self) -> [f64; 4] {
        let (position, velocity) = (self.spawn.rect.origin, self.spawn.velocity);
        [position.x, position.y, velocity.x, velocity.y]
    }

    /// Returns true if the body was spawned at rest and `state` (x, y, vx, vy) has the bits of its
    /// initial state.
    pub fn is_at_initial_state(&self, state: [f64; 4]) -> bool {
        self.spawn.velocity == Vector::ZERO && self.initial_state().map(f64::to_bits) == state.map(f64::to_bits)
    }

    /// Returns the first field of `rebond_msgs/Spawn` in which the bodies differ, numbers bit for bit, and its value in
    /// each of them.
    pub fn difference(&self, other: &BodyInfo) -> Option<(&'static str, [String; 2])> {
        let (a, b) = (&self.spawn, &other.spawn);
        let numbers = [
            ("x", a.rect.origin.x, b.rect.origin.x),
            ("y", a.rect.origin.y, b.rect.origin.y),
            ("width", a.rect.width(), b.rect.width()),
            ("height", a.rect.height(), b.rect.height()),
            ("mass", a.mass, b.mass),
            ("vx", a.velocity.x, b.velocity.x),
            ("vy", a.velocity.y, b.velocity.y),
            ("fx", a.force.x, b.force.x),
            ("fy", a.force.y, b.force.y),
        ];
        let texts = [
            ("name", a.name.as_str(), b.name.as_str()),
            ("material", &a.material, &b.material),
            ("color", self.paint.as_str(), other.paint.as_str()),
        ];
        if self.id != other.id {
            return Some(("id", [self.id, other.id].map(|id| id.to_string())));
        }
        if let Some((field, a, b)) = numbers.into_iter().find(|(_, a, b)| a.to_bits() != b.to_bits()) {
            return Some((field, [a, b].map(|number| format!("{number:?}"))));
        }
        let (field, a, b) = texts.into_iter().find(|(_, a, b)| a != b)?;
        Some((field, [a, b].map(|text| format!("{text:?}"))))
    }
}

/// The living bodies in creation order, updated by events.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyTable {
    bodies: Vec<Arc<BodyInfo>>,
}

impl FromIterator<Arc<BodyInfo>> for BodyTable {
    /// Collects bodies, which must be in creation order.
    fn from_iter<T: IntoIterator<Item = Arc<BodyInfo>>>(bodies: T) -> BodyTable {
        BodyTable { bodies: bodies.into_iter().collect() }
    }
}

impl BodyTable {
    /// The living bodies, ids ascending.
    pub fn bodies(&self) -> &[Arc<BodyInfo>] {
        &self.bodies
    }

    /// Returns the body with this id, if it is alive.
    pub fn body(&self, id: BodyId) -> Option<&Arc<BodyInfo>> {
        self.index(id).ok().map(|index| &self.bodies[index])
    }

    /// Applies an event.
    pub fn apply(&mut self, change: &Change) {
        match change {
            Change::Spawn(info) => {
                if let Err(index) = self.index(info.id) {
                    self.bodies.insert(index, info.clone());
                }
            }
            Change::Delete { id } => {
                if let Ok(index) = self.index(*id) {
                    self.bodies.remove(index);
                }
            }
        }
    }

    /// Returns the living bodies in creation order, each with its x, y, vx, vy if `state` lists it.
    pub fn join_state(&self, state: &RecordedState) -> impl Iterator<Item = (&Arc<BodyInfo>, Option<[f64; 4]>)> {
        let mut next = 0;
        self.bodies.iter().map(move |info| {
            while state.id.get(next).is_some_and(|id| *id < info.id) {
                next += 1;
            }
            let listed = state.id.get(next) == Some(&info.id);
            (info, listed.then(|| state.body_state(next)))
        })
    }

    fn index(&self, id: BodyId) -> Result<usize, usize> {
        self.bodies.binary_search_by_key(&id, |body| body.id)
    }
}
