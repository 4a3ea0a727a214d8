use crate::physics::{Memory, Settings, Snapshot, Vector};

use super::{BodyTable, KnownBody};

/// Everything about one step: what a run can be taken up from to the bit.
///
/// It stands after the events of its step and before its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframe {
    /// The step.
    pub step: u64,
    /// The id the next body will get.
    pub next_id: u32,
    /// The bodies alive, in creation order.
    pub bodies: Vec<KeyframeBody>,
    /// What the solver remembers beyond the bodies.
    pub memory: Memory,
}

/// A body in a [`Keyframe`].
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframeBody {
    /// As it was spawned.
    pub known: KnownBody,
    /// Where it is, m.
    pub position: Vector,
    /// m/s.
    pub velocity: Vector,
    /// The engine's accumulator of forces, N.
    pub force: Vector,
}

impl Keyframe {
    /// What [`Engine::restore`](crate::physics::Engine::restore) takes.
    pub fn snapshot(&self, _settings: &Settings) -> Snapshot {
        todo!()
    }

    /// The bodies alive.
    pub fn table(&self) -> BodyTable {
        todo!()
    }
}
