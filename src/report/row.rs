use super::case::{Case, Trial, Truth};
use super::{Cost, Errors, Expectation, remark};
use crate::physics::SolverKind;
use crate::run::RunError;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// A line of the report: one scene, one solver, one rate. Other engines fill in the same.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Row {
    /// Scenes of one family share a diagram.
    pub family: String,
    /// Which scene.
    pub scene: String,
    /// Which solver, or which other engine.
    pub solver: String,
    /// Steps per second, Hz.
    pub rate: f64,
    /// Bodies of finite mass at the start.
    pub bodies: u64,
    /// Steps of the run.
    pub steps: u64,
    /// The greatest distance of any body from where it should be, m.
    pub position_error: Option<f64>,
    /// What energy was gained or, at e = 1, lost, as a part of all there was.
    pub energy_drift: Option<f64>,
    /// Momentum from nowhere, as a part of the sum of all m·|v|.
    pub momentum_drift: Option<f64>,
    /// The deepest overlap, m.
    pub worst_overlap: Option<f64>,
    /// Collisions counted.
    pub collisions: Option<u64>,
    /// Collisions there are.
    pub true_collisions: Option<u64>,
    /// How positions and collisions are known, or why not.
    pub truth: String,
    /// ns of processor time for each body and step.
    pub ns_per_body_step: Option<f64>,
    /// The least and the greatest of several runs, ns.
    pub ns_spread: Option<[f64; 2]>,
    /// Collisions in a second of processor time.
    pub events_per_second: Option<f64>,
    /// Memory the run took, bytes.
    pub peak_bytes: Option<u64>,
    /// What the solver cannot do here, in words.
    pub remark: Option<String>,
}

/// A run of the handout's solver that looks at more pairs than that is left out, but for a full report.
const MOST_PAIRS: u64 = 1_000_000_000;

/// Even a full report leaves out what takes longer than hours.
const MOST_PAIRS_IN_FULL: u64 = 1_000_000_000_000;

/// Why a run is not made, in words; none if it is.
pub fn left_out(scene: &Scene, trial: Trial, full: bool) -> Option<String> {
    let (most, pairs) = (if full { MOST_PAIRS_IN_FULL } else { MOST_PAIRS }, trial.pairs(scene));
    let too_many = trial.solver == SolverKind::Handout && pairs > most;
    too_many.then(|| format!("left out: it looks at all pairs in every step, {:.0e} in all", pairs as f64))
}

impl Row {
    /// The line of a run, its cost still to be measured.
    ///
    /// # Errors
    /// When an input of the scene is refused.
    pub fn of(case: &Case, trial: Trial, expectation: &Expectation, full: bool) -> Result<Row, RunError> {
        let scene = case.scene(trial)?;
        let row = Row {
            family: case.family.clone(),
            scene: case.name.clone(),
            solver: trial.solver.name().into(),
            rate: scene.run.rate,
            bodies: remark::finite(&scene).count() as u64,
            steps: scene.run.steps - case.from * trial.factor,
            true_collisions: expectation.collisions,
            truth: expectation.source.clone(),
            ..Row::default()
        };
        if let Some(why) = left_out(&scene, trial, full) {
            return Ok(Row { remark: Some(why), ..row });
        }
        let errors = Errors::of(case, &scene, trial, expectation)?;
        let must_end = matches!(case.truth, Truth::Crush);
        Ok(Row {
            position_error: errors.position,
            energy_drift: errors.energy,
            momentum_drift: errors.momentum,
            worst_overlap: Some(errors.overlap),
            collisions: Some(errors.collisions),
            remark: remark::of(&errors, must_end, expectation.collisions, remark::smallest_side(&scene)),
            ..row
        })
    }

    /// Whether it was run at all.
    pub fn was_run(&self) -> bool {
        self.collisions.is_some()
    }

    /// The line with its cost.
    pub fn with(self, cost: &Cost) -> Row {
        Row {
            ns_per_body_step: Some(cost.ns_per_body_step),
            ns_spread: Some(cost.ns_spread),
            events_per_second: Some(cost.events_per_second),
            peak_bytes: cost.peak_bytes,
            ..self
        }
    }
}
