//! Scenes on which the exact solver once went wrong: each says how in its first lines.

use rebond::{
    physics::{Collision, Engine, Observer, invariants},
    run::Run,
    scene,
};
use std::{fs, path::Path};

/// No more than so many collisions are needed in any of these scenes.
const FEW: u64 = 2_000;

struct Count(u64);

impl Observer for Count {
    fn collision(&mut self, _: &Collision) {
        self.0 += 1;
    }
}

fn start(path: &Path) -> (Run, u64) {
    let scene = scene::load(path).expect("a scene");
    let mut run = Run::new(&scene);
    run.happen(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
    (run, scene.run.steps)
}

fn x(engine: &Engine, name: &str) -> f64 {
    engine.world().bodies.iter().find(|body| body.name == name).expect("a body of that name").rect.origin.x
}

#[test]
fn contacts_that_shrink_to_nothing_end_soon_and_without_overlap() {
    let mut faults = Vec::new();
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hard")).expect("the hard scenes") {
        let path = entry.unwrap().path();
        let (mut run, steps) = start(&path);
        let mut collisions = Count(0);
        let mut overlap = 0.0_f64;
        let ended = (0..steps).try_for_each(|_| {
            run.step(&mut collisions)?;
            let now = invariants::worst_overlap(run.engine().world());
            overlap = if now > overlap { now } else { overlap };
            Ok::<(), rebond::physics::StepError>(())
        });
        if ended.is_err() || overlap > 1e-14 || collisions.0 > FEW {
            faults.push(format!("{}: {ended:?}, overlap {overlap} m, {} collisions", path.display(), collisions.0));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn pressed_corners_push_and_part_together() {
    let (mut run, _) = start(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hard/corner-pressed.toml"));
    for _ in 0..60 {
        run.step(&mut Count(0)).unwrap();
    }
    let [a, b] = ["a", "b"].map(|name| x(run.engine(), name));
    assert!((a - 0.25).abs() < 1e-15, "half of 1 N on 2 kg in all, for a second: {a}");
    assert!((b - a - 1.0).abs() < 1e-15);
}

#[test]
fn a_floor_of_tiles_is_as_smooth_as_a_plank() {
    let (mut run, steps) = start(&Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings/tile-seams.toml"));
    for step in 0..steps {
        run.step(&mut Count(0)).unwrap();
        let [plank, tiles] = ["on a plank", "on tiles"].map(|name| x(run.engine(), name));
        assert_eq!(plank.to_bits(), tiles.to_bits(), "after {} steps", step + 1);
    }
}
