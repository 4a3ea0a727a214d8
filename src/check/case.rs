use crate::illustration::{Evidence, Format, Wish};
use std::path::{Path, PathBuf};

/// One file that is held.
#[derive(Clone, Debug)]
pub enum Case {
    /// A recording must replay the same.
    Recording {
        /// The recording.
        path: PathBuf,
        /// The scene beside it, which must still give it: `NAME.toml` beside `NAME.mcap`.
        scene: Option<PathBuf>,
    },
    /// A picture must come out again.
    Picture(Reference),
}

impl Case {
    /// The file that is held.
    pub fn path(&self) -> &Path {
        match self {
            Case::Recording { path, .. } => path,
            Case::Picture(reference) => &reference.file,
        }
    }
}

/// A picture that is held, and how it is drawn.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The file; it may be missing.
    pub file: PathBuf,
    /// What draws it.
    pub drawing: Drawing,
}

/// What draws a picture.
#[derive(Clone, Debug)]
pub enum Drawing {
    /// What somebody wrote down.
    Wished {
        /// What they wish for.
        wish: Box<Wish>,
        /// Scenes or recordings.
        sources: Vec<PathBuf>,
        /// What it is written as.
        format: Format,
    },
    /// The evidence in the picture itself.
    Again {
        /// What it says.
        evidence: Box<Evidence>,
        /// The recordings it names, in its order.
        sources: Vec<PathBuf>,
        /// What it is written as.
        format: Format,
    },
    /// Nothing: the evidence in the picture names a recording that is nowhere.
    Orphaned {
        /// Which, in words.
        recording: String,
    },
    /// What somebody wrote down cannot be understood.
    Refused {
        /// Why.
        why: String,
    },
}
