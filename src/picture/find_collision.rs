use super::options::unknown_body;
use super::style::appearance;
use super::{CollisionSelector, Error, Progress, Source, source};
use crate::counted::counted;
use crate::figure::CollisionSubject;
use crate::physics::{BodyId, Collision, Engine, Observer};
use crate::recording::{Change, RecordedEvent};
use crate::render::Appearance;
use crate::replay::{Replayer, StateObserver, Verdict};
use std::{collections::BTreeMap, sync::Arc};

/// Finds the first collision with an impulse in or after `step`, between the bodies of `pair` if given,
/// by replaying the recording.
///
/// # Errors
/// If there is no such collision, or the recording cannot be read or diverges.
pub fn find_collision(
    source: &Source,
    step: u64,
    pair: Option<&[String; 2]>,
    progress: Progress,
) -> Result<CollisionSubject, Error> {
    let bodies = appearances(source)?;
    let mut search = Search { step, pair, bodies: &bodies, found: None };
    let steps = source.header.steps;
    let recording = source::open(&source.path)?;
    let mut replayer = Replayer::new(recording, step..=u64::MAX).map_err(|error| source.read_error(error))?;
    while search.found.is_none() {
        match replayer.advance(&mut search, &mut |step| progress(step, steps)) {
            Ok(None) => {}
            Ok(Some(verdict @ Verdict::Diverged(_))) => {
                return Err(Error::Diverged { path: source.path.clone(), verdict: Box::new(verdict) });
            }
            Ok(Some(Verdict::Same { .. } | Verdict::Truncated { .. } | Verdict::Corrupt { .. })) => break,
            Err(error) => return Err(source.read_error(error)),
        }
    }
    let found = search.found.and_then(|collision| {
        let [c, b] = collision.bodies.map(|id| bodies.get(&id).cloned());
        Some(CollisionSubject { title: String::new(), collision, bodies: [c?, b?] })
    });
    let missing = pair.into_iter().flatten().find(|&name| !source.summary.names.contains(name));
    if let Some(name) = missing {
        return Err(unknown_body(name, source));
    }
    found.ok_or_else(|| {
        let between = pair.map_or(String::new(), |[a, b]| format!(" between {a:?} and {b:?}"));
        let run = counted(steps, "step");
        Error::NothingToShow { reason: format!("no collision{between} in or after step {step}, in a run of {run}") }
    })
}

/// The selector that finds this collision again.
pub fn collision_selector(subject: &CollisionSubject) -> CollisionSelector {
    let [c, b] = &subject.bodies;
    CollisionSelector { step: subject.collision.step, pair: [c.name.clone(), b.name.clone()] }
}

/// The appearance of every body that is ever spawned.
pub fn appearances(source: &Source) -> Result<BTreeMap<BodyId, Arc<Appearance>>, Error> {
    let gravity = source.header.config.gravity;
    let mut bodies = BTreeMap::new();
    let add = |event: RecordedEvent| {
        if let Change::Spawn { id, spawn, color } = &event.change {
            bodies.insert(*id, Arc::new(appearance(*id, spawn, color.as_deref(), gravity)));
        }
    };
    source::open(&source.path)?.for_each_event(add).map_err(|error| source.read_error(error))?;
    Ok(bodies)
}

struct Search<'a> {
    step: u64,
    pair: Option<&'a [String; 2]>,
    bodies: &'a BTreeMap<BodyId, Arc<Appearance>>,
    found: Option<Collision>,
}

impl Search<'_> {
    fn matches(&self, collision: &Collision) -> bool {
        let names = || collision.bodies.map(|id| self.bodies.get(&id).map(|body| body.name.as_str()));
        let is_pair = |[a, b]: &[String; 2]| {
            let names = names();
            names == [Some(a.as_str()), Some(b)] || names == [Some(b.as_str()), Some(a)]
        };
        collision.step >= self.step && collision.impulse != 0.0 && self.pair.is_none_or(is_pair)
    }
}

impl Observer for Search<'_> {
    fn collision(&mut self, collision: &Collision) {
        if self.found.is_none() && self.matches(collision) {
            self.found = Some(collision.clone());
        }
    }
}

impl StateObserver for Search<'_> {
    fn state(&mut self, _: &Engine) {}
}
