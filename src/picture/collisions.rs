//! Collisions of a recording, which are found by a replay.

use super::figures::CollisionSubject;
use super::{AnimationSchedule, Appearance, CollisionSelector, Error, Moment, Progress, Source, TraceGap};
use crate::physics::{BodyId, Collision, Observer, larger};
use crate::picture_options::StepOrTime;
use crate::recording::{Health, Item, Missing};
use crate::replay::{ALL_STEPS, Replayer};
use crate::text::counted;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Finds the first collision with an impulse in or after a step, or at or after a time, between the bodies of `pair` if
/// given, by replaying the recording. If no later collision has an impulse, finds the first one without: bodies that
/// overlap at rest or while they separate, which the handout's solver displaces.
///
/// Returns it with the health of the recording as far as it was read.
///
/// # Errors
/// If there is no such collision or no state, if a [`CollisionSelector`] cannot name it, or if the recording cannot be
/// read or diverges.
pub fn find_collision(
    source: &Source,
    start: StepOrTime,
    pair: Option<&[String; 2]>,
    progress: Progress,
) -> Result<(CollisionSubject, Health), Error> {
    let is_wanted = |(found, _): &&(CollisionSubject, Health)| {
        let selector = collision_selector(found);
        start == StepOrTime::Step(selector.step) && pair == Some(&selector.pair)
    };
    let cached = source.found_collisions.lock().ok().and_then(|found| found.iter().find(is_wanted).cloned());
    if let Some(found) = cached {
        return Ok(found);
    }
    let bodies = source.appearances()?;
    let mut search = Search::new(start, pair, &bodies);
    let steps = source.header.steps;
    let first = start.first_collision_step(source.header.config.rate);
    let recording = source.recording()?;
    let mut replayer = Replayer::new(recording, first..=u64::MAX).map_err(|error| source.read_error(error))?;
    let mut has_states = false;
    while search.found.is_none() {
        let Some(step) = replayer.next_state(&mut search).map_err(|error| source.read_error(error))? else { break };
        has_states = true;
        progress(step, steps);
    }
    let health = Error::unless_diverged(replayer.verdict(), &source.path)?;
    let health = if search.found.is_some() { without_missing_end(health) } else { health };
    if !has_states && health != Health::Whole {
        return Err(source.missing_states(&(first..=u64::MAX), health));
    }
    search.refuse_ambiguous()?;
    let found = search.found.or(search.without_impulse).and_then(|collision| {
        let [c, b] = collision.bodies.map(|id| bodies.get(&id).cloned());
        Some((CollisionSubject { title: String::new(), collision, bodies: [c?, b?] }, health.clone()))
    });
    let missing = pair.into_iter().flatten().find(|&name| !source.statistics.names.contains(name));
    if let Some(name) = missing {
        return Err(source.unknown_body(name));
    }
    if let (Some(found), Ok(mut cache)) = (&found, source.found_collisions.lock()) {
        cache.push(found.clone());
    }
    found.ok_or_else(|| {
        let between = pair.map_or(String::new(), |[a, b]| format!(" between {a:?} and {b:?}"));
        let run = counted(steps, "step");
        let range = match start {
            StepOrTime::Step(step) => format!("in or after step {step}"),
            StepOrTime::Time(time) => format!("at or after {time} s"),
        };
        source.nothing_to_show(format!("no collision{between} {range}, in a run of {run}"))
    })
}

/// The parts before a step that the recording lacks. Whatever collisions they had are unknown, so that the one in the
/// step is the first only of those that are known. They are read from the start, so that they do not depend on where
/// the search for the collision began.
pub fn gaps_before(source: &Source, step: u64) -> Result<Vec<TraceGap>, Error> {
    let mut recording = source.recording()?;
    while let Some(item) = recording.next().transpose().map_err(|error| source.read_error(error))? {
        if matches!(item, Item::State(state) if state.step >= step) {
            break;
        }
    }
    Ok(source.missing_in(&(0..=step), &recording.health()))
}

/// The health of the part of a recording that was read: its missing end is left out, because it is not known yet.
fn without_missing_end(health: Health) -> Health {
    match health {
        Health::Incomplete(missing) if (Missing { end: None, ..missing.clone() }).is_empty() => Health::Whole,
        Health::Incomplete(missing) => Health::Incomplete(Missing { end: None, ..missing }),
        Health::Corrupt { damage, missing } => Health::Corrupt { damage, missing: Missing { end: None, ..missing } },
        Health::Whole => Health::Whole,
    }
}

/// The selector that finds this collision again.
pub fn collision_selector(subject: &CollisionSubject) -> CollisionSelector {
    let [c, b] = &subject.bodies;
    CollisionSelector { step: subject.collision.step, pair: [c.name.clone(), b.name.clone()] }
}

struct Search<'a> {
    start: StepOrTime,
    pair: Option<&'a [String; 2]>,
    bodies: &'a BTreeMap<BodyId, Arc<Appearance>>,
    found: Option<Collision>,
    without_impulse: Option<Collision>,
    /// The last step with a collision before the start, and the pairs that collided in it.
    passed: (u64, BTreeSet<[BodyId; 2]>),
}

