//! What a process that runs one engine is told and answers, one line of JSON each way.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// One scene at one rate, the same for every engine.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Job {
    /// Steps a second.
    pub rate: f64,
    /// m/s², y down.
    pub gravity: [f64; 2],
    /// e of every pair.
    pub restitution: f64,
    /// Whether bodies may be put to sleep, as each engine does by default.
    pub sleep: bool,
    /// In rebond's creation order.
    pub bodies: Vec<Body>,
    /// How many steps are timed together, one part after the other.
    pub phases: Vec<u64>,
    /// Every how many steps the bodies are looked at, when nothing is timed.
    pub sample_every: u64,
    /// Where the samples go: for each sample and body x, y, vx, vy, as little-endian f64.
    pub samples: PathBuf,
    /// Processor time after which a pass is given up, s.
    pub limit: f64,
    /// The scene as rebond reads it.
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
    /// kg; none if infinite.
    pub mass: Option<f64>,
    /// m/s.
    pub vx: f64,
    /// m/s.
    pub vy: f64,
    /// Whether it is swept against bodies that move, too, where the engine can.
    pub bullet: bool,
}

impl Job {
    /// Steps of all phases.
    pub fn steps(&self) -> u64 {
        self.phases.iter().sum()
    }
}

/// What an engine made of a [`Job`].
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Answer {
    /// Of the engine, as it says itself.
    pub version: String,
    /// Why the engine cannot run the scene, if it cannot.
    pub refused: Option<String>,
    /// Steps done before the limit, or all.
    pub steps: u64,
    /// For each repeat the processor time of each phase, s.
    pub seconds: Vec<Vec<f64>>,
    /// Collisions, where the engine counts them.
    pub collisions: Option<u64>,
}
