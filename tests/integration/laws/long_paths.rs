//! Bodies that come from afar: the rounding errors of a position grow with the path since the last impact, also where the
//! position itself is small.

use super::random::Random;
use crate::world_builder::{Conditions, INFINITE, spec, world};
use rebond::internals::physics::{
    Collision, CollisionCount, Engine, EngineConfig, Event, Rect, Restitution, RestitutionPair, SolverKind, Spawn,
    Vector,
};

const SCENES: u64 = if cfg!(debug_assertions) { 150 } else { 1500 };

#[test]
fn a_plastic_fall_from_any_height_is_one_collision() {
    for seed in 0..SCENES {
        let mut random = Random::new(seed);
        let size = random.pick(&[0.01, 0.1, 1.0]);
        let height = size * random.magnitude(100.0, 12);
        let conditions = Conditions { gravity: Some([0.0, 9.81]), restitution: 0.0, ..Conditions::default() };
        let floor = spec([-size, 0.0], [3.0 * size, size], INFINITE);
        let falling = spec([0.0, -height - size], [size; 2], 1.0);
        let about = format!("seed {seed}: a box of {size} m falls {height} m");
        let mut engine = world(Conditions { rate: 1.0, events_per_step: 1000, ..conditions }, &[floor, falling]);
        let mut collisions = CollisionCount(0);
        let seconds = (2.0 * height / 9.81).sqrt() as u64 + 2;
        for _ in 0..seconds {
            engine.step(&mut collisions).unwrap_or_else(|error| panic!("{about}: {error}"));
        }
        assert_eq!(collisions.0, 1, "{about}");
        assert_eq!(engine.world().bodies[1].rect.origin, Vector::new(0.0, -size), "{about}");
    }
}

/// A body bounces between two plates on its way along x, so that its trajectory along y is much younger.
#[test]
fn a_plastic_impact_after_a_long_flight_between_plates_is_one_collision() {
    for seed in 0..SCENES {
        let mut random = Random::new(seed);
        let distance = random.between(3000.0, 10_000.0);
        let velocity = [random.between(90.0, 110.0), random.between(3.0, 7.0)];
        let restitution = Restitution::new(
            1.0,
            &[RestitutionPair { materials: ["soft".to_owned(), "soft".to_owned()], restitution: 0.0 }],
        );
        let config =
            EngineConfig::new(SolverKind::EventDriven, 1.0).with_restitution(restitution).with_events_per_step(2000);
        let mut engine = Engine::new(config);
        let mut spawn = |at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2], material: &str| {
            let rect = Rect::new(Vector::new(at[0], at[1]), size[0], size[1]);
            let spawn = Spawn::new(String::new(), rect, mass).with_velocity(Vector::new(velocity[0], velocity[1]));
            engine.apply(&Event::Spawn(spawn.with_material(material)));
        };
        spawn([-20_000.0, -1.5], [40_000.0, 1.0], INFINITE, [0.0; 2], "");
        spawn([-20_000.0, 0.5], [40_000.0, 1.0], INFINITE, [0.0; 2], "");
        spawn([0.0, -0.49], [0.1, 0.98], 5.0, [0.0, 0.5], "soft");
        spawn([-distance, -0.05], [0.1; 2], 1.0, velocity, "soft");
        let mut collisions: Vec<Collision> = Vec::new();
        for _ in 0..(distance / velocity[0]) as u64 + 1 {
            engine.step(&mut collisions).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        }
        let hits = collisions.iter().filter(|collision| collision.bodies == [2, 3]).count();
        assert_eq!(hits, 1, "seed {seed}");
    }
}

/// Two bodies come from afar to one at rest, at times that differ by rounding: the first passes its velocity on and stops,
/// and the second one does the same or hits at the same instant.
#[test]
fn bodies_that_come_from_afar_do_not_pass_each_other() {
    for seed in 0..2 * SCENES {
        let mut random = Random::new(seed);
        let size = random.pick(&[0.01, 0.1]);
        let (distance, speed) = (size * random.between(500.0, 3000.0), random.between(0.7, 1.3));
        let mut right = size + distance;
        (0..random.below(4)).for_each(|_| right = right.next_up());
        let bodies = [
            spec([-distance - size, 0.0], [size; 2], 1.0).with_velocity(speed, 0.0),
            spec([0.0; 2], [size; 2], 1.0),
            spec([right, 0.0], [size; 2], 1.0).with_velocity(-speed, 0.0),
        ];
        let mut engine = world(Conditions { rate: 0.5, ..Conditions::default() }, &bodies);
        let mut collisions = CollisionCount(0);
        for _ in 0..(distance / speed) as u64 + 2 {
            engine.step(&mut collisions).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
            let x: Vec<f64> = engine.world().bodies.iter().map(|body| body.rect.origin.x).collect();
            let rounding = 1e-13 * distance;
            assert!(x[0] + size <= x[1] + rounding && x[1] + size <= x[2] + rounding, "seed {seed}: {x:?}");
        }
        let velocities: Vec<f64> = engine.world().bodies.iter().map(|body| body.velocity.x).collect();
        assert_eq!(velocities, [-speed, 0.0, speed], "seed {seed}");
        assert!(collisions.0 == 2 || collisions.0 == 3, "seed {seed}: {} collisions", collisions.0);
    }
}
