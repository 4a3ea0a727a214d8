//! `rebond record` from end to end, to be held against the bare stepping of others.

use crate::{clock::children_cpu_seconds, scenes::Scene};
use std::{
    path::Path,
    process::{Command, Stdio},
    time::Instant,
};

/// What recording a scene took, start of the program included.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// What the table calls the scene.
    pub scene: String,
    /// Processor time of all its threads, s.
    pub cpu: f64,
    /// Time on the clock, s.
    pub wall: f64,
    /// Size of the recording, bytes.
    pub bytes: u64,
}

/// The middle one of three recordings by `program`, by processor time.
pub fn record(program: &Path, scene: &Scene, folder: &Path) -> Recorded {
    let [source, target] = ["scene.toml", "scene.mcap"].map(|name| folder.join(name));
    std::fs::write(&source, &scene.toml).expect("a temporary folder");
    let mut all: Vec<Recorded> = (0..3)
        .map(|_| {
            let [cpu, start] = [children_cpu_seconds(), 0.0];
            let clock = Instant::now();
            let mut command = Command::new(program);
            command.arg("record").arg(&source).arg("-o").arg(&target).arg("--force").stderr(Stdio::null());
            let status = command.stdout(Stdio::null()).status().expect("rebond is built");
            assert!(status.success(), "rebond record failed");
            let bytes = std::fs::metadata(&target).expect("it was written").len();
            let wall = clock.elapsed().as_secs_f64();
            Recorded { scene: scene.name.clone(), cpu: children_cpu_seconds() - cpu - start, wall, bytes }
        })
        .collect();
    all.sort_by(|one, other| one.cpu.total_cmp(&other.cpu));
    all.swap_remove(1)
}
