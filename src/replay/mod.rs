//! Runs scenes and replays recordings. Both drive an [`Engine`](crate::physics::Engine) step by step.
//!
//! A [`Run`] turns the inputs of a scene into events of the engine; [`record()`] writes such a run to a recording. A
//! [`Replayer`] applies the events of a recording and compares every state bit for bit, which gives a [`Verdict`].

mod altered_setting;
mod live_events;
mod record;
mod replayer;
mod scene_run;
mod verdict;

pub use live_events::{LiveEvents, NO_LIVE_EVENTS, OnBadEvent};
pub use record::{RecordOptions, Recorded, RecordingRun, header, record};
pub use replayer::{ALL_STEPS, Replayer};
pub use scene_run::{IdleClicks, Run, RunError, RunSnapshot, engine_config};
pub use verdict::{Difference, Divergence, Verdict, distance, ulps};

#[cfg(test)]
mod tests;
