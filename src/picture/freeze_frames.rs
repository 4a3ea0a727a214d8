use super::{Error, Progress, Source, source};
use crate::physics::{BodyId, Collision, Observer};
use crate::render::{Moment, StepGrid};
use crate::replay::replay;

/// Returns the moments of new collisions within `grid`, in order, found by a replay. A collision is new
/// if its two bodies did not collide in the previous step.
///
/// The event-driven solver gives exact instants; the handout's solver gives the state in which it
/// detected the collision.
///
/// # Errors
/// If the recording cannot be read.
pub fn freeze_frames(source: &Source, grid: &StepGrid, progress: Progress) -> Result<Vec<Moment>, Error> {
    let (from, rate) = (*grid.steps.start(), grid.rate);
    let mut finder =
        FreezeFrameFinder { from, rate, step: 0, pairs: Vec::new(), previous_pairs: Vec::new(), moments: Vec::new() };
    let last = *grid.steps.end();
    let recording = source::open(&source.path)?;
    // The collisions of the step before the first decide which ones of the first step are new.
    let verdict = replay(recording, from.saturating_sub(2)..=last, &mut finder, &mut |step| progress(step, last));
    verdict.map_err(|error| source.read_error(error))?;
    Ok(finder.moments)
}

struct FreezeFrameFinder {
    from: u64,
    /// Hz.
    rate: f64,
    /// The step of the last collision.
    step: u64,
    /// The pairs that collided in that step and in the previous one.
    pairs: Vec<[BodyId; 2]>,
    previous_pairs: Vec<[BodyId; 2]>,
    moments: Vec<Moment>,
}

impl Observer for FreezeFrameFinder {
    fn collision(&mut self, collision: &Collision) {
        if collision.impulse == 0.0 {
            return;
        }
        if collision.step != self.step {
            let pairs = std::mem::take(&mut self.pairs);
            self.previous_pairs = if collision.step == self.step + 1 { pairs } else { Vec::new() };
            self.step = collision.step;
        }
        let moment = if collision.time * self.rate < 1.0 {
            Moment { step: collision.step, offset: collision.time }
        } else {
            Moment { step: collision.step + 1, offset: 0.0 }
        };
        let mut pair = collision.bodies;
        pair.sort_unstable();
        let is_new = !self.previous_pairs.contains(&pair) && !self.pairs.contains(&pair);
        if is_new && moment.step >= self.from && self.moments.last() != Some(&moment) {
            self.moments.push(moment);
        }
        self.pairs.push(pair);
    }
}
