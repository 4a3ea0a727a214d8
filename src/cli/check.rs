use super::arguments::{CheckOptions, Shard};
use super::error::CommandError;
use super::github::{self, StepSummary};
use super::output_file::{OutputFile, Overwrite, RefuseInputs};
use super::replay::difference_json;
use super::review::{self, Answer, Review};
use super::supervisor::{self, Input, Journal};
use super::{Exit, manifest, output};
use crate::check::{
    self, Acceptance, Case, Cases, CheckResult, Decision, FileKind, Files, Outcome, Page, Recipe, RecordingIndex,
    Replacement, Severity,
};
use crate::junit::{TestCase, TestOutcome, TestSuite};
use crate::temporary::TemporaryRecording;
use crate::text::counted;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Display, Formatter};
use std::fs::{self, File};
use std::io::{self, Write};
use std::num::NonZero;
use std::path::{Path, PathBuf};

/// Checks that recordings and pictures are unchanged.
pub fn run(options: &CheckOptions) -> Result<Exit, CommandError> {
    let journal = match &options.journal {
        Some(path) => Journal::open(path).map_err(CommandError::unwritable(path))?,
        None => match supervise(options)? {
            Some(exit) => return Ok(exit),
            None => Journal::default(),
        },
    };
    if let Some(parent) = journal.parent {
        let input = if options.review { Input::Answers } else { Input::Lifeline };
        supervisor::end_with_parent(parent, input);
    }
    check(options, &journal)
}

/// Checks in child processes, if they can be started.
fn supervise(options: &CheckOptions) -> Result<Option<Exit>, CommandError> {
    let outputs = [Some(report_folder(options)), options.junit.clone()];
    let folder =
        |path: &PathBuf| path.ancestors().skip(1).find(|folder| folder.is_dir()).unwrap_or(Path::new(".")).to_owned();
    let folders: Vec<PathBuf> = outputs.iter().flatten().map(folder).collect();
    let input = if options.review { Input::Answers } else { Input::Lifeline };
    supervisor::supervise(&folders, input).map_err(CommandError::Supervisor)
}

fn check(options: &CheckOptions, journal: &Journal) -> Result<Exit, CommandError> {
    let files = Files::find(&options.paths);
    let found = Cases::find(&files, manifest::read);
    if found.is_empty() {
        let paths = options.paths.iter().map(|path| path.display().to_string()).collect();
        return Err(CommandError::NothingToCheck { paths });
    }
    let all: Vec<Case> = found.iter().collect();
    let cases = &all[options.shard.range(all.len())];
    let mut index = index_of(&files, cases, options, journal);
    let junit = options.junit.as_deref().map(|path| open_junit(path, &files, &all, options)).transpose()?;
    let mut review = options.review.then(|| Review::new(journal));
    if let Some(review) = &mut review {
        review.ask_about_pending(&files)?;
    }
    let folder = report_folder(options);
    let mut session = Session {
        options,
        journal,
        page: Page::new(&folder).map_err(unwritable_page(&folder))?,
        acceptance: Acceptance::new(&files, &found),
        commands: Commands { paths: &options.paths },
        summary: CheckSummary { skipped: found.skipped as u64, ..CheckSummary::default() },
        step_summary: StepSummary::default(),
        suite: TestSuite { name: "rebond check".into(), cases: Vec::new() },
        worst: Severity::Same,
        review,
        replaced: Vec::new(),
        foreign: Vec::new(),
    };
    // All recordings are checked, and changes to them accepted, before pictures are drawn from them.
    let first_picture = cases.iter().take_while(|case| !matches!(case, Case::Picture(_))).count();
    let (recordings, pictures) = cases.split_at(first_picture);
    session.check(recordings, &index)?;
    if !session.replaced.is_empty() {
        index.add(files.recordings().map(PathBuf::as_path).chain(session.replaced.iter().map(PathBuf::as_path)));
    }
    let followers = session.followers(pictures, &mut index);
    session.check(pictures, &index)?;
    session.check(&followers, &index)?;
    session.print_foreign()?;
    session.finish(&files, junit)
}

