use super::arguments::CheckOptions;
use super::error::CommandError;
use super::output_file::{OutputFile, Overwrite};
use super::replay::difference_json;
use super::{Exit, manifest, output};
use crate::check::{self, Case, CheckResult, Files, Outcome, Page, Replacement, SceneMismatch, Severity};
use crate::picture::Format;
use crate::text::counted;
use std::fmt::{self, Display, Formatter};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// Checks that recordings and pictures are unchanged.
pub fn run(options: &CheckOptions) -> Result<Exit, CommandError> {
    let files = Files::find(&options.paths)?;
    let mut listed = Vec::new();
    for path in files.manifests() {
        listed.extend(manifest::read(path)?);
    }
    let mut cases = files.cases(listed)?;
    let range = options.shard.range(cases.len());
    cases = cases.drain(range).collect();
    let unwritable = CommandError::unwritable(&options.report);
    let page = Page::new(&options.report).map_err(&unwritable)?;
    let mut session = Session { options, page, summary: CheckSummary::default(), worst: Severity::Same };
    // All recordings are checked, and changes to them accepted, before pictures are drawn from them.
    let recordings = cases.iter().take_while(|case| matches!(case, Case::Recording { .. })).count();
    let (recordings, pictures) = cases.split_at(recordings);
    let bar = output::progress_bar("checking", cases.len() as u64);
    for cases in [recordings, pictures] {
        check::check_cases(cases, options.jobs.threads(), |result| {
            let handled = bar.suspend(|| session.handle(result));
            bar.inc(1);
            handled
        })?;
    }
    bar.finish_and_clear();
    let Session { page, summary, worst, .. } = session;
    let index = page.finish(&summary.to_string()).map_err(&unwritable)?;
    let summary = match index {
        Some(index) => format!("{summary}; see {}{}\n", index.display(), summary.advice()),
        None => format!("{summary}\n"),
    };
    if options.json {
        output::info(format_args!("{}", summary.trim_end()));
    } else {
        output::print(&summary)?;
    }
    Ok(match worst {
        Severity::Same => Exit::Done,
        Severity::Different => Exit::Diverged,
        Severity::Damaged => Exit::Damaged,
        Severity::Failed => Exit::Error,
    })
}

/// The state of a check in progress.
struct Session<'a> {
    options: &'a CheckOptions,
    page: Page,
    summary: CheckSummary,
    worst: Severity,
}

impl Session<'_> {
    /// Prints a result, adds it to the page and, with `--update`, accepts it.
    fn handle(&mut self, result: CheckResult) -> Result<(), CommandError> {
        let files = self.page.add(&result).map_err(CommandError::unwritable(&self.options.report))?;
        let is_accepted = match &result.replacement {
            Some(replacement) if self.options.update => accept(&result.path, replacement).map(|()| true)?,
            Some(_) | None => false,
        };
        self.summary.count(&result, is_accepted);
        let severity = if is_accepted { Severity::Same } else { result.outcome.severity() };
        self.worst = self.worst.max(severity);
        if self.options.json {
            return output::print(&json(&result, &files, is_accepted));
        }
        if output::is_quiet() && result.outcome.severity() == Severity::Same {
            return Ok(());
        }
        output::print(&line(&result, is_accepted))
    }
}

/// Replaces the file at `path`.
fn accept(path: &Path, replacement: &Replacement) -> Result<(), CommandError> {
    let unwritable = CommandError::unwritable(path);
    OutputFile::create(path, Overwrite::Allowed, &[])?.write(|file| match replacement {
        Replacement::Picture(content) => file.write_all(content).map_err(&unwritable),
        Replacement::Recording(recording) => {
            let mut content = File::open(recording.path()).map_err(&unwritable)?;
            io::copy(&mut content, file).map(drop).map_err(&unwritable)
        }
    })
}

/// The line of text about a result.
fn line(result: &CheckResult, is_accepted: bool) -> String {
    let accepted = if is_accepted { "; accepted" } else { "" };
    format!("{}: {}{accepted}\n", result.path.display(), result.outcome)
}

/// The line of JSON about a result.
fn json(result: &CheckResult, shown: &[PathBuf], is_accepted: bool) -> String {
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
        Outcome::Diverged(divergence) => Some(difference_json(divergence.step, &divergence.difference)),
        Outcome::Drifted(SceneMismatch::State { step, difference: found }) => Some(difference_json(*step, found)),
        Outcome::Drifted(_) | Outcome::Replayed { .. } | Outcome::OtherSemantics { .. } | Outcome::Damaged(_) => None,
        Outcome::Identical | Outcome::Differs(_) | Outcome::Missing | Outcome::Orphaned { .. } => None,
        Outcome::Unrenderable { .. } | Outcome::Failed(_) => None,
    }
}

/// The number of cases checked, by kind and outcome.
#[derive(Debug, Default)]
struct CheckSummary {
    recordings: u64,
    pictures: u64,
    failed: u64,
    accepted: u64,
    /// True if `--update` would accept a change.
    has_acceptable: bool,
}

impl CheckSummary {
    /// Counts one result.
    fn count(&mut self, result: &CheckResult, is_accepted: bool) {
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
    const fn advice(&self) -> &'static str {
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
