//! The event queue: a timing wheel with a bin for each of the next steps, bins for slices of the current step, and
//! a binary heap for the current slice.
//!
//! Each body has at most one event in the queue, and at most one cell crossing after the current step. The bins
//! sort only roughly; within a slice the heap delivers events in their total order, so the width of the slices
//! changes no result. The order of the cell crossings of a step changes none either.

use super::body_state::{NONE, Slot};
use super::instant::{Clock, Instant};
use super::pair_event::PairEvent;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::hint::black_box;

/// Bodies per slice of a step: few enough to keep the heap small, enough to leave few slices empty.
const BODIES_PER_SLICE: u64 = 32;

/// Bodies per slice with at least [`MIN_READ_AHEAD`] bodies: enough events to read their records ahead together.
const BODIES_PER_LONG_SLICE: u64 = 512;

/// From this number of bodies on, their records do not fit into the fast caches, and reading ahead pays.
pub const MIN_READ_AHEAD: usize = 2000;

/// Heap length up to which invalidated events are never removed.
const MIN_PURGE_LEN: usize = 64;

/// Number of steps that have a bin. Later events and crossings are kept in the last bin and inserted again when
/// it is due.
const STEP_BINS: u64 = 32;

/// The next event of a body: an event of a pair or a cell crossing.
///
/// An event of a pair is stored with each body that has predicted it: with one of the two, or with both. It is
/// invalidated if the partner's generation has changed since; when it is due, the body predicts again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledEvent {
    /// The time of the event; the earliest possible one unless it is exact.
    pub at: Instant,
    /// The two bodies in creation order; for a cell crossing twice the same body.
    pub pair: [Slot; 2],
    /// The event of the pair; `None` for a cell crossing.
    pub pair_event: Option<PairEvent>,
    /// The partner's generation at the time of the prediction.
    pub partner_generation: u32,
    /// The precision of the time.
    pub precision: Precision,
}

/// The precision of the time of a scheduled event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// The event does not happen earlier.
    LowerBound,
    /// The event does not happen earlier, and another one of the body may precede it.
    Contested,
    /// The time is exact to the rounding of the state.
    Exact,
}

impl ScheduledEvent {
    /// True for [`NO_EVENT`].
    #[inline]
    fn is_none(&self) -> bool {
        self.pair[0] == NONE
    }

    /// Returns true if this event precedes `other` in the total order: by time, then by the lower slot of the
    /// pair, then by the higher.
    #[inline]
    pub fn is_before(&self, other: &ScheduledEvent) -> bool {
        self.at.is_before(other.at) || (self.at == other.at && self.pair < other.pair)
    }
}

/// A body in the heap, with the time and the pair of its event. It is valid while its stamp equals the body's.
#[derive(Clone, Copy, Debug)]
struct HeapEntry {
    at: Instant,
    pair: [Slot; 2],
    slot: Slot,
    stamp: u32,
}

