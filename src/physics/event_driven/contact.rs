//! Which boxes rest on each other: a contact is a flag, never a tested gap.
//!
//! Along its axis the two have the same velocity, and stay together until an acceleration
//! or a blow parts them, or one slides past the other's edge. Two that press corner on corner
//! are in contact along both axes, and part along both at once.

use super::mover::{Mover, Slot};

/// One side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Contact {
    /// The body touched.
    pub other: Slot,
    /// The axis along which they touch.
    pub axis: usize,
    /// Whether the other lies towards greater coordinates.
    pub ahead: bool,
}

/// All contacts, kept in creation order of the other with each body of finite mass that has a part in them.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    of: Vec<Vec<Contact>>,
    /// How many are listed: where there are none nobody looks for them.
    count: usize,
}

impl Contacts {
    /// Makes room for one more body.
    pub fn add_body(&mut self) {
        self.of.push(Vec::new());
    }

    /// The contacts of a body; none are listed with an infinite mass.
    pub fn of(&self, slot: Slot) -> &[Contact] {
        if self.count == 0 { &[] } else { &self.of[slot as usize] }
    }

    /// The axis along which two bodies are in contact, if they are; ask for a finite mass.
    pub fn between(&self, slot: Slot, other: Slot) -> Option<usize> {
        self.of(slot).iter().find(|contact| contact.other == other).map(|contact| contact.axis)
    }

    /// Enters a contact: the second body lies ahead of the first.
    pub fn join(&mut self, movers: &[Mover], [first, second]: [Slot; 2], axis: usize) {
        for (slot, other, ahead) in [(first, second, true), (second, first, false)] {
            if !movers[slot as usize].infinite {
                let contacts = &mut self.of[slot as usize];
                let contact = Contact { other, axis, ahead };
                let place = contacts.partition_point(|known| *known < contact);
                contacts.insert(place, contact);
                self.count += 1;
            }
        }
    }

    /// Strikes out the contact of two bodies.
    pub fn part(&mut self, slot: Slot, other: Slot) {
        for [own, others] in [[slot, other], [other, slot]] {
            let contacts = &mut self.of[own as usize];
            self.count -= contacts.len();
            contacts.retain(|contact| contact.other != others);
            self.count += contacts.len();
        }
    }

    /// Whether contacts lead on from a body, in a direction along an axis, to an infinite mass.
    pub fn holds(&self, movers: &[Mover], slot: Slot, axis: usize, ahead: bool) -> bool {
        self.of(slot).iter().any(|contact| {
            contact.axis == axis && contact.ahead == ahead && movers[contact.other as usize].is_immovable(axis, ahead)
        })
    }

    /// The bodies of finite mass joined to these, directly or through others, by contacts
    /// along the axis, in creation order.
    pub fn group(&self, movers: &[Mover], slots: &[Slot], axis: usize) -> Vec<Slot> {
        let mut seen = std::collections::BTreeSet::new();
        let mut open: Vec<Slot> = slots.iter().copied().filter(|slot| !movers[*slot as usize].infinite).collect();
        while let Some(slot) = open.pop() {
            if seen.insert(slot) {
                let others = self.of(slot).iter().filter(|contact| contact.axis == axis).map(|contact| contact.other);
                open.extend(others.filter(|other| !movers[*other as usize].infinite));
            }
        }
        seen.into_iter().collect()
    }
}
