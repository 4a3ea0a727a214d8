//! Laws on crowds: random scenes of about a hundred bodies in debug and up to thousands in release. There the candidates
//! of a prediction come from cells, and coincidences that are rare in small scenes happen.

use super::{
    random::{COEFFICIENTS, Random},
    run::larger,
    seeds,
};
use crate::world_builder::{BodySpec, Conditions, INFINITE, all_bits, config, spawn, spec, walls, world};
use rebond::internals::physics::{BodyId, Collision, CollisionCount, Engine, Event, Observer};

/// One crowd is run for so many scenes of the other laws.
const SCENES_PER_CROWD: u64 = if cfg!(debug_assertions) { 40 } else { 100 };

const STEPS: u64 = if cfg!(debug_assertions) { 60 } else { 150 };

/// The distance of the places on which boxes are put, m. No box is longer.
const PITCH: f64 = 1.5;

/// A box, or a block of touching boxes of equal velocity, for the place whose corner is given.
type Fill = fn(&mut Random, [f64; 2]) -> BodySpec;

/// Boxes of different sizes in general position.
fn scattered(r: &mut Random, corner: [f64; 2]) -> BodySpec {
    let size = [r.between(0.3, 1.4), r.between(0.3, 1.4)];
    let at = [0, 1].map(|k| corner[k] + r.between(0.0, PITCH - size[k]));
    spec(at, size, r.between(0.5, 3.0)).with_velocity(r.between(-3.0, 3.0), r.between(-3.0, 3.0))
}

/// Boxes with faces and events that coincide; those that fill their places touch their neighbours.
fn aligned(r: &mut Random, corner: [f64; 2]) -> BodySpec {
    let size = [r.pick(&[0.5, 1.0, 1.5]), r.pick(&[0.5, 1.0, 1.5])];
    let at = [0, 1].map(|k| corner[k] + 0.25 * r.below(1 + ((PITCH - size[k]) * 4.0) as u64) as f64);
    spec(at, size, r.pick(&[1.0, 1.0, 2.0])).with_velocity(r.whole(-1, 1) as f64, r.whole(-1, 1) as f64)
}

/// Boxes at rest that fill their places, and some that fly.
fn stacked(r: &mut Random, corner: [f64; 2]) -> BodySpec {
    let body = spec(corner, [PITCH; 2], 1.0);
    if r.chance(5) { body.with_velocity(r.whole(-4, 4) as f64, r.whole(-4, 4) as f64) } else { body }
}

/// A few boxes that are much smaller than the others.
fn unequal(r: &mut Random, corner: [f64; 2]) -> BodySpec {
    let mut body = scattered(r, corner);
    if r.chance(30) {
        body.size = body.size.map(|side| side / 64.0);
    }
    body
}

struct Crowd {
    conditions: Conditions,
    bodies: Vec<BodySpec>,
    /// Deletions and spawns at the starts of steps.
    changes: Vec<(u64, Change)>,
    /// True to compare its states with those at four times the rate, false with those after a restoration.
    is_compared_with_a_higher_rate: bool,
}

enum Change {
    Delete(BodyId),
    Spawn(BodySpec),
}

/// The random crowd of a seed.
fn crowd(seed: u64) -> Crowd {
    let mut r = Random::new(seed);
    let fill: Fill = [scattered, aligned, stacked, unequal][(seed % 4) as usize];
    let gravity = [None, Some([0.0, 9.81]), Some([0.0, 8.0]), Some([-2.0, 9.81])][r.below(4) as usize];
    // An elastic crowd under a weight never comes to rest; one with touching boxes has bursts without end.
    let coefficients = if seed % 4 == 2 || gravity.is_some() { &COEFFICIENTS[..4] } else { &COEFFICIENTS[..] };
    let restitution = r.pick(coefficients);
    // Bursts take time that grows with the square of the boxes that touch.
    let most = if cfg!(debug_assertions) {
        12
    } else if seed % 4 == 2 {
        20
    } else {
        60
    };
    let [columns, rows] = [r.whole(8, most), r.whole(8, most)];
    let mut bodies = walls(columns as f64 * PITCH, rows as f64 * PITCH);
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        if r.chance(85) {
            let mut body = fill(&mut r, [column as f64 * PITCH, row as f64 * PITCH]);
            if r.chance(1) {
                body = BodySpec { mass: INFINITE, velocity: [0.0; 2], ..body };
            }
            bodies.push(body);
        }
    }
    let mut changes = Vec::new();
    for id in 0..bodies.len() as BodyId {
        if r.chance(3) {
            changes.push((1 + r.below(STEPS - 1), Change::Delete(id)));
        }
    }
    for number in 0..10 {
        // Above the room, where there is no other body.
        let at = [10.0 * number as f64, -20.0];
        changes.push((1 + r.below(STEPS - 1), Change::Spawn(scattered(&mut r, at))));
    }
    changes.sort_by_key(|(step, _)| *step);
    let conditions = Conditions { restitution, gravity, events_per_step: 1_000_000_000, ..Conditions::default() };
    Crowd { conditions, bodies, changes, is_compared_with_a_higher_rate: r.chance(50) }
}

/// Records the first collision with a negative impulse, or of bodies that do not approach.
#[derive(Default)]
struct Impossible(Option<Collision>);

impl Observer for Impossible {
    fn collision(&mut self, collision: &Collision) {
        if collision.impulse < 0.0 || collision.normal_velocity[0] > 0.0 {
            self.0.get_or_insert(collision.clone());
        }
    }
}