impl PartialEq for HeapEntry {
    fn eq(&self, other: &HeapEntry) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for HeapEntry {}

impl PartialOrd for HeapEntry {
    fn partial_cmp(&self, other: &HeapEntry) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for HeapEntry {
    fn cmp(&self, other: &HeapEntry) -> Ordering {
        if self.at.is_before(other.at) {
            Ordering::Less
        } else if other.at.is_before(self.at) {
            Ordering::Greater
        } else {
            (self.pair, self.slot).cmp(&(other.pair, other.slot))
        }
    }
}

/// The event and the cell crossing of a body, and the bin in which the body is listed.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct QueueEntry {
    event: ScheduledEvent,
    /// The step before which the body must be moved to its next cell; [`NEVER`] if there is none.
    crossing: u64,
    /// The slice of the bin that lists the body: the slice itself in the current step, otherwise the
    /// first slice of the step; [`NO_BIN`] if none does.
    bin: u64,
    /// The latest possible time of `event`, s; infinite if unknown.
    latest: f64,
    /// The number of changes of `event`, modulo 2³².
    stamp: u32,
}

const NO_BIN: u64 = u64::MAX;

const NEVER: u64 = u64::MAX;

const NO_EVENT: ScheduledEvent = ScheduledEvent {
    at: Instant::NEVER,
    pair: [NONE; 2],
    pair_event: None,
    partner_generation: 0,
    precision: Precision::Exact,
};

/// Events are filed early by this fraction of their time, so that one at the instant of a sample is found
/// before it.
const EARLINESS: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;

/// The slice in which all later events are filed, so that the numbers of slices do not overflow.
const MAX_SLICE: f64 = (1_u64 << 62) as f64;

const EMPTY_ENTRY: QueueEntry =
    QueueEntry { event: NO_EVENT, crossing: NEVER, bin: NO_BIN, latest: f64::INFINITY, stamp: 0 };

/// The events and cell crossings of all bodies.
///
/// Invariants: a body whose event is not in the heap is listed in a bin that is due no later than its event and its
/// crossing. A body is taken only from the bin that its `bin` names, and once: entries elsewhere and a second one there
/// are skipped. A body whose event or crossing is postponed stays in its bin until the bin is due and is inserted again
/// then, so the bins do not grow however often a body predicts again.
#[derive(Clone, Debug)]
pub struct EventQueue {
    /// Slices per second, Hz, less by [`EARLINESS`].
    slice_rate: f64,
    /// Base-2 logarithm of the number of slices per step.
    log2_slices: u32,
    /// The slice whose events are in the heap, counted from step 0.
    current_slice: u64,
    /// The last slice that was read ahead.
    slice_read_ahead: u64,
    /// Bodies by step, for the next steps.
    step_bins: Vec<Vec<Slot>>,
    /// Bodies by slice, for the current step.
    slice_bins: Vec<Vec<Slot>>,
    /// The number of entries in `slice_bins`.
    binned: usize,
    /// By slot.
    entries: Vec<QueueEntry>,
    heap: BinaryHeap<Reverse<HeapEntry>>,
    /// Heap length at which invalidated events are removed.
    purge_threshold: usize,
}

impl EventQueue {
    /// Creates an empty queue at the start of a step, with slices chosen for a number of bodies.
    pub fn new(clock: Clock, step: u64, bodies: usize) -> EventQueue {
        let bodies_per_slice = if bodies < MIN_READ_AHEAD { BODIES_PER_SLICE } else { BODIES_PER_LONG_SLICE };
        let log2_slices = (bodies as u64 / bodies_per_slice).clamp(1, 1 << 10).next_power_of_two().trailing_zeros();
        EventQueue {
            slice_rate: clock.rate * f64::from(1_u32 << log2_slices) * EARLINESS,
            log2_slices,
            current_slice: step << log2_slices,
            slice_read_ahead: 0,
            step_bins: vec![Vec::new(); STEP_BINS as usize],
            slice_bins: vec![Vec::new(); 1 << log2_slices],
            binned: 0,
            entries: Vec::new(),
            heap: BinaryHeap::new(),
            purge_threshold: MIN_PURGE_LEN,
        }
    }

    /// Replaces the event of a body; `None` removes it.
    pub fn set(&mut self, slot: Slot, event: Option<ScheduledEvent>) {
        self.set_until(slot, event, f64::INFINITY);
    }

    /// Replaces the event of a body, which happens at `latest` seconds since step 0 at the latest; `None` removes it.
    pub fn set_until(&mut self, slot: Slot, event: Option<ScheduledEvent>, latest: f64) {
        let entry = self.entry(slot);
        entry.latest = latest;
        match event {
            Some(event) if entry.event != event => {
                entry.stamp = entry.stamp.wrapping_add(1);
                entry.event = event;
                self.insert_event(slot);
            }
            None if !entry.event.is_none() => {
                entry.stamp = entry.stamp.wrapping_add(1);
                entry.event = NO_EVENT;
            }
            Some(_) | None => {}
        }
    }

    /// The time in seconds at which the event of a body happens at the latest; infinite if it has none or if that is
    /// unknown.
    pub fn latest(&self, slot: Slot) -> f64 {
        match self.entries.get(slot as usize) {
            Some(entry) if !entry.event.is_none() => entry.latest,
            Some(_) | None => f64::INFINITY,
        }
    }

    /// The earliest time of the event of a body in seconds; infinite if it has none.
    pub fn time_of(&self, slot: Slot) -> f64 {
        match self.entries.get(slot as usize) {
            Some(entry) if !entry.event.is_none() => entry.event.at.high,
            Some(_) | None => f64::INFINITY,
        }
    }

