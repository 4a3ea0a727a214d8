//! A timing wheel of the cell crossings after the current step.

use super::body_state::Slot;

/// Number of steps that have a bin. Later crossings are kept in the last bin and inserted again when it
/// is due.
const BINS: u64 = 32;

const NEVER: u64 = u64::MAX;

/// For each of the next steps, the bodies that may leave their cells in it.
///
/// Their order within a step is irrelevant, so this is cheaper than the event queue. A body whose
/// crossing is postponed stays in its bin until the bin is due, so the bins do not grow however often a
/// body is scheduled again.
#[derive(Clone, Debug)]
pub struct CrossingWheel {
    current_step: u64,
    bins: Vec<Vec<Slot>>,
    entries: Vec<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    /// The step before which the body must be moved to its next cell, or [`NEVER`].
    due: u64,
    /// The step of the bin that lists the body, or [`NEVER`].
    bin: u64,
}

impl CrossingWheel {
    /// Creates an empty wheel.
    pub fn new(current_step: u64) -> CrossingWheel {
        CrossingWheel { current_step, bins: vec![Vec::new(); BINS as usize], entries: Vec::new() }
    }

    /// Adds an entry for one more body.
    pub fn add_body(&mut self) {
        self.entries.push(Entry { due: NEVER, bin: NEVER });
    }

    /// Schedules the crossing of a body in a number of steps, at least one.
    pub fn schedule(&mut self, slot: Slot, steps: u32) {
        self.entries[slot as usize].due = self.current_step + u64::from(steps);
        self.insert(slot);
    }

    /// Cancels the crossing of a body.
    pub fn cancel(&mut self, slot: Slot) {
        self.entries[slot as usize].due = NEVER;
    }

    fn insert(&mut self, slot: Slot) {
        let entry = &mut self.entries[slot as usize];
        let last = self.current_step + BINS - 1;
        let bin = if entry.due < last { entry.due } else { last };
        if bin < entry.bin {
            entry.bin = bin;
            self.bins[(bin % BINS) as usize].push(slot);
        }
    }

    /// Returns true if the bin of the next step is empty.
    pub fn is_next_bin_empty(&self) -> bool {
        self.bins[((self.current_step + 1) % BINS) as usize].is_empty()
    }

    /// Advances to the next step without reading its bin, which must be empty.
    pub fn skip_step(&mut self) {
        self.current_step += 1;
    }

    /// Advances to the next step and appends the bodies due in it to `due`.
    pub fn advance(&mut self, due: &mut Vec<Slot>) {
        self.current_step += 1;
        let index = (self.current_step % BINS) as usize;
        let mut bin = std::mem::take(&mut self.bins[index]);
        for slot in bin.drain(..) {
            let entry = &mut self.entries[slot as usize];
            if entry.bin != self.current_step {
                continue;
            }
            entry.bin = NEVER;
            if entry.due <= self.current_step {
                due.push(slot);
            } else if entry.due != NEVER {
                self.insert(slot);
            }
        }
        self.bins[index] = bin;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due(wheel: &mut CrossingWheel) -> Vec<Slot> {
        let mut due = Vec::new();
        wheel.advance(&mut due);
        due
    }

    #[test]
    fn a_body_is_due_in_the_step_it_was_scheduled_for_last() {
        let mut wheel = CrossingWheel::new(7);
        (0..4).for_each(|_| wheel.add_body());
        wheel.schedule(0, 1);
        wheel.schedule(1, 1);
        wheel.schedule(1, 3);
        wheel.schedule(2, 3);
        wheel.schedule(2, 2);
        wheel.schedule(3, 100);
        assert_eq!(due(&mut wheel), [0]);
        assert_eq!(due(&mut wheel), [2]);
        assert_eq!(due(&mut wheel), [1]);
        assert!((11..107).all(|_| due(&mut wheel).is_empty()));
        assert_eq!(due(&mut wheel), [3]);
    }

    #[test]
    fn a_cancelled_crossing_is_never_due() {
        let mut wheel = CrossingWheel::new(0);
        wheel.add_body();
        wheel.schedule(0, 40);
        wheel.cancel(0);
        assert!((0..100).all(|_| due(&mut wheel).is_empty()));
    }
}
