use super::{Body, BodyId};

/// The complete state of an engine, from which it continues bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The step of the state.
    pub step: u64,
    /// The id of the next body to be spawned.
    pub next_id: BodyId,
    /// The bodies alive, in creation order, as sampled at this step.
    pub bodies: Vec<Body>,
    /// The state of the solver.
    pub solver: SolverSnapshot,
}

/// The state of a solver as two flat lists, whose layout the solver defines.
///
/// It consists of numbers only, so that it can be stored without knowledge of the solver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolverSnapshot {
    /// Counts, steps, ids.
    pub integers: Vec<u64>,
    /// Seconds, metres, metres per second.
    pub numbers: Vec<f64>,
}

/// The reason why a snapshot cannot be restored: another solver created it, or it is damaged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the snapshot of step {step} does not fit the solver: {reason}")]
pub struct SnapshotError {
    /// The step of the snapshot.
    pub step: u64,
    /// The mismatch.
    pub reason: String,
}
