//! Checking a recording: it must replay the same and match a new run of the scene next to it.

use super::{CheckResult, Outcome, Replacement, SceneMismatch};
use crate::recording::{self, Error, Identity};
use crate::replay::{Verdict, replay_file};
use crate::run::{self, RunError};
use crate::scene::{self, Scene};
use std::path::Path;
use tempfile::TempPath;

/// Checks the recording at `path`, and compares it with a new run of the scene, if one is given.
pub fn check_recording(path: &Path, scene: Option<&Path>) -> CheckResult {
    let replayed = replay_recording(path);
    let result = |outcome, replacement| CheckResult { path: path.into(), outcome, replacement };
    let Some(scene_path) = scene else { return result(replayed, None) };
    let new_recording = scene::load(scene_path).map_err(RunError::from).and_then(|scene| record_scene(&scene, path));
    let new_recording = match new_recording {
        Ok(new_recording) => new_recording,
        Err(error) => {
            let reason = format!("its scene {} cannot be run: {error}", scene_path.display());
            return result(Outcome::Failed(reason), None);
        }
    };
    let Outcome::Replayed { verdict: verdict @ Verdict::Same { .. }, .. } = replayed else {
        return result(replayed, Some(Replacement::Recording(new_recording.file)));
    };
    match compare_with(path, &new_recording) {
        Ok(None) => result(Outcome::Replayed { verdict, matches_scene: true }, None),
        Ok(Some(mismatch)) => result(Outcome::Drifted(mismatch), Some(Replacement::Recording(new_recording.file))),
        Err(error) => result(Outcome::Failed(error.to_string()), None),
    }
}

fn replay_recording(path: &Path) -> Outcome {
    match replay_file(path) {
        Ok(Verdict::Diverged(divergence)) => Outcome::Diverged(divergence),
        Ok(verdict) => Outcome::Replayed { verdict, matches_scene: false },
        Err(Error::OtherSemantics { found }) => Outcome::OtherSemantics { found },
        Err(error) if error.is_damage() => Outcome::Damaged(error.to_string()),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}

/// A recording of a new run of a scene.
struct NewRecording {
    file: TempPath,
    identity: Identity,
}

/// Records a scene with the number of steps and the thinning of the recording at `path`, or in full if that recording
/// cannot be read.
fn record_scene(scene: &Scene, path: &Path) -> Result<NewRecording, RunError> {
    let (steps, every) = match recording::open(path) {
        Ok(recording) => (recording.header.steps, recording.header.every),
        Err(_) => (scene.run.steps, 1),
    };
    let unwritable = |error| RunError::from(Error::Write(error));
    let (file, temp_path) = tempfile::Builder::new().prefix("rebond-").tempfile().map_err(unwritable)?.into_parts();
    let plan = run::RecordOptions { steps, every, viewer: None };
    let recorded = run::record(scene, plan, run::NO_LIVE_EVENTS, file, |_| ())?;
    Ok(NewRecording { file: temp_path, identity: recorded.end.identity })
}

/// Compares the recording at `path` with a new one. `None` if both have the same identity.
fn compare_with(path: &Path, new_recording: &NewRecording) -> Result<Option<SceneMismatch>, Error> {
    let mut recorded = recording::open(path)?;
    for item in recorded.by_ref() {
        item?;
    }
    if recorded.trailer().is_some_and(|end| end.identity == new_recording.identity) {
        return Ok(None);
    }
    SceneMismatch::between(recording::open(path)?, recording::open(&new_recording.file)?).map(Some)
}
