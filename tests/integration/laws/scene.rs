//! A scene of a law, its transformations, and its runs.

use super::run::{Run, State};
use crate::world_builder::{BodySpec, INFINITE};
use rebond::internals::physics::{
    AccuracyProbe, BodyId, Collision, Engine, EngineConfig, Event, Rect, Restitution, RestitutionPair, SolverKind,
    Spawn, Vector,
};

/// A body and the step at which it is spawned.
#[derive(Clone, Debug)]
pub struct SceneBody {
    /// Identifies the body in every transformation of the scene.
    pub label: usize,
    pub spec: BodySpec,
    pub material: &'static str,
    pub step: u64,
}

/// Bodies in the order of their creation, and the conditions of their world.
#[derive(Clone, Debug)]
pub struct Scene {
    pub kind: &'static str,
    pub seed: u64,
    pub rate: f64,
    pub steps: u64,
    pub gravity: [f64; 2],
    pub restitution: f64,
    pub pairs: Vec<([&'static str; 2], f64)>,
    /// Sorted by step, so that the id of a body is its index.
    pub bodies: Vec<SceneBody>,
    /// Steps and labels.
    pub deletes: Vec<(u64, usize)>,
    /// True if coordinates and velocities are multiples of an eighth, so that they can be mirrored and moved exactly.
    pub is_dyadic: bool,
}

impl Scene {
    pub fn config(&self) -> EngineConfig {
        let pair = |(materials, restitution): &([&str; 2], f64)| RestitutionPair {
            materials: materials.map(str::to_owned),
            restitution: *restitution,
        };
        let pairs: Vec<_> = self.pairs.iter().map(pair).collect();
        EngineConfig::new(SolverKind::EventDriven, self.rate)
            .with_gravity((self.gravity != [0.0; 2]).then(|| vector(self.gravity)))
            .with_restitution(Restitution::new(self.restitution, &pairs))
            .with_events_per_step(100_000)
    }

    /// Runs the scene to its end, or to an error.
    pub fn run(&self) -> Run {
        self.run_with(|_| {})
    }

    /// Runs the scene; `between` receives the engine at each step, after its deletes and spawns.
    pub fn run_with(&self, mut between: impl FnMut(&mut Engine)) -> Run {
        let mut engine = Engine::new(self.config());
        engine.assert_invariants();
        let mut run = Run::default();
        for step in 0..=self.steps {
            if step > 0 {
                let mut collisions: Vec<Collision> = Vec::new();
                let result = engine.step(&mut collisions);
                run.collisions.extend(collisions);
                if let Err(error) = result {
                    run.error = Some(error.to_string());
                    break;
                }
            }
            self.apply_events(step, |event| engine.apply(event));
            between(&mut engine);
            let states = engine.world().bodies.iter().map(|body| State {
                id: body.id as usize,
                at: [body.rect.origin.x, body.rect.origin.y],
                velocity: [body.velocity.x, body.velocity.y],
            });
            run.states.push(states.collect());
        }
        run
    }

    /// The last step up to which rounding and the resolution of positions cannot have changed the run.
    pub fn horizon(&self) -> u64 {
        let mut engine = Engine::new(self.config());
        let mut probe = AccuracyProbe::new(&engine).expect("the event-driven solver");
        for step in 0..=self.steps {
            if step > 0 {
                let result = engine.step(&mut probe);
                probe.follow(&engine);
                if result.is_err() {
                    break;
                }
            }
            self.apply_events(step, |event| {
                engine.apply(event);
                probe.apply(event);
            });
        }
        probe.accuracy().until.unwrap_or(self.steps)
    }

    /// Runs the scene until it has more collisions.
    pub fn has_more_collisions_than(&self, most: usize) -> bool {
        let mut engine = Engine::new(self.config().with_events_per_step(4 * most as u64));
        engine.assert_invariants();
        let mut collisions: Vec<Collision> = Vec::new();
        self.apply_events(0, |event| engine.apply(event));
        (1..=self.steps).any(|step| {
            // An error of the run is the business of the law.
            let is_stopped = engine.step(&mut collisions).is_err_and(|error| error.to_string().contains("more than"));
            self.apply_events(step, |event| engine.apply(event));
            is_stopped || collisions.len() > most
        })
    }

    /// Passes the deletes and spawns of a step to `apply`.
    fn apply_events(&self, step: u64, mut apply: impl FnMut(&Event)) {
        for (_, label) in self.deletes.iter().filter(|(at, _)| *at == step) {
            let id = self.bodies.iter().position(|body| body.label == *label).expect("the label of a body");
            apply(&Event::Delete(id as BodyId));
        }
        for body in self.bodies.iter().filter(|body| body.step == step) {
            let BodySpec { at, size, mass, velocity, force } = body.spec;
            let rect = Rect::new(vector(at), size[0], size[1]);
            let spawn = Spawn::new(format!("b{}", body.label), rect, mass)
                .with_velocity(vector(velocity))
                .with_force(vector(force))
                .with_material(body.material);
            apply(&Event::Spawn(spawn));
        }
    }

    /// The coefficient of restitution of two bodies, given by their ids.
    pub fn restitution_of(&self, ids: [BodyId; 2]) -> f64 {
        let [a, b] = ids.map(|id| self.bodies[id as usize].material);
        let found = self.pairs.iter().find(|(pair, _)| *pair == [a, b] || *pair == [b, a]);
        found.map_or(self.restitution, |(_, restitution)| *restitution)
    }

    pub fn restitutions(&self) -> impl Iterator<Item = f64> {
        self.pairs.iter().map(|(_, restitution)| *restitution).chain([self.restitution])
    }

    /// The largest size, and the largest coordinate of a body of finite mass, m.
    pub fn extent(&self) -> f64 {
        let lengths = self.bodies.iter().flat_map(|body| {
            let at = if body.spec.mass == INFINITE { [0.0; 2] } else { body.spec.at };
            at.into_iter().chain(body.spec.size)
        });
        lengths.fold(0.0, |most, length| if length.abs() > most { length.abs() } else { most })
    }

    /// The greatest acceleration of gravity and the forces of bodies, m/s².
    pub fn acceleration(&self) -> f64 {
        let forces = self.bodies.iter().flat_map(|body| body.spec.force.map(|force| force.abs() / body.spec.mass));
        let gravity = self.gravity.map(f64::abs);
        forces.fold(0.0, |most, a| if a > most { a } else { most }) + gravity[0] + gravity[1]
    }

    /// Returns true if anything is spawned or deleted after the start.
    pub fn changes_in_motion(&self) -> bool {
        !self.deletes.is_empty() || self.bodies.iter().any(|body| body.step > 0)
    }

    /// Returns true if a body is spawned into another one. Such bodies are separated in the step after it.
    pub fn has_overlapping_spawns(&self) -> bool {
        let mut overlaps = false;
        if self.bodies.iter().any(|body| body.step > 0) {
            self.run_with(|engine| {
                let bodies = &engine.world().bodies;
                let new = |id: BodyId| self.bodies[id as usize].step == engine.current_step();
                overlaps |= bodies
                    .iter()
                    .filter(|a| new(a.id))
                    .any(|a| bodies.iter().any(|b| a.id != b.id && a.rect.overlaps(&b.rect)));
            });
        }
        overlaps
    }

    // Transformations.

    fn with_bodies(&self, change: impl Fn(&mut SceneBody)) -> Scene {
        let mut scene = self.clone();
        scene.bodies.iter_mut().for_each(change);
        scene
    }

    pub fn with_axes_exchanged(&self) -> Scene {
        let mut scene = self.with_bodies(|body| {
            let BodySpec { at, size, velocity, force, .. } = &mut body.spec;
            [at, size, velocity, force].into_iter().for_each(|pair| pair.swap(0, 1));
        });
        scene.gravity.swap(0, 1);
        scene
    }

    /// Multiplies all lengths, masses and times.
    pub fn scaled(&self, length: f64, mass: f64, time: f64) -> Scene {
        let acceleration = length / time / time;
        let mut scene = self.with_bodies(|body| {
            body.spec.at = body.spec.at.map(|x| x * length);
            body.spec.size = body.spec.size.map(|x| x * length);
            body.spec.velocity = body.spec.velocity.map(|v| v * (length / time));
            body.spec.force = body.spec.force.map(|f| f * mass * acceleration);
            body.spec.mass *= mass;
        });
        scene.rate /= time;
        scene.gravity = scene.gravity.map(|g| g * acceleration);
        scene
    }

    /// The same simulated time in `factor` times as many steps.
    pub fn at_rate_times(&self, factor: u64) -> Scene {
        let mut scene = self.with_bodies(|body| body.step *= factor);
        scene.rate *= factor as f64;
        scene.steps *= factor;
        scene.deletes.iter_mut().for_each(|(step, _)| *step *= factor);
        scene
    }

    /// The first label that no body has.
    pub fn next_label(&self) -> usize {
        self.bodies.iter().map(|body| body.label + 1).max().unwrap_or(0)
    }

    /// Adds bodies at step 0, before or after the others. Their labels begin at the next label.
    pub fn with_others(&self, others: &[BodySpec], come_first: bool) -> Scene {
        let first_label = self.next_label();
        let mut scene = self.clone();
        let others = others.iter().zip(first_label..);
        let others = others.map(|(spec, label)| SceneBody { label, spec: spec.clone(), material: "", step: 0 });
        let place = if come_first { 0 } else { scene.bodies.iter().take_while(|body| body.step == 0).count() };
        scene.bodies.splice(place..place, others);
        scene
    }

    /// Mirrors an axis at 0.
    pub fn mirrored(&self, axis: usize) -> Scene {
        let mut scene = self.with_bodies(|body| {
            body.spec.at[axis] = 0.0 - body.spec.at[axis] - body.spec.size[axis];
            body.spec.velocity[axis] = 0.0 - body.spec.velocity[axis];
            body.spec.force[axis] = 0.0 - body.spec.force[axis];
        });
        scene.gravity[axis] = 0.0 - scene.gravity[axis];
        scene
    }

    /// Adds a velocity to all bodies and moves them, m/s and m. Later spawns move with the others.
    pub fn moved(&self, by: [f64; 2], velocity: [f64; 2]) -> Scene {
        self.with_bodies(|body| {
            let time = body.step as f64 / self.rate;
            for k in 0..2 {
                body.spec.at[k] += by[k] + velocity[k] * time;
                body.spec.velocity[k] += velocity[k];
            }
        })
    }

    // Description.

    /// The scene as a file.
    pub fn toml(&self) -> String {
        let mut text = format!(
            "[world]\nsize = [16.0, 9.0]\ngravity = {:?}\n[run]\nrate = {:?}\nsteps = {}\nsolver = \"event-driven\"\n\
             [restitution]\ndefault = {:?}\n",
            self.gravity, self.rate, self.steps, self.restitution
        );
        for ([a, b], restitution) in &self.pairs {
            text += &format!("\"{a}/{b}\" = {restitution:?}\n");
        }
        for SceneBody { label, spec: BodySpec { at, size, mass, velocity, force }, material, step } in &self.bodies {
            text += &format!("[[spawn]]\nname = \"b{label}\"\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\n");
            text += &format!("velocity = {velocity:?}\nforce = {force:?}\nstep = {step}\n");
            if !material.is_empty() {
                text += &format!("material = \"{material}\"\n");
            }
        }
        for (step, label) in &self.deletes {
            text += &format!("[[delete]]\nstep = {step}\nname = \"b{label}\"\n");
        }
        text
    }

    /// Scenes that lack one body, event, force, velocity or material of this one, or its second half.
    pub fn simpler(&self) -> Vec<Scene> {
        let mut simpler = Vec::new();
        if self.steps > 1 {
            simpler.extend([self.steps / 2, self.steps - 1].map(|steps| Scene { steps, ..self.clone() }));
        }
        for index in 0..self.deletes.len() {
            let mut scene = self.clone();
            scene.deletes.remove(index);
            simpler.push(scene);
        }
        for index in (0..self.bodies.len()).rev() {
            let mut scene = self.clone();
            let label = scene.bodies.remove(index).label;
            scene.deletes.retain(|delete| delete.1 != label);
            simpler.push(scene);
            let changes: [fn(&mut SceneBody); 4] = [
                |body| body.spec.force = [0.0; 2],
                |body| body.spec.velocity = [0.0; 2],
                |body| body.material = "",
                |body| body.spec.mass = if body.spec.mass == INFINITE { INFINITE } else { 1.0 },
            ];
            for change in changes {
                let mut scene = self.clone();
                change(&mut scene.bodies[index]);
                if format!("{scene:?}") != format!("{self:?}") {
                    simpler.push(scene);
                }
            }
        }
        simpler
    }
}

pub fn vector([x, y]: [f64; 2]) -> Vector {
    Vector::new(x, y)
}
