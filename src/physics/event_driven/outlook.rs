//! What each body expects next: its first meeting, and when it leaves its cell.

use super::instant::Instant;
use super::meeting::{Kind, meeting, parting};
use super::mover::{Mover, Slot};
use super::schedule::Turn;
use super::{Contacts, EventDriven, instant::Clock};

/// What a body expects.
///
/// Of each pair it is enough that one of the two knows: the one that looked ahead last.
/// A meeting whose partner has changed since then is void; when its time comes the body
/// looks ahead again.
#[derive(Clone, Copy, Debug)]
pub struct Outlook {
    /// The first meeting it knows of.
    pub meeting: Option<Meeting>,
    /// When it leaves its cell.
    pub leaving: Instant,
}

/// A meeting foretold.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// When, and who.
    pub turn: Turn,
    /// How.
    pub kind: Kind,
    /// The other body.
    pub partner: Slot,
    /// The partner's generation when this was foretold.
    pub generation: u32,
}

impl Outlook {
    /// Nothing to come.
    pub const NOTHING: Outlook = Outlook { meeting: None, leaving: Instant::NEVER };

    /// The turn to wait for.
    fn turn(&self, slot: Slot) -> Option<Turn> {
        match self.meeting {
            Some(meeting) if !self.leaving.is_before(meeting.turn.at) => Some(meeting.turn),
            Some(_) | None => (self.leaving != Instant::NEVER).then_some(Turn { at: self.leaving, pair: [slot, slot] }),
        }
    }
}

/// Keeps the earlier of two meetings.
fn keep_first(first: &mut Option<Meeting>, meeting: Meeting) {
    let earlier = match first {
        None => true,
        Some(known) => meeting.turn.is_before(&known.turn) || (meeting.turn == known.turn && meeting.kind < known.kind),
    };
    if earlier {
        *first = Some(meeting);
    }
}

fn pair(slot: Slot, other: Slot) -> [Slot; 2] {
    if slot < other { [slot, other] } else { [other, slot] }
}

/// Asks when a body meets another and keeps it if it is the first meeting.
fn ask(clock: &Clock, movers: &[Mover], contacts: &Contacts, slot: Slot, other: Slot, first: &mut Option<Meeting>) {
    let (mover, partner) = (&movers[slot as usize], &movers[other as usize]);
    if slot == other || (mover.infinite && partner.infinite) {
        return;
    }
    let in_contact = if mover.infinite { contacts.between(other, slot) } else { contacts.between(slot, other) };
    if in_contact.is_some() {
        return;
    }
    if let Some((at, kind)) = meeting(clock, mover, partner) {
        let turn = Turn { at, pair: pair(slot, other) };
        keep_first(first, Meeting { turn, kind, partner: other, generation: partner.generation });
    }
}

impl EventDriven {
    /// Looks ahead for a body: asks everyone near it.
    pub(super) fn predict(&mut self, slot: Slot) {
        let mover = &self.movers[slot as usize];
        if mover.is_anchored() {
            return;
        }
        let mut first = None;
        let (clock, movers, contacts) = (&self.clock, &self.movers, &self.contacts);
        self.neighbours.near(slot, mover, |other| ask(clock, movers, contacts, slot, other, &mut first));
        self.foresee_partings(slot, &mut first);
        let leaving = self.neighbours.leaving(&self.clock, slot, mover, self.now);
        self.expect(slot, Outlook { meeting: first, leaving });
    }

    /// Moves a body to its next cell and asks those who came near by it.
    pub(super) fn cross(&mut self, slot: Slot) {
        let mut first = self.outlooks[slot as usize].meeting;
        let (clock, movers, contacts) = (&self.clock, &self.movers, &self.contacts);
        let mover = &movers[slot as usize];
        self.neighbours
            .cross(clock, slot, mover, self.now, |other| ask(clock, movers, contacts, slot, other, &mut first));
        let leaving = self.neighbours.leaving(&self.clock, slot, mover, self.now);
        self.expect(slot, Outlook { meeting: first, leaving });
    }

    fn foresee_partings(&self, slot: Slot, first: &mut Option<Meeting>) {
        for contact in self.contacts.of(slot) {
            let partner = &self.movers[contact.other as usize];
            if let Some(at) = parting(&self.clock, contact.axis, &self.movers[slot as usize], partner) {
                let turn = Turn { at, pair: pair(slot, contact.other) };
                let kind = Kind::Part(contact.axis);
                keep_first(first, Meeting { turn, kind, partner: contact.other, generation: partner.generation });
            }
        }
    }

    fn expect(&mut self, slot: Slot, outlook: Outlook) {
        self.outlooks[slot as usize] = outlook;
        self.schedule.set(slot, outlook.turn(slot));
    }
}
