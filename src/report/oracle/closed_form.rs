//! Motions with a closed form, to 77 decimals.

use super::Fixed256;

/// A box that falls onto a floor and bounces.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// Height of the fall before the first impact, m.
    pub height: f64,
    /// Acceleration, m/s².
    pub gravity: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

impl Bounce {
    /// Returns the distance below the start (m) after `time` (s) and the number of impacts, which is
    /// `None` after an infinite sequence of bounces has ended.
    ///
    /// The fall takes t₀ = √(2h/g). The k-th flight after it starts at speed eᵏ·g·t₀ and takes 2·t₀·eᵏ.
    /// With e < 1 the box rests from t₀·(1 + e)/(1 − e) on.
    pub fn state_at(&self, time: &Fixed256) -> (Fixed256, Option<u64>) {
        let [height, gravity, e] = [self.height, self.gravity, self.restitution].map(Fixed256::stated);
        let (one, two) = (Fixed256::from(1.0), Fixed256::from(2.0));
        let Some(fall) = (&(&two * &height) / &gravity).square_root() else { return (Fixed256::zero(), None) };
        if *time < fall {
            return (&(&gravity * &(time * time)) / &two, Some(0));
        }
        let since = time - &fall;
        let first_flight = &(&two * &fall) * &e;
        let (flown, flight, flights) = if e == one {
            let flights = (&since / &first_flight).floor();
            (&since - &(&flights * &first_flight), first_flight, flights.to_f64() as u64)
        } else if since >= &first_flight / &(&one - &e) {
            return (height, None);
        } else {
            last_flight(since, first_flight, &e)
        };
        let risen = &(&(&gravity * &flown) * &(&flight - &flown)) / &two;
        (&height - &risen, Some(flights + 1))
    }
}

/// For flights that each take e times as long as the one before: returns the time since the current
/// flight began, its duration, and the number of flights before it.
fn last_flight(mut since: Fixed256, mut flight: Fixed256, e: &Fixed256) -> (Fixed256, Fixed256, u64) {
    let mut flights = 0;
    while since >= flight && !flight.is_zero() {
        since = &since - &flight;
        flight = &flight * e;
        flights += 1;
    }
    (since, flight, flights)
}

/// Position of a point that starts at `from` (m) and moves at `velocity` (m/s), m.
pub fn uniform(from: f64, velocity: f64, time: &Fixed256) -> Fixed256 {
    &Fixed256::stated(from) + &(&Fixed256::stated(velocity) * time)
}

/// Returns the velocities (m/s) of a row of touching boxes of equal mass after it has hit a wall at 1 m/s, the nearest
/// box first, and the number of impacts.
///
/// All impacts happen in one instant: the lowest of the pairs that approach, until none does. With e = 0 they are an
/// infinite sequence, whose limit is rest.
pub fn burst_velocities(boxes: usize, restitution: f64) -> (Vec<Fixed256>, u64) {
    let minus = -&Fixed256::from(1.0);
    let mut velocities = vec![if restitution > 0.0 { minus } else { Fixed256::zero() }; boxes];
    let (half, e) = (Fixed256::from(0.5), Fixed256::stated(restitution));
    let [kept, given] = [&half - &(&half * &e), &half + &(&half * &e)];
    let (mut pair, mut impacts) = (0, 0);
    while pair < boxes {
        let velocity = velocities[pair].clone();
        let nearer = pair.checked_sub(1).map(|nearer| velocities[nearer].clone());
        match nearer {
            None if velocity < Fixed256::zero() => velocities[0] = -&(&e * &velocity),
            Some(nearer) if nearer > velocity => {
                velocities[pair - 1] = &(&kept * &nearer) + &(&given * &velocity);
                velocities[pair] = &(&given * &nearer) + &(&kept * &velocity);
            }
            None | Some(_) => {
                pair += 1;
                continue;
            }
        }
        impacts += 1;
        pair = pair.saturating_sub(1);
    }
    (velocities, impacts)
}

/// Position of a point that starts at `from` (m), moves at `velocity` (m/s) and is reflected at `turn` (m), m.
pub fn reflected(from: f64, velocity: f64, turn: f64, time: &Fixed256) -> Fixed256 {
    let uniform = uniform(from, velocity, time);
    let turn = Fixed256::stated(turn);
    let beyond = if velocity > 0.0 { uniform > turn } else { uniform < turn };
    if beyond { &(&turn + &turn) - &uniform } else { uniform }
}

/// Number of collisions of Galperin's billiard with a mass ratio of 100^digits: the first
/// `digits` + 1 digits of π (G. Galperin, "Playing pool with π", 2003).
pub const fn galperin_collisions(digits: u32) -> u64 {
    314_159_265_358 / 10_u64.pow(11 - digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: f64) -> Fixed256 {
        Fixed256::from(value)
    }

    #[test]
    fn an_elastic_bounce_returns_to_its_start() {
        // t₀ = 1 s: back at the start at 2, 4, 6, … s.
        let bounce = Bounce { height: 5.0, gravity: 10.0, restitution: 1.0 };
        assert_eq!(bounce.state_at(&number(0.5)), (number(1.25), Some(0)));
        assert_eq!(bounce.state_at(&number(1.0)), (number(5.0), Some(1)));
        assert_eq!(bounce.state_at(&number(2_000_000.0)), (number(0.0), Some(1_000_000)));
        assert_eq!(bounce.state_at(&number(1.5)), (number(1.25), Some(1)));
    }

    #[test]
    fn bounces_of_half_the_speed_end_after_three_falls() {
        // Flights of 1, 1/2, 1/4, … s after the fall of 1 s: 1.25 m high, a quarter of that, …
        let bounce = Bounce { height: 5.0, gravity: 10.0, restitution: 0.5 };
        assert_eq!(bounce.state_at(&number(1.5)), (number(3.75), Some(1)));
        assert_eq!(bounce.state_at(&number(2.25)), (number(5.0 - 0.3125), Some(2)));
        assert_eq!(bounce.state_at(&number(2.875)).1, Some(5));
        assert_eq!(bounce.state_at(&number(3.0)), (number(5.0), None));
    }

    #[test]
    fn a_reflected_point_returns_at_the_same_speed() {
        assert_eq!(reflected(1.0, 2.0, 4.0, &number(1.0)), number(3.0));
        assert_eq!(reflected(1.0, 2.0, 4.0, &number(2.0)), number(3.0));
        assert_eq!(reflected(1.0, -2.0, -4.0, &number(5.0)), number(1.0));
    }

    #[test]
    fn bursts_of_rows_have_the_impacts_of_rational_arithmetic_and_separate_all_boxes() {
        for (boxes, restitution, impacts) in [(8, 0.9, 80), (16, 0.99, 396), (20, 1.0, 210), (5, 0.0, 0)] {
            let (velocities, found) = burst_velocities(boxes, restitution);
            assert_eq!(found, impacts);
            assert!(velocities.is_sorted() && velocities[0] >= number(0.0));
        }
        let (velocities, _) = burst_velocities(16, 0.99);
        assert!((velocities[0].to_f64() - 0.849805).abs() < 1e-6 && (velocities[15].to_f64() - 0.856223).abs() < 1e-6);
    }

    #[test]
    fn galperin_counts_the_digits_of_pi() {
        assert_eq!([0, 1, 4, 9].map(galperin_collisions), [3, 31, 31_415, 3_141_592_653]);
    }
}
