use crate::picture::{PictureOptions, Provenance, SubjectOptions};
use std::path::{Path, PathBuf};

/// A file to check.
#[derive(Clone, Debug)]
pub enum Case {
    /// A recording, which must replay the same.
    Recording {
        /// The recording.
        path: PathBuf,
        /// The scene next to it (`NAME.toml` next to `NAME.mcap`), a new run of which must match the recording.
        scene: Option<PathBuf>,
    },
    /// A picture, which must be redrawn the same.
    Picture(ReferenceImage),
}

impl Case {
    /// The path of the file.
    pub fn path(&self) -> &Path {
        match self {
            Case::Recording { path, .. } => path,
            Case::Picture(reference) => &reference.file,
        }
    }
}

/// A picture to check, and how it is drawn.
#[derive(Clone, Debug)]
pub struct ReferenceImage {
    /// The file; it may be missing.
    pub file: PathBuf,
    /// How it is drawn.
    pub recipe: Recipe,
}

/// How a picture is drawn.
#[derive(Clone, Debug)]
pub enum Recipe {
    /// By a command that a manifest lists.
    Listed {
        /// The picture and its format.
        subject: SubjectOptions,
        /// The options of the command.
        options: Box<PictureOptions>,
        /// Scenes or recordings.
        sources: Vec<PathBuf>,
    },
    /// By the provenance that the picture contains.
    Embedded {
        /// The provenance.
        provenance: Box<Provenance>,
        /// The recordings that the provenance names, in the same order.
        sources: Vec<PathBuf>,
    },
    /// Not at all: a recording that the provenance names was not found.
    Orphaned {
        /// The recording and why it is missing.
        reason: String,
    },
    /// Not at all: the line of the manifest is invalid.
    Invalid {
        /// The line number and the error.
        reason: String,
    },
}
