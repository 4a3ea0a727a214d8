//! The event-driven solver: molecular dynamics of boxes from event to event. See [`EventDriven`].
//!
//! Boxes do not rotate and have no friction, so between events each body follows a parabola along each
//! axis (`axis_trajectory`, `trajectory`), and the time of impact of a pair has a closed form
//! (`pair_event`). The length of a step does not affect accuracy: it only determines when the state is
//! sampled.
//!
//! # Phases of a step
//!
//! 1. **Insert.** The bodies spawned since the last step enter the cell lists (`insert`), overlaps that they
//!    cause are removed (`separation`), and faces that decimal coordinates leave an ulp apart are made to coincide
//!    (`face_alignment`). The changes made by inputs are processed as an instant of their own.
//! 2. **Process events** in the order of their times (`event_queue`). An impact that involves no third body is carried
//!    out at once (`isolated`), and further impacts of a few bodies in a row follow without the queue (`closed_group`).
//!    Any other instant (`simultaneous`) is processed on the bodies that it involves (`patch`): contacts and
//!    accelerations (`resting`, `contact_group`) and impacts (`burst`). A fast body that leaves its cell is moved to
//!    the next one (`cell_lists`). Each body whose trajectory or contacts changed predicts its next event again
//!    (`predict`).
//! 3. **Sample.** The states of the bodies that moved are written to the world (`dirty_states`).
//! 4. **Find neighbours.** Without inputs for some steps, each body gets a list of neighbours for a window of several
//!    steps (`window_lists`, `home_grid`). Otherwise, the bodies that would leave their cells in the next step are
//!    moved to their next cells (`cell_lists`, `spatial_hash`).
//!
//! With many bodies, phase 3 and the start of a window run on several `threads`.
//!
//! A step in which nothing moves and nothing is due does none of this. `solver_snapshot` stores what
//! is needed to continue bit for bit; `diagnose` creates the errors of a failed step.
//!
//! # Time
//!
//! An `Instant` is a double-double number of seconds since step 0, so the step and its rate influence no event. A
//! prediction is computed in doubles and queued at the earliest time that its error bound admits (`pair_event`). When
//! it comes first, its time is computed again in double-double arithmetic (`exact`), and the event is carried out if no
//! other can be earlier. Where the error bounds of two events of a body overlap, both are computed exactly, so no
//! event hides an earlier one.
//!
//! A later event belongs to the same instant if its gap is 0 already at the time of the first, and that of the first is
//! still 0 at its time. So the length of an instant follows from coordinates and speeds and is no parameter. A pair
//! that still approaches when its computed time is past is due now.
//!
//! # Rules
//!
//! A gap is *0* if it is below the resolution of positions, an approach speed or an approach acceleration if it is
//! below the rounding of the numbers from which it was computed (`exact`). Two boxes *touch on a face* if their gap is
//! 0 along one axis and they overlap on the other, *at a corner* if both gaps are 0.
//!
//! These rules apply where mechanics leaves a choice. The chapter `solvers` of the guide explains them under the same
//! numbers.
//!
//! 1. **Contacts.** A pair that touches without approach speed and acceleration along an axis is in contact if it
//!    already was, if a plastic impact or a collapse joined it, or if the accelerations of its component differ from
//!    free fall (`resting`).
//! 2. **Impacts on contacts.** On either side of an impact the body acts together with all bodies that it pushes
//!    through contacts; if these reach an infinite mass, it acts like that mass (`burst`). Bodies that only touch pass
//!    the impact on. (To pass an impact on through contacts from pair to pair would need infinitely many impacts in a
//!    resting stack.)
//! 3. **Simultaneous impacts.** Of all approaching pairs the lowest in creation order collides, again and again until
//!    none approaches; faces come before corners, so a box that lands on flush faces does not hit the corners between
//!    them (`burst`).
//! 4. **Order of an instant**: resting, impacts, resting (`simultaneous`).
//! 5. **Corners** block only what enters them (along both axes the boxes approach, or accelerate towards each other
//!    from rest), and only along the axis of the gentler approach; along both if the approaches are equal. Those that
//!    are not entered any more because of others are released (`resting`).
//! 6. **Sliding.** A contact ends when one body slides past the edge of the other; an overlap that shrinks to 0 and
//!    grows again ends nothing. So a supported box slides over the seams of flush faces (`resting`).
//! 7. **Inelastic collapse.** An infinite sequence of impacts is replaced by its limit (`collapse`).
//! 8. **Resolution.** A bounce that does not rise by the resolution of positions is plastic (`exact`).
//! 9. **Overlapping spawns.** A spawned body of finite mass that overlaps others moves to the nearest free position
//!    (`separation`).
//! 10. **Faces coincide.** After an instant a body whose motion changed is placed exactly on the faces that it touches
//!     (`simultaneous`).
//!
//! # Invariants
//!
//! 1. A prediction is a function of the trajectories of the two bodies alone, regardless of which of the two predicts
//!    and when. So cell lists, window lists and the event queue, which are derived data, influence no result.
//! 2. Each body has at most one event in the queue. The event is invalidated when the generation of the partner
//!    changes; when an invalidated event is due, the body predicts again.
//! 3. After an instant, no touching pair approaches, and none without a contact accelerates towards each other from
//!    rest. Where the alignment of faces makes a pair touch that does, its impact is due at the same time; where the
//!    gap of a pair falls below the resolution shortly before its impact, this is still queued.
//!
//! The invariants of the parts are documented at `Bodies`, `ContactGraph`, `CellLists`, `WindowLists`, `HomeGrid` and
//! `EventQueue`.

