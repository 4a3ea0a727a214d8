use super::error::CommandError;
use super::{Exit, output, record, replay};
use crate::physics::{CollisionCount, StepError};
use crate::picture;
use crate::replay::{ALL_STEPS, NO_LIVE_EVENTS, RecordOptions, Verdict};
use crate::scene::{self, Scene};
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
    /// Takes a recording as it is, or records a scene and verifies that it replays the same.
    pub fn open(path: &Path) -> Result<SourceFile, CommandError> {
        if picture::Source::is_recording(path).map_err(CommandError::unreadable(path))? {
            return Ok(SourceFile { path: path.into(), failure: None, _temporary: None });
        }
        let scene = scene::load(path)?;
        let folder = TemporaryFolder::create_in_system().map_err(CommandError::unwritable(&std::env::temp_dir()))?;
        let recording = folder.path().join("scene.mcap");
        let failure = record_and_replay(&scene, &recording)?;
        Ok(SourceFile { path: recording, failure, _temporary: Some(folder) })
    }

    /// The exit code of a command that has used the source and would return `exit`: an error if the run of the scene
    /// ended in one, as `record` returns for it.
    pub fn exit(&self, exit: Exit) -> Exit {
        if self.failure.is_some() { Exit::Error } else { exit }
    }
}

/// A recording to draw.
pub struct OpenedSource {
    /// The recording, with its summary.
    pub recording: picture::Source,
    /// The file of the recording.
    pub file: SourceFile,
}

impl OpenedSource {
    /// Opens a recording, or records a scene and verifies that it replays the same.
    pub fn open(path: &Path) -> Result<OpenedSource, CommandError> {
        let file = SourceFile::open(path)?;
        Ok(OpenedSource { recording: picture::Source::open(&file.path)?, file })
    }
}

/// Records a scene and replays it; returns the error that ended its run, if there is one. A verdict other than `same` is
/// an error.
fn record_and_replay(scene: &Scene, path: &Path) -> Result<Option<StepError>, CommandError> {
    let file = File::create(path).map_err(CommandError::unwritable(path))?;
    let plan = RecordOptions::complete(scene);
    let recorded = record::record(scene, plan, NO_LIVE_EVENTS, file, path)?;
    if let Some(error) = &recorded.error {
        output::info(format_args!("{error}; using the steps before it"));
    }
    let verdict = replay::replay_with_progress(path, ALL_STEPS, &mut CollisionCount::default())?;
    output::info(format_args!("{verdict}"));
    match verdict {
        Verdict::Same { .. } => Ok(recorded.error),
        Verdict::Diverged(_) | Verdict::Incomplete { .. } | Verdict::Corrupt { .. } => {
            Err(CommandError::NotReproducible)
        }
    }
}
