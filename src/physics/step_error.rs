/// The reason why a step could not be completed. The states before it remain valid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StepError {
    /// A number overflowed, as in scenes with extreme values.
    #[error("step {step}: body {body:?} left the finite numbers; start it smaller or slower")]
    NotFinite {
        /// The step that failed: from state `step` to state `step + 1`.
        step: u64,
        /// Name of the body.
        body: String,
    },
    /// Infinite masses press on a body from both sides.
    #[error("step {step}: body {body:?} is crushed between {:?} and {:?}, which have infinite mass", between[0], between[1])]
    Crushed {
        /// The step that failed.
        step: u64,
        /// Name of the body.
        body: String,
        /// Names of the two infinite masses.
        between: [String; 2],
    },
    /// A step had more events than the scene allows.
    #[error("step {step}: more than {limit} events, the last between {}; raise run.events_per_step if this is meant", bodies.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(" and "))]
    TooManyEvents {
        /// The step that failed.
        step: u64,
        /// The scene's `events_per_step`.
        limit: u64,
        /// Names of the bodies of the last event.
        bodies: Vec<String>,
    },
}