    /// True if the event of a body is one of the pair.
    #[cfg(debug_assertions)]
    pub fn holds(&self, slot: Slot, pair: [Slot; 2]) -> bool {
        self.entries
            .get(slot as usize)
            .is_some_and(|entry| entry.event.pair == pair && entry.event.pair_event.is_some())
    }

    /// Removes the event and the cell crossing of a body.
    pub fn remove(&mut self, slot: Slot) {
        self.set(slot, None);
        self.set_crossing(slot, None);
    }

    /// Replaces the cell crossing of a body: the number of steps, at least one, after which it is due; `None` removes
    /// it.
    pub fn set_crossing(&mut self, slot: Slot, steps: Option<u32>) {
        let Some(steps) = steps else {
            self.entry(slot).crossing = NEVER;
            return;
        };
        self.entry(slot).crossing = self.current_step() + u64::from(steps);
        self.insert_crossing(slot);
    }

    #[inline]
    fn entry(&mut self, slot: Slot) -> &mut QueueEntry {
        if self.entries.len() <= slot as usize {
            self.add_entries(slot);
        }
        &mut self.entries[slot as usize]
    }

    #[cold]
    #[inline(never)]
    fn add_entries(&mut self, last: Slot) {
        self.entries.resize(last as usize + 1, EMPTY_ENTRY);
    }

    const fn current_step(&self) -> u64 {
        self.current_slice >> self.log2_slices
    }

    /// Removes the event of a body if it is one of the pair, predicted for this generation of the partner. If the
    /// partner has changed since, the body must predict again at the time of its event, because one with another body
    /// may follow.
    pub fn take_event_of(&mut self, slot: Slot, pair: [Slot; 2], partner_generation: u32) -> Option<ScheduledEvent> {
        let entry = self.entries.get_mut(slot as usize)?;
        let event = entry.event;
        if event.pair != pair || event.pair_event.is_none() || event.partner_generation != partner_generation {
            return None;
        }
        entry.stamp = entry.stamp.wrapping_add(1);
        entry.event = NO_EVENT;
        Some(event)
    }

    /// The pairs of the events in the current slice at the first call in it, with many bodies; otherwise `None`.
    pub fn pairs_to_read_ahead(&mut self) -> Option<impl Iterator<Item = [Slot; 2]> + Clone + '_> {
        if self.slice_read_ahead == self.current_slice || self.entries.len() < MIN_READ_AHEAD {
            return None;
        }
        self.slice_read_ahead = self.current_slice;
        Some(self.heap.iter().map(|Reverse(queued)| queued.pair))
    }

    /// Removes the first event and returns it with its body; `None` if it is after `until`, an instant of the current
    /// step.
    ///
    /// Inlined, so that the event is not copied through memory: that makes a gas of 100 boxes 1.02 times as fast.
    #[inline(always)]
    pub fn pop(&mut self, until: Instant) -> Option<(Slot, ScheduledEvent)> {
        if until.is_before(self.next_time()) {
            return None;
        }
        let slot = self.heap.peek()?.0.slot;
        self.heap.pop();
        let entry = &mut self.entries[slot as usize];
        // A body that was listed in a bin as well can be in the heap twice.
        entry.stamp = entry.stamp.wrapping_add(1);
        Some((slot, std::mem::replace(&mut entry.event, NO_EVENT)))
    }

    /// The time of the first event of the current step; [`Instant::NEVER`] if there is none.
    pub fn next_time(&mut self) -> Instant {
        let end = (self.current_step() + 1) << self.log2_slices;
        loop {
            while let Some(Reverse(first)) = self.heap.peek() {
                if self.entries[first.slot as usize].stamp == first.stamp {
                    return first.at;
                }
                self.heap.pop();
            }
            if self.current_slice + 1 >= end {
                return Instant::NEVER;
            }
            self.advance();
        }
    }

    /// Begins the next step: moves the bodies in its bin to the bins of its slices or to the heap, and appends to
    /// `due` those that must be moved to their next cells. These have no event any more and must predict again.
    pub fn begin_next_step(&mut self, due: &mut Vec<Slot>) {
        while self.binned > 0 {
            self.advance();
        }
        let step = self.current_step() + 1;
        self.current_slice = step << self.log2_slices;
        let index = (step % STEP_BINS) as usize;
        if !self.step_bins[index].is_empty() {
            let mut bin = std::mem::take(&mut self.step_bins[index]);
            self.redistribute(&bin, due);
            bin.clear();
            self.step_bins[index] = bin;
        }
    }

