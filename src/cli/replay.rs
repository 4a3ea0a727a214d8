use super::arguments::ReplayOptions;
use super::error::CommandError;
use super::{Exit, against, output};
use crate::physics::{CollisionCount, Observer};
use crate::picture_options::ReversedRange;
use crate::recording::{self, Health, Missing};
use crate::replay::{Difference, Replayer, Verdict, ulps};
use serde_json::{Value, json};
use std::{ops::RangeInclusive, path::Path};

/// Runs a recording again and prints the verdict.
pub fn run(options: &ReplayOptions) -> Result<Exit, CommandError> {
    if let Some(states) = &options.against {
        return against::run(options, states);
    }
    let steps = |rate| options.steps(rate);
    let verdict = replay_with_progress(&options.recording, steps, &mut CollisionCount::default())?;
    let text = if options.json { verdict_json(&verdict).to_string() } else { verdict.to_string() };
    output::print(&format!("{text}\n"))?;
    Ok(exit_code(&verdict))
}

/// Replays with a progress bar, and compares the steps that `steps` returns for the rate of the recording. Collisions
/// are passed to the observer.
pub fn replay_with_progress<O: Observer>(
    path: &Path,
    steps: impl FnOnce(f64) -> Result<RangeInclusive<u64>, ReversedRange>,
    observer: &mut O,
) -> Result<Verdict, CommandError> {
    let recording = recording::open(path).map_err(CommandError::in_recording(path))?;
    let bar = output::progress_bar("replaying", recording.header.steps);
    let steps = steps(recording.header.config.rate)?;
    let replayer = Replayer::new(recording, steps);
    let verdict = replayer.and_then(|replayer| replayer.run(observer, |step| bar.set_position(step)));
    bar.finish_and_clear();
    verdict.map_err(CommandError::in_recording(path))
}

/// The exit code of a verdict.
fn exit_code(verdict: &Verdict) -> Exit {
    match verdict {
        Verdict::Same { .. } => Exit::Done,
        Verdict::Diverged(_) => Exit::Diverged,
        Verdict::Incomplete { .. } | Verdict::Corrupt { .. } => Exit::Damaged,
    }
}

/// A verdict as JSON, including its line of text.
fn verdict_json(verdict: &Verdict) -> Value {
    let (steps, divergence) = match verdict {
        Verdict::Same { steps, .. } | Verdict::Incomplete { steps, .. } | Verdict::Corrupt { steps, .. } => {
            (Some(steps), None)
        }
        Verdict::Diverged(divergence) => (None, Some(difference_json(divergence.step, &divergence.difference))),
    };
    let health = verdict.health();
    let missing = health.as_ref().and_then(Health::missing).map(missing_json);
    json!({
        "verdict": verdict.word(), "same_steps": steps, "divergence": divergence,
        "health": health.as_ref().map(Health::word), "missing": missing, "what": verdict.to_string(),
    })
}

/// The missing parts of a recording as JSON.
pub fn missing_json(missing: &Missing) -> Value {
    let steps: Vec<Value> = missing.steps().into_iter().map(|(from, to)| json!({ "from": from, "to": to })).collect();
    let end = missing.end.map(|end| json!({ "after": end.after, "last": end.last, "cut": end.is_cut }));
    json!({
        "steps": steps, "end": end, "scene": missing.scene, "keyframes": missing.keyframes,
        "recovered": missing.recovered, "what": missing.to_string(),
    })
}

/// A difference as JSON, with the step where it was found.
pub fn difference_json(step: u64, difference: &Difference) -> Value {
    match difference {
        Difference::Value { body, field, recorded, replayed } => json!({
            "step": step, "body": body, "field": field, "recorded": recorded, "replayed": replayed,
            "ulps": ulps(*recorded, *replayed),
        }),
        Difference::Digest { .. } | Difference::Mismatch { .. } => {
            json!({ "step": step, "what": difference.to_string() })
        }
    }
}
