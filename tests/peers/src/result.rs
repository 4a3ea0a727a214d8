//! The results of one engine on one scene.

use crate::{job::Answer, judge::Errors};
use serde::Serialize;

/// One cell of the table. The fields have the names of a row of `rebond report`.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// The diagram that shows the result: one for each scene.
    pub family: String,
    /// The name of the scene.
    pub scene: String,
    /// The name of the engine.
    pub solver: &'static str,
    /// The version that the engine reports.
    pub version: String,
    /// Steps per second.
    pub rate: u64,
    /// Bodies of finite mass.
    pub bodies: usize,
    /// Completed steps: fewer than `of_steps` if the time limit was reached.
    pub steps: u64,
    /// Steps of the scene.
    pub of_steps: u64,
    /// The reason why there are no results; `None` if there are.
    pub remark: Option<String>,
    /// The errors, if the scene was run.
    #[serde(flatten)]
    pub errors: Option<Errors>,
    /// Processor time per body and step over all phases, ns.
    pub ns_per_body_step: Option<f64>,
    /// Minimum and maximum over the repetitions, ns.
    pub ns_spread: Option<[f64; 2]>,
    /// The cost of each phase.
    pub phases: Vec<Cost>,
}

/// Processor time per body and step, ns.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// The median over the repetitions.
    pub median: f64,
    /// The minimum.
    pub least: f64,
    /// The maximum.
    pub most: f64,
}

/// The cost of each phase that was reached; `phases` are their numbers of steps.
pub fn phase_costs(answer: &Answer, phases: &[u64], bodies: usize) -> Vec<Cost> {
    let mut left = answer.steps;
    let mut costs = Vec::new();
    for (index, phase) in phases.iter().enumerate() {
        let steps = left.min(*phase);
        left -= steps;
        if steps > 0 {
            let each = 1e9 / (steps as f64 * bodies as f64);
            costs.push(cost(answer.seconds.iter().map(|seconds| seconds[index] * each).collect()));
        }
    }
    costs
}

fn cost(mut repeats: Vec<f64>) -> Cost {
    repeats.sort_by(f64::total_cmp);
    Cost { median: repeats[repeats.len() / 2], least: repeats[0], most: repeats[repeats.len() - 1] }
}

/// The cost of all phases together.
pub fn total_cost(answer: &Answer, bodies: usize) -> Cost {
    let each = 1e9 / (answer.steps as f64 * bodies as f64);
    cost(answer.seconds.iter().map(|seconds| seconds.iter().sum::<f64>() * each).collect())
}
