/// Why a step could not be completed. The states before it stand.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StepError {
    /// A number overflowed: what a scene with too large numbers ends in.
    #[error("step {step}: body {body:?} left the finite numbers; start it smaller or slower")]
    NotFinite {
        /// The step that failed: from state `step` to the next.
        step: u64,
        /// Name of the body.
        body: String,
    },
    /// A body is pressed from both sides by masses that cannot give way.
    #[error("step {step}: body {body:?} is crushed between {:?} and {:?}, which have infinite mass", between[0], between[1])]
    Crushed {
        /// The step that failed.
        step: u64,
        /// Name of the body.
        body: String,
        /// Names of the two infinite masses.
        between: [String; 2],
    },
    /// A spawned body is thinner than a few units in the last place of its position, so its faces coincide.
    #[error("step {step}: body {body:?} is thinner than its position can resolve; place it nearer to the origin or make it larger")]
    TooThin {
        /// The step in which it was spawned.
        step: u64,
        /// Name of the body.
        body: String,
    },
    /// Impacts at one instant repeat without loss and without end: a body at e = 1 that has no room.
    #[error("step {step}: bodies {:?} and {:?} collide for ever at one instant, because e = 1 and there is no room between them and their neighbours; leave a gap, or choose e < 1", bodies[0], bodies[1])]
    Endless {
        /// The step that failed.
        step: u64,
        /// Names of the two bodies.
        bodies: [String; 2],
    },
    /// More happened within one step than the scene allows.
    #[error("step {step}: more than {limit} events, the last between {}; raise run.events_per_step if this is meant", bodies.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(" and "))]
    TooManyEvents {
        /// The step that failed.
        step: u64,
        /// The scene's `events_per_step`.
        limit: u64,
        /// Names of the bodies that were at it last.
        bodies: Vec<String>,
    },
}
