use crate::physics::BodyId;
use std::collections::BTreeMap;

/// The names of the bodies alive, and the number of bodies spawned, which the names `#K` count.
#[derive(Clone, Debug, Default)]
pub struct Names {
    alive: BTreeMap<String, BodyId>,
    spawns: u64,
}

impl Names {
    /// Counts a spawn and returns its number: 1 for the first of the run; walls are not counted.
    pub fn count_spawn(&mut self) -> u64 {
        self.spawns += 1;
        self.spawns
    }

    /// Gives `name` to a body; returns false if another body has it.
    pub fn claim(&mut self, name: &str, id: BodyId) -> bool {
        let is_free = !self.alive.contains_key(name);
        if is_free {
            self.alive.insert(name.to_owned(), id);
        }
        is_free
    }

    /// Removes `name` and returns the body that had it.
    pub fn release(&mut self, name: &str) -> Option<BodyId> {
        self.alive.remove(name)
    }

    /// The first few names alive, for a message.
    pub fn first_alive(&self) -> Vec<String> {
        self.alive.keys().take(8).cloned().collect()
    }
}
