//! What contacts do to accelerations, whenever contacts come or go.

use super::EventDriven;
use super::least_change::{Group, least_change};
use super::mover::Slot;

impl EventDriven {
    /// Two bodies in contact have slid past each other's edge.
    pub(super) fn part(&mut self, [first, second]: [Slot; 2], axis: usize) {
        self.contacts.part(first, second);
        self.mark(first);
        self.mark(second);
        self.settle(axis, vec![first, second]);
    }

    /// A body is about to go: whatever rested on it wakes.
    pub(super) fn release(&mut self, slot: Slot) {
        let resting: Vec<(Slot, usize)> = match self.movers[slot as usize].infinite {
            false => self.contacts.of(slot).iter().map(|contact| (contact.other, contact.axis)).collect(),
            true => (0..self.movers.len() as Slot)
                .filter_map(|other| self.contacts.between(other, slot).map(|axis| (other, axis)))
                .collect(),
        };
        for (other, axis) in resting {
            self.contacts.part(slot, other);
            self.mark(other);
            self.settle(axis, vec![other]);
        }
        self.changed.retain(|changed| *changed != slot);
        self.predict_changed();
    }

    /// Finds the accelerations along an axis after the contacts of some bodies changed, and
    /// ends the contacts that part under them.
    pub(super) fn settle(&mut self, axis: usize, mut touched: Vec<Slot>) {
        while !touched.is_empty() {
            let mut affected = self.hold(axis, touched);
            if self.forced[axis] > 0 {
                affected = self.contacts.group(&self.movers, &affected, axis);
                self.press(axis, &affected);
            } else {
                affected.sort_unstable();
                affected.dedup();
                self.support(axis, &affected);
            }
            touched = self.part_separating(axis, &affected);
        }
    }

    /// Brings up to date who is held by an infinite mass; returns all finite bodies looked at.
    ///
    /// Contacts along an axis lead from lower to higher coordinates, never in a circle: so
    /// this ends, and nothing holds itself up.
    pub(super) fn hold(&mut self, axis: usize, mut open: Vec<Slot>) -> Vec<Slot> {
        let mut seen = Vec::new();
        while let Some(slot) = open.pop() {
            if self.movers[slot as usize].infinite {
                continue;
            }
            seen.push(slot);
            let held = [false, true].map(|ahead| self.contacts.holds(&self.movers, slot, axis, ahead));
            if held != self.movers[slot as usize].held[axis] {
                self.movers[slot as usize].held[axis] = held;
                let along = self.contacts.of(slot).iter().filter(|contact| contact.axis == axis);
                open.extend(along.map(|contact| contact.other));
            }
        }
        seen
    }

    /// Accelerations where gravity is the only force: what is held against it rests, all else
    /// falls.
    ///
    /// That is the solution of least change (see [`least_change`]) when all have the same
    /// free fall; no mass matters.
    fn support(&mut self, axis: usize, slots: &[Slot]) {
        let gravity = self.gravity[axis];
        for slot in slots {
            let mover = &self.movers[*slot as usize];
            let held = mover.held[axis][usize::from(gravity > 0.0)];
            self.accelerate(*slot, axis, if held { 0.0 } else { gravity });
        }
    }

    /// Accelerations where bodies carry forces of their own.
    fn press(&mut self, axis: usize, slots: &[Slot]) {
        let mut group = Group::default();
        for (index, slot) in slots.iter().enumerate() {
            let mover = &self.movers[*slot as usize];
            let traits = &self.traits[*slot as usize];
            group.add(traits.free_fall[axis], traits.mass, mover.held[axis]);
            for contact in self.contacts.of(*slot).iter().filter(|contact| contact.axis == axis && contact.ahead) {
                if let Ok(other) = slots.binary_search(&contact.other) {
                    group.order.push([index, other]);
                }
            }
        }
        for (slot, acceleration) in slots.iter().zip(least_change(&group)) {
            self.accelerate(*slot, axis, acceleration);
        }
    }

    fn accelerate(&mut self, slot: Slot, axis: usize, acceleration: f64) {
        let motion = self.movers[slot as usize].motion[axis];
        if motion.acceleration != acceleration {
            let (position, velocity) = motion.at(&self.clock, self.now);
            self.redirect(slot, axis, [position, velocity, acceleration]);
        }
    }

    /// Ends the contacts of these bodies whose partners accelerate apart.
    fn part_separating(&mut self, axis: usize, slots: &[Slot]) -> Vec<Slot> {
        let mut parted = Vec::new();
        for slot in slots {
            let own = self.movers[*slot as usize].motion[axis].acceleration;
            for contact in self.contacts.of(*slot).to_vec() {
                let others = self.movers[contact.other as usize].motion[axis].acceleration;
                if contact.axis == axis && if contact.ahead { others > own } else { others < own } {
                    self.contacts.part(*slot, contact.other);
                    self.mark(*slot);
                    self.mark(contact.other);
                    parted.extend([*slot, contact.other]);
                }
            }
        }
        parted
    }
}
