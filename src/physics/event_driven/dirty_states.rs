//! The bodies whose states must be written to the world at the end of a step.

use super::bodies::Bodies;
use super::body_state::{BodyState, NONE, Slot};
use super::instant::Instant;
use super::threads::Threads;
use super::trajectory::Trajectory;
use crate::physics::{Body, StepError, Vector, World};
use std::sync::atomic::{AtomicBool, Ordering};

/// From this number of bodies on, several threads write their states faster than one.
const MIN_SHARED: usize = 1 << 15;

/// The number of bodies whose states a thread then writes in one go.
const BODIES_PER_PART: usize = 4096;

/// The bodies whose states must be written at the end of the step: those in motion and those that came
/// to rest in the step.
#[derive(Clone, Debug, Default)]
pub struct DirtyStates {
    /// Bodies in motion.
    moving: Vec<Slot>,
    /// By slot, the index in `moving` or [`NONE`].
    moving_indices: Vec<u32>,
    /// Bodies that came to rest in this step.
    stopped: Vec<Slot>,
    /// By slot, true if the body is in `stopped`.
    has_stopped: Vec<bool>,
}

impl DirtyStates {
    /// Adds an entry for one more body.
    pub fn add_body(&mut self) {
        self.moving_indices.push(NONE);
        self.has_stopped.push(false);
    }

    /// Returns true if no state must be written.
    pub fn is_empty(&self) -> bool {
        self.moving.is_empty() && self.stopped.is_empty()
    }

    /// Updates the lists after a change of a body's trajectory.
    pub fn update(&mut self, slot: Slot, state: &BodyState) {
        if state.trajectory.is_at_rest() {
            self.remove_moving(slot);
            if !std::mem::replace(&mut self.has_stopped[slot as usize], true) {
                self.stopped.push(slot);
            }
        } else if self.moving_indices[slot as usize] == NONE {
            self.moving_indices[slot as usize] = self.moving.len() as u32;
            self.moving.push(slot);
        }
    }

    /// Reads the entry of a body; returns a number that depends on it.
    #[inline]
    pub fn read_ahead(&self, slot: Slot) -> u32 {
        self.moving_indices[slot as usize]
    }

    /// Removes a body from the lists.
    pub fn remove(&mut self, slot: Slot) {
        self.remove_moving(slot);
        self.stopped.retain(|stopped| *stopped != slot);
        self.has_stopped[slot as usize] = false;
    }

    /// Removes and returns the bodies that came to rest in this step.
    fn take_stopped(&mut self) -> Vec<Slot> {
        let stopped = std::mem::take(&mut self.stopped);
        stopped.iter().for_each(|slot| self.has_stopped[*slot as usize] = false);
        stopped
    }

    fn remove_moving(&mut self, slot: Slot) {
        let index = self.moving_indices[slot as usize];
        if index != NONE {
            self.moving.swap_remove(index as usize);
            if let Some(moved) = self.moving.get(index as usize) {
                self.moving_indices[*moved as usize] = index;
            }
            self.moving_indices[slot as usize] = NONE;
        }
    }
}

impl DirtyStates {
    /// Writes the states at the instant `end`, the end of `step`, to the world.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if a position or velocity is not finite.
    pub fn sample(
        &mut self,
        bodies: &Bodies,
        world: &mut World,
        step: u64,
        end: Instant,
        threads: Threads,
    ) -> Result<(), StepError> {
        let stopped = self.take_stopped();
        let are_slots_dense = bodies.len() == world.bodies.len();
        let do_most_move = are_slots_dense && stopped.is_empty() && 2 * self.moving.len() >= bodies.len();
        // Variants, so that unused fields are not read: memory access dominates the cost.
        let are_finite = match (bodies.are_free(), are_slots_dense) {
            (true, _) if do_most_move => {
                self.write_moving(bodies, world, threads, move |trajectory| trajectory.drifted(end))
            }
            (false, _) if do_most_move => {
                self.write_moving(bodies, world, threads, move |trajectory| trajectory.at(end))
            }
            (true, true) => {
                self.write_states(bodies, world, &stopped, |slot, _| slot, |trajectory| trajectory.drifted(end))
            }
            (true, false) => {
                self.write_states(bodies, world, &stopped, |_, index| *index, |trajectory| trajectory.drifted(end))
            }
            (false, true) => {
                self.write_states(bodies, world, &stopped, |slot, _| slot, |trajectory| trajectory.at(end))
            }
            (false, false) => {
                self.write_states(bodies, world, &stopped, |_, index| *index, |trajectory| trajectory.at(end))
            }
        };
        if are_finite {
            return Ok(());
        }
        match world.bodies.iter().find(|body| !has_finite_state(body)) {
            Some(body) => Err(StepError::NotFinite { step, body: body.name.clone() }),
            None => Ok(()),
        }
    }

    /// Writes the states of all bodies in motion in the order of their slots, which are their indices in the world;
    /// returns true if all numbers are certainly finite.
    fn write_moving(
        &self,
        bodies: &Bodies,
        world: &mut World,
        threads: Threads,
        state: impl Fn(&Trajectory) -> [[f64; 2]; 2] + Copy + Sync,
    ) -> bool {
        let are_finite = AtomicBool::new(true);
        let write_part = |((written, states), moving_indices): ((&mut [Body], &[BodyState]), &[u32])| {
            if !write_states_of_part(written, states, moving_indices, state) {
                are_finite.store(false, Ordering::Relaxed);
            }
        };
        if bodies.len() < MIN_SHARED {
            write_part(((&mut world.bodies, bodies.states()), &self.moving_indices));
        } else {
            let parts = world.bodies.chunks_mut(BODIES_PER_PART).zip(bodies.states().chunks(BODIES_PER_PART));
            threads.share(parts.zip(self.moving_indices.chunks(BODIES_PER_PART)), write_part);
        }
        are_finite.into_inner()
    }

