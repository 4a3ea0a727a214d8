use super::case::{ManifestLine, ReferenceRecording};
use super::scene_mismatch::RunDifference;
use super::{Mismatch, SceneMismatch, ValueChange};
use crate::picture::Format;
use crate::recording::SEMANTICS_VERSION;
use crate::replay::{Difference, Divergence, Verdict};
use crate::temporary::TemporaryRecording;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

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
    /// The line of the manifest that lists the file.
    pub line: Option<ManifestLine>,
}

/// The kind of a file that was checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A recording.
    Recording,
    /// A picture.
    Picture,
    /// Anything else, which cannot be checked: a manifest with an invalid line, or a folder that cannot be read.
    Other,
}

impl FileKind {
    /// The kind of file that a name indicates.
    pub fn of(path: &Path) -> FileKind {
        match (Format::from_path(path), path.extension()) {
            (Some(_), _) => FileKind::Picture,
            (None, Some(extension)) if extension == "mcap" => FileKind::Recording,
            (None, _) => FileKind::Other,
        }
    }

    /// The name of the kind.
    pub const fn name(self) -> &'static str {
        match self {
            FileKind::Recording => "recording",
            FileKind::Picture => "picture",
            FileKind::Other => "other",
        }
    }
}

impl CheckResult {
    /// A result without a replacement.
    pub const fn new(path: PathBuf, outcome: Outcome) -> CheckResult {
        CheckResult { path, outcome, replacement: None, line: None }
    }

    /// The kind of the file.
    pub fn kind(&self) -> FileKind {
        match &self.replacement {
            Some(Replacement::Recording(_) | Replacement::Run(_)) => FileKind::Recording,
            Some(Replacement::Picture(_)) => FileKind::Picture,
            None => FileKind::of(&self.path),
        }
    }

    /// The settings, options and lines that have changed.
    pub fn causes(&self) -> Vec<ValueChange> {
        match &self.outcome {
            Outcome::Drifted(mismatch) => {
                let line = mismatch.line.iter().map(|line| ValueChange {
                    name: format!("line {} of the scene", line.number),
                    recorded: line.recorded.clone(),
                    current: line.current.clone(),
                });
                mismatch.changes.iter().cloned().chain(line).collect()
            }
            Outcome::Differs(mismatch) => mismatch.changes.clone(),
            _ => Vec::new(),
        }
    }

    /// The first state or number that differs, and its step, if the runs differ.
    pub const fn divergence(&self) -> Option<(u64, &Difference)> {
        match &self.outcome {
            Outcome::Diverged(divergence) => Some((divergence.step, &divergence.difference)),
            Outcome::Drifted(SceneMismatch { first: Some(RunDifference::State { step, difference }), .. }) => {
                Some((*step, difference))
            }
            _ => None,
        }
    }
}

/// The new content of a file, which replaces it when the change is accepted.
#[derive(Debug)]
pub enum Replacement {
    /// A picture.
    Picture(Vec<u8>),
    /// A recording, in a temporary file that is removed when this is dropped.
    Recording(TemporaryRecording),
    /// A recording that does not exist and is made when it is accepted, see [`make_recording`](super::make_recording).
    Run(Box<ReferenceRecording>),
}

/// The outcome of checking one case.
#[non_exhaustive]
#[derive(Debug)]
pub enum Outcome {
    /// A recording replays the same; an incomplete or corrupt one, as far as it can be read.
    Replayed {
        /// The verdict of the replay.
        verdict: Verdict,
        /// The events that it was replayed with.
        basis: Basis,
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
    /// A file does not exist; holds a sentence.
    Missing(String),
    /// A picture without provenance: it was drawn by another program, or its provenance was removed.
    Foreign,
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

/// The events that a recording was replayed with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Its own; there is no scene next to it.
    NoScene,
    /// Its own, and a new run of its scene has the same.
    Scene,
    /// Its own, because it has values or events that the scene next to it does not have. Holds these in words.
    OwnEvents(String),
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

impl Severity {
    /// The name of the severity.
    pub const fn name(self) -> &'static str {
        match self {
            Severity::Same => "same",
            Severity::Different => "different",
            Severity::Damaged => "damaged",
            Severity::Failed => "failed",
        }
    }
}

impl Outcome {
    /// The same outcome of a replay on another basis.
    pub fn with_basis(self, basis: Basis) -> Outcome {
        match self {
            Outcome::Replayed { verdict, .. } => Outcome::Replayed { verdict, basis },
            outcome => outcome,
        }
    }

    /// The severity of this outcome.
    pub const fn severity(&self) -> Severity {
        match self {
            Outcome::Replayed { verdict: Verdict::Same { .. }, .. } | Outcome::Identical | Outcome::Foreign => {
                Severity::Same
            }
            Outcome::Replayed { verdict: Verdict::Diverged(_), .. }
            | Outcome::Diverged(_)
            | Outcome::OtherSemantics { .. }
            | Outcome::Drifted(_)
            | Outcome::Differs(_)
            | Outcome::Missing(_)
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
            Outcome::Missing(_) => "missing",
            Outcome::Foreign => "unchecked",
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
            Outcome::Replayed { verdict: verdict @ Verdict::Same { .. }, basis: Basis::Scene } => {
                write!(out, "{verdict}; matches its scene")
            }
            Outcome::Replayed { verdict, basis: Basis::OwnEvents(inputs) } => {
                write!(out, "{verdict}; it has {inputs}, and was checked by its own events")
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
            Outcome::Missing(reason) => write!(out, "missing: {reason}"),
            Outcome::Foreign => write!(out, "unchecked: it carries no rebond provenance"),
            Outcome::Orphaned { reason } => write!(out, "orphaned: {reason}"),
            Outcome::Unrenderable { reason, .. } => write!(out, "undrawn: {reason}"),
            Outcome::Failed(reason) => write!(out, "failed: {reason}"),
        }
    }
}
