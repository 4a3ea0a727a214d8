//! The contact graph: a contact is stored, never derived from a gap.
//!
//! Along the axis of a contact both bodies have the same velocity. They stay together until an
//! acceleration or an impact separates them, or until one slides past the edge of the other. Bodies
//! that press on each other corner to corner are in contact along the axis of the gentler approach.

use super::body_state::Slot;
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

/// All contacts, and which bodies they support.
///
/// Invariants: a contact is stored with each of its bodies that has a finite mass, in creation order of the other
/// body. A body is supported on a side of an axis if and only if contacts on that side lead to an infinite mass.
/// Contacts along an axis lead from lower to higher coordinates, so they form no cycle, and no body supports itself,
/// unless the rounding of coordinates exceeds the sizes of the boxes.
#[derive(Clone, Debug, Default)]
pub struct ContactGraph {
    /// By slot.
    nodes: Vec<Node>,
    /// The total number of entries; at 0, lookups read no memory.
    count: usize,
    /// Buffer for the bodies whose supports must be examined.
    unchecked: Vec<Slot>,
}

/// A body in the graph.
#[derive(Clone, Debug)]
struct Node {
    contacts: Vec<Contact>,
    has_infinite_mass: bool,
    /// For each axis and side, true if contacts on that side lead to an infinite mass.
    supported: [[bool; 2]; 2],
}

impl ContactGraph {
    /// Adds a body without contacts; the mass in any unit.
    pub fn add_body(&mut self, mass: f64) {
        let has_infinite_mass = mass == f64::INFINITY;
        self.nodes.push(Node { contacts: Vec::new(), has_infinite_mass, supported: [[false; 2]; 2] });
    }

    /// The contacts of a body of finite mass; empty for an infinite mass.
    pub fn of(&self, slot: Slot) -> &[Contact] {
        if self.count == 0 { &[] } else { &self.nodes[slot as usize].contacts }
    }

    /// For each axis, true if two bodies are in contact along it.
    #[inline]
    pub fn axes_between(&self, [first, second]: [Slot; 2]) -> [bool; 2] {
        // An infinite mass has no list of its contacts.
        let has_list = !self.nodes[first as usize].has_infinite_mass;
        let [slot, other] = if has_list { [first, second] } else { [second, first] };
        let mut axes = [false; 2];
        for contact in self.of(slot).iter().filter(|contact| contact.other == other) {
            axes[contact.axis] = true;
        }
        axes
    }

    /// True if a push along the axis towards `side` cannot move a body.
    pub fn is_immovable(&self, slot: Slot, axis: Axis, side: Side) -> bool {
        let node = &self.nodes[slot as usize];
        node.has_infinite_mass || node.supported[axis][side]
    }

    /// True if contacts on a side of a body lead to an infinite mass.
    #[inline]
    pub fn is_supported(&self, slot: Slot, axis: Axis, side: Side) -> bool {
        self.count > 0 && self.nodes[slot as usize].supported[axis][side]
    }

    /// The infinite mass that supports an immovable body on a side: the body itself if its mass is infinite.
    pub fn supporting_wall(&self, mut slot: Slot, axis: Axis, side: Side) -> Slot {
        // Not more than there are bodies: where coordinates are rounded by more than the boxes, contacts can form a
        // cycle.
        for _ in 0..self.nodes.len() {
            if self.nodes[slot as usize].has_infinite_mass {
                break;
            }
            let Some(contact) = self.support(slot, axis, side) else { break };
            slot = contact.other;
        }
        slot
    }

    /// Adds a contact, the body on the low side first; returns the bodies whose support changed.
    pub fn add(&mut self, [low, high]: [Slot; 2], axis: Axis) -> Vec<Slot> {
        for (slot, other, side) in [(low, high, Side::High), (high, low, Side::Low)] {
            let node = &mut self.nodes[slot as usize];
            if !node.has_infinite_mass {
                let contact = Contact { other, axis, side };
                let index = node.contacts.partition_point(|present| *present < contact);
                node.contacts.insert(index, contact);
                self.count += 1;
            }
        }
        self.update_supports(axis, [low, high])
    }

    /// Removes the contact of two bodies along an axis; returns the bodies whose support changed.
    pub fn remove(&mut self, [slot, other]: [Slot; 2], axis: Axis) -> Vec<Slot> {
        self.unlink([slot, other], axis);
        self.update_supports(axis, [slot, other])
    }

    /// Removes all contacts of a body; returns the bodies of finite mass that were in contact with it or whose
    /// support changed, possibly more than once.
    pub fn remove_all(&mut self, slot: Slot) -> Vec<Slot> {
        let others: Vec<Slot> = if self.nodes[slot as usize].has_infinite_mass {
            let is_in_contact = |other: &Slot| *other != slot && self.axes_between([*other, slot]) != [false; 2];
            (0..self.nodes.len() as Slot).filter(is_in_contact).collect()
        } else {
            self.of(slot).iter().map(|contact| contact.other).collect()
        };
        let mut concerned = others.clone();
        for axis in Axis::BOTH {
            others.iter().for_each(|other| self.unlink([slot, *other], axis));
            concerned.extend(self.update_supports(axis, others.iter().copied().chain([slot])));
        }
        concerned.retain(|other| *other != slot && !self.nodes[*other as usize].has_infinite_mass);
        concerned
    }

    fn unlink(&mut self, [slot, other]: [Slot; 2], axis: Axis) {
        for [own, others] in [[slot, other], [other, slot]] {
            let contacts = &mut self.nodes[own as usize].contacts;
            self.count -= contacts.len();
            contacts.retain(|contact| contact.other != others || contact.axis != axis);
            self.count += contacts.len();
        }
    }

