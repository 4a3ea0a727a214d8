use super::frames::{ReadExtent, ReadStatus};
use super::{Error, Source, source};
use crate::figure::EnergySample;
use crate::physics::{Body, EngineConfig, Material, Vector, World, invariants};
use crate::recording::{Playback, SampledBody, SampledState};
use crate::render::StepGrid;

/// Energy and momentum of the recorded states on `grid`, and the health of the recording.
pub fn energies(source: &Source, grid: &StepGrid) -> Result<(Vec<EnergySample>, ReadStatus), Error> {
    let mut playback = Playback::new(source::open(&source.path)?);
    playback.seek(*grid.steps.start()).map_err(|error| source.read_error(error))?;
    let config = &source.header.config;
    let mut samples = Vec::new();
    let mut extent = ReadExtent::End;
    for state in playback.by_ref() {
        let state = state.map_err(|error| source.read_error(error))?;
        if state.step > *grid.steps.end() {
            extent = ReadExtent::LastStep;
            break;
        }
        if grid.contains(state.step) {
            samples.push(energy(&state, config));
        }
    }
    Ok((samples, ReadStatus { path: source.path.clone(), health: playback.health(), extent }))
}

fn energy(state: &SampledState, config: &EngineConfig) -> EnergySample {
    let bodies = state.bodies.iter().map(body).collect();
    let world = World { bodies, gravity: config.gravity, restitution: config.restitution.clone() };
    EnergySample {
        time: state.time,
        kinetic: invariants::kinetic_energy(&world),
        potential: invariants::potential_energy(&world),
        momentum: invariants::momentum(&world),
    }
}

/// The recorded body as a body of the physics module, as far as energy and momentum depend on it.
fn body(recorded: &SampledBody) -> Body {
    let spawn = &recorded.info.spawn;
    let mut rect = spawn.rect;
    rect.origin = recorded.position;
    Body {
        id: recorded.info.id,
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