    /// Writes the states of all bodies in motion or just stopped; returns true if all numbers are certainly
    /// finite. `index` maps the slot and the stored world index to the index in the world.
    fn write_states(
        &self,
        bodies: &Bodies,
        world: &mut World,
        stopped: &[Slot],
        index: impl Fn(u32, &u32) -> u32,
        state: impl Fn(&Trajectory) -> [[f64; 2]; 2],
    ) -> bool {
        let mut zero = [0.0; 2];
        for slots in [self.moving.as_slice(), stopped] {
            for slot in slots {
                let source = &bodies[*slot];
                let body = &mut world.bodies[index(*slot, &source.world_index) as usize];
                let [[x, y], [vx, vy]] = state(&source.trajectory);
                body.rect.origin = Vector::new(x, y);
                body.velocity = Vector::new(vx, vy);
                // 0 times a number that is not finite is NaN.
                zero = [zero[0] + 0.0 * (x + vx), zero[1] + 0.0 * (y + vy)];
            }
        }
        zero == [0.0; 2]
    }

    /// Returns the world at an instant of the present step. All events before it must have been processed.
    pub fn world_at(&self, bodies: &Bodies, world: &World, instant: Instant) -> World {
        let mut sampled = world.clone();
        // A body that has stopped can move again.
        for slot in self.moving.iter().chain(&self.stopped) {
            let source = &bodies[*slot];
            let body = &mut sampled.bodies[source.world_index as usize];
            let [[x, y], [vx, vy]] = source.trajectory.at(instant);
            body.rect.origin = Vector::new(x, y);
            body.velocity = Vector::new(vx, vy);
        }
        sampled
    }
}

/// Writes the states of the bodies in motion among those of consecutive slots, given their indices in
/// [`DirtyStates::moving`]; returns true if all numbers are certainly finite.
///
/// Not inlined, since the compiler knows the alignment of records that are arguments; with the plain sum, that saves a
/// gas of 10³ boxes 1.5 % of its instructions.
#[inline(never)]
fn write_states_of_part(
    written: &mut [Body],
    states: &[BodyState],
    moving_indices: &[u32],
    state: impl Fn(&Trajectory) -> [[f64; 2]; 2],
) -> bool {
    // Not finite if one of its terms is not.
    let mut sum = [0.0; 2];
    for ((body, source), index) in written.iter_mut().zip(states).zip(moving_indices) {
        if *index != NONE {
            let [[x, y], [vx, vy]] = state(&source.trajectory);
            body.rect.origin = Vector::new(x, y);
            body.velocity = Vector::new(vx, vy);
            sum = [sum[0] + (x + vx), sum[1] + (y + vy)];
        }
    }
    sum[0].is_finite() & sum[1].is_finite()
}

fn has_finite_state(body: &Body) -> bool {
    body.rect.origin.is_finite() && body.velocity.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Engine, EngineConfig, Event, Rect, SolverKind, Spawn};
    use std::num::NonZero;

    /// The solver's bodies, their lists and the world of boxes of which one in five is at rest.
    fn boxes(count: usize, last_speed: f64) -> (Bodies, DirtyStates, World) {
        let mut engine = Engine::new(EngineConfig::new(SolverKind::Handout, 60.0));
        let (mut bodies, mut states) = (Bodies::new([0.0; 2]), DirtyStates::default());
        for index in 0..count {
            let number = index as f64;
            let speed = if index + 1 == count { last_speed } else { 1.0 / (number + 3.0) };
            engine.apply(&Event::Spawn(Spawn {
                name: String::new(),
                rect: Rect::new(Vector::new(number, 0.0), 1.0, 1.0),
                mass: 1.0,
                velocity: Vector::new(0.0, if index % 5 == 0 { 0.0 } else { speed }),
                force: Vector::ZERO,
                material: String::new(),
            }));
            let slot = bodies.push(&engine.world().bodies[index], index, Instant::START);
            states.add_body();
            states.update(slot, &bodies[slot]);
        }
        states.take_stopped();
        (bodies, states, engine.world().clone())
    }

    #[test]
    fn several_threads_write_the_same_states_as_one() {
        let (bodies, mut states, world) = boxes(MIN_SHARED * 3 / 2, 1.0);
        assert!(states.moving.len() > MIN_SHARED);
        let mut sampled = |threads: u32| {
            let (mut world, end) = (world.clone(), Instant { high: 0.1, low: 0.0 });
            states.sample(&bodies, &mut world, 0, end, Threads::new(NonZero::new(threads))).unwrap();
            world.bodies
        };
        let expected = sampled(1);
        assert!(expected != world.bodies && sampled(3) == expected);
    }

    #[test]
    fn a_number_that_is_not_finite_is_found_with_any_number_of_threads() {
        for (count, threads) in [(7, 1), (MIN_SHARED * 3 / 2 + 3, 3)] {
            let (bodies, mut states, mut world) = boxes(count, 1e300);
            let end = Instant { high: 1e10, low: 0.0 };
            let result = states.sample(&bodies, &mut world, 4, end, Threads::new(NonZero::new(threads)));
            assert_eq!(result, Err(StepError::NotFinite { step: 4, body: String::new() }));
        }
    }
}
