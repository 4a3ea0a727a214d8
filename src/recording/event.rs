use crate::physics::{BodyId, Event, Spawn};

/// One event as it was applied: the expanded truth that replay feeds to the engine.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedEvent {
    /// It changed state `step` before that state was recorded.
    pub step: u64,
    /// What happened.
    pub change: Change,
}

/// What an event did.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A body came into being.
    Spawn {
        /// The id the engine gave it.
        id: BodyId,
        /// Its constants, first position and first velocity.
        spawn: Spawn,
        /// What the scene wants it drawn in, for instance `#3366cc`.
        color: Option<String>,
    },
    /// A body went.
    Delete {
        /// Its id.
        id: BodyId,
    },
}

impl Change {
    /// The event as the engine takes it.
    pub fn event(&self) -> Event {
        match self {
            Change::Spawn { spawn, .. } => Event::Spawn(spawn.clone()),
            Change::Delete { id } => Event::Delete(*id),
        }
    }
}
