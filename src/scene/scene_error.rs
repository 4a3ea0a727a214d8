use std::{io, path::PathBuf};

use miette::Diagnostic;

use super::{Place, SceneSource};

/// Why a scene or a line of events is refused.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("cannot read the scene {}: {error}", path.display())]
    Unreadable {
        /// As the user named it.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

/// What is wrong at a place of a scene or of a line of events.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A body of that name is alive already.
    #[error("the name {name:?} is taken: a body of that name is alive at step {step}")]
    DuplicateName {
        /// The name.
        name: String,
        /// When.
        step: u64,
    },
    /// No body of that name is alive.
    #[error("no body named {name:?} is alive at step {step}")]
    NotAlive {
        /// The name.
        name: String,
        /// When.
        step: u64,
    },
}

impl SceneError {
    /// The error of that fault at a place an [`super::Input`] of the scene gave: for what shows only in the run.
    pub fn at(source: &SceneSource, place: &Place, fault: Fault) -> SceneError {
        let _ = (source, place, fault);
        todo!("the types come first")
    }
}
