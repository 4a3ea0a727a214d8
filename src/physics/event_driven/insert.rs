//! Inserts spawned bodies into cell lists and event queue, and rebuilds both.

use super::EventDriven;
use super::body_state::Slot;
use super::cell_lists::CellLists;
use super::event_queue::EventQueue;
use super::pair_event::tolerance;
use crate::physics::{Axis, StepError, World};

impl EventDriven {
    /// Inserts the bodies spawned since the last step; returns the bodies whose contacts or accelerations may change
    /// with them.
    ///
    /// If the bodies have outgrown cell lists and event queue, or are few, both are rebuilt and all
    /// bodies predict again; likewise if a static body is spawned, which predicts nothing itself.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if gravity and the constant force on a body add up to an infinite acceleration.
    pub(super) fn insert_spawned(&mut self, world: &World) -> Result<Vec<Slot>, StepError> {
        if self.pending_spawns.is_empty() {
            return Ok(Vec::new());
        }
        let accelerates = |slot: &&Slot| {
            self.bodies.params(**slot).free_acceleration.iter().all(|acceleration| acceleration.high.is_finite())
        };
        if let Some(slot) = self.pending_spawns.iter().find(|slot| !accelerates(slot)) {
            return Err(StepError::NotFinite { step: self.timeline.step(), body: self.name_of(world, *slot) });
        }
        let spawned = std::mem::take(&mut self.pending_spawns);
        let is_outgrown =
            self.bodies.len() > 2 * self.indexed_bodies || self.bodies.len() > 2 * world.bodies.len() + 64;
        let spawned = if is_outgrown
            || self.cell_lists.uses_all_pairs()
            || spawned.iter().any(|slot| self.bodies[*slot].is_static())
        {
            self.pending_spawns = spawned;
            if self.bodies.len() > world.bodies.len() {
                self.compact(world);
            }
            let spawned = std::mem::take(&mut self.pending_spawns);
            self.rebuild_indices();
            self.changed.extend(self.bodies.alive());
            spawned
        } else {
            for slot in &spawned {
                self.cell_lists.insert(self.timeline.clock(), *slot, &self.bodies[*slot], self.timeline.now());
            }
            self.changed.extend(&spawned);
            spawned
        };
        let (touching, mut concerned) = self.separate_overlaps(&spawned);
        self.align_spawned(&spawned, &touching);
        concerned.extend(self.neighbours_of_infinite(&spawned));
        // A body that touches no other falls freely as it was spawned. To leave it out saves memory with many bodies.
        concerned.extend(touching);
        concerned.extend(spawned.into_iter().filter(|slot| self.bodies.params(*slot).has_force != [false; 2]));
        Ok(concerned)
    }

    /// The bodies of finite mass near spawned bodies of infinite mass.
    fn neighbours_of_infinite(&self, spawned: &[Slot]) -> Vec<Slot> {
        let mut found = Vec::new();
        for slot in spawned.iter().filter(|slot| self.bodies[**slot].infinite) {
            let state = &self.bodies[*slot];
            let low = state.trajectory.at(self.timeline.now())[0];
            let magnitude = state.trajectory.magnitude_at(self.timeline.now());
            let [from, to] = [-1.0, 1.0].map(|sign| {
                Axis::BOTH.map(|axis| {
                    let margin = 2.0 * tolerance(magnitude[axis] + state.size[axis]);
                    low[axis] + sign * margin + if sign > 0.0 { state.size[axis] } else { 0.0 }
                })
            });
            self.cell_lists.visit_region(from, to, |other| {
                let other_state = &self.bodies[other];
                let position = other_state.trajectory.at(self.timeline.now())[0];
                let magnitude = other_state.trajectory.magnitude_at(self.timeline.now());
                let is_near = Axis::BOTH.into_iter().all(|axis| {
                    let margin = 2.0 * tolerance(magnitude[axis] + other_state.size[axis]);
                    position[axis] - margin <= to[axis]
                        && position[axis] + other_state.size[axis] + margin >= from[axis]
                });
                if !other_state.infinite && is_near {
                    found.push(other);
                }
            });
        }
        found
    }

