//! The neighbours that a broad phase finds for a body.

use super::body_state::Slot;

/// The neighbours found for a body, possibly with duplicates.
///
/// A reusable buffer. Candidates are added without a branch: whether one is a neighbour is unpredictable, and
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
        self.extend_by(&[slot], |_| is_near);
    }

    /// Adds the bodies for which `is_near` is true.
    #[inline]
    pub fn extend_by(&mut self, bodies: &[Slot], is_near: impl Fn(Slot) -> bool) {
        if self.slots.len() < self.count + bodies.len() {
            self.grow(bodies.len());
        }
        // A count in a register, not in memory, which each addition would wait for.
        let mut count = self.count;
        for slot in bodies {
            self.slots[count] = *slot;
            count += usize::from(is_near(*slot));
        }
        self.count = count;
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self, more: usize) {
        self.slots.resize(2 * self.count + more + 16, 0);
    }

    /// The bodies found.
    pub fn slots(&self) -> &[Slot] {
        &self.slots[..self.count]
    }
}
