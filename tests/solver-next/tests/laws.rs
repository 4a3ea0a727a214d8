//! Laws of the event-driven solver on random scenes of coincident events.

use edmd::physics::{
    BodyId, Collision, Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, StepError, Vector,
};

/// The number of scenes per law; `LAW_SCENES` sets another.
fn scenes() -> u64 {
    let standard = if cfg!(debug_assertions) { 100 } else { 400 };
    std::env::var("LAW_SCENES").ok().and_then(|text| text.parse().ok()).unwrap_or(standard)
}

/// A linear congruential generator (Knuth's MMIX constants).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % bound
    }

    fn pick(&mut self, numbers: &[f64]) -> f64 {
        numbers[self.below(numbers.len() as u64) as usize]
    }
}

#[derive(Clone)]
struct Scene {
    rate: f64,
    steps: u64,
    gravity: Vector,
    restitution: f64,
    spawns: Vec<(u64, Spawn)>,
    deletes: Vec<(u64, BodyId)>,
}

/// Boxes on a grid of quarters: they touch, slide, fall and collide at the same instants.
fn random_scene(seed: u64) -> Scene {
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1);
    (0..20).for_each(|_| _ = random.below(2));
    let mut scene = Scene {
        rate: 64.0,
        steps: 96,
        gravity: Vector::new(random.pick(&[0.0, 0.0, 2.0]), random.pick(&[0.0, 8.0, -4.0])),
        restitution: random.pick(&[0.0, 0.25, 0.5, 0.875, 1.0]),
        spawns: Vec::new(),
        deletes: Vec::new(),
    };
    let mut placed: Vec<Rect> = Vec::new();
    for index in 0..2 + random.below(8) {
        let step = if random.below(6) == 0 { random.below(40) } else { 0 };
        let size = [0, 1].map(|_| random.pick(&[0.5, 1.0, 1.0, 2.0]));
        let at = [0, 1].map(|_| random.below(20) as f64 * 0.25);
        let rect = Rect::new(Vector::new(at[0], at[1]), size[0], size[1]);
        let overlaps = |other: &Rect| {
            let [a, b] = [rect.far_corner(), other.far_corner()];
            rect.origin.x < b.x && other.origin.x < a.x && rect.origin.y < b.y && other.origin.y < a.y
        };
        if placed.iter().any(overlaps) || (step > 0 && index < 4) {
            continue;
        }
        placed.push(rect);
        let mass = random.pick(&[1.0, 1.0, 2.0, 0.5, f64::INFINITY]);
        let velocity = [0, 1].map(|_| random.pick(&[0.0, 0.0, 1.0, -1.0, 2.0]));
        let is_static = mass == f64::INFINITY && random.below(3) > 0;
        let velocity = if is_static { Vector::ZERO } else { Vector::new(velocity[0], velocity[1]) };
        let force = if random.below(4) == 0 { Vector::new(random.pick(&[-4.0, 4.0]), random.pick(&[0.0, 2.0])) } else { Vector::ZERO };
        let step = if placed.len() > 3 { step } else { 0 };
        let name = format!("b{index}");
        scene.spawns.push((step, Spawn { name, rect, mass, velocity, force, material: String::new() }));
    }
    scene.spawns.sort_by_key(|(step, _)| *step);
    if random.below(3) == 0 && !scene.spawns.is_empty() {
        let id = random.below(scene.spawns.len() as u64) as usize;
        scene.deletes.push((scene.spawns[id].0 + 10 + random.below(30), id as BodyId));
    }
    scene
}

/// All states and collisions, and the error that ended the run.
#[derive(Clone, Debug, PartialEq)]
struct Run {
    states: Vec<Vec<(BodyId, Vector, Vector)>>,
    collisions: Vec<(f64, [BodyId; 2], Vector, f64, [f64; 2])>,
    failed: bool,
}

impl Scene {
    fn engine(&self) -> Engine {
        Engine::new(self.config())
    }

    fn config(&self) -> EngineConfig {
        EngineConfig {
            solver: SolverKind::EventDriven,
            rate: self.rate,
            gravity: Some(self.gravity),
            restitution: Restitution::new(self.restitution, &[]),
            events_per_step: 20_000,
        }
    }

    fn run(&self) -> Run {
        self.run_with(|_| {})
    }

    fn run_with(&self, mut between: impl FnMut(&mut Engine)) -> Run {
        let mut engine = self.engine();
        let (mut states, mut collisions) = (Vec::new(), Vec::new());
        let mut failed = false;
        for step in 0..=self.steps {
            if step > 0 {
                let mut found: Vec<Collision> = Vec::new();
                if engine.step(&mut found).is_err() {
                    failed = true;
                    break;
                }
                collisions.extend(found.into_iter().map(|c| (c.instant, c.bodies, c.normal, c.impulse, c.normal_velocity)));
            }
            self.deletes.iter().filter(|(at, _)| *at == step).for_each(|(_, id)| engine.apply(&Event::Delete(*id)));
            for (_, spawn) in self.spawns.iter().filter(|(at, _)| *at == step) {
                engine.apply(&Event::Spawn(spawn.clone()));
            }
            between(&mut engine);
            states.push(engine.world().bodies.iter().map(|body| (body.id, body.rect.origin, body.velocity)).collect());
        }
        Run { states, collisions, failed }
    }

