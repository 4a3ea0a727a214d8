//! Output of `check`: lines of text or JSON.

use crate::check::{CheckResult, Outcome, Replacement, SceneMismatch, Severity};
use crate::cli::json::difference;
use crate::counted::counted;
use crate::picture::Format;
use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

/// The line of text about a result.
pub fn line(result: &CheckResult, is_accepted: bool) -> String {
    let accepted = if is_accepted { "; accepted" } else { "" };
    format!("{}: {}{accepted}\n", result.path.display(), result.outcome)
}

/// The line of JSON about a result.
pub fn json(result: &CheckResult, shown: &[PathBuf], is_accepted: bool) -> String {
    let outcome = &result.outcome;
    let shown: Vec<String> = shown.iter().map(|path| path.display().to_string()).collect();
    let object = serde_json::json!({
        "path": result.path.display().to_string(),
        "outcome": outcome.word(),
        "what": outcome.to_string(),
        "divergence": divergence(outcome),
        "accepted": is_accepted,
        "shown": shown,
    });
    format!("{object}\n")
}

/// The first state or number that differs, if the runs differ.
fn divergence(outcome: &Outcome) -> Option<serde_json::Value> {
    match outcome {
        Outcome::Diverged(divergence) => Some(difference(divergence.step, &divergence.difference)),
        Outcome::Drifted(SceneMismatch::State { step, difference: found }) => Some(difference(*step, found)),
        Outcome::Drifted(_) | Outcome::Replayed { .. } | Outcome::OtherSemantics { .. } | Outcome::Damaged(_) => None,
        Outcome::Identical | Outcome::Differs(_) | Outcome::Missing | Outcome::Orphaned { .. } => None,
        Outcome::Unrenderable { .. } | Outcome::Failed(_) => None,
    }
}

/// The number of cases checked, by kind and outcome.
#[derive(Debug, Default)]
pub struct CheckSummary {
    recordings: u64,
    pictures: u64,
    failed: u64,
    accepted: u64,
    /// True if `--update` would accept a change.
    has_acceptable: bool,
}

impl CheckSummary {
    /// Counts one result.
    pub fn count(&mut self, result: &CheckResult, is_accepted: bool) {
        let is_recording = match &result.replacement {
            Some(Replacement::Recording(_)) => true,
            Some(Replacement::Picture(_)) => false,
            None => Format::from_path(&result.path).is_none(),
        };
        let kind = if is_recording { &mut self.recordings } else { &mut self.pictures };
        *kind += 1;
        let is_failed = result.outcome.severity() != Severity::Same;
        self.accepted += u64::from(is_failed && is_accepted);
        self.failed += u64::from(is_failed && !is_accepted);
        self.has_acceptable |= result.replacement.is_some() && !is_accepted;
    }

    /// A hint what to do next, if anything can be accepted.
    pub const fn advice(&self) -> &'static str {
        if self.has_acceptable { ", and accept intended changes with --update" } else { "" }
    }
}

/// Formats the verdict on all cases.
impl Display for CheckSummary {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let CheckSummary { recordings, pictures, failed, accepted, .. } = self;
        match (failed, accepted) {
            (0, 0) => write!(out, "same: {}, {}", counted(*recordings, "recording"), counted(*pictures, "picture")),
            (0, _) => write!(out, "accepted: {accepted} of {} changed", recordings + pictures),
            (_, 0) => write!(out, "not the same: {failed} of {}", recordings + pictures),
            (_, _) => write!(out, "not the same: {failed} of {}, {accepted} accepted", recordings + pictures),
        }
    }
}