/// The index of the recordings, if a case may need it: one of a picture that names no files, or one that may be
/// replaced.
fn index_of(files: &Files, cases: &[Case], options: &CheckOptions, journal: &Journal) -> RecordingIndex {
    let mut index = RecordingIndex::default();
    let names_recordings =
        |case: &Case| matches!(case, Case::Picture(picture) if matches!(picture.recipe, Recipe::Embedded(_)));
    if options.update || options.review || cases.iter().any(names_recordings) {
        for recording in files.recordings() {
            // A recording that ends the process is one line of the result below.
            let _ = journal.watch(&supervisor::key(recording, None), || index.add([recording.as_path()]));
        }
    }
    index
}

/// Opens the JUnit report, or returns an error before any work is done if it cannot be written or is a file that is
/// checked or a manifest that is read.
fn open_junit(path: &Path, files: &Files, cases: &[Case], options: &CheckOptions) -> Result<OutputFile, CommandError> {
    let mut output = OutputFile::create(path, Overwrite::for_junit(path, options.force), &[])?;
    if path.is_file() {
        output.refuse_inputs(&files.manifests().cloned().collect::<Vec<_>>())?;
        cases.iter().try_for_each(|case| output.refuse_inputs(&case.inputs()))?;
    }
    Ok(output)
}

/// The folder of the page. Each shard has its own.
fn report_folder(options: &CheckOptions) -> PathBuf {
    let CheckOptions { report, shard, .. } = options;
    if *shard == Shard::WHOLE {
        return report.clone();
    }
    let mut name = report.components().collect::<PathBuf>().into_os_string();
    name.push(format!("-{}-of-{}", shard.number, shard.count));
    name.into()
}

/// Returns a function that converts an error of writing the page in `folder`.
fn unwritable_page(folder: &Path) -> impl Fn(io::Error) -> CommandError {
    move |source| CommandError::Page { folder: folder.into(), source }
}

/// The state of a check in progress.
struct Session<'a> {
    options: &'a CheckOptions,
    journal: &'a Journal,
    page: Page,
    acceptance: Acceptance<'a>,
    commands: Commands<'a>,
    summary: CheckSummary,
    step_summary: StepSummary,
    suite: TestSuite,
    worst: Severity,
    /// The review of changes one by one, if that was requested.
    review: Option<Review<'a>>,
    /// The recordings that were replaced.
    replaced: Vec<PathBuf>,
    /// The pictures of other programs.
    foreign: Vec<PathBuf>,
}

