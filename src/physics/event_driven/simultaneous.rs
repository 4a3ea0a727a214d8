//! An instant: all events of one time among bodies that touch.
//!
//! 1. Resting (`resting`): contacts that have slid off end, those that slid on or are pressed begin.
//! 2. Impacts (`burst`), until no pair approaches.
//! 3. Resting again, with the velocities after. Bounces below the resolution of coordinates are joined, and 2 and
//!    3 repeated.
//!
//! Only what depends on the bodies concerned is visited (`patch`): a body joins when its velocity, acceleration or
//! contacts may change, and brings all that it touches.

use super::EventDriven;
use super::body_state::Slot;
use super::event_queue::ScheduledEvent;
use super::exact::VELOCITY_ROUNDING;
use super::instant::Instant;
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::Sample;
use super::patch::{Local, LocalBody, Patch, TouchKind};
use crate::physics::{Axis, Observer, Side, StepError, World};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::iter::{self, repeat};

/// A body that an instant concerns.
#[derive(Clone, Copy, Debug)]
pub struct Concerned {
    pub slot: Slot,
    /// The instant of its events, the same for all bodies connected with it by touching.
    pub at: Instant,
}

/// Bodies that are connected by touching when the earliest of their events in a vicinity is due.
struct Group<'a> {
    earliest: &'a ScheduledEvent,
    /// True until an event of the group does not coincide with the earliest one.
    accepts_events: bool,
}

impl EventDriven {
    /// Processes the present instant for the bodies [concerned](EventDriven::concerned), and predicts their next events.
    pub(super) fn process_instant<O: Observer>(&mut self, world: &World, observer: &mut O) -> Result<(), StepError> {
        let mut patch = self.patch.take().unwrap_or_default();
        let result = self.process_patch(&mut patch, world, observer);
        if result.is_ok() {
            self.write_back(&mut patch);
            self.predict_changed();
        }
        patch.clear();
        self.patch = Some(patch);
        result
    }

    /// Takes the other events in the vicinity of an instant, the time of the next event, and in the vicinities of these
    /// events, from the queue. They are in the order of their times.
    ///
    /// # Errors
    /// [`StepError::TooManyEvents`] if bodies predict again too often.
    pub(super) fn collect_simultaneous(
        &mut self,
        world: &World,
        at: Instant,
    ) -> Result<Vec<ScheduledEvent>, StepError> {
        let (mut events, end) = (Vec::new(), at.end_of_vicinity());
        let mut last = end;
        while let Some((other, event)) = self.event_queue.pop(last) {
            let pair = event.pair;
            match self.next_exact_event(other, event, last) {
                Some(event) => {
                    if !end.is_before(event.at) {
                        last = event.at.end_of_vicinity();
                    }
                    self.changed.push(other);
                    events.push(event);
                }
                None => self.count_repetition(world, pair)?,
            }
        }
        Ok(events)
    }

    /// Returns true if an event is at most at the instant `last`, or in its vicinity and coincides with it.
    pub(super) fn is_due(&self, event: &ScheduledEvent, last: Instant) -> bool {
        !last.is_before(event.at) || (!last.end_of_vicinity().is_before(event.at) && self.coincides(event, last))
    }

