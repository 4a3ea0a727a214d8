use super::{Mismatch, SceneMismatch, TemporaryRecording};
use crate::recording::SEMANTICS_VERSION;
use crate::replay::{Divergence, Verdict};
use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

/// The result of checking one case.
#[non_exhaustive]
#[derive(Debug)]
pub struct CheckResult {
    /// The path of the file that was checked.
    pub path: PathBuf,
    /// The outcome.
    pub outcome: Outcome,
    /// The new content of the file, if it can be produced and differs.
    pub replacement: Option<Replacement>,
}

/// The new content of a file, which replaces it when the change is accepted.
#[derive(Debug)]
pub enum Replacement {
    /// A picture.
    Picture(Vec<u8>),
    /// A recording, in a temporary file that is removed when this is dropped.
    Recording(TemporaryRecording),
}

/// The outcome of checking one case.
#[non_exhaustive]
#[derive(Debug)]
pub enum Outcome {
    /// A recording replays the same; a incomplete or corrupt one, as far as it can be read.
    Replayed {
        /// The verdict of the replay.
        verdict: Verdict,
        /// True if there is a scene next to the recording and a new run of it matches.
        matches_scene: bool,
    },
    /// A recording replays differently: the engine has changed.
    Diverged(Box<Divergence>),
    /// A recording was made with another version of the engine semantics and cannot be compared.
    OtherSemantics {
        /// The version of the recording.
        found: u32,
    },
    /// A recording replays the same, but its scene has changed since.
    Drifted(SceneMismatch),
    /// A recording cannot be read at all.
    Damaged(String),
    /// A picture is redrawn the same.
    Identical,
    /// A picture is redrawn differently.
    Differs(Box<Mismatch>),
    /// A picture does not exist.
    Missing,
    /// A recording of a picture was not found.
    Orphaned {
        /// The recording and why it is missing.
        reason: String,
    },
    /// A picture cannot be drawn, for example because its recording is damaged.
    Unrenderable {
        /// The error.
        reason: String,
        /// The severity of the error.
        severity: Severity,
    },
    /// The case cannot be checked.
    Failed(String),
}

/// The severity of an outcome, in ascending order. The worst of all outcomes determines the exit code of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The file is unchanged.
    Same,
    /// Something differs, is missing or cannot be compared.
    Different,
    /// A recording is incomplete or corrupt.
    Damaged,
    /// The case cannot be checked.
    Failed,
}

impl Outcome {
    /// The severity of this outcome.
    pub const fn severity(&self) -> Severity {
        match self {
            Outcome::Replayed { verdict: Verdict::Same { .. }, .. } | Outcome::Identical => Severity::Same,
            Outcome::Replayed { verdict: Verdict::Diverged(_), .. }
            | Outcome::Diverged(_)
            | Outcome::OtherSemantics { .. }
            | Outcome::Drifted(_)
            | Outcome::Differs(_)
            | Outcome::Missing
            | Outcome::Orphaned { .. } => Severity::Different,
            Outcome::Replayed { verdict: Verdict::Incomplete { .. } | Verdict::Corrupt { .. }, .. }
            | Outcome::Damaged(_) => Severity::Damaged,
            Outcome::Unrenderable { severity, .. } => *severity,
            Outcome::Failed(_) => Severity::Failed,
        }
    }

    /// The first word of the line of text, for scripts.
    pub const fn word(&self) -> &'static str {
        match self {
            Outcome::Replayed { verdict: Verdict::Same { .. }, .. } | Outcome::Identical => "same",
            Outcome::Replayed { verdict: Verdict::Diverged(_), .. } | Outcome::Diverged(_) => "diverged",
            Outcome::Replayed { verdict: Verdict::Incomplete { .. }, .. } => "incomplete",
            Outcome::Replayed { verdict: Verdict::Corrupt { .. }, .. } => "corrupt",
            Outcome::OtherSemantics { .. } => "other semantics",
            Outcome::Drifted(_) => "drifted",
            Outcome::Damaged(_) => "damaged",
            Outcome::Differs(_) => "differs",
            Outcome::Missing => "missing",
            Outcome::Orphaned { .. } => "orphaned",
            Outcome::Unrenderable { .. } => "undrawn",
            Outcome::Failed(_) => "failed",
        }
    }
}

/// Formats a sentence that begins with [`Outcome::word`].
impl Display for Outcome {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        match self {
            Outcome::Replayed { verdict: verdict @ Verdict::Same { .. }, matches_scene: true } => {
                write!(out, "{verdict}; matches its scene")
            }
            Outcome::Replayed { verdict, .. } => write!(out, "{verdict}"),
            Outcome::Diverged(divergence) => write!(out, "{divergence}"),
            Outcome::OtherSemantics { found } => write!(
                out,
                "other semantics: recorded with engine semantics {found}, this rebond has {SEMANTICS_VERSION}; its states can \
                 still be drawn and exported"
            ),
            Outcome::Drifted(mismatch) => write!(out, "drifted: it replays the same, but {mismatch}"),
            Outcome::Damaged(error) => write!(out, "damaged: {error}"),
            Outcome::Identical => write!(out, "same"),
            Outcome::Differs(mismatch) => write!(out, "differs: {mismatch}"),
            Outcome::Missing => write!(out, "missing: the picture does not exist"),
            Outcome::Orphaned { reason } => write!(out, "orphaned: {reason}"),
            Outcome::Unrenderable { reason, .. } => write!(out, "undrawn: {reason}"),
            Outcome::Failed(reason) => write!(out, "failed: {reason}"),
        }
    }
}
