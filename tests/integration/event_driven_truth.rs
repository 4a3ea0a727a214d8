//! The exact solver beside a slow one of 32 digits that shares nothing with it: all pairs,
//! one collision after the other, every position carried along.

use crate::{double_double::DoubleDouble as Number, laboratory::*};

struct Point {
    at: [Number; 2],
    velocity: [Number; 2],
    size: [f64; 2],
    mass: f64,
}

/// Seconds until two meet along an axis, if they do before `limit`.
fn meets(a: &Point, b: &Point, axis: usize, limit: Number) -> Option<Number> {
    let zero = Number::from(0.0);
    let other = 1 - axis;
    let velocity = b.velocity[axis] - a.velocity[axis];
    let gap = if velocity < zero {
        b.at[axis] - a.at[axis] - a.size[axis].into()
    } else {
        a.at[axis] - b.at[axis] - b.size[axis].into()
    };
    if velocity == zero || gap < zero {
        return None;
    }
    let t = if velocity < zero { gap / -velocity } else { gap / velocity };
    let [there, here] = [b, a].map(|point| point.at[other] + point.velocity[other] * t);
    let beside = here < there + b.size[other].into() && there < here + a.size[other].into();
    (t < limit && beside).then_some(t)
}

fn bounce(points: &mut [Point], [i, j]: [usize; 2], axis: usize, e: f64) {
    let one = Number::from(1.0);
    let inverse = |mass: f64| if mass == INFINITE { Number::from(0.0) } else { one / mass.into() };
    let [first, second] = [inverse(points[i].mass), inverse(points[j].mass)];
    let approach = points[i].velocity[axis] - points[j].velocity[axis];
    let impulse = (one + e.into()) * approach / (first + second);
    points[i].velocity[axis] = points[i].velocity[axis] - impulse * first;
    points[j].velocity[axis] = points[j].velocity[axis] + impulse * second;
}

/// The number of collisions in so many seconds, and where everything is then.
fn simulate(sketches: &[Sketch], e: f64, seconds: Number) -> (u64, Vec<[f64; 2]>) {
    let point = |sketch: &Sketch| Point {
        at: sketch.at.map(Number::from),
        velocity: sketch.velocity.map(Number::from),
        size: sketch.size,
        mass: sketch.mass,
    };
    let mut points: Vec<Point> = sketches.iter().map(point).collect();
    let (mut left, mut collisions) = (seconds, 0);
    let mut last = None;
    loop {
        let mut first = left;
        let mut who = None;
        for j in 0..points.len() {
            for i in 0..j {
                for axis in 0..2 {
                    let walls = points[i].mass == INFINITE && points[j].mass == INFINITE;
                    if walls || last == Some(([i, j], axis)) {
                        continue;
                    }
                    if let Some(t) = meets(&points[i], &points[j], axis, first) {
                        (first, who) = (t, Some(([i, j], axis)));
                    }
                }
            }
        }
        for point in &mut points {
            point.at = [0, 1].map(|axis| point.at[axis] + point.velocity[axis] * first);
        }
        let Some((pair, axis)) = who else { break };
        bounce(&mut points, pair, axis, e);
        last = who;
        collisions += 1;
        left = left - first;
    }
    (collisions, points.iter().map(|point| point.at.map(Number::to_f64)).collect())
}

/// A gas of boxes of all sizes and masses, from a linear congruence.
fn gas(seed: u64) -> Vec<Sketch> {
    let mut state = seed;
    let mut random = move |from: f64, to: f64| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        from + (to - from) * ((state >> 11) as f64 / (1u64 << 53) as f64)
    };
    let mut bodies = walls(8.0, 6.0);
    for place in 0..12 {
        let corner = [f64::from(place % 4) * 2.0, f64::from(place / 4) * 2.0];
        let size = [random(0.2, 1.5), random(0.2, 1.5)];
        let at = [corner[0] + random(0.0, 0.4), corner[1] + random(0.0, 0.4)];
        let mass = random(0.1, 4.0) * random(0.1, 10.0);
        bodies.push(sketch(at, size, mass).moving(random(-4.0, 4.0), random(-4.0, 4.0)));
    }
    bodies
}

#[test]
fn random_gases_are_where_thirty_two_digits_put_them() {
    for seed in 1..=6 {
        check(seed, 1.0, 1200);
        check(seed, 0.97, 600);
    }
}

/// Thousands of collisions; `cargo test --release -- --ignored`
#[test]
#[ignore = "ten thousand collisions among all pairs"]
fn random_gases_stay_where_thirty_two_digits_put_them() {
    (100..110).for_each(|seed| check(seed, 1.0, 12_000));
}

fn check(seed: u64, restitution: f64, steps: u64) {
    let bodies = gas(seed);
    let seconds = Number::from(steps as f64) / 60.0.into();
    let (collisions, places) = simulate(&bodies, restitution, seconds);
    let mut engine = world(Conditions { restitution, ..Conditions::default() }, &bodies);
    assert_eq!(count(&mut engine, steps), collisions, "seed {seed}, e = {restitution}");
    for (found, expected) in engine.world().bodies.iter().zip(places) {
        assert_close(found.rect.origin.x, expected[0], 1e-10);
        assert_close(found.rect.origin.y, expected[1], 1e-10);
    }
}
