//! What contacts do to accelerations, whenever contacts come or go.

use super::EventDriven;
use super::double_double::DoubleDouble;
use super::fine_state::FineState;
use super::least_change::{Group, least_change};
use super::mover::{AXES, Slot};

impl EventDriven {
    /// Enters a contact: the second body lies ahead of the first.
    pub(super) fn join(&mut self, pair: [Slot; 2], axis: usize) {
        self.contacts.join(&self.movers, pair, axis);
        self.loosened[axis].extend(pair);
    }

    /// Ends the contact of two bodies, along every axis.
    pub(super) fn unjoin(&mut self, slot: Slot, other: Slot) {
        let finite = if self.movers[slot as usize].infinite { other } else { slot };
        for contact in self.contacts.of(finite) {
            if contact.other == slot || contact.other == other {
                self.loosened[contact.axis].extend([slot, other]);
            }
        }
        self.contacts.part(slot, other);
        self.mark(slot);
        self.mark(other);
    }

    /// Two bodies in contact have slid past each other's edge.
    pub(super) fn part(&mut self, [first, second]: [Slot; 2]) {
        self.unjoin(first, second);
        self.settle();
    }

    /// A body is about to go: whatever rested on it wakes.
    pub(super) fn release(&mut self, slot: Slot) {
        let resting: Vec<Slot> = match self.movers[slot as usize].infinite {
            false => self.contacts.of(slot).iter().map(|contact| contact.other).collect(),
            true => (0..self.movers.len() as Slot)
                .filter(|other| *other != slot && self.contacts.between(*other, slot).is_some())
                .collect(),
        };
        for other in resting {
            self.unjoin(slot, other);
        }
        self.settle();
        self.changed.retain(|changed| *changed != slot);
        self.predict_changed();
    }

    /// Finds the accelerations after contacts came or went, and ends the contacts that part
    /// under them, until none does.
    pub(super) fn settle(&mut self) {
        while let Some(axis) = AXES.into_iter().find(|axis| !self.loosened[*axis].is_empty()) {
            let loosened = std::mem::take(&mut self.loosened[axis]);
            let mut affected = self.hold(axis, loosened);
            if self.forced[axis] > 0 {
                affected = self.contacts.group(&self.movers, &affected, axis);
                self.press(axis, &affected);
            } else {
                affected.sort_unstable();
                affected.dedup();
                self.support(axis, &affected);
            }
            self.part_separating(axis, &affected);
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
            self.accelerate(*slot, axis, if held { DoubleDouble::ZERO } else { gravity.into() });
        }
    }

    /// Accelerations where bodies carry forces of their own.
    fn press(&mut self, axis: usize, slots: &[Slot]) {
        if let [slot] = slots
            && self.movers[*slot as usize].held[axis] == [false; 2]
        {
            return self.accelerate(*slot, axis, self.traits[*slot as usize].free_fall[axis]);
        }
        let mut group = Group::default();
        for (index, slot) in slots.iter().enumerate() {
            let mover = &self.movers[*slot as usize];
            let traits = &self.traits[*slot as usize];
            group.add(traits.free_fall[axis].high, traits.mass, mover.held[axis]);
            for contact in self.contacts.of(*slot).iter().filter(|contact| contact.axis == axis && contact.ahead) {
                if let Ok(other) = slots.binary_search(&contact.other) {
                    group.order.push([index, other]);
                }
            }
        }
        for (slot, acceleration) in slots.iter().zip(least_change(&group)) {
            self.accelerate(*slot, axis, acceleration.into());
        }
    }

    fn accelerate(&mut self, slot: Slot, axis: usize, acceleration: DoubleDouble) {
        if self.acceleration(slot, axis) != acceleration {
            let state = self.fine(slot, axis);
            self.redirect(slot, axis, FineState { acceleration, ..state });
        }
    }

    /// Ends the contacts of these bodies whose partners accelerate apart.
    fn part_separating(&mut self, axis: usize, slots: &[Slot]) {
        for slot in slots {
            let own = self.movers[*slot as usize].motion.acceleration[axis];
            for contact in self.contacts.of(*slot).to_vec() {
                let others = self.movers[contact.other as usize].motion.acceleration[axis];
                if contact.axis == axis && if contact.ahead { others > own } else { others < own } {
                    self.unjoin(*slot, contact.other);
                }
            }
        }
    }
}