// Numbers and time.
mod decimal;
mod double_double;
mod instant;
#[cfg(test)]
mod pseudo_random;
mod random_rounding;
mod timeline;

// Bodies, their trajectories and their contacts.
mod axis_trajectory;
mod bodies;
mod body_state;
mod contact;
mod reference;
mod trajectory;

// Phase 1: insert.
mod face_alignment;
mod insert;
mod separation;

// Phase 2: predict events and process them in order.
mod event_limit;
mod event_queue;
mod exact;
mod pair_event;
mod predict;

// The impact law, and impacts of two bodies that touch no third.
mod closed_group;
mod impact;
mod impact_record;
mod isolated;

// Instants of any bodies that touch.
mod burst;
mod collapse;
mod contact_group;
mod impact_history;
mod patch;
mod resting;
mod simultaneous;

// Phase 3: sample.
mod dirty_states;
mod threads;

// Phase 4: find neighbours.
mod cell_lists;
mod home_grid;
mod neighbour_buffer;
mod spatial_hash;
mod swept_aabb;
mod window_lists;

// Snapshots and errors.
mod diagnose;
mod solver_snapshot;

use super::{Axis, Body, BodyId, EngineConfig, Observer, StepError, World, larger};
use axis_trajectory::StateDd;
use bodies::Bodies;
use body_state::Slot;
use burst::Cluster;
use cell_lists::CellLists;
use contact::ContactGraph;
use contact_group::ContactGroup;
use decimal::stated;
use dirty_states::DirtyStates;
use double_double::DoubleDouble;
use event_limit::{EventLimit, LimitExceeded};
use event_queue::{EventQueue, Precision, ScheduledEvent};
use impact::LatestShares;
use instant::{Clock, Instant, VICINITY};
use neighbour_buffer::NeighbourBuffer;
use pair_event::PairEvent;
use patch::{Local, Patch};
use simultaneous::{Concerned, Placement};
use std::hint::black_box;
use std::num::NonZero;
use swept_aabb::SweptAabb;
use threads::Threads;
use timeline::Timeline;
use window_lists::WindowLists;