    /// Updates the supports, starting at some bodies; returns those for which they changed.
    fn update_supports(&mut self, axis: Axis, start: impl IntoIterator<Item = Slot>) -> Vec<Slot> {
        let (mut changed, mut unchecked) = (Vec::new(), std::mem::take(&mut self.unchecked));
        unchecked.extend(start);
        while let Some(slot) = unchecked.pop() {
            if self.nodes[slot as usize].has_infinite_mass {
                continue;
            }
            let supported = Side::BOTH.map(|side| self.support(slot, axis, side).is_some());
            let node = &mut self.nodes[slot as usize];
            if supported != node.supported[axis] {
                node.supported[axis] = supported;
                changed.push(slot);
                let along = node.contacts.iter().filter(|contact| contact.axis == axis);
                unchecked.extend(along.map(|contact| contact.other));
            }
        }
        self.unchecked = unchecked;
        changed
    }

    /// The first contact on a side of a body of finite mass that leads to an infinite mass.
    fn support(&self, slot: Slot, axis: Axis, side: Side) -> Option<Contact> {
        let contacts = self.of(slot).iter().copied();
        contacts.filter(|contact| contact.axis == axis && contact.side == side).find(|contact| {
            let other = &self.nodes[contact.other as usize];
            other.has_infinite_mass || other.supported[axis][side]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A floor of infinite mass, 0, and boxes, 1 to 3.
    fn graph() -> ContactGraph {
        let mut graph = ContactGraph::default();
        [f64::INFINITY, 1.0, 2.0, 3.0].into_iter().for_each(|mass| graph.add_body(mass));
        graph
    }

    fn supported(graph: &ContactGraph) -> Vec<Slot> {
        (1..4).filter(|slot| graph.is_immovable(*slot, Axis::Y, Side::High)).collect()
    }

    #[test]
    fn a_contact_is_stored_with_each_body_of_finite_mass() {
        let mut graph = graph();
        graph.add([2, 1], Axis::Y);
        graph.add([1, 0], Axis::Y);
        assert_eq!(graph.of(0), []);
        let contact = |other, side| Contact { other, axis: Axis::Y, side };
        assert_eq!(graph.of(1), [contact(0, Side::High), contact(2, Side::Low)]);
        assert_eq!(graph.of(2), [contact(1, Side::High)]);
        assert_eq!(graph.axes_between([2, 1]), [false, true]);
    }

    #[test]
    fn a_stack_is_supported_as_soon_as_its_foot_is() {
        let mut graph = graph();
        assert!(graph.add([3, 2], Axis::Y).is_empty());
        assert!(graph.add([2, 1], Axis::Y).is_empty());
        let mut changed = graph.add([1, 0], Axis::Y);
        changed.sort_unstable();
        assert_eq!((changed, supported(&graph)), (vec![1, 2, 3], vec![1, 2, 3]));
        assert_eq!(graph.supporting_wall(3, Axis::Y, Side::High), 0);
        assert!(!graph.is_immovable(3, Axis::Y, Side::Low) && !graph.is_immovable(3, Axis::X, Side::High));
    }

    #[test]
    fn a_body_on_two_supports_keeps_one_when_the_other_goes() {
        let mut graph = graph();
        graph.add([1, 0], Axis::Y);
        graph.add([2, 0], Axis::Y);
        graph.add([3, 1], Axis::Y);
        graph.add([3, 2], Axis::Y);
        assert!(graph.remove([1, 3], Axis::Y).is_empty());
        assert_eq!(supported(&graph), [1, 2, 3]);
        assert_eq!(graph.remove([2, 3], Axis::Y), [3]);
        assert_eq!(supported(&graph), [1, 2]);
    }

    #[test]
    fn without_the_infinite_mass_nothing_is_supported() {
        let mut graph = graph();
        graph.add([1, 0], Axis::Y);
        graph.add([2, 1], Axis::Y);
        let mut concerned = graph.remove_all(0);
        concerned.sort_unstable();
        concerned.dedup();
        assert_eq!((concerned, supported(&graph)), (vec![1, 2], Vec::new()));
        assert_eq!(graph.axes_between([2, 1]), [false, true], "the boxes remain in contact");
    }

    #[test]
    fn supports_equal_a_search_after_any_changes() {
        let mut graph = ContactGraph::default();
        let infinite = |slot: Slot| slot.is_multiple_of(7);
        (0..30).for_each(|slot| graph.add_body(if infinite(slot) { f64::INFINITY } else { 1.0 }));
        let mut contacts: Vec<[Slot; 2]> = Vec::new();
        let mut random = 1_u32;
        for _ in 0..3000 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (a, b) = (random >> 8 & 31, random >> 16 & 31);
            let [low, high] = [a.min(b), a.max(b)];
            if high >= 30 || low == high || infinite(low) && infinite(high) {
                continue;
            }
            match contacts.iter().position(|contact| *contact == [low, high]) {
                Some(index) => {
                    contacts.swap_remove(index);
                    graph.remove([low, high], Axis::X);
                }
                None => {
                    contacts.push([low, high]);
                    graph.add([low, high], Axis::X);
                }
            }
            let mut reached = [false; 30];
            for slot in (0..30).rev() {
                let leads = |contact: &[Slot; 2]| contact[0] == slot && reached[contact[1] as usize];
                reached[slot as usize] = infinite(slot) || contacts.iter().any(leads);
            }
            for slot in 0..30 {
                assert_eq!(graph.is_immovable(slot, Axis::X, Side::High), reached[slot as usize]);
            }
        }
    }
}
