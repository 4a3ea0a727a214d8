//! Diagnosis of failed steps: which bodies are crushed, and between which.

use super::EventDriven;
use super::body_state::Slot;
use super::pair_event::tolerance;
use crate::physics::{Axis, Side, StepError, World};

impl EventDriven {
    /// The error of an impact in which neither body can move.
    pub(super) fn crushed_error(&self, world: &World, [first, second]: [Slot; 2], axis: Axis) -> StepError {
        let body = if self.bodies[first].infinite { second } else { first };
        let between = [(first, Side::Low), (second, Side::High)];
        let between = between.map(|(slot, side)| self.contacts.supporting_wall(slot, axis, side));
        let between = between.map(|slot| self.name_of(world, slot));
        StepError::Crushed { step: self.timeline.step(), body: self.name_of(world, body), between }
    }

    /// The error of a step that exceeds the limit of events.
    ///
    /// A body that bounces without loss between closing walls has infinitely many impacts before it is
    /// crushed; it is reported as crushed.
    pub(super) fn too_many_events(&self, world: &World, pair: [Slot; 2]) -> StepError {
        let step = self.timeline.step();
        let finite = pair.into_iter().find(|slot| !self.bodies[*slot].infinite);
        if let Some(slot) = finite
            && let Some(between) = Axis::BOTH.into_iter().find_map(|axis| self.closing_walls(slot, axis))
        {
            let between = between.map(|slot| self.name_of(world, slot));
            return StepError::Crushed { step, body: self.name_of(world, slot), between };
        }
        // A cell crossing concerns one body.
        let slots = if pair[0] == pair[1] { &pair[..1] } else { &pair[..] };
        let bodies = slots.iter().map(|slot| self.name_of(world, *slot)).collect();
        StepError::TooManyEvents { step, limit: self.event_limit.max_events(), bodies }
    }

    /// The error of a burst without end.
    pub(super) fn endless_error(&self, world: &World, pair: [Slot; 2]) -> StepError {
        StepError::Endless { step: self.timeline.step(), bodies: pair.map(|slot| self.name_of(world, slot)) }
    }

    /// True if two boxes overlap along an axis by more than rounding.
    fn overlaps_along(&self, axis: Axis, slot: Slot, other: Slot) -> bool {
        let [own, others] = [slot, other].map(|slot| self.state_dd(slot, axis).position.high);
        let [own_size, others_size] = [slot, other].map(|slot| self.bodies[slot].size[axis]);
        let overlap = if others > own { own + own_size - others } else { others + others_size - own };
        overlap > tolerance(own.abs() + others.abs() + own_size + others_size)
    }

    /// The two infinite masses that close in on a body along an axis within one step, if any.
    fn closing_walls(&self, slot: Slot, axis: Axis) -> Option<[Slot; 2]> {
        let [low, high] = Side::BOTH.map(|side| self.nearest_wall(slot, axis, side));
        let (low, high) = (low?, high?);
        let [first, second] = [low, high].map(|slot| self.state_dd(slot, axis));
        let size = self.bodies[low].size[axis] + self.bodies[slot].size[axis];
        let room = (second.position - first.position).high - size;
        let speed = (first.velocity - second.velocity).high;
        (speed > 0.0 && room <= speed * self.timeline.clock().period).then_some([low, high])
    }

    /// The nearest infinite mass on a side of a body.
    fn nearest_wall(&self, slot: Slot, axis: Axis, side: Side) -> Option<Slot> {
        let own = self.state_dd(slot, axis).position.high;
        let walls = self.bodies.alive().filter(|other| {
            let position = self.state_dd(*other, axis).position.high;
            let is_on_side = match side {
                Side::High => position > own,
                Side::Low => position < own,
            };
            self.bodies[*other].infinite && is_on_side && self.overlaps_along(axis.other(), slot, *other)
        });
        let face = |other: &Slot| {
            let body = &self.bodies[*other];
            let near = self.state_dd(*other, axis).position.high;
            match side {
                Side::High => near,
                Side::Low => -(near + body.size[axis]),
            }
        };
        walls.min_by(|a, b| face(a).total_cmp(&face(b)))
    }

    /// Checks the invariants between instants: no pair overlaps, none that touches approaches; in a contact nothing
    /// changes; the lists of a window are complete.
    ///
    /// # Panics
    /// If one does not hold.
    #[cfg(debug_assertions)]
    pub(super) fn assert_consistent(&self) {
        const MOST_BODIES: usize = 40;
        if self.bodies.len() > MOST_BODIES {
            return;
        }
        if self.window_lists.is_active() {
            self.assert_lists();
        }
        let alive: Vec<Slot> = (0..self.bodies.len() as Slot)
            .filter(|slot| self.bodies.params(*slot).alive && !self.pending_spawns.contains(slot))
            .collect();
        for first in &alive {
            for second in alive.iter().filter(|second| first < *second) {
                let pair = [*first, *second];
                if pair.iter().all(|slot| self.bodies[*slot].infinite) {
                    continue;
                }
                let contacts = self.contacts.axes_between(pair);
                for axis in Axis::BOTH.into_iter().filter(|axis| contacts[*axis]) {
                    let [gap, speed, acceleration] = self.motion_now(pair, axis);
                    assert!(
                        gap == 0.0,
                        "contact of {pair:?} along {axis:?} at {:?} with gap {gap:e}",
                        self.timeline.now()
                    );
                    assert!(
                        speed == 0.0,
                        "contact of {pair:?} along {axis:?} at {:?} with approach speed {speed:e}",
                        self.timeline.now()
                    );
                    assert!(
                        acceleration == 0.0,
                        "contact of {pair:?} along {axis:?} at {:?}: {acceleration:e}",
                        self.timeline.now()
                    );
                }
                let motions = Axis::BOTH.map(|axis| self.motion_now(pair, axis));
                let overlap = motions.iter().all(|motion| motion[0] < 0.0);
                assert!(!overlap, "{pair:?} overlap at {:?}, contacts {contacts:?}", self.timeline.now());
                if contacts == [false; 2]
                    && let Some(event) = self.approach_now(pair)
                    && !self.turns_in_touch(pair, event.axis_and_side().0)
                {
                    // In a sequence of ever faster impacts, that of a pair can be later than the instant by less than
                    // the resolution, and an earlier one of the body that predicted it can be queued.
                    let is_queued = pair.iter().any(|slot| self.event_queue.holds(*slot, pair))
                        || self
                            .predict_exactly(pair)
                            .is_some_and(|(at, _)| pair.iter().any(|slot| self.event_queue.time_of(*slot) <= at.high));
                    assert!(is_queued, "{pair:?} approach at {:?}: {event:?}, {motions:?}", self.timeline.now());
                }
            }
        }
    }

    /// True if two touching bodies that approach part again before they overlap by the resolution of positions.
    #[cfg(debug_assertions)]
    fn turns_in_touch(&self, pair: [Slot; 2], axis: Axis) -> bool {
        let [_, speed, acceleration] = self.motion_now(pair, axis);
        let coordinates = pair.map(|slot| self.state_dd(slot, axis).position.high);
        let sizes = pair.map(|slot| self.bodies[slot].size[axis]);
        acceleration < 0.0 && self.bodies.resolution().hides_bounce(speed, -acceleration, coordinates, sizes)
    }
}