    /// Returns true if nothing is due in the current step, and no cell crossing at its end.
    pub fn is_step_empty(&self) -> bool {
        let next = (self.current_step() + 1) % STEP_BINS;
        self.heap.is_empty() && self.binned == 0 && self.step_bins[next as usize].is_empty()
    }

    /// Advances to the next step from one in which [nothing is due](Self::is_step_empty), without reading its bin.
    pub fn skip_step(&mut self) {
        self.current_slice = (self.current_step() + 1) << self.log2_slices;
    }

    /// Advances to the next slice, or to the last slice of the step if all bins are empty.
    fn advance(&mut self) {
        let last = self.current_slice | (self.slice_bins.len() as u64 - 1);
        self.current_slice = if self.binned == 0 { last } else { self.current_slice + 1 };
        let index = (self.current_slice & (self.slice_bins.len() as u64 - 1)) as usize;
        if !self.slice_bins[index].is_empty() {
            let mut bin = std::mem::take(&mut self.slice_bins[index]);
            self.binned -= bin.len();
            self.redistribute(&bin, &mut Vec::new());
            bin.clear();
            self.slice_bins[index] = bin;
        }
    }

    /// Inserts again the bodies that are still listed in the current bin, or appends them to `due` if their crossings
    /// are due.
    fn redistribute(&mut self, bin: &[Slot], due: &mut Vec<Slot>) {
        let current_step = self.current_step();
        if self.entries.len() >= MIN_READ_AHEAD {
            // Reads the records at the same time, see `EventDriven::read_ahead`.
            black_box(bin.iter().fold(0, |sum, slot| sum ^ self.entries[*slot as usize].bin));
        }
        for &slot in bin {
            let entry = &mut self.entries[slot as usize];
            if entry.bin != self.current_slice {
                continue;
            }
            if entry.crossing <= current_step {
                *entry = QueueEntry { stamp: entry.stamp.wrapping_add(1), ..EMPTY_ENTRY };
                due.push(slot);
                continue;
            }
            entry.bin = NO_BIN;
            let has_crossing = entry.crossing != NEVER;
            if !entry.event.is_none() {
                self.insert_event(slot);
            }
            if has_crossing {
                self.insert_crossing(slot);
            }
        }
    }

    /// Removes the invalidated events from the heap. The heap may double before the next call, so the
    /// cost per event is constant.
    #[cold]
    fn remove_invalidated(&mut self) {
        let entries = &self.entries;
        self.heap.retain(|Reverse(queued)| entries[queued.slot as usize].stamp == queued.stamp);
        self.purge_threshold = 2 * self.heap.len() + MIN_PURGE_LEN;
    }

    /// Enters a body in the heap or, unless it is in an earlier bin, in the bin of its event.
    fn insert_event(&mut self, slot: Slot) {
        let entry = &self.entries[slot as usize];
        let slice = entry.event.at.high * self.slice_rate;
        // No time is negative, and the conversion to a signed number is shorter.
        debug_assert!(slice.is_nan() || slice >= 0.0);
        let slice = (if slice < MAX_SLICE { slice as i64 } else { MAX_SLICE as i64 }) as u64;
        let step = slice >> self.log2_slices;
        if slice <= self.current_slice {
            let ScheduledEvent { at, pair, .. } = entry.event;
            let queued = HeapEntry { at, pair, slot, stamp: entry.stamp };
            self.heap.push(Reverse(queued));
            if self.heap.len() > self.purge_threshold {
                self.remove_invalidated();
            }
            return;
        }
        let is_current = step == self.current_step();
        let bin = if is_current { slice } else { self.step_bin(step) };
        if bin >= entry.bin {
            return;
        }
        self.entries[slot as usize].bin = bin;
        if is_current {
            self.binned += 1;
            let last = self.slice_bins.len() as u64 - 1;
            self.slice_bins[(slice & last) as usize].push(slot);
        } else {
            self.step_bins[((bin >> self.log2_slices) % STEP_BINS) as usize].push(slot);
        }
    }

