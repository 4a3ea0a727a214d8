use super::error_report::ErrorReport;
use super::output_file::is_busy;
use super::{Exit, arguments::is_standard_output};
use crate::{
    picture::{self, RenderError},
    picture_options::ReversedRange,
    recording::{self, error_text},
    replay::RunError,
    scene::SceneError,
    text::{counted, steps_up_to},
};
use miette::{Diagnostic, MietteHandlerOpts};
use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

/// The error of a command.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum CommandError {
    /// The scene is invalid.
    #[error(transparent)]
    Scene(Box<SceneError>),
    /// The run could not be recorded.
    #[error(transparent)]
    Run(RunError),
    /// A recording cannot be read.
    #[error("{}: {source}", path.display())]
    Recording {
        /// The recording.
        path: PathBuf,
        /// The cause.
        source: recording::Error,
    },
    /// A scene was given in place of a recording.
    #[error("{} is a scene, not a recording; record it first: rebond record {} -o {}", path.display(), path.display(), path.with_extension("mcap").display())]
    SceneAsRecording {
        /// The scene.
        path: PathBuf,
    },
    /// A scene that is read several times comes from a pipe or a device.
    #[error(
        "report reads each scene several times, and {} is not a regular file; save the scene to a file first",
        path.display()
    )]
    SceneReadOnce {
        /// The scene.
        path: PathBuf,
    },
    /// The scene and its events are both to be read from standard input.
    #[error("the scene and the events cannot both come from standard input; write one of them to a file")]
    TwoFromStandardInput,
    /// The values of `--set` cannot be combined.
    #[error("{0}")]
    Set(String),
    /// `--set` is given, but no scene.
    #[error(
        "--set changes scenes, and {} is a recording; give the scene that it was made from",
        path.display()
    )]
    SetOfRecordings {
        /// The first source.
        path: PathBuf,
    },
    /// The process that checks cannot be watched, or was ended outside of a case.
    #[error("{0}")]
    Supervisor(io::Error),
    /// A temporary folder cannot be created; the error names its place and what to do.
    #[error("{0}")]
    TemporaryFiles(io::Error),
    /// The page of differences cannot be written.
    #[error(
        "cannot write the page of differences to {}: {source}; choose another folder with --report",
        folder.display()
    )]
    Page {
        /// The folder of the page.
        folder: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A folder has no recordings.
    #[error("the folder {} has no recordings (*.mcap)", .0.display())]
    NoRecordings(PathBuf),
    /// `--skip-existing` found the recording of another run.
    #[error(
        "{} is not the recording of this run: {difference}; choose another name, or record it again with --force",
        path.display()
    )]
    OtherRun {
        /// The existing recording.
        path: PathBuf,
        /// A description of the difference.
        difference: String,
    },
    /// The states of another program cannot be read.
    #[error("{}: {source}", path.display())]
    StatesTable {
        /// The table.
        path: PathBuf,
        /// The cause.
        source: super::states_table::TableError,
    },
    /// The table and the recording have no step in common.
    #[error("{} has no rows for the compared steps; the recording has {}", path.display(), steps_up_to(*last))]
    NoCommonSteps {
        /// The table.
        path: PathBuf,
        /// The last step of the recording.
        last: u64,
    },
    /// The recording that states are to be compared with does not replay the same itself.
    #[error("{} cannot be compared with: it does not replay the same: {verdict}", path.display())]
    NoReference {
        /// The recording.
        path: PathBuf,
        /// The verdict on it.
        verdict: Box<crate::replay::Verdict>,
    },
    /// A recording cannot be opened; the error names it.
    #[error(transparent)]
    RecordingFile(recording::Error),
    /// A frame cannot be rasterised, encoded or decoded.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A result cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    #[diagnostic(help("check that the folder exists, is writable and has free space, or choose another path"))]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// Writing a recording failed after its file had appeared.
    #[error(
        "cannot write {}: {source}; it is unfinished and has {}",
        path.display(),
        steps_up_to(*last)
    )]
    #[diagnostic(help(
        "free some space and make a recording of these steps with rebond recover, or record again with --force"
    ))]
    CutRecording {
        /// The recording.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
        /// The last step that can be read.
        last: u64,
    },
    /// A run failed after its recording had appeared, for example because a line of events is invalid.
    #[error("{source}{}", unfinished_recording(path, *last))]
    UnfinishedRun {
        /// The recording.
        path: PathBuf,
        /// The cause.
        source: Box<CommandError>,
        /// The last step that can be read.
        last: u64,
    },
    /// Standard output cannot be written.
    #[error("cannot write to standard output: {0}")]
    #[diagnostic(help("free some space on its disk, or redirect it to another one"))]
    StandardOutput(#[source] io::Error),
    /// The reader of standard output or of a named pipe has closed it. It needs no more, so nothing is printed.
    #[error("the reader of {} has closed it", .0.display())]
    ReaderClosed(PathBuf),
    /// The output file already exists.
    #[error("{} already exists; choose another name, or overwrite it with --force", .0.display())]
    Exists(PathBuf),
    /// The output is a folder.
    #[error("cannot write {}: it is a folder; name a file in it", .0.display())]
    IsFolder(PathBuf),
    /// A file of an output folder would replace something else than a file.
    #[error("cannot replace {}: it is {kind}; remove it, or choose another folder", path.display())]
    Irreplaceable {
        /// The place of the file.
        path: PathBuf,
        /// The kind of the file, with its article.
        kind: &'static str,
    },
    /// The output must be a folder and is a file.
    #[error("cannot write files into {}: it is not a folder; choose another name", .0.display())]
    IsNoFolder(PathBuf),
    /// The output is one of the inputs.
    #[error("cannot write {}: the command reads this file; choose another name", .0.display())]
    IsInput(PathBuf),
    /// Another process is recording to the output.
    #[error("cannot write {}: another process is recording to it; wait for its end, or choose another name", .0.display())]
    Busy(PathBuf),
    /// No case to check was found.
    #[error(
        "nothing to check in {}: expected recordings (*.mcap), scenes, manifests (*.check) or pictures drawn by rebond",
        paths.join(", ")
    )]
    NothingToCheck {
        /// The files and folders searched.
        paths: Vec<String>,
    },
    /// A picture cannot be drawn or read.
    #[error(transparent)]
    Picture(picture::Error),
    /// A picture has no provenance, or an invalid one.
    #[error("{}: {source}", path.display())]
    NoProvenance {
        /// The picture.
        path: PathBuf,
        /// The cause.
        source: Box<picture::Error>,
    },
    /// A family of scenes does not exist.
    #[error("unknown family of scenes {name:?}; known families: {known}")]
    UnknownFamily {
        /// The requested name.
        name: String,
        /// The names of all families.
        known: String,
    },
    /// The process that measures the cost of a run failed.
    #[error("cannot measure the cost of {scene:?}: {reason}")]
    CostNotMeasured {
        /// The name of the scene.
        scene: String,
        /// The messages of the process, or its exit status.
        reason: String,
    },
    /// A file given with `--read` is not a report.
    #[error("{} is not a report written by rebond report --json: {source}", path.display())]
    NotAReport {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: serde_json::Error,
    },
    /// ffmpeg cannot be started.
    #[error(
        "cannot write {}: ffmpeg cannot be run ({source}); install it (https://ffmpeg.org), or write a .gif or .apng \
         file instead",
        path.display()
    )]
    NoFfmpeg {
        /// The video.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// ffmpeg failed.
    #[error("cannot write {}: ffmpeg failed: {message}", path.display())]
    Ffmpeg {
        /// The video.
        path: PathBuf,
        /// The messages of ffmpeg, or its exit status.
        message: String,
    },
    /// ffmpeg closed its standard input.
    #[error("cannot write to ffmpeg: {0}")]
    Pipe(#[source] io::Error),
    /// The command does not support an output of this name.
    #[error("cannot write {}: {expected}{}", path.display(), lower_case(path))]
    UnsupportedOutput {
        /// The output.
        path: PathBuf,
        /// The supported names.
        expected: &'static str,
    },
    /// A clip would be very long.
    #[error(
        "the clip would have {} and last {seconds:.0} s; {cures}",
        counted(*frames, "frame")
    )]
    LongClip {
        /// The number of frames.
        frames: u64,
        /// Its duration, s.
        seconds: f64,
        /// Advice that brings it within the limits.
        cures: String,
    },
    /// A clip is longer than any clip may be.
    #[error(
        "the clip would have {} and last {seconds:.0} s, and no clip may have more than {max_frames} frames or \
         {max_seconds:.0} s; {cures}",
        counted(*frames, "frame")
    )]
    TooLongClip {
        /// The number of frames.
        frames: u64,
        /// Its duration, s.
        seconds: f64,
        /// The largest number of frames.
        max_frames: u64,
        /// The longest duration, s.
        max_seconds: f64,
        /// Advice that brings it within the limits.
        cures: String,
    },
    /// A range ends before it starts.
    #[error(transparent)]
    ReversedRange(#[from] ReversedRange),
    /// None of the states in a range is recorded in full.
    #[error(
        "{} has no full state {}: only those of every {every} steps are recorded in full",
        path.display(),
        recording::steps_in_words(*from, *to)
    )]
    NoFullState {
        /// The recording.
        path: PathBuf,
        /// The first step.
        from: u64,
        /// The last step.
        to: u64,
        /// The number of steps from one full state to the next.
        every: u64,
    },
    /// A part of a table of several sources was requested.
    #[error("--shard divides the table of one source; export each source on its own")]
    ShardOfSeveral,
    /// A scene that was just recorded did not replay the same.
    #[error("the scene did not replay the same; this is a bug in rebond, please report it with the scene")]
    NotReproducible,
    /// The engine failed in a step. The recording ends with the same error.
    #[error("{}; {} has {}", error_text(error), path.display(), steps_up_to(error.step()))]
    Step {
        /// The recording.
        path: PathBuf,
        /// The error of the engine.
        error: crate::physics::StepError,
    },
}

