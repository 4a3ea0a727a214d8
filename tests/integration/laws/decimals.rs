//! Scenes whose numbers are decimals mean these decimals, not the doubles nearest to them: a box whose corner reaches that of
//! another at both gaps in the same instant collides along the axis of the gentler approach.

use super::random::Random;
use crate::world_builder::{BodySpec, Conditions, INFINITE, run, spec, world};
use rebond::internals::physics::Axis;

/// A number of units of 10⁻⁴ as a decimal.
fn decimal(units: i64) -> f64 {
    units as f64 / 1e4
}

/// A box whose lower right corner reaches the upper left one of a block. Integers are in units of 10⁻⁴ m, m/s, N, kg and m/s².
struct Approach {
    /// The gap that it crosses along each axis.
    gap: [i64; 2],
    /// The speed at which it arrives.
    arrival: [i64; 2],
    /// The time at which it arrives, s.
    time: f64,
    velocity: [i64; 2],
    /// Along y, like gravity.
    force: i64,
    mass: i64,
    gravity: i64,
    restitution: f64,
    /// The distance of a wall to its left.
    wall: Option<i64>,
}

impl Approach {
    fn random(random: &mut Random) -> Approach {
        let tenths = 2 * random.whole(1, 10);
        let [vx, vy] = [0, 1].map(|_| 1000 * random.whole(1, 60));
        let mut approach = Approach {
            gap: [vx * tenths / 10, vy * tenths / 10],
            arrival: [vx, vy],
            time: tenths as f64 / 10.0,
            velocity: [vx, vy],
            force: 0,
            mass: 10_000,
            gravity: 0,
            restitution: random.pick(&[0.9, 0.7, 0.3]),
            wall: None,
        };
        match random.below(4) {
            0 => {}
            1 => approach.accelerate(tenths, |approach| {
                approach.gravity = random.pick(&[98_000, 98_100, 16_200, 3000]);
                approach.gravity
            }),
            2 => approach.accelerate(tenths, |approach| {
                let [mass, acceleration] = [random.whole(1, 30), random.whole(1, 30)];
                (approach.mass, approach.force) = (mass * 1000, mass * acceleration * 100);
                acceleration * 1000
            }),
            // It first bounces from the wall, and returns at e times its speed.
            _ => {
                let (e, hundredths) = random.pick(&[(0.8, 125), (0.4, 250), (0.2, 500)]);
                let wall = 100 * random.whole(1, 30);
                approach.restitution = e;
                approach.velocity[0] = -10_000;
                approach.arrival[0] = 1_000_000 / hundredths;
                approach.wall = Some(wall);
                // In units of 10⁻⁴ s, because it moves at 1 m/s towards the wall.
                let time = wall + (wall + approach.gap[0]) * hundredths / 100;
                approach.time = decimal(time);
                let vy = 10_000 * random.whole(1, 3);
                (approach.velocity[1], approach.arrival[1], approach.gap[1]) = (vy, vy, vy / 10_000 * time);
            }
        }
        approach
    }

    /// Lets the box also accelerate along y.
    fn accelerate(&mut self, tenths: i64, acceleration: impl FnOnce(&mut Approach) -> i64) {
        let acceleration = acceleration(self);
        self.arrival[1] += acceleration * tenths / 10;
        self.gap[1] += acceleration * tenths / 10 * tenths / 20;
    }

    /// Asserts that the corner blocks along the axis of the gentler approach, in each quadrant.
    fn check(&self, signs: [f64; 2], is_block_first: bool, about: &str) {
        let vector = |x: f64, y: f64| [signs[0] * x, signs[1] * y];
        // The position of a box whose low corner and size are given, in this quadrant: a decimal itself.
        let position = |low: [i64; 2], size: i64| {
            [0, 1].map(|axis| decimal(if signs[axis] > 0.0 { low[axis] } else { -(low[axis] + size) }))
        };
        let (corner, size) = ([3000, 7000], 4000);
        let start = [0, 1].map(|axis| corner[axis] - self.gap[axis] - size);
        let moving = BodySpec {
            velocity: vector(decimal(self.velocity[0]), decimal(self.velocity[1])),
            force: vector(0.0, decimal(self.force)),
            ..spec(position(start, size), [decimal(size); 2], decimal(self.mass))
        };
        let block = spec(position(corner, 50_000), [5.0; 2], INFINITE);
        let mut bodies: Vec<BodySpec> = vec![moving, block];
        if let Some(wall) = self.wall {
            bodies.push(spec([position([start[0] - wall - 10_000, 0], 10_000)[0], -1000.0], [1.0, 2000.0], INFINITE));
        }
        if is_block_first {
            bodies.swap(0, 1);
        }
        let [x, y] = vector(0.0, decimal(self.gravity));
        let gravity = (self.gravity != 0).then_some([x, y]);
        let conditions = Conditions { restitution: self.restitution, gravity, rate: 64.0, ..Conditions::default() };
        let mut engine = world(conditions, &bodies);
        let collisions = run(&mut engine, (self.time * 64.0) as u64 + 2);
        let hits: Vec<_> = collisions.iter().filter(|collision| collision.bodies == [0, 1]).collect();
        let blocked: Vec<Axis> =
            hits.iter().filter(|hit| (hit.instant - self.time).abs() < 1e-9).map(|hit| hit.axis).collect();
        let expected: &[Axis] = match self.arrival[0].cmp(&self.arrival[1]) {
            std::cmp::Ordering::Less => &[Axis::X],
            std::cmp::Ordering::Equal => &[Axis::X, Axis::Y],
            std::cmp::Ordering::Greater => &[Axis::Y],
        };
        assert_eq!(blocked, expected, "{about}: {bodies:?}, gravity {gravity:?}, at {} s: {hits:?}", self.time);
    }
}

#[test]
fn corners_that_meet_in_decimals_block_the_gentler_approach() {
    for seed in 0..300 {
        let mut random = Random::new(seed);
        let approach = Approach::random(&mut random);
        for signs in [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]] {
            approach.check(signs, random.chance(50), &format!("seed {seed}, signs {signs:?}"));
        }
    }
}
