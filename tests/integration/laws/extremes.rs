//! The law of extreme numbers: each step of a scene of finite numbers ends, with finite states or with an error.

use super::{random::Random, seeds_of};
use rebond::internals::physics::{
    CollisionCount, Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, StepError, Vector,
};

/// The binary exponents around which the numbers of a scene lie.
const EXPONENTS: [i64; 8] = [-1070, -500, -100, 0, 0, 100, 500, 1023];

/// The range of the numbers of a scene for one quantity.
#[derive(Clone, Copy)]
struct Magnitude {
    exponent: i64,
    spread: i64,
}

impl Magnitude {
    fn random(r: &mut Random) -> Magnitude {
        Magnitude { exponent: r.pick(&EXPONENTS), spread: r.pick(&[0, 3, 30, 400]) }
    }

    /// A positive number, also a subnormal one.
    fn positive(self, r: &mut Random) -> f64 {
        let exponent = (self.exponent + r.whole(-self.spread, self.spread)).clamp(-1074, 1023);
        let factor = if exponent < 0 { 0.5 } else { 2.0 };
        let power = (0..exponent.unsigned_abs()).fold(1.0, |value, _| value * factor);
        power * r.between(1.0, 1.999)
    }

    fn signed(self, r: &mut Random) -> f64 {
        r.pick(&[0.0, 1.0, 1.0, -1.0, -1.0]) * self.positive(r)
    }

    fn vector(self, r: &mut Random) -> Vector {
        Vector::new(self.signed(r), self.signed(r))
    }
}

fn engine(r: &mut Random) -> Engine {
    let [place, size, mass, speed, acceleration] = [(); 5].map(|()| Magnitude::random(r));
    let solver = r.pick(&[SolverKind::EventDriven, SolverKind::EventDriven, SolverKind::Handout]);
    let rate = if r.chance(25) { Magnitude { exponent: 0, spread: 30 }.positive(r) } else { 60.0 };
    let config = EngineConfig::new(solver, rate)
        .with_gravity(r.chance(50).then(|| acceleration.vector(r)))
        .with_restitution(Restitution::new(r.pick(&[0.0, 0.5, 1.0]), &[]))
        .with_events_per_step(500);
    let mut engine = Engine::new(config);
    let most = if r.chance(30) { 40 } else { 8 };
    for index in 0..=r.below(most) {
        let rect = Rect::new(place.vector(r), size.positive(r), size.positive(r));
        let mass = if r.chance(15) { f64::INFINITY } else { mass.positive(r) };
        let force = if r.chance(20) { acceleration.vector(r) } else { Vector::ZERO };
        let spawn = Spawn::new(format!("body {index}"), rect, mass).with_velocity(speed.vector(r)).with_force(force);
        // If the acceleration overflows, the first step must fail.
        engine.apply(&Event::Spawn(spawn));
    }
    engine
}

/// The error that ends a run of 40 steps, if one does.
fn error_of(engine: &mut Engine, seed: u64) -> Option<StepError> {
    for step in 0..40 {
        if let Err(error) = engine.step(&mut CollisionCount::default()) {
            return Some(error);
        }
        let is_finite =
            engine.world().bodies.iter().all(|body| body.rect.origin.is_finite() && body.velocity.is_finite());
        assert!(is_finite, "seed {seed}, step {step}: a state is not finite");
    }
    None
}

#[test]
fn each_step_of_finite_numbers_ends_with_finite_states_or_with_an_error() {
    let (mut ended, mut failed) = (0, 0);
    for seed in seeds_of("REBOND_LAW_SCENES", if cfg!(debug_assertions) { 90 } else { 1120 }) {
        match error_of(&mut engine(&mut Random::new(seed)), seed) {
            None => ended += 1,
            Some(_) => failed += 1,
        }
    }
    println!("extremes: {ended} scenes run to their end, {failed} end with an error");
    assert!(ended > failed / 4, "most scenes are not simulated");
}

#[test]
fn boxes_of_the_largest_size_are_simulated() {
    let mut engine = Engine::new(EngineConfig::new(SolverKind::EventDriven, 30.0));
    for index in 0..20 {
        let at = Vector::new(0.0, f64::from(index) * 3.0);
        engine.apply(&Event::Spawn(Spawn::new(format!("body {index}"), Rect::new(at, f64::MAX, 2.0), 1.0)));
    }
    assert_eq!(error_of(&mut engine, 0), None);
}
