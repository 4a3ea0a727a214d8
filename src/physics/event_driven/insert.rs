//! Inserts spawned bodies into cell lists and event queue, and rebuilds both.

use super::EventDriven;
use super::body_state::Slot;
use super::cell_lists::CellLists;
use super::event_queue::EventQueue;
use crate::physics::{Axis, World};

impl EventDriven {
    /// Inserts the bodies spawned since the last step; returns the bodies whose contacts or accelerations may change with them.
    ///
    /// If the bodies have outgrown cell lists and event queue, or are few, both are rebuilt and all
    /// bodies predict again; likewise if a static body is spawned, which predicts nothing itself.
    pub(super) fn insert_spawned(&mut self, world: &World) -> Vec<Slot> {
        if self.pending_spawns.is_empty() {
            return Vec::new();
        }
        let spawned = std::mem::take(&mut self.pending_spawns);
        let is_outgrown =
            self.bodies.len() > 2 * self.indexed_bodies || self.bodies.len() > 2 * world.bodies.len() + 64;
        let spawned = if is_outgrown
            || self.cell_lists.uses_all_pairs()
            || spawned.iter().any(|slot| self.bodies[*slot].is_static())
        {
            self.pending_spawns = spawned;
            if self.bodies.len() > world.bodies.len() {
                self.compact(world);
            }
            let spawned = std::mem::take(&mut self.pending_spawns);
            self.rebuild_indices();
            self.changed.extend(self.bodies.alive());
            spawned
        } else {
            for slot in &spawned {
                self.cell_lists.insert(&self.clock, *slot, &self.bodies[*slot], self.now);
            }
            self.changed.extend(&spawned);
            spawned
        };
        let mut concerned = self.separate_overlaps(&spawned);
        self.align_spawned(&spawned);
        concerned.extend(self.neighbours_of_infinite(&spawned));
        // One that touches no other falls freely already, as it was spawned; with many bodies, a patch of all would take
        // more memory than everything else.
        concerned.extend(spawned.into_iter().filter(|slot| {
            let is_forced = self.bodies.params(*slot).has_force != [false; 2];
            !self.bodies[*slot].infinite && (is_forced || !self.touches_none_but(None, *slot))
        }));
        concerned
    }

    /// The bodies of finite mass near spawned bodies of infinite mass.
    fn neighbours_of_infinite(&self, spawned: &[Slot]) -> Vec<Slot> {
        let mut found = Vec::new();
        for slot in spawned.iter().filter(|slot| self.bodies[**slot].infinite) {
            let state = &self.bodies[*slot];
            let low = state.trajectory.at(self.now)[0];
            let [from, to] = [-1.0, 1.0].map(|sign| {
                Axis::BOTH.map(|axis| {
                    let margin = (low[axis].abs() + state.size[axis]) * (16.0 * f64::EPSILON);
                    low[axis] + sign * margin + if sign > 0.0 { state.size[axis] } else { 0.0 }
                })
            });
            self.cell_lists.visit_region(from, to, |other| {
                let other_state = &self.bodies[other];
                let position = other_state.trajectory.at(self.now)[0];
                let is_near = Axis::BOTH.into_iter().all(|axis| {
                    let margin = (position[axis].abs() + other_state.size[axis]) * (16.0 * f64::EPSILON);
                    position[axis] - margin <= to[axis]
                        && position[axis] + other_state.size[axis] + margin >= from[axis]
                });
                if !other_state.infinite && is_near {
                    found.push(other);
                }
            });
        }
        found
    }

    /// Removes the slots of deleted bodies.
    fn compact(&mut self, world: &World) {
        let snapshot = self.snapshot(self.step);
        let restored = self.deserialize(world, self.step, &snapshot);
        debug_assert_eq!(restored, Ok(()));
    }

    /// Rebuilds cell lists and event queue for the present number and sizes of bodies.
    pub(super) fn rebuild_indices(&mut self) {
        self.window_lists.end(self.step);
        self.indexed_bodies = self.bodies.len();
        self.cell_lists = CellLists::new(self.bodies.typical_size());
        self.event_queue = EventQueue::new(self.clock, self.step, self.bodies.len());
        for slot in self.bodies.alive() {
            if self.pending_spawns.binary_search(&slot).is_err() {
                self.cell_lists.insert(&self.clock, slot, &self.bodies[slot], self.now);
            }
        }
    }
}
