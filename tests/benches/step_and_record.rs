//! Measures the cost of stepping with the handout solver and of recording: `cargo bench --bench step_and_record`
//!
//! Prints the median and the range of several runs, and the energy error of the run that was measured.

use rebond::internals::{
    physics::{CollisionCount, Engine},
    recording::{Header, RecordedEvent, RunEnd, SceneText, Writer},
    replay, scene,
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

/// A scene of unit boxes between walls that fill a tenth of the area.
fn gas(bodies: usize) -> scene::Scene {
    let side = (bodies as f64 * 10.0).sqrt();
    let text = format!(
        "[world]\nsize = [{side}, {side}]\nwalls = true\n[run]\nrate = 60\nsteps = 100\nsolver = \"handout\"\n\
         [[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {side}, {side}]\nsize = [[1.0, 1.0], [1.0, 1.0]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    );
    scene::parse("gas.toml", &text).expect("a scene")
}

/// Returns the engine at its first state and the events applied to it.
fn start(scene: &scene::Scene) -> (Engine, Vec<RecordedEvent>) {
    let mut run = replay::Run::new(scene);
    let events = run.apply_inputs(Vec::new(), |error| Err(error.into())).expect("a scene's own events");
    (run.engine().clone(), events)
}

/// Returns median and range of `RUNS` measurements after one warm-up.
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
    let (engine, _) = start(&gas(bodies));
    let steps = [20_000, 2_000, 60][bodies.ilog10() as usize - 1];
    let energy = engine.world().kinetic_energy();
    let mut drift = 0.0;
    let cost = measure(|| {
        let mut engine = engine.clone();
        let elapsed = nanoseconds(|| {
            for _ in 0..steps {
                engine.step(&mut CollisionCount::default()).expect("finite numbers");
            }
        });
        drift = engine.world().kinetic_energy() / energy - 1.0;
        elapsed / (steps * bodies) as f64
    });
    println!("{bodies:6}   {cost:22} {drift:+.1e} in {steps} steps");
}

fn recording(bodies: usize) {
    let scene = gas(bodies);
    let steps = 120;
    let (engine, events) = start(&scene);
    let mut states = vec![engine];
    for _ in 0..steps {
        let mut engine = states[states.len() - 1].clone();
        engine.step(&mut CollisionCount::default()).expect("finite numbers");
        states.push(engine);
    }
    let text = SceneText { file_name: "gas.toml".into(), text: scene.source.text.clone() };
    let header = Header::new(replay::engine_config(&scene), steps, text);
    let mut bytes = 0;
    let cost = measure(|| {
        let mut finished = None;
        let elapsed = nanoseconds(|| {
            let mut writer = Writer::new(io::Cursor::new(Vec::new()), &header).expect("memory");
            events.iter().for_each(|event| writer.write_event(event).expect("memory"));
            states.iter().for_each(|engine| writer.write_state(engine).expect("memory"));
            finished = writer.finish(RunEnd::default()).ok();
        });
        bytes = finished.map_or(0, |finished| finished.output.into_inner().len());
        elapsed / (steps as f64 * bodies as f64)
    });
    println!("{bodies:6}   {cost:22} {:.1}", bytes as f64 / (steps as f64 * bodies as f64));
}
