use crate::physics::SolverKind;

/// How far, how finely and by which solver: the scene's `[run]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Steps per second, Hz; finite and positive.
    pub rate: f64,
    /// Steps from the first state to the last, so that states are 0..=steps.
    pub steps: u64,
    /// Which solver.
    pub solver: SolverKind,
    /// How much may happen within one step before the run is given up.
    pub events_per_step: u64,
}
