use super::output_file::Busy;
use super::{Exit, arguments::is_standard_output, error_report::ErrorReport};
use crate::{
    picture::{self, RenderError},
    recording::{self, error_text},
    replay::RunError,
    scene::SceneError,
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
    /// Standard output cannot be written.
    #[error("cannot write to standard output: {0}")]
    #[diagnostic(help("free some space on its disk, or write to a file with -o instead"))]
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
    /// The output must be a folder and is a file.
    #[error("cannot write files into {}: it is not a folder; choose another name", .0.display())]
    IsNoFolder(PathBuf),
    /// The output is one of the inputs.
    #[error("cannot write {}: the command reads this file; choose another name", .0.display())]
    IsInput(PathBuf),
    /// Another process is recording to the output.
    #[error("cannot write {}: another process is recording to it; wait for its end, or choose another name", .0.display())]
    Busy(PathBuf),
    /// The check cannot start.
    #[error(transparent)]
    Check(#[from] crate::check::CheckError),
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
    #[error("cannot write {}: {expected}", path.display())]
    UnsupportedOutput {
        /// The output.
        path: PathBuf,
        /// The supported names.
        expected: &'static str,
    },
    /// A clip would be very long.
    #[error(
        "the clip would have {frames} frames and last {seconds:.0} s; draw a part with --from and --to, fewer frames with \
         --fps or --every, or allow it with --long"
    )]
    LongClip {
        /// The number of frames.
        frames: u64,
        /// Its duration, s.
        seconds: f64,
    },
    /// A part of a table of several sources was requested.
    #[error("--shard divides the table of one source; export each source on its own")]
    ShardOfSeveral,
    /// A scene that was just recorded did not replay the same.
    #[error("the scene did not replay the same; this is a bug in rebond, please report it with the scene")]
    NotReproducible,
    /// The engine failed in a step. The recording ends with the same error.
    #[error("{}; the steps before it are recorded in {}", error_text(error), path.display())]
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
            recording::Error::Open { .. } => CommandError::RecordingFile(source),
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
            _ if source.get_ref().is_some_and(|source| source.is::<Busy>()) => CommandError::Busy(path.into()),
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
    let reports = match &error {
        CommandError::Scene(error) => ErrorReport::of_scene(error),
        error => vec![ErrorReport::new(error, error.help().as_deref())],
    };
    for report in reports {
        let _ = writeln!(io::stderr(), "{:?}", miette::Report::new(report));
    }
    match error {
        CommandError::NotReproducible | CommandError::Picture(picture::Error::Diverged { .. }) => Exit::Diverged,
        CommandError::Recording { source, .. } if source.is_damage() => Exit::Damaged,
        _ => Exit::Error,
    }
}
