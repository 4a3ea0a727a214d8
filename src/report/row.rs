use super::case::{Case, Oracle, RunSpec};
use super::{Cost, Errors, Expectation, notes};
use crate::physics::SolverKind;
use crate::run::RunError;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// A row of the report: one scene, one solver, one rate. The comparison with other engines uses the
/// same rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Row {
    /// Scenes of one family share a diagram.
    pub family: String,
    /// Name of the scene.
    pub scene: String,
    /// Name of the solver or of another engine.
    pub solver: String,
    /// Steps per second, Hz.
    pub rate: f64,
    /// Bodies of finite mass at the start.
    pub bodies: u64,
    /// Measured steps of the run.
    pub steps: u64,
    /// Greatest distance of any body from its correct position, m.
    pub position_error: Option<f64>,
    /// Energy gained (at e = 1 also lost), relative to the initial energy.
    pub energy_drift: Option<f64>,
    /// Momentum error, relative to the sum of all m·|v|.
    pub momentum_drift: Option<f64>,
    /// Deepest overlap of two boxes, m.
    pub worst_overlap: Option<f64>,
    /// Number of collisions in the run.
    pub collisions: Option<u64>,
    /// Correct number of collisions.
    pub true_collisions: Option<u64>,
    /// Source of the correct positions and collisions, or the reason why they are unknown.
    pub truth: String,
    /// Processor time per body and step, ns.
    pub ns_per_body_step: Option<f64>,
    /// Minimum and maximum of several runs, ns.
    pub ns_spread: Option<[f64; 2]>,
    /// Collisions per second of processor time.
    pub events_per_second: Option<f64>,
    /// Peak memory of the run, bytes.
    pub peak_bytes: Option<u64>,
    /// Notable errors of the solver on this scene, as text.
    pub remark: Option<String>,
}

/// Runs of the handout solver with more pair tests are left out, except in a full report.
const MAX_PAIRS: u64 = 1_000_000_000;

/// Limit of pair tests in a full report; beyond it a run would take hours.
const MAX_PAIRS_FULL: u64 = 1_000_000_000_000;

/// Returns the reason why a run is left out, or `None` if it is made.
pub fn skip_reason(scene: &Scene, spec: RunSpec, full: bool) -> Option<String> {
    let (limit, tests) = (if full { MAX_PAIRS_FULL } else { MAX_PAIRS }, spec.pair_tests(scene));
    let too_many = spec.solver == SolverKind::Handout && tests > limit;
    too_many.then(|| format!("left out: it tests all pairs in every step, {:.0e} tests in all", tests as f64))
}

impl Row {
    /// Runs a case and returns its row, without the cost.
    ///
    /// # Errors
    /// Returns an error if an input of the scene is invalid.
    pub fn measure_errors(case: &Case, spec: RunSpec, expectation: &Expectation, full: bool) -> Result<Row, RunError> {
        let scene = case.scene(spec)?;
        let row = Row {
            family: case.family.clone(),
            scene: case.name.clone(),
            solver: spec.solver.name().into(),
            rate: scene.run.rate,
            bodies: notes::finite(&scene).count() as u64,
            steps: scene.run.steps - case.from * spec.factor,
            true_collisions: expectation.collisions,
            truth: expectation.source.clone(),
            ..Row::default()
        };
        if let Some(reason) = skip_reason(&scene, spec, full) {
            return Ok(Row { remark: Some(reason), ..row });
        }
        let errors = Errors::measure(case, &scene, spec, expectation)?;
        let must_fail = matches!(case.oracle, Oracle::Error);
        Ok(Row {
            position_error: errors.position,
            energy_drift: errors.energy,
            momentum_drift: errors.momentum,
            worst_overlap: Some(errors.overlap),
            collisions: Some(errors.collisions),
            remark: notes::describe(&errors, must_fail, expectation.collisions, notes::smallest_side(&scene)),
            ..row
        })
    }

    /// Returns true if the run was made.
    pub fn was_run(&self) -> bool {
        self.collisions.is_some()
    }

    /// Adds the cost.
    pub fn with_cost(self, cost: &Cost) -> Row {
        Row {
            ns_per_body_step: Some(cost.ns_per_body_step),
            ns_spread: Some(cost.ns_spread),
            events_per_second: Some(cost.events_per_second),
            peak_bytes: cost.peak_bytes,
            ..self
        }
    }
}
