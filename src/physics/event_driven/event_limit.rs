/// Repetitions allowed per body and step beyond the limit of events: predictions after cell crossings, of invalidated
/// events and of events whose order doubles cannot decide, and captured bounces. No speed requires nearly as many; the
/// limit ensures that every step ends.
const MAX_REPETITIONS_PER_BODY: u64 = 1000;

/// Of the impacts of an instant that lose energy, one in this number counts against the limit of events. Their sequence
/// ends in any case, but can be long: rows of 50 touching boxes at e = 0.9 hit a wall in 2·10⁷ impacts.
const LOSSY_IMPACTS_PER_EVENT: u64 = 1000;

/// The error of a step that exceeds its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitExceeded;

/// The events and repetitions of a step, and the limits that ensure that it ends.
///
/// Invariant: every event and repetition of the step is counted, and the first that exceeds a limit is an error.
#[derive(Clone, Copy, Debug)]
pub struct EventLimit {
    /// The number of events allowed in a step.
    max_events: u64,
    /// The number of events in the present step.
    events: u64,
    /// The number of repetitions in the present step; see [`MAX_REPETITIONS_PER_BODY`].
    repetitions: u64,
    /// The number of impacts in the present burst that lose energy.
    lossy_impacts: u64,
}

/// An instant whose impacts are counted.
#[must_use]
pub struct CountedInstant {
    /// The number of events with it, if it has one impact.
    events: u64,
}

impl EventLimit {
    /// No events in a step that allows `max_events`.
    pub fn new(max_events: u64) -> EventLimit {
        EventLimit { max_events, events: 0, repetitions: 0, lossy_impacts: 0 }
    }

    /// The number of events allowed in a step.
    pub fn max_events(&self) -> u64 {
        self.max_events
    }

    /// The number of events in the present step.
    #[inline]
    pub fn events(&self) -> u64 {
        self.events
    }

    /// Resets the counts of events and repetitions at the start of a step.
    #[inline]
    pub fn begin_step(&mut self) {
        (self.events, self.repetitions) = (0, 0);
    }

    /// Counts an event.
    #[inline]
    pub fn count_event(&mut self) -> Result<(), LimitExceeded> {
        self.events += 1;
        if self.events > self.max_events { Err(LimitExceeded) } else { Ok(()) }
    }

    /// Counts an event if that does not exceed the limit; returns true if it did.
    #[inline]
    pub fn count_allowed_event(&mut self) -> bool {
        let is_allowed = self.events < self.max_events;
        self.events += u64::from(is_allowed);
        is_allowed
    }

    /// Counts a repetition in a step of a number of bodies.
    #[inline]
    pub fn count_repetition(&mut self, bodies: usize) -> Result<(), LimitExceeded> {
        self.repetitions += 1;
        let allowed = self.max_events.saturating_add(MAX_REPETITIONS_PER_BODY * bodies as u64);
        if self.repetitions > allowed.saturating_add(self.events) { Err(LimitExceeded) } else { Ok(()) }
    }

    /// Counts the impacts of the event that was counted last, an instant, instead of the event.
    pub fn begin_instant(&mut self) -> CountedInstant {
        let events = self.events;
        self.events -= 1;
        CountedInstant { events }
    }

    /// Ends an instant, which counts as one event at least.
    pub fn end_instant(&mut self, instant: CountedInstant) {
        self.events = self.events.max(instant.events);
    }

    /// Begins the impacts of an instant.
    pub fn begin_burst(&mut self) {
        self.lossy_impacts = 0;
    }

    /// Counts an impact of the burst with a coefficient of restitution.
    #[inline]
    pub fn count_impact(&mut self, restitution: f64) -> Result<(), LimitExceeded> {
        self.lossy_impacts += u64::from(restitution < 1.0);
        let is_counted = restitution == 1.0 || self.lossy_impacts.is_multiple_of(LOSSY_IMPACTS_PER_EVENT);
        if is_counted { self.count_event() } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_event_beyond_the_limit_is_an_error() {
        let mut limit = EventLimit::new(2);
        assert_eq!([(); 3].map(|()| limit.count_event()), [Ok(()), Ok(()), Err(LimitExceeded)]);
        limit.begin_step();
        assert_eq!([(); 3].map(|()| limit.count_allowed_event()), [true, true, false]);
    }

    #[test]
    fn repetitions_are_allowed_per_body_and_event() {
        let mut limit = EventLimit::new(2);
        limit.count_event().unwrap();
        let allowed = 2 + 3 * MAX_REPETITIONS_PER_BODY + 1;
        assert!((0..allowed).all(|_| limit.count_repetition(3).is_ok()));
        assert_eq!(limit.count_repetition(3), Err(LimitExceeded));
    }

    #[test]
    fn an_instant_counts_as_its_impacts_and_at_least_as_one_event() {
        let mut limit = EventLimit::new(10);
        for (impacts, events) in [(0, 1), (1, 2), (3, 5)] {
            limit.count_event().unwrap();
            let instant = limit.begin_instant();
            limit.begin_burst();
            (0..impacts).for_each(|_| limit.count_impact(1.0).unwrap());
            limit.end_instant(instant);
            assert_eq!(limit.events(), events);
        }
    }

    #[test]
    fn of_the_impacts_that_lose_energy_few_count() {
        let mut limit = EventLimit::new(10);
        limit.begin_burst();
        (0..2 * LOSSY_IMPACTS_PER_EVENT + 1).for_each(|_| limit.count_impact(0.5).unwrap());
        assert_eq!(limit.events(), 2);
    }
}
