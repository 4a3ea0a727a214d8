//! The solver's state as flat lists, and back.
//!
//! Integers: [`LAYOUT`], the number of bodies; for each and axis its reference step
//! and its impacts in a row; the number of contacts; for each the places behind and ahead and
//! the axis; the number of bodies not yet admitted, and their places. Numbers: for each body
//! and axis position, velocity, acceleration and offset of the reference instant, then the
//! lower halves of the same four. Bodies by their place in the world.

use super::EventDriven;
use super::fine_state::Residue;
use super::instant::{Instant, LONGEST_ROUNDING};
use super::motion::Motion;
use super::mover::{AXES, Slot};
use crate::physics::{Memory, SnapshotError, World};

/// Names this layout; another one is another number.
const LAYOUT: u64 = 2;

impl EventDriven {
    /// All that [`EventDriven::restore`] needs.
    pub fn memory(&self) -> Memory {
        let mut memory = Memory::default();
        let alive: Vec<usize> = (0..self.movers.len()).filter(|slot| self.traits[*slot].alive).collect();
        memory.integers.extend([LAYOUT, alive.len() as u64]);
        let mut contacts: Vec<[u64; 3]> = Vec::new();
        for slot in alive {
            let mover = &self.movers[slot];
            for axis in AXES {
                let motion = mover.motion.along(axis);
                memory.integers.extend([motion.since.step as u64, u64::from(mover.hurry[axis])]);
                memory.numbers.extend([motion.position, motion.velocity, motion.acceleration, motion.since.offset]);
                let residue = &self.residues[slot].0[axis];
                memory.numbers.extend([residue.position, residue.velocity, residue.acceleration, residue.offset]);
            }
            contacts.extend(self.contacts_of(slot));
        }
        memory.integers.push(contacts.len() as u64);
        memory.integers.extend(contacts.iter().flatten());
        memory.integers.push(self.fresh.len() as u64);
        memory.integers.extend(self.fresh.iter().map(|slot| self.place(*slot)));
        memory
    }

    fn place(&self, slot: Slot) -> u64 {
        u64::from(self.movers[slot as usize].place)
    }

    /// The contacts that this body has to report: each is reported once.
    fn contacts_of(&self, slot: usize) -> Vec<[u64; 3]> {
        let mut contacts: Vec<[u64; 3]> = Vec::new();
        for contact in self.contacts.of(slot as Slot) {
            let [own, other] = [slot as Slot, contact.other].map(|slot| self.place(slot));
            let pair = if contact.ahead { [own, other] } else { [other, own] };
            if contact.ahead || self.movers[contact.other as usize].infinite {
                contacts.push([pair[0], pair[1], contact.axis as u64]);
            }
        }
        contacts.sort_unstable();
        contacts
    }

    /// Takes up where [`EventDriven::memory`] was taken.
    ///
    /// # Errors
    /// When the memory is not one of this solver's.
    pub fn restore(&mut self, world: &World, step: u64, memory: &Memory) -> Result<(), SnapshotError> {
        self.take_up(world, step, memory).map_err(|what| SnapshotError { step, what })
    }

    pub(super) fn take_up(&mut self, world: &World, step: u64, memory: &Memory) -> Result<(), String> {
        let mut reader = Reader { integers: &memory.integers, numbers: &memory.numbers };
        if reader.integer()? != LAYOUT {
            return Err("its layout is not one this version knows".to_owned());
        }
        if reader.integer()? != world.bodies.len() as u64 {
            return Err(format!("it is not of {} bodies", world.bodies.len()));
        }
        self.clear();
        for (place, body) in world.bodies.iter().enumerate() {
            let slot = self.add(body, place, Instant::start_of(step));
            let mover = &mut self.movers[slot as usize];
            for axis in AXES {
                let (motion, hurry) = reader.motion(step)?;
                mover.motion.set(axis, motion);
                mover.hurry[axis] = hurry;
                self.residues[slot as usize].0[axis] = reader.residue()?;
            }
            mover.since = mover.motion.latest();
        }
        self.restore_contacts(&mut reader)?;
        for _ in 0..reader.integer()? {
            let place = reader.place(self.movers.len())?;
            self.fresh.push(place);
        }
        if !self.fresh.is_sorted() {
            return Err("its newcomers are out of order".to_owned());
        }
        reader.end()?;
        self.now = Instant::start_of(step);
        self.now_residue = 0.0;
        self.resume(step);
        Ok(())
    }