    fn map(&self, rect: impl Fn(Rect) -> Rect, vector: impl Fn(Vector) -> Vector) -> Scene {
        let mut scene = self.clone();
        scene.gravity = vector(scene.gravity);
        for (_, spawn) in &mut scene.spawns {
            spawn.rect = rect(spawn.rect);
            spawn.velocity = vector(spawn.velocity);
            spawn.force = vector(spawn.force);
        }
        scene
    }
}

fn swapped(v: Vector) -> Vector {
    Vector::new(v.y, v.x)
}

fn swapped_rect(rect: Rect) -> Rect {
    Rect::new(swapped(rect.origin), rect.height(), rect.width())
}

fn check(law: &str, transformed: impl Fn(&Scene) -> Run, expected: impl Fn(Run) -> Run) {
    for seed in 0..scenes() {
        let scene = random_scene(seed);
        let (right, found) = (expected(scene.run()), transformed(&scene));
        assert_eq!(right.failed, found.failed, "{law}, seed {seed}");
        if !right.failed {
            assert!(right.collisions == found.collisions, "{law}, seed {seed}: collisions {:#?} {:#?}", right.collisions, found.collisions);
            assert!(right.states == found.states, "{law}, seed {seed}: states");
        }
    }
}

#[test]
fn exchanging_the_axes_exchanges_the_results() {
    check(
        "axes",
        |scene| scene.map(swapped_rect, swapped).run(),
        |mut run| {
            run.states.iter_mut().flatten().for_each(|(_, x, v)| (*x, *v) = (swapped(*x), swapped(*v)));
            run.collisions.iter_mut().for_each(|collision| collision.2 = swapped(collision.2));
            // A corner that blocks along both axes is hit along x first.
            let mut sorted = run.collisions.clone();
            for index in 1..sorted.len() {
                let [a, b] = [&sorted[index - 1], &sorted[index]];
                if a.0 == b.0 && a.1 == b.1 && a.2.y != 0.0 && b.2.x != 0.0 && a.4[0] == b.4[0] {
                    sorted.swap(index - 1, index);
                }
            }
            run.collisions = sorted;
            run
        },
    );
}

#[test]
fn lengths_times_a_power_of_two() {
    for k in [1.0 / 1024.0, 4.0, (1_u128 << 100) as f64] {
        check(
            "lengths",
            |scene| {
                let rect = |rect: Rect| Rect::new(rect.origin.mult(k), rect.width() * k, rect.height() * k);
                scene.map(rect, |v| v.mult(k)).run()
            },
            |mut run| {
                run.states.iter_mut().flatten().for_each(|(_, x, v)| (*x, *v) = (x.mult(k), v.mult(k)));
                for (_, _, _, impulse, velocity) in &mut run.collisions {
                    *impulse *= k;
                    *velocity = velocity.map(|v| v * k);
                }
                run
            },
        );
    }
}

#[test]
fn masses_times_a_power_of_two() {
    for k in [1.0 / 1024.0, (1_u128 << 100) as f64] {
        check(
            "masses",
            |scene| {
                let mut scene = scene.clone();
                for (_, spawn) in &mut scene.spawns {
                    spawn.mass *= k;
                    spawn.force = spawn.force.mult(k);
                }
                scene.run()
            },
            |mut run| {
                run.collisions.iter_mut().for_each(|collision| collision.3 *= k);
                run
            },
        );
    }
}

#[test]
fn times_times_a_power_of_two() {
    for k in [0.25, 1024.0] {
        check(
            "times",
            |scene| {
                let mut scene = scene.clone();
                scene.rate /= k;
                scene.gravity = scene.gravity.mult(1.0 / (k * k));
                for (_, spawn) in &mut scene.spawns {
                    spawn.velocity = spawn.velocity.mult(1.0 / k);
                    spawn.force = spawn.force.mult(1.0 / (k * k));
                }
                scene.run()
            },
            |mut run| {
                run.states.iter_mut().flatten().for_each(|(_, _, v)| *v = v.mult(1.0 / k));
                for (instant, _, _, impulse, velocity) in &mut run.collisions {
                    *instant *= k;
                    *impulse /= k;
                    *velocity = velocity.map(|v| v / k);
                }
                run
            },
        );
    }
}

#[test]
fn the_rate_only_samples() {
    check(
        "rates",
        |scene| {
            let mut scene = scene.clone();
            scene.rate *= 4.0;
            scene.steps *= 4;
            scene.spawns.iter_mut().for_each(|(step, _)| *step *= 4);
            scene.deletes.iter_mut().for_each(|(step, _)| *step *= 4);
            let mut run = scene.run();
            run.states = run.states.into_iter().step_by(4).collect();
            run
        },
        |run| run,
    );
}

