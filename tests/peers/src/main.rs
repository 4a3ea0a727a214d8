//! Runs rebond and other engines on the same scenes and writes a table of their errors and costs.
//!
//! `rebond-peers table REBOND [--quick] [--only WORD|WORD…] [--into FOLDER]` prints the table; the script `run` builds
//! everything and calls it. `rebond-peers engine NAME` runs one job from standard input.

// These lints protect the determinism of rebond, which is not needed here.
#![allow(clippy::disallowed_methods)]

mod box2d;
mod clock;
mod drive;
mod edmd;
mod engine;
mod job;
mod judge;
mod machine;
mod oracle;
mod ours;
mod rapier;
mod recording_cost;
mod result;
mod scenes;
mod table;

use engine::Engine;
use job::{Body, Job};
use rebond::internals::replay::Run;
use result::Cell;
use scenes::Scene;
use std::path::{Path, PathBuf};

/// Processor time after which a run of an engine is stopped, s.
const TIME_LIMIT: f64 = 8.0;

/// The number of bodies from which a scene is large.
const LARGE: usize = 60;

/// The number of samples of a large scene.
const SAMPLES: u64 = 30;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["engine", name] => run_one(name),
        ["table", rebond, ref options @ ..] => write_table(Path::new(rebond), options),
        _ => {
            eprintln!("usage: rebond-peers table REBOND [--quick] [--only WORD] [--into FOLDER]");
            std::process::exit(2);
        }
    }
}

/// Runs one job from standard input in this process.
fn run_one(name: &str) {
    let job: Job = serde_json::from_reader(std::io::stdin().lock()).expect("a job");
    let engine = Engine::ALL.into_iter().find(|engine| engine.name() == name).expect("an engine");
    let answer = engine.run_here(&job).expect("an engine that Rust can call");
    println!("{}", serde_json::to_string(&answer).expect("plain data"));
}

fn write_table(rebond: &Path, options: &[&str]) {
    let after = |flag: &str| options.iter().skip_while(|word| **word != flag).nth(1).copied();
    let only = after("--only").unwrap_or_default();
    let quick = options.contains(&"--quick");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let load_at_start = machine::load();
    let scenes: Vec<Scene> =
        scenes::all(quick).into_iter().filter(|scene| only.split('|').any(|word| scene.name.contains(word))).collect();
    let cells: Vec<Cell> = scenes.iter().flat_map(|scene| run_all(scene, folder.path())).collect();
    let recordings: Vec<_> = scenes
        .iter()
        .filter(|scene| scene.rate == 60 && scene.name.starts_with("gas"))
        .map(|scene| recording_cost::measure(rebond, scene, folder.path()))
        .collect();
    let conditions = machine::conditions(load_at_start);
    let text = table::write(&scenes, &cells, &recordings, &conditions);
    if let Some(folder) = after("--into").map(PathBuf::from) {
        let json = table::json(&cells);
        std::fs::write(folder.join("results.json"), json).expect("the folder of the results");
        std::fs::write(folder.join("results.md"), &text.full).expect("the folder of the results");
        std::fs::write(folder.join("results-guide.md"), &text.guide).expect("the folder of the results");
    }
    print!("{}", text.full);
}

/// Runs every engine on one scene, one after the other.
fn run_all(scene: &Scene, folder: &Path) -> Vec<Cell> {
    let job = job(scene, folder.join("samples"));
    let cell = |engine: Engine| {
        eprint!("{} at {} Hz: {} … ", scene.name, scene.rate, engine.name());
        let cell = run(engine, scene, &job);
        match (&cell.remark, cell.ns_per_body_step) {
            (Some(reason), _) => eprintln!("{reason}"),
            (None, cost) => eprintln!("{:.1} ns", cost.unwrap_or_default()),
        }
        cell
    };
    Engine::ALL.into_iter().map(cell).collect()
}

fn run(engine: Engine, scene: &Scene, job: &Job) -> Cell {
    let answer = engine.run(job);
    let bodies = job.bodies.iter().filter(|body| body.mass.is_some()).count();
    let mut cell = Cell {
        family: scene.name.clone(),
        scene: scene.name.clone(),
        solver: engine.name(),
        version: answer.version.clone(),
        rate: scene.rate,
        bodies,
        steps: answer.steps,
        of_steps: job.steps(),
        remark: answer.refused.clone(),
        errors: None,
        ns_per_body_step: None,
        ns_spread: None,
        phases: Vec::new(),
    };
    if answer.refused.is_none() {
        let samples = std::fs::read(&job.samples).expect("the engine wrote them");
        cell.errors = Some(judge::judge(scene.oracle, job, &answer, &samples));
        let cost = result::total_cost(&answer, bodies);
        cell.ns_per_body_step = Some(cost.median);
        cell.ns_spread = Some([cost.least, cost.most]);
        cell.phases = result::phase_costs(&answer, &job.phases, bodies);
    }
    cell
}

/// Marks every second body of finite mass as a bullet. No engine sweeps bullets against each other, so the
/// neighbours of a bullet must not be bullets; all fast bodies are swept against static ones anyway.
fn mark_bullets(bodies: &mut [Body]) {
    bodies.iter_mut().filter(|body| body.mass.is_some()).step_by(2).for_each(|body| body.bullet = true);
}

/// The job for all engines: the bodies that rebond spawns from the scene.
fn job(scene: &Scene, samples: PathBuf) -> Job {
    let parsed = rebond::internals::scene::parse(&scene.name, &scene.toml).unwrap_or_else(|error| panic!("{error}"));
    let mut run = Run::new(&parsed);
    run.apply_inputs(Vec::new(), |error| Err(error.into())).unwrap_or_else(|error| panic!("{error}"));
    let world = run.engine().world();
    let body = |body: &rebond::internals::physics::Body| Body {
        x: body.rect.origin.x,
        y: body.rect.origin.y,
        width: body.rect.width(),
        height: body.rect.height(),
        mass: (!body.is_infinite()).then_some(body.mass),
        vx: body.velocity.x,
        vy: body.velocity.y,
        fx: body.constant_force.x,
        fy: body.constant_force.y,
        bullet: false,
    };
    let mut bodies: Vec<Body> = world.bodies.iter().map(body).collect();
    if scene.oracle.is_fast() {
        mark_bullets(&mut bodies);
    }
    let steps: u64 = scene.phases.iter().sum();
    Job {
        rate: scene.rate as f64,
        gravity: world.gravity.map_or([0.0; 2], |gravity| [gravity.x, gravity.y]),
        restitution: scene.oracle.restitution(),
        sleep: scene.sleep,
        phases: scene.phases.clone(),
        sample_every: if bodies.len() < LARGE { 1 } else { steps / SAMPLES },
        bodies,
        samples,
        limit: TIME_LIMIT,
        toml: scene.toml.clone(),
    }
}