/// The event-driven solver.
///
/// A snapshot stores the present instant, trajectories, low parts of sizes, contacts, loads, pending spawns and wakes.
/// Cell lists, window lists and event queue are derived from them and influence no result.
#[derive(Clone, Debug)]
pub struct EventDriven {
    threads: Threads,
    bodies: Bodies,
    /// The coefficients of restitution as the decimals that they stand for, by `Restitution::index`.
    restitutions: Vec<DoubleDouble>,
    contacts: ContactGraph,
    /// Bodies spawned since the last step, which may still overlap others.
    pending_spawns: Vec<Slot>,
    /// Bodies that lost a contact because another was deleted since the last step; some may have been deleted after
    /// that.
    pending_wakes: Vec<Slot>,
    /// True to assert the invariants between instants, in debug builds.
    asserts_invariants: bool,
    timeline: Timeline,
    event_limit: EventLimit,
    /// In use outside windows.
    cell_lists: CellLists,
    window_lists: WindowLists,
    event_queue: EventQueue,
    dirty_states: DirtyStates,
    /// Bodies whose trajectory or contacts changed at the present instant.
    changed: Vec<Slot>,
    /// Two bodies that have just collided and have no event with each other until one of them changes.
    receding: Option<[Slot; 2]>,
    /// The number of events from one search for a closed group to the next.
    #[cfg(test)]
    search_interval: u64,
    /// The number of impacts carried out in closed groups.
    #[cfg(test)]
    impacts_in_groups: u64,
    /// True to examine also the spawned bodies that touch no other.
    #[cfg(test)]
    examines_all_spawned: bool,
    /// The number of slots when cell lists and event queue were last rebuilt.
    indexed_bodies: usize,
    /// Buffer for the bodies concerned by the next instant, before they are added to the patch.
    concerned: Vec<Concerned>,
    /// Buffer for the bodies concerned by an instant; `None` during the instant, and before the first. Behind a pointer,
    /// since each instant takes it out: a heap of 10³ boxes needs 0.7 % fewer instructions.
    patch: Option<Box<Patch>>,
    /// Buffers for the alignment of faces at the end of an instant.
    placement: Placement,
    /// Buffer for the bodies whose contacts were examined.
    examined: Vec<Local>,
    /// Buffer for a component of bodies in contact.
    contact_group: ContactGroup,
    latest_shares: LatestShares,
    /// Buffers for the two clusters of an impact.
    clusters: [Cluster; 2],
    /// Buffer for the bodies that are due to cross a cell border.
    due: Vec<Slot>,
    /// Buffer for the neighbours of a body.
    neighbour_buffer: NeighbourBuffer,
}

impl EventDriven {
    /// The solver of an empty world.
    pub fn new(config: &EngineConfig) -> EventDriven {
        let clock = Clock::new(config.rate);
        let gravity = config.gravity.map_or([0.0; 2], |gravity| [gravity.x, gravity.y]);
        EventDriven {
            threads: Threads::new(None),
            bodies: Bodies::new(gravity),
            restitutions: config.restitution.table().iter().map(|restitution| stated(*restitution)).collect(),
            contacts: ContactGraph::default(),
            pending_spawns: Vec::new(),
            pending_wakes: Vec::new(),
            asserts_invariants: false,
            timeline: Timeline::new(clock),
            event_limit: EventLimit::new(config.events_per_step),
            cell_lists: CellLists::new(1.0),
            window_lists: WindowLists::default(),
            event_queue: EventQueue::new(clock, 0, 0),
            dirty_states: DirtyStates::default(),
            changed: Vec::new(),
            receding: None,
            #[cfg(test)]
            search_interval: closed_group::SEARCH_INTERVAL,
            #[cfg(test)]
            impacts_in_groups: 0,
            #[cfg(test)]
            examines_all_spawned: false,
            indexed_bodies: 0,
            concerned: Vec::new(),
            patch: None,
            placement: Placement::default(),
            examined: Vec::new(),
            contact_group: ContactGroup::default(),
            latest_shares: LatestShares::default(),
            clusters: [Cluster::default(), Cluster::default()],
            due: Vec::new(),
            neighbour_buffer: NeighbourBuffer::default(),
        }
    }

    /// Sets the number of threads; `None` stands for as many as the system can run at the same time.
    pub fn set_threads(&mut self, count: Option<NonZero<u32>>) {
        self.threads = Threads::new(count);
    }

    /// Adds the last body of the world, which was spawned just now.
    pub fn add_spawned(&mut self, world: &World, step: u64) {
        self.disturb_window(step);
        let last = world.bodies.len() - 1;
        let slot = self.push_body(&world.bodies[last], last, self.timeline.now_in(step));
        self.pending_spawns.push(slot);
    }

    /// The bodies spawned since the last step.
    pub fn pending_spawns(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.pending_spawns.iter().map(|slot| self.bodies.params(*slot).id)
    }

    /// Appends a body without contacts, whose trajectory starts at `since`.
    fn push_body(&mut self, body: &Body, world_index: usize, since: Instant) -> Slot {
        self.contacts.add_body(body.mass);
        self.dirty_states.add_body();
        self.bodies.push(body, world_index, since)
    }

    /// Removes the body at `world_index`, before it is removed from the world.
    pub fn remove(&mut self, world: &World, world_index: usize, step: u64) {
        let Some(slot) = self.bodies.slot_of(world.bodies[world_index].id) else { return };
        self.begin_at(step);
        self.disturb_window(step);
        self.bodies.delete(slot);
        if let Ok(index) = self.pending_spawns.binary_search(&slot) {
            self.pending_spawns.remove(index);
            return;
        }
        self.cell_lists.remove(slot);
        self.event_queue.remove(slot);
        self.dirty_states.remove(slot);
        self.pending_wakes.extend(self.contacts.remove_all(slot));
    }

