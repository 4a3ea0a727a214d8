//! Bursts: touching rows and columns hit a wall. The impacts of the one instant are compared with integer arithmetic of
//! a thousand bits.

use super::random::Random;
use crate::world_builder::{BodySpec, Conditions, INFINITE, spec, world};
use num_bigint::{BigInt, Sign};
use rebond::internals::physics::{BodyId, Collision, CollisionCount, StepError};
use std::{collections::BTreeSet, ops::Range};

/// The bits after the binary point.
const BITS: u64 = 1000;

/// An infinite burst is carried out until its approach speeds are 2^−100 of the greatest. Where infinite bursts contain
/// others, the velocities can depend on this number; they are compared only if those for 2^−200 are the same.
const DECAYS: [usize; 2] = [100, 200];

/// The most impacts that are carried out in this arithmetic.
const MOST_IMPACTS: usize = 400_000;

/// Boxes in a line, from the wall outwards, which all approach it at 1 m/s.
struct Line {
    /// kg; all boxes touch, the first one touches the wall.
    masses: Vec<u32>,
    restitution: f64,
    /// The position in the order of creation, of the wall and then of each box.
    order: Vec<BodyId>,
}

/// The impacts of a burst.
struct Burst {
    /// The places in the line of the inner one of each pair: 0 is the wall.
    impacts: Vec<usize>,
    /// After the burst, of the wall and each box, m/s.
    velocities: Vec<f64>,
    /// True if the burst was infinite and was ended by its limit.
    is_infinite: bool,
}

/// A number as an integer times 2^−1000, rounded down. Orders are decided by signs: a number below the sum of all
/// rounding errors counts as 0.
fn fixed(number: f64) -> BigInt {
    let (bits, exponent) = (number.abs().to_bits(), (number.abs().to_bits() >> 52) as i64);
    if number == 0.0 {
        return BigInt::from(0);
    }
    let magnitude = BigInt::from((bits & ((1 << 52) - 1)) | (1 << 52)) << (BITS as i64 + exponent - 1075) as usize;
    if number < 0.0 { -magnitude } else { magnitude }
}

fn to_f64(number: &BigInt) -> f64 {
    let shortened = number >> (BITS as usize - 62);
    let (sign, digits) = shortened.to_u64_digits();
    let magnitude = digits.first().copied().unwrap_or(0) as f64 / (1_u64 << 62) as f64;
    if sign == Sign::Minus { -magnitude } else { magnitude }
}

impl Line {
    /// The impacts in the documented order: of all approaching pairs the lowest in creation order, again and again.
    /// `None` if there are too many.
    fn burst(&self, decay: usize) -> Option<Burst> {
        let count = self.masses.len() + 1;
        let mut v: Vec<BigInt> = (0..count).map(|place| fixed(if place == 0 { 0.0 } else { -1.0 })).collect();
        let mut joined = vec![false; count - 1];
        let mut burst = Burst { impacts: Vec::new(), velocities: Vec::new(), is_infinite: false };
        let (mut top, mut error) = (BigInt::from(0), BigInt::from(0));
        let bounce = fixed(1.0) + fixed(self.restitution);
        let mut approaching = BTreeSet::new();
        let look = |v: &[BigInt], error: &BigInt, approaching: &mut BTreeSet<_>, places: Range<usize>| {
            for place in places.start.saturating_sub(1)..if places.end < count { places.end } else { count - 1 } {
                let entry = (self.pair(place), place);
                if &v[place] - &v[place + 1] > *error {
                    approaching.insert(entry)
                } else {
                    approaching.remove(&entry)
                };
            }
        };
        look(&v, &error, &mut approaching, 0..count);
        while let Some(&(_, place)) = approaching.first() {
            let c = &v[place] - &v[place + 1];
            top = if c > top { c.clone() } else { top };
            if self.restitution < 1.0 && c <= &top >> decay {
                burst.is_infinite = true;
                let cluster = self.take_limit(&mut v, &mut joined, place, &(&top >> decay));
                look(&v, &error, &mut approaching, cluster);
                continue;
            }
            let (inner, outer) = (pushed(&joined, place, -1), pushed(&joined, place + 1, 1));
            let [inner_mass, outer_mass] = [&inner, &outer].map(|places| self.mass(places));
            // ΔV of the inner side is −(1 + e)·c·M/(m + M); that of a side with the wall is 0.
            let change = (&bounce * &c) >> BITS as usize;
            let (inner_change, outer_change) = match (inner_mass, outer_mass) {
                (Some(inner), Some(outer)) => (&change * outer / (inner + outer), &change * inner / (inner + outer)),
                (None, _) => (BigInt::from(0), change),
                (_, None) => unreachable!("there is one wall"),
            };
            inner.iter().for_each(|&place| v[place] -= &inner_change);
            outer.iter().for_each(|&place| v[place] += &outer_change);
            error += 4;
            burst.impacts.push(place);
            if burst.impacts.len() > MOST_IMPACTS {
                return None;
            }
            let changed = inner[inner.len() - 1]..outer[outer.len() - 1] + 1;
            for place in changed.start.saturating_sub(1)..if changed.end < count { changed.end } else { count - 1 } {
                joined[place] &= v[place] == v[place + 1];
            }
            look(&v, &error, &mut approaching, changed);
        }
        burst.velocities = v.iter().map(to_f64).collect();
        Some(burst)
    }

