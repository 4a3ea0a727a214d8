//! A reusable buffer for the neighbours of a body.

use super::body_state::Slot;

/// The neighbours found for a body, possibly with duplicates.
///
/// Candidates are added without a branch: whether one is a neighbour is unpredictable, and
/// mispredicted branches would dominate the cost.
#[derive(Clone, Debug, Default)]
pub struct NeighbourBuffer {
    slots: Vec<Slot>,
    count: usize,
}

impl NeighbourBuffer {
    /// Removes all bodies.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a body if `is_near` is true.
    #[inline]
    pub fn push_if(&mut self, slot: Slot, is_near: bool) {
        if self.count == self.slots.len() {
            self.grow();
        }
        self.slots[self.count] = slot;
        self.count += usize::from(is_near);
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        self.slots.resize(2 * self.count + 16, 0);
    }

    /// The bodies found.
    pub fn slots(&self) -> &[Slot] {
        &self.slots[..self.count]
    }
}
