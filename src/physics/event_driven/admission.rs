//! How bodies enter: the newly spawned, and all of them when grids and schedule are made anew.

use super::EventDriven;
use super::calendar::Calendar;
use super::mover::Slot;
use super::neighbours::Neighbours;
use super::schedule::Schedule;
use crate::physics::World;

impl EventDriven {
    /// Takes up the bodies spawned since the last step.
    pub(super) fn admit(&mut self, world: &World, step: u64) {
        if self.fresh.is_empty() {
            return;
        }
        let fresh = std::mem::take(&mut self.fresh);
        let many = self.movers.len() > 2 * self.made_for || self.movers.len() > 2 * world.bodies.len() + 64;
        if many || self.neighbours.are_few() || fresh.iter().any(|slot| self.movers[*slot as usize].is_anchored()) {
            self.fresh = fresh;
            if self.movers.len() > world.bodies.len() {
                self.forget_deleted(world, step);
            }
            let fresh = std::mem::take(&mut self.fresh);
            self.make(step);
            self.separate(&fresh);
            self.changed.extend((0..self.movers.len() as Slot).filter(|slot| self.traits[*slot as usize].alive));
        } else {
            for slot in &fresh {
                self.neighbours.insert(&self.clock, *slot, &self.movers[*slot as usize], self.now);
            }
            self.separate(&fresh);
            self.changed.extend(fresh);
        }
        self.predict_changed();
    }

    /// Closes the gaps that deleted bodies leave.
    fn forget_deleted(&mut self, world: &World, step: u64) {
        let memory = self.memory();
        let taken_up = self.take_up(world, step, &memory);
        debug_assert_eq!(taken_up, Ok(()));
    }

    /// Makes grids and schedule anew, fit for the bodies there are.
    pub(super) fn make(&mut self, step: u64) {
        self.made_for = self.movers.len();
        self.neighbours = Neighbours::new(self.usual_size());
        self.schedule = Schedule::new(self.clock, step, self.movers.len());
        self.calendar = Calendar::new(step);
        (0..self.movers.len()).for_each(|_| self.calendar.add_body());
        for slot in 0..self.movers.len() {
            if self.traits[slot].alive && self.fresh.binary_search(&(slot as Slot)).is_err() {
                self.neighbours.insert(&self.clock, slot as Slot, &self.movers[slot], self.now);
            }
        }
    }

    /// The greatest size of moving bodies, but for a few much larger than the rest, m.
    fn usual_size(&self) -> f64 {
        let moving = (0..self.movers.len()).filter(|slot| self.traits[*slot].alive && !self.movers[*slot].infinite);
        let longer = |[width, height]: [f64; 2]| if width > height { width } else { height };
        let mut sizes: Vec<f64> = moving.map(|slot| longer(self.movers[slot].size)).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let Some(large) = sizes.get(sizes.len() * 9 / 10) else { return 1.0 };
        sizes[sizes.partition_point(|size| *size <= 2.0 * large) - 1]
    }
}