    /// The pair of a box and the next one outwards, in the order of creation.
    fn pair(&self, place: usize) -> [BodyId; 2] {
        let mut pair = [self.order[place], self.order[place + 1]];
        pair.sort_unstable();
        pair
    }

    /// The mass of boxes in the line; `None` if the wall is among them.
    fn mass(&self, places: &[usize]) -> Option<u32> {
        (!places.contains(&0)).then(|| places.iter().map(|place| self.masses[place - 1]).sum())
    }

    /// Gives the boxes joined by approaches of at most `slow` their common velocity, and returns their places.
    fn take_limit(&self, v: &mut [BigInt], joined: &mut [bool], place: usize, slow: &BigInt) -> Range<usize> {
        let is_slow = |v: &[BigInt], place: usize| {
            let c = &v[place] - &v[place + 1];
            &c <= slow && &-c <= slow
        };
        let (mut first, mut last) = (place, place + 1);
        while first > 0 && is_slow(v, first - 1) {
            first -= 1;
        }
        while last + 1 < v.len() && is_slow(v, last) {
            last += 1;
        }
        let places: Vec<usize> = (first..=last).collect();
        let common = self.mass(&places).map_or(BigInt::from(0), |mass| {
            places.iter().map(|&place| &v[place] * self.masses[place - 1]).sum::<BigInt>() / mass
        });
        places.iter().for_each(|&place| v[place] = common.clone());
        (first..last).for_each(|place| joined[place] = true);
        first..last + 1
    }

    /// The bodies in the order of creation, along x or y.
    fn bodies(&self, axis: usize) -> Vec<BodySpec> {
        let mut bodies = vec![spec([-1.0; 2], [1.0; 2], INFINITE); self.order.len()];
        for (place, &id) in self.order.iter().enumerate() {
            let mass = if place == 0 { INFINITE } else { f64::from(self.masses[place - 1]) };
            let mut body = spec([0.0; 2], [1.0; 2], mass);
            body.at[axis] = place as f64;
            body.velocity[axis] = if place == 0 { 0.0 } else { -1.0 };
            bodies[id as usize] = body;
        }
        bodies
    }

    /// Compares a row and a column with the arithmetic. Returns false if its limit is not defined, or if there
    /// are too many impacts.
    fn check(&self) -> bool {
        let Some(expected) = self.burst(DECAYS[0]) else { return false };
        if expected.is_infinite {
            let Some(deeper) = self.burst(DECAYS[1]) else { return false };
            let pairs = expected.velocities.iter().zip(&deeper.velocities);
            if pairs.into_iter().any(|(a, b)| (a - b).abs() > 1e-12) {
                return false;
            }
        }
        (0..2).for_each(|axis| self.compare(&expected, axis));
        true
    }

    fn compare(&self, expected: &Burst, axis: usize) {
        let about = format!("masses {:?}, e = {}, axis {axis}, order {:?}", self.masses, self.restitution, self.order);
        let conditions = Conditions { restitution: self.restitution, rate: 4.0, ..Conditions::default() };
        let mut engine = world(conditions, &self.bodies(axis));
        let mut collisions: Vec<Collision> = Vec::new();
        engine.step(&mut collisions).unwrap_or_else(|error| panic!("{about}: {error}"));
        let found: Vec<usize> = collisions.iter().map(|collision| self.place_of(collision.bodies)).collect();
        let common = found.iter().zip(&expected.impacts).take_while(|(a, b)| a == b).count();
        // An infinite burst may be ended earlier or later, so that only its first impacts are compared.
        if !expected.is_infinite {
            assert_eq!((common, found.len()), (expected.impacts.len(), expected.impacts.len()), "impacts of {about}");
        }
        for (place, &id) in self.order.iter().enumerate() {
            let velocity = engine.world().bodies[id as usize].velocity;
            let (found, expected) = ([velocity.x, velocity.y][axis], expected.velocities[place]);
            assert!(
                (found - expected).abs() <= 1e-9,
                "{about}: box {place} leaves at {found} m/s, expected {expected}"
            );
        }
    }