#[test]
fn distant_bodies_change_nothing() {
    check(
        "distant",
        |scene| {
            let mut scene = scene.clone();
            for index in 0..20_u32 {
                let rect = Rect::new(Vector::new(1000.0 + f64::from(index), 500.0), 1.0, 1.0);
                let velocity = Vector::new(f64::from(index % 3) - 1.0, 0.0);
                let name = format!("far {index}");
                scene.spawns.push((0, Spawn { name, rect, mass: 1.0, velocity, force: Vector::ZERO, material: String::new() }));
            }
            let last = scene.spawns.len() as BodyId - 20;
            if scene.spawns[..last as usize].iter().any(|(step, _)| *step > 0) || !scene.deletes.is_empty() {
                return random_run_without_far_bodies(&scene, last);
            }
            let mut run = scene.run();
            run.states.iter_mut().for_each(|state| state.retain(|(id, ..)| *id < last));
            run.collisions.retain(|(_, bodies, ..)| bodies[0] < last);
            run
        },
        |run| run,
    );
}

/// Ids are given in the order of spawning, so scenes with late spawns run without the distant bodies.
fn random_run_without_far_bodies(scene: &Scene, last: BodyId) -> Run {
    let mut scene = scene.clone();
    scene.spawns.truncate(last as usize);
    scene.run()
}

#[test]
fn restoring_at_every_step_changes_nothing() {
    check(
        "restore",
        |scene| {
            scene.run_with(|engine| *engine = Engine::restore(scene.config(), engine.snapshot()).expect("a valid snapshot"))
        },
        |run| run,
    );
}

#[test]
fn mirrored_and_shifted_scenes_give_mirrored_and_shifted_positions() {
    let shift = Vector::new(-64.0, 1024.0);
    for seed in 0..scenes() {
        let scene = random_scene(seed);
        let right = scene.run();
        let mirrored = scene.map(
            |rect| Rect::new(Vector::new(-rect.origin.x - rect.width(), rect.origin.y), rect.width(), rect.height()),
            |v| Vector::new(-v.x, v.y),
        );
        let shifted = scene.map(|rect| Rect::new(rect.origin.add(shift), rect.width(), rect.height()), |v| v);
        let width = |id: BodyId| scene.spawns[id as usize].1.rect.width();
        let runs: [(Run, Box<dyn Fn(BodyId, Vector) -> Vector>); 2] = [
            (mirrored.run(), Box::new(|id, x| Vector::new(-x.x - width(id), x.y))),
            (shifted.run(), Box::new(|_, x| x.sub(shift))),
        ];
        for (law, (found, back)) in ["mirror", "shift"].into_iter().zip(runs) {
            assert_eq!(right.failed, found.failed, "{law}, seed {seed}");
            for (step, (a, b)) in right.states.iter().zip(&found.states).enumerate() {
                for ((id, x, _), (_, y, _)) in a.iter().zip(b) {
                    let difference = back(*id, *y).sub(*x).norm();
                    assert!(difference < 1e-9, "{law}, seed {seed}, step {step}, body {id}: {difference:e}");
                }
            }
        }
    }
}

#[test]
fn no_impulse_is_negative_and_no_boxes_overlap() {
    for seed in 0..scenes() {
        let scene = random_scene(seed);
        let mut worst = 0.0;
        let run = scene.run_with(|engine| {
            let overlap = edmd::physics::invariants::worst_overlap(engine.world());
            worst = if overlap > worst && engine.current_step() > 0 { overlap } else { worst };
        });
        assert!(run.collisions.iter().all(|(_, _, _, impulse, [before, after])| *impulse > 0.0 && *before < 0.0 && *after >= 0.0));
        let spawns_late = scene.spawns.iter().any(|(step, _)| *step > 0);
        assert!(spawns_late || worst < 1e-12, "seed {seed}: {worst:e}");
    }
}

#[test]
fn an_engine_that_has_failed_returns_the_same_error_again() {
    let mut scene = random_scene(0);
    scene.spawns.clear();
    scene.deletes.clear();
    scene.restitution = 1.0;
    for (name, x, mass, velocity) in [("left", 0.0, f64::INFINITY, 0.0), ("right", 2.0, f64::INFINITY, 0.0), ("box", 1.0, 1.0, 1.0)] {
        let rect = Rect::new(Vector::new(x, 0.0), 1.0, 1.0);
        let (name, velocity) = (name.to_owned(), Vector::new(velocity, 0.0));
        scene.spawns.push((0, Spawn { name, rect, mass, velocity, force: Vector::ZERO, material: String::new() }));
    }
    let mut engine = scene.engine();
    scene.spawns.iter().for_each(|(_, spawn)| engine.apply(&Event::Spawn(spawn.clone())));
    let first = engine.step(&mut Vec::new()).unwrap_err();
    assert!(matches!(first, StepError::Endless { .. }), "{first}");
    assert_eq!(engine.step(&mut Vec::new()), Err(first));
}
