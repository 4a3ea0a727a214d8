//! Whether a recording replays, and whether the scene beside it still gives it.

use super::{Drift, Finding, Fresh, Outcome};
use crate::recording::{self, Error, Identity};
use crate::replay::{Verdict, replay_file};
use crate::run::{self, RunError};
use crate::scene::{self, Scene};
use std::path::Path;
use tempfile::TempPath;

/// Examines the recording at `path`.
pub fn examine(path: &Path, scene: Option<&Path>) -> Finding {
    let replayed = replayed(path);
    let finding = |outcome, fresh| Finding { path: path.into(), outcome, fresh };
    let Some(scene_path) = scene else { return finding(replayed, None) };
    let fresh = match scene::load(scene_path).map_err(RunError::from).and_then(|scene| anew(&scene, path)) {
        Ok(fresh) => fresh,
        Err(error) => {
            let why = format!("its scene {} cannot be recorded: {error}", scene_path.display());
            return finding(Outcome::Failed(why), None);
        }
    };
    let Outcome::Replayed { verdict: verdict @ Verdict::Same { .. }, .. } = replayed else {
        return finding(replayed, Some(Fresh::Recording(fresh.file)));
    };
    match drift(path, &fresh) {
        Ok(None) => finding(Outcome::Replayed { verdict, has_scene: true }, None),
        Ok(Some(drift)) => finding(Outcome::Drifted(drift), Some(Fresh::Recording(fresh.file))),
        Err(error) => finding(Outcome::Failed(error.to_string()), None),
    }
}

fn replayed(path: &Path) -> Outcome {
    match replay_file(path) {
        Ok(Verdict::Diverged(divergence)) => Outcome::Diverged(divergence),
        Ok(verdict) => Outcome::Replayed { verdict, has_scene: false },
        Err(Error::OtherSemantics { found }) => Outcome::OtherSemantics { found },
        Err(error) if error.is_damage() => Outcome::Damaged(error.to_string()),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}

/// A recording made anew of a scene.
struct Anew {
    file: TempPath,
    identity: Identity,
}

/// Records a scene as far and as finely as the recording at `path` was; where that cannot be read,
/// as the scene has it.
fn anew(scene: &Scene, path: &Path) -> Result<Anew, RunError> {
    let (steps, every) = match recording::open(path) {
        Ok(recording) => (recording.header.steps, recording.header.every),
        Err(_) => (scene.run.steps, 1),
    };
    let unwritable = |error| RunError::from(Error::Write(error));
    let (file, place) = tempfile::Builder::new().prefix("rebond-").tempfile().map_err(unwritable)?.into_parts();
    let plan = run::RecordOptions { steps, every, viewer: None };
    let recorded = run::record(scene, plan, run::NO_LIVE_EVENTS, file, |_| ())?;
    Ok(Anew { file: place, identity: recorded.end.identity })
}

fn drift(path: &Path, fresh: &Anew) -> Result<Option<Drift>, Error> {
    let mut recorded = recording::open(path)?;
    for item in recorded.by_ref() {
        item?;
    }
    if recorded.end().is_some_and(|end| end.identity == fresh.identity) {
        return Ok(None);
    }
    Drift::between(recording::open(path)?, recording::open(&fresh.file)?).map(Some)
}
