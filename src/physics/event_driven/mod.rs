//! The event-driven solver: molecular dynamics of boxes from event to event. See [`EventDriven`].
//!
//! Boxes do not rotate and have no friction, so between events each body follows a parabola along each
//! axis (`axis_trajectory`, `trajectory`), and the time of impact of a pair has a closed form
//! (`pair_event`). The length of a step does not affect accuracy: it only determines when the state is
//! sampled.
//!
//! # Phases of a step
//!
//! 1. **Insert.** The bodies spawned since the last step enter the cell lists (`insert`), and
//!    overlaps that they cause are removed (`separation`).
//! 2. **Process events** in their total order (`event_queue`):
//!    - an impact of faces or corners (`collide`, `contact_cluster`, `impact`);
//!    - the end of a contact, when one body has slid past the edge of the other;
//!    - a cell crossing of a fast body (`cell_lists`).
//!
//!    When contacts begin or end (`contact`), the accelerations are solved again (`contact_solver`,
//!    `isotonic`). Each body whose trajectory or contacts changed predicts its next event again
//!    (`predict`) among its neighbours (`swept_aabb`, `neighbour_buffer`, `cell_lists`,
//!    `spatial_hash`).
//! 3. **Sample.** The states of the bodies that moved are written to the world (`dirty_states`).
//! 4. **Cross cells.** The bodies that would leave their cells in the next step are moved to their
//!    next cells (`crossing_wheel`).
//!
//! A step in which nothing moves and nothing is due does none of this. `solver_snapshot` stores what
//! is needed to continue bit for bit; `diagnose` creates the errors of a failed step.
//!
//! Predictions are computed in `f64`, impacts and contacts in double-double arithmetic
//! (`state_dd`, `double_double`, `f64x2`): rounding errors grow from collision to
//! collision and would otherwise be visible after a few hundred of them.
//!
//! # Rules
//!
//! These rules apply where mechanics leaves a choice:
//!
//! 1. **Simultaneous impacts.** Of all pairs that approach each other at an instant, the pair lowest
//!    in creation order collides first, then again the lowest, until no pair approaches. So bodies
//!    that touch in a row pass an impact on from pair to pair, as in Newton's cradle.
//! 2. **Contacts.** Two bodies are in contact if they press on each other or if a plastic impact
//!    joined them. Bodies that merely touch are not in contact.
//! 3. **Impacts on contacts.** Bodies in contact take an impact as one. A body supported, directly
//!    or through others, by an infinite mass responds like that mass, with the e of the impact; a
//!    free body responds together with all bodies that it pushes. (The alternative, to pass the
//!    impact on from pair to pair, needs infinitely many impacts in a resting stack.)
//! 4. **Corners.** Corners that touch exactly collide along both axes. If they are at rest against
//!    each other afterwards, or are pressed together from rest, they are in contact along both axes
//!    until they separate along one. Boxes whose edges only slide along the same line do not collide.
//! 5. **Inelastic collapse.** Where e < 1, an impact is plastic if it is slower than
//!    `impact::collapse_speed`, or if it follows more than `impact::COLLAPSE_LIMIT` impacts without
//!    displacement between them. All bodies in contact with the two along that axis, and all that
//!    touch them (in a slow impact: all with a relative speed of at most `collapse_speed`), move on
//!    as one. This is the limit of infinitely many impacts between them.
//! 6. **Faces coincide.** After an impact the body on the high side is placed exactly on the face of
//!    the other (or the body on the low side, if the one on the high side cannot move).
//! 7. **Touching.** Coordinates that differ by a few units in the last place touch unless the bodies
//!    move apart. Faces that touch in this sense at the instant of a sample collide before the sample.
//!
//! # Invariants
//!
//! 1. A prediction is a function of the trajectories of the two bodies alone, regardless of which of
//!    the two predicts and when. So the cell lists and the event queue, which are derived data,
//!    influence no result.
//! 2. Each body has at most one event in the queue. The event is invalidated when the generation of
//!    the partner changes; when an invalidated event is due, the body predicts again.
//! 3. Contacts along an axis lead from lower to higher coordinates, so they form no cycle and
//!    no body supports itself.

