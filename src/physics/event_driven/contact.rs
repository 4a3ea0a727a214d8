//! The contact graph: a contact is stored, never derived from a gap.
//!
//! Along the axis of a contact both bodies have the same velocity. They stay together until an
//! acceleration or an impact separates them, or until one slides past the edge of the other. Bodies
//! that press on each other corner to corner are in contact along the axis of the gentler approach.

use super::body_state::{BodyState, Slot};
use crate::physics::{Axis, Side};

/// A contact as stored with one of its two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Contact {
    /// The other body.
    pub other: Slot,
    /// The axis of the contact normal.
    pub axis: Axis,
    /// The side on which the other lies.
    pub side: Side,
}

/// All contacts, stored with each of their bodies that has a finite mass, in creation order of the other body.
#[derive(Clone, Debug, Default)]
pub struct ContactGraph {
    /// By slot.
    of: Vec<Vec<Contact>>,
    /// The total number of entries; at 0, lookups read no memory.
    count: usize,
}

impl ContactGraph {
    /// Adds a body without contacts.
    pub fn add_body(&mut self) {
        self.of.push(Vec::new());
    }

    /// The contacts of a body of finite mass; empty for an infinite mass.
    pub fn of(&self, slot: Slot) -> &[Contact] {
        if self.count == 0 { &[] } else { &self.of[slot as usize] }
    }

    /// Along which axes two bodies are in contact; the mass of `slot` must be finite.
    #[inline]
    pub fn axes_between(&self, slot: Slot, other: Slot) -> [bool; 2] {
        let mut axes = [false; 2];
        for contact in self.of(slot).iter().filter(|contact| contact.other == other) {
            axes[contact.axis] = true;
        }
        axes
    }

    /// Adds a contact; the second body lies on the high side of the first.
    pub fn add(&mut self, states: &[BodyState], [first, second]: [Slot; 2], axis: Axis) {
        for (slot, other, side) in [(first, second, Side::High), (second, first, Side::Low)] {
            if !states[slot as usize].infinite {
                let contacts = &mut self.of[slot as usize];
                let contact = Contact { other, axis, side };
                let index = contacts.partition_point(|present| *present < contact);
                contacts.insert(index, contact);
                self.count += 1;
            }
        }
    }

    /// Removes the contact of two bodies along an axis.
    pub fn remove(&mut self, slot: Slot, other: Slot, axis: Axis) {
        for [own, others] in [[slot, other], [other, slot]] {
            let contacts = &mut self.of[own as usize];
            self.count -= contacts.len();
            contacts.retain(|contact| contact.other != others || contact.axis != axis);
            self.count += contacts.len();
        }
    }

    /// True if contacts on one side of a body lead to an infinite mass.
    pub fn is_supported(&self, states: &[BodyState], slot: Slot, axis: Axis, side: Side) -> bool {
        self.of(slot).iter().any(|contact| {
            contact.axis == axis && contact.side == side && states[contact.other as usize].is_immovable(axis, side)
        })
    }
}
