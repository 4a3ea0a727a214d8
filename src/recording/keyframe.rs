use std::sync::Arc;

use crate::physics::{Body, BodyId, Memory, Rect, Settings, Snapshot, Vector};

use super::{BodyTable, KnownBody};

/// Everything about one step: what a run can be taken up from to the bit.
///
/// It stands after the events of its step and before its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframe {
    /// The step.
    pub step: u64,
    /// The id the next body will get.
    pub next_id: BodyId,
    /// The bodies alive, in creation order.
    pub bodies: Vec<KeyframeBody>,
    /// What the solver remembers beyond the bodies.
    pub memory: Memory,
}

/// A body in a [`Keyframe`].
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframeBody {
    /// As it was spawned.
    pub known: Arc<KnownBody>,
    /// Where it is, m.
    pub position: Vector,
    /// m/s.
    pub velocity: Vector,
    /// The engine's accumulator of forces, N.
    pub force: Vector,
}

impl Keyframe {
    /// The keyframe of a snapshot whose bodies are those of the table.
    pub fn new(snapshot: Snapshot, table: &BodyTable) -> Keyframe {
        let bodies = snapshot.bodies.iter().zip(table.bodies()).map(|(body, known)| KeyframeBody {
            known: known.clone(),
            position: body.rect.origin,
            velocity: body.velocity,
            force: body.force,
        });
        Keyframe { step: snapshot.step, next_id: snapshot.next_id, bodies: bodies.collect(), memory: snapshot.memory }
    }

    /// What [`Engine::restore`](crate::physics::Engine::restore) takes, given the settings
    /// of the run.
    pub fn snapshot(&self, settings: &Settings) -> Snapshot {
        Snapshot {
            step: self.step,
            next_id: self.next_id,
            bodies: self.bodies.iter().map(|body| body.body(settings)).collect(),
            memory: self.memory.clone(),
        }
    }

    /// The bodies alive.
    pub fn table(&self) -> BodyTable {
        self.bodies.iter().map(|body| body.known.clone()).collect()
    }
}

impl KeyframeBody {
    /// The body as the engine holds it.
    fn body(&self, settings: &Settings) -> Body {
        let KnownBody { id, spawn, .. } = &*self.known;
        Body {
            id: *id,
            name: spawn.name.clone(),
            rect: Rect::new(self.position, spawn.rect.width(), spawn.rect.height()),
            mass: spawn.mass,
            inverse_mass: 1.0 / spawn.mass,
            velocity: self.velocity,
            force: self.force,
            constant_force: spawn.force,
            material: settings.restitution.material(&spawn.material),
        }
    }
}
