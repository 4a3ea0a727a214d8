use crate::recording;
use crate::render::RenderError;
use crate::replay::Verdict;
use crate::scene::SceneError;
use std::path::PathBuf;

/// Why there is no illustration.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A recording cannot be read.
    #[error("{}: {source}", path.display())]
    Recording {
        /// Which one.
        path: PathBuf,
        /// What of it.
        source: recording::Error,
    },
    /// The scene in a recording is refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// There is no picture.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// What was asked for is not there.
    #[error("there is nothing to show: {what}")]
    Nothing {
        /// What was asked for, and what there is.
        what: String,
    },
    /// What was asked for cannot be drawn so.
    #[error("{what}")]
    Unfit {
        /// What does not go together, and what would.
        what: String,
    },
    /// A recording did not replay the same, so what happened in it is not known.
    #[error("{}: {verdict}", path.display())]
    Diverged {
        /// Which one.
        path: PathBuf,
        /// How.
        verdict: Box<Verdict>,
    },
    /// The engine could not go where a picture was to be taken.
    #[error("{}: {source}", path.display())]
    Step {
        /// The recording.
        path: PathBuf,
        /// What happened.
        source: crate::physics::StepError,
    },
    /// A file is no picture of rebond.
    #[error("no picture that says what it was drawn from: {what}")]
    NoEvidence {
        /// What gives it away.
        what: String,
    },
    /// A picture cannot be drawn again.
    #[error("the picture cannot be drawn again: {what}")]
    NotAgain {
        /// What is missing.
        what: String,
    },
}