mod axis_trajectory;
mod body_state;
mod cell_lists;
mod collide;
mod contact;
mod contact_cluster;
mod contact_solver;
mod crossing_wheel;
mod diagnose;
mod dirty_states;
mod double_double;
mod event_queue;
mod f64x2;
mod impact;
mod insert;
mod instant;
mod isotonic;
mod neighbour_buffer;
mod pair_event;
mod predict;
mod separation;
mod solver_snapshot;
mod spatial_hash;
mod state_dd;
mod swept_aabb;
mod trajectory;

use super::{Axis, Body, BodyId, EngineConfig, Observer, StepError, World};
use axis_trajectory::AxisTrajectory;
use body_state::{BodyParams, BodyState, Slot};
use cell_lists::CellLists;
use contact::ContactGraph;
use contact_cluster::ContactCluster;
use crossing_wheel::CrossingWheel;
use dirty_states::DirtyStates;
use double_double::DoubleDouble;
use event_queue::EventQueue;
use instant::{Clock, Instant};
use neighbour_buffer::NeighbourBuffer;
use pair_event::PairEvent;
use state_dd::{AxisLowParts, LowParts};
use swept_aabb::SweptAabb;
use trajectory::Trajectory;

/// Repeated predictions (after cell crossings and invalidated events) allowed per body and step, beyond the
/// limit of events, before the step is aborted. No speed requires nearly as many; the limit ensures
/// that no scene hangs.
const MAX_REPREDICTIONS_PER_BODY: u64 = 1000;