    fn clear(&mut self) {
        self.movers.clear();
        self.residues.clear();
        self.traits.clear();
        self.contacts = super::Contacts::default();
        self.forced = [0; 2];
        self.fresh.clear();
        self.moving = super::Moving::default();
        self.calendar = super::Calendar::new(0);
        self.changed.clear();
    }

    fn restore_contacts(&mut self, reader: &mut Reader) -> Result<(), String> {
        let bodies = self.movers.len();
        let mut touched = [Vec::new(), Vec::new()];
        for _ in 0..reader.integer()? {
            let pair = [reader.place(bodies)?, reader.place(bodies)?];
            let axis = match reader.integer()? {
                0 => 0,
                1 => 1,
                other => return Err(format!("{other} is no axis")),
            };
            if pair[0] == pair[1] || pair.iter().all(|slot| self.movers[*slot as usize].infinite) {
                return Err("a body cannot rest on itself, nor infinite masses on each other".to_owned());
            }
            self.contacts.join(&self.movers, pair, axis);
            touched[axis].extend(pair);
        }
        for axis in AXES {
            self.hold(axis, std::mem::take(&mut touched[axis]));
        }
        Ok(())
    }

    /// Derives everything else from motions and contacts.
    fn resume(&mut self, step: u64) {
        self.make(step);
        self.changed = (0..self.movers.len() as Slot).filter(|slot| self.fresh.binary_search(slot).is_err()).collect();
        self.predict_changed();
    }
}

/// Takes one value after another.
struct Reader<'a> {
    integers: &'a [u64],
    numbers: &'a [f64],
}

impl Reader<'_> {
    fn integer(&mut self) -> Result<u64, String> {
        let (first, rest) = self.integers.split_first().ok_or("it ends too early")?;
        self.integers = rest;
        Ok(*first)
    }

    fn number(&mut self) -> Result<f64, String> {
        let (first, rest) = self.numbers.split_first().ok_or("it ends too early")?;
        self.numbers = rest;
        if first.is_finite() { Ok(*first) } else { Err(format!("{first} is not a finite number")) }
    }

    fn place(&mut self, bodies: usize) -> Result<Slot, String> {
        let place = self.integer()?;
        if place < bodies as u64 { Ok(place as Slot) } else { Err(format!("there is no body at place {place}")) }
    }

    fn motion(&mut self, step: u64) -> Result<(Motion, u8), String> {
        let since = self.integer()?;
        let hurry = u8::try_from(self.integer()?).map_err(|_| "a body has too many impacts in a row")?;
        if since > step {
            return Err(format!("a body moves since step {since}, which is to come"));
        }
        let [position, velocity, acceleration, offset] =
            [self.number()?, self.number()?, self.number()?, self.number()?];
        if offset < -LONGEST_ROUNDING {
            return Err(format!("a step has no instant {offset} s"));
        }
        let since = Instant { step: since as f64, offset };
        Ok((Motion { position, velocity, acceleration, since }, hurry))
    }

    fn residue(&mut self) -> Result<Residue, String> {
        let [position, velocity, acceleration, offset] =
            [self.number()?, self.number()?, self.number()?, self.number()?];
        Ok(Residue { position, velocity, acceleration, offset })
    }

    fn end(&self) -> Result<(), String> {
        if self.integers.is_empty() && self.numbers.is_empty() { Ok(()) } else { Err("it is too long".to_owned()) }
    }
}
