use super::{Error, Progress, Source, source};
use crate::physics::{BodyId, Collision, Observer};
use crate::render::{Moment, Sampling};
use crate::replay::replay;

/// The moments within a sampling at which bodies meet that did not meet in the step before, in
/// order: exact instants where the solver knows them, else the states in which it found them.
///
/// # Errors
/// When the recording cannot be read.
pub fn stops(source: &Source, sampling: &Sampling, progress: Progress) -> Result<Vec<Moment>, Error> {
    let (from, rate) = (*sampling.steps.start(), sampling.rate);
    let mut stops = Stops { from, rate, step: 0, met: Vec::new(), before: Vec::new(), moments: Vec::new() };
    let last = *sampling.steps.end();
    let recording = source::open(&source.path)?;
    // Who met in the step before the first is known from the one before that.
    let done = replay(recording, from.saturating_sub(2)..=last, &mut stops, &mut |step| progress(step, last));
    done.map_err(|error| source.unreadable(error))?;
    Ok(stops.moments)
}

struct Stops {
    from: u64,
    /// Hz.
    rate: f64,
    /// The step the last collision was in.
    step: u64,
    /// Who met in it, and in the one before.
    met: Vec<[BodyId; 2]>,
    before: Vec<[BodyId; 2]>,
    moments: Vec<Moment>,
}

impl Observer for Stops {
    fn collision(&mut self, collision: &Collision) {
        if collision.impulse == 0.0 {
            return;
        }
        if collision.step != self.step {
            let met = std::mem::take(&mut self.met);
            self.before = if collision.step == self.step + 1 { met } else { Vec::new() };
            self.step = collision.step;
        }
        let moment = if collision.time * self.rate < 1.0 {
            Moment { step: collision.step, offset: collision.time }
        } else {
            Moment { step: collision.step + 1, offset: 0.0 }
        };
        let mut pair = collision.bodies;
        pair.sort_unstable();
        let is_new = !self.before.contains(&pair) && !self.met.contains(&pair);
        if is_new && moment.step >= self.from && self.moments.last() != Some(&moment) {
            self.moments.push(moment);
        }
        self.met.push(pair);
    }
}
