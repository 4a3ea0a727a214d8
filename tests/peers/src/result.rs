//! What is known of one engine on one scene.

use crate::{job::Answer, judge::Errors};
use serde::Serialize;

/// One cell of the table, in the words of a row of `rebond report`.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// What is drawn in one diagram: each scene in its own.
    pub family: String,
    /// What the table calls the scene.
    pub scene: String,
    /// What the table calls the engine.
    pub solver: &'static str,
    /// As the engine says itself.
    pub version: String,
    /// Steps a second.
    pub rate: u64,
    /// That can move.
    pub bodies: usize,
    /// Done, which are fewer than asked for if that took too long.
    pub steps: u64,
    /// That were asked for.
    pub of_steps: u64,
    /// Why there is nothing, if there is not.
    pub remark: Option<String>,
    /// If there is something.
    #[serde(flatten)]
    pub errors: Option<Errors>,
    /// Of all phases together.
    pub ns_per_body_step: Option<f64>,
    /// The least and the most of the repeats, ns.
    pub ns_spread: Option<[f64; 2]>,
    /// Of each phase.
    pub phases: Vec<Cost>,
}

/// Processor time for one body and one step, ns.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// The middle one of the repeats.
    pub median: f64,
    /// The least.
    pub least: f64,
    /// The most.
    pub most: f64,
}

/// What each phase of so many steps cost, as far as it was reached.
pub fn costs(answer: &Answer, phases: &[u64], bodies: usize) -> Vec<Cost> {
    let mut left = answer.steps;
    let mut costs = Vec::new();
    for (place, phase) in phases.iter().enumerate() {
        let steps = left.min(*phase);
        left -= steps;
        if steps > 0 {
            let each = 1e9 / (steps as f64 * bodies as f64);
            costs.push(cost(answer.seconds.iter().map(|seconds| seconds[place] * each).collect()));
        }
    }
    costs
}

fn cost(mut repeats: Vec<f64>) -> Cost {
    repeats.sort_by(f64::total_cmp);
    Cost { median: repeats[repeats.len() / 2], least: repeats[0], most: repeats[repeats.len() - 1] }
}

/// Of all phases together, ns.
pub fn whole_cost(answer: &Answer, bodies: usize) -> Cost {
    let each = 1e9 / (answer.steps as f64 * bodies as f64);
    cost(answer.seconds.iter().map(|seconds| seconds.iter().sum::<f64>() * each).collect())
}