    /// Finds the bodies [concerned](EventDriven::concerned) by the next instant, given the next event and those in its
    /// vicinity. They are none if no event is due.
    ///
    /// Bodies that touch form a group. The events of a group that coincide with the earliest of them share its time,
    /// whatever the events of other groups. Groups whose earliest events coincide are processed in one instant, so that
    /// the order of their impacts does not follow from rounding, but each at its own time. A group whose earliest event
    /// is not due until `last` is left out.
    pub(super) fn find_concerned(&mut self, first: &ScheduledEvent, others: Vec<ScheduledEvent>, last: Instant) {
        let mut concerned = std::mem::take(&mut self.concerned);
        concerned.clear();
        let mut add = |pair: [Slot; 2], at: Instant| concerned.extend(pair.map(|slot| Concerned { slot, at }));
        // Events coincide if both gaps are 0 at both times.
        let coincide = |earlier: &ScheduledEvent, later: &ScheduledEvent| {
            earlier.at == later.at
                || (!earlier.at.end_of_vicinity().is_before(later.at)
                    && self.coincides(later, earlier.at)
                    && self.coincides(earlier, later.at))
        };
        let is_first_due = self.is_due(first, last);
        if is_first_due && !others.iter().any(|event| coincide(first, event)) {
            add(first.pair, first.at);
        } else if is_first_due && others.iter().all(|event| event.at == first.at && self.is_due(event, last)) {
            iter::once(first).chain(&others).for_each(|event| add(event.pair, event.at));
        } else {
            let (mut group_of, mut groups) = (BTreeMap::new(), Vec::<Group>::new());
            // The first event of the instant, and true until an event does not coincide with it.
            let (mut lead, mut accepts_groups) = (None, true);
            for event in iter::once(first).chain(&others) {
                let start = if self.bodies[event.pair[0]].infinite { event.pair[1] } else { event.pair[0] };
                accepts_groups &= lead.is_none_or(|lead| coincide(lead, event));
                if !group_of.contains_key(&start) {
                    let bodies = self.connected_by_touching(start, event.at);
                    group_of.extend(bodies.into_iter().zip(repeat(groups.len())));
                    let is_accepted = accepts_groups && self.is_due(event, last);
                    groups.push(Group { earliest: event, accepts_events: is_accepted });
                    lead = lead.or(is_accepted.then_some(event));
                }
                let group = &mut groups[group_of[&start]];
                group.accepts_events &= coincide(group.earliest, event);
                if group.accepts_events {
                    add(event.pair, group.earliest.at);
                }
            }
        }
        concerned.sort_unstable_by(|a, b| a.slot.cmp(&b.slot).then_with(|| a.at.total_cmp(b.at)));
        concerned.dedup_by_key(|body| body.slot);
        self.concerned = concerned;
    }

    /// A body of finite mass and all that are connected with it by touching, to the precision of doubles.
    fn connected_by_touching(&self, start: Slot, at: Instant) -> BTreeSet<Slot> {
        let (mut found, mut waiting) = (BTreeSet::from([start]), vec![start]);
        let mut neighbours = NeighbourBuffer::default();
        while let Some(body) = waiting.pop() {
            let sample = Sample::new(&self.bodies[body], at);
            self.find_touching(body, &sample, &mut neighbours);
            for other in neighbours.slots() {
                let neighbour = &self.bodies[*other];
                if !neighbour.infinite && sample.may_touch(neighbour) && found.insert(*other) {
                    waiting.push(*other);
                }
            }
        }
        found
    }

    fn process_patch<O: Observer>(
        &mut self,
        patch: &mut Patch,
        world: &World,
        observer: &mut O,
    ) -> Result<(), StepError> {
        self.add_concerned(patch);
        self.update_contacts(patch);
        loop {
            self.carry_out_impacts(patch, world, observer)?;
            self.update_contacts(patch);
            match self.capture_bounce(patch) {
                Some(pair) => self.count_repetition(world, pair)?,
                None => return Ok(()),
            }
        }
    }

    /// Adds the bodies concerned to the patch, and in turn each body that begins or ceases to touch one of them now:
    /// of several such events of a body, the queue holds only one.
    fn add_concerned(&mut self, patch: &mut Patch) {
        let mut waiting = std::mem::take(&mut patch.waiting);
        waiting.extend(self.concerned.iter().map(|body| self.local_of(patch, body.slot, body.at)));
        while let Some(body) = waiting.pop() {
            Axis::BOTH.into_iter().for_each(|axis| patch.mark_dirty(body, axis));
            self.explore(patch, body);
            for index in &patch.bodies[body as usize].touches {
                let touch = &patch.touches[*index as usize];
                let other = touch.other(body);
                if !patch.bodies[other as usize].infinite
                    && !patch.axis(other, Axis::X).is_dirty
                    && patch.is_changing(touch)
                {
                    waiting.push(other);
                }
            }
        }
        patch.waiting = waiting;
    }

    /// Makes the instant the reference of the bodies that it changed.
    fn write_back(&mut self, patch: &mut Patch) {
        for axis in Axis::BOTH {
            let mut changed = std::mem::take(&mut patch.changed[axis]);
            changed.sort_unstable_by_key(|body| patch.bodies[*body as usize].slot);
            place_on_faces(patch, &changed, &mut self.placement, axis);
            for body in &changed {
                let state = patch.axis_mut(*body, axis);
                state.state.velocity = state.state.velocity.or_zero(state.magnitudes.velocity * VELOCITY_ROUNDING);
                let state = state.state;
                let LocalBody { slot, at, .. } = patch.bodies[*body as usize];
                self.set_trajectory(slot, axis, state, at);
            }
            patch.changed[axis] = changed;
        }
        for body in patch.present().iter().filter(|body| body.contacts_changed) {
            self.invalidate(body.slot);
        }
    }
}

