use std::sync::Arc;

use crate::physics::{Body, BodyId, EngineConfig, Rect, Snapshot, SolverSnapshot, Vector};

use super::{BodyInfo, BodyTable};

/// The complete state of a step, from which a run can be continued bit for bit.
///
/// In the file it follows the events of its step and precedes the state.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframe {
    /// The step.
    pub step: u64,
    /// The id of the next body to be spawned.
    pub next_id: BodyId,
    /// The living bodies, in creation order.
    pub bodies: Vec<KeyframeBody>,
    /// The internal state of the solver.
    pub solver: SolverSnapshot,
}

/// A body in a [`Keyframe`].
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframeBody {
    /// The constants and the initial state.
    pub info: Arc<BodyInfo>,
    /// The upper-left corner, m.
    pub position: Vector,
    /// The velocity, m/s.
    pub velocity: Vector,
    /// The accumulated force of the engine, N.
    pub force: Vector,
}

impl Keyframe {
    /// Creates the keyframe of a snapshot, whose bodies must be those of `table`.
    pub fn new(snapshot: Snapshot, table: &BodyTable) -> Keyframe {
        let bodies = snapshot.bodies.iter().zip(table.bodies()).map(|(body, info)| KeyframeBody {
            info: info.clone(),
            position: body.rect.origin,
            velocity: body.velocity,
            force: body.force,
        });
        Keyframe { step: snapshot.step, next_id: snapshot.next_id, bodies: bodies.collect(), solver: snapshot.solver }
    }

    /// Returns the snapshot for [`Engine::restore`](crate::physics::Engine::restore).
    pub fn snapshot(&self, config: &EngineConfig) -> Snapshot {
        Snapshot {
            step: self.step,
            next_id: self.next_id,
            bodies: self.bodies.iter().map(|body| body.body(config)).collect(),
            solver: self.solver.clone(),
        }
    }

    /// Returns the living bodies.
    pub fn table(&self) -> BodyTable {
        self.bodies.iter().map(|body| body.info.clone()).collect()
    }
}

impl KeyframeBody {
    /// Returns the body as the engine stores it.
    fn body(&self, config: &EngineConfig) -> Body {
        let BodyInfo { id, spawn, .. } = &*self.info;
        Body {
            id: *id,
            name: spawn.name.clone(),
            rect: Rect::new(self.position, spawn.rect.width(), spawn.rect.height()),
            mass: spawn.mass,
            inverse_mass: 1.0 / spawn.mass,
            velocity: self.velocity,
            force: self.force,
            constant_force: spawn.force,
            material: config.restitution.material(&spawn.material),
        }
    }
}
