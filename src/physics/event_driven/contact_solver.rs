//! Solves the accelerations of bodies in contact whenever contacts begin or end.

use super::EventDriven;
use super::body_state::Slot;
use super::double_double::DoubleDouble;
use super::isotonic::{self, ContactGroup};
use super::state_dd::StateDd;
use crate::physics::{Axis, Side};

impl EventDriven {
    /// Adds a contact; the second body lies on the high side of the first.
    pub(super) fn add_contact(&mut self, pair: [Slot; 2], axis: Axis) {
        self.contacts.add(&self.states, pair, axis);
        self.dirty_contacts[axis].extend(pair);
    }

    /// Removes the contact of two bodies, along all axes.
    pub(super) fn remove_contact(&mut self, slot: Slot, other: Slot) {
        let finite = if self.states[slot as usize].infinite { other } else { slot };
        for contact in self.contacts.of(finite) {
            if contact.other == slot || contact.other == other {
                self.dirty_contacts[contact.axis].extend([slot, other]);
            }
        }
        self.contacts.remove(slot, other);
        self.invalidate(slot);
        self.invalidate(other);
    }

    /// Ends the contact of two bodies that have slid past each other's edge.
    pub(super) fn end_contact(&mut self, [first, second]: [Slot; 2]) {
        self.remove_contact(first, second);
        self.solve_contacts();
    }

    /// Removes all contacts of a body that is to be deleted, and updates the bodies that rested on it.
    pub(super) fn wake_dependents(&mut self, slot: Slot) {
        let resting: Vec<Slot> = match self.states[slot as usize].infinite {
            false => self.contacts.of(slot).iter().map(|contact| contact.other).collect(),
            true => (0..self.states.len() as Slot)
                .filter(|other| *other != slot && self.contacts.axis_between(*other, slot).is_some())
                .collect(),
        };
        for other in resting {
            self.remove_contact(slot, other);
        }
        self.solve_contacts();
        self.changed.retain(|changed| *changed != slot);
        self.predict_changed();
    }

    /// Solves the accelerations of all bodies whose contacts changed, and removes the contacts that
    /// separate under them, until none does.
    pub(super) fn solve_contacts(&mut self) {
        while let Some(axis) = Axis::BOTH.into_iter().find(|axis| !self.dirty_contacts[*axis].is_empty()) {
            let dirty = std::mem::take(&mut self.dirty_contacts[axis]);
            let mut affected = self.update_supports(axis, dirty);
            if self.force_counts[axis] > 0 {
                affected = self.contacts.connected_bodies(&self.states, &affected, axis);
                self.solve_isotonic(axis, &affected);
            } else {
                affected.sort_unstable();
                affected.dedup();
                self.solve_gravity_only(axis, &affected);
            }
            self.remove_separating_contacts(axis, &affected);
        }
    }

    /// Updates which bodies are supported by an infinite mass, starting at `dirty`; returns all visited
    /// bodies of finite mass.
    ///
    /// Contacts along an axis lead from lower to higher coordinates and form no cycle, so this
    /// terminates and no body supports itself.
    pub(super) fn update_supports(&mut self, axis: Axis, mut dirty: Vec<Slot>) -> Vec<Slot> {
        let mut visited = Vec::new();
        while let Some(slot) = dirty.pop() {
            if self.states[slot as usize].infinite {
                continue;
            }
            visited.push(slot);
            let supported = Side::BOTH.map(|side| self.contacts.is_supported(&self.states, slot, axis, side));
            if supported != self.states[slot as usize].supported[axis] {
                self.states[slot as usize].supported[axis] = supported;
                let along = self.contacts.of(slot).iter().filter(|contact| contact.axis == axis);
                dirty.extend(along.map(|contact| contact.other));
            }
        }
        visited
    }

    /// Solves the accelerations where gravity is the only force: bodies supported against it rest,
    /// all others fall.
    ///
    /// This is the solution of [`isotonic`] for equal free accelerations, whatever the masses.
    fn solve_gravity_only(&mut self, axis: Axis, slots: &[Slot]) {
        let gravity = self.gravity[axis];
        for slot in slots {
            let body = &self.states[*slot as usize];
            let supported = body.supported[axis][if gravity > 0.0 { Side::High } else { Side::Low }];
            self.set_acceleration(*slot, axis, if supported { DoubleDouble::ZERO } else { gravity.into() });
        }
    }

    /// Solves the accelerations where constant forces act on bodies, by isotonic regression.
    fn solve_isotonic(&mut self, axis: Axis, slots: &[Slot]) {
        if let [slot] = slots
            && self.states[*slot as usize].supported[axis] == [false; 2]
        {
            return self.set_acceleration(*slot, axis, self.params[*slot as usize].free_acceleration[axis]);
        }
        let mut group = ContactGroup::default();
        for (index, slot) in slots.iter().enumerate() {
            let body = &self.states[*slot as usize];
            let params = &self.params[*slot as usize];
            group.add(params.free_acceleration[axis].high, params.mass, body.supported[axis]);
            for contact in
                self.contacts.of(*slot).iter().filter(|contact| contact.axis == axis && contact.side == Side::High)
            {
                if let Ok(other) = slots.binary_search(&contact.other) {
                    group.contacts.push([index, other]);
                }
            }
        }
        for (slot, acceleration) in slots.iter().zip(isotonic::solve(&group)) {
            self.set_acceleration(*slot, axis, acceleration.into());
        }
    }

    /// Changes the acceleration of a body from the present instant on.
    fn set_acceleration(&mut self, slot: Slot, axis: Axis, acceleration: DoubleDouble) {
        if self.acceleration(slot, axis) != acceleration {
            let state = self.state_dd(slot, axis);
            self.set_trajectory(slot, axis, StateDd { acceleration, ..state });
        }
    }

    /// Removes the contacts of these bodies in which the two accelerations move the bodies apart.
    fn remove_separating_contacts(&mut self, axis: Axis, slots: &[Slot]) {
        for slot in slots {
            let own = self.states[*slot as usize].trajectory.acceleration[axis];
            for contact in self.contacts.of(*slot).to_vec() {
                let others = self.states[contact.other as usize].trajectory.acceleration[axis];
                let separates = match contact.side {
                    Side::High => others > own,
                    Side::Low => others < own,
                };
                if contact.axis == axis && separates {
                    self.remove_contact(*slot, contact.other);
                }
            }
        }
    }
}
