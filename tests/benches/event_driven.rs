//! Measures cost and accuracy of the event-driven solver: `cargo bench --bench event_driven -- SCENE.toml…`
//!
//! Prints one line for each scene: nanoseconds per body-step, with a sample at each step but without recording;
//! energy drift; deepest overlap; number of collisions; nanoseconds per collision, all costs included; bytes per
//! body, if the scene increased the memory of the process; the ratio of the costs of `cell_list` and of rebond;
//! nanoseconds per step after all bodies have come to rest. The ratio is measured for elastic gases of equal
//! boxes; the two engines take turns, so that it does not depend on the load of the machine.
//!
//! Without scenes as arguments, built-in ones are measured; with `--full`, these include Galperin's billiard for up to
//! ten digits of π, which takes half an hour.

mod cell_list;

use cell_list::CellList;
use rebond::internals::{
    physics::{CollisionCount, EngineConfig, World},
    replay::{Run, engine_config},
    scene::{self, Scene},
};
use std::{path::Path, time::Instant};

fn main() {
    println!(
        "scene                        bodies    steps  ns/body-step  energy drift  overlap, m  collisions  ns/collision  bytes/body  plain/rebond  ns/step at rest"
    );
    let (options, paths): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|word| word.starts_with("--"));
    if paths.is_empty() {
        [100, 1_000, 10_000, 100_000].into_iter().for_each(|bodies| measure(&format!("gas of {bodies}"), &gas(bodies)));
        [1_000, 10_000].into_iter().for_each(|bodies| measure(&format!("heap of {bodies}"), &heap(bodies)));
        measure("sizes from 1e-3 to 1e3", &mixed());
        let last = if options.iter().any(|option| option == "--full") { 9 } else { 6 };
        (0..=last).for_each(|digits| measure(&format!("Galperin {digits}"), &galperin(digits)));
    }
    for path in &paths {
        let scene = scene::load(Path::new(path)).unwrap_or_else(|error| panic!("{error}"));
        measure(path.rsplit('/').next().unwrap_or(path), &scene);
    }
}

/// Number of turns that each of the two engines takes.
const TURNS: u64 = 20;

