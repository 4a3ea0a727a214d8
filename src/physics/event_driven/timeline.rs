use super::instant::{Clock, Instant};

/// The present instant and step.
///
/// Invariants: `step_start` and `step_end` are the instants of two consecutive states, the present instant is between
/// them up to the vicinity of the end, and it never decreases, except from an event to the sample that coincides with
/// it.
#[derive(Clone, Copy, Debug)]
pub struct Timeline {
    clock: Clock,
    now: Instant,
    step: u64,
    /// The instant of the state before the present step.
    step_start: Instant,
    /// The instant of the state after it.
    step_end: Instant,
}

impl Timeline {
    /// The start of a run.
    pub fn new(clock: Clock) -> Timeline {
        Timeline { clock, now: Instant::START, step: 0, step_start: Instant::START, step_end: clock.start_of(1) }
    }

    /// The steps of the run.
    #[inline]
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// The present instant.
    #[inline]
    pub fn now(&self) -> Instant {
        self.now
    }

    /// The present instant, or the start of a step if that is later: steps in which nothing happens do not advance it.
    pub fn now_in(&self, step: u64) -> Instant {
        self.now.max(self.clock.start_of(step))
    }

    /// The present step.
    #[inline]
    pub fn step(&self) -> u64 {
        self.step
    }

    /// The instant of the state before the present step.
    #[inline]
    pub fn step_start(&self) -> Instant {
        self.step_start
    }

    /// The instant of the state after the present step.
    #[inline]
    pub fn step_end(&self) -> Instant {
        self.step_end
    }

    /// The seconds from the start of the present step to the present instant.
    #[inline]
    pub fn elapsed(&self) -> f64 {
        self.step_start.seconds_until(self.now)
    }

    /// Advances to the start of a step.
    pub fn begin_at(&mut self, step: u64) {
        if step != self.step {
            self.step_start = if step == self.step + 1 { self.step_end } else { self.clock.start_of(step) };
            self.step_end = self.clock.start_of(step + 1);
            self.step = step;
        }
        self.advance_to(self.step_start);
    }

    /// Advances to an instant, unless it is in the past.
    #[inline]
    pub fn advance_to(&mut self, instant: Instant) {
        self.now = self.now.max(instant);
    }

    /// Advances to an instant that is certainly not in the past.
    #[inline]
    pub fn advance_to_later(&mut self, instant: Instant) {
        debug_assert!(!instant.is_before(self.now));
        self.now = instant;
    }

    /// Returns from an event to the sample that coincides with it, if the event is later by rounding.
    #[inline]
    pub fn return_to(&mut self, sample: Instant) {
        if sample.is_before(self.now) {
            self.now = sample;
        }
    }

    /// Sets the present instant and the start of the present step from a snapshot.
    pub fn restore(&mut self, now: Instant, step: u64) {
        self.now = now;
        self.begin_at(step);
    }
}
