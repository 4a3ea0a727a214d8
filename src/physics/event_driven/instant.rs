use super::decimal::stated;
use super::double_double::DoubleDouble;
use std::cmp::Ordering;

/// The vicinity of an instant, as a fraction of the time since step 0: the rounding of times in doubles. Events within
/// it are compared by their gaps.
const COMPARED_TIMES: f64 = 1.0 / (1_u64 << 50) as f64;

/// The factor from a time to one that is certainly after the end of its vicinity.
pub const VICINITY: f64 = 1.0 + 4.0 * COMPARED_TIMES;

/// An instant of simulated time: the seconds since step 0 in double-double precision.
///
/// It is independent of the steps and of their rate. Instants between which no coordinate changes by more than its
/// rounding cannot be distinguished.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant {
    /// The seconds, rounded to a double.
    pub high: f64,
    /// The rounding error of `high`.
    pub low: f64,
}

impl Instant {
    /// The start of the run.
    pub const START: Instant = Instant { high: 0.0, low: 0.0 };

    /// An instant after all others.
    pub const NEVER: Instant = Instant { high: f64::INFINITY, low: 0.0 };

    /// Returns true if this instant precedes `other`.
    #[inline]
    pub fn is_before(self, other: Instant) -> bool {
        (self.high < other.high) | ((self.high == other.high) & (self.low < other.low))
    }

    /// Compares two instants in a total order.
    pub fn total_cmp(self, other: Instant) -> Ordering {
        self.high.total_cmp(&other.high).then(self.low.total_cmp(&other.low))
    }

    /// Returns the later of two instants.
    #[inline]
    pub fn max(self, other: Instant) -> Instant {
        if self.is_before(other) { other } else { self }
    }

    /// The seconds until `other`, negative if it is earlier.
    #[inline]
    pub fn seconds_until(self, other: Instant) -> f64 {
        (other.high - self.high) + (other.low - self.low)
    }

    /// The seconds until `other` in double-double precision.
    #[inline]
    pub fn exact_seconds_until(self, other: Instant) -> DoubleDouble {
        other.as_number() - self.as_number()
    }

    /// The instant a number of seconds later; [`Instant::NEVER`] if that is not finite.
    #[inline]
    pub fn after(self, seconds: f64) -> Instant {
        self.after_exactly(seconds.into())
    }

    /// The instant a number of seconds later; [`Instant::NEVER`] if that is not finite.
    #[inline]
    pub fn after_exactly(self, seconds: DoubleDouble) -> Instant {
        let DoubleDouble { high, low } = self.as_number() + seconds;
        if high.is_finite() && low.is_finite() { Instant { high, low } } else { Instant::NEVER }
    }

    /// The last time that is compared with this instant by gaps.
    pub fn end_of_vicinity(self) -> Instant {
        self.after(self.high * COMPARED_TIMES)
    }

    /// The seconds since step 0.
    #[inline]
    pub fn as_number(self) -> DoubleDouble {
        DoubleDouble { high: self.high, low: self.low }
    }
}

/// The steps of a run: the instants at which the state is sampled.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Steps per second, Hz.
    pub rate: f64,
    /// The rate as the decimal that it stands for.
    stated_rate: DoubleDouble,
    /// Seconds per step.
    pub period: f64,
}

impl Clock {
    /// Creates a clock of `rate` steps per second.
    pub fn new(rate: f64) -> Clock {
        Clock { rate, stated_rate: stated(rate), period: 1.0 / rate }
    }

    /// The instant of the state of a step.
    pub fn start_of(&self, step: u64) -> Instant {
        let DoubleDouble { high, low } = DoubleDouble::from(step as f64) / self.stated_rate;
        Instant { high, low }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_that_differ_by_a_power_of_two_sample_at_the_same_instants() {
        for step in [1, 7, 1000, 123_456_789] {
            assert_eq!(Clock::new(60.0).start_of(step), Clock::new(240.0).start_of(4 * step));
        }
    }

    #[test]
    fn decimal_rates_sample_at_the_instants_of_whole_ones() {
        for (rate, steps, whole_rate, whole_steps) in [
            (0.1, 864, 1.0, 8640),
            (0.3, 9, 1.0, 30),
            (59.94, 2997, 1.0, 50),
            (1e-3, 7, 1.0, 7000),
            (12.6, 63, 60.0, 300),
        ] {
            let instants = [Clock::new(rate).start_of(steps), Clock::new(whole_rate).start_of(whole_steps)];
            let [decimal, whole] = instants.map(Instant::as_number);
            assert!((decimal - whole).high.abs() <= 1e-31 * whole.high, "{rate} Hz: {decimal:?}, not {whole:?}");
        }
    }

    #[test]
    fn a_rate_of_any_number_of_thousandths_samples_at_whole_seconds() {
        for thousandths in 1..=20_000_u32 {
            let sample = Clock::new(f64::from(thousandths) / 1000.0).start_of(thousandths.into()).as_number();
            assert!((sample - 1000.0.into()).high.abs() <= 1e-28, "{thousandths}: {sample:?}");
        }
    }

    #[test]
    fn a_day_does_not_coarsen_the_difference_of_instants() {
        let late = Instant { high: 86_400.0, low: 0.0 };
        let later = late.after(1e-13);
        assert!(late.is_before(later) && !later.is_before(late));
        assert_eq!(late.seconds_until(later), 1e-13);
        assert_eq!(late.max(later), later);
    }

    #[test]
    fn an_instant_that_is_not_finite_is_never() {
        assert_eq!(Instant::START.after(f64::INFINITY), Instant::NEVER);
        assert!(Instant::START.is_before(Instant::NEVER));
    }
}
