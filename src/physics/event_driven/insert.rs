//! Inserts spawned bodies into cell lists and event queue, and rebuilds both.

use super::EventDriven;
use super::body_state::Slot;
use super::cell_lists::CellLists;
use super::crossing_wheel::CrossingWheel;
use super::event_queue::EventQueue;
use crate::physics::World;

impl EventDriven {
    /// Inserts the bodies spawned since the last step.
    ///
    /// If the bodies have outgrown cell lists and event queue, or are few, both are rebuilt and all
    /// bodies predict again; likewise if a static body is spawned, which predicts nothing itself.
    pub(super) fn insert_spawned(&mut self, world: &World, step: u64) {
        if self.pending_spawns.is_empty() {
            return;
        }
        let spawned = std::mem::take(&mut self.pending_spawns);
        let is_outgrown =
            self.states.len() > 2 * self.indexed_bodies || self.states.len() > 2 * world.bodies.len() + 64;
        if is_outgrown
            || self.cell_lists.uses_all_pairs()
            || spawned.iter().any(|slot| self.states[*slot as usize].is_static())
        {
            self.pending_spawns = spawned;
            if self.states.len() > world.bodies.len() {
                self.compact(world, step);
            }
            let spawned = std::mem::take(&mut self.pending_spawns);
            self.rebuild_indices(step);
            self.separate_overlaps(&spawned);
            self.changed.extend((0..self.states.len() as Slot).filter(|slot| self.params[*slot as usize].alive));
        } else {
            for slot in &spawned {
                self.cell_lists.insert(&self.clock, *slot, &self.states[*slot as usize], self.now);
            }
            self.separate_overlaps(&spawned);
            self.changed.extend(spawned);
        }
        self.predict_changed();
    }

    /// Removes the slots of deleted bodies.
    fn compact(&mut self, world: &World, step: u64) {
        let snapshot = self.snapshot();
        let restored = self.deserialize(world, step, &snapshot);
        debug_assert_eq!(restored, Ok(()));
    }

    /// Rebuilds cell lists and event queue for the present number and sizes of bodies.
    pub(super) fn rebuild_indices(&mut self, step: u64) {
        self.indexed_bodies = self.states.len();
        self.cell_lists = CellLists::new(self.typical_size());
        self.event_queue = EventQueue::new(self.clock, step, self.states.len());
        self.crossing_wheel = CrossingWheel::new(step);
        (0..self.states.len()).for_each(|_| self.crossing_wheel.add_body());
        for slot in 0..self.states.len() {
            if self.params[slot].alive && self.pending_spawns.binary_search(&(slot as Slot)).is_err() {
                self.cell_lists.insert(&self.clock, slot as Slot, &self.states[slot], self.now);
            }
        }
    }

    /// The longest side among the bodies of finite mass, without the outliers; m.
    ///
    /// A side of more than twice the 90th percentile is an outlier.
    fn typical_size(&self) -> f64 {
        let moving = (0..self.states.len()).filter(|slot| self.params[*slot].alive && !self.states[*slot].infinite);
        let longer = |[width, height]: [f64; 2]| if width > height { width } else { height };
        let mut sizes: Vec<f64> = moving.map(|slot| longer(self.states[slot].size)).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let Some(large) = sizes.get(sizes.len() * 9 / 10) else { return 1.0 };
        sizes[sizes.partition_point(|size| *size <= 2.0 * large) - 1]
    }
}
