mod manifest;
mod tale;

use super::arguments::CheckOptions;
use super::error::CommandError;
use super::{Exit, jobs, output, progress};
use crate::check::{self, Case, Finding, Fresh, Grade, Page};
use std::fs::File;
use std::io;
use std::path::Path;
use tale::{Tally, json, line};

/// Holds recordings and pictures to what they were.
pub fn run(options: &CheckOptions) -> Result<Exit, CommandError> {
    let mut cases = check::find(&options.paths, manifest::read)?;
    let own = options.shard.range(cases.len());
    cases = cases.drain(own).collect();
    let unwritable = CommandError::unwritable(&options.report);
    let page = Page::new(&options.report).map_err(&unwritable)?;
    let mut examination = Examination { options, page, tally: Tally::default(), worst: Grade::Same };
    // Pictures are drawn of recordings as they were accepted.
    let recordings = cases.iter().take_while(|case| matches!(case, Case::Recording { .. })).count();
    let (recordings, pictures) = cases.split_at(recordings);
    let bar = progress::bar("checking", cases.len() as u64);
    for cases in [recordings, pictures] {
        check::examine(cases, jobs::threads(options.jobs), |finding| {
            let told = bar.suspend(|| examination.hear(finding));
            bar.inc(1);
            told
        })?;
    }
    bar.finish_and_clear();
    let Examination { page, tally, worst, .. } = examination;
    let shown = page.finish(&tally.to_string()).map_err(&unwritable)?;
    let summary = match shown {
        Some(index) => format!("{tally}; look at {}{}\n", index.display(), tally.advice()),
        None => format!("{tally}\n"),
    };
    if options.json {
        output::note(format_args!("{}", summary.trim_end()));
    } else {
        output::print(summary.as_bytes())?;
    }
    Ok(match worst {
        Grade::Same => Exit::Done,
        Grade::Different => Exit::Diverged,
        Grade::Damaged => Exit::Damaged,
        Grade::Failed => Exit::Error,
    })
}

/// A check that is under way.
struct Examination<'a> {
    options: &'a CheckOptions,
    page: Page,
    tally: Tally,
    worst: Grade,
}

impl Examination<'_> {
    /// Tells of a finding, shows it and, if that is wished, accepts it.
    fn hear(&mut self, finding: Finding) -> Result<(), CommandError> {
        let shown = self.page.add(&finding).map_err(CommandError::unwritable(&self.options.report))?;
        let is_accepted = match &finding.fresh {
            Some(fresh) if self.options.update => accept(&finding.path, fresh).map(|()| true)?,
            Some(_) | None => false,
        };
        self.tally.count(&finding, is_accepted);
        let grade = if is_accepted { Grade::Same } else { finding.outcome.grade() };
        self.worst = self.worst.max(grade);
        if self.options.json {
            return output::print(json(&finding, &shown, is_accepted).as_bytes());
        }
        if output::is_quiet() && finding.outcome.grade() == Grade::Same {
            return Ok(());
        }
        output::print(line(&finding, is_accepted).as_bytes())
    }
}

fn accept(path: &Path, fresh: &Fresh) -> Result<(), CommandError> {
    let unwritable = CommandError::unwritable(path);
    output::write_file(path, true, |file| match fresh {
        Fresh::Picture(content) => file.write_all(content).map_err(&unwritable),
        Fresh::Recording(place) => {
            let mut recording = File::open(place).map_err(&unwritable)?;
            io::copy(&mut recording, file).map(drop).map_err(&unwritable)
        }
    })
}
