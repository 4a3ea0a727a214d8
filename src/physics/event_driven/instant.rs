use super::double_double::DoubleDouble;

/// An instant of simulated time: a step and the seconds since its start.
///
/// As a single number of seconds, time would have a resolution of 10⁻¹¹ s after a day. Split like this
/// its resolution does not decrease.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// The step, an integer; stored as a float because it is only subtracted.
    pub step: f64,
    /// Seconds since the start of the step, at most one period.
    pub offset: f64,
}

impl Instant {
    /// An instant after all others.
    pub const NEVER: Instant = Instant { step: f64::INFINITY, offset: 0.0 };

    /// The start of a step.
    pub const fn start_of(step: u64) -> Instant {
        Instant { step: step as f64, offset: 0.0 }
    }

    /// Returns true if this instant precedes `other`.
    pub fn is_before(self, other: Instant) -> bool {
        (self.step < other.step) | ((self.step == other.step) & (self.offset < other.offset))
    }

    /// Returns the later of two instants.
    pub fn max(self, other: Instant) -> Instant {
        if self.is_before(other) { other } else { self }
    }
}

/// Upper bound of the rounding error of a predicted time, s, except for marginal events such as impacts
/// at almost zero speed.
pub const MAX_TIME_ROUNDING: f64 = 1e-7;

/// From this step on, doubles do not represent every integer. Later events are not predicted.
const MAX_STEP: f64 = (1u64 << 53) as f64;

/// The largest integer below a positive number; infinity from [`MAX_STEP`] on and for NaN.
fn largest_integer_below(number: f64) -> f64 {
    if number >= MAX_STEP || number.is_nan() {
        return f64::INFINITY;
    }
    let whole = number as i64 as f64;
    if whole == number { whole - 1.0 } else { whole }
}

/// The rate of the steps; converts between instants and seconds.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Steps per second, Hz.
    pub rate: f64,
    /// Seconds per step.
    pub period: f64,
    /// Seconds per step, in double-double precision.
    pub period_dd: DoubleDouble,
}

impl Clock {
    /// Creates a clock of `rate` steps per second.
    pub fn new(rate: f64) -> Clock {
        Clock { rate, period: 1.0 / rate, period_dd: DoubleDouble::from(1.0) / rate.into() }
    }

    /// The seconds from one instant to another.
    #[inline]
    pub fn seconds_between(&self, from: Instant, to: Instant) -> f64 {
        (to.step - from.step) / self.rate + (to.offset - from.offset)
    }

    /// Like [`Clock::seconds_between`], faster but less exact: only for bounds, never for results.
    #[inline]
    pub fn approx_seconds(&self, from: Instant, to: Instant) -> f64 {
        (to.step - from.step) * self.period + (to.offset - from.offset)
    }

    /// The last instant of `step`, which must be an integer.
    pub fn end_of(&self, step: f64) -> Instant {
        Instant { step, offset: self.period }
    }

    /// The instant `seconds` (not negative) after `from`; [`Instant::NEVER`] if it is too late to be
    /// represented.
    ///
    /// The end of a step belongs to that step, so that events at the instant of a sample precede it.
    pub fn after(&self, from: Instant, seconds: f64) -> Instant {
        let offset = from.offset + seconds;
        if offset <= self.period {
            return Instant { step: from.step, offset };
        }
        let steps = largest_integer_below(offset * self.rate);
        if from.step + steps < MAX_STEP {
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
    fn seconds_between_inverts_after_up_to_rounding() {
        let clock = Clock::new(60.0);
        let start = Instant { step: 5_184_000.0, offset: 0.003 };
        for seconds in [1e-9, 0.01, 0.7, 12.5, 3600.0] {
            let end = clock.after(start, seconds);
            assert!(
                (clock.seconds_between(start, end) - seconds).abs() <= 2.0 * f64::EPSILON * (seconds + clock.period)
            );
            assert!(end.offset >= 0.0 && end.offset <= clock.period);
        }
    }

    #[test]
    fn an_instant_too_late_to_be_represented_is_never() {
        let clock = Clock::new(60.0);
        assert_eq!(clock.after(Instant::start_of(1), 1e300), Instant::NEVER);
        assert_eq!(clock.after(Instant::start_of(1), f64::INFINITY), Instant::NEVER);
    }
}
