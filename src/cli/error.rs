use super::{Exit, output};
use crate::{illustration, recording, render::RenderError, run::RunError, scene::SceneError};
use miette::{Diagnostic, MietteHandlerOpts};
use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

/// Why a command could not be carried out.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum CommandError {
    /// The scene is refused.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] SceneError),
    /// The run could not be recorded.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
    /// A recording cannot be read or written.
    #[error("{}: {source}", path.display())]
    Recording {
        /// Which one.
        path: PathBuf,
        /// What of it.
        source: recording::Error,
    },
    /// A scene stands where a recording is wanted.
    #[error("{} is a scene; record it first: rebond record {} -o {}", path.display(), path.display(), path.with_extension("mcap").display())]
    NotRecordedYet {
        /// The scene.
        path: PathBuf,
    },
    /// A recording cannot be opened or created; the error names it.
    #[error(transparent)]
    RecordingFile(recording::Error),
    /// There is no picture.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A result cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    #[diagnostic(help("see that its folder is there, may be written to and has room, or give another place with -o"))]
    Unwritable {
        /// Which file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Standard output does not take any more.
    #[error("cannot write to standard output: {0}")]
    #[diagnostic(help("its reader has gone or has no room; give a file with -o instead"))]
    StandardOutput(#[source] io::Error),
    /// Something stands where the result is to go.
    #[error("{} exists already; give another name with -o, or --force to replace it", .0.display())]
    Exists(PathBuf),
    /// There is nothing to check.
    #[error(transparent)]
    Check(#[from] crate::check::CheckError),
    /// There is no illustration.
    #[error(transparent)]
    Illustration(illustration::Error),
    /// A picture says nothing of where it comes from.
    #[error("{}: {source}", path.display())]
    NoEvidence {
        /// The picture.
        path: PathBuf,
        /// What of it.
        source: Box<illustration::Error>,
    },
    /// A video cannot be compressed.
    #[error(
        "cannot make {}: ffmpeg cannot be run ({source}); install it (https://ffmpeg.org), or give a name that ends \
         in .gif or .apng, which need nothing",
        path.display()
    )]
    NoFfmpeg {
        /// The video.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// ffmpeg gave up.
    #[error("cannot make {}: ffmpeg says: {what}", path.display())]
    Ffmpeg {
        /// The video.
        path: PathBuf,
        /// Its own words.
        what: String,
    },
    /// ffmpeg does not take any more.
    #[error("cannot write to ffmpeg: {0}")]
    Pipe(#[source] io::Error),
    /// The name of the result does not say what it is to be.
    #[error("cannot tell what {} is to be: {expected}", path.display())]
    UnknownKind {
        /// The name given.
        path: PathBuf,
        /// What names would be accepted.
        expected: &'static str,
    },
    /// A scene that was recorded just now did not replay the same.
    #[error("the scene did not replay the same; this is a fault of rebond, please report it with the scene")]
    NotTheSame,
    /// The run ended in an error of the engine; the recording tells it too.
    #[error("{error}; recorded up to there in {}", path.display())]
    Step {
        /// The recording.
        path: PathBuf,
        /// What happened.
        error: crate::physics::StepError,
    },
}

impl CommandError {
    /// The error of reading or writing a recording at `path`, which is named once.
    pub fn recording(path: &Path, source: recording::Error) -> CommandError {
        match source {
            recording::Error::Open { .. } | recording::Error::Create { .. } | recording::Error::Exists { .. } => {
                CommandError::RecordingFile(source)
            }
            recording::Error::NotARecording { .. } if path.extension().is_some_and(|extension| extension == "toml") => {
                CommandError::NotRecordedYet { path: path.into() }
            }
            recording::Error::Write(source) => CommandError::unwritable(path)(source),
            source => CommandError::Recording { path: path.into(), source },
        }
    }

    /// The error of writing a result at `path`, which may be standard output.
    pub fn unwritable(path: &Path) -> impl Fn(io::Error) -> CommandError {
        move |source| match output::is_standard_output(path) {
            true => CommandError::StandardOutput(source),
            false => CommandError::Unwritable { path: path.into(), source },
        }
    }
}

impl From<illustration::Error> for CommandError {
    fn from(error: illustration::Error) -> CommandError {
        match error {
            illustration::Error::Recording { path, source } => CommandError::recording(&path, source),
            illustration::Error::Scene(error) => CommandError::Scene(error),
            error => CommandError::Illustration(error),
        }
    }
}

/// Tells the user on standard error. Should that be closed, the exit code remains.
///
/// Each error is one sentence that says what the system said, so causes are not listed again,
/// and it stays on one line, so that a script can find words in it.
pub fn report(error: CommandError) -> Exit {
    let handler = || MietteHandlerOpts::new().without_cause_chain().wrap_lines(false).build();
    let _ = miette::set_hook(Box::new(move |_| Box::new(handler()))); // Fails only if set before.
    let report = miette::Report::new(error);
    let exit = match report.downcast_ref() {
        Some(CommandError::NotTheSame | CommandError::Illustration(illustration::Error::Diverged { .. })) => {
            Exit::Diverged
        }
        Some(CommandError::Recording { source, .. }) if source.is_damage() => Exit::Damaged,
        Some(_) | None => Exit::Error,
    };
    let _ = writeln!(io::stderr(), "{report:?}");
    exit
}