impl<'a> Search<'a> {
    fn new(
        start: StepOrTime,
        pair: Option<&'a [String; 2]>,
        bodies: &'a BTreeMap<BodyId, Arc<Appearance>>,
    ) -> Search<'a> {
        Search { start, pair, bodies, found: None, without_impulse: None, passed: (0, BTreeSet::new()) }
    }

    /// Returns an error if the pair of the collision found has collided in the same step before, so that step and pair
    /// do not distinguish the two collisions.
    fn refuse_ambiguous(&self) -> Result<(), Error> {
        let (step, pairs) = &self.passed;
        let found = self.found.as_ref().or(self.without_impulse.as_ref());
        let Some(collision) = found.filter(|found| found.step == *step && pairs.contains(&found.bodies)) else {
            return Ok(());
        };
        let names = collision.bodies.map(|id| self.bodies.get(&id).map_or("", |body| body.name.as_str()));
        let reason = format!(
            "the collision of {:?} and {:?} at {} s is not their first one in step {step}; choose a collision by its \
             step with --step {step} or --step {}, or record with a higher rate",
            names[0],
            names[1],
            collision.instant,
            step + 1
        );
        Err(Error::NothingToShow { reason })
    }

    fn is_reached(&self, collision: &Collision) -> bool {
        match self.start {
            StepOrTime::Step(step) => collision.step >= step,
            StepOrTime::Time(time) => collision.instant >= time,
        }
    }

    /// Remembers a collision before the start.
    fn pass(&mut self, collision: &Collision) {
        let (step, pairs) = &mut self.passed;
        if *step != collision.step {
            *step = collision.step;
            pairs.clear();
        }
        pairs.insert(collision.bodies);
    }

    fn matches(&self, collision: &Collision) -> bool {
        let names = || collision.bodies.map(|id| self.bodies.get(&id).map(|body| body.name.as_str()));
        let is_pair = |[a, b]: &[String; 2]| {
            let names = names();
            names == [Some(a.as_str()), Some(b)] || names == [Some(b.as_str()), Some(a)]
        };
        self.pair.is_none_or(is_pair)
    }
}

impl Observer for Search<'_> {
    fn collision(&mut self, collision: &Collision) {
        if !self.is_reached(collision) {
            return self.pass(collision);
        }
        let place = if collision.impulse != 0.0 { &self.found } else { &self.without_impulse };
        if place.is_none() && self.matches(collision) {
            let place = if collision.impulse != 0.0 { &mut self.found } else { &mut self.without_impulse };
            *place = Some(collision.clone());
        }
    }
}

/// The largest impulse of a run, N·s.
pub fn max_impulse(source: &Source, progress: Progress) -> Result<f64, Error> {
    struct MaxImpulse(f64);
    impl Observer for MaxImpulse {
        fn collision(&mut self, collision: &Collision) {
            self.0 = larger(collision.impulse.abs(), self.0);
        }
    }
    let mut max = MaxImpulse(0.0);
    let steps = source.header.steps;
    let recording = source.recording()?;
    let replayer = Replayer::new(recording, ALL_STEPS);
    let verdict = replayer.and_then(|replayer| replayer.run(&mut max, |step| progress(step, steps)));
    verdict.map_err(|error| source.read_error(error))?;
    Ok(max.0)
}

/// Returns the moments of new collisions at which an animation with this schedule freezes, in order, found by a replay:
/// of several moments between two frames only the first, so their number is bounded by that of frames. The moments are
/// those of the schedule, whose rate may differ from that of the recording. A collision is new if its two bodies did
/// not collide in the previous step.
///
/// The event-driven solver gives exact instants; the handout's solver gives the state in which it
/// detected the collision.
///
/// # Errors
/// If the recording cannot be read.
pub fn freeze_frames(source: &Source, schedule: &AnimationSchedule, progress: Progress) -> Result<Vec<Moment>, Error> {
    let grid = &schedule.grid;
    let rate = source.header.config.rate;
    let own_step = |step: u64| Moment { step, offset: 0.0 }.at_rate(grid.rate, rate).step;
    let from = own_step(*grid.steps.start());
    let mut finder = FreezeFrameFinder {
        schedule,
        from,
        rate,
        step: 0,
        pairs: BTreeSet::new(),
        previous_pairs: BTreeSet::new(),
        last: None,
        moments: Vec::new(),
    };
    let last = own_step(*grid.steps.end());
    let recording = source.recording()?;
    // The collisions of the step before the first decide which ones of the first step are new.
    let replayer = Replayer::new(recording, from.saturating_sub(2)..=last);
    let verdict = replayer.and_then(|replayer| replayer.run(&mut finder, |step| progress(step, last)));
    verdict.map_err(|error| source.read_error(error))?;
    Ok(finder.moments)
}

struct FreezeFrameFinder<'a> {
    schedule: &'a AnimationSchedule,
    from: u64,
    /// Hz.
    rate: f64,
    /// The step of the last collision.
    step: u64,
    /// The pairs that collided in that step.
    pairs: BTreeSet<[BodyId; 2]>,
    /// The pairs that collided in the step before it.
    previous_pairs: BTreeSet<[BodyId; 2]>,
    /// The frame before the last moment.
    last: Option<u64>,
    moments: Vec<Moment>,
}

impl Observer for FreezeFrameFinder<'_> {
    fn collision(&mut self, collision: &Collision) {
        if collision.impulse == 0.0 {
            return;
        }
        if collision.step != self.step {
            let pairs = std::mem::take(&mut self.pairs);
            self.previous_pairs = if collision.step == self.step + 1 { pairs } else { BTreeSet::new() };
            self.step = collision.step;
        }
        let moment = if collision.time * self.rate < 1.0 {
            Moment { step: collision.step, offset: collision.time }
        } else {
            Moment { step: collision.step + 1, offset: 0.0 }
        };
        let mut pair = collision.bodies;
        pair.sort_unstable();
        let is_new = !self.previous_pairs.contains(&pair) && self.pairs.insert(pair);
        let shown = moment.at_rate(self.rate, self.schedule.grid.rate);
        if is_new
            && moment.step >= self.from
            && let Some(frame) = self.schedule.grid_index(shown).filter(|frame| self.last != Some(*frame))
        {
            self.last = Some(frame);
            self.moments.push(shown);
        }
        self.pairs.insert(pair);
    }
}
