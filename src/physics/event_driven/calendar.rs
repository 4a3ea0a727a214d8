//! Who is to be looked at before which step.

use super::mover::Slot;

/// The calendar reaches so many steps ahead; who is due later is looked at again then.
const STEPS: u64 = 32;

/// For each of the coming steps the bodies that may leave their cells in it.
///
/// Within a step their order means nothing, so this is cheaper than a schedule. A body whose
/// day comes later than was foretold stays where it is listed, to be listed anew then: so the
/// lists do not grow however often it changes its mind.
#[derive(Clone, Debug)]
pub struct Calendar {
    lists: Vec<Vec<Slot>>,
    /// The step for which each body is listed; the greatest number if for none.
    listed: Vec<u64>,
    /// The first step whose list is still open.
    from: u64,
}

impl Calendar {
    /// An empty calendar from a step on.
    pub fn new(from: u64) -> Calendar {
        Calendar { lists: vec![Vec::new(); STEPS as usize], listed: Vec::new(), from }
    }

    /// Enters a body for a step; one too near or too far is entered for the nearest possible.
    pub fn note(&mut self, slot: Slot, step: u64) {
        if self.listed.len() <= slot as usize {
            self.listed.resize(slot as usize + 1, u64::MAX);
        }
        let step = step.clamp(self.from, self.from + STEPS - 2);
        if step < self.listed[slot as usize] {
            self.listed[slot as usize] = step;
            self.lists[(step % STEPS) as usize].push(slot);
        }
    }

    /// Strikes a body out.
    pub fn forget(&mut self, slot: Slot) {
        if let Some(listed) = self.listed.get_mut(slot as usize) {
            *listed = u64::MAX;
        }
    }

    /// Closes the list of the next step, which must be this one, and hands it out.
    pub fn due(&mut self, step: u64) -> Vec<Slot> {
        self.from = step + 1;
        let listed = &mut self.listed;
        let mut due = std::mem::take(&mut self.lists[(step % STEPS) as usize]);
        due.retain(|slot| {
            let holds = listed[*slot as usize] == step;
            if holds {
                listed[*slot as usize] = u64::MAX;
            }
            holds
        });
        due
    }

    /// Takes back a list handed out, so that its room is used again.
    pub fn recycle(&mut self, step: u64, mut list: Vec<Slot>) {
        list.clear();
        self.lists[(step % STEPS) as usize] = list;
    }
}