    /// Skips the present step if no body moves and nothing is due in it; returns false otherwise.
    #[inline]
    pub fn skip_idle_step(&mut self) -> bool {
        let is_idle = self.dirty_states.is_empty()
            && self.pending_spawns.is_empty()
            && self.pending_wakes.is_empty()
            && self.event_queue.is_step_empty();
        if is_idle {
            self.event_queue.skip_step();
        }
        is_idle
    }

    /// Advances the world by one step; the module documentation lists the phases.
    ///
    /// # Errors
    /// [`StepError::Crushed`] if a body is crushed between infinite masses, [`StepError::Endless`] if impacts repeat
    /// without end, [`StepError::TooManyEvents`] if the step exceeds the limit of events, [`StepError::NotFinite`] if a
    /// number overflows. Except in the last case, the world still holds the state before the step.
    pub fn step<O: Observer>(&mut self, world: &mut World, step: u64, observer: &mut O) -> Result<(), StepError> {
        self.begin_at(step);
        self.apply_inputs(world, observer)?;
        self.process_events(world, self.timeline.step_end(), observer)?;
        self.dirty_states.sample(&self.bodies, world, step, self.timeline.step_end(), self.threads)?;
        self.cross_cells(step + 1);
        Ok(())
    }

    /// A copy that has begun `step`, for [`EventDriven::world_after`].
    ///
    /// # Errors
    /// Returns the errors of [`EventDriven::step`].
    pub fn begun<O: Observer>(&self, world: &World, step: u64, observer: &mut O) -> Result<EventDriven, StepError> {
        let mut copy = self.clone();
        copy.begin_at(step);
        copy.apply_inputs(world, observer)?;
        Ok(copy)
    }

    /// Advances within the step that was [begun](Self::begun), and returns the world `offset` seconds after its start.
    /// `world` is that at the start. The offsets must not decrease.
    ///
    /// # Errors
    /// Returns the errors of [`EventDriven::step`].
    pub fn world_after<O: Observer>(
        &mut self,
        world: &World,
        offset: f64,
        observer: &mut O,
    ) -> Result<World, StepError> {
        let instant = self.timeline.step_start().after(offset);
        self.process_events(world, instant, observer)?;
        Ok(self.dirty_states.world_at(&self.bodies, world, instant))
    }

    /// Asserts the invariants after each instant from now on, in debug builds and with few bodies.
    pub fn assert_invariants(&mut self) {
        self.asserts_invariants = true;
    }

    /// From now on rounds at random, with numbers that follow from `seed`, and computes with a resolution that is finer
    /// or coarser by a factor.
    pub fn perturb(&mut self, seed: u64, factor: f64) {
        self.bodies.perturb(seed, factor);
    }

    /// The greatest difference between the positions of the bodies along an axis here and in `other` in the state of
    /// `step`, m, in double-double precision; infinite if the bodies are not the same.
    pub fn distance_to(&self, other: &EventDriven, step: u64) -> f64 {
        let at = self.timeline.clock().start_of(step);
        let [slots, other_slots] = [self, other].map(|solver| solver.bodies.alive().collect::<Vec<Slot>>());
        if slots.len() != other_slots.len() {
            return f64::INFINITY;
        }
        let distances = slots.into_iter().zip(other_slots).flat_map(|(slot, other_slot)| {
            Axis::BOTH.map(|axis| {
                let position = self.bodies.state_at(slot, axis, at).position;
                (position - other.bodies.state_at(other_slot, axis, at).position).high.abs()
            })
        });
        distances.fold(0.0, larger)
    }

    /// Sets the present step and instant.
    fn begin_at(&mut self, step: u64) {
        self.event_limit.begin_step();
        self.timeline.begin_at(step);
    }

