use super::{Budget, Case, Cost, Errors, Expectation, RunSpec};
use crate::physics::{SolverKind, smaller};
use crate::replay::RunError;
use crate::scene::{Action, Scene, SpawnRequest};
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

impl Row {
    /// Runs a case and returns its row, without the cost. A run that exceeds the budget is left out, with a remark.
    ///
    /// # Errors
    /// Returns an error if an input of the scene is invalid.
    pub fn measure_errors(
        case: &Case,
        spec: RunSpec,
        expectation: &Expectation,
        budget: Budget,
    ) -> Result<Row, RunError> {
        let scene = case.scene(spec)?;
        let row = Row {
            family: case.family.clone(),
            scene: case.name.clone(),
            solver: spec.solver.name().into(),
            rate: scene.run.rate,
            bodies: finite_spawns(&scene).count() as u64,
            steps: scene.run.steps - case.from * spec.factor,
            true_collisions: expectation.collisions,
            truth: expectation.source.clone(),
            ..Row::default()
        };
        // The handout solver tests all pairs in every step.
        let pair_tests = (scene.inputs.len() as u64).pow(2) * scene.run.steps;
        if spec.solver == SolverKind::Handout && pair_tests > budget.max_pair_tests() {
            let tests = pair_tests as f64;
            let remark = format!("left out: it tests all pairs in every step, {tests:.0e} tests in all");
            return Ok(Row { remark: Some(remark), ..row });
        }
        let errors = Errors::measure(case, &scene, spec, expectation)?;
        Ok(Row {
            position_error: errors.position,
            energy_drift: errors.energy,
            momentum_drift: errors.momentum,
            worst_overlap: Some(errors.overlap),
            collisions: Some(errors.collisions),
            remark: errors.remark(&case.oracle, expectation.collisions, smallest_side(&scene)),
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

/// The bodies of finite mass spawned at step 0.
fn finite_spawns(scene: &Scene) -> impl Iterator<Item = &SpawnRequest> {
    scene.inputs.iter().filter(|input| input.step == 0).filter_map(|input| match &input.action {
        Action::Spawn(request) if request.blueprint.mass < f64::INFINITY => Some(request),
        Action::Spawn(_) | Action::Wall(_) | Action::Delete { .. } | Action::Click { .. } => None,
    })
}

/// The smallest side of the bodies of finite mass spawned at step 0, m; infinite if there are none.
fn smallest_side(scene: &Scene) -> f64 {
    let sides = finite_spawns(scene).flat_map(|request| request.blueprint.size);
    sides.fold(f64::INFINITY, |least, side| smaller(side, least))
}
