use crate::{physics::StepError, recording, scene::SceneError};
use std::io;

/// Why a run could not be carried or recorded to its end.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RunError {
    /// An input is refused.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] SceneError),
    /// The recording cannot be written.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// The engine could not complete a step. While recording that is no error: it is recorded.
    #[error(transparent)]
    Step(#[from] StepError),
    /// Live events cannot be read.
    #[error("cannot read the events after line {line}: {source}")]
    Events {
        /// Lines read before.
        line: u64,
        /// What the system says.
        source: io::Error,
    },
    /// A live event is not text.
    #[error("line {line} of the events is not UTF-8; write it as UTF-8, or skip such lines with --lenient")]
    NotText {
        /// The line, from 1.
        line: u64,
    },
    /// A line is too long to be an event.
    #[error(
        "line {line} of the events has more than {limit} bytes, which no event needs; write one JSON object a line, or skip such lines with --lenient"
    )]
    TooLong {
        /// The line, from 1.
        line: u64,
        /// The most it may have.
        limit: usize,
    },
    /// A live event names a step that is over.
    #[error(
        "line {line} of the events names step {named}, but the run is at step {present} already; order the lines by step, or skip such lines with --lenient"
    )]
    Late {
        /// The line, from 1.
        line: u64,
        /// The step it names.
        named: u64,
        /// The step the run is at.
        present: u64,
    },
    /// A live event comes after the end of the run.
    #[error(
        "line {line} of the events names step {named}, but the run ends at step {last}; make it longer with --steps, or skip such lines with --lenient"
    )]
    AfterLastStep {
        /// The line, from 1.
        line: u64,
        /// The step it names.
        named: u64,
        /// The last step.
        last: u64,
    },
}