    fn place_of(&self, pair: [BodyId; 2]) -> usize {
        (0..self.masses.len()).find(|&place| self.pair(place) == pair).expect("a pair of neighbours")
    }
}

/// The places of the boxes that a push on one reaches through contacts in a direction, itself included.
fn pushed(joined: &[bool], place: usize, direction: isize) -> Vec<usize> {
    let mut places = vec![place];
    let mut next = place as isize;
    loop {
        let contact = if direction < 0 { next - 1 } else { next };
        if contact < 0 || contact as usize >= joined.len() || !joined[contact as usize] {
            return places;
        }
        next += direction;
        places.push(next as usize);
    }
}

const COEFFICIENTS: [f64; 6] = [0.5, 0.9, 0.95, 0.99, 0.999, 1.0];

/// Checks equal boxes, and equal boxes behind which a heavy one follows, created from the wall outwards or inwards.
/// Returns the number of those whose limit is defined.
fn check(count: usize, restitution: f64) -> usize {
    let mut compared = 0;
    for heavy in [1, 100] {
        for is_reversed in [false, true] {
            let mut masses = vec![1; count];
            masses[count - 1] = heavy;
            let mut order: Vec<BodyId> = (0..=count as BodyId).collect();
            if is_reversed {
                order.reverse();
            }
            let line = Line { masses, restitution, order };
            compared += usize::from(line.check());
        }
    }
    compared
}

#[test]
fn rows_and_columns_that_hit_a_wall_leave_as_in_rational_arithmetic() {
    let longest = if cfg!(debug_assertions) { 6 } else { 8 };
    let counts = |e: f64| 1..=if e == 0.5 { 5 } else { longest };
    let compared: usize = COEFFICIENTS.iter().map(|&e| counts(e).map(|count| check(count, e)).sum::<usize>()).sum();
    println!("bursts: {compared} rows, as many columns");
}

#[test]
#[ignore = "rows of up to 110 boxes"]
fn long_rows_and_columns_that_hit_a_wall_leave_as_in_rational_arithmetic() {
    for e in COEFFICIENTS {
        let counts: Vec<usize> = if e == 0.5 { vec![6, 7, 8] } else { (9..=16).chain([30, 110]).collect() };
        let compared: usize = counts.iter().map(|&count| check(count, e)).sum();
        println!("bursts at e = {e}: {compared} of {} rows, as many columns", counts.len() * 4);
    }
}

impl Line {
    /// The velocities (m/s) after the burst of equal boxes, of the wall and each box, in doubles: of relative velocities, each
    /// impact changes that of its pair and those of the two adjacent pairs, so that rounding stays relative to each.
    fn velocities_of_equal_boxes(&self) -> Vec<f64> {
        let boxes = self.masses.len();
        let e = self.restitution;
        let mut pairs: Vec<usize> = (0..boxes).collect();
        pairs.sort_unstable_by_key(|place| self.pair(*place));
        // The speed at which the bodies at a place and the next one outwards part.
        let mut parting: Vec<f64> = (0..boxes).map(|place| if place == 0 { -1.0 } else { 0.0 }).collect();
        while let Some(&place) = pairs.iter().find(|place| parting[**place] < 0.0) {
            let approach = -parting[place];
            if approach < 1e-40 {
                break;
            }
            parting[place] = e * approach;
            if place > 0 {
                parting[place - 1] -= 0.5 * (1.0 + e) * approach;
            }
            if place + 1 < boxes {
                parting[place + 1] -= if place == 0 { 1.0 + e } else { 0.5 * (1.0 + e) } * approach;
            }
        }
        let mut velocity = 0.0;
        let outwards = parting.iter().map(|speed| {
            velocity += speed;
            velocity
        });
        [0.0].into_iter().chain(outwards).collect()
    }
}

