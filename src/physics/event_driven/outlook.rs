//! What each body expects next: its first meeting, or to leave its cell.

use super::contact::Contact;
use super::instant::{Instant, LONGEST_ROUNDING};
use super::meeting::{Kind, State, meeting, parting};
use super::mover::{Mover, Slot};
use super::near::Near;
use super::reach::Reach;
use super::schedule::Turn;
use super::{Contacts, EventDriven, instant::Clock};

/// Keeps the earlier of two meetings.
fn keep_first(first: &mut Option<Turn>, turn: Turn) {
    let earlier = match first {
        None => true,
        Some(known) => {
            turn.is_before(known) || (turn.at == known.at && turn.pair == known.pair && turn.meeting < known.meeting)
        }
    };
    if earlier {
        *first = Some(turn);
    }
}

fn pair(slot: Slot, other: Slot) -> [Slot; 2] {
    if slot < other { [slot, other] } else { [other, slot] }
}

/// A body that asks others when they meet, and keeps the first answer.
struct Asker<'a> {
    clock: &'a Clock,
    movers: &'a [Mover],
    contacts: &'a Contacts,
    /// Its own contacts.
    touched: &'a [Contact],
    slot: Slot,
    /// Since when it has moved as it does.
    state: State<'a>,
    first: Option<Turn>,
    /// Seconds from then on until no later than which something is known to happen.
    latest: f64,
}

/// By so much more of the time than any rounding is a meeting told to be later than another.
const LATER: f64 = 1.0 + 1e-9;

impl<'a> Asker<'a> {
    fn new(solver: &'a EventDriven, slot: Slot) -> Asker<'a> {
        let mover = &solver.movers[slot as usize];
        let state = State::new(&solver.clock, mover, mover.since);
        let (clock, movers, contacts) = (&solver.clock, &solver.movers, &solver.contacts);
        let touched = contacts.of(slot);
        Asker { clock, movers, contacts, touched, slot, state, first: None, latest: f64::INFINITY }
    }

    /// Seconds from an instant until no later than which something is known to happen.
    fn seconds_from(&self, now: Instant, most: f64) -> f64 {
        let seconds = self.latest - self.clock.about(self.state.at, now);
        if seconds < most { seconds } else { most }
    }

    /// Asks one body; whether that is now the first to be met.
    fn ask(&mut self, other: Slot) -> bool {
        let partner = &self.movers[other as usize];
        if self.state.is_infinite() && partner.infinite {
            return false;
        }
        if self.touches(other) {
            return false;
        }
        let Some((at, kind)) = meeting(self.clock, &self.state, partner, self.latest) else { return false };
        let pair = pair(self.slot, other);
        keep_first(&mut self.first, Turn { at, pair, meeting: Some(kind), generation: partner.generation });
        self.looks_again_in(self.clock.about(self.state.at, at))
    }

    /// It looks ahead again after so many seconds at the latest; whether that is news.
    #[inline]
    fn looks_again_in(&mut self, seconds: f64) -> bool {
        let latest = seconds * LATER + 2.0 * LONGEST_ROUNDING;
        let sooner = latest < self.latest;
        if sooner {
            self.latest = latest;
        }
        sooner
    }

    /// Whether it is in contact with another body.
    #[inline]
    fn touches(&self, other: Slot) -> bool {
        if self.state.is_infinite() {
            self.contacts.between(other, self.slot).is_some()
        } else {
            self.touched.iter().any(|contact| contact.other == other)
        }
    }
}

impl EventDriven {
    /// Looks ahead for a body: asks everyone near it whom it may meet before it looks again.
    pub(super) fn predict(&mut self, slot: Slot) {
        let mut near = std::mem::take(&mut self.near);
        self.predict_among(slot, &mut near);
        self.near = near;
    }

    fn predict_among(&mut self, slot: Slot, near: &mut Near) {
        let mover = &self.movers[slot as usize];
        if mover.is_anchored() {
            let reach = Reach::new(&State::new(&self.clock, mover, self.now), 0.0);
            self.neighbours.extend(slot, reach);
            return;
        }
        let mut asker = Asker::new(self, slot);
        let (mut leaving, mut reach) = (f64::INFINITY, Reach::ANYWHERE);
        if self.neighbours.are_few() {
            self.neighbours.near(slot, mover, &reach, near);
            near.slots().iter().for_each(|other| _ = asker.ask(*other));
        } else {
            let state = asker.state.until(&self.clock, self.now);
            leaving = self.neighbours.leaving(slot, &state);
            asker.looks_again_in(self.clock.about(asker.state.at, self.now) + leaving);
            reach = Reach::new(&state, leaving);
            self.neighbours.near(slot, mover, &reach, near);
            for other in near.slots() {
                if !reach.is_apart_from(self.neighbours.reach(*other)) && asker.ask(*other) {
                    reach = Reach::new(&state, asker.seconds_from(self.now, leaving));
                }
            }
        }
        let mut first = asker.first;
        self.foresee_partings(slot, &mut first);
        self.neighbours.extend(slot, reach);
        self.expect(slot, first, leaving);
    }