impl Session<'_> {
    fn check(&mut self, cases: &[Case], index: &RecordingIndex) -> Result<(), CommandError> {
        let bar = output::progress_bar("checking", cases.len() as u64);
        let journal = self.journal;
        let threads = if journal.is_alone { NonZero::<usize>::MIN } else { self.options.jobs.threads() };
        let check = |case: &Case| journal.check(case, || check::check_case(case, index));
        check::check_cases(cases, check, threads, |result| {
            let key = supervisor::key(&result.path, result.line.as_ref());
            let handled = bar.suspend(|| self.handle(&result, &key));
            bar.inc(1);
            handled
        })?;
        bar.finish_and_clear();
        Ok(())
    }

    /// Prints a result, adds it to the page and, with `--update`, accepts it.
    fn handle(&mut self, result: &CheckResult, key: &str) -> Result<(), CommandError> {
        let command = self.commands.accepting(result);
        let (acceptance, decision) = match self.acceptance.replacement(result) {
            Ok(None) => (None, Decision::NothingToAccept),
            Ok(Some(replacement)) => (Some(replacement), Decision::Acceptable(command)),
            Err(reason) => (None, Decision::Refused(reason)),
        };
        let files = self.page.add(result, &decision).map_err(unwritable_page(&report_folder(self.options)))?;
        let is_accepted = match (&acceptance, &mut self.review) {
            (Some(_), Some(review)) => {
                review.ask(&result.path, &result.outcome, files.first().map(|file| self.page.staged(file)))?
                    == Answer::Accept
            }
            (Some(_), None) => self.options.update,
            (None, _) => false,
        };
        let decision = match (acceptance, is_accepted) {
            (Some(replacement), true) => match accept(&result.path, replacement) {
                Ok(()) => Decision::Accepted,
                Err(error) => Decision::Refused(error.to_string()),
            },
            (Some(_) | None, _) => decision,
        };
        if matches!((&decision, result.kind()), (Decision::Accepted, FileKind::Recording)) {
            self.replaced.push(result.path.clone());
        }
        self.summary.count(result, &decision);
        if decision == Decision::Accepted {
            self.journal.accept(key);
        } else if self.journal.was_accepted(key) {
            self.summary.accepted += 1;
        }
        let severity = if decision == Decision::Accepted { Severity::Same } else { result.outcome.severity() };
        self.suite.cases.push(test_case(result, severity, &decision));
        self.worst = self.worst.max(severity);
        if self.options.github && severity != Severity::Same {
            self.step_summary.add(result, &decision);
        }
        if self.journal.is_first(key) { self.print(result, &files, &decision, severity) } else { Ok(()) }
    }

    /// Prints a result. Pictures of other programs are printed at the end, by folder.
    fn print(
        &mut self,
        result: &CheckResult,
        files: &[PathBuf],
        decision: &Decision,
        severity: Severity,
    ) -> Result<(), CommandError> {
        if self.options.github && severity != Severity::Same {
            let annotation = github::annotation(result);
            // Workflow commands are read from both streams.
            if self.options.json { output::print_to_stderr(&annotation) } else { output::print(&annotation)? }
        }
        if self.options.json {
            return output::print(&format!("{}\n", json(result, files, decision)));
        }
        if output::is_quiet() && result.outcome.severity() == Severity::Same {
            return Ok(());
        }
        if matches!(result.outcome, Outcome::Foreign) && !self.options.paths.contains(&result.path) {
            self.foreign.push(result.path.clone());
            return Ok(());
        }
        let note = match decision {
            Decision::Accepted => "; accepted".to_owned(),
            Decision::Refused(reason) if self.options.update => format!("; not accepted: {reason}"),
            Decision::NothingToAccept | Decision::Acceptable(_) | Decision::Refused(_) => String::new(),
        };
        output::print(&format!("{}: {}{note}\n", result.path.display(), result.outcome))
    }

    /// Prints one line about the pictures of other programs in each folder.
    fn print_foreign(&self) -> Result<(), CommandError> {
        let mut folders: BTreeMap<&Path, Vec<&Path>> = BTreeMap::new();
        for picture in &self.foreign {
            folders.entry(picture.parent().unwrap_or(picture)).or_default().push(picture);
        }
        folders.into_iter().try_for_each(|(folder, pictures)| match &pictures[..] {
            [picture] => output::print(&format!("{}: {}\n", picture.display(), Outcome::Foreign)),
            [..] => {
                let folder = if folder == Path::new("") { Path::new(".") } else { folder };
                let count = counted(pictures.len() as u64, "picture");
                output::print(&format!("{}: unchecked: {count} without rebond provenance\n", folder.display()))
            }
        })
    }

    /// Writes the reports and the summary, and returns the exit code of the worst result.
    fn finish(self, files: &Files, junit: Option<OutputFile>) -> Result<Exit, CommandError> {
        let Session { options, page, mut summary, step_summary, suite, worst, .. } = self;
        summary.pending = files.pending().count() as u64;
        if options.github {
            step_summary.write(&summary.to_string()).map_err(|error| {
                CommandError::unwritable(Path::new("the file that GITHUB_STEP_SUMMARY names"))(error)
            })?;
        }
        if let Some(file) = junit {
            file.write(|file| {
                write!(file, "{suite}")
                    .map_err(CommandError::unwritable(options.junit.as_deref().unwrap_or(Path::new(""))))
            })?;
        }
        let index = page.finish(&summary.to_string()).map_err(unwritable_page(&report_folder(options)))?;
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

    /// The pictures next to recordings that were replaced, which are drawn from them and were not to be checked. They
    /// would be orphaned.
    fn followers(&mut self, pictures: &[Case], index: &mut RecordingIndex) -> Vec<Case> {
        if self.replaced.is_empty() {
            return Vec::new();
        }
        let folder = |path: &PathBuf| path.parent().map_or(PathBuf::from("."), |folder| Path::new(".").join(folder));
        let folders: BTreeSet<PathBuf> =
            self.replaced.iter().map(folder).map(|folder| check::normalize(&folder)).collect();
        let folders: Vec<PathBuf> =
            folders.into_iter().map(|folder| if folder == Path::new("") { ".".into() } else { folder }).collect();
        let around = Files::find(&folders);
        let known: BTreeSet<PathBuf> = pictures.iter().map(|case| check::normalize(case.path())).collect();
        let replaced: BTreeSet<PathBuf> = self.replaced.iter().map(|path| check::normalize(path)).collect();
        let mut followers = Vec::new();
        for picture in Cases::find(&around, manifest::read).pictures {
            let is_drawn_from = picture.recordings(index).iter().any(|path| replaced.contains(&check::normalize(path)));
            if is_drawn_from && !known.contains(&check::normalize(&picture.file)) && around.encloses(&picture.file) {
                self.acceptance.follow(&picture.file);
                followers.push(Case::Picture(picture));
            }
        }
        followers
    }
}

