use super::case::{Case, Course, Trial};
use super::{clock::processor_seconds, memory};
use crate::physics::CollisionCount;
use crate::run::RunError;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// What one run costs, states being neither looked at nor recorded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Processor time for each body of finite mass and step, ns: the median of several runs.
    pub ns_per_body_step: f64,
    /// The least and the greatest of them, ns.
    pub ns_spread: [f64; 2],
    /// Collisions resolved in a second of processor time.
    pub events_per_second: f64,
    /// Memory the run took beyond what there was before it, bytes, where the system tells.
    pub peak_bytes: Option<u64>,
}

/// Runs are repeated at least so often and for at least so long, s; no more begin after a while.
const RUNS: usize = 5;
const LONG: f64 = 0.1;
const TOO_LONG: f64 = 1.5;

impl Cost {
    /// Measures a run that ends well, or the part of it up to its end.
    ///
    /// # Errors
    /// When an input of the scene is refused.
    pub fn of(case: &Case, scene: &Scene, trial: Trial) -> Result<Cost, RunError> {
        let before = memory::begin();
        let mut start = Course::new(scene);
        start.happen()?;
        let _ = start.advance_to(case.from * trial.factor, &mut CollisionCount::default())?;
        // The first run brings all into the processor's caches, and tells what memory it takes.
        let first = Run::of(start.clone(), scene.run.steps)?;
        let peak_bytes = before.zip(memory::most()).map(|(before, most)| most.saturating_sub(before));
        let mut runs = if first.seconds > TOO_LONG { vec![first] } else { Vec::new() };
        while !is_enough(&runs) {
            runs.push(Run::of(start.clone(), scene.run.steps)?);
        }
        runs.sort_by(|a, b| a.nanoseconds().total_cmp(&b.nanoseconds()));
        let median = runs[runs.len() / 2];
        Ok(Cost {
            ns_per_body_step: median.nanoseconds(),
            ns_spread: [runs[0], runs[runs.len() - 1]].map(Run::nanoseconds),
            events_per_second: median.events as f64 / median.seconds,
            peak_bytes,
        })
    }
}

fn is_enough(runs: &[Run]) -> bool {
    let seconds: f64 = runs.iter().map(|run| run.seconds).sum();
    (runs.len() >= RUNS && seconds >= LONG) || seconds > TOO_LONG
}

/// One timed run.
#[derive(Clone, Copy)]
struct Run {
    seconds: f64,
    events: u64,
    body_steps: u64,
}

impl Run {
    fn of(mut course: Course, steps: u64) -> Result<Run, RunError> {
        let bodies = course.world().bodies.iter().filter(|body| !body.is_infinite()).count() as u64;
        let mut collisions = CollisionCount::default();
        let (first, start) = (course.present_step(), processor_seconds());
        // A run that ends in an error has cost what it took until then.
        let _ = course.advance_to(steps, &mut collisions)?;
        let seconds = processor_seconds() - start;
        Ok(Run { seconds, events: collisions.0, body_steps: bodies * (course.present_step() - first).max(1) })
    }

    fn nanoseconds(self) -> f64 {
        self.seconds * 1e9 / self.body_steps as f64
    }
}
