//! Predicts the next event of a body: the first event with another body or the next cell crossing.

use super::EventDriven;
use super::body_state::Slot;
use super::contact::Contact;
use super::event_queue::{MIN_READ_AHEAD, Precision, ScheduledEvent};
use super::instant::Instant;
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::{Prediction, Sample, predict_contact_end, predict_pair_event};
use super::swept_aabb::SweptAabb;
use crate::physics::{Side, smaller};
use std::hint::black_box;

/// The pair in creation order.
pub fn ordered_pair(slot: Slot, other: Slot) -> [Slot; 2] {
    if slot < other { [slot, other] } else { [other, slot] }
}

/// Finds the first event of one body among those with its candidate partners.
struct Predictor<'a> {
    solver: &'a EventDriven,
    /// The contacts listed with the body.
    own_contacts: &'a [Contact],
    slot: Slot,
    /// A body with which it has no event.
    receding: Option<Slot>,
    precision: Precision,
    /// The state at the later of the body's reference times.
    sample: Sample<'a>,
    /// The earliest event found so far, and the seconds from the sample until it happens at the latest.
    first: Option<(ScheduledEvent, f64)>,
    /// The earliest time of any other event, in seconds from the sample.
    runner_up: f64,
    /// Seconds from the sample to the time by which the body predicts again in any case.
    horizon: f64,
}

/// Factor by which the horizon exceeds the time to an event: more than any rounding, so that simultaneous
/// events are compared in their total order and not cut off.
const HORIZON_MARGIN: f64 = 1.0 + 1e-9;

/// The factor from a time since step 0 to one that is certainly later, whatever the rounding.
const LATENESS: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;

/// The number of pairs whose records are read at the same time, so that the processor waits for many cache misses
/// together.
const READ_AHEAD: usize = 64;

impl<'a> Predictor<'a> {
    fn new(solver: &'a EventDriven, slot: Slot, precision: Precision) -> Predictor<'a> {
        let body = &solver.bodies[slot];
        Predictor::with(solver, slot, precision, Sample::new(body, body.since))
    }

    /// The same, given the state at the later of the body's reference times.
    #[inline(always)]
    fn with(solver: &'a EventDriven, slot: Slot, precision: Precision, sample: Sample<'a>) -> Predictor<'a> {
        let own_contacts = solver.contacts.of(slot);
        let receding = match solver.receding {
            Some([first, second]) if first == slot => Some(second),
            Some([first, second]) if second == slot => Some(first),
            Some(_) | None => None,
        };
        Predictor {
            solver,
            own_contacts,
            slot,
            receding,
            precision,
            sample,
            first: None,
            runner_up: f64::INFINITY,
            horizon: f64::INFINITY,
        }
    }

    /// The seconds from `now` to the horizon, at most `limit`.
    fn seconds_to_horizon(&self, now: Instant, limit: f64) -> f64 {
        let seconds = self.horizon - self.sample.at.seconds_until(now);
        smaller(seconds, limit)
    }

    /// Predicts the next event with another body; returns true if that lowered the horizon.
    #[inline(always)]
    fn predict_pair(&mut self, other: Slot) -> bool {
        if Some(other) == self.receding {
            debug_assert_eq!(self.solver.predict_exactly(ordered_pair(self.slot, other)), None);
            return false;
        }
        self.predict_candidate(other)
    }

    /// The same for a body from which it does not recede.
    fn predict_candidate(&mut self, other: Slot) -> bool {
        let partner = &self.solver.bodies[other];
        if self.sample.is_infinite() && partner.infinite {
            return false;
        }
        if self.is_in_contact(other) {
            return false;
        }
        let order = if self.slot < other { Side::Low } else { Side::High };
        match predict_pair_event(&self.sample, partner, order, self.horizon, self.solver.timeline.now()) {
            Prediction::None => false,
            prediction => self.keep(other, prediction),
        }
    }

