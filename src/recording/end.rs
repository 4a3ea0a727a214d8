use super::{Extremes, Identity};

/// How a run ended: what stands at the end of a finished recording.
#[derive(Clone, Debug, PartialEq)]
pub struct End {
    /// Steps taken: the number of the last state.
    pub steps: u64,
    /// Collisions that gave an impulse; unknown if the run's own end was lost.
    pub collisions: Option<u64>,
    /// Bodies that ever lived, walls included.
    pub bodies: u64,
    /// Spawns and deletes.
    pub events: u64,
    /// The engine's error, if the run ended in one.
    pub error: Option<String>,
    /// Whether this is what could be saved of a damaged or unfinished recording.
    pub recovered: bool,
    /// What no recorded state exceeds; unknown where states are missing, where one is beyond
    /// the finite numbers, and before format 2.
    pub extremes: Option<Extremes>,
    /// The digest of it all.
    pub identity: Identity,
}
