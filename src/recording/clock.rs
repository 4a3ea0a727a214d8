/// Returns the simulated time of state `step`, in nanoseconds since the start of the run.
///
/// Exact (rounded down) if `rate` (Hz) is an integer, else to the precision of f64. Saturates at
/// `u64::MAX` (584 years).
pub fn nanoseconds(step: u64, rate: f64) -> u64 {
    const SECOND: u128 = 1_000_000_000;
    let whole = rate as u64;
    if whole as f64 == rate {
        u64::try_from(u128::from(step) * SECOND / u128::from(whole)).unwrap_or(u64::MAX)
    } else {
        (step as f64 * SECOND as f64 / rate) as u64
    }
}

/// Returns the number of steps nearest to a second of simulated time, at least 1.
pub fn steps_per_second(rate: f64) -> u64 {
    (rate.round() as u64).max(1)
}

/// Returns true if the state of `step` is the last one of its second, after which a writer flushes.
pub fn ends_second(step: u64, rate: f64) -> bool {
    (step % steps_per_second(rate)) + 1 == steps_per_second(rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integer_rates_are_exact() {
        assert_eq!(nanoseconds(1, 60.0), 16_666_666);
        assert_eq!(nanoseconds(86_400 * 60, 60.0), 86_400_000_000_000);
        assert_eq!(nanoseconds(3, 0.5), 6_000_000_000);
        assert_eq!(nanoseconds(u64::MAX, 1.0), u64::MAX);
    }

    #[test]
    fn a_second_has_at_least_one_step() {
        assert_eq!([0.1, 1.0, 59.94, 60.0].map(steps_per_second), [1, 1, 60, 60]);
    }
}
