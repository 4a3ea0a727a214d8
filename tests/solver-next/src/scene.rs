//! A small loader of scenes for tests and examples; not part of the merge.

use crate::physics::{
    Axis, Collision, Engine, EngineConfig, Event, Observer, Rect, Restitution, RestitutionPair, SolverKind, Spawn, StepError,
    Vector,
};
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Clone, Debug, Deserialize)]
pub struct Scene {
    #[serde(default)]
    pub world: WorldPart,
    pub run: Run,
    #[serde(default)]
    pub restitution: BTreeMap<String, f64>,
    #[serde(default)]
    pub spawn: Vec<SpawnPart>,
    #[serde(default)]
    pub delete: Vec<DeletePart>,
}

#[derive(Clone, Debug, Default, Deserialize)]
pub struct WorldPart {
    pub size: Option<[f64; 2]>,
    #[serde(default)]
    pub walls: bool,
    pub wall_material: Option<String>,
    pub gravity: Option<[f64; 2]>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Run {
    pub rate: Option<f64>,
    pub steps: Option<u64>,
    pub duration: Option<f64>,
    pub solver: Option<String>,
    pub events_per_step: Option<u64>,
}

#[derive(Clone, Debug, Default, Deserialize)]
pub struct SpawnPart {
    pub name: Option<String>,
    #[serde(default)]
    pub step: u64,
    pub at: [f64; 2],
    pub size: [f64; 2],
    pub mass: f64,
    #[serde(default)]
    pub velocity: [f64; 2],
    #[serde(default)]
    pub force: [f64; 2],
    pub material: Option<String>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct DeletePart {
    pub step: u64,
    pub name: String,
}

impl Scene {
    pub fn parse(text: &str) -> Scene {
        toml::from_str(text).expect("a scene")
    }

    pub fn rate(&self) -> f64 {
        self.run.rate.unwrap_or(60.0)
    }

    pub fn steps(&self) -> u64 {
        self.run.steps.unwrap_or_else(|| (self.run.duration.unwrap() * self.rate()).ceil() as u64)
    }

    pub fn config(&self) -> EngineConfig {
        let pairs: Vec<RestitutionPair> = self
            .restitution
            .iter()
            .filter_map(|(key, e)| {
                let (a, b) = key.split_once('/')?;
                Some(RestitutionPair { materials: [a.into(), b.into()], restitution: *e })
            })
            .collect();
        EngineConfig {
            solver: SolverKind::EventDriven,
            rate: self.rate(),
            gravity: self.world.gravity.map(|[x, y]| Vector::new(x, y)),
            restitution: Restitution::new(self.restitution.get("default").copied().unwrap_or(1.0), &pairs),
            events_per_step: self.run.events_per_step.unwrap_or(1_000_000),
        }
    }

    /// The walls, to be applied before everything else.
    pub fn walls(&self) -> Vec<Event> {
        if !self.world.walls {
            return Vec::new();
        }
        let [w, h] = self.world.size.unwrap_or([16.0, 9.0]);
        let material = self.world.wall_material.clone().unwrap_or_default();
        [
            ("wall-top", -1.0, -1.0, w + 2.0, 1.0),
            ("wall-bottom", -1.0, h, w + 2.0, 1.0),
            ("wall-left", -1.0, 0.0, 1.0, h),
            ("wall-right", w, 0.0, 1.0, h),
        ]
        .into_iter()
        .map(|(name, x, y, width, height)| {
            Event::Spawn(Spawn {
                name: name.into(),
                rect: Rect::new(Vector::new(x, y), width, height),
                mass: f64::INFINITY,
                velocity: Vector::ZERO,
                force: Vector::ZERO,
                material: material.clone(),
            })
        })
        .collect()
    }

    /// The event of the spawn with an index.
    pub fn spawn_event(&self, index: usize) -> Event {
        let part = &self.spawn[index];
        Event::Spawn(Spawn {
            name: part.name.clone().unwrap_or_else(|| format!("#{}", index + 1)),
            rect: Rect::new(Vector::new(part.at[0], part.at[1]), part.size[0], part.size[1]),
            mass: part.mass,
            velocity: Vector::new(part.velocity[0], part.velocity[1]),
            force: Vector::new(part.force[0], part.force[1]),
            material: part.material.clone().unwrap_or_default(),
        })
    }

    /// Applies the events of a step.
    pub fn apply(&self, engine: &mut Engine, step: u64) {
        if step == 0 {
            self.walls().iter().for_each(|event| engine.apply(event));
        }
        for delete in self.delete.iter().filter(|delete| delete.step == step) {
            let id = engine.world().bodies.iter().rev().find(|body| body.name == delete.name).map(|body| body.id);
            if let Some(id) = id {
                engine.apply(&Event::Delete(id));
            }
        }
        for (index, _) in self.spawn.iter().enumerate().filter(|(_, spawn)| spawn.step == step) {
            engine.apply(&self.spawn_event(index));
        }
    }

    /// Runs the scene; `sample` sees every state after the events of its step.
    pub fn run<O: Observer>(&self, observer: &mut O, mut sample: impl FnMut(&Engine)) -> Result<Engine, StepError> {
        let mut engine = Engine::new(self.config());
        for step in 0..=self.steps() {
            if step > 0 {
                engine.step(observer)?;
            }
            self.apply(&mut engine, step);
            sample(&engine);
        }
        Ok(engine)
    }
}

/// The text of a number with 17 significant digits, as Python's `{:.17g}` prints it.
pub fn digits17(number: f64) -> String {
    if number.is_infinite() {
        return if number > 0.0 { "inf".into() } else { "-inf".into() };
    }
    if number.is_nan() {
        return "nan".into();
    }
    if number == 0.0 {
        return if number.is_sign_negative() { "-0".into() } else { "0".into() };
    }
    let text = format!("{number:.16e}");
    let (mantissa, exponent) = text.split_once('e').unwrap();
    let exponent: i32 = exponent.parse().unwrap();
    let trim = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if (-4..17).contains(&exponent) {
        trim(&format!("{number:.*}", (16 - exponent) as usize))
    } else {
        let sign = if exponent < 0 { '-' } else { '+' };
        format!("{}e{sign}{:02}", trim(mantissa), exponent.abs())
    }
}

/// A line of the log of collisions: time, a, b, axis, vn before, vn after, impulse.
pub fn log_line(collision: &Collision, name: impl Fn(u32) -> String) -> String {
    let [a, b] = collision.bodies;
    let axis = if collision.axis == Axis::X { 'x' } else { 'y' };
    let [before, after] = collision.normal_velocity;
    format!(
        "{},{},{},{axis},{},{},{}",
        digits17(collision.instant),
        name(a),
        name(b),
        digits17(before),
        digits17(after),
        digits17(collision.impulse)
    )
}
