//! Serialization of the solver's state as two flat lists.
//!
//! - Integers: [`LAYOUT_VERSION`]; the number of bodies; for each body and axis 1 if a body of its component carries
//!   a force of its own, otherwise 0; the number of contacts; for each contact the bodies on its low and high
//!   side and the axis (0 for x, 1 for y); the number of pending spawns, and these bodies; the same for
//!   pending wakes.
//! - Numbers: the high and low part of the present instant; for each body and axis position, velocity,
//!   acceleration and reference instant, then the low parts of the same four, then the low part of the size.
//!
//! Bodies are identified by their index in the world.

use super::EventDriven;
use super::axis_trajectory::{AxisLowParts, AxisTrajectory};
use super::body_state::{Load, Slot};
use super::instant::Instant;
use crate::physics::{Axis, Side, SnapshotError, SolverSnapshot, World};

/// The version of the layout of the lists.
const LAYOUT_VERSION: u64 = 3;

impl EventDriven {
    /// Returns all state that [`EventDriven::restore`] needs besides the world, at the start of `step`.
    pub fn snapshot(&self, step: u64) -> SolverSnapshot {
        let mut snapshot = SolverSnapshot::default();
        let alive: Vec<Slot> = self.bodies.alive().collect();
        snapshot.integers.extend([LAYOUT_VERSION, alive.len() as u64]);
        let now = self.timeline.now_in(step);
        snapshot.numbers.extend([now.high, now.low]);
        let mut contacts: Vec<[u64; 3]> = Vec::new();
        let mut world_indices = vec![0; self.bodies.len()];
        for (index, slot) in alive.iter().enumerate() {
            world_indices[*slot as usize] = index as u64;
        }
        for slot in alive {
            let state = &self.bodies[slot];
            for axis in Axis::BOTH {
                let trajectory = state.trajectory.along(axis);
                let since = trajectory.since;
                let low = self.bodies.low_parts(slot, axis);
                snapshot.integers.push(u64::from(state.load[axis] == Load::OwnForces));
                snapshot.numbers.extend([
                    trajectory.position,
                    trajectory.velocity,
                    trajectory.acceleration,
                    since.high,
                ]);
                snapshot.numbers.extend([low.position, low.velocity, low.acceleration, since.low, low.size]);
            }
            contacts.extend(self.stored_contacts(slot, &world_indices));
        }
        snapshot.integers.push(contacts.len() as u64);
        snapshot.integers.extend(contacts.iter().flatten());
        for pending in [&self.pending_spawns, &self.pending_wakes] {
            let pending = pending.iter().filter(|slot| self.bodies.params(**slot).alive);
            snapshot.integers.push(pending.clone().count() as u64);
            snapshot.integers.extend(pending.map(|slot| world_indices[*slot as usize]));
        }
        snapshot
    }

    /// The contacts to store with a body, sorted. Each contact is stored with one of its bodies: the one on
    /// the low side, or the one of finite mass. `world_indices` are the indices of the bodies in the world, by slot.
    fn stored_contacts(&self, slot: Slot, world_indices: &[u64]) -> Vec<[u64; 3]> {
        let mut contacts: Vec<[u64; 3]> = Vec::new();
        for contact in self.contacts.of(slot) {
            let [own, other] = [slot, contact.other].map(|slot| world_indices[slot as usize]);
            let pair = match contact.side {
                Side::High => [own, other],
                Side::Low => [other, own],
            };
            if contact.side == Side::High || self.bodies[contact.other].infinite {
                contacts.push([pair[0], pair[1], contact.axis as u64]);
            }
        }
        contacts.sort_unstable();
        contacts
    }

    /// Restores the state stored in `snapshot`.
    ///
    /// # Errors
    /// Returns an error if the snapshot was created by another solver, does not fit the world, or is damaged.
    pub fn restore(&mut self, world: &World, step: u64, snapshot: &SolverSnapshot) -> Result<(), SnapshotError> {
        self.deserialize(world, step, snapshot).map_err(|reason| SnapshotError { step, reason })
    }