    /// Keeps the event of a prediction if it is the earliest; returns true if that lowered the horizon.
    fn keep(&mut self, other: Slot, prediction: Prediction) -> bool {
        let (at, pair_event, upper, precision) = match prediction {
            Prediction::Event { not_before, upper, event } if self.precision == Precision::LowerBound => {
                (not_before, event, upper, Precision::LowerBound)
            }
            Prediction::Event { not_before, .. }
                if self.first.is_some_and(|(first, _)| first.at.is_before(not_before)) =>
            {
                return false;
            }
            Prediction::None => return false,
            Prediction::Unclear | Prediction::Event { .. } => {
                match self.solver.predict_exactly(ordered_pair(self.slot, other)) {
                    Some((at, event)) => (at, event, 0.0, Precision::Exact),
                    None => return false,
                }
            }
        };
        let partner_generation = self.solver.bodies[other].generation;
        let pair = ordered_pair(self.slot, other);
        let event = ScheduledEvent { at, pair, pair_event: Some(pair_event), partner_generation, precision };
        let seconds = self.sample.at.seconds_until(at);
        let latest = seconds + upper;
        let runner_up = match self.first {
            Some((first, _)) if !event.is_before(&first) => seconds,
            previous => {
                self.first = Some((event, latest));
                previous.map_or(f64::INFINITY, |(previous, _)| self.sample.at.seconds_until(previous.at))
            }
        };
        self.runner_up = smaller(runner_up, self.runner_up);
        self.limit_horizon(latest)
    }

    /// The earliest event.
    fn first(&self) -> Option<ScheduledEvent> {
        let (first, latest) = self.first?;
        let is_contested = first.precision == Precision::LowerBound && self.runner_up <= latest;
        Some(if is_contested { ScheduledEvent { precision: Precision::Contested, ..first } } else { first })
    }

    /// The time in seconds at which the earliest event happens at the latest, and somewhat more than its rounding.
    fn latest(&self) -> f64 {
        self.first.map_or(f64::INFINITY, |(_, latest)| (self.sample.at.high + latest) * LATENESS)
    }

    /// Lowers the horizon to `seconds` after the sample, unless it is earlier; returns true if it changed.
    #[inline]
    fn limit_horizon(&mut self, seconds: f64) -> bool {
        let horizon = seconds * HORIZON_MARGIN;
        let is_lower = horizon < self.horizon;
        if is_lower {
            self.horizon = horizon;
        }
        is_lower
    }

    /// Returns true if the body is in contact with `other`.
    #[inline]
    fn is_in_contact(&self, other: Slot) -> bool {
        if self.sample.is_infinite() {
            self.solver.contacts.axes_between([other, self.slot]) != [false; 2]
        } else {
            self.own_contacts.iter().any(|contact| contact.other == other)
        }
    }

    /// Keeps the first end of a contact of the body if that is the earliest event.
    fn predict_contact_ends(&mut self) {
        for contact in self.own_contacts {
            let [first, second] = ordered_pair(self.slot, contact.other).map(|slot| &self.solver.bodies[slot]);
            // The start of a window does not predict contact ends again, so only an earlier event limits the time.
            let horizon = self.first.map_or(f64::INFINITY, |(_, latest)| latest * HORIZON_MARGIN);
            let prediction = predict_contact_end(contact.axis, first, second, horizon, self.solver.timeline.now());
            self.keep(contact.other, prediction);
        }
    }
}

/// The event of a pair of bodies that was predicted at the start of a window.
#[derive(Clone, Debug)]
pub struct PredictedEvent {
    /// The body that predicted it.
    slot: Slot,
    event: ScheduledEvent,
    /// The time in seconds at which it happens at the latest.
    latest: f64,
}

impl EventDriven {
    /// Predicts the next event of a body among its neighbours and enters it in the queue.
    pub(super) fn predict(&mut self, slot: Slot) {
        self.predict_to(slot, Precision::LowerBound);
    }

    /// Predicts the next event of a body, its time in doubles ([`Precision::LowerBound`]) or in double-double
    /// arithmetic ([`Precision::Exact`]).
    pub(super) fn predict_to(&mut self, slot: Slot, precision: Precision) {
        let body = &self.bodies[slot];
        match (self.window_lists.is_active(), body.is_static()) {
            (true, true) => {}
            (true, false) => self.predict_in_window(slot, precision),
            (false, true) => {
                let aabb = SweptAabb::new(&Sample::new(body, self.timeline.now()), 0.0);
                self.cell_lists.set_swept_aabb(slot, aabb);
            }
            (false, false) => {
                let mut neighbours = std::mem::take(&mut self.neighbour_buffer);
                self.predict_in_cell(slot, precision, &mut neighbours);
                self.neighbour_buffer = neighbours;
            }
        }
    }

