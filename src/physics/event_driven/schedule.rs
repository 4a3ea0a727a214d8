//! What happens next: pages of coming steps, short slices of the present one, and a heap for the
//! slice at hand.
//!
//! Every body has at most one turn pending. The slices only sort roughly; inside a slice
//! turns come in their total order, so that how finely time is sliced changes no result.

use super::instant::{Clock, Instant};
use super::meeting::Kind;
use super::mover::Slot;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

const NONE: u32 = u32::MAX;

/// With so many bodies for each slice of a step, few meet in a slice, and few slices are empty.
const BODIES_PER_SLICE: u64 = 32;

/// So many turns may be in the heap, void or not.
const FEW: usize = 64;

/// The pages reach so many steps ahead; what comes later is looked at again then.
const STEPS: u64 = 32;

/// What happens next to a body, and when: to meet another, or else to leave its cell.
///
/// Of each pair it is enough that one of the two knows: the one that looked ahead last.
/// A meeting whose partner has changed since then is void; when its time comes the body
/// looks ahead again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// The instant.
    pub at: Instant,
    /// The two bodies, the earlier created first; the same twice for a body on its own.
    pub pair: [Slot; 2],
    /// How the two meet.
    pub meeting: Option<Kind>,
    /// The partner's generation when this was foretold.
    pub generation: u32,
}

impl Turn {
    /// Whether this turn comes before `other`: of all that happens at an instant what is late
    /// comes last, then by the lower body of the pair, then the higher.
    #[inline]
    pub fn is_before(&self, other: &Turn) -> bool {
        self.at.is_before(other.at)
            || (self.at == other.at && (self.is_late(), self.pair) < (other.is_late(), other.pair))
    }

    /// Whether it waits for all else at that instant, which may make it void.
    fn is_late(&self) -> bool {
        self.meeting == Some(Kind::Press)
    }
}

/// A turn in the heap, still valid if the body's stamp is the same.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    turn: Turn,
    slot: Slot,
    stamp: u32,
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Waiting) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Waiting) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Waiting) -> Ordering {
        if self.turn.is_before(&other.turn) {
            Ordering::Less
        } else if other.turn.is_before(&self.turn) {
            Ordering::Greater
        } else {
            self.slot.cmp(&other.slot)
        }
    }
}

/// What a body waits for, and where it stands until then.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Pending {
    turn: Turn,
    /// The first slice of the step on whose page it stands, or its slice of the present step.
    stands: u64,
    stamp: u32,
}

const NOWHERE: u64 = u64::MAX;

const NO_TURN: Turn = Turn { at: Instant::NEVER, pair: [NONE; 2], meeting: None, generation: 0 };

const IDLE: Pending = Pending { turn: NO_TURN, stands: NOWHERE, stamp: 0 };

/// The turns of all bodies.
///
/// A body whose turn comes later than was foretold stays where it stands until that is at hand,
/// and is entered anew then: so it stands in one place only, and what it left is known to be void.
#[derive(Clone, Debug)]
pub struct Schedule {
    clock: Clock,
    /// Slices a step: 2 to this power.
    fineness: u32,
    /// The slice at hand, counted from the first step on.
    present: u64,
    /// For each of the coming steps who stands there.
    pages: Vec<Vec<Slot>>,
    /// For each slice of the present step who stands there.
    slices: Vec<Vec<Slot>>,
    /// How many stand in slices.
    waiting: usize,
    pending: Vec<Pending>,
    heap: BinaryHeap<Reverse<Waiting>>,
    /// With more turns than these in the heap, the void ones are worth looking for.
    crowded: usize,
}

impl Schedule {
    /// An empty schedule at the start of a step, fit for so many bodies.
    pub fn new(clock: Clock, step: u64, bodies: usize) -> Schedule {
        let fineness = (bodies as u64 / BODIES_PER_SLICE).clamp(1, 1 << 10).next_power_of_two().trailing_zeros();
        Schedule {
            clock,
            fineness,
            present: step << fineness,
            pages: vec![Vec::new(); STEPS as usize],
            slices: vec![Vec::new(); 1 << fineness],
            waiting: 0,
            pending: Vec::new(),
            heap: BinaryHeap::new(),
            crowded: FEW,
        }
    }

    /// Replaces a body's turn.
    pub fn set(&mut self, slot: Slot, turn: Option<Turn>) {
        if self.pending.len() <= slot as usize {
            self.pending.resize(slot as usize + 1, IDLE);
        }
        let turn = turn.unwrap_or(NO_TURN);
        let pending = &mut self.pending[slot as usize];
        if pending.turn == turn {
            return;
        }
        pending.stamp = pending.stamp.wrapping_add(1);
        pending.turn = turn;
        if turn != NO_TURN {
            self.enter(slot);
        }
    }

    /// The first turn of all, if it is due by the end of the step, and the body whose it is.
    pub fn next(&mut self, step: u64) -> Option<(Slot, Turn)> {
        let end = (step + 1) << self.fineness;
        loop {
            while let Some(Reverse(first)) = self.heap.pop() {
                let pending = &mut self.pending[first.slot as usize];
                if pending.stamp == first.stamp {
                    pending.turn = NO_TURN;
                    return Some((first.slot, first.turn));
                }
            }
            if self.present + 1 >= end {
                return None;
            }
            self.advance();
        }
    }

