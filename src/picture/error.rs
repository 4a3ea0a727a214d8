use crate::picture::RenderError;
use crate::recording::{self, error_text};
use crate::replay::Verdict;
use crate::scene::SceneError;
use std::path::PathBuf;

/// The reason why a picture could not be drawn or read.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A recording cannot be read.
    #[error("{}: {source}", path.display())]
    Recording {
        /// The recording.
        path: PathBuf,
        /// The cause.
        source: recording::Error,
    },
    /// The scene stored in a recording is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Drawing, encoding or decoding failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The recording does not contain the requested subject.
    #[error("there is nothing to show: {reason}")]
    NothingToShow {
        /// The missing subject, and the existing alternatives.
        reason: String,
    },
    /// Options that cannot be combined.
    #[error("{reason}")]
    Incompatible {
        /// The conflict, and what to do instead.
        reason: String,
    },
    /// The replay of a recording diverged, so its collisions are unknown.
    #[error("{}: {verdict}", path.display())]
    Diverged {
        /// The recording.
        path: PathBuf,
        /// The divergence.
        verdict: Box<Verdict>,
    },
    /// The engine failed in a step that a picture needs.
    #[error("{}: {}", path.display(), error_text(source))]
    Step {
        /// The recording.
        path: PathBuf,
        /// The cause.
        source: crate::physics::StepError,
    },
    /// A file is not a picture drawn by rebond.
    #[error("the file carries no rebond provenance: {reason}")]
    NoProvenance {
        /// The missing or invalid part.
        reason: String,
    },
    /// The provenance of a picture is damaged.
    #[error("the rebond provenance of the file is damaged: {reason}")]
    DamagedProvenance {
        /// The missing or invalid part.
        reason: String,
    },
    /// A picture cannot be drawn again.
    #[error("the picture cannot be drawn again: {reason}")]
    CannotRedraw {
        /// The recording that is missing or unsuitable.
        reason: String,
    },
}
