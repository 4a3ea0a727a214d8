//! What the exact solver costs and how exact it is: `cargo bench --bench event_driven -- SCENE.toml…`
//!
//! For each scene one line: nanoseconds per body-step, sampling every step and recording
//! nothing; energy drift; worst overlap; collisions; nanoseconds per collision, all else
//! included; bytes per body, where memory had to grow for the scene. An elastic gas of equal
//! boxes is also run by the plain engine in `cell_list`, in turns with ours, so that the last
//! column but one compares the two however busy the machine is. The last is what a step costs
//! after all has come to rest. Without arguments, scenes made here; with `--full`, Galperin's
//! billiard up to the tenth digit of π, which takes half an hour.

mod cell_list;

use cell_list::CellList;
use rebond::{
    physics::{CollisionCount, Settings, World, invariants},
    run::{Run, settings},
    scene::{self, Scene},
};
use std::{path::Path, time::Instant};

fn main() {
    println!(
        "scene                        bodies    steps  ns/body-step  energy drift  overlap, m  collisions  ns/collision  bytes/body  plain/ours  ns/step at rest"
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

/// So many turns the two engines take.
const TURNS: u64 = 20;

fn measure(name: &str, scene: &Scene) {
    let Settings { gravity, .. } = settings(scene);
    let empty = resident();
    let mut run = Run::new(scene);
    let mut collisions = CollisionCount::default();
    run.happen(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
    let total = |world: &World| {
        let potential = if gravity.is_some() { invariants::potential_energy(world) } else { 0.0 };
        (invariants::kinetic_energy(world), potential)
    };
    let (kinetic, potential) = total(run.engine().world());
    let bodies = run.engine().world().bodies.iter().filter(|body| !body.is_infinite()).count();
    run.step(&mut collisions).expect("a first step");
    let bytes = resident().saturating_sub(empty) / bodies;
    let mut plain = Plain::of(scene, run.engine().world());
    let [mut ours, mut theirs] = [0.0; 2];
    for turn in 0..TURNS {
        let start = Instant::now();
        for step in (scene.run.steps * turn / TURNS).max(1)..scene.run.steps * (turn + 1) / TURNS {
            if let Err(error) = run.step(&mut collisions) {
                println!("{name}: after {step} steps: {error}");
                return;
            }
            if step + 1 < scene.run.steps {
                run.happen(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
            }
        }
        ours += start.elapsed().as_secs_f64();
        if let Some(plain) = &mut plain {
            let start = Instant::now();
            plain.run(scene.run.steps * (turn + 1) / TURNS, scene.run.rate);
            theirs += start.elapsed().as_secs_f64();
        }
    }
    let cost = ours * 1e9 / (bodies as u64 * scene.run.steps) as f64;
    let after = total(run.engine().world());
    let scale = kinetic + potential.abs();
    let drift = (after.0 + after.1 - kinetic - potential) / if scale > 0.0 { scale } else { 1.0 };
    let overlap = if bodies <= 20_000 { invariants::worst_overlap(run.engine().world()) } else { f64::NAN };
    let [bytes, ratio] = [(bytes > 0).then(|| bytes.to_string()), plain.map(|_| format!("{:.2}", theirs / ours))]
        .map(|figure| figure.unwrap_or_else(|| "-".to_owned()));
    let steps = scene.run.steps;
    let each = ours * 1e9 / collisions.0 as f64;
    let rest = at_rest(&mut run).map_or("-".to_owned(), |cost| format!("{cost:.1}"));
    println!(
        "{name:28} {bodies:6} {steps:8} {cost:13.2} {drift:13.1e} {overlap:11.1e} {:11} {each:13.0} {bytes:>11} {ratio:>11} {rest:>16}",
        collisions.0
    );
}

/// What a further step costs, ns, if nothing moves any more.
fn at_rest(run: &mut Run) -> Option<f64> {
    const STEPS: u32 = 1_000_000;
    let moves = |world: &World| world.bodies.iter().any(|body| body.velocity != rebond::physics::Vector::ZERO);
    if moves(run.engine().world()) {
        return None;
    }
    let start = Instant::now();
    (0..STEPS).for_each(|_| run.step(&mut CollisionCount::default()).expect("nothing to happen"));
    Some(start.elapsed().as_secs_f64() * 1e9 / f64::from(STEPS))
}

/// The plain engine on the same gas, which samples each step as ours does.
struct Plain {
    gas: CellList,
    step: u64,
    sample: Vec<([f64; 2], [f64; 2])>,
}

impl Plain {
    /// If the scene is an elastic gas of unit boxes between walls, as far as can be told.
    fn of(scene: &Scene, world: &World) -> Option<Plain> {
        let moving = || world.bodies.iter().filter(|body| !body.is_infinite());
        let unit = moving().all(|body| body.rect.width() == 1.0 && body.rect.height() == 1.0 && body.mass == 1.0);
        let elastic = world.restitution.default_restitution() == 1.0 && world.gravity.is_none();
        if !(unit && elastic && scene.walls.is_some() && moving().count() > 1) {
            return None;
        }
        let state = |body: &rebond::physics::Body| {
            let (at, velocity) = (body.rect.origin, body.velocity);
            ([at.x, at.y], [velocity.x, velocity.y])
        };
        let sample: Vec<_> = moving().map(state).collect();
        Some(Plain { gas: CellList::new(1.0, scene.size, &sample), step: 1, sample })
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

/// Bytes of memory the process has in use, where the system says so.
fn resident() -> usize {
    const PAGE: usize = 4096;
    let pages = std::fs::read_to_string("/proc/self/statm").ok();
    pages.and_then(|pages| pages.split(' ').nth(1)?.parse().ok()).unwrap_or(0) * PAGE
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

/// As many boxes of each size between a millimetre and a kilometre, e = 1.
fn mixed() -> Scene {
    let scatter = |(place, size): (usize, f64)| {
        let (x, side, speed) = (place as f64 * 4000.0, 20.0 * size, 2.0 * size);
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

/// Galperin's billiard of that many digits of π after the first, until long after the last collision.
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
