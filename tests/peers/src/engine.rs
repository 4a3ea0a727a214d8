//! The engines, and how the process of each is started.

use crate::{
    box2d,
    drive::{Build, drive},
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
    /// rebond's exact solver.
    EventDriven,
    /// rebond's teaching reference.
    Handout,
    /// Rapier in 32 bits.
    RapierSingle,
    /// Rapier in 64 bits.
    RapierDouble,
    /// Box2D v3, in 32 bits.
    Box2d,
    /// Chipmunk by its Python binding.
    Pymunk,
    /// In JavaScript.
    Matter,
    /// Box2D v2 in JavaScript.
    Planck,
}

impl Engine {
    /// In the order of the table.
    pub const ALL: [Engine; 8] = [
        Engine::EventDriven,
        Engine::Handout,
        Engine::RapierSingle,
        Engine::RapierDouble,
        Engine::Box2d,
        Engine::Pymunk,
        Engine::Matter,
        Engine::Planck,
    ];

    /// What the table calls it.
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
        }
    }

    /// Whether it is rebond.
    pub fn is_ours(self) -> bool {
        matches!(self, Engine::EventDriven | Engine::Handout)
    }

    /// Runs the job in this process, if the engine can be called from Rust.
    pub fn run_here(self, job: &Job) -> Option<Answer> {
        let (build, version): (Build, String) = match self {
            Engine::EventDriven => (ours::event_driven, locked("rebond")),
            Engine::Handout => (ours::handout, locked("rebond")),
            Engine::RapierSingle => (rapier::single::build, locked("rapier2d")),
            Engine::RapierDouble => (rapier::double::build, locked("rapier2d-f64")),
            Engine::Box2d => (box2d::build, box2d::version()),
            Engine::Pymunk | Engine::Matter | Engine::Planck => return None,
        };
        Some(drive(job, version, build))
    }

    /// Runs the job in a process of its own, so that no engine finds another's memory or heat.
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
        answer(&mut command, job).unwrap_or_else(|reason| Answer { refused: Some(reason), ..Answer::default() })
    }
}

fn answer(command: &mut Command, job: &Job) -> Result<Answer, String> {
    let failed = |error: std::io::Error| format!("could not be run: {error}");
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
    let question = serde_json::to_vec(job).expect("plain data");
    child.stdin.take().expect("it is piped").write_all(&question).map_err(failed)?;
    let output = child.wait_with_output().map_err(failed)?;
    if !output.status.success() {
        return Err(format!("stopped: {}", output.status));
    }
    serde_json::from_slice(&output.stdout).map_err(|error| format!("answered what is not understood: {error}"))
}

/// The version of a package in the lock file.
fn locked(package: &str) -> String {
    let wanted = format!("name = \"{package}\"\nversion = \"");
    let (_, after) = include_str!("../Cargo.lock").split_once(&wanted).expect("it is a dependency");
    after.split('"').next().unwrap_or_default().to_owned()
}
