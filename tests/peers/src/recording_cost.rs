//! The cost of `rebond record` as a whole, to be compared with stepping alone in other engines.

use crate::{clock::children_cpu_seconds, scenes::Scene};
use std::{
    path::Path,
    process::{Command, Stdio},
    time::Instant,
};

/// The cost of recording a scene, including the start of the program.
#[derive(Clone, Debug)]
pub struct RecordingCost {
    /// The name of the scene.
    pub scene: String,
    /// Processor time of all its threads, s.
    pub cpu: f64,
    /// Wall-clock time, s.
    pub wall: f64,
    /// Size of the recording, bytes.
    pub bytes: u64,
}

/// Records the scene three times with `program` and returns the run with the median processor time.
pub fn measure(program: &Path, scene: &Scene, folder: &Path) -> RecordingCost {
    let [source, target] = ["scene.toml", "scene.mcap"].map(|name| folder.join(name));
    std::fs::write(&source, &scene.toml).expect("a temporary folder");
    let mut all: Vec<RecordingCost> = (0..3)
        .map(|_| {
            let start = children_cpu_seconds();
            let clock = Instant::now();
            let mut command = Command::new(program);
            command.arg("record").arg(&source).arg("-o").arg(&target).arg("--force").stderr(Stdio::null());
            let status = command.stdout(Stdio::null()).status().expect("rebond is built");
            assert!(status.success(), "rebond record failed");
            let bytes = std::fs::metadata(&target).expect("it was written").len();
            let wall = clock.elapsed().as_secs_f64();
            RecordingCost { scene: scene.name.clone(), cpu: children_cpu_seconds() - start, wall, bytes }
        })
        .collect();
    all.sort_by(|a, b| a.cpu.total_cmp(&b.cpu));
    all.swap_remove(1)
}