/// The result as a case of a JUnit report: a difference is a failure, a case that cannot be checked an error.
fn test_case(result: &CheckResult, severity: Severity, decision: &Decision) -> TestCase {
    let path = result.path.display().to_string();
    let message = result.outcome.to_string();
    let advice = match decision {
        Decision::Acceptable(command) => format!("\nAccept: {command}"),
        Decision::Refused(reason) => format!("\nNot acceptable: {reason}"),
        Decision::Accepted | Decision::NothingToAccept => String::new(),
    };
    let outcome = match severity {
        Severity::Same => TestOutcome::Passed,
        Severity::Different | Severity::Damaged => {
            TestOutcome::Failed { details: format!("{path}: {message}{advice}"), message }
        }
        Severity::Failed => TestOutcome::Error { message },
    };
    TestCase { class: format!("rebond.{}", result.kind().name()), name: path, outcome }
}

/// Replaces the file at `path`, or makes it, and removes new content that a test has left beside it.
fn accept(path: &Path, replacement: &Replacement) -> Result<(), CommandError> {
    let unwritable = CommandError::unwritable(path);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(&unwritable)?;
    }
    let copy = |recording: &TemporaryRecording, file: &mut dyn Write| {
        let mut content = File::open(recording.path()).map_err(&unwritable)?;
        io::copy(&mut content, file).map(drop).map_err(&unwritable)
    };
    OutputFile::create(path, Overwrite::Allowed, &[])?.write(|file| match replacement {
        Replacement::Picture(content) => file.write_all(content).map_err(&unwritable),
        Replacement::Recording(recording) => copy(recording, file),
        Replacement::Run(reference) => check::make_recording(reference)?.iter().try_for_each(|new| copy(new, file)),
    })?;
    review::remove_pending(path)
}

/// The commands that accept one case each.
struct Commands<'a> {
    /// The paths to check.
    paths: &'a [PathBuf],
}

impl Commands<'_> {
    /// The command that accepts the change of a file alone: of the file, of its manifest if that is in another folder,
    /// or of all paths if its recordings are in another folder.
    fn accepting(&self, result: &CheckResult) -> String {
        let folder = |path: &Path| path.parent().map(Path::to_owned);
        let paths: Vec<&Path> = match &result.line {
            Some(line) if folder(&line.manifest) != folder(&result.path) => vec![&line.manifest],
            Some(_) => vec![&result.path],
            None if result.kind() == FileKind::Recording => vec![&result.path],
            None if self.paths.iter().any(|path| path.is_dir() && folder(&path.join("x")) == folder(&result.path)) => {
                vec![&result.path]
            }
            None => self.paths.iter().map(PathBuf::as_path).collect(),
        };
        let quoted = paths.into_iter().map(|path| {
            let path = path.display().to_string();
            let path = if path.starts_with('-') { format!("./{path}") } else { path };
            shlex::try_quote(&path).map_or(path.clone(), |quoted| quoted.into_owned())
        });
        format!("rebond check {} --update", quoted.collect::<Vec<String>>().join(" "))
    }
}