/// Bursts of rows created towards the wall, whose cycles have a thousand impacts and more: carried out one by one, they would
/// take millions.
#[test]
fn rows_with_long_cycles_end_in_their_limits() {
    let rows = [(16, 0.7), (20, 0.75), (40, 0.9)];
    for (count, restitution) in rows.into_iter().take(if cfg!(debug_assertions) { 2 } else { 3 }) {
        let order: Vec<BodyId> = (0..=count as BodyId).rev().collect();
        let line = Line { masses: vec![1; count], restitution, order };
        let velocities = line.velocities_of_equal_boxes();
        line.compare(&Burst { impacts: Vec::new(), velocities, is_infinite: true }, 0);
    }
}

/// A sequence of impacts that lose energy ends in any case, so that it may be longer than the limit of events.
#[test]
fn the_limit_of_events_does_not_end_a_burst_that_loses_energy() {
    let (count, restitution, limit) = if cfg!(debug_assertions) { (16, 0.7, 30) } else { (35, 0.9, 1_000_000) };
    let wall = spec([-1.0, 0.0], [1.0; 2], INFINITE);
    let boxes = (0..count).map(|place| spec([f64::from(place), 0.0], [1.0; 2], 1.0).with_velocity(-1.0, 0.0));
    let bodies: Vec<BodySpec> = [wall].into_iter().chain(boxes).collect();
    let conditions = Conditions { restitution, rate: 4.0, events_per_step: limit, ..Conditions::default() };
    let mut collisions = CollisionCount(0);
    assert_eq!(world(conditions, &bodies).step(&mut collisions), Ok(()));
    assert!(collisions.0 > limit, "{} impacts do not exceed the limit", collisions.0);

    let conditions = Conditions { restitution: 1.0, events_per_step: 30, ..conditions };
    let error = world(conditions, &bodies).step(&mut collisions).expect_err("without loss each impact counts");
    assert!(matches!(error, StepError::TooManyEvents { limit: 30, .. }), "{error}");
}

/// Touching rows in which light boxes bounce between heavy ones: carried out one by one, it would take up to 10¹⁰ impacts
/// until their speeds have decayed. They have more impacts than events are allowed.
#[test]
fn rows_of_any_masses_end_in_any_order_of_creation() {
    let rows = if cfg!(debug_assertions) { 300 } else { 3000 };
    for seed in 0..rows {
        let mut random = Random::new(seed);
        let count = 3 + random.below(2) as usize;
        let masses: Vec<f64> = (0..count).map(|_| random.pick(&[1.0, 1.0, 1e3, 1e5, 1e7, 1e8])).collect();
        let speeds: Vec<f64> = (0..count).map(|_| random.pick(&[0.0, 0.0, 1.0, -1.0])).collect();
        let restitution = random.pick(&[0.1, 0.3, 0.5, 0.9]);
        let mut order: Vec<usize> = (0..count).collect();
        random.shuffle(&mut order);
        let body =
            |place: &usize| spec([*place as f64, 0.0], [1.0; 2], masses[*place]).with_velocity(speeds[*place], 0.0);
        let bodies: Vec<BodySpec> = order.iter().map(body).collect();
        let about = format!("seed {seed}: masses {masses:?}, speeds {speeds:?}, e = {restitution}, order {order:?}");
        let mut engine =
            world(Conditions { restitution, rate: 4.0, events_per_step: 200, ..Conditions::default() }, &bodies);
        engine.step(&mut CollisionCount(0)).unwrap_or_else(|error| panic!("{about}: {error}"));
        let mut after = vec![0.0; count];
        for (place, body) in order.iter().zip(&engine.world().bodies) {
            after[*place] = body.velocity.x;
        }
        let sum = |term: &dyn Fn(usize) -> f64| (0..count).map(term).sum::<f64>();
        let change = sum(&|place| masses[place] * (after[place] - speeds[place]));
        assert!(change.abs() <= 1e-12 * sum(&|place| masses[place]), "{about}: the momentum changes by {change}");
        let energy = |speeds: &[f64]| sum(&|place| 0.5 * masses[place] * speeds[place] * speeds[place]);
        assert!(energy(&after) <= energy(&speeds) * (1.0 + 1e-12), "{about}: the energy rises");
        for place in 1..count {
            assert!(after[place - 1] <= after[place] + 1e-12, "{about}: the boxes at {place} approach: {after:?}");
        }
    }
}
