mod manifest;
mod report;

use super::arguments::CheckOptions;
use super::error::CommandError;
use super::{Exit, jobs, output, progress};
use crate::check::{self, Case, CheckResult, Page, Replacement, Severity};
use report::{CheckSummary, json, line};
use std::fs::File;
use std::io;
use std::path::Path;

/// Checks that recordings and pictures are unchanged.
pub fn run(options: &CheckOptions) -> Result<Exit, CommandError> {
    let mut cases = check::find(&options.paths, manifest::read)?;
    let range = options.shard.range(cases.len());
    cases = cases.drain(range).collect();
    let unwritable = CommandError::unwritable(&options.report);
    let page = Page::new(&options.report).map_err(&unwritable)?;
    let mut session = Session { options, page, summary: CheckSummary::default(), worst: Severity::Same };
    // All recordings are checked, and changes to them accepted, before pictures are drawn from them.
    let recordings = cases.iter().take_while(|case| matches!(case, Case::Recording { .. })).count();
    let (recordings, pictures) = cases.split_at(recordings);
    let bar = progress::bar("checking", cases.len() as u64);
    for cases in [recordings, pictures] {
        check::check_cases(cases, jobs::thread_count(options.jobs), |result| {
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
        output::print(summary.as_bytes())?;
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
            return output::print(json(&result, &files, is_accepted).as_bytes());
        }
        if output::is_quiet() && result.outcome.severity() == Severity::Same {
            return Ok(());
        }
        output::print(line(&result, is_accepted).as_bytes())
    }
}

/// Replaces the file at `path`.
fn accept(path: &Path, replacement: &Replacement) -> Result<(), CommandError> {
    let unwritable = CommandError::unwritable(path);
    output::write_file(path, true, |file| match replacement {
        Replacement::Picture(content) => file.write_all(content).map_err(&unwritable),
        Replacement::Recording(temp_path) => {
            let mut recording = File::open(temp_path).map_err(&unwritable)?;
            io::copy(&mut recording, file).map(drop).map_err(&unwritable)
        }
    })
}