    /// Predicts the next event of a body among those in its cell and the adjacent ones.
    fn predict_in_cell(&mut self, slot: Slot, precision: Precision, neighbours: &mut NeighbourBuffer) {
        let body = &self.bodies[slot];
        let mut predictor = Predictor::new(self, slot, precision);
        let (mut exit_time, mut swept) = (f64::INFINITY, SweptAabb::EVERYWHERE);
        if self.cell_lists.uses_all_pairs() {
            let others = self.cell_lists.few().iter().filter(|other| **other != slot);
            others.for_each(|other| _ = predictor.predict_pair(*other));
        } else {
            let sample = predictor.sample.at_time(self.timeline.now());
            exit_time = self.cell_lists.cell_exit_time(slot, &sample);
            predictor.limit_horizon(predictor.sample.at.seconds_until(self.timeline.now()) + exit_time);
            swept = SweptAabb::new(&sample, exit_time);
            self.cell_lists.find_neighbours(slot, body, &swept, neighbours);
            for other in neighbours.slots() {
                if !swept.is_disjoint_from(self.cell_lists.swept_aabb(*other)) && predictor.predict_pair(*other) {
                    swept = SweptAabb::new(&sample, predictor.seconds_to_horizon(self.timeline.now(), exit_time));
                }
            }
        }
        predictor.predict_contact_ends();
        let first = predictor.first();
        self.cell_lists.set_swept_aabb(slot, swept);
        self.schedule_next(slot, first, exit_time);
    }

    /// Predicts the next event of a body among those in its list, up to the end of the window.
    fn predict_in_window(&mut self, slot: Slot, precision: Precision) {
        let body = &self.bodies[slot];
        let sample = Sample::new(body, self.timeline.now());
        let path = self.window_lists.set_path(slot, &sample, self.timeline.step());
        self.window_lists.find_neighbours(slot, &path, &mut self.neighbour_buffer);
        let mut predictor = Predictor::with(self, slot, precision, sample.at_time(body.since));
        predictor.limit_horizon(predictor.sample.at.seconds_until(self.window_lists.valid_until()));
        self.neighbour_buffer.slots().iter().for_each(|other| _ = predictor.predict_pair(*other));
        predictor.predict_contact_ends();
        let (first, latest) = (predictor.first(), predictor.latest());
        self.event_queue.set_until(slot, first, latest);
    }

    /// Predicts the pairs whose paths overlap in a new window. If the event of a pair is before the pending one of the
    /// first body, it replaces it; if doubles cannot distinguish them, the body is to predict again.
    pub(super) fn predict_close_pairs(&mut self) {
        let mut found = std::mem::take(&mut self.window_lists.events);
        let parts = self.window_lists.close_pairs();
        found.resize_with(parts.len(), Vec::new);
        self.threads_of_window().share(parts.zip(&mut found), |(pairs, found)| {
            for (index, pair) in pairs.iter().enumerate() {
                if index % READ_AHEAD == 0 && self.bodies.len() >= MIN_READ_AHEAD {
                    let ahead = pairs[index..].iter().take(READ_AHEAD).flatten();
                    let read = |slot: &Slot| self.bodies[*slot].read_ahead() + self.event_queue.time_of(*slot);
                    black_box(ahead.map(read).sum::<f64>());
                }
                self.predict_close_pair(*pair, found);
            }
        });
        for PredictedEvent { slot, event, latest } in found.iter().flatten() {
            if self.latest_in_window(*slot).is_before(event.at) {
                continue;
            }
            if *latest < self.event_queue.time_of(*slot) {
                self.event_queue.set_until(*slot, Some(*event), *latest);
            } else {
                self.changed.push(*slot);
            }
        }
        found.iter_mut().for_each(Vec::clear);
        self.window_lists.events = found;
    }

    /// Adds the event of a pair whose paths overlap in a new window to `found`, unless it is after the pending one of
    /// the first body.
    fn predict_close_pair(&self, [slot, other]: [Slot; 2], found: &mut Vec<PredictedEvent>) {
        let end = self.latest_in_window(slot);
        let mut predictor = Predictor::new(self, slot, Precision::LowerBound);
        predictor.limit_horizon(predictor.sample.at.seconds_until(end));
        predictor.predict_pair(other);
        if let Some((event, _)) = &predictor.first
            && !end.is_before(event.at)
        {
            found.push(PredictedEvent { slot, event: *event, latest: predictor.latest() });
        }
    }

    /// The latest instant of the pending event of a body, or the end of the window if that is earlier.
    fn latest_in_window(&self, slot: Slot) -> Instant {
        let (latest, end) =
            (Instant { high: self.event_queue.latest(slot), low: 0.0 }, self.window_lists.valid_until());
        if latest.is_before(end) { latest } else { end }
    }

