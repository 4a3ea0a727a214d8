//! Regression tests: scenes on which the event-driven solver once failed. The first lines of each describe how.

use rebond::internals::{
    physics::{Collision, Engine, Observer},
    replay::Run,
    scene,
};
use std::{fs, path::Path};

/// Upper bound of the number of collisions in each of these scenes.
const MAX_COLLISIONS: u64 = 2_000;

/// Counts all collisions, including those without an impulse.
struct Count(u64);

impl Observer for Count {
    fn collision(&mut self, _: &Collision) {
        self.0 += 1;
    }
}

fn start(path: &Path) -> (Run, u64) {
    let scene = scene::load(path).expect("a scene");
    let mut run = Run::new(&scene);
    run.apply_inputs(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
    (run, scene.run.steps)
}

fn x(engine: &Engine, name: &str) -> f64 {
    engine.world().bodies.iter().find(|body| body.name == name).expect("a body with this name").rect.origin.x
}

#[test]
fn hard_scenes_run_without_error_overlap_or_too_many_collisions() {
    let mut failures = Vec::new();
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hard")).expect("the hard scenes") {
        let path = entry.unwrap().path();
        let (mut run, steps) = start(&path);
        let mut collisions = Count(0);
        let mut overlap = 0.0_f64;
        let ended = (0..steps).try_for_each(|_| {
            run.step(&mut collisions)?;
            let now = run.engine().world().deepest_overlap();
            overlap = if now > overlap { now } else { overlap };
            Ok::<(), rebond::internals::physics::StepError>(())
        });
        if ended.is_err() || overlap > 1e-14 || collisions.0 > MAX_COLLISIONS {
            failures.push(format!("{}: {ended:?}, overlap {overlap} m, {} collisions", path.display(), collisions.0));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_body_pressed_against_a_corner_pushes_the_other_body() {
    let (mut run, _) = start(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hard/corner-pressed.toml"));
    for _ in 0..60 {
        run.step(&mut Count(0)).unwrap();
    }
    let [a, b] = ["a", "b"].map(|name| x(run.engine(), name));
    assert!((a - 0.25).abs() < 1e-15, "1 N on a total of 2 kg for 1 s: x = {a}, expected 0.25");
    assert!((b - a - 1.0).abs() < 1e-15);
}

#[test]
fn a_box_slides_on_tiles_as_on_a_single_plank() {
    let (mut run, steps) = start(&Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings/tile-seams.toml"));
    for step in 0..steps {
        run.step(&mut Count(0)).unwrap();
        let [plank, tiles] = ["on a plank", "on tiles"].map(|name| x(run.engine(), name));
        assert_eq!(plank.to_bits(), tiles.to_bits(), "after {} steps", step + 1);
    }
}
