//! Scenes the exact solver still gets wrong, kept until it does not: each says in its first
//! lines what is wrong. `cargo test known_faults -- --ignored` shows where we stand.

use rebond::{
    physics::{CollisionCount, invariants},
    run::Run,
    scene,
};
use std::{fs, path::Path};

#[test]
#[ignore = "these are the open faults of the event-driven solver"]
fn known_faults_are_mended() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults");
    let mut faults = Vec::new();
    for entry in fs::read_dir(folder).expect("the folder of faults") {
        let path = entry.unwrap().path();
        let mut scene = scene::load(&path).expect("a scene");
        scene.run.events_per_step = 10_000;
        let mut run = Run::new(&scene);
        run.happen(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
        let ended = (0..scene.run.steps).try_for_each(|_| run.step(&mut CollisionCount::default()));
        let overlap = invariants::worst_overlap(run.engine().world());
        if ended.is_err() || overlap > 1e-12 {
            faults.push(format!("{}: {ended:?}, overlap {overlap} m", path.display()));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
