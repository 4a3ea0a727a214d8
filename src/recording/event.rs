use crate::physics::{BodyId, Event, Spawn};

/// An event as it was applied to the engine, with all values resolved. Replay applies it again.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedEvent {
    /// The step whose state the event changed, before that state was recorded.
    pub step: u64,
    /// The change.
    pub change: Change,
}

/// The effect of an event.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A body was created.
    Spawn {
        /// The id that the engine assigned.
        id: BodyId,
        /// The constants, initial position and initial velocity.
        spawn: Spawn,
        /// The colour that the scene gives it, for instance `#3366cc`.
        color: Option<String>,
    },
    /// A body was removed.
    Delete {
        /// The id of the body.
        id: BodyId,
    },
}

impl Change {
    /// Returns the event in the form that the engine applies.
    pub fn event(&self) -> Event {
        match self {
            Change::Spawn { spawn, .. } => Event::Spawn(spawn.clone()),
            Change::Delete { id } => Event::Delete(*id),
        }
    }
}
