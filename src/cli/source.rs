use super::error::CommandError;
use super::{output, record, replay};
use crate::physics::CollisionCount;
use crate::picture;
use crate::replay::Verdict;
use crate::run;
use crate::scene::{self, Scene};
use std::{fs::File, io::Read, path::Path};
use tempfile::TempDir;

/// A recording to draw, possibly a temporary one made from a scene.
pub struct Source {
    /// The recording, with its summary.
    pub recording: picture::Source,
    /// The folder of the temporary recording; it is removed when this is dropped.
    _temporary: Option<TempDir>,
}

impl Source {
    /// Opens a recording, or records a scene and verifies that it replays the same.
    pub fn open(path: &Path) -> Result<Source, CommandError> {
        if is_recording(path)? {
            return Ok(Source { recording: picture::Source::open(path)?, _temporary: None });
        }
        let scene = scene::load(path)?;
        let folder = TempDir::with_prefix("rebond-").map_err(CommandError::unwritable(&std::env::temp_dir()))?;
        let recording = folder.path().join("scene.mcap");
        record_and_replay(&scene, &recording)?;
        Ok(Source { recording: picture::Source::open(&recording)?, _temporary: Some(folder) })
    }
}

fn is_recording(path: &Path) -> Result<bool, CommandError> {
    let unreadable = |source| CommandError::Unreadable { path: path.into(), source };
    let mut magic = Vec::new();
    File::open(path).and_then(|file| file.take(8).read_to_end(&mut magic)).map_err(unreadable)?;
    Ok(magic.starts_with(mcap::MAGIC) || path.extension().is_some_and(|extension| extension == "mcap"))
}

/// Records a scene and replays it. A verdict other than `same` is an error.
fn record_and_replay(scene: &Scene, path: &Path) -> Result<(), CommandError> {
    let file = File::create(path).map_err(CommandError::unwritable(path))?;
    let plan = run::RecordOptions::whole(scene);
    let recorded = record::record(scene, plan, run::NO_LIVE_EVENTS, file, path)?;
    if let Some(error) = &recorded.error {
        output::info(format_args!("{error}; drawing the steps before it"));
    }
    let verdict = replay::replay_with_progress(path, 0..=u64::MAX, &mut CollisionCount::default())?;
    output::info(format_args!("{verdict}"));
    match verdict {
        Verdict::Same { .. } => Ok(()),
        Verdict::Diverged(_) | Verdict::Truncated { .. } | Verdict::Corrupt { .. } => {
            Err(CommandError::NotReproducible)
        }
    }
}
