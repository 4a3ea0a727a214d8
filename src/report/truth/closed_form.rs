//! Motions that mechanics knows in closed form, to 77 decimals.

use super::Number;

/// A box that falls onto a floor and bounces.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// What it falls before it first touches the floor, m.
    pub height: f64,
    /// m/s².
    pub gravity: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

impl Bounce {
    /// How far it is below where it began after so many seconds, m, and how often it has hit the
    /// floor; after the end of infinitely many bounces the count is none.
    ///
    /// The fall lasts t₀ = √(2h/g), the k-th flight after it 2·t₀·eᵏ, from where it leaves the
    /// floor at e^k·g·t₀; with e < 1 all is over at t₀·(1 + e)/(1 − e).
    pub fn at(&self, time: &Number) -> (Number, Option<u64>) {
        let [height, gravity, e] = [self.height, self.gravity, self.restitution].map(Number::from);
        let (one, two) = (Number::from(1.0), Number::from(2.0));
        let Some(fall) = (&(&two * &height) / &gravity).square_root() else { return (Number::zero(), None) };
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

/// Of flights that each last e times the one before: the time since the last one began, how long
/// it lasts, and how many were before it.
fn last_flight(mut since: Number, mut flight: Number, e: &Number) -> (Number, Number, u64) {
    let mut flights = 0;
    while since >= flight && !flight.is_zero() {
        since = &since - &flight;
        flight = &flight * e;
        flights += 1;
    }
    (since, flight, flights)
}

/// Where a point is that goes through `from` at the speed `velocity`, m.
pub fn straight(from: f64, velocity: f64, time: &Number) -> Number {
    &Number::from(from) + &(&Number::from(velocity) * time)
}

/// Where a point is that goes through `from` at `velocity` and at `turn` turns round, m.
pub fn turning(from: f64, velocity: f64, turn: f64, time: &Number) -> Number {
    let straight = straight(from, velocity, time);
    let beyond = if velocity > 0.0 { straight > Number::from(turn) } else { straight < Number::from(turn) };
    if beyond { &(&Number::from(turn) + &Number::from(turn)) - &straight } else { straight }
}

/// How many collisions Galperin's billiard has whose masses are as 1 to 100^digits: so many
/// digits of π after the first (G. Galperin, "Playing pool with π", 2003).
pub const fn galperin(digits: u32) -> u64 {
    314_159_265_358 / 10_u64.pow(11 - digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: f64) -> Number {
        Number::from(value)
    }

    #[test]
    fn an_elastic_bounce_comes_back_to_where_it_began() {
        // t₀ = 1 s: up again at 2, 4, 6, … s.
        let bounce = Bounce { height: 5.0, gravity: 10.0, restitution: 1.0 };
        assert_eq!(bounce.at(&number(0.5)), (number(1.25), Some(0)));
        assert_eq!(bounce.at(&number(1.0)), (number(5.0), Some(1)));
        assert_eq!(bounce.at(&number(2_000_000.0)), (number(0.0), Some(1_000_000)));
        assert_eq!(bounce.at(&number(1.5)), (number(1.25), Some(1)));
    }

    #[test]
    fn bounces_of_half_the_speed_end_after_three_falls() {
        // Flights of 1, 1/2, 1/4, … s after the fall of 1 s: 1.25 m high, a quarter of that, …
        let bounce = Bounce { height: 5.0, gravity: 10.0, restitution: 0.5 };
        assert_eq!(bounce.at(&number(1.5)), (number(3.75), Some(1)));
        assert_eq!(bounce.at(&number(2.25)), (number(5.0 - 0.3125), Some(2)));
        assert_eq!(bounce.at(&number(2.875)).1, Some(5));
        assert_eq!(bounce.at(&number(3.0)), (number(5.0), None));
    }

    #[test]
    fn what_turns_comes_back_as_fast() {
        assert_eq!(turning(1.0, 2.0, 4.0, &number(1.0)), number(3.0));
        assert_eq!(turning(1.0, 2.0, 4.0, &number(2.0)), number(3.0));
        assert_eq!(turning(1.0, -2.0, -4.0, &number(5.0)), number(1.0));
    }

    #[test]
    fn galperin_counts_the_digits_of_pi() {
        assert_eq!([0, 1, 4, 9].map(galperin), [3, 31, 31_415, 3_141_592_653]);
    }
}
