//! What the spine costs: stepping, recording. `cargo bench --bench spine`
//!
//! Each figure is the median of several runs, with the spread beside it, and the error of
//! what was computed beside the cost of computing it.

use rebond::{
    physics::{CollisionCount, Engine, invariants},
    recording::{Header, Outcome, RecordedEvent, SceneText, Versions, Writer},
    run, scene,
};
use std::{io, time::Instant};

const BODIES: [usize; 3] = [10, 100, 1000];
const RUNS: usize = 7;

fn main() {
    println!("handout solver, elastic gas, 60 Hz\nbodies   ns per body-step      energy drift");
    BODIES.iter().for_each(|&bodies| stepping(bodies));
    println!(
        "\nrecording every state of a moving gas (zstd, as always)\nbodies   ns per body-step      bytes per body-step"
    );
    BODIES.iter().for_each(|&bodies| recording(bodies));
}

/// A scene of that many unit boxes, packed to a tenth, between walls.
fn gas(bodies: usize) -> scene::Scene {
    let side = (bodies as f64 * 10.0).sqrt();
    let text = format!(
        "[world]\nsize = [{side}, {side}]\nwalls = true\n[run]\nrate = 60\nsteps = 100\nsolver = \"handout\"\n\
         [[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {side}, {side}]\nsize = [[1.0, 1.0], [1.0, 1.0]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    );
    scene::parse("gas.toml", &text).expect("a scene")
}

/// The engine of the gas at its first state, and the events that led there.
fn started(scene: &scene::Scene) -> (Engine, Vec<RecordedEvent>) {
    let mut run = run::Run::new(scene);
    let events = run.happen(Vec::new(), |error| Err(error.into())).expect("a scene's own events");
    (run.engine().clone(), events)
}

/// Median and spread of `RUNS` measurements, after one that is not counted.
fn measure(mut run: impl FnMut() -> f64) -> String {
    run();
    let mut figures: Vec<f64> = (0..RUNS).map(|_| run()).collect();
    figures.sort_by(f64::total_cmp);
    format!("{:8.2} ({:.2}–{:.2})", figures[RUNS / 2], figures[0], figures[RUNS - 1])
}

fn nanoseconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1e9
}

fn stepping(bodies: usize) {
    let (engine, _) = started(&gas(bodies));
    let steps = [20_000, 2_000, 60][bodies.ilog10() as usize - 1];
    let energy = invariants::kinetic_energy(engine.world());
    let mut drift = 0.0;
    let cost = measure(|| {
        let mut engine = engine.clone();
        let elapsed = nanoseconds(|| {
            for _ in 0..steps {
                engine.step(&mut CollisionCount::default()).expect("finite numbers");
            }
        });
        drift = invariants::kinetic_energy(engine.world()) / energy - 1.0;
        elapsed / (steps * bodies) as f64
    });
    println!("{bodies:6}   {cost:22} {drift:+.1e} in {steps} steps");
}

fn recording(bodies: usize) {
    let scene = gas(bodies);
    let steps = 120;
    let (engine, events) = started(&scene);
    let mut states = vec![engine];
    for _ in 0..steps {
        let mut engine = states[states.len() - 1].clone();
        engine.step(&mut CollisionCount::default()).expect("finite numbers");
        states.push(engine);
    }
    let text = SceneText { file_name: "gas.toml".into(), text: scene.source.text.clone() };
    let header = Header {
        versions: Versions::CURRENT,
        settings: run::settings(&scene),
        steps,
        every: 1,
        scene: text,
        gaps: Vec::new(),
    };
    let mut bytes = 0;
    let cost = measure(|| {
        let mut finished = None;
        let elapsed = nanoseconds(|| {
            let mut writer = Writer::new(io::Cursor::new(Vec::new()), &header).expect("memory");
            events.iter().for_each(|event| writer.event(event).expect("memory"));
            states.iter().for_each(|engine| writer.state(engine).expect("memory"));
            finished = writer.finish(Outcome::default()).ok();
        });
        bytes = finished.map_or(0, |finished| finished.write.into_inner().len());
        elapsed / (steps as f64 * bodies as f64)
    });
    println!("{bodies:6}   {cost:22} {:.1}", bytes as f64 / (steps as f64 * bodies as f64));
}
