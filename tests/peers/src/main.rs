//! Runs rebond and other engines on the same scenes and writes what accuracy costs in each.
//!
//! `rebond-peers table REBOND [--quick] [--only WORD] [--into FOLDER]` prints the table; `run` beside this package
//! builds all and calls it. `rebond-peers engine NAME` runs one job read from standard input.

// These lints hold rebond to equal bits everywhere, which nothing here promises.
#![allow(clippy::disallowed_methods)]

mod box2d;
mod clock;
mod drive;
mod engine;
mod job;
mod judge;
mod machine;
mod ours;
mod rapier;
mod recorded;
mod result;
mod scenes;
mod table;
mod truth;

use engine::Engine;
use job::{Body, Job};
use rebond::run::Run;
use result::Cell;
use scenes::Scene;
use std::path::{Path, PathBuf};

/// Processor time after which one pass of one engine is given up, s.
const LIMIT: f64 = 8.0;

/// Bodies from which on a scene is large.
const CROWD: usize = 60;

/// How many samples of a large scene are looked at.
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

/// One job from standard input, in this process.
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
    let begin = machine::load();
    let scenes: Vec<Scene> = scenes::all(quick).into_iter().filter(|scene| scene.name.contains(only)).collect();
    let cells: Vec<Cell> = scenes.iter().flat_map(|scene| run_all(scene, folder.path())).collect();
    let recorded: Vec<_> = scenes
        .iter()
        .filter(|scene| scene.rate == 60 && scene.name.starts_with("gas"))
        .map(|scene| recorded::record(rebond, scene, folder.path()))
        .collect();
    let conditions = machine::conditions(begin);
    let text = table::write(&scenes, &cells, &recorded, &conditions);
    if let Some(folder) = after("--into").map(PathBuf::from) {
        let json = table::json(&cells);
        std::fs::write(folder.join("results.json"), json).expect("the folder of the results");
        std::fs::write(folder.join("results.md"), &text.whole).expect("the folder of the results");
        std::fs::write(folder.join("results-readme.md"), &text.readme).expect("the folder of the results");
    }
    print!("{}", text.whole);
}

/// Every engine on one scene, one after the other.
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
        cell.errors = Some(judge::judge(scene.truth, job, &answer, &samples));
        let cost = result::whole_cost(&answer, bodies);
        cell.ns_per_body_step = Some(cost.median);
        cell.ns_spread = Some([cost.least, cost.most]);
        cell.phases = result::costs(&answer, &job.phases, bodies);
    }
    cell
}

/// Every second body in a row of fast ones: no engine sweeps one bullet against another, so that each
/// neighbour of a bullet has to be none. Against what stands still everything fast is swept anyway.
fn mark_bullets(bodies: &mut [Body]) {
    bodies.iter_mut().filter(|body| body.mass.is_some()).step_by(2).for_each(|body| body.bullet = true);
}

/// The numbers all engines are given: what rebond spawns from the scene.
fn job(scene: &Scene, samples: PathBuf) -> Job {
    let parsed = rebond::scene::parse(&scene.name, &scene.toml).unwrap_or_else(|error| panic!("{error}"));
    let mut run = Run::new(&parsed);
    run.happen(Vec::new(), |error| Err(error.into())).unwrap_or_else(|error| panic!("{error}"));
    let world = run.engine().world();
    let body = |body: &rebond::physics::Body| Body {
        x: body.rect.origin.x,
        y: body.rect.origin.y,
        width: body.rect.width(),
        height: body.rect.height(),
        mass: (!body.is_infinite()).then_some(body.mass),
        vx: body.velocity.x,
        vy: body.velocity.y,
        bullet: false,
    };
    let mut bodies: Vec<Body> = world.bodies.iter().map(body).collect();
    if scene.truth.is_fast() {
        mark_bullets(&mut bodies);
    }
    let steps: u64 = scene.phases.iter().sum();
    Job {
        rate: scene.rate as f64,
        gravity: world.gravity.map_or([0.0; 2], |gravity| [gravity.x, gravity.y]),
        restitution: scene.truth.restitution(),
        sleep: scene.sleep,
        phases: scene.phases.clone(),
        sample_every: if bodies.len() < CROWD { 1 } else { steps / SAMPLES },
        bodies,
        samples,
        limit: LIMIT,
        toml: scene.toml.clone(),
    }
}