/// The state of the event-driven solver.
///
/// A snapshot stores only trajectories, contacts and pending spawns. Cell lists and event queue are derived
/// from them and influence no result.
#[derive(Clone, Debug)]
pub struct EventDriven {
    clock: Clock,
    /// Acceleration along x and y, m/s².
    gravity: [f64; 2],
    /// The number of events allowed in a step.
    max_events: u64,
    /// By slot, in creation order; a deleted body keeps its slot until the slots are compacted.
    states: Vec<BodyState>,
    /// The low parts of the trajectories, by slot.
    low_parts: Vec<LowParts>,
    params: Vec<BodyParams>,
    contacts: ContactGraph,
    /// For each axis, the number of bodies with a constant force along it.
    force_counts: [u32; 2],
    /// Bodies spawned since the last step, which may still overlap others.
    pending_spawns: Vec<Slot>,
    /// The instant reached in the present step.
    now: Instant,
    /// The low part of the offset of `now`, s.
    now_low: f64,
    cell_lists: CellLists,
    event_queue: EventQueue,
    crossing_wheel: CrossingWheel,
    dirty_states: DirtyStates,
    /// Bodies whose trajectory or contacts changed at the present instant.
    changed: Vec<Slot>,
    /// For each axis, the bodies whose contacts along it changed since the accelerations were solved.
    dirty_contacts: [Vec<Slot>; 2],
    /// The number of slots when cell lists and event queue were last rebuilt.
    indexed_bodies: usize,
    /// Buffers for the two clusters of an impact.
    clusters: [ContactCluster; 2],
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
            clock,
            gravity,
            max_events: config.events_per_step,
            states: Vec::new(),
            low_parts: Vec::new(),
            params: Vec::new(),
            contacts: ContactGraph::default(),
            force_counts: [0; 2],
            pending_spawns: Vec::new(),
            now: Instant::start_of(0),
            now_low: 0.0,
            cell_lists: CellLists::new(1.0),
            event_queue: EventQueue::new(clock, 0, 0),
            crossing_wheel: CrossingWheel::new(0),
            dirty_states: DirtyStates::default(),
            changed: Vec::new(),
            dirty_contacts: [Vec::new(), Vec::new()],
            indexed_bodies: 0,
            clusters: [ContactCluster::default(), ContactCluster::default()],
            due: Vec::new(),
            neighbour_buffer: NeighbourBuffer::default(),
        }
    }

    /// Adds the last body of the world, which was spawned just now.
    pub fn add_spawned(&mut self, world: &World, step: u64) {
        let last = world.bodies.len() - 1;
        let slot = self.push_body(&world.bodies[last], last, Instant::start_of(step));
        self.pending_spawns.push(slot);
    }

    /// Appends a body without contacts, whose trajectory starts at `since`.
    fn push_body(&mut self, body: &Body, world_index: usize, since: Instant) -> Slot {
        let slot = self.states.len() as Slot;
        let force = body.constant_force;
        let infinite = body.is_infinite();
        let free_acceleration = Axis::BOTH.map(|axis| match infinite {
            true => DoubleDouble::ZERO,
            false if force[axis] == 0.0 => self.gravity[axis].into(),
            false => DoubleDouble::from(force[axis]) / body.mass.into() + self.gravity[axis].into(),
        });
        let trajectory = Trajectory::new(Axis::BOTH.map(|axis| {
            let (position, velocity) = (body.rect.origin[axis], body.velocity[axis]);
            AxisTrajectory { position, velocity, acceleration: free_acceleration[axis].high, since }
        }));
        let low_parts = Axis::BOTH
            .map(|axis| AxisLowParts { acceleration: free_acceleration[axis].low, ..AxisLowParts::default() });
        self.low_parts.push(LowParts(low_parts));
        let size = [body.rect.width(), body.rect.height()];
        self.states.push(BodyState {
            trajectory,
            size,
            since,
            generation: 0,
            world_index: world_index as u32,
            infinite,
            supported: [[false; 2]; 2],
            collapse_count: [0; 2],
        });
        let has_force = Axis::BOTH.map(|axis| !infinite && force[axis] != 0.0);
        for axis in Axis::BOTH {
            self.force_counts[axis] += u32::from(has_force[axis]);
        }
        let (mass, material) = (body.mass, body.material);
        self.params.push(BodyParams { id: body.id, mass, material, free_acceleration, has_force, alive: true });
        self.contacts.add_body();
        self.dirty_states.add_body();
        self.crossing_wheel.add_body();
        slot
    }

    /// Removes the body at `world_index`, before it is removed from the world.
    pub fn remove(&mut self, world: &World, world_index: usize, step: u64) {
        let Some(slot) = self.slot_of(world.bodies[world_index].id) else { return };
        self.advance_clock(Instant::start_of(step));
        self.params[slot as usize].alive = false;
        for axis in Axis::BOTH {
            self.force_counts[axis] -= u32::from(self.params[slot as usize].has_force[axis]);
        }
        for later in &mut self.states[slot as usize + 1..] {
            later.world_index = later.world_index.saturating_sub(1);
        }
        if let Some(index) = self.pending_spawns.iter().position(|pending| *pending == slot) {
            self.pending_spawns.remove(index);
            return;
        }
        self.states[slot as usize].generation += 1;
        self.cell_lists.remove(slot);
        self.event_queue.set(slot, None);
        self.crossing_wheel.cancel(slot);
        self.dirty_states.remove(slot);
        self.wake_dependents(slot);
    }

    fn slot_of(&self, id: BodyId) -> Option<Slot> {
        self.params.binary_search_by_key(&id, |params| params.id).ok().map(|slot| slot as Slot)
    }

    /// Advances the world by one step; the module documentation lists the phases.
    ///
    /// # Errors
    /// [`StepError::Crushed`] if a body is crushed between infinite masses,
    /// [`StepError::TooManyEvents`] if the step exceeds the limit of events,
    /// [`StepError::NotFinite`] if a number overflows. In the first two cases the world still
    /// holds the state before the step.
    pub fn step<O: Observer>(&mut self, world: &mut World, step: u64, observer: &mut O) -> Result<(), StepError> {
        if self.is_idle(step) {
            self.skip_step(step);
            return Ok(());
        }
        self.advance_clock(Instant::start_of(step));
        self.insert_spawned(world, step);
        self.process_events(world, step, Instant::NEVER, observer)?;
        self.sample(world, step)?;
        self.handle_due_crossings(step + 1);
        Ok(())
    }

    /// The world `offset` seconds after the start of `step`; the solver itself does not advance.
    ///
    /// # Errors
    /// Returns the errors of [`EventDriven::step`].
    pub fn world_after<O: Observer>(
        &self,
        world: &World,
        step: u64,
        offset: f64,
        observer: &mut O,
    ) -> Result<World, StepError> {
        let instant = Instant { step: step as f64, offset };
        let mut copy = self.clone();
        copy.now = Instant::start_of(step);
        copy.insert_spawned(world, step);
        copy.process_events(world, step, instant, observer)?;
        Ok(copy.world_at(world, instant))
    }

    /// True if no body moves and nothing is due in the step.
    fn is_idle(&self, step: u64) -> bool {
        self.pending_spawns.is_empty()
            && self.dirty_states.is_empty()
            && self.event_queue.is_step_empty(step)
            && self.crossing_wheel.is_next_bin_empty()
    }

    /// Skips a step in which [nothing happens](Self::is_idle).
    fn skip_step(&mut self, step: u64) {
        self.event_queue.skip_step(step);
        self.crossing_wheel.skip_step();
        self.advance_clock(Instant::start_of(step + 1));
    }

    /// Processes the events due in the step up to the instant `last`, in their total order.
    fn process_events<O: Observer>(
        &mut self,
        world: &World,
        step: u64,
        last: Instant,
        observer: &mut O,
    ) -> Result<(), StepError> {
        self.event_queue.begin_step(step);
        let (mut dequeued, mut events) = (0, 0);
        let max_repredictions = self.max_events.saturating_add(MAX_REPREDICTIONS_PER_BODY * self.states.len() as u64);
        while let Some((slot, event)) = self.event_queue.pop(step) {
            if last.is_before(event.at) {
                break;
            }
            dequeued += 1;
            if dequeued - events > max_repredictions {
                return Err(self.too_many_events(world, step, event.pair));
            }
            self.advance_clock(event.at);
            let Some(pair_event) = event.pair_event else {
                self.handle_cell_crossing(slot);
                continue;
            };
            let partner = if event.pair[0] == slot { event.pair[1] } else { event.pair[0] };
            if self.states[partner as usize].generation != event.partner_generation {
                self.predict(slot);
                continue;
            }
            events += 1;
            if events > self.max_events {
                return Err(self.too_many_events(world, step, event.pair));
            }
            self.changed.push(slot);
            self.handle_pair_event(world, event.pair, pair_event, observer)?;
        }
        Ok(())
    }

    /// Handles an event of two bodies, and predicts the next events of all bodies that it changed.
    fn handle_pair_event<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        event: PairEvent,
        observer: &mut O,
    ) -> Result<(), StepError> {
        match event {
            PairEvent::FaceImpact(axis) => self.collide_faces(world, pair, axis, observer)?,
            PairEvent::CornerImpact | PairEvent::CornerPress => self.collide_corners(world, pair, observer)?,
            PairEvent::ContactEnd(_) => self.end_contact(pair),
        }
        self.predict_changed();
        Ok(())
    }

    /// Invalidates all predictions that involve a body of finite mass, because its trajectory or
    /// contacts changed.
    fn invalidate(&mut self, slot: Slot) {
        let body = &mut self.states[slot as usize];
        if !body.infinite {
            body.generation = body.generation.wrapping_add(1);
            self.cell_lists.set_swept_aabb(slot, SweptAabb::EVERYWHERE);
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
            self.dirty_states.update(*slot, &self.states[*slot as usize]);
        }
        changed.clear();
        self.changed = changed;
    }

    fn name_of(&self, world: &World, slot: Slot) -> String {
        world.bodies[self.states[slot as usize].world_index as usize].name.clone()
    }
}
