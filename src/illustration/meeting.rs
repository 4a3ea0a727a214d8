use super::style::appearance;
use super::wish::unknown;
use super::{Encounter, Error, Progress, Source, source};
use crate::figure::Meeting;
use crate::physics::{BodyId, Collision, Engine, Observer};
use crate::recording::{Change, RecordedEvent};
use crate::render::Appearance;
use crate::replay::{Replaying, Verdict, Witness};
use std::{collections::BTreeMap, sync::Arc};

/// The first collision with an impulse from `step` on, between `pair` if one is named.
///
/// # Errors
/// When there is none, or the recording cannot be read.
pub fn meeting(source: &Source, step: u64, pair: Option<&[String; 2]>, progress: Progress) -> Result<Meeting, Error> {
    let bodies = appearances(source)?;
    let mut search = Search { step, pair, bodies: &bodies, found: None };
    let steps = source.header.steps;
    let recording = source::open(&source.path)?;
    let mut replaying = Replaying::new(recording, step..=u64::MAX).map_err(|error| source.unreadable(error))?;
    while search.found.is_none() {
        match replaying.advance(&mut search, &mut |step| progress(step, steps)) {
            Ok(None) => {}
            Ok(Some(verdict @ Verdict::Diverged(_))) => {
                return Err(Error::Diverged { path: source.path.clone(), verdict: Box::new(verdict) });
            }
            Ok(Some(Verdict::Same { .. } | Verdict::Truncated { .. } | Verdict::Corrupt { .. })) => break,
            Err(error) => return Err(source.unreadable(error)),
        }
    }
    let found = search.found.and_then(|collision| {
        let [c, b] = collision.bodies.map(|id| bodies.get(&id).cloned());
        Some(Meeting { title: String::new(), collision, bodies: [c?, b?] })
    });
    let missing = pair.into_iter().flatten().find(|&name| !source.survey.names.contains(name));
    if let Some(name) = missing {
        return Err(unknown(name, std::slice::from_ref(source)));
    }
    found.ok_or_else(|| {
        let between = pair.map_or(String::new(), |[a, b]| format!(" between {a:?} and {b:?}"));
        Error::Nothing { what: format!("no collision{between} from step {step} on, in a run of {steps} steps") }
    })
}

/// What finds that collision again.
pub fn encounter(meeting: &Meeting) -> Encounter {
    let [c, b] = &meeting.bodies;
    Encounter { step: meeting.collision.step, pair: [c.name.clone(), b.name.clone()] }
}

/// Every body that is ever spawned.
pub fn appearances(source: &Source) -> Result<BTreeMap<BodyId, Arc<Appearance>>, Error> {
    let gravity = source.header.settings.gravity;
    let mut bodies = BTreeMap::new();
    let take = |event: RecordedEvent| {
        if let Change::Spawn { id, spawn, color } = &event.change {
            bodies.insert(*id, Arc::new(appearance(*id, spawn, color.as_deref(), gravity)));
        }
    };
    source::open(&source.path)?.events(take).map_err(|error| source.unreadable(error))?;
    Ok(bodies)
}

struct Search<'a> {
    step: u64,
    pair: Option<&'a [String; 2]>,
    bodies: &'a BTreeMap<BodyId, Arc<Appearance>>,
    found: Option<Collision>,
}

impl Search<'_> {
    fn is_wanted(&self, collision: &Collision) -> bool {
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
        if self.found.is_none() && self.is_wanted(collision) {
            self.found = Some(collision.clone());
        }
    }
}

impl Witness for Search<'_> {
    fn state(&mut self, _: &Engine) {}
}