impl Crowd {
    /// Runs the crowd and returns the first difference from the laws.
    fn judge(&self) -> Result<(), String> {
        let mut engine = world(self.conditions, &self.bodies);
        let reach = self.bodies.iter().flat_map(|body| [body.at[0] + body.size[0], body.at[1] + body.size[1]]);
        let reach = reach.fold(100.0, larger);
        // J per kilogram
        let weight = self.conditions.gravity.map_or(0.0, |[x, y]| x.abs() + y.abs()) * reach;
        let fast = Conditions { rate: 4.0 * self.conditions.rate, ..self.conditions };
        let mut fast = self.is_compared_with_a_higher_rate.then(|| world(fast, &self.bodies));
        let mut restored = None;
        let mut changes = self.changes.iter().peekable();
        for step in 0..STEPS {
            if step == STEPS / 2 && fast.is_none() {
                let copy = Engine::restore(config(self.conditions), engine.snapshot());
                restored = Some(copy.map_err(|error| error.to_string())?);
            }
            while let Some((_, change)) = changes.next_if(|(due, _)| *due == step) {
                for engine in [Some(&mut engine), restored.as_mut(), fast.as_mut()].into_iter().flatten() {
                    match change {
                        Change::Delete(id) => engine.apply(&Event::Delete(*id)),
                        Change::Spawn(body) => spawn(engine, body),
                    }
                }
            }
            let before = engine.world().kinetic_energy() + engine.world().potential_energy();
            let mut impossible = Impossible::default();
            engine.step(&mut impossible).map_err(|error| error.to_string())?;
            if let Some(restored) = &mut restored {
                restored.step(&mut CollisionCount::default()).map_err(|error| error.to_string())?;
            }
            if let Some(fast) = &mut fast {
                for _ in 0..4 {
                    fast.step(&mut CollisionCount::default()).map_err(|error| error.to_string())?;
                }
            }
            if let Impossible(Some(collision)) = impossible {
                return Err(format!("step {step}: {collision:?}"));
            }
            let overlap = engine.world().deepest_overlap();
            if overlap > 16.0 * f64::EPSILON * reach {
                return Err(format!("step {step}: overlap of {overlap:e} m"));
            }
            let (kinetic, mass) = (engine.world().kinetic_energy(), 3.0 * engine.world().bodies.len() as f64);
            let after = kinetic + engine.world().potential_energy();
            if after > before + 1e-9 * (kinetic + mass * weight) {
                return Err(format!("step {step}: energy {before} J, then {after} J"));
            }
        }
        let differs = |other: Option<Engine>| other.is_some_and(|other| all_bits(&other) != all_bits(&engine));
        if differs(restored) {
            return Err("the engine restored halfway differs".into());
        }
        if differs(fast) { Err("the engine at four times the rate differs".into()) } else { Ok(()) }
    }
}

#[test]
fn crowds_have_no_overlaps_and_no_impossible_impulses_do_not_gain_energy_and_do_not_depend_on_rate_or_restoration() {
    let seeds = seeds();
    let last = seeds.start + (seeds.end - seeds.start).div_ceil(SCENES_PER_CROWD);
    let (mut bodies, mut failures) = (0, Vec::new());
    for seed in seeds.start..last {
        let crowd = crowd(seed);
        bodies += crowd.bodies.len();
        failures.extend(crowd.judge().err().map(|difference| format!("seed {seed}: {difference}\n")));
    }
    println!("crowds: {} with {bodies} bodies, {} fail", last - seeds.start, failures.len());
    assert!(failures.is_empty(), "{}", failures.concat());
}

/// The inelastic collapse of three boxes ends while the middle one is above the lowest by less than doubles see; the
/// alignment of its upper face with the stand then makes it touch.
#[test]
fn boxes_that_collapse_beside_a_stand_do_not_sink_into_each_other() {
    let mut r = Random::new(1);
    let (groups, steps) = if cfg!(debug_assertions) { (120, 60) } else { (1000, 240) };
    let mut bodies = vec![spec([-10.0, 24.0], [10.0 * f64::from(groups) + 20.0, 1.0], INFINITE)];
    for group in 0..groups {
        let x = 10.0 * f64::from(group);
        let [lowest, middle, highest] = [0; 3].map(|_| r.pick(&[0.5, 1.0, 2.0, 3.0]));
        bodies.push(spec([x + 0.5, 23.5], [0.5, 0.5], lowest));
        bodies.push(spec([x + 2.0, 23.0], [0.5, 1.0], r.pick(&[1.0, INFINITE])));
        bodies.push(spec([x + 0.25, 23.0 - r.between(0.01, 0.5)], [1.0, 0.5], middle));
        bodies.push(spec([x + 1.0, 22.0 - r.between(0.6, 1.5)], [1.5, 1.0], highest));
    }
    for restitution in [0.2, 0.3, 0.5] {
        let conditions = Conditions { restitution, gravity: Some([0.0, 9.81]), ..Conditions::default() };
        let mut engine = world(conditions, &bodies);
        for step in 0..steps {
            engine.step(&mut CollisionCount::default()).unwrap_or_else(|error| panic!("{error}"));
            let overlap = engine.world().deepest_overlap();
            assert!(overlap <= 1e-12, "e = {restitution}, step {step}: {overlap:e} m");
        }
    }
}