    /// Moves a body to its next cell and predicts its next event there.
    pub(super) fn handle_cell_crossing(&mut self, slot: Slot) {
        let sample = Sample::new(&self.bodies[slot], self.timeline.now());
        let remaining = self.timeline.clock().period - self.timeline.elapsed();
        self.cell_lists.move_to_next_cell(self.timeline.clock(), slot, &sample, remaining);
        self.predict(slot);
    }

    /// Moves the bodies that would leave their cells in `step`, which begins now, to their next cells.
    pub(super) fn cross_cells(&mut self, step: u64) {
        self.begin_at(step);
        let mut due = std::mem::take(&mut self.due);
        self.event_queue.begin_next_step(&mut due);
        due.drain(..).for_each(|slot| self.handle_cell_crossing(slot));
        self.due = due;
        self.begin_window(step);
    }

    /// Schedules the next event of a body: its first pair event or the exit from its cell in `exit_time`
    /// seconds. A cell exit after the current step is a crossing before a later step.
    fn schedule_next(&mut self, slot: Slot, pair_event: Option<ScheduledEvent>, exit_time: f64) {
        let offset = self.timeline.elapsed() + exit_time;
        let (mut crossing, mut next_prediction) = (None, f64::INFINITY);
        if offset <= self.timeline.clock().period {
            crossing = Some(ScheduledEvent {
                at: self.timeline.now().after(exit_time),
                pair: [slot, slot],
                pair_event: None,
                partner_generation: 0,
                precision: Precision::Exact,
            });
        } else if offset == f64::INFINITY {
            self.event_queue.set_crossing(slot, None);
        } else {
            let steps = (offset * self.timeline.clock().rate) as u32;
            let steps = if steps > 1 { steps } else { 1 };
            self.event_queue.set_crossing(slot, Some(steps));
            next_prediction =
                self.timeline.step_start().high + f64::from(steps) * self.timeline.clock().period * HORIZON_MARGIN;
        }
        let pair_event = pair_event.filter(|event| event.at.high <= next_prediction * HORIZON_MARGIN);
        let is_crossing_first = match (&pair_event, &crossing) {
            (Some(event), Some(crossing)) => crossing.at.is_before(event.at),
            (Some(_), None) => false,
            (None, Some(_) | None) => true,
        };
        self.event_queue.set(slot, if is_crossing_first { crossing } else { pair_event });
    }
}

#[cfg(test)]
mod tests {
    use crate::physics::{Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, Vector};

    fn spawn(at: Vector, size: f64, mass: f64, velocity: Vector) -> Event {
        let rect = Rect::new(at, size, size);
        let name = format!("{at:?}");
        Event::Spawn(Spawn { name, rect, mass, velocity, force: Vector::ZERO, material: String::new() })
    }

    /// Position and velocity after 200 steps of eight boxes that fall, slide and bounce, in a world with
    /// a number of distant boxes.
    fn final_states_of_eight_boxes(distant_boxes: usize) -> Vec<(Vector, Vector)> {
        let mut engine = Engine::new(EngineConfig {
            solver: SolverKind::EventDriven,
            rate: 60.0,
            gravity: Some(Vector::new(0.0, 9.81)),
            restitution: Restitution::new(0.5, &[]),
            events_per_step: 10_000,
        });
        engine.apply(&spawn(Vector::new(-100.0, 10.0), 200.0, f64::INFINITY, Vector::ZERO));
        engine.apply(&spawn(Vector::new(14.0, 2.0), 8.0, f64::INFINITY, Vector::ZERO));
        for index in 0..8 {
            let number = f64::from(index);
            let velocity = Vector::new(5.0 - 2.5 * f64::from(index % 4), -1.0);
            engine.apply(&spawn(Vector::new(1.5 * number, 4.0 - 0.7 * number), 1.0, 1.0 + number, velocity));
        }
        (0..distant_boxes).for_each(|index| {
            engine.apply(&spawn(Vector::new(1e4 + 10.0 * index as f64, 0.0), 1.0, 1.0, Vector::ZERO));
        });
        (0..200).for_each(|_| engine.step(&mut Vec::new()).unwrap());
        engine.world().bodies[2..10].iter().map(|body| (body.rect.origin, body.velocity)).collect()
    }

    #[test]
    fn the_choice_of_candidates_changes_no_bit() {
        let [few, many] = [0, 50].map(final_states_of_eight_boxes);
        assert_eq!(few, many, "few bodies test all pairs, many only neighbours");
    }
}