    /// Inserts the bodies spawned since the last step and processes the instant for all that the inputs concern.
    fn apply_inputs<O: Observer>(&mut self, world: &World, observer: &mut O) -> Result<(), StepError> {
        self.bodies.update_world_indices();
        if self.pending_spawns.is_empty() && self.pending_wakes.is_empty() && self.changed.is_empty() {
            return Ok(());
        }
        self.changed.retain(|slot| self.bodies.params(*slot).alive);
        let mut concerned = self.insert_spawned(world)?;
        concerned.append(&mut self.pending_wakes);
        concerned.sort_unstable();
        concerned.dedup();
        concerned.retain(|slot| self.bodies.params(*slot).alive && !self.bodies[*slot].infinite);
        if concerned.is_empty() {
            self.predict_changed();
            return Ok(());
        }
        let at = self.timeline.now();
        self.concerned.clear();
        self.concerned.extend(concerned.into_iter().map(|slot| Concerned { slot, at }));
        self.process_instant(world, observer)
    }

    /// Processes the events up to the instant `last`, and those that coincide with it, in the order of their times.
    fn process_events<O: Observer>(&mut self, world: &World, last: Instant, observer: &mut O) -> Result<(), StepError> {
        if self.event_queue.next_time().high > last.high * VICINITY {
            return Ok(());
        }
        let end = last.end_of_vicinity();
        while let Some((slot, event)) = self.event_queue.pop(end) {
            self.read_ahead();
            if event.pair_event.is_none() {
                self.timeline.advance_to(if last.is_before(event.at) { last } else { event.at });
            }
            let pair = event.pair;
            let Some(event) = self.next_exact_event(slot, event, end) else {
                self.count_repetition(world, pair)?;
                continue;
            };
            let is_due = self.is_due(&event, last);
            if is_due {
                self.timeline.advance_to(event.at);
                self.event_limit.count_event().map_err(|LimitExceeded| self.too_many_events(world, pair))?;
            }
            self.changed.push(slot);
            let next = self.event_queue.next_time();
            // The first comparison mostly decides, without arithmetic in double-double.
            let is_alone = event.at.high * VICINITY < next.high || event.at.end_of_vicinity().is_before(next);
            let others = if is_alone { Vec::new() } else { self.collect_simultaneous(world, event.at)? };
            if others.is_empty() && self.collide_at_once(world, &event, last, observer) {
                self.predict_changed();
                self.receding = None;
            } else {
                self.find_concerned(&event, others, last);
                if self.concerned.is_empty() {
                    self.predict_changed();
                    return Ok(());
                }
                // The first event, which is after `last`, must wait.
                if !is_due {
                    self.timeline.advance_to(last);
                    self.event_limit.count_event().map_err(|LimitExceeded| self.too_many_events(world, pair))?;
                }
                let instant = self.event_limit.begin_instant();
                self.process_instant(world, observer)?;
                self.event_limit.end_instant(instant);
            }
            // An event that coincides with `last` does not delay the inputs then.
            self.timeline.return_to(last);
            #[cfg(debug_assertions)]
            if self.asserts_invariants {
                self.assert_consistent();
            }
        }
        Ok(())
    }

    /// Carries out the event if it is an isolated impact at the present instant, and the next impacts of its closed
    /// group up to the instant `last`; returns true if it did. Inlined, since most events of a gas are isolated
    /// impacts.
    #[inline(always)]
    fn collide_at_once<O: Observer>(
        &mut self,
        world: &World,
        event: &ScheduledEvent,
        last: Instant,
        observer: &mut O,
    ) -> bool {
        let Some(PairEvent::FaceImpact(axis, side)) = event.pair_event else { return false };
        let is_present = event.at == self.timeline.now() && !last.is_before(event.at);
        if !is_present || !self.collide_isolated(world, event.pair, axis, side, observer) {
            return false;
        }
        self.continue_in_closed_group(world, axis, last, observer);
        true
    }

    /// With many bodies, reads the records of those with events in a new slice of the queue, and the paths of their
    /// neighbours.
    ///
    /// The processor then waits for many cache misses at the same time, not for one after the other: all reading ahead
    /// makes a gas of 10⁵ 1.2 times as fast and one of 10⁶ 1.4 times (`cargo bench --bench event_driven`, with and
    /// without it in turn).
    #[inline]
    fn read_ahead(&mut self) {
        if !self.window_lists.is_active() {
            return;
        }
        let Some(pairs) = self.event_queue.pairs_to_read_ahead() else { return };
        let mut sum = 0.0;
        for slot in pairs.clone().flatten() {
            sum += self.bodies.read_ahead(slot) + self.window_lists.read_ahead(slot);
            sum += f64::from(self.dirty_states.read_ahead(slot));
        }
        for slot in pairs.flatten() {
            self.window_lists.visit(slot, |other| sum += self.window_lists.path(other).longer_side());
        }
        black_box(sum);
    }

