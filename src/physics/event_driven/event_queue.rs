//! The event queue: a bin for each of the next steps, bins for slices of the current step, and a
//! binary heap for the current slice.
//!
//! Each body has at most one event in the queue. The bins sort only roughly; within a slice the heap
//! delivers events in their total order, so the width of the slices changes no result.

use super::body_state::Slot;
use super::instant::{Clock, Instant};
use super::pair_event::PairEvent;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

const NONE: u32 = u32::MAX;

/// Bodies per slice of a step: few enough to keep the heap small, enough to leave few slices empty.
const BODIES_PER_SLICE: u64 = 32;

/// Heap length up to which invalidated events are never removed.
const MIN_PURGE_LEN: usize = 64;

/// Number of steps that have a bin. Later events are kept in the last bin and inserted again when it
/// is due.
const STEP_BINS: u64 = 32;

/// The next event of a body: an event of a pair or a cell crossing.
///
/// An event of a pair is stored with one of the two bodies, the one whose prediction is more recent.
/// It is invalidated if the partner's generation has changed since; when it is due, the body predicts
/// again.
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
    /// How well the time is known.
    pub precision: Precision,
}

/// How well the time of a scheduled event is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// The event does not happen earlier.
    LowerBound,
    /// The event does not happen earlier, and another one of the body may precede it.
    Contested,
    /// To the rounding of the state.
    Exact,
}

impl ScheduledEvent {
    /// Returns true if this event precedes `other` in the total order: by time, then by the lower slot of the
    /// pair, then by the higher.
    #[inline]
    pub fn is_before(&self, other: &ScheduledEvent) -> bool {
        self.at.is_before(other.at) || (self.at == other.at && self.pair < other.pair)
    }
}

/// An event in the heap. It is valid while its stamp equals the body's.
#[derive(Clone, Copy, Debug)]
struct HeapEntry {
    event: ScheduledEvent,
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
        if self.event.is_before(&other.event) {
            Ordering::Less
        } else if other.event.is_before(&self.event) {
            Ordering::Greater
        } else {
            self.slot.cmp(&other.slot)
        }
    }
}

/// The event of a body and the bin in which the body is listed.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct QueueEntry {
    event: ScheduledEvent,
    /// The slice of the bin that lists the body: the slice itself in the current step, otherwise the
    /// first slice of the step; [`NO_BIN`] if none does.
    bin: u64,
    /// The number of changes of `event`, modulo 2³².
    stamp: u32,
}

const NO_BIN: u64 = u64::MAX;

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

/// The last slice that is filed exactly.
const MAX_SLICE: f64 = (1_u64 << 62) as f64;

const EMPTY_ENTRY: QueueEntry = QueueEntry { event: NO_EVENT, bin: NO_BIN, stamp: 0 };

/// The events of all bodies.
///
/// A body whose event is postponed stays in its bin until the bin is due and is inserted again then.
/// So at most one entry of a body in the bins is valid, the one that its `bin` names.
#[derive(Clone, Debug)]
pub struct EventQueue {
    clock: Clock,
    /// Base-2 logarithm of the number of slices per step.
    log2_slices: u32,
    /// The slice whose events are in the heap, counted from step 0.
    current_slice: u64,
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
        let log2_slices = (bodies as u64 / BODIES_PER_SLICE).clamp(1, 1 << 10).next_power_of_two().trailing_zeros();
        EventQueue {
            clock,
            log2_slices,
            current_slice: step << log2_slices,
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
        if self.entries.len() <= slot as usize {
            self.entries.resize(slot as usize + 1, EMPTY_ENTRY);
        }
        let event = event.unwrap_or(NO_EVENT);
        let entry = &mut self.entries[slot as usize];
        if entry.event == event {
            return;
        }
        entry.stamp = entry.stamp.wrapping_add(1);
        entry.event = event;
        if event != NO_EVENT {
            self.insert(slot);
        }
    }

    /// True if the body waits for an event of the pair.
    #[cfg(debug_assertions)]
    pub fn holds(&self, slot: Slot, pair: [Slot; 2]) -> bool {
        self.entries
            .get(slot as usize)
            .is_some_and(|entry| entry.event.pair == pair && entry.event.pair_event.is_some())
    }

    /// Removes the event of a body if it is one of the pair.
    pub fn take_event_of(&mut self, slot: Slot, pair: [Slot; 2]) -> Option<ScheduledEvent> {
        let entry = self.entries.get_mut(slot as usize)?;
        let event = entry.event;
        if event.pair != pair || event.pair_event.is_none() {
            return None;
        }
        entry.stamp = entry.stamp.wrapping_add(1);
        entry.event = NO_EVENT;
        Some(event)
    }

