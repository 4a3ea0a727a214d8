//! What can be seen of the motions: the state at each step.

use super::EventDriven;
use super::instant::Instant;
use super::motions::Motions;
use super::mover::{Mover, Slot};
use crate::physics::{Body, StepError, Vector, World};

const NONE: u32 = u32::MAX;

/// The bodies whose state changes from step to step: only they are copied.
#[derive(Clone, Debug, Default)]
pub struct Moving {
    slots: Vec<Slot>,
    /// For each body its place in `slots`.
    places: Vec<u32>,
    /// Bodies that came to rest in this step: to be copied once more.
    stopped: Vec<Slot>,
    /// For each body whether it is among them.
    has_stopped: Vec<bool>,
}

impl Moving {
    /// Makes room for one more body.
    pub fn add_body(&mut self) {
        self.places.push(NONE);
        self.has_stopped.push(false);
    }

    /// Whether there is nothing to be copied.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty() && self.stopped.is_empty()
    }

    /// A body has a new motion.
    pub fn update(&mut self, slot: Slot, mover: &Mover) {
        if mover.motion.is_still() {
            self.remove(slot);
            if !std::mem::replace(&mut self.has_stopped[slot as usize], true) {
                self.stopped.push(slot);
            }
        } else if self.places[slot as usize] == NONE {
            self.places[slot as usize] = self.slots.len() as u32;
            self.slots.push(slot);
        }
    }

    /// A body is no more.
    pub fn forget(&mut self, slot: Slot) {
        self.remove(slot);
        self.stopped.retain(|stopped| *stopped != slot);
        self.has_stopped[slot as usize] = false;
    }

    /// Those who came to rest in this step, which is over.
    fn take_stopped(&mut self) -> Vec<Slot> {
        let stopped = std::mem::take(&mut self.stopped);
        stopped.iter().for_each(|slot| self.has_stopped[*slot as usize] = false);
        stopped
    }

    fn remove(&mut self, slot: Slot) {
        let place = self.places[slot as usize];
        if place != NONE {
            self.slots.swap_remove(place as usize);
            if let Some(moved) = self.slots.get(place as usize) {
                self.places[*moved as usize] = place;
            }
            self.places[slot as usize] = NONE;
        }
    }
}

impl EventDriven {
    /// Writes the state at the end of the step into the world.
    pub(super) fn sample(&mut self, world: &mut World, step: u64) -> Result<(), StepError> {
        let stopped = self.moving.take_stopped();
        let clock = self.clock;
        let end = Instant::start_of(step + 1);
        let gapless = self.movers.len() == world.bodies.len();
        // What is not needed is not even read: memory is what takes the time here.
        let are_finite = match (self.gravity == [0.0; 2] && self.forced == [0; 2], gapless) {
            (true, true) => self.write(world, &stopped, |slot, _| slot, |motion| motion.drifted(&clock, end)),
            (true, false) => self.write(world, &stopped, |_, place| *place, |motion| motion.drifted(&clock, end)),
            (false, true) => self.write(world, &stopped, |slot, _| slot, |motion| motion.at(&clock, end)),
            (false, false) => self.write(world, &stopped, |_, place| *place, |motion| motion.at(&clock, end)),
        };
        if are_finite {
            return Ok(());
        }
        match world.bodies.iter().find(|body| !has_finite_state(body)) {
            Some(body) => Err(StepError::NotFinite { step, body: body.name.clone() }),
            None => Ok(()),
        }
    }

    /// Writes the states of all bodies that move or just stopped where they are in the world, and
    /// says whether all numbers are surely finite.
    fn write(
        &self,
        world: &mut World,
        stopped: &[Slot],
        place: impl Fn(u32, &u32) -> u32,
        state: impl Fn(&Motions) -> [[f64; 2]; 2],
    ) -> bool {
        let mut nothing = 0.0;
        for slots in [self.moving.slots.as_slice(), stopped] {
            for slot in slots {
                let mover = &self.movers[*slot as usize];
                let body = &mut world.bodies[place(*slot, &mover.place) as usize];
                let [[x, y], [vx, vy]] = state(&mover.motion);
                body.rect.origin = Vector::new(x, y);
                body.velocity = Vector::new(vx, vy);
                // Nothing times a finite number is nothing.
                nothing += 0.0 * ((x + y) + (vx + vy));
            }
        }
        nothing == 0.0
    }

    /// The world at an instant of the present step: nothing is due before it any more.
    pub(super) fn seen_at(&self, world: &World, instant: Instant) -> World {
        let mut seen = world.clone();
        for slot in &self.moving.slots {
            let mover = &self.movers[*slot as usize];
            let body = &mut seen.bodies[mover.place as usize];
            let [[x, y], [vx, vy]] = mover.motion.at(&self.clock, instant);
            body.rect.origin = Vector::new(x, y);
            body.velocity = Vector::new(vx, vy);
        }
        for slot in &self.moving.stopped {
            let mover = &self.movers[*slot as usize];
            let body = &mut seen.bodies[mover.place as usize];
            body.rect.origin = Vector::new(mover.motion.position[0], mover.motion.position[1]);
            body.velocity = Vector::ZERO;
        }
        seen
    }
}

fn has_finite_state(body: &Body) -> bool {
    body.rect.origin.is_finite() && body.velocity.is_finite()
}