    /// Moves a body to its next cell, where it looks around.
    pub(super) fn cross(&mut self, slot: Slot) {
        let state = State::new(&self.clock, &self.movers[slot as usize], self.now);
        self.neighbours.cross(&self.clock, slot, &state);
        self.predict(slot);
    }

    /// Moves on the bodies that would leave their cells in the step that begins.
    pub(super) fn move_on(&mut self, step: u64) {
        self.advance_to(Instant::start_of(step));
        let mut due = std::mem::take(&mut self.due);
        self.calendar.turn_page(&mut due);
        due.drain(..).for_each(|slot| self.cross(slot));
        self.due = due;
    }

    fn foresee_partings(&self, slot: Slot, first: &mut Option<Turn>) {
        for contact in self.contacts.of(slot) {
            let partner = &self.movers[contact.other as usize];
            if let Some(at) = parting(&self.clock, contact.axis, &self.movers[slot as usize], partner) {
                let pair = pair(slot, contact.other);
                let meeting = Some(Kind::Part(contact.axis as u8));
                keep_first(first, Turn { at, pair, meeting, generation: partner.generation });
            }
        }
    }

    /// Has the body wait for what it expects: its first meeting, or to leave its cell so many
    /// seconds from now. Unless that is still in this step it is left to the calendar.
    fn expect(&mut self, slot: Slot, meeting: Option<Turn>, leaving: f64) {
        let offset = self.now.offset + leaving;
        let (mut leaves, mut looks_again) = (None, f64::INFINITY);
        if offset <= self.clock.period {
            let at = Instant { step: self.now.step, offset };
            leaves = Some(Turn { at, pair: [slot, slot], meeting: None, generation: 0 });
        } else if offset == f64::INFINITY {
            self.calendar.forget(slot);
        } else {
            let ahead = (offset * self.clock.rate) as u32;
            let ahead = if ahead > 1 { ahead } else { 1 };
            self.calendar.note(slot, ahead);
            looks_again = self.now.step + f64::from(ahead);
        }
        let meeting = meeting.filter(|meeting| meeting.at.step < looks_again);
        let leaves_first = match (&meeting, &leaves) {
            (Some(meeting), Some(leaves)) => leaves.at.is_before(meeting.at),
            (Some(_), None) => false,
            (None, Some(_) | None) => true,
        };
        self.schedule.set(slot, if leaves_first { leaves } else { meeting });
    }
}

#[cfg(test)]
mod tests {
    use crate::physics::{Engine, Event, Rect, Restitution, Settings, SolverKind, Spawn, Vector};

    fn spawn(at: Vector, size: f64, mass: f64, velocity: Vector) -> Event {
        let rect = Rect::new(at, size, size);
        let name = format!("{at:?}");
        Event::Spawn(Spawn { name, rect, mass, velocity, force: Vector::ZERO, material: String::new() })
    }

    /// Eight boxes between two blocks that fall, slide and bounce, and some that are far away:
    /// where the eight are after 200 steps.
    fn eight_of(far_away: usize) -> Vec<(Vector, Vector)> {
        let mut engine = Engine::new(Settings {
            solver: SolverKind::EventDriven,
            rate: 60.0,
            gravity: Some(Vector::new(0.0, 9.81)),
            restitution: Restitution::new(0.5, &[]),
            events_per_step: 10_000,
        });
        engine.apply(&spawn(Vector::new(-100.0, 10.0), 200.0, f64::INFINITY, Vector::ZERO));
        engine.apply(&spawn(Vector::new(14.0, 2.0), 8.0, f64::INFINITY, Vector::ZERO));
        for index in 0..8 {
            let place = f64::from(index);
            let velocity = Vector::new(5.0 - 2.5 * f64::from(index % 4), -1.0);
            engine.apply(&spawn(Vector::new(1.5 * place, 4.0 - 0.7 * place), 1.0, 1.0 + place, velocity));
        }
        (0..far_away).for_each(|index| {
            engine.apply(&spawn(Vector::new(1e4 + 10.0 * index as f64, 0.0), 1.0, 1.0, Vector::ZERO));
        });
        (0..200).for_each(|_| engine.step(&mut Vec::new()).unwrap());
        engine.world().bodies[2..10].iter().map(|body| (body.rect.origin, body.velocity)).collect()
    }

    #[test]
    fn who_is_asked_changes_no_bit() {
        assert_eq!(eight_of(0), eight_of(50), "few bodies ask everyone, many look for neighbours");
    }
}
