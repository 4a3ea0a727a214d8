use super::case::{Case, RunSpec, SceneRunner};
use super::{clock::processor_seconds, memory};
use crate::physics::CollisionCount;
use crate::run::RunError;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// The cost of one run, measured without recording or reading states.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Processor time per body of finite mass and step, ns; the median of several runs.
    pub ns_per_body_step: f64,
    /// Minimum and maximum of these runs, ns.
    pub ns_spread: [f64; 2],
    /// Collisions per second of processor time.
    pub events_per_second: f64,
    /// Peak memory of the run above that of the process before it, bytes; `None` where the system
    /// does not report it.
    pub peak_bytes: Option<u64>,
}

/// A run is repeated at least `MIN_RUNS` times and for at least `MIN_SECONDS` of processor time; no
/// run is started after `MAX_SECONDS`.
const MIN_RUNS: usize = 5;
const MIN_SECONDS: f64 = 0.1;
const MAX_SECONDS: f64 = 1.5;

impl Cost {
    /// Measures a run. If it ends in an error, the part up to the error is measured.
    ///
    /// # Errors
    /// Returns an error if an input of the scene is invalid.
    pub fn measure(case: &Case, scene: &Scene, spec: RunSpec) -> Result<Cost, RunError> {
        let before = memory::reset_peak();
        let mut start = SceneRunner::new(scene);
        start.apply_inputs()?;
        let _ = start.advance_to(case.from * spec.factor, &mut CollisionCount::default())?;
        // The first run warms the caches and determines the peak memory.
        let first = TimedRun::measure(start.clone(), scene.run.steps)?;
        let peak_bytes = before.zip(memory::peak()).map(|(before, peak)| peak.saturating_sub(before));
        let mut runs = if first.seconds > MAX_SECONDS { vec![first] } else { Vec::new() };
        while !is_enough(&runs) {
            runs.push(TimedRun::measure(start.clone(), scene.run.steps)?);
        }
        runs.sort_by(|a, b| a.nanoseconds().total_cmp(&b.nanoseconds()));
        let median = runs[runs.len() / 2];
        Ok(Cost {
            ns_per_body_step: median.nanoseconds(),
            ns_spread: [runs[0], runs[runs.len() - 1]].map(TimedRun::nanoseconds),
            events_per_second: median.events as f64 / median.seconds,
            peak_bytes,
        })
    }
}

fn is_enough(runs: &[TimedRun]) -> bool {
    let seconds: f64 = runs.iter().map(|run| run.seconds).sum();
    (runs.len() >= MIN_RUNS && seconds >= MIN_SECONDS) || seconds > MAX_SECONDS
}

/// One timed run.
#[derive(Clone, Copy)]
struct TimedRun {
    seconds: f64,
    events: u64,
    body_steps: u64,
}

impl TimedRun {
    fn measure(mut runner: SceneRunner, steps: u64) -> Result<TimedRun, RunError> {
        let bodies = runner.world().bodies.iter().filter(|body| !body.is_infinite()).count() as u64;
        let mut collisions = CollisionCount::default();
        let (first, start) = (runner.current_step(), processor_seconds());
        // If the run ends in an error, the time up to the error counts.
        let _ = runner.advance_to(steps, &mut collisions)?;
        let seconds = processor_seconds() - start;
        Ok(TimedRun { seconds, events: collisions.0, body_steps: bodies * (runner.current_step() - first).max(1) })
    }

    fn nanoseconds(self) -> f64 {
        self.seconds * 1e9 / self.body_steps as f64
    }
}
