use super::error::CommandError;
use super::{output, record, replay};
use crate::illustration;
use crate::physics::CollisionCount;
use crate::replay::Verdict;
use crate::run;
use crate::scene::{self, Scene};
use std::{fs::File, io::Read, path::Path};
use tempfile::TempDir;

/// A recording that is drawn, or one made of a scene for that.
pub struct Source {
    /// The recording, looked through.
    pub recording: illustration::Source,
    /// Holds the recording of a scene until it has been drawn.
    _made_here: Option<TempDir>,
}

impl Source {
    /// Opens a recording; or records a scene and makes sure that it replays the same.
    pub fn open(path: &Path) -> Result<Source, CommandError> {
        if is_recording(path)? {
            return Ok(Source { recording: illustration::Source::open(path)?, _made_here: None });
        }
        let scene = scene::load(path)?;
        let folder = TempDir::with_prefix("rebond-").map_err(CommandError::unwritable(&std::env::temp_dir()))?;
        let recording = folder.path().join("scene.mcap");
        record_and_replay(&scene, &recording)?;
        Ok(Source { recording: illustration::Source::open(&recording)?, _made_here: Some(folder) })
    }
}

fn is_recording(path: &Path) -> Result<bool, CommandError> {
    let unreadable = |source| CommandError::Unreadable { path: path.into(), source };
    let mut magic = Vec::new();
    File::open(path).and_then(|file| file.take(8).read_to_end(&mut magic)).map_err(unreadable)?;
    Ok(magic.starts_with(mcap::MAGIC) || path.extension().is_some_and(|extension| extension == "mcap"))
}

/// Records a scene and replays it; a verdict other than `same` is told and ends the work.
fn record_and_replay(scene: &Scene, path: &Path) -> Result<(), CommandError> {
    let file = File::create(path).map_err(CommandError::unwritable(path))?;
    let plan = run::RecordOptions::whole(scene);
    let recorded = record::record(scene, plan, run::NO_LIVE_EVENTS, file, path)?;
    if let Some(error) = &recorded.error {
        output::note(format_args!("{error}; drawing what came before"));
    }
    let verdict = replay::judge(path, 0..=u64::MAX, &mut CollisionCount::default())?;
    output::note(format_args!("{verdict}"));
    match verdict {
        Verdict::Same { .. } => Ok(()),
        Verdict::Diverged(_) | Verdict::Truncated { .. } | Verdict::Corrupt { .. } => Err(CommandError::NotTheSame),
    }
}
