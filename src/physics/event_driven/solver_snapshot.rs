//! Serialization of the solver's state as two flat lists.
//!
//! - Integers: [`LAYOUT_VERSION`]; the number of bodies; for each body and axis the reference step and
//!   the collapse count; the number of contacts; for each contact the bodies on its low and high side
//!   and the axis (0 for x, 1 for y); the number of pending spawns, and these bodies.
//! - Numbers: for each body and axis position, velocity, acceleration and offset of the reference
//!   instant, then the low parts of the same four.
//!
//! Bodies are identified by their index in the world.

use super::EventDriven;
use super::axis_trajectory::AxisTrajectory;
use super::body_state::Slot;
use super::instant::{Instant, MAX_TIME_ROUNDING};
use super::state_dd::AxisLowParts;
use crate::physics::{Axis, Side, SnapshotError, SolverSnapshot, World};

/// The version of the layout of the lists.
const LAYOUT_VERSION: u64 = 2;

impl EventDriven {
    /// Returns all state that [`EventDriven::restore`] needs besides the world.
    pub fn snapshot(&self) -> SolverSnapshot {
        let mut snapshot = SolverSnapshot::default();
        let alive: Vec<usize> = (0..self.states.len()).filter(|slot| self.params[*slot].alive).collect();
        snapshot.integers.extend([LAYOUT_VERSION, alive.len() as u64]);
        let mut contacts: Vec<[u64; 3]> = Vec::new();
        for slot in alive {
            let state = &self.states[slot];
            for axis in Axis::BOTH {
                let trajectory = state.trajectory.along(axis);
                snapshot.integers.extend([trajectory.since.step as u64, u64::from(state.collapse_count[axis])]);
                snapshot.numbers.extend([
                    trajectory.position,
                    trajectory.velocity,
                    trajectory.acceleration,
                    trajectory.since.offset,
                ]);
                let low = &self.low_parts[slot].0[axis];
                snapshot.numbers.extend([low.position, low.velocity, low.acceleration, low.offset]);
            }
            contacts.extend(self.stored_contacts(slot));
        }
        snapshot.integers.push(contacts.len() as u64);
        snapshot.integers.extend(contacts.iter().flatten());
        snapshot.integers.push(self.pending_spawns.len() as u64);
        snapshot.integers.extend(self.pending_spawns.iter().map(|slot| self.world_index(*slot)));
        snapshot
    }

    fn world_index(&self, slot: Slot) -> u64 {
        u64::from(self.states[slot as usize].world_index)
    }

    /// The contacts to store with a body, sorted. Each contact is stored with one of its bodies: the one on
    /// the low side, or the one of finite mass.
    fn stored_contacts(&self, slot: usize) -> Vec<[u64; 3]> {
        let mut contacts: Vec<[u64; 3]> = Vec::new();
        for contact in self.contacts.of(slot as Slot) {
            let [own, other] = [slot as Slot, contact.other].map(|slot| self.world_index(slot));
            let pair = match contact.side {
                Side::High => [own, other],
                Side::Low => [other, own],
            };
            if contact.side == Side::High || self.states[contact.other as usize].infinite {
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
        self.clear();
        for (index, body) in world.bodies.iter().enumerate() {
            let slot = self.push_body(body, index, Instant::start_of(step));
            let state = &mut self.states[slot as usize];
            for axis in Axis::BOTH {
                let (trajectory, collapse_count) = reader.trajectory(step)?;
                state.trajectory.set(axis, trajectory);
                state.collapse_count[axis] = collapse_count;
                self.low_parts[slot as usize].0[axis] = reader.low_parts()?;
            }
            state.since = state.trajectory.latest();
        }
        self.restore_contacts(&mut reader)?;
        for _ in 0..reader.integer()? {
            let slot = reader.slot(self.states.len())?;
            self.pending_spawns.push(slot);
        }
        if !self.pending_spawns.is_sorted() {
            return Err("its pending spawns are not in creation order".to_owned());
        }
        reader.end()?;
        self.now = Instant::start_of(step);
        self.now_low = 0.0;
        self.rebuild_derived_state(step);
        Ok(())
    }

    fn clear(&mut self) {
        self.states.clear();
        self.low_parts.clear();
        self.params.clear();
        self.contacts = super::ContactGraph::default();
        self.force_counts = [0; 2];
        self.pending_spawns.clear();
        self.dirty_states = super::DirtyStates::default();
        self.crossing_wheel = super::CrossingWheel::new(0);
        self.changed.clear();
    }

    fn restore_contacts(&mut self, reader: &mut SnapshotReader) -> Result<(), String> {
        let bodies = self.states.len();
        let mut in_contact = [Vec::new(), Vec::new()];
        for _ in 0..reader.integer()? {
            let pair = [reader.slot(bodies)?, reader.slot(bodies)?];
            let axis = match reader.integer()? {
                0 => Axis::X,
                1 => Axis::Y,
                other => return Err(format!("the axis of a contact is {other}, not 0 or 1")),
            };
            if pair[0] == pair[1] || pair.iter().all(|slot| self.states[*slot as usize].infinite) {
                return Err("a contact is between a body and itself or between infinite masses".to_owned());
            }
            self.contacts.add(&self.states, pair, axis);
            in_contact[axis].extend(pair);
        }
        for axis in Axis::BOTH {
            self.update_supports(axis, std::mem::take(&mut in_contact[axis]));
        }
        Ok(())
    }

    /// Rebuilds the derived state, cell lists and event queue, from trajectories and contacts.
    fn rebuild_derived_state(&mut self, step: u64) {
        self.rebuild_indices(step);
        self.changed =
            (0..self.states.len() as Slot).filter(|slot| self.pending_spawns.binary_search(slot).is_err()).collect();
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

    /// The high parts of a trajectory along an axis and the collapse count.
    fn trajectory(&mut self, step: u64) -> Result<(AxisTrajectory, u8), String> {
        let since = self.integer()?;
        let collapse_count = u8::try_from(self.integer()?).map_err(|_| "a collapse count is too large")?;
        if since > step {
            return Err(format!("the reference step {since} of a body is in the future"));
        }
        let [position, velocity, acceleration, offset] =
            [self.number()?, self.number()?, self.number()?, self.number()?];
        if offset < -MAX_TIME_ROUNDING {
            return Err(format!("the offset {offset} s of a reference instant is negative"));
        }
        let since = Instant { step: since as f64, offset };
        Ok((AxisTrajectory { position, velocity, acceleration, since }, collapse_count))
    }

    fn low_parts(&mut self) -> Result<AxisLowParts, String> {
        let [position, velocity, acceleration, offset] =
            [self.number()?, self.number()?, self.number()?, self.number()?];
        Ok(AxisLowParts { position, velocity, acceleration, offset })
    }

    fn end(&self) -> Result<(), String> {
        if self.integers.is_empty() && self.numbers.is_empty() { Ok(()) } else { Err("it is too long".to_owned()) }
    }
}
