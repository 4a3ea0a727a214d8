use super::double_double::DoubleDouble;

/// A moment of simulated time: a step and the seconds since that step began.
///
/// A day of simulated time in seconds would leave 10⁻¹¹ s of resolution; split like this
/// an instant is as sharp on the last day as in the first step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// The step, a whole number; as a float because it is only ever subtracted.
    pub step: f64,
    /// Seconds since the step began, at most one period.
    pub offset: f64,
}

impl Instant {
    /// After everything that ever happens.
    pub const NEVER: Instant = Instant { step: f64::INFINITY, offset: 0.0 };

    /// The beginning of a step.
    pub const fn start_of(step: u64) -> Instant {
        Instant { step: step as f64, offset: 0.0 }
    }

    /// Whether this instant comes before `other`.
    pub fn is_before(self, other: Instant) -> bool {
        (self.step < other.step) | ((self.step == other.step) & (self.offset < other.offset))
    }

    /// The later of the two.
    pub fn or_later(self, other: Instant) -> Instant {
        if self.is_before(other) { other } else { self }
    }
}

/// What rounding can do to an instant is less than this, s, unless what happens then hardly
/// happens at all, like faces that meet at almost no speed.
pub const LONGEST_ROUNDING: f64 = 1e-7;

/// Steps beyond this are not whole numbers any more: an event out there never happens.
const LAST_STEP: f64 = (1u64 << 53) as f64;

/// The greatest whole number below a positive one; infinity for what is too large to tell.
fn whole_below(number: f64) -> f64 {
    if number >= LAST_STEP || number.is_nan() {
        return f64::INFINITY;
    }
    let whole = number as i64 as f64;
    if whole == number { whole - 1.0 } else { whole }
}

/// Counts seconds between instants.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Steps per second, Hz.
    pub rate: f64,
    /// Seconds per step.
    pub period: f64,
    /// The same to 32 digits.
    pub exact_period: DoubleDouble,
}

impl Clock {
    /// The clock of that many steps per second.
    pub fn new(rate: f64) -> Clock {
        Clock { rate, period: 1.0 / rate, exact_period: DoubleDouble::from(1.0) / rate.into() }
    }

    /// Seconds from one instant to another.
    #[inline]
    pub fn seconds(&self, from: Instant, to: Instant) -> f64 {
        (to.step - from.step) / self.rate + (to.offset - from.offset)
    }

    /// The same, but for rounding: good enough where nothing is decided by it.
    #[inline]
    pub fn about(&self, from: Instant, to: Instant) -> f64 {
        (to.step - from.step) * self.period + (to.offset - from.offset)
    }

    /// The very end of a step, a whole number.
    pub fn end_of(&self, step: f64) -> Instant {
        Instant { step, offset: self.period }
    }

    /// The instant so many seconds (not negative) after another.
    ///
    /// The very end of a step belongs to that step, so that what happens at the instant of
    /// a sample has happened when the sample is taken.
    pub fn after(&self, from: Instant, seconds: f64) -> Instant {
        let offset = from.offset + seconds;
        if offset <= self.period {
            return Instant { step: from.step, offset };
        }
        let steps = whole_below(offset * self.rate);
        if from.step + steps < LAST_STEP {
            let rest = offset - steps / self.rate;
            let offset = if rest < 0.0 {
                0.0
            } else if rest > self.period {
                self.period
            } else {
                rest
            };
            Instant { step: from.step + steps, offset }
        } else {
            Instant::NEVER
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_step_belongs_to_it() {
        let clock = Clock::new(4.0);
        let start = Instant::start_of(3);
        assert_eq!(clock.after(start, 0.25), Instant { step: 3.0, offset: 0.25 });
        assert_eq!(clock.after(start, 0.375), Instant { step: 4.0, offset: 0.125 });
        assert_eq!(clock.after(start, 1.0), Instant { step: 6.0, offset: 0.25 });
    }

    #[test]
    fn seconds_undo_after_to_rounding() {
        let clock = Clock::new(60.0);
        let start = Instant { step: 5_184_000.0, offset: 0.003 };
        for seconds in [1e-9, 0.01, 0.7, 12.5, 3600.0] {
            let there = clock.after(start, seconds);
            assert!((clock.seconds(start, there) - seconds).abs() <= 2.0 * f64::EPSILON * (seconds + clock.period));
            assert!(there.offset >= 0.0 && there.offset <= clock.period);
        }
    }

    #[test]
    fn what_is_too_far_away_never_happens() {
        let clock = Clock::new(60.0);
        assert_eq!(clock.after(Instant::start_of(1), 1e300), Instant::NEVER);
        assert_eq!(clock.after(Instant::start_of(1), f64::INFINITY), Instant::NEVER);
    }
}
