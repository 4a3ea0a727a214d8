use super::{Identity, StateBounds};

/// The end record of a finished recording (metadata `rebond_end`): how the run ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Trailer {
    /// The number of steps, which is also the step of the last state.
    pub steps: u64,
    /// The number of collisions with an impulse; `None` if the original end record was lost.
    pub collisions: Option<u64>,
    /// The number of bodies ever spawned, walls included.
    pub bodies: u64,
    /// The number of spawns and deletes.
    pub events: u64,
    /// The engine's error, if the run ended in one.
    pub error: Option<String>,
    /// True if the recording was recovered from a damaged or unfinished one.
    pub recovered: bool,
    /// Bounds of all recorded states; `None` if states are missing, if a value is not finite,
    /// and before format 2.
    pub state_bounds: Option<StateBounds>,
    /// The identity of the run.
    pub identity: Identity,
}