    /// Like [`EventDriven::restore`]; the error is the reason alone.
    pub(super) fn deserialize(&mut self, world: &World, step: u64, snapshot: &SolverSnapshot) -> Result<(), String> {
        let mut reader = SnapshotReader { integers: &snapshot.integers, numbers: &snapshot.numbers };
        if reader.integer()? != LAYOUT_VERSION {
            return Err("this version of rebond does not support its layout".to_owned());
        }
        if reader.integer()? != world.bodies.len() as u64 {
            return Err(format!("its number of bodies is not {}", world.bodies.len()));
        }
        let now = Instant { high: reader.number()?, low: reader.number()? };
        self.clear();
        for (index, body) in world.bodies.iter().enumerate() {
            let slot = self.push_body(body, index, now);
            for axis in Axis::BOTH {
                let load = reader.load()?;
                let (trajectory, low_parts) = reader.trajectory(now)?;
                self.bodies.restore(slot, axis, trajectory, low_parts, load);
            }
        }
        self.restore_contacts(&mut reader)?;
        for pending in [&mut self.pending_spawns, &mut self.pending_wakes] {
            for _ in 0..reader.integer()? {
                pending.push(reader.slot(self.bodies.len())?);
            }
        }
        if !self.pending_spawns.is_sorted_by(|a, b| a < b) {
            return Err("its pending spawns are not in creation order, each once".to_owned());
        }
        let is_pending = |slot: &Slot| self.pending_spawns.binary_search(slot).is_ok();
        for slot in 0..self.bodies.len() as Slot {
            let mut pair = self.contacts.of(slot).iter().flat_map(|contact| [slot, contact.other]);
            if let Some(pending) = pair.find(is_pending) {
                return Err(format!("the pending spawn with index {pending} has contacts"));
            }
        }
        reader.end()?;
        self.event_limit.begin_step();
        self.timeline.restore(now, step);
        self.rebuild_derived_state();
        Ok(())
    }

    fn clear(&mut self) {
        self.bodies.clear();
        self.contacts = super::ContactGraph::default();
        self.pending_spawns.clear();
        self.pending_wakes.clear();
        self.dirty_states = super::DirtyStates::default();
        self.changed.clear();
    }

    fn restore_contacts(&mut self, reader: &mut SnapshotReader) -> Result<(), String> {
        let bodies = self.bodies.len();
        for _ in 0..reader.integer()? {
            let pair = [reader.slot(bodies)?, reader.slot(bodies)?];
            let axis = match reader.integer()? {
                0 => Axis::X,
                1 => Axis::Y,
                other => return Err(format!("the axis of a contact is {other}, not 0 or 1")),
            };
            if pair[0] == pair[1] || pair.iter().all(|slot| self.bodies[*slot].infinite) {
                return Err("a contact is between a body and itself or between infinite masses".to_owned());
            }
            if self.contacts.axes_between(pair)[axis] {
                return Err("a contact is listed twice".to_owned());
            }
            self.contacts.add(pair, axis);
        }
        Ok(())
    }

    /// Rebuilds the derived state, cell lists and event queue, from trajectories and contacts.
    fn rebuild_derived_state(&mut self) {
        self.rebuild_indices();
        self.changed =
            (0..self.bodies.len() as Slot).filter(|slot| self.pending_spawns.binary_search(slot).is_err()).collect();
        self.predict_changed();
    }
}

/// Reads the two lists value by value.
struct SnapshotReader<'a> {
    integers: &'a [u64],
    numbers: &'a [f64],
}

impl SnapshotReader<'_> {
    fn integer(&mut self) -> Result<u64, String> {
        let (first, rest) = self.integers.split_first().ok_or("it is too short")?;
        self.integers = rest;
        Ok(*first)
    }

    fn number(&mut self) -> Result<f64, String> {
        let (first, rest) = self.numbers.split_first().ok_or("it is too short")?;
        self.numbers = rest;
        if first.is_finite() { Ok(*first) } else { Err(format!("{first} is not a finite number")) }
    }

    /// A body by its index in the world; slots are dense after a restore, so the index is the slot.
    fn slot(&mut self, bodies: usize) -> Result<Slot, String> {
        let index = self.integer()?;
        if index < bodies as u64 { Ok(index as Slot) } else { Err(format!("it refers to a body with index {index}")) }
    }

    fn load(&mut self) -> Result<Load, String> {
        match self.integer()? {
            0 => Ok(Load::GravityOnly),
            1 => Ok(Load::OwnForces),
            other => Err(format!("a flag is {other}, not 0 or 1")),
        }
    }

    /// The high and low parts of a trajectory along an axis.
    fn trajectory(&mut self, now: Instant) -> Result<(AxisTrajectory, AxisLowParts), String> {
        let [position, velocity, acceleration, high] = [self.number()?, self.number()?, self.number()?, self.number()?];
        let low_parts = AxisLowParts {
            position: self.number()?,
            velocity: self.number()?,
            acceleration: self.number()?,
            size: 0.0,
        };
        let since = Instant { high, low: self.number()? };
        let size = self.number()?;
        // By rounding, a reference can be later than the clock, see `EventDriven::now_of`.
        if now.end_of_vicinity().is_before(since) {
            return Err(format!("the reference instant {high} s of a body is in the future"));
        }
        Ok((AxisTrajectory { position, velocity, acceleration, since }, AxisLowParts { size, ..low_parts }))
    }

    fn end(&self) -> Result<(), String> {
        if self.integers.is_empty() && self.numbers.is_empty() { Ok(()) } else { Err("it is too long".to_owned()) }
    }
}
