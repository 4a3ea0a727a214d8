//! Measures the cost of recording on the thread that steps a gas: `cargo bench --bench recording`
//!
//! The gas is stepped as in a real run. Only the calls of the writer are timed; the compression that remains at
//! the end of the run is reported separately.

use rebond::internals::{
    physics::{CollisionCount, Engine},
    recording::{Header, RecordedEvent, RunEnd, SceneText, Writer},
    replay, scene,
};
use std::{
    io,
    time::{Duration, Instant},
};

const BODIES: u64 = 10_000;
const STEPS: u64 = 240;
const RUNS: usize = 5;

fn main() {
    let scene = gas();
    println!("{BODIES} boxes, event-driven solver, 60 Hz, {STEPS} steps; ns and bytes per body-step");
    println!("{:16} {:>9} {:>18} {:>14} {:>8}", "recorded", "stepping", "recording", "at the end", "bytes");
    for (name, every) in [("every state", 1), ("every 10th", 10), ("events only", u64::MAX)] {
        let mut costs: Vec<Cost> = (0..RUNS).map(|_| record(&scene, every)).collect();
        costs.sort_by(|a, b| a.recording.total_cmp(&b.recording));
        let Cost { stepping, recording, finishing, bytes } = costs[RUNS / 2];
        let spread = format!("{recording:.1} ({:.1}–{:.1})", costs[0].recording, costs[RUNS - 1].recording);
        println!("{name:16} {stepping:>9.1} {spread:>18} {finishing:>14.1} {bytes:>8.2}");
    }
}

/// Costs per body-step in ns, size per body-step in bytes.
#[derive(Clone, Copy)]
struct Cost {
    stepping: f64,
    recording: f64,
    finishing: f64,
    bytes: f64,
}

/// Small boxes between walls that fill a twentieth of the area, with about one collision per box and second.
fn gas() -> scene::Scene {
    let text = format!(
        "[world]\nsize = [100.0, 100.0]\nwalls = true\n[run]\nrate = 60\nsteps = {STEPS}\nsolver = \"event-driven\"\n\
         [[scatter]]\ncount = {BODIES}\nseed = 1\nregion = [0.0, 0.0, 100.0, 100.0]\n\
         size = [[0.2, 0.2], [0.25, 0.25]]\nmass = [1.0, 2.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    );
    scene::parse("gas.toml", &text).expect("a scene")
}

fn start(scene: &scene::Scene) -> (Engine, Vec<RecordedEvent>) {
    let mut run = replay::Run::new(scene);
    let events = run.apply_inputs(Vec::new(), |error| Err(error.into())).expect("a scene's own events");
    (run.engine().clone(), events)
}

fn record(scene: &scene::Scene, every: u64) -> Cost {
    let (mut engine, events) = start(scene);
    let mut writer = Writer::new(io::Cursor::new(Vec::new()), &header(scene, every)).expect("memory");
    let [mut stepping, mut recording] = [Duration::ZERO; 2];
    recording += time(|| events.iter().for_each(|event| writer.write_event(event).expect("memory")));
    for _ in 0..STEPS {
        recording += time(|| writer.write_state(&engine).expect("memory"));
        stepping += time(|| engine.step(&mut CollisionCount::default()).expect("finite numbers"));
    }
    let mut bytes = 0;
    let finishing = time(|| {
        let finished = writer.finish(RunEnd::default()).expect("memory");
        bytes = finished.output.into_inner().len();
    });
    let per_body_step = |duration: Duration| duration.as_secs_f64() * 1e9 / (STEPS * BODIES) as f64;
    let bytes = bytes as f64 / (STEPS * BODIES) as f64;
    Cost {
        stepping: per_body_step(stepping),
        recording: per_body_step(recording),
        finishing: per_body_step(finishing),
        bytes,
    }
}

fn time(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

fn header(scene: &scene::Scene, every: u64) -> Header {
    let text = SceneText { file_name: "gas.toml".into(), text: scene.source.text.clone() };
    Header::new(replay::engine_config(scene), STEPS, text).with_every(every)
}
