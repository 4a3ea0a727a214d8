use super::{Drift, Mismatch};
use crate::recording::SEMANTICS_VERSION;
use crate::replay::{Divergence, Verdict};
use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

/// What was found of one case.
#[derive(Debug)]
pub struct Finding {
    /// The file that is held.
    pub path: PathBuf,
    /// How it is.
    pub outcome: Outcome,
    /// What would have to stand there for the case to be the same.
    pub fresh: Option<Fresh>,
}

/// What takes the place of a file when what changed is accepted.
#[derive(Debug)]
pub enum Fresh {
    /// A picture.
    Picture(Vec<u8>),
    /// A recording, in a file that goes with this.
    Recording(tempfile::TempPath),
}

/// How a case is.
#[derive(Debug)]
pub enum Outcome {
    /// A recording replays the same or, if it is not whole, as far as it can be read.
    Replayed {
        /// What the replay says.
        verdict: Verdict,
        /// Whether a scene beside it gives it.
        has_scene: bool,
    },
    /// A recording replays differently: the engine is another.
    Diverged(Box<Divergence>),
    /// A recording was made with another version of the engine, which this one is not held to.
    OtherSemantics {
        /// That of the recording.
        found: u32,
    },
    /// A recording replays the same, but its scene is another by now.
    Drifted(Drift),
    /// A recording cannot be read at all.
    Damaged(String),
    /// A picture comes out again.
    Drawn,
    /// A picture comes out differently.
    Differs(Box<Mismatch>),
    /// A picture is not there.
    Missing,
    /// A picture's recording is not there.
    Orphaned {
        /// Which, in words.
        recording: String,
    },
    /// A picture cannot be drawn, for that is not as it should be which it is drawn of.
    Undrawn {
        /// Why.
        why: String,
        /// How bad that is.
        grade: Grade,
    },
    /// It cannot be told.
    Failed(String),
}

/// How bad an outcome is, from good to bad: the worst of all is how a check ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grade {
    /// As it should be.
    Same,
    /// Something differs, is missing or has nothing to be compared with.
    Different,
    /// A recording is truncated or corrupt.
    Damaged,
    /// It cannot be told.
    Failed,
}

impl Outcome {
    /// How bad that is.
    pub const fn grade(&self) -> Grade {
        match self {
            Outcome::Replayed { verdict: Verdict::Same { .. }, .. } | Outcome::Drawn => Grade::Same,
            Outcome::Replayed { verdict: Verdict::Diverged(_), .. }
            | Outcome::Diverged(_)
            | Outcome::OtherSemantics { .. }
            | Outcome::Drifted(_)
            | Outcome::Differs(_)
            | Outcome::Missing
            | Outcome::Orphaned { .. } => Grade::Different,
            Outcome::Replayed { verdict: Verdict::Truncated { .. } | Verdict::Corrupt { .. }, .. }
            | Outcome::Damaged(_) => Grade::Damaged,
            Outcome::Undrawn { grade, .. } => *grade,
            Outcome::Failed(_) => Grade::Failed,
        }
    }

    /// The word a script looks for.
    pub const fn word(&self) -> &'static str {
        match self {
            Outcome::Replayed { verdict: Verdict::Same { .. }, .. } | Outcome::Drawn => "same",
            Outcome::Replayed { verdict: Verdict::Diverged(_), .. } | Outcome::Diverged(_) => "diverged",
            Outcome::Replayed { verdict: Verdict::Truncated { .. }, .. } => "truncated",
            Outcome::Replayed { verdict: Verdict::Corrupt { .. }, .. } => "corrupt",
            Outcome::OtherSemantics { .. } => "other semantics",
            Outcome::Drifted(_) => "drifted",
            Outcome::Damaged(_) => "damaged",
            Outcome::Differs(_) => "differs",
            Outcome::Missing => "missing",
            Outcome::Orphaned { .. } => "orphaned",
            Outcome::Undrawn { .. } => "undrawn",
            Outcome::Failed(_) => "failed",
        }
    }
}

/// In words, the word of [`Outcome::word`] first.
impl Display for Outcome {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        match self {
            Outcome::Replayed { verdict: verdict @ Verdict::Same { .. }, has_scene: true } => {
                write!(out, "{verdict}; its scene gives it")
            }
            Outcome::Replayed { verdict, .. } => write!(out, "{verdict}"),
            Outcome::Diverged(divergence) => write!(out, "{divergence}"),
            Outcome::OtherSemantics { found } => write!(
                out,
                "other semantics: it was made with engine semantics {found}, this rebond has {SEMANTICS_VERSION}; its \
                 states are still shown"
            ),
            Outcome::Drifted(drift) => write!(out, "drifted: it replays the same, but {drift}"),
            Outcome::Damaged(what) => write!(out, "damaged: {what}"),
            Outcome::Drawn => write!(out, "same"),
            Outcome::Differs(mismatch) => write!(out, "differs: {mismatch}"),
            Outcome::Missing => write!(out, "missing: there is no such picture yet"),
            Outcome::Orphaned { recording } => {
                write!(out, "orphaned: {recording} is not there")
            }
            Outcome::Undrawn { why, .. } => write!(out, "undrawn: {why}"),
            Outcome::Failed(why) => write!(out, "failed: {why}"),
        }
    }
}
