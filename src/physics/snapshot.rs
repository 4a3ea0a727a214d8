use super::{Body, BodyId};

/// Everything an engine needs to go on to the bit as if it had never stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The step whose state this is.
    pub step: u64,
    /// The id the next body will get.
    pub next_id: BodyId,
    /// The bodies alive, in creation order, as sampled at that step.
    pub bodies: Vec<Body>,
    /// What the solver remembers beyond that.
    pub memory: Memory,
}

/// A solver's own state as two flat lists, laid out as that solver documents.
///
/// Numbers and nothing else, so that whoever stores a snapshot need not know the solver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memory {
    /// Counts, steps, ids.
    pub integers: Vec<u64>,
    /// Seconds, metres, metres per second.
    pub numbers: Vec<f64>,
}

/// Why a snapshot cannot be restored: it was not made by this solver, or it is damaged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the snapshot of step {step} does not fit the solver: {what}")]
pub struct SnapshotError {
    /// The step of the snapshot.
    pub step: u64,
    /// What does not fit.
    pub what: String,
}
