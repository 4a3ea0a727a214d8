use super::error::CommandError;
use super::{Exit, output, record, replay};
use crate::physics::{CollisionCount, StepError};
use crate::picture;
use crate::replay::{ALL_STEPS, NO_LIVE_EVENTS, RecordOptions, Verdict};
use crate::scene;
use crate::temporary::TemporaryFolder;
use std::{fs::File, path::Path, path::PathBuf};

/// A recording given as such, or a temporary one made from a scene.
pub struct SourceFile {
    /// The path of the recording.
    pub path: PathBuf,
    /// The error that ended the run of the scene; its steps before it are used.
    failure: Option<StepError>,
    /// The folder of the temporary recording; it is removed when this is dropped.
    _temporary: Option<TemporaryFolder>,
}

impl SourceFile {
    /// Takes a recording as it is, or records a scene, with or without verifying that it replays the same.
    pub fn open(path: &Path, verification: Verification) -> Result<SourceFile, CommandError> {
        if picture::Source::is_recording(path).map_err(CommandError::unreadable(path))? {
            return Ok(SourceFile { path: path.into(), failure: None, _temporary: None });
        }
        let scene = scene::load(path)?;
        let folder = TemporaryFolder::create_in_system().map_err(CommandError::unwritable(&std::env::temp_dir()))?;
        let recording = folder.path().join("scene.mcap");
        let file = File::create(&recording).map_err(CommandError::unwritable(&recording))?;
        let recorded = record::record(&scene, RecordOptions::complete(&scene), NO_LIVE_EVENTS, file, &recording)?;
        if let Some(error) = &recorded.error {
            output::info(format_args!("{error}; using the steps before it"));
        }
        if verification == Verification::Replay {
            verify(&recording)?;
        }
        let failure = recorded.error;
        Ok(SourceFile { path: recording, failure, _temporary: Some(folder) })
    }

    /// The exit code of a command that has used the source and would return `exit`: an error if the run of the scene
    /// ended in one, as `record` returns for it.
    pub fn exit(&self, exit: Exit) -> Exit {
        if self.failure.is_some() { Exit::Error } else { exit }
    }
}

/// The verification of a recording that was made from a scene just now. Recordings of files are verified by the commands
/// that replay them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verification {
    /// The recording is replayed once, and a verdict other than `same` is an error.
    Replay,
    /// For a single picture, which takes less time than a replay: the scene is simulated once, unless the picture itself
    /// needs a replay, which compares every state.
    None,
}

/// A recording to draw.
pub struct OpenedSource {
    /// The recording, with its summary.
    pub recording: picture::Source,
    /// The file of the recording.
    pub file: SourceFile,
}

impl OpenedSource {
    /// Opens a recording, or records a scene, with or without verifying that it replays the same.
    pub fn open(path: &Path, verification: Verification) -> Result<OpenedSource, CommandError> {
        let file = SourceFile::open(path, verification)?;
        Ok(OpenedSource { recording: picture::Source::open(&file.path)?, file })
    }
}

/// Replays a recording. A verdict other than `same` is an error.
fn verify(recording: &Path) -> Result<(), CommandError> {
    let verdict = replay::replay_with_progress(recording, ALL_STEPS, &mut CollisionCount::default())?;
    output::info(format_args!("{verdict}"));
    match verdict {
        Verdict::Same { .. } => Ok(()),
        Verdict::Diverged(_) | Verdict::Incomplete { .. } | Verdict::Corrupt { .. } => {
            Err(CommandError::NotReproducible)
        }
    }
}
