//! Builds worlds for tests of the event-driven solver, and measures them.

use rebond::internals::physics::{
    Body, BodyId, Collision, CollisionCount, Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, Vector,
};

pub const INFINITE: f64 = f64::INFINITY;

/// The conditions of a world. Default: 60 Hz, e = 1, no gravity.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    pub rate: f64,
    pub restitution: f64,
    pub gravity: Option<[f64; 2]>,
    pub events_per_step: u64,
}

impl Default for Conditions {
    fn default() -> Conditions {
        Conditions { rate: 60.0, restitution: 1.0, gravity: None, events_per_step: 1_000_000 }
    }
}

/// The initial state of a body: position and size, m, mass, kg, velocity, m/s, force, N.
#[derive(Clone, Debug)]
pub struct BodySpec {
    pub at: [f64; 2],
    pub size: [f64; 2],
    pub mass: f64,
    pub velocity: [f64; 2],
    pub force: [f64; 2],
}

/// A body at rest without a force.
pub fn spec(at: [f64; 2], size: [f64; 2], mass: f64) -> BodySpec {
    BodySpec { at, size, mass, velocity: [0.0; 2], force: [0.0; 2] }
}

impl BodySpec {
    pub fn with_velocity(self, x: f64, y: f64) -> BodySpec {
        BodySpec { velocity: [x, y], ..self }
    }

    pub fn with_force(self, x: f64, y: f64) -> BodySpec {
        BodySpec { force: [x, y], ..self }
    }
}

/// The four walls of the handout around a room.
pub fn walls(width: f64, height: f64) -> Vec<BodySpec> {
    vec![
        spec([-1.0, -1.0], [width + 2.0, 1.0], INFINITE),
        spec([-1.0, height], [width + 2.0, 1.0], INFINITE),
        spec([-1.0, 0.0], [1.0, height], INFINITE),
        spec([width, 0.0], [1.0, height], INFINITE),
    ]
}

pub fn config(conditions: Conditions) -> EngineConfig {
    EngineConfig::new(SolverKind::EventDriven, conditions.rate)
        .with_gravity(conditions.gravity.map(|[x, y]| Vector::new(x, y)))
        .with_restitution(Restitution::new(conditions.restitution, &[]))
        .with_events_per_step(conditions.events_per_step)
}

/// Creates a world with these bodies.
pub fn world(conditions: Conditions, bodies: &[BodySpec]) -> Engine {
    let mut engine = Engine::new(config(conditions));
    bodies.iter().for_each(|body| spawn(&mut engine, body));
    engine
}

pub fn spawn(engine: &mut Engine, body: &BodySpec) {
    let vector = |[x, y]: [f64; 2]| Vector::new(x, y);
    let rect = Rect::new(vector(body.at), body.size[0], body.size[1]);
    let spawn = Spawn::new(format!("{}", engine.next_id()), rect, body.mass);
    engine.apply(&Event::Spawn(spawn.with_velocity(vector(body.velocity)).with_force(vector(body.force))));
}

/// Advances the engine and returns the collisions.
pub fn run(engine: &mut Engine, steps: u64) -> Vec<Collision> {
    let mut collisions: Vec<Collision> = Vec::new();
    for _ in 0..steps {
        engine.step(&mut collisions).unwrap_or_else(|error| panic!("{error}"));
    }
    collisions
}

/// Advances the engine and returns the number of collisions with an impulse.
pub fn count(engine: &mut Engine, steps: u64) -> u64 {
    let mut collisions = CollisionCount::default();
    for _ in 0..steps {
        engine.step(&mut collisions).unwrap_or_else(|error| panic!("{error}"));
    }
    collisions.0
}

pub fn body(engine: &Engine, id: BodyId) -> &Body {
    engine.world().body(id).unwrap()
}

/// The bits of x, y, vx, vy, because values of different bits can compare equal.
pub fn bits(body: &Body) -> [u64; 4] {
    [body.rect.origin.x, body.rect.origin.y, body.velocity.x, body.velocity.y].map(f64::to_bits)
}

pub fn all_bits(engine: &Engine) -> Vec<[u64; 4]> {
    engine.world().bodies.iter().map(bits).collect()
}

pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected} ± {tolerance:e}");
}