fn measure(name: &str, scene: &Scene) {
    let EngineConfig { gravity, .. } = engine_config(scene);
    let memory_before = resident_bytes();
    let mut run = Run::new(scene);
    let mut collisions = CollisionCount::default();
    run.apply_inputs(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
    let energies = |world: &World| {
        let potential = if gravity.is_some() { world.potential_energy() } else { 0.0 };
        (world.kinetic_energy(), potential)
    };
    let (kinetic, potential) = energies(run.engine().world());
    let bodies = run.engine().world().bodies.iter().filter(|body| !body.is_infinite()).count();
    run.step(&mut collisions).expect("a first step");
    let bytes = resident_bytes().saturating_sub(memory_before) / bodies;
    let mut plain = PlainGas::new(scene, run.engine().world());
    let [mut seconds, mut plain_seconds] = [0.0; 2];
    for turn in 0..TURNS {
        let start = Instant::now();
        for step in (scene.run.steps * turn / TURNS).max(1)..scene.run.steps * (turn + 1) / TURNS {
            if let Err(error) = run.step(&mut collisions) {
                println!("{name}: after {step} steps: {error}");
                return;
            }
            if step + 1 < scene.run.steps {
                run.apply_inputs(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
            }
        }
        seconds += start.elapsed().as_secs_f64();
        if let Some(plain) = &mut plain {
            let start = Instant::now();
            plain.run(scene.run.steps * (turn + 1) / TURNS, scene.run.rate);
            plain_seconds += start.elapsed().as_secs_f64();
        }
    }
    let cost = seconds * 1e9 / (bodies as u64 * scene.run.steps) as f64;
    let after = energies(run.engine().world());
    let scale = kinetic + potential.abs();
    let drift = (after.0 + after.1 - kinetic - potential) / if scale > 0.0 { scale } else { 1.0 };
    let overlap = if bodies <= 20_000 { run.engine().world().deepest_overlap() } else { f64::NAN };
    let [bytes, ratio] =
        [(bytes > 0).then(|| bytes.to_string()), plain.map(|_| format!("{:.2}", plain_seconds / seconds))]
            .map(|figure| figure.unwrap_or_else(|| "-".to_owned()));
    let steps = scene.run.steps;
    let per_collision = seconds * 1e9 / collisions.0 as f64;
    let at_rest = cost_at_rest(&mut run).map_or("-".to_owned(), |cost| format!("{cost:.1}"));
    println!(
        "{name:28} {bodies:6} {steps:8} {cost:13.2} {drift:13.1e} {overlap:11.1e} {:11} {per_collision:13.0} {bytes:>11} {ratio:>11} {at_rest:>16}",
        collisions.0
    );
}

/// Returns the cost of a further step, ns, if all bodies are at rest.
fn cost_at_rest(run: &mut Run) -> Option<f64> {
    const STEPS: u32 = 1_000_000;
    let is_moving =
        |world: &World| world.bodies.iter().any(|body| body.velocity != rebond::internals::physics::Vector::ZERO);
    if is_moving(run.engine().world()) {
        return None;
    }
    let start = Instant::now();
    (0..STEPS).for_each(|_| run.step(&mut CollisionCount::default()).expect("a step without inputs succeeds"));
    Some(start.elapsed().as_secs_f64() * 1e9 / f64::from(STEPS))
}

/// The same gas in the baseline engine, sampled at each step like the solver.
struct PlainGas {
    gas: CellList,
    step: u64,
    sample: Vec<([f64; 2], [f64; 2])>,
}

impl PlainGas {
    /// Returns the gas if the scene is an elastic gas of unit boxes between walls.
    fn new(scene: &Scene, world: &World) -> Option<PlainGas> {
        let moving = || world.bodies.iter().filter(|body| !body.is_infinite());
        let unit = moving().all(|body| body.rect.width() == 1.0 && body.rect.height() == 1.0 && body.mass == 1.0);
        let elastic = world.restitution.default_restitution() == 1.0 && world.gravity.is_none();
        if !(unit && elastic && scene.walls.is_some() && moving().count() > 1) {
            return None;
        }
        let state = |body: &rebond::internals::physics::Body| {
            let (at, velocity) = (body.rect.origin, body.velocity);
            ([at.x, at.y], [velocity.x, velocity.y])
        };
        let sample: Vec<_> = moving().map(state).collect();
        Some(PlainGas { gas: CellList::new(1.0, scene.size, &sample), step: 1, sample })
    }

    fn run(&mut self, until: u64, rate: f64) {
        while self.step < until {
            self.step += 1;
            let time = (self.step - 1) as f64 / rate;
            self.gas.run_until(time);
            self.sample.iter_mut().enumerate().for_each(|(slot, state)| *state = self.gas.state(slot, time));
        }
    }
}

/// Returns the resident memory of the process, bytes; 0 on systems without /proc.
fn resident_bytes() -> usize {
    const PAGE: usize = 4096;
    let pages = std::fs::read_to_string("/proc/self/statm").ok();
    pages.and_then(|pages| pages.split(' ').nth(1)?.parse().ok()).unwrap_or(0) * PAGE
}

/// Unit boxes between walls that fill a fifth of the area, e = 1.
fn gas(bodies: usize) -> Scene {
    let side = (bodies as f64 * 5.0).sqrt();
    let steps = if bodies > 20_000 { 200 } else { 1000 };
    parse(&format!(
        "[world]\nsize = [{side}, {side}]\nwalls = true\n[run]\nrate = 60\nsteps = {steps}\nsolver = \"event-driven\"\n\
         [[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {side}, {side}]\nsize = [[1.0, 1.0], [1.0, 1.0]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    ))
}

/// Boxes of sides 0.6–1.4 m that fall into a bin with horizontal speeds of up to 3 m/s, e = 0.3.
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

/// 100 boxes of each order of magnitude of size from a millimetre to a kilometre, e = 1.
fn mixed() -> Scene {
    let scatter = |(index, size): (usize, f64)| {
        let (x, side, speed) = (index as f64 * 4000.0, 20.0 * size, 2.0 * size);
        format!(
            "[[scatter]]\ncount = 100\nseed = 1\nregion = [{x}, 0.0, {side}, {side}]\n\
             size = [[{0}, {0}], [{size}, {size}]]\nmass = [1.0, 1.0]\nvelocity = [[-{speed}, -{speed}], [{speed}, {speed}]]\n",
            0.5 * size
        )
    };
    let sizes = [1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1000.0];
    let scatters: String = sizes.into_iter().enumerate().map(scatter).collect();
    parse(&format!(
        "[world]\nsize = [60000.0, 40000.0]\nwalls = true\n[run]\nrate = 60\nsteps = 600\nsolver = \"event-driven\"\n{scatters}"
    ))
}

/// Galperin's billiard for a number of decimals of π, until long after the last collision.
fn galperin(digits: usize) -> Scene {
    let mass = format!("1{}.0", "00".repeat(digits));
    parse(&format!(
        "[world]\nsize = [16.0, 9.0]\n[run]\nrate = 1\nsteps = 100000\nsolver = \"event-driven\"\nevents_per_step = 100000000000\n\
         [[spawn]]\nat = [0.0, 0.0]\nsize = [1.0, 9.0]\nmass = inf\n\
         [[spawn]]\nat = [4.0, 8.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
         [[spawn]]\nat = [8.0, 7.0]\nsize = [2.0, 2.0]\nmass = {mass}\nvelocity = [-1.0, 0.0]\n"
    ))
}

fn parse(text: &str) -> Scene {
    scene::parse("bench.toml", text).unwrap_or_else(|error| panic!("{error}"))
}
