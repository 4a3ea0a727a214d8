use super::arguments::ReplayOptions;
use super::error::CommandError;
use super::{Exit, json, output, progress};
use crate::physics::{CollisionCount, Observer};
use crate::recording;
use crate::replay::{Verdict, replay};
use std::{ops::RangeInclusive, path::Path};

/// Runs a recording again and prints the verdict.
pub fn run(options: &ReplayOptions) -> Result<Exit, CommandError> {
    let steps = options.from.unwrap_or(0)..=options.to.unwrap_or(u64::MAX);
    let verdict = replay_with_progress(&options.recording, steps, &mut CollisionCount::default())?;
    let text = if options.json { json::verdict(&verdict).to_string() } else { verdict.to_string() };
    output::print(format!("{text}\n").as_bytes())?;
    Ok(exit_code(&verdict))
}

/// Replays with a progress bar. Collisions are passed to the observer.
pub fn replay_with_progress<O: Observer>(
    path: &Path,
    steps: RangeInclusive<u64>,
    observer: &mut O,
) -> Result<Verdict, CommandError> {
    let failed = |error| CommandError::recording(path, error);
    let recording = recording::open(path).map_err(failed)?;
    let bar = progress::bar("replaying", recording.header.steps);
    let verdict = replay(recording, steps, observer, &mut |step| bar.set_position(step));
    bar.finish_and_clear();
    verdict.map_err(failed)
}

/// The exit code of a verdict.
fn exit_code(verdict: &Verdict) -> Exit {
    match verdict {
        Verdict::Same { .. } => Exit::Done,
        Verdict::Diverged(_) => Exit::Diverged,
        Verdict::Truncated { .. } | Verdict::Corrupt { .. } => Exit::Damaged,
    }
}
