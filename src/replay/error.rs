use crate::{
    physics::StepError,
    recording::{self, error_text},
    scene::SceneError,
};
use std::io;

/// The error that ended a run or its recording.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// An input of the scene or of the live events is refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The recording cannot be written.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// The engine could not complete a step. [`record`](super::record) returns it in
    /// [`Recorded`](super::Recorded) instead and stores it in the recording.
    #[error("{}", error_text(.0))]
    Step(#[from] StepError),
    /// Live events cannot be read.
    #[error("cannot read the events after line {line}: {source}")]
    Events {
        /// The number of lines read before.
        line: u64,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A line of live events is not text.
    #[error("line {line} of the events is not UTF-8; write it as UTF-8, or skip such lines with --lenient")]
    NotText {
        /// The number of the line, from 1.
        line: u64,
    },
    /// A line of live events is too long.
    #[error(
        "line {line} of the events is longer than {limit} bytes; write one JSON object per line, or skip such lines with --lenient"
    )]
    TooLong {
        /// The number of the line, from 1.
        line: u64,
        /// The limit, bytes.
        limit: usize,
    },
    /// A live event names a step that is already recorded.
    #[error(
        "line {line} of the events names step {named}, but the run is already at step {current}; order the lines by step, or skip such lines with --lenient"
    )]
    Late {
        /// The number of the line, from 1.
        line: u64,
        /// The step that it names.
        named: u64,
        /// The step of the run.
        current: u64,
    },
    /// A live event names a step after the end of the run.
    #[error(
        "line {line} of the events names step {named}, but the run ends at step {last}; increase the number of steps with --steps, or skip such lines with --lenient"
    )]
    AfterLastStep {
        /// The number of the line, from 1.
        line: u64,
        /// The step that it names.
        named: u64,
        /// The last step.
        last: u64,
    },
}
