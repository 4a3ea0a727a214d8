use super::frames::{Condition, Reached};
use super::{Error, Source, source};
use crate::figure::EnergySample;
use crate::physics::{Body, Material, Settings, Vector, World, invariants};
use crate::recording::{Frame, FrameBody, Playback};
use crate::render::Sampling;

/// Energy and momentum of the states that a sampling shows, and how the recording was found to be.
pub fn energies(source: &Source, sampling: &Sampling) -> Result<(Vec<EnergySample>, Condition), Error> {
    let mut playback = Playback::new(source::open(&source.path)?);
    playback.seek(*sampling.steps.start()).map_err(|error| source.unreadable(error))?;
    let settings = &source.header.settings;
    let mut samples = Vec::new();
    let mut reached = Reached::End;
    for state in playback.by_ref() {
        let state = state.map_err(|error| source.unreadable(error))?;
        if state.step > *sampling.steps.end() {
            reached = Reached::LastStep;
            break;
        }
        if sampling.shows(state.step) {
            samples.push(energy(&state, settings));
        }
    }
    Ok((samples, Condition { path: source.path.clone(), health: playback.health(), reached }))
}

fn energy(state: &Frame, settings: &Settings) -> EnergySample {
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
