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

/// A picture to check, and the recipe for drawing it.
#[derive(Clone, Debug)]
pub struct ReferenceImage {
    /// The file; it may be missing.
    pub file: PathBuf,
    /// The recipe for drawing it.
    pub recipe: Recipe,
}

/// The recipe for drawing a picture.
#[derive(Clone, Debug)]
pub enum Recipe {
    /// Draw it with a command that a manifest lists.
    Listed {
        /// The picture and its format.
        subject: SubjectOptions,
        /// The options of the command.
        options: Box<PictureOptions>,
        /// Scenes or recordings.
        sources: Vec<PathBuf>,
    },
    /// Redraw it from the provenance that it contains.
    Embedded {
        /// The provenance.
        provenance: Box<Provenance>,
        /// The recordings that the provenance names, in the same order.
        sources: Vec<PathBuf>,
    },
    /// It cannot be drawn: a recording that its provenance names was not found.
    Orphaned {
        /// The recording and why it is missing.
        reason: String,
    },
    /// It cannot be drawn: the line of the manifest is invalid.
    Invalid {
        /// The line number and the error.
        reason: String,
    },
}
