//! Who is near a body.

use super::mover::Slot;

/// Bodies found near another, some perhaps twice.
///
/// Whether one that is looked at belongs here cannot be guessed, so it is entered without a
/// branch: a wrong guess costs more than all the rest.
#[derive(Clone, Debug, Default)]
pub struct Near {
    slots: Vec<Slot>,
    count: usize,
}

impl Near {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Enters a body if it is near.
    #[inline]
    pub fn enter(&mut self, slot: Slot, is_near: bool) {
        if self.count == self.slots.len() {
            self.make_room();
        }
        self.slots[self.count] = slot;
        self.count += usize::from(is_near);
    }

    #[cold]
    #[inline(never)]
    fn make_room(&mut self) {
        self.slots.resize(2 * self.count + 16, 0);
    }

    /// Those found.
    pub fn slots(&self) -> &[Slot] {
        &self.slots[..self.count]
    }
}
