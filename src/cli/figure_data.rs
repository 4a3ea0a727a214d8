//! What figures are made of, taken from a recording: one collision, or states.

use super::error::CommandError;
use super::export::{Reached, tell_damage};
use super::frames::{self, Frames};
use super::{Exit, replay};
use crate::figure::EnergySample;
use crate::physics::{Body, BodyId, Collision, Material, Observer, Settings, Vector, World, invariants};
use crate::recording::{self, Change, FrameBody, Item, Playback};
use crate::render::{Appearance, Frame, Sampling};
use crate::scene::Overlay;
use std::{collections::BTreeMap, path::Path, sync::Arc};

/// One collision and what its two bodies look like.
pub struct FoundCollision {
    /// As the replay's observer saw it.
    pub collision: Collision,
    /// Its bodies c and b.
    pub bodies: [Arc<Appearance>; 2],
}

/// The first collision with an impulse from `step` on, between `pair` if one is named.
pub fn collision(path: &Path, step: u64, pair: Option<&[String; 2]>) -> Result<FoundCollision, CommandError> {
    let bodies = appearances(path)?;
    let mut search = Search { step, pair, bodies: &bodies, found: None };
    replay::judge(path, 0..=u64::MAX, &mut search)?;
    let found = search.found.and_then(|collision| {
        let [c, b] = collision.bodies.map(|id| bodies.get(&id).cloned());
        Some(FoundCollision { collision, bodies: [c?, b?] })
    });
    found.ok_or_else(|| {
        let between = pair.map_or(String::new(), |[a, b]| format!(" between {a:?} and {b:?}"));
        CommandError::NoSuchStep { what: format!("no collision{between} from step {step} on") }
    })
}

/// Every body that is ever spawned.
fn appearances(path: &Path) -> Result<BTreeMap<BodyId, Arc<Appearance>>, CommandError> {
    let mut bodies = BTreeMap::new();
    for item in frames::open(path)? {
        if let Item::Event(event) = item.map_err(|error| CommandError::recording(path, error))?
            && let Change::Spawn { id, spawn, color } = &event.change
        {
            bodies.insert(*id, Arc::new(frames::appearance(*id, spawn, color.as_deref())));
        }
    }
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

/// The states that a sampling shows, and how the recording was found to be.
pub fn frames(path: &Path, sampling: &Sampling, show: &[Overlay]) -> Result<(Vec<Frame>, Exit), CommandError> {
    let mut frames = Frames::new(path, sampling.clone(), show)?;
    let shown: Vec<Frame> = frames.by_ref().collect::<Result<_, _>>()?;
    Ok((shown, frames.tell_damage()))
}

/// Energy and momentum of the states that a sampling shows, and how the recording was found to be.
pub fn energies(path: &Path, sampling: &Sampling) -> Result<(Vec<EnergySample>, Exit), CommandError> {
    let mut playback = Playback::new(frames::open(path)?);
    let settings = playback.header().settings.clone();
    let mut samples = Vec::new();
    let mut reached = Reached::End;
    for state in playback.by_ref() {
        let state = state.map_err(|error| CommandError::recording(path, error))?;
        if state.step > *sampling.steps.end() {
            reached = Reached::LastStep;
            break;
        }
        if sampling.shows(state.step) {
            samples.push(energy(&state, &settings));
        }
    }
    Ok((samples, tell_damage(path, &playback.health(), reached)))
}

fn energy(state: &recording::Frame, settings: &Settings) -> EnergySample {
    let bodies = state.bodies.iter().map(body).collect();
    let world = World { bodies, gravity: settings.gravity, restitution: settings.restitution.clone() };
    EnergySample {
        time: state.time,
        kinetic: invariants::kinetic_energy(&world),
        potential: invariants::potential_energy(&world),
        momentum: invariants::momentum(&world),
    }
}

/// A recorded body as the laws of mechanics see it.
fn body(recorded: &FrameBody) -> Body {
    let spawn = &recorded.known.spawn;
    let mut rect = spawn.rect;
    rect.origin = recorded.position;
    Body {
        id: recorded.known.id,
        name: String::new(),
        rect,
        mass: spawn.mass,
        inverse_mass: 1.0 / spawn.mass,
        velocity: recorded.velocity,
        force: Vector::ZERO,
        constant_force: spawn.force,
        material: Material::default(),
    }
}
