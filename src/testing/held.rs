use crate::check::{
    self, Acceptance, Case, Cases, CheckResult, Decision, FileKind, Files, Outcome, Page, RecordingIndex, Replacement,
    Severity, mismatch, pending_path,
};
use crate::picture::Format;
use crate::temporary::{self, TemporaryFolder};
use std::fmt::Write as _;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// Asserts that all recordings and pictures below the folder `path` are unchanged, as `rebond check` does: recordings
/// replay the same and match the scenes next to them, pictures are redrawn the same, and all files that manifests
/// (`*.check`) list exist.
///
/// ```no_run
/// #[test]
/// fn the_lecture_is_unchanged() {
///     rebond::testing::assert_folder("lecture");
/// }
/// ```
///
/// # Panics
/// If anything differs, is missing or cannot be checked, or if there is nothing to check. The message has one line per
/// case, and names the page that shows the differences.
#[track_caller]
pub fn assert_folder(path: impl AsRef<Path>) {
    pass(hold(path.as_ref(), Update::from_environment()));
}

/// Asserts that the recording at `path` replays the same and matches a run of the scene next to it (`NAME.toml` next to
/// `NAME.mcap`) or of the command in a manifest next to it. A recording that does not exist is made with
/// `REBOND_UPDATE=always`, or beside its place otherwise.
///
/// # Panics
/// As for [`assert_folder`].
#[track_caller]
pub fn assert_recording(path: impl AsRef<Path>) {
    pass(hold(path.as_ref(), Update::from_environment()));
}

/// Asserts that the picture at `path` is redrawn the same, by the command in a manifest next to it or else from its
/// provenance. Its recordings are searched in its folder.
///
/// # Panics
/// As for [`assert_folder`].
#[track_caller]
pub fn assert_picture(path: impl AsRef<Path>) {
    pass(hold(path.as_ref(), Update::from_environment()));
}

/// Asserts that `actual`, the file of a picture drawn by the test, is the same as the reference at `path`. Of PNG, GIF
/// and animated PNG, pixels, durations and provenance are compared; of SVG and PDF, bytes.
///
/// ```no_run
/// use rebond::{PictureOptions, Source, StillFormat, SubjectOptions, draw_to_vec};
///
/// let source = Source::open("lecture/cradle.mcap".as_ref())?;
/// let subject = SubjectOptions::State { step: 60.into(), format: StillFormat::Png };
/// let actual = draw_to_vec(&subject, &PictureOptions::default(), &[source])?;
/// rebond::testing::assert_same_picture("tests/cradle.png", &actual);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If they differ, or the reference does not exist. The message names the page that shows the difference.
#[track_caller]
pub fn assert_same_picture(path: impl AsRef<Path>, actual: &[u8]) {
    pass(hold_picture(path.as_ref(), actual, Update::from_environment()));
}

#[track_caller]
fn pass(result: Result<(), String>) {
    if let Err(message) = result {
        panic!("{message}");
    }
}

/// The fate of files that have changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Update {
    /// They are kept.
    No,
    /// They are kept, and their new content is written beside them.
    New,
    /// They are replaced.
    Always,
}

impl Update {
    /// The policy that `REBOND_UPDATE` and `CI` select. An unknown value is no policy, and a panic says so.
    fn from_environment() -> Update {
        match env::var("REBOND_UPDATE").ok().as_deref() {
            Some("no") => Update::No,
            Some("new") => Update::New,
            Some("always") => Update::Always,
            None | Some("" | "auto") => {
                let is_ci =
                    env::var_os("CI").is_some_and(|value| !value.is_empty() && value != "false" && value != "0");
                if is_ci { Update::No } else { Update::New }
            }
            Some(other) => panic!("REBOND_UPDATE cannot be {other:?}; it accepts no, new, always and auto"),
        }
    }
}

/// Checks a file or a folder.
///
/// # Errors
/// The message of the failed assertion.
pub fn hold(path: &Path, update: Update) -> Result<(), String> {
    let files = Files::find(&[path.to_owned()]);
    let found = find_cases(&files);
    if found.is_empty() {
        return Err(format!("there is nothing to check in {}", path.display()));
    }
    let cases: Vec<Case> = found.iter().collect();
    let mut index = RecordingIndex::default();
    index.add(files.recordings().map(PathBuf::as_path));
    let acceptance = Acceptance::new(&files, &found);
    let mut session = Session::new(path, update)?;
    let first_picture = cases.iter().take_while(|case| !matches!(case, Case::Picture(_))).count();
    for cases in [&cases[..first_picture], &cases[first_picture..]] {
        let threads = env::var("REBOND_JOBS").ok().and_then(|jobs| jobs.parse().ok()).unwrap_or(NonZero::<usize>::MIN);
        let check = |case: &Case| check::check_case(case, &index);
        check::check_cases(cases, check, threads, |result| session.handle(&result, acceptance.replacement(&result)))?;
        if update == Update::Always {
            index.add(files.recordings().map(PathBuf::as_path));
        }
    }
    session.finish()
}

