use crate::physics::BodyId;
use std::collections::BTreeMap;

/// The names alive, and how many bodies have been spawned: what `#K` counts.
#[derive(Clone, Debug, Default)]
pub struct Names {
    alive: BTreeMap<String, BodyId>,
    spawns: u64,
}

impl Names {
    /// The number of the body being spawned now: 1 for the first of the run, walls not counted.
    pub fn count_spawn(&mut self) -> u64 {
        self.spawns += 1;
        self.spawns
    }

    /// Gives `name` to a body; false if another has it.
    pub fn take(&mut self, name: &str, id: BodyId) -> bool {
        let free = !self.alive.contains_key(name);
        if free {
            self.alive.insert(name.to_owned(), id);
        }
        free
    }

    /// Takes `name` from the body that has it.
    pub fn free(&mut self, name: &str) -> Option<BodyId> {
        self.alive.remove(name)
    }

    /// Some of the names alive, for a message.
    pub fn first_alive(&self) -> Vec<String> {
        self.alive.keys().take(8).cloned().collect()
    }
}