impl CommandError {
    /// Returns a function that converts an error of reading or writing the recording at `path`.
    pub fn in_recording(path: &Path) -> impl Fn(recording::Error) -> CommandError {
        move |source| CommandError::recording(path, source)
    }

    /// Converts an error of reading or writing the recording at `path`, so that the message names the path once.
    fn recording(path: &Path, source: recording::Error) -> CommandError {
        match source {
            recording::Error::Open { path, source } => CommandError::Unreadable { path, source },
            recording::Error::NotARegularFile { .. } => CommandError::RecordingFile(source),
            recording::Error::NotARecording { .. } if path.extension().is_some_and(|extension| extension == "toml") => {
                CommandError::SceneAsRecording { path: path.into() }
            }
            recording::Error::Write(source) => CommandError::unwritable(path)(source),
            source => CommandError::Recording { path: path.into(), source },
        }
    }

    /// Returns a function that converts an error of writing to `path`, which may be standard output.
    pub fn unwritable(path: &Path) -> impl Fn(io::Error) -> CommandError {
        move |source| match source.kind() {
            io::ErrorKind::BrokenPipe => CommandError::ReaderClosed(path.into()),
            io::ErrorKind::AlreadyExists if source.get_ref().is_none() => CommandError::Exists(path.into()),
            _ if is_busy(&source) => CommandError::Busy(path.into()),
            _ if is_standard_output(path) => CommandError::StandardOutput(source),
            _ => CommandError::Unwritable { path: path.into(), source },
        }
    }