/// Compares a picture with its reference.
///
/// # Errors
/// The message of the failed assertion.
pub fn hold_picture(path: &Path, actual: &[u8], update: Update) -> Result<(), String> {
    let Some(format) = Format::from_content(actual) else {
        return Err(format!("{}: the picture to compare is neither PNG, GIF, SVG nor PDF", path.display()));
    };
    let outcome = match fs::read(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Outcome::Missing("the picture does not exist".into()),
        Err(error) => Outcome::Failed(format!("it cannot be read: {error}")),
        Ok(expected) => match mismatch(format, &expected, actual) {
            Ok(None) => Outcome::Identical,
            Ok(Some(mismatch)) => Outcome::Differs(Box::new(mismatch)),
            Err(error) => Outcome::Failed(error.to_string()),
        },
    };
    let is_same = outcome.severity() == Severity::Same;
    let replacement = (!is_same).then(|| Replacement::Picture(actual.to_owned()));
    let result = CheckResult { replacement, ..CheckResult::new(path.into(), outcome) };
    let files = Files::find(&[path.to_owned()]);
    let acceptance = Acceptance::new(&files, &Cases::default());
    let mut session = Session::new(path, update)?;
    session.handle(&result, acceptance.replacement(&result))?;
    session.finish()
}

#[cfg(feature = "cli")]
fn find_cases(files: &Files) -> Cases {
    Cases::find(files, crate::cli::read_manifest)
}

/// Manifests contain commands, which the feature `cli` reads.
#[cfg(not(feature = "cli"))]
fn find_cases(files: &Files) -> Cases {
    Cases::find(files, |path: &Path| {
        let reason = "manifests are read by rebond with its feature cli".into();
        Err(check::Problem { path: path.into(), line: None, reason, is_missing: false })
    })
}

/// The state of an assertion.
struct Session {
    update: Update,
    page: Page,
    lines: String,
    failed: usize,
    pending: usize,
}

impl Session {
    fn new(path: &Path, update: Update) -> Result<Session, String> {
        let folder = report_folder(path);
        let page = Page::new(&folder).map_err(|error| format!("cannot write {}: {error}", folder.display()))?;
        Ok(Session { update, page, lines: String::new(), failed: 0, pending: 0 })
    }

    fn handle(
        &mut self,
        result: &CheckResult,
        replacement: Result<Option<&Replacement>, String>,
    ) -> Result<(), String> {
        if result.outcome.severity() == Severity::Same {
            return Ok(());
        }
        let unwritable = |error| format!("cannot write beside {}: {error}", result.path.display());
        let mut note = String::new();
        match (&replacement, self.update) {
            (Ok(Some(replacement)), Update::Always) => {
                put(replacement, &result.path).map_err(unwritable)?;
                return Ok(());
            }
            (Ok(Some(replacement)), Update::New) => {
                let pending = pending_path(&result.path);
                put(replacement, &pending).map_err(unwritable)?;
                self.pending += 1;
                note = format!("; its new content is in {}", pending.display());
            }
            (Err(reason), _) => note = format!("; it cannot be replaced: {reason}"),
            (Ok(_), _) => {}
        }
        let shown = self.page.add(result, &Decision::NothingToAccept).map_err(unwritable)?;
        let _ = write!(self.lines, "\n  {}: {}{note}", result.path.display(), result.outcome);
        if let (Some(picture), FileKind::Picture) = (shown.first(), result.kind()) {
            let _ = write!(self.lines, "; see {}", picture.display());
        }
        self.failed += 1;
        Ok(())
    }

    fn finish(self) -> Result<(), String> {
        let Session { page, lines, failed, pending, .. } = self;
        let index = page.finish("the last failed assertion").map_err(|error| error.to_string())?;
        if failed == 0 {
            return Ok(());
        }
        let mut message = format!("{} not the same:{lines}", crate::text::counted(failed as u64, "file"));
        if let Some(index) = index {
            let _ = write!(message, "\nDifferences: {}", index.display());
        }
        if pending > 0 {
            message += "\nAccept or reject the new contents: rebond check --review PATH, or run the test with \
                        REBOND_UPDATE=always";
        }
        Err(message)
    }
}

/// Writes new content to `place`, at once.
fn put(replacement: &Replacement, place: &Path) -> io::Result<()> {
    let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let staging = TemporaryFolder::create(folder)?;
    let staged = staging.path().join("content");
    match replacement {
        Replacement::Picture(content) => fs::write(&staged, content)?,
        Replacement::Recording(recording) => fs::copy(recording.path(), &staged).map(drop)?,
        Replacement::Run(reference) => {
            let made = check::make_recording(reference).map_err(io::Error::other)?;
            made.iter().try_for_each(|new| fs::copy(new.path(), &staged).map(drop))?;
        }
    }
    fs::rename(&staged, place)
}

/// The folder of the page: in the target folder of the test that runs, or in the folder for temporary files. Each path
/// has its own.
fn report_folder(path: &Path) -> PathBuf {
    let executable = env::current_exe().unwrap_or_default();
    let in_target =
        executable.parent().filter(|folder| folder.ends_with("deps")).and_then(|deps| deps.ancestors().nth(2));
    let folder = in_target.map_or_else(temporary::system_folder, Path::to_owned);
    let absolute = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let is_plain = |character: char| character.is_ascii_alphanumeric();
    let name: String = absolute
        .display()
        .to_string()
        .chars()
        .map(|character| if is_plain(character) { character } else { '-' })
        .collect();
    let start = name.char_indices().rev().nth(80).map_or(0, |(at, _)| at);
    folder.join("rebond-check").join(name[start..].trim_matches('-'))
}
