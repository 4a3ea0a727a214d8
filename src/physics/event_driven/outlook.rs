//! What each body expects next: its first meeting, and when it leaves its cell.

use super::instant::Instant;
use super::meeting::{Kind, State, meeting, parting};
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
            Some(_) | None => {
                (self.leaving != Instant::NEVER).then_some(Turn { at: self.leaving, late: false, pair: [slot, slot] })
            }
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

/// A body that asks others when they meet, and keeps the first answer.
struct Asker<'a> {
    clock: &'a Clock,
    movers: &'a [Mover],
    contacts: &'a Contacts,
    slot: Slot,
    /// Since when it has moved as it does.
    state: State<'a>,
    first: Option<Meeting>,
}

impl<'a> Asker<'a> {
    fn new(solver: &'a EventDriven, slot: Slot, first: Option<Meeting>) -> Asker<'a> {
        let mover = &solver.movers[slot as usize];
        let state = State::new(&solver.clock, mover, mover.since);
        Asker { clock: &solver.clock, movers: &solver.movers, contacts: &solver.contacts, slot, state, first }
    }

    fn ask(&mut self, other: Slot) {
        let partner = &self.movers[other as usize];
        if self.slot == other || (self.state.is_infinite() && partner.infinite) {
            return;
        }
        if let Some((at, kind)) = meeting(self.clock, &self.state, partner)
            && !self.touches(other)
        {
            let turn = Turn { at, late: kind == Kind::Press, pair: pair(self.slot, other) };
            keep_first(&mut self.first, Meeting { turn, kind, partner: other, generation: partner.generation });
        }
    }

    /// Whether it is in contact with another body.
    fn touches(&self, other: Slot) -> bool {
        let [finite, known] = if self.state.is_infinite() { [other, self.slot] } else { [self.slot, other] };
        self.contacts.between(finite, known).is_some()
    }
}

impl EventDriven {
    /// Looks ahead for a body: asks everyone near it.
    pub(super) fn predict(&mut self, slot: Slot) {
        let mover = &self.movers[slot as usize];
        if mover.is_anchored() {
            return;
        }
        let mut asker = Asker::new(self, slot, None);
        self.neighbours.near(slot, mover, |other| asker.ask(other));
        let mut first = asker.first;
        self.foresee_partings(slot, &mut first);
        let leaving = self.neighbours.leaving(&self.clock, slot, mover, self.now);
        self.expect(slot, Outlook { meeting: first, leaving });
    }

    /// Moves a body to its next cell and asks those who came near by it.
    pub(super) fn cross(&mut self, slot: Slot) {
        let mut came_near = std::mem::take(&mut self.came_near);
        let mover = &self.movers[slot as usize];
        self.neighbours.cross(&self.clock, slot, mover, self.now, |other| came_near.push(other));
        let mut asker = Asker::new(self, slot, self.outlooks[slot as usize].meeting);
        came_near.drain(..).for_each(|other| asker.ask(other));
        let first = asker.first;
        self.came_near = came_near;
        let mover = &self.movers[slot as usize];
        let leaving = self.neighbours.leaving(&self.clock, slot, mover, self.now);
        self.expect(slot, Outlook { meeting: first, leaving });
    }

    fn foresee_partings(&self, slot: Slot, first: &mut Option<Meeting>) {
        for contact in self.contacts.of(slot) {
            let partner = &self.movers[contact.other as usize];
            if let Some(at) = parting(&self.clock, contact.axis, &self.movers[slot as usize], partner) {
                let turn = Turn { at, late: false, pair: pair(slot, contact.other) };
                let kind = Kind::Part(contact.axis as u8);
                keep_first(first, Meeting { turn, kind, partner: contact.other, generation: partner.generation });
            }
        }
    }

    fn expect(&mut self, slot: Slot, outlook: Outlook) {
        self.outlooks[slot as usize] = outlook;
        self.schedule.set(slot, outlook.turn(slot));
    }
}
