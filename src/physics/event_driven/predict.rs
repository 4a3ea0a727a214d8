//! Predicts the next event of a body: the first event with another body or the next cell crossing.

use super::body_state::{BodyState, Slot};
use super::contact::Contact;
use super::event_queue::ScheduledEvent;
use super::instant::{Instant, MAX_TIME_ROUNDING};
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::{PairEvent, Sample, predict_contact_end, predict_pair_event};
use super::swept_aabb::SweptAabb;
use super::{ContactGraph, EventDriven, instant::Clock};

/// Replaces `first` by `event` if that is earlier. Events of one pair at one instant are ordered by kind.
fn keep_earlier(first: &mut Option<ScheduledEvent>, event: ScheduledEvent) {
    let is_earlier = match first {
        None => true,
        Some(first) => {
            let is_same_time_and_pair = event.at == first.at && event.pair == first.pair;
            event.is_before(first) || (is_same_time_and_pair && event.pair_event < first.pair_event)
        }
    };
    if is_earlier {
        *first = Some(event);
    }
}

/// The pair in creation order.
fn ordered_pair(slot: Slot, other: Slot) -> [Slot; 2] {
    if slot < other { [slot, other] } else { [other, slot] }
}

/// Finds the first event of one body among those with its candidate partners.
struct Predictor<'a> {
    clock: &'a Clock,
    states: &'a [BodyState],
    contacts: &'a ContactGraph,
    /// The contacts listed with the body.
    own_contacts: &'a [Contact],
    slot: Slot,
    /// The state at the later of the body's reference times.
    sample: Sample<'a>,
    /// The earliest event found so far.
    first: Option<ScheduledEvent>,
    /// Seconds from the sample to the time by which the body predicts again in any case.
    horizon: f64,
}

/// Factor by which the horizon exceeds the time to an event: more than any rounding, so that simultaneous
/// events are compared in their total order and not cut off.
const HORIZON_MARGIN: f64 = 1.0 + 1e-9;

impl<'a> Predictor<'a> {
    fn new(solver: &'a EventDriven, slot: Slot) -> Predictor<'a> {
        let body = &solver.states[slot as usize];
        let sample = Sample::new(&solver.clock, body, body.since);
        let (clock, states, contacts) = (&solver.clock, &solver.states, &solver.contacts);
        let own_contacts = contacts.of(slot);
        Predictor { clock, states, contacts, own_contacts, slot, sample, first: None, horizon: f64::INFINITY }
    }

    /// The seconds from `now` to the horizon, at most `limit`.
    fn seconds_to_horizon(&self, now: Instant, limit: f64) -> f64 {
        let seconds = self.horizon - self.clock.approx_seconds(self.sample.at, now);
        if seconds < limit { seconds } else { limit }
    }

    /// Predicts the next event with another body; returns true if that lowered the horizon.
    fn predict_pair(&mut self, other: Slot) -> bool {
        let partner = &self.states[other as usize];
        if self.sample.is_infinite() && partner.infinite {
            return false;
        }
        if self.is_in_contact(other) {
            return false;
        }
        let Some((at, pair_event)) = predict_pair_event(self.clock, &self.sample, partner, self.horizon) else {
            return false;
        };
        let pair = ordered_pair(self.slot, other);
        let (pair_event, partner_generation) = (Some(pair_event), partner.generation);
        keep_earlier(&mut self.first, ScheduledEvent { at, pair, pair_event, partner_generation });
        self.limit_horizon(self.clock.approx_seconds(self.sample.at, at))
    }

    /// Lowers the horizon to `seconds` after the sample, unless it is earlier; returns true if it changed.
    #[inline]
    fn limit_horizon(&mut self, seconds: f64) -> bool {
        let horizon = seconds * HORIZON_MARGIN + 2.0 * MAX_TIME_ROUNDING;
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
            self.contacts.axis_between(other, self.slot).is_some()
        } else {
            self.own_contacts.iter().any(|contact| contact.other == other)
        }
    }
}

impl EventDriven {
    /// Predicts the next event of a body among its neighbours and enters it in the queue.
    pub(super) fn predict(&mut self, slot: Slot) {
        let mut neighbours = std::mem::take(&mut self.neighbour_buffer);
        self.predict_with(slot, &mut neighbours);
        self.neighbour_buffer = neighbours;
    }

