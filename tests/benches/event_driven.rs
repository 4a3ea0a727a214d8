//! What the exact solver costs and how exact it is: `cargo bench --bench event_driven -- SCENE.toml…`
//!
//! For each scene one line: nanoseconds per body-step, sampling every step and recording
//! nothing; energy drift; worst overlap; collisions. Without arguments, a few scenes made here.

use rebond::{
    physics::{CollisionCount, Settings, invariants},
    run::{Run, settings},
    scene::{self, Scene},
};
use std::{path::Path, time::Instant};

fn main() {
    println!("scene                        bodies    steps  ns/body-step  energy drift  overlap, m  collisions");
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    if arguments.is_empty() {
        [100, 1_000, 10_000, 100_000].into_iter().for_each(|bodies| measure(&format!("gas of {bodies}"), &gas(bodies)));
        [1_000, 10_000].into_iter().for_each(|bodies| measure(&format!("heap of {bodies}"), &heap(bodies)));
        (0..=7).for_each(|digits| measure(&format!("Galperin {digits}"), &galperin(digits)));
    }
    for path in &arguments {
        let scene = scene::load(Path::new(path)).unwrap_or_else(|error| panic!("{error}"));
        measure(path.rsplit('/').next().unwrap_or(path), &scene);
    }
}

fn measure(name: &str, scene: &Scene) {
    let Settings { gravity, .. } = settings(scene);
    let mut run = Run::new(scene);
    let mut collisions = CollisionCount::default();
    run.happen(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
    let total = |run: &Run| {
        let potential = if gravity.is_some() { invariants::potential_energy(run.engine().world()) } else { 0.0 };
        (invariants::kinetic_energy(run.engine().world()), potential)
    };
    let (kinetic, potential) = total(&run);
    let bodies = run.engine().world().bodies.iter().filter(|body| !body.is_infinite()).count();
    let start = Instant::now();
    for step in 0..scene.run.steps {
        if let Err(error) = run.step(&mut collisions) {
            println!("{name}: after {step} steps: {error}");
            return;
        }
        if step + 1 < scene.run.steps {
            run.happen(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
        }
    }
    let cost = start.elapsed().as_secs_f64() * 1e9 / (bodies as u64 * scene.run.steps) as f64;
    let after = total(&run);
    let scale = kinetic + potential.abs();
    let drift = (after.0 + after.1 - kinetic - potential) / if scale > 0.0 { scale } else { 1.0 };
    let overlap = if bodies <= 20_000 { invariants::worst_overlap(run.engine().world()) } else { f64::NAN };
    println!(
        "{name:28} {bodies:6} {:8} {cost:13.2} {drift:13.1e} {overlap:11.1e} {:11}",
        scene.run.steps, collisions.0
    );
}

/// Unit boxes packed to a fifth between walls, e = 1.
fn gas(bodies: usize) -> Scene {
    let side = (bodies as f64 * 5.0).sqrt();
    let steps = if bodies > 20_000 { 200 } else { 1000 };
    parse(&format!(
        "[world]\nsize = [{side}, {side}]\nwalls = true\n[run]\nrate = 60\nsteps = {steps}\nsolver = \"event-driven\"\n\
         [[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {side}, {side}]\nsize = [[1.0, 1.0], [1.0, 1.0]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    ))
}

/// Boxes of sides 0.6–1.4 that fall into a bin with up to 3 m/s sideways, e = 0.3.
fn heap(bodies: usize) -> Scene {
    let width = (bodies as f64 * 3.6).sqrt();
    let height = width * 0.8;
    parse(&format!(
        "[world]\nsize = [{width}, {height}]\nwalls = true\ngravity = [0.0, 9.81]\n[run]\nrate = 60\nsteps = 600\n\
         solver = \"event-driven\"\n[restitution]\ndefault = 0.3\n\
         [[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {width}, {height}]\nsize = [[0.6, 0.6], [1.4, 1.4]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-3.0, 0.0], [3.0, 0.0]]\n"
    ))
}

/// Galperin's billiard of that many digits of π after the first.
fn galperin(digits: usize) -> Scene {
    let mass = format!("1{}.0", "00".repeat(digits));
    parse(&format!(
        "[world]\nsize = [16.0, 9.0]\n[run]\nrate = 60\nsteps = 600\nsolver = \"event-driven\"\nevents_per_step = 100000000000\n\
         [[spawn]]\nat = [0.0, 0.0]\nsize = [1.0, 9.0]\nmass = inf\n\
         [[spawn]]\nat = [4.0, 8.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
         [[spawn]]\nat = [8.0, 7.0]\nsize = [2.0, 2.0]\nmass = {mass}\nvelocity = [-1.0, 0.0]\n"
    ))
}

fn parse(text: &str) -> Scene {
    scene::parse("bench.toml", text).unwrap_or_else(|error| panic!("{error}"))
}
