//! Compares the event-driven solver with an independent, slow simulation of 32 digits, which tests all pairs for
//! each collision and advances every position.

use crate::{double_double::DoubleDouble as Number, world_builder::*};

/// A body of the slow simulation.
struct Particle {
    at: [Number; 2],
    velocity: [Number; 2],
    size: [f64; 2],
    mass: f64,
}

/// The seconds until two bodies collide along an axis, if that is before `limit`.
fn time_of_impact(a: &Particle, b: &Particle, axis: usize, limit: Number) -> Option<Number> {
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
    let [position_b, position_a] = [b, a].map(|particle| particle.at[other] + particle.velocity[other] * t);
    let overlaps = position_a < position_b + b.size[other].into() && position_b < position_a + a.size[other].into();
    (t < limit && overlaps).then_some(t)
}

fn bounce(particles: &mut [Particle], [i, j]: [usize; 2], axis: usize, e: f64) {
    let one = Number::from(1.0);
    let inverse = |mass: f64| if mass == INFINITE { Number::from(0.0) } else { one / mass.into() };
    let [first, second] = [inverse(particles[i].mass), inverse(particles[j].mass)];
    let approach = particles[i].velocity[axis] - particles[j].velocity[axis];
    let impulse = (one + e.into()) * approach / (first + second);
    particles[i].velocity[axis] = particles[i].velocity[axis] - impulse * first;
    particles[j].velocity[axis] = particles[j].velocity[axis] + impulse * second;
}

/// The number of collisions in a time, and the positions of all bodies at its end.
fn simulate(specs: &[BodySpec], e: f64, seconds: Number) -> (u64, Vec<[f64; 2]>) {
    let particle = |spec: &BodySpec| Particle {
        at: spec.at.map(Number::from),
        velocity: spec.velocity.map(Number::from),
        size: spec.size,
        mass: spec.mass,
    };
    let mut particles: Vec<Particle> = specs.iter().map(particle).collect();
    let (mut remaining, mut collisions) = (seconds, 0);
    let mut last = None;
    loop {
        let mut first = remaining;
        let mut next = None;
        for j in 0..particles.len() {
            for i in 0..j {
                for axis in 0..2 {
                    let walls = particles[i].mass == INFINITE && particles[j].mass == INFINITE;
                    if walls || last == Some(([i, j], axis)) {
                        continue;
                    }
                    if let Some(t) = time_of_impact(&particles[i], &particles[j], axis, first) {
                        (first, next) = (t, Some(([i, j], axis)));
                    }
                }
            }
        }
        for particle in &mut particles {
            particle.at = [0, 1].map(|axis| particle.at[axis] + particle.velocity[axis] * first);
        }
        let Some((pair, axis)) = next else { break };
        bounce(&mut particles, pair, axis, e);
        last = next;
        collisions += 1;
        remaining = remaining - first;
    }
    (collisions, particles.iter().map(|particle| particle.at.map(Number::to_f64)).collect())
}

/// A gas of boxes of various sizes and masses, from a linear congruential generator.
fn gas(seed: u64) -> Vec<BodySpec> {
    let mut state = seed;
    let mut random = move |from: f64, to: f64| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        from + (to - from) * ((state >> 11) as f64 / (1u64 << 53) as f64)
    };
    let mut bodies = walls(8.0, 6.0);
    for number in 0..12 {
        let corner = [f64::from(number % 4) * 2.0, f64::from(number / 4) * 2.0];
        let size = [random(0.2, 1.5), random(0.2, 1.5)];
        let at = [corner[0] + random(0.0, 0.4), corner[1] + random(0.0, 0.4)];
        let mass = random(0.1, 4.0) * random(0.1, 10.0);
        bodies.push(spec(at, size, mass).with_velocity(random(-4.0, 4.0), random(-4.0, 4.0)));
    }
    bodies
}

#[test]
fn random_gases_agree_with_a_simulation_of_32_digits() {
    for seed in 1..=6 {
        check(seed, 1.0, 1200);
        check(seed, 0.97, 600);
    }
}

/// `cargo test --release -- --ignored`
#[test]
#[ignore = "ten thousand collisions among all pairs"]
fn random_gases_agree_with_a_simulation_of_32_digits_for_long() {
    (100..110).for_each(|seed| check(seed, 1.0, 12_000));
}

fn check(seed: u64, restitution: f64, steps: u64) {
    let bodies = gas(seed);
    let seconds = Number::from(steps as f64) / 60.0.into();
    let (collisions, positions) = simulate(&bodies, restitution, seconds);
    let mut engine = world(Conditions { restitution, ..Conditions::default() }, &bodies);
    assert_eq!(count(&mut engine, steps), collisions, "seed {seed}, e = {restitution}");
    for (found, expected) in engine.world().bodies.iter().zip(positions) {
        assert_close(found.rect.origin.x, expected[0], 1e-10);
        assert_close(found.rect.origin.y, expected[1], 1e-10);
    }
}