    /// Returns a function that converts an error of reading the file at `path`.
    pub fn unreadable(path: &Path) -> impl Fn(io::Error) -> CommandError {
        move |source| CommandError::Unreadable { path: path.into(), source }
    }
}

impl From<SceneError> for CommandError {
    fn from(error: SceneError) -> CommandError {
        CommandError::Scene(Box::new(error))
    }
}

impl From<RunError> for CommandError {
    fn from(error: RunError) -> CommandError {
        match error {
            RunError::Scene(error) => error.into(),
            error => CommandError::Run(error),
        }
    }
}

impl From<picture::Error> for CommandError {
    fn from(error: picture::Error) -> CommandError {
        match error {
            picture::Error::Recording { path, source } => CommandError::recording(&path, source),
            picture::Error::Scene(error) => error.into(),
            error => CommandError::Picture(error),
        }
    }
}

/// The reason why a known extension in capital letters is not recognised.
fn lower_case(path: &Path) -> &'static str {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if extension.chars().any(char::is_uppercase) { "; write the extension in lower case" } else { "" }
}

/// Prints an error on standard error and returns the exit code. A failure to print is ignored.
///
/// Messages contain their causes, so these are not listed again. Lines are not wrapped, so that scripts can search
/// them.
pub fn report(error: CommandError) -> Exit {
    if let CommandError::ReaderClosed(_) = error {
        return Exit::Done;
    }
    let handler = || MietteHandlerOpts::new().without_cause_chain().wrap_lines(false).build();
    let _ = miette::set_hook(Box::new(move |_| Box::new(handler()))); // Fails only if set before.
    for report in reports(&error) {
        let _ = writeln!(io::stderr(), "{:?}", miette::Report::new(report));
    }
    match error {
        CommandError::UnsupportedOutput { .. } | CommandError::ShardOfSeveral => Exit::Usage,
        CommandError::Picture(picture::Error::Misused { .. }) => Exit::Usage,
        CommandError::NotReproducible | CommandError::Picture(picture::Error::Diverged { .. }) => Exit::Diverged,
        CommandError::NoReference { verdict, .. } if verdict.health().is_some() => Exit::Damaged,
        CommandError::NoReference { .. } => Exit::Diverged,
        CommandError::Recording { source, .. } if source.is_damage() => Exit::Damaged,
        CommandError::Picture(
            picture::Error::NothingReadable { .. } | picture::Error::Render(RenderError::PictureCount { .. }),
        ) => Exit::Damaged,
        _ => Exit::Error,
    }
}

/// The reports of an error; the first one describes the state of the recording.
fn reports(error: &CommandError) -> Vec<ErrorReport> {
    match error {
        CommandError::Scene(error) => ErrorReport::of_scene(error),
        CommandError::UnfinishedRun { path, source, last } => {
            let mut reports = reports(source);
            reports[0].append(&unfinished_recording(path, *last));
            reports
        }
        error => vec![ErrorReport::new(error, error.help().as_deref())],
    }
}

/// Says which steps an unfinished recording has.
fn unfinished_recording(path: &Path, last: u64) -> String {
    format!("; {} is unfinished and has {}", path.display(), steps_up_to(last))
}
