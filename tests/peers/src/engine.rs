//! The engines, and starting a process for each of them.

use crate::{
    box2d,
    drive::{Build, drive},
    edmd,
    job::{Answer, Job},
    ours, rapier,
};
use std::{
    io::Write,
    path::Path,
    process::{Command, Stdio},
};

/// An engine, or a solver or precision of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// The event-driven solver of rebond.
    EventDriven,
    /// The handout solver of rebond.
    Handout,
    /// Rapier in single precision.
    RapierSingle,
    /// Rapier in double precision.
    RapierDouble,
    /// Box2D v3, in single precision.
    Box2d,
    /// Chipmunk through its Python binding.
    Pymunk,
    /// matter-js, in JavaScript.
    Matter,
    /// planck, a port of Box2D v2 to JavaScript.
    Planck,
    /// Event-driven molecular dynamics after Smallenburg (2022), for gases.
    Edmd,
}

impl Engine {
    /// All engines, in the order of the table.
    pub const ALL: [Engine; 9] = [
        Engine::EventDriven,
        Engine::Handout,
        Engine::RapierSingle,
        Engine::RapierDouble,
        Engine::Box2d,
        Engine::Pymunk,
        Engine::Matter,
        Engine::Planck,
        Engine::Edmd,
    ];

    /// The name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Engine::EventDriven => "rebond",
            Engine::Handout => "rebond handout",
            Engine::RapierSingle => "Rapier f32",
            Engine::RapierDouble => "Rapier f64",
            Engine::Box2d => "Box2D",
            Engine::Pymunk => "pymunk",
            Engine::Matter => "matter-js",
            Engine::Planck => "planck",
            Engine::Edmd => "EDMD",
        }
    }

    /// Returns true for the solvers of rebond.
    pub fn is_ours(self) -> bool {
        matches!(self, Engine::EventDriven | Engine::Handout)
    }

    /// Runs the job in this process; `None` if the engine cannot be called from Rust.
    pub fn run_here(self, job: &Job) -> Option<Answer> {
        let (build, version): (Build, String) = match self {
            Engine::EventDriven => (ours::event_driven, locked("rebond")),
            Engine::Handout => (ours::handout, locked("rebond")),
            Engine::RapierSingle => (rapier::single::build, locked("rapier2d")),
            Engine::RapierDouble => (rapier::double::build, locked("rapier2d-f64")),
            Engine::Box2d => (box2d::build, box2d::version()),
            Engine::Edmd => (edmd::build, "of the paper of 2022".to_owned()),
            Engine::Pymunk | Engine::Matter | Engine::Planck => return None,
        };
        Some(drive(job, version, build))
    }

    /// Runs the job in a process of its own, so that engines do not influence each other through memory.
    pub fn run(self, job: &Job) -> Answer {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let node = |script: &str| {
            let mut command = Command::new("node");
            command.arg(folder.join(script));
            command
        };
        let mut command = match self {
            Engine::Pymunk => {
                let mut command = Command::new(folder.join(".venv/bin/python"));
                command.arg(folder.join("chipmunk.py"));
                command
            }
            Engine::Matter => node("matter.mjs"),
            Engine::Planck => node("planck.mjs"),
            _ => {
                let mut command = Command::new(std::env::current_exe().expect("this program"));
                command.args(["engine", self.name()]);
                command
            }
        };
        run_process(&mut command, job).unwrap_or_else(|reason| Answer { refused: Some(reason), ..Answer::default() })
    }
}

/// Writes the job to the standard input of a process and reads its answer.
fn run_process(command: &mut Command, job: &Job) -> Result<Answer, String> {
    let failed = |error: std::io::Error| format!("could not be run: {error}");
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
    let input = serde_json::to_vec(job).expect("plain data");
    child.stdin.take().expect("standard input is piped").write_all(&input).map_err(failed)?;
    let output = child.wait_with_output().map_err(failed)?;
    if !output.status.success() {
        return Err(format!("stopped: {}", output.status));
    }
    serde_json::from_slice(&output.stdout).map_err(|error| format!("gave an invalid answer: {error}"))
}

/// The version of a package in the lock file.
fn locked(package: &str) -> String {
    let wanted = format!("name = \"{package}\"\nversion = \"");
    let (_, after) = include_str!("../Cargo.lock").split_once(&wanted).expect("the package is a dependency");
    after.split('"').next().unwrap_or_default().to_owned()
}
