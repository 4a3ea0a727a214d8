//! Input and output of a process that runs one engine, as one line of JSON each.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// One scene at one rate, the same for every engine.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Job {
    /// Steps per second.
    pub rate: f64,
    /// m/s², y down.
    pub gravity: [f64; 2],
    /// The coefficient of restitution of every pair.
    pub restitution: f64,
    /// True if bodies may sleep, with the settings that each engine has by default.
    pub sleep: bool,
    /// The bodies in the creation order of rebond.
    pub bodies: Vec<Body>,
    /// The number of steps of each phase; phases are timed separately.
    pub phases: Vec<u64>,
    /// The number of steps from one sample to the next; no samples are taken while timing.
    pub sample_every: u64,
    /// The file of the samples: for each sample and body x, y, vx, vy as little-endian `f64`.
    pub samples: PathBuf,
    /// Processor time after which a run is stopped, s.
    pub limit: f64,
    /// The scene as TOML.
    pub toml: String,
}

/// A box as it is spawned.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub struct Body {
    /// Upper-left corner, m.
    pub x: f64,
    /// m.
    pub y: f64,
    /// m.
    pub width: f64,
    /// m.
    pub height: f64,
    /// kg; `None` if infinite.
    pub mass: Option<f64>,
    /// m/s.
    pub vx: f64,
    /// m/s.
    pub vy: f64,
    /// Constant force, N.
    pub fx: f64,
    /// N, y down.
    pub fy: f64,
    /// True if it is also swept against moving bodies, in engines that can.
    pub bullet: bool,
}

impl Job {
    /// The number of steps of all phases.
    pub fn steps(&self) -> u64 {
        self.phases.iter().sum()
    }
}

/// The result of an engine for a [`Job`].
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Answer {
    /// The version that the engine reports.
    pub version: String,
    /// The reason why the engine cannot run the scene; `None` if it can.
    pub refused: Option<String>,
    /// The number of steps completed within the time limit.
    pub steps: u64,
    /// For each repetition the processor time of each phase, s.
    pub seconds: Vec<Vec<f64>>,
    /// The number of collisions, if the engine counts them.
    pub collisions: Option<u64>,
}
