//! What was found, for people and for scripts.

use crate::check::{Drift, Finding, Fresh, Grade, Outcome};
use crate::cli::json::difference;
use crate::illustration::Format;
use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

/// One line for people.
pub fn line(finding: &Finding, is_accepted: bool) -> String {
    let accepted = if is_accepted { "; accepted" } else { "" };
    format!("{}: {}{accepted}\n", finding.path.display(), finding.outcome)
}

/// One line for scripts: an object for each case.
pub fn json(finding: &Finding, shown: &[PathBuf], is_accepted: bool) -> String {
    let outcome = &finding.outcome;
    let shown: Vec<String> = shown.iter().map(|path| path.display().to_string()).collect();
    let object = serde_json::json!({
        "path": finding.path.display().to_string(),
        "outcome": outcome.word(),
        "what": outcome.to_string(),
        "divergence": divergence(outcome),
        "accepted": is_accepted,
        "shown": shown,
    });
    format!("{object}\n")
}

/// The first number that differs, if one does.
fn divergence(outcome: &Outcome) -> Option<serde_json::Value> {
    match outcome {
        Outcome::Diverged(divergence) => Some(difference(divergence.step, &divergence.difference)),
        Outcome::Drifted(Drift::State { step, difference: found }) => Some(difference(*step, found)),
        Outcome::Drifted(_) | Outcome::Replayed { .. } | Outcome::OtherSemantics { .. } | Outcome::Damaged(_) => None,
        Outcome::Drawn | Outcome::Differs(_) | Outcome::Missing | Outcome::Orphaned { .. } => None,
        Outcome::Undrawn { .. } | Outcome::Failed(_) => None,
    }
}

/// How many of each kind there were, and how they are.
#[derive(Debug, Default)]
pub struct Tally {
    recordings: u64,
    pictures: u64,
    bad: u64,
    accepted: u64,
    /// Whether there is something that --update would accept.
    acceptable: bool,
}

impl Tally {
    /// Counts one more.
    pub fn count(&mut self, finding: &Finding, is_accepted: bool) {
        let is_recording = match &finding.fresh {
            Some(Fresh::Recording(_)) => true,
            Some(Fresh::Picture(_)) => false,
            None => Format::of_name(&finding.path).is_none(),
        };
        let kind = if is_recording { &mut self.recordings } else { &mut self.pictures };
        *kind += 1;
        let is_bad = finding.outcome.grade() != Grade::Same;
        self.accepted += u64::from(is_bad && is_accepted);
        self.bad += u64::from(is_bad && !is_accepted);
        self.acceptable |= finding.fresh.is_some() && !is_accepted;
    }

    /// What to do about it.
    pub const fn advice(&self) -> &'static str {
        if self.acceptable { ", and accept what is meant with --update" } else { "" }
    }
}

/// The last line: the verdict on all.
impl Display for Tally {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let Tally { recordings, pictures, bad, accepted, .. } = self;
        match (bad, accepted) {
            (0, 0) => write!(out, "same: {recordings} recordings, {pictures} pictures"),
            (0, _) => write!(out, "accepted: {accepted} of {} changed", recordings + pictures),
            (_, 0) => write!(out, "not the same: {bad} of {}", recordings + pictures),
            (_, _) => write!(out, "not the same: {bad} of {}, {accepted} accepted", recordings + pictures),
        }
    }
}