/// Places the changed bodies, in creation order, exactly on the faces that they touch, so that rounding errors do not
/// accumulate; those that do not move relative to each other get the same velocity.
///
/// Unchanged bodies and, where there is none, the earliest changed one keep their positions. Where faces form a cycle,
/// some gap may remain; bodies that do not move relative to each other are placed first, because they may be in contact.
fn place_on_faces(patch: &mut Patch, changed: &[Local], buffers: &mut Placement, axis: Axis) {
    let Placement { placed, faces, moving } = buffers;
    find_unchanged_neighbours(patch, changed, axis, placed);
    moving.clear();
    let mut unplaced = changed.iter().copied();
    let [mut next_placed, mut next_moving] = [0; 2];
    loop {
        if let Some(by) = placed.get(next_placed).copied() {
            next_placed += 1;
            find_unplaced_neighbours(patch, by, axis, faces);
            for (other, touch) in faces.iter().copied() {
                if patch.approach_speed_sign(&patch.touches[touch as usize], axis) == Ordering::Equal {
                    place_on(patch, other, by, touch, axis);
                    patch.axis_mut(other, axis).state.velocity = patch.axis(by, axis).state.velocity;
                    placed.push(other);
                } else {
                    moving.push((other, by, touch));
                }
            }
        } else if let Some((body, by, touch)) = moving.get(next_moving).copied() {
            next_moving += 1;
            if !patch.axis(body, axis).is_placed {
                place_on(patch, body, by, touch, axis);
                placed.push(body);
            }
        } else if let Some(body) = unplaced.next() {
            if !std::mem::replace(&mut patch.axis_mut(body, axis).is_placed, true) {
                placed.push(body);
            }
        } else {
            break;
        }
    }
}

/// Buffers for [`place_on_faces`].
#[derive(Clone, Debug, Default)]
pub struct Placement {
    /// The bodies that have their positions, on whose faces others are placed.
    placed: Vec<Local>,
    /// The faces of a body.
    faces: Vec<(Local, u32)>,
    /// Bodies that move relative to one that has its position, with that one and their touch.
    moving: Vec<(Local, Local, u32)>,
}

/// Replaces `found` by the unchanged bodies that touch changed ones on a face along an axis, in creation order.
fn find_unchanged_neighbours(patch: &Patch, changed: &[Local], axis: Axis, found: &mut Vec<Local>) {
    found.clear();
    for body in changed {
        let others = faces_of(patch, *body, axis).map(|(other, _)| other);
        found.extend(others.filter(|other| !patch.axis(*other, axis).has_changed));
    }
    found.sort_unstable_by_key(|body| (patch.bodies[*body as usize].slot, *body));
    found.dedup();
}

/// Replaces `found` by the changed bodies without a position that touch one on a face along an axis, in creation order,
/// with their touches.
fn find_unplaced_neighbours(patch: &Patch, body: Local, axis: Axis, found: &mut Vec<(Local, u32)>) {
    let is_unplaced = |other: Local| {
        let state = patch.axis(other, axis);
        state.has_changed && !state.is_placed
    };
    found.clear();
    found.extend(faces_of(patch, body, axis).filter(|(other, _)| is_unplaced(*other)));
    found.sort_unstable_by_key(|(other, _)| patch.bodies[*other as usize].slot);
}

/// The bodies that touch one on a face along an axis, with their touches.
fn faces_of(patch: &Patch, body: Local, axis: Axis) -> impl Iterator<Item = (Local, u32)> {
    let touches = patch.bodies[body as usize].touches.iter().copied();
    let faces = touches.filter(move |touch| patch.touches[*touch as usize].kind == TouchKind::Face(axis));
    faces.map(move |touch| (patch.touches[touch as usize].other(body), touch))
}

/// Places a body on a face of another that it touches.
fn place_on(patch: &mut Patch, body: Local, by: Local, touch: u32, axis: Axis) {
    let [body_state, by_state] = [body, by].map(|body| patch.axis(body, axis));
    let position = match patch.touches[touch as usize].side_of(by, axis) {
        Side::High => by_state.state.position + by_state.size,
        Side::Low => by_state.state.position - body_state.size,
    };
    let state = patch.axis_mut(body, axis);
    state.state.position = position;
    state.is_placed = true;
}