    /// Enters the step: who stands on its page goes to the slices, or is at hand.
    pub fn begin(&mut self, step: u64) {
        if self.present < step << self.fineness {
            self.present = step << self.fineness;
            let place = (step % STEPS) as usize;
            let page = std::mem::take(&mut self.pages[place]);
            self.pages[place] = self.enter_again(page);
        }
    }

    /// Whether nobody waits for anything in the step to come.
    pub fn is_free(&self, step: u64) -> bool {
        self.heap.is_empty() && self.waiting == 0 && self.pages[(step % STEPS) as usize].is_empty()
    }

    /// Passes over a step in which nobody waits.
    pub fn pass(&mut self, step: u64) {
        self.present = ((step + 1) << self.fineness) - 1;
    }

    /// Goes on to the next slice, or over the rest of a step in which nobody waits.
    fn advance(&mut self) {
        let last = self.present | (self.slices.len() as u64 - 1);
        self.present = if self.waiting == 0 { last } else { self.present + 1 };
        let place = (self.present & (self.slices.len() as u64 - 1)) as usize;
        let slice = std::mem::take(&mut self.slices[place]);
        self.waiting -= slice.len();
        self.slices[place] = self.enter_again(slice);
    }

    /// Sends on those who still stand in the present place; returns the emptied list.
    fn enter_again(&mut self, mut list: Vec<Slot>) -> Vec<Slot> {
        for slot in list.drain(..) {
            let pending = &mut self.pending[slot as usize];
            if pending.stands == self.present {
                pending.stands = NOWHERE;
                if pending.turn != NO_TURN {
                    self.enter(slot);
                }
            }
        }
        list
    }

    /// Throws the void turns out of the heap: at least every other one, or it may double.
    #[cold]
    fn forget_void(&mut self) {
        let pending = &self.pending;
        self.heap.retain(|Reverse(waiting)| pending[waiting.slot as usize].stamp == waiting.stamp);
        self.crowded = 2 * self.heap.len() + FEW;
    }

    fn enter(&mut self, slot: Slot) {
        let pending = &mut self.pending[slot as usize];
        let last = (1 << self.fineness) - 1;
        let within = (pending.turn.at.offset * self.clock.rate * f64::from(1_u32 << self.fineness)) as i64 as u64;
        let step = pending.turn.at.step as i64 as u64;
        let slice = (step << self.fineness) + if within < last { within } else { last };
        if slice <= self.present {
            pending.stands = NOWHERE;
            let waiting = Waiting { turn: pending.turn, slot, stamp: pending.stamp };
            self.heap.push(Reverse(waiting));
            if self.heap.len() > self.crowded {
                self.forget_void();
            }
            return;
        }
        let present_step = self.present >> self.fineness;
        let stands = if step == present_step {
            slice
        } else {
            let furthest = present_step + STEPS - 1;
            (if step < furthest { step } else { furthest }) << self.fineness
        };
        if stands >= pending.stands {
            return;
        }
        pending.stands = stands;
        if step == present_step {
            self.waiting += 1;
            self.slices[(slice & last) as usize].push(slot);
        } else {
            self.pages[((stands >> self.fineness) % STEPS) as usize].push(slot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(step: f64, offset: f64, pair: [Slot; 2]) -> Option<Turn> {
        Some(Turn { at: Instant { step, offset }, pair, meeting: None, generation: 0 })
    }

    fn order(bodies: usize) -> Vec<(u64, Slot)> {
        let mut schedule = Schedule::new(Clock::new(10.0), 0, bodies);
        schedule.set(0, turn(0.0, 0.05, [0, 4]));
        schedule.set(1, turn(0.0, 0.05, [0, 3]));
        schedule.set(2, turn(0.0, 0.1, [2, 2]));
        schedule.set(3, turn(0.0, 0.01, [3, 3]));
        schedule.set(4, turn(200.0, 0.0, [4, 4]));
        schedule.set(5, turn(3.0, 0.02, [5, 5]));
        schedule.set(6, turn(0.0, 0.02, [6, 6]));
        schedule.set(6, None);
        schedule.set(3, turn(2.0, 0.07, [3, 3]));
        let mut order = Vec::new();
        for step in 0..=200 {
            schedule.begin(step);
            while let Some((slot, _)) = schedule.next(step) {
                order.push((step, slot));
                schedule.set(slot, if slot == 5 && step == 3 { turn(3.0, 0.03, [5, 5]) } else { None });
                if order.len() == 6 {
                    schedule.set(5, None);
                }
            }
        }
        order
    }

    #[test]
    fn void_turns_take_no_memory() {
        let mut schedule = Schedule::new(Clock::new(1.0), 0, 100);
        schedule.begin(0);
        (0..100).for_each(|slot| schedule.set(slot, turn(0.0, 0.0, [slot, slot])));
        for round in 1..10_000 {
            let later = 0.01 + 1e-9 * f64::from(round);
            (0..3).for_each(|slot| schedule.set(slot, turn(0.0, later, [slot, slot])));
        }
        assert!(schedule.heap.len() <= 2 * 100 + FEW, "{}", schedule.heap.len());
        let order: Vec<Slot> = std::iter::from_fn(|| Some(schedule.next(0)?.0)).collect();
        assert_eq!(order, (3..100).chain(0..3).collect::<Vec<Slot>>());
    }

    #[test]
    fn turns_come_in_their_total_order_however_finely_time_is_sliced() {
        let expected = [(0, 1), (0, 0), (0, 2), (2, 3), (3, 5), (3, 5), (200, 4)];
        for bodies in [1, 100, 10_000] {
            assert_eq!(order(bodies), expected);
        }
    }
}