    /// Enters a body that has a cell crossing in the bin of that, unless it is in an earlier bin.
    fn insert_crossing(&mut self, slot: Slot) {
        let QueueEntry { crossing, bin: present, .. } = self.entries[slot as usize];
        let bin = self.step_bin(crossing);
        if bin < present {
            self.entries[slot as usize].bin = bin;
            self.step_bins[((bin >> self.log2_slices) % STEP_BINS) as usize].push(slot);
        }
    }

    /// The first slice of a later step, or of the last one that has a bin.
    fn step_bin(&self, step: u64) -> u64 {
        let last_step = self.current_step() + STEP_BINS - 1;
        (if step < last_step { step } else { last_step }) << self.log2_slices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::pseudo_random::PseudoRandom;

    fn event(step: f64, offset: f64, pair: [Slot; 2]) -> Option<ScheduledEvent> {
        let at = Instant { high: step / 10.0 + offset, low: 0.0 };
        Some(ScheduledEvent { at, pair, pair_event: None, partner_generation: 0, precision: Precision::Exact })
    }

    fn popped_order(bodies: usize) -> Vec<(u64, Slot)> {
        let mut queue = EventQueue::new(Clock::new(10.0), 0, bodies);
        queue.set(0, event(0.0, 0.05, [0, 4]));
        queue.set(1, event(0.0, 0.05, [0, 3]));
        queue.set(2, event(0.0, 0.1, [2, 2]));
        queue.set(3, event(0.0, 0.01, [3, 3]));
        queue.set(4, event(200.0, 0.0, [4, 4]));
        queue.set(5, event(3.0, 0.02, [5, 5]));
        queue.set(6, event(0.0, 0.02, [6, 6]));
        queue.set(6, None);
        queue.set(3, event(2.0, 0.07, [3, 3]));
        let mut order = Vec::new();
        for step in 0..=200 {
            while let Some((slot, _)) = queue.pop(Clock::new(10.0).start_of(step + 1)) {
                order.push((step, slot));
                queue.set(slot, if slot == 5 && step == 3 { event(3.0, 0.03, [5, 5]) } else { None });
                if order.len() == 6 {
                    queue.set(5, None);
                }
            }
            queue.begin_next_step(&mut Vec::new());
        }
        order
    }

    #[test]
    fn invalidated_events_do_not_accumulate_in_the_heap() {
        let mut queue = EventQueue::new(Clock::new(1.0), 0, 100);
        (0..100).for_each(|slot| queue.set(slot, event(0.0, 0.0, [slot, slot])));
        for round in 1..10_000 {
            let later = 0.01 + 1e-9 * f64::from(round);
            (0..3).for_each(|slot| queue.set(slot, event(0.0, later, [slot, slot])));
        }
        assert!(queue.heap.len() <= 2 * 100 + MIN_PURGE_LEN, "{}", queue.heap.len());
        let order: Vec<Slot> = std::iter::from_fn(|| Some(queue.pop(Instant::NEVER)?.0)).collect();
        assert_eq!(order, (3..100).chain(0..3).collect::<Vec<Slot>>());
    }

    #[test]
    fn events_are_popped_in_their_total_order_whatever_the_width_of_a_slice() {
        let expected = [(0, 1), (0, 0), (1, 2), (2, 3), (3, 5), (3, 5), (199, 4)];
        for bodies in [1, 100, 10_000] {
            assert_eq!(popped_order(bodies), expected);
        }
    }

    #[test]
    fn each_event_is_popped_once_and_in_its_total_order_whatever_replaces_it() {
        for seed in 0..if cfg!(debug_assertions) { 60 } else { 600 } {
            let random = &mut PseudoRandom(seed * 7919);
            let bodies = random.pick(&[1, 100, 10_000]);
            let (clock, mut queue, mut events) =
                (Clock::new(10.0), EventQueue::new(Clock::new(10.0), 0, bodies), [None; 6]);
            for step in 0..40 {
                for _ in 0..random.pick(&[0, 1, 4, 20]) {
                    let slot = (random.next() * 6.0) as Slot;
                    let steps = f64::from(step) + random.pick(&[0.0, 0.0, 1.0, 2.0, 40.0]);
                    let offset = random.pick(&[0.0, 0.02, 0.05, 0.1 - 1e-16, 0.1, 0.1 + 1e-16, 0.1 + 1e-13]);
                    let next =
                        random.pick(&[None, event(steps, offset, [slot / 2, slot]), event(steps, offset, [0, 6])]);
                    queue.set(slot, next);
                    events[slot as usize] = next;
                    if random.next() < 0.5 {
                        let until = clock.start_of(step as u64 + 1);
                        let due = |event: &ScheduledEvent| !until.is_before(event.at);
                        let pending = (0..).zip(&events).filter_map(|(slot, event)| event.map(|event| (slot, event)));
                        let first = pending.filter(|(_, event)| due(event)).min_by(|(slot, a), (other, b)| {
                            if a.is_before(b) {
                                Ordering::Less
                            } else if b.is_before(a) {
                                Ordering::Greater
                            } else {
                                slot.cmp(other)
                            }
                        });
                        assert_eq!(queue.pop(until), first, "seed {seed}, step {step}");
                        if let Some((slot, _)) = first {
                            events[slot as usize] = None;
                        }
                    }
                }
                queue.begin_next_step(&mut Vec::new());
            }
        }
    }

    /// The bodies whose crossings are due at the beginning of the next step.
    fn due(queue: &mut EventQueue) -> Vec<Slot> {
        let mut due = Vec::new();
        queue.begin_next_step(&mut due);
        due
    }

    #[test]
    fn a_crossing_is_due_in_the_step_that_it_was_set_to_last() {
        let mut queue = EventQueue::new(Clock::new(10.0), 7, 4);
        for (slot, steps) in [(0, 1), (1, 1), (1, 3), (2, 3), (2, 2), (3, 100)] {
            queue.set_crossing(slot, Some(steps));
        }
        assert_eq!(due(&mut queue), [0]);
        assert_eq!(due(&mut queue), [2]);
        assert_eq!(due(&mut queue), [1]);
        assert!((11..107).all(|_| due(&mut queue).is_empty()));
        assert_eq!(due(&mut queue), [3]);
    }

    #[test]
    fn a_crossing_that_is_removed_is_never_due() {
        let mut queue = EventQueue::new(Clock::new(10.0), 0, 1);
        queue.set_crossing(0, Some(40));
        queue.set_crossing(0, None);
        assert!((0..100).all(|_| due(&mut queue).is_empty()));
    }

    #[test]
    fn a_body_whose_crossing_is_due_has_no_event_until_it_predicts_again() {
        let mut queue = EventQueue::new(Clock::new(10.0), 0, 1);
        queue.set(0, event(2.0, 0.05, [0, 1]));
        queue.set_crossing(0, Some(2));
        assert!(due(&mut queue).is_empty() && !queue.is_step_empty(), "the crossing is due at the end of the step");
        assert_eq!((due(&mut queue), queue.next_time()), (vec![0], Instant::NEVER));
    }

    #[test]
    fn an_event_after_a_crossing_and_a_crossing_after_an_event_are_both_kept() {
        for (event_step, steps) in [(2.0, 50), (50.0, 2), (0.0, 1)] {
            let mut queue = EventQueue::new(Clock::new(10.0), 0, 1000);
            queue.set_crossing(0, Some(steps));
            queue.set(0, event(event_step, 0.05, [0, 1]));
            let (mut popped, mut crossed) = (None, None);
            for step in 0..100_u32 {
                if queue.pop(Clock::new(10.0).start_of(u64::from(step) + 1)).is_some() {
                    popped = Some(f64::from(step));
                }
                if !due(&mut queue).is_empty() {
                    crossed = Some(step + 1);
                    queue.set(0, event(event_step, 0.05, [0, 1]).filter(|_| popped.is_none()));
                }
            }
            assert_eq!((popped, crossed), (Some(event_step), Some(steps)));
        }
    }

    #[test]
    fn a_step_is_empty_until_something_is_due_in_it_or_at_its_end() {
        let mut queue = EventQueue::new(Clock::new(10.0), 0, 1);
        queue.set(0, event(3.0, 0.05, [0, 1]));
        queue.set_crossing(1, Some(5));
        let mut skipped = 0;
        while queue.is_step_empty() {
            queue.skip_step();
            skipped += 1;
        }
        assert_eq!(skipped, 2, "the bin of step 3 is not empty");
        assert!(due(&mut queue).is_empty());
        assert_eq!(queue.pop(Instant::NEVER).map(|(slot, _)| slot), Some(0));
    }
}