    fn predict_with(&mut self, slot: Slot, neighbours: &mut NeighbourBuffer) {
        let body = &self.states[slot as usize];
        if body.is_static() {
            let aabb = SweptAabb::new(&Sample::new(&self.clock, body, self.now), 0.0);
            self.cell_lists.set_swept_aabb(slot, aabb);
            return;
        }
        let mut predictor = Predictor::new(self, slot);
        let (mut exit_time, mut swept) = (f64::INFINITY, SweptAabb::EVERYWHERE);
        if self.cell_lists.uses_all_pairs() {
            self.cell_lists.find_neighbours(slot, body, &swept, neighbours);
            neighbours.slots().iter().for_each(|other| _ = predictor.predict_pair(*other));
        } else {
            let sample = predictor.sample.at_time(&self.clock, self.now);
            exit_time = self.cell_lists.cell_exit_time(slot, &sample);
            predictor.limit_horizon(self.clock.approx_seconds(predictor.sample.at, self.now) + exit_time);
            swept = SweptAabb::new(&sample, exit_time);
            self.cell_lists.find_neighbours(slot, body, &swept, neighbours);
            for other in neighbours.slots() {
                if !swept.is_disjoint_from(self.cell_lists.swept_aabb(*other)) && predictor.predict_pair(*other) {
                    swept = SweptAabb::new(&sample, predictor.seconds_to_horizon(self.now, exit_time));
                }
            }
        }
        let mut first = predictor.first;
        self.predict_contact_ends(slot, &mut first);
        self.cell_lists.set_swept_aabb(slot, swept);
        self.schedule_next(slot, first, exit_time);
    }

    /// Moves a body to its next cell and predicts its next event there.
    pub(super) fn handle_cell_crossing(&mut self, slot: Slot) {
        let sample = Sample::new(&self.clock, &self.states[slot as usize], self.now);
        self.cell_lists.move_to_next_cell(&self.clock, slot, &sample);
        self.predict(slot);
    }

    /// Moves the bodies that would leave their cells in `step`, which begins now, to their next cells.
    pub(super) fn handle_due_crossings(&mut self, step: u64) {
        self.advance_clock(Instant::start_of(step));
        let mut due = std::mem::take(&mut self.due);
        self.crossing_wheel.advance(&mut due);
        due.drain(..).for_each(|slot| self.handle_cell_crossing(slot));
        self.due = due;
    }

    /// Replaces `first` by the first end of a contact of the body if that is earlier.
    fn predict_contact_ends(&self, slot: Slot, first: &mut Option<ScheduledEvent>) {
        for contact in self.contacts.of(slot) {
            let partner = &self.states[contact.other as usize];
            if let Some(at) = predict_contact_end(&self.clock, contact.axis, &self.states[slot as usize], partner) {
                let pair = ordered_pair(slot, contact.other);
                let pair_event = Some(PairEvent::ContactEnd(contact.axis));
                keep_earlier(first, ScheduledEvent { at, pair, pair_event, partner_generation: partner.generation });
            }
        }
    }

    /// Schedules the next event of a body: its first pair event or the exit from its cell in `exit_time`
    /// seconds. A cell exit after the current step is left to the crossing wheel.
    fn schedule_next(&mut self, slot: Slot, pair_event: Option<ScheduledEvent>, exit_time: f64) {
        let offset = self.now.offset + exit_time;
        let (mut crossing, mut next_prediction_step) = (None, f64::INFINITY);
        if offset <= self.clock.period {
            let at = Instant { step: self.now.step, offset };
            crossing = Some(ScheduledEvent { at, pair: [slot, slot], pair_event: None, partner_generation: 0 });
        } else if offset == f64::INFINITY {
            self.crossing_wheel.cancel(slot);
        } else {
            let steps = (offset * self.clock.rate) as u32;
            let steps = if steps > 1 { steps } else { 1 };
            self.crossing_wheel.schedule(slot, steps);
            next_prediction_step = self.now.step + f64::from(steps);
        }
        let pair_event = pair_event.filter(|event| event.at.step < next_prediction_step);
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