    /// Returns the event taken from the queue with its exact time if it comes next and not after `last`; the event of
    /// the same pair that the partner may have is then removed, and the partner is among those that predict again.
    /// Otherwise the body has predicted again, or the event is back in the queue with its exact time.
    fn next_exact_event(&mut self, slot: Slot, event: ScheduledEvent, last: Instant) -> Option<ScheduledEvent> {
        let Some(kind) = event.pair_event else {
            self.handle_cell_crossing(slot);
            return None;
        };
        let partner = if event.pair[0] == slot { event.pair[1] } else { event.pair[0] };
        if self.bodies[partner].generation != event.partner_generation {
            self.predict(slot);
            return None;
        }
        let generation = self.bodies[slot].generation;
        if event.precision == Precision::Exact {
            let twin = self.event_queue.take_event_of(partner, event.pair, generation);
            self.changed.extend(twin.map(|_| partner));
            return Some(event);
        }
        if event.precision == Precision::Contested {
            self.predict_to(slot, Precision::Exact);
            return None;
        }
        let exact = match kind {
            PairEvent::FaceImpact(axis, side) => self.exact_face_impact(event.pair, axis, side).map(|at| (at, kind)),
            PairEvent::CornerImpact(..) | PairEvent::ContactEnd(..) => self.predict_exactly(event.pair),
        };
        let Some((at, kind)) = exact else {
            self.predict_to(slot, Precision::Exact);
            return None;
        };
        let event = ScheduledEvent { at, pair_event: Some(kind), precision: Precision::Exact, ..event };
        let twin = self.event_queue.take_event_of(partner, event.pair, generation);
        if twin.is_some_and(|twin| twin.precision == Precision::Contested) {
            self.event_queue.set(slot, Some(event));
            self.predict_to(partner, Precision::Exact);
            return None;
        }
        if !last.is_before(at) && at.is_before(self.event_queue.next_time()) {
            self.changed.extend(twin.map(|_| partner));
            return Some(event);
        }
        self.event_queue.set(slot, Some(event));
        if let Some(twin) = twin {
            self.event_queue
                .set(partner, Some(ScheduledEvent { partner_generation: twin.partner_generation, ..event }));
        }
        None
    }

    /// Counts a repetition for a pair of bodies against its limit.
    fn count_repetition(&mut self, world: &World, pair: [Slot; 2]) -> Result<(), StepError> {
        let counted = self.event_limit.count_repetition(self.bodies.len());
        counted.map_err(|LimitExceeded| self.too_many_events(world, pair))
    }

    /// The present instant for a pair of bodies: the later one of the clock and their references. If an instant
    /// consists of several groups of bodies, or coincides with a sample, some references are later than the clock by
    /// rounding.
    #[inline]
    fn now_of(&self, pair: [Slot; 2]) -> Instant {
        self.timeline.now().max(self.bodies.common_reference(pair))
    }

    /// The state of a body along an axis at the present instant.
    #[inline]
    fn state_dd(&self, slot: Slot, axis: Axis) -> StateDd {
        self.bodies.state_at(slot, axis, self.timeline.now())
    }

    /// Sets the trajectory of a body along one axis from an instant on, and invalidates its predictions.
    fn set_trajectory(&mut self, slot: Slot, axis: Axis, state: StateDd, at: Instant) {
        self.bodies.set_trajectory(slot, axis, state, at);
        self.invalidate(slot);
    }

    /// Invalidates all predictions that involve a body of finite mass, because its trajectory or
    /// contacts changed.
    fn invalidate(&mut self, slot: Slot) {
        if !self.bodies[slot].infinite {
            self.bodies.invalidate(slot);
            if self.window_lists.is_active() {
                self.window_lists.invalidate(slot);
            } else {
                self.cell_lists.set_swept_aabb(slot, SweptAabb::EVERYWHERE);
            }
            self.changed.push(slot);
        }
    }

    /// Predicts the next events of all bodies that changed at the present instant.
    fn predict_changed(&mut self) {
        let mut changed = std::mem::take(&mut self.changed);
        if changed.len() > 2 {
            changed.sort_unstable();
        }
        changed.dedup();
        for slot in &changed {
            self.predict(*slot);
            self.dirty_states.update(*slot, &self.bodies[*slot]);
        }
        changed.clear();
        self.changed = changed;
    }

    fn name_of(&self, world: &World, slot: Slot) -> String {
        world.bodies[self.bodies[slot].world_index as usize].name.clone()
    }
}