    /// Removes the first event, if it is due by an instant of the current step, and returns it with its body.
    pub fn pop(&mut self, until: Instant) -> Option<(Slot, ScheduledEvent)> {
        if until.is_before(self.next_time()) {
            return None;
        }
        let Reverse(first) = self.heap.pop()?;
        self.entries[first.slot as usize].event = NO_EVENT;
        Some((first.slot, first.event))
    }

    /// The time of the first event of the current step; [`Instant::NEVER`] if there is none.
    pub fn next_time(&mut self) -> Instant {
        let end = ((self.current_slice >> self.log2_slices) + 1) << self.log2_slices;
        loop {
            while let Some(Reverse(first)) = self.heap.peek() {
                if self.entries[first.slot as usize].stamp == first.stamp {
                    return first.event.at;
                }
                self.heap.pop();
            }
            if self.current_slice + 1 >= end {
                return Instant::NEVER;
            }
            self.advance();
        }
    }

    /// Begins a step: moves the bodies in its bin to the bins of its slices or to the heap.
    pub fn begin_step(&mut self, step: u64) {
        if self.current_slice < step << self.log2_slices {
            self.current_slice = step << self.log2_slices;
            let index = (step % STEP_BINS) as usize;
            let bin = std::mem::take(&mut self.step_bins[index]);
            self.step_bins[index] = self.redistribute(bin);
        }
    }

    /// Returns true if no entry is due in `step`, the next step.
    pub fn is_step_empty(&self, step: u64) -> bool {
        self.heap.is_empty() && self.binned == 0 && self.step_bins[(step % STEP_BINS) as usize].is_empty()
    }

    /// Skips a step without entries.
    pub fn skip_step(&mut self, step: u64) {
        self.current_slice = ((step + 1) << self.log2_slices) - 1;
    }

    /// Advances to the next slice, or to the last slice of the step if all bins are empty.
    fn advance(&mut self) {
        let last = self.current_slice | (self.slice_bins.len() as u64 - 1);
        self.current_slice = if self.binned == 0 { last } else { self.current_slice + 1 };
        let index = (self.current_slice & (self.slice_bins.len() as u64 - 1)) as usize;
        let bin = std::mem::take(&mut self.slice_bins[index]);
        self.binned -= bin.len();
        self.slice_bins[index] = self.redistribute(bin);
    }

    /// Inserts again the bodies that are still listed in the current bin; returns the emptied bin.
    fn redistribute(&mut self, mut bin: Vec<Slot>) -> Vec<Slot> {
        for slot in bin.drain(..) {
            let entry = &mut self.entries[slot as usize];
            if entry.bin == self.current_slice {
                entry.bin = NO_BIN;
                if entry.event != NO_EVENT {
                    self.insert(slot);
                }
            }
        }
        bin
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
    fn insert(&mut self, slot: Slot) {
        let entry = &mut self.entries[slot as usize];
        let last = (1 << self.log2_slices) - 1;
        let slice = entry.event.at.high * self.clock.rate * f64::from(1_u32 << self.log2_slices) * EARLINESS;
        let slice = if slice < MAX_SLICE { slice as u64 } else { MAX_SLICE as u64 };
        let step = slice >> self.log2_slices;
        if slice <= self.current_slice {
            entry.bin = NO_BIN;
            let queued = HeapEntry { event: entry.event, slot, stamp: entry.stamp };
            self.heap.push(Reverse(queued));
            if self.heap.len() > self.purge_threshold {
                self.remove_invalidated();
            }
            return;
        }
        let current_step = self.current_slice >> self.log2_slices;
        let bin = if step == current_step {
            slice
        } else {
            let last_step = current_step + STEP_BINS - 1;
            (if step < last_step { step } else { last_step }) << self.log2_slices
        };
        if bin >= entry.bin {
            return;
        }
        entry.bin = bin;
        if step == current_step {
            self.binned += 1;
            self.slice_bins[(slice & last) as usize].push(slot);
        } else {
            self.step_bins[((bin >> self.log2_slices) % STEP_BINS) as usize].push(slot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            queue.begin_step(step);
            while let Some((slot, _)) = queue.pop(Clock::new(10.0).start_of(step + 1)) {
                order.push((step, slot));
                queue.set(slot, if slot == 5 && step == 3 { event(3.0, 0.03, [5, 5]) } else { None });
                if order.len() == 6 {
                    queue.set(5, None);
                }
            }
        }
        order
    }

    #[test]
    fn invalidated_events_do_not_accumulate_in_the_heap() {
        let mut queue = EventQueue::new(Clock::new(1.0), 0, 100);
        queue.begin_step(0);
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
}
