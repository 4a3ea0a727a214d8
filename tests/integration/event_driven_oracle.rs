//! Compares the event-driven solver with the simulator of 77 decimals of the report, which shares no arithmetic with it.

use crate::world_builder::*;
use rebond::internals::report::oracle::{Fixed256, PreciseSimulator};

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
fn random_gases_agree_with_a_simulation_of_77_decimals() {
    for seed in 1..=6 {
        check(seed, 1.0, 1200);
        check(seed, 0.97, 600);
    }
}

/// `cargo test --release -- --ignored`
#[test]
#[ignore = "ten thousand collisions among all pairs"]
fn random_gases_agree_with_a_simulation_of_77_decimals_for_long() {
    (100..110).for_each(|seed| check(seed, 1.0, 12_000));
}

fn check(seed: u64, restitution: f64, steps: u64) {
    let mut engine = world(Conditions { restitution, ..Conditions::default() }, &gas(seed));
    let end = &Fixed256::from(steps as f64) / &Fixed256::from(60.0);
    let mut simulator = PreciseSimulator::new(engine.world(), end.to_f64()).unwrap();
    simulator.advance(&end).unwrap();
    assert_eq!(count(&mut engine, steps), simulator.collisions, "seed {seed}, e = {restitution}");
    let finite = engine.world().bodies.iter().filter(|body| !body.is_infinite());
    for (found, expected) in finite.zip(simulator.positions(&end)) {
        assert_close(found.rect.origin.x, expected[0].to_f64(), 1e-13);
        assert_close(found.rect.origin.y, expected[1].to_f64(), 1e-13);
    }
}