    /// Removes the slots of deleted bodies: in a restored snapshot the slots are consecutive.
    fn compact(&mut self, world: &World) {
        let snapshot = self.snapshot(self.timeline.step());
        self.deserialize(world, self.timeline.step(), &snapshot).expect("the snapshot was taken of this world");
    }

    /// Rebuilds cell lists and event queue for the present number and sizes of bodies.
    pub(super) fn rebuild_indices(&mut self) {
        self.window_lists.end(self.timeline.step());
        self.indexed_bodies = self.bodies.len();
        self.cell_lists = CellLists::new(self.bodies.largest_usual_size());
        self.event_queue = EventQueue::new(*self.timeline.clock(), self.timeline.step(), self.bodies.len());
        for slot in self.bodies.alive() {
            if self.pending_spawns.binary_search(&slot).is_err() {
                self.cell_lists.insert(self.timeline.clock(), slot, &self.bodies[slot], self.timeline.now());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::physics::event_driven::pseudo_random::PseudoRandom;
    use crate::physics::{
        Collision, Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, StepError, Vector,
    };

    /// A box of a random size on a coarse grid, so that many touch, or between its lines.
    fn random_spawn(random: &mut PseudoRandom) -> Spawn {
        let is_on_grid = random.next() < 0.7;
        let mut number = |from: f64, to: f64| {
            let number = random.between(from, to);
            if is_on_grid { (number * 2.0).floor() / 2.0 } else { number }
        };
        let [at, velocity, force] =
            [[0.0, 9.0], [-3.0, 3.0], [-3.0, 3.0]].map(|[from, to]| Vector::new(number(from, to), number(from, to)));
        let [width, height] = [random.pick(&[0.5, 1.0, 0.1]), random.pick(&[0.5, 1.0, 0.2])];
        let mass = random.pick(&[1.0, 1.0, 3.0, 1e3, f64::INFINITY]);
        let spawn = Spawn::new(String::new(), Rect::new(at, width, height), mass);
        let spawn = if random.next() < 0.5 { spawn.with_velocity(velocity) } else { spawn };
        if random.next() < 0.2 { spawn.with_force(force) } else { spawn }
    }

    /// All collisions, snapshots and errors of a random scene with spawns in every fifth step.
    fn run(seed: u32, examines_all: bool) -> Vec<String> {
        let random = &mut PseudoRandom(seed * 7919);
        let gravity = random.pick(&[None, Some(Vector::new(0.0, 9.81)), Some(Vector::new(2.0, -3.0))]);
        let restitution = Restitution::new(random.pick(&[1.0, 0.9, 0.5, 0.0]), &[]);
        let config = EngineConfig::new(SolverKind::EventDriven, 60.0).with_gravity(gravity);
        let mut engine = Engine::new(config.with_restitution(restitution).with_events_per_step(2000));
        engine.event_driven_mut().examines_all_spawned = examines_all;
        let mut record = Vec::new();
        let at_start = random.pick(&[2, 6, 20]);
        for step in 0..16 {
            let count = if step == 0 { at_start } else { 2 * u32::from(step % 5 == 0) };
            (0..count).for_each(|_| engine.apply(&Event::Spawn(random_spawn(random))));
            let mut collisions: Vec<Collision> = Vec::new();
            let result: Result<(), StepError> = engine.step(&mut collisions);
            record.push(format!("{collisions:?} {result:?} {:?}", engine.snapshot()));
        }
        record
    }

    #[test]
    fn spawned_bodies_that_touch_no_other_need_not_be_examined() {
        for seed in 0..if cfg!(debug_assertions) { 100 } else { 1000 } {
            for (one, other) in run(seed, false).iter().zip(run(seed, true)) {
                assert_eq!(*one, other, "seed {seed}");
            }
        }
    }
}