/// The version of the JSON objects. It is raised if a key is removed or changes its meaning.
const JSON_VERSION: u32 = 1;

/// The JSON object about a result. The guide has its schema.
fn json(result: &CheckResult, shown: &[PathBuf], decision: &Decision) -> Value {
    let outcome = &result.outcome;
    let text = |path: &Path| path.display().to_string();
    let causes: Vec<Value> = result
        .causes()
        .into_iter()
        .map(|cause| json!({ "name": cause.name, "recorded": cause.recorded, "current": cause.current }))
        .collect();
    let line = result.line.as_ref().map(|line| json!({ "path": text(&line.manifest), "line": line.number }));
    let (command, refusal) = match decision {
        Decision::Acceptable(command) => (Some(command), None),
        Decision::Refused(reason) => (None, Some(reason)),
        Decision::NothingToAccept | Decision::Accepted => (None, None),
    };
    json!({
        "version": JSON_VERSION,
        "path": text(&result.path),
        "kind": result.kind().name(),
        "outcome": outcome.word(),
        "severity": outcome.severity().name(),
        "what": outcome.to_string(),
        "causes": causes,
        "divergence": result.divergence().map(|(step, difference)| difference_json(step, difference)),
        "accepted": *decision == Decision::Accepted,
        "accept_command": command,
        "refusal": refusal,
        "manifest": line,
        "shown": shown.iter().map(|path| text(path)).collect::<Vec<String>>(),
    })
}

/// The number of cases checked, by kind and outcome.
#[derive(Debug, Default)]
struct CheckSummary {
    recordings: u64,
    pictures: u64,
    others: u64,
    failed: u64,
    accepted: u64,
    /// Pictures without provenance.
    foreign: u64,
    /// Scenes whose recordings are not kept.
    skipped: u64,
    /// Files with new content beside them, from failed assertions.
    pending: u64,
    /// True if `--update` would accept a change.
    has_acceptable: bool,
}

impl CheckSummary {
    /// Counts one result.
    fn count(&mut self, result: &CheckResult, decision: &Decision) {
        if matches!(result.outcome, Outcome::Foreign) {
            self.foreign += 1;
            return;
        }
        let kind = match result.kind() {
            FileKind::Recording => &mut self.recordings,
            FileKind::Picture => &mut self.pictures,
            FileKind::Other => &mut self.others,
        };
        *kind += 1;
        let is_failed = result.outcome.severity() != Severity::Same;
        let is_accepted = *decision == Decision::Accepted;
        self.accepted += u64::from(is_failed && is_accepted);
        self.failed += u64::from(is_failed && !is_accepted);
        self.has_acceptable |= matches!(decision, Decision::Acceptable(_));
    }

    /// A hint what to do next, if anything can be accepted.
    const fn advice(&self) -> &'static str {
        if self.has_acceptable { ", and accept intended changes with --update" } else { "" }
    }
}

/// Formats the verdict on all cases.
impl Display for CheckSummary {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let CheckSummary { recordings, pictures, others, failed, accepted, foreign, skipped, pending, .. } = self;
        let all = recordings + pictures + others;
        match (failed, accepted) {
            (0, 0) => write!(out, "same: {}, {}", counted(*recordings, "recording"), counted(*pictures, "picture"))?,
            (0, _) => write!(out, "accepted: {accepted} of {all} changed")?,
            (_, 0) => write!(out, "not the same: {failed} of {all}")?,
            (_, _) => write!(out, "not the same: {failed} of {all}, {accepted} accepted")?,
        }
        if *foreign > 0 {
            write!(out, "; unchecked: {} without provenance", counted(*foreign, "picture"))?;
        }
        if *skipped > 0 {
            write!(out, "; skipped: {}", counted(*skipped, "scene"))?;
        }
        if *pending > 0 {
            write!(out, "; pending: {}, see --review", counted(*pending, "file"))?;
        }
        Ok(())
    }
}
