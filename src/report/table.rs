//! The rows of the report, and the report as text: an aligned table, or comma-separated values.

use super::{Budget, Case, Cost, Errors, Expectation, Growth, RunSpec};
use crate::physics::{SolverKind, smaller};
use crate::replay::RunError;
use crate::scene::{Action, Scene, SpawnRequest};
use crate::text::{counted, csv_field};
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
    /// The part of the run in which rounding does not matter, such as `1e-10 until step 64`; only for scenes of the
    /// user, at their own rate.
    pub accuracy: Option<String>,
    /// How rounding errors grow: pairs of an error, as a fraction of the largest side of a finite body, and the first
    /// step at which it is exceeded.
    pub error_growth: Vec<(f64, u64)>,
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
        let growth = if case.estimates_accuracy && spec.factor == 1 { Growth::estimate(&scene)? } else { None };
        Ok(Row {
            accuracy: growth.as_ref().map(|growth| growth.accuracy.to_string()),
            error_growth: growth.map_or(Vec::new(), |growth| growth.steps),
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

    /// Adds the cost, or a remark that there is none.
    pub fn with_cost(self, cost: Option<&Cost>) -> Row {
        let Some(cost) = cost else {
            let none = "no cost per body and step: no body of finite mass takes a step";
            let remark = self.remark.map_or(none.to_owned(), |remark| format!("{remark}; {none}"));
            return Row { remark: Some(remark), ..self };
        };
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

/// A column: its title, and the text of its cell for a row.
struct Column {
    title: &'static str,
    cell: fn(&Row) -> String,
}

const COLUMNS: [Column; 11] = [
    Column { title: "solver", cell: |row| row.solver.clone() },
    Column { title: "rate, Hz", cell: |row| row.rate.to_string() },
    Column { title: "position, m", cell: |row| error(row.position_error) },
    Column { title: "energy", cell: |row| error(row.energy_drift) },
    Column { title: "momentum", cell: |row| error(row.momentum_drift) },
    Column { title: "overlap, m", cell: |row| error(row.worst_overlap) },
    Column { title: "collisions", cell: |row| row.collisions.map_or("-".into(), |count| count.to_string()) },
    Column { title: "ns/body-step", cell: |row| row.ns_per_body_step.map_or("-".into(), format_significant) },
    Column { title: "min–max", cell: spread },
    Column { title: "events/s", cell: |row| row.events_per_second.map_or("-".into(), |rate| format!("{rate:.1e}")) },
    Column { title: "memory, kB", cell: memory },
];

/// Formats the report as aligned text: a block for each scene, followed by the remarks.
pub fn table(rows: &[Row]) -> String {
    let widths = COLUMNS.each_ref().map(|column| {
        let longest = rows.iter().map(|row| (column.cell)(row).chars().count()).max().unwrap_or(0);
        longest.max(column.title.chars().count())
    });
    let titles = line(COLUMNS.each_ref().map(|column| column.title.to_owned()), widths);
    let mut text = String::new();
    for block in rows.chunk_by(|a, b| a.family == b.family && a.scene == b.scene) {
        let Row { scene, truth, bodies, true_collisions, .. } = &block[0];
        text += &format!("{scene}: {}", counted(*bodies, "body"));
        if let Some(collisions) = true_collisions {
            text += &format!(", {}", counted(*collisions, "collision"));
        }
        text += &format!("; reference: {truth}\n{titles}");
        for row in block {
            text += &line(COLUMNS.each_ref().map(|column| (column.cell)(row)), widths);
        }
        for row in block {
            if let Some(remark) = &row.remark {
                text += &format!("  {}, {} Hz: {remark}\n", row.solver, row.rate);
            }
        }
        for row in block {
            if let Some(accuracy) = &row.accuracy {
                text += &format!("  {}: accuracy {accuracy}, estimated by random rounding\n", row.solver);
                text += &growth_line(&row.error_growth);
            }
        }
        text += "\n";
    }
    text
}

/// Describes how rounding errors grow.
fn growth_line(growth: &[(f64, u64)]) -> String {
    let steps: Vec<String> = growth.iter().map(|(level, step)| format!("{level:e} from step {step}")).collect();
    if steps.is_empty() {
        "    rounding moves no position by more than 1e-28 of the largest box\n".into()
    } else {
        format!("    rounding moves a position by more than this part of the largest box: {}\n", steps.join(", "))
    }
}

/// Formats a line: the first column left-aligned, numbers right-aligned.
fn line<const N: usize>(cells: [String; N], widths: [usize; N]) -> String {
    let padded = cells.iter().zip(widths).enumerate().map(|(column, (cell, width))| match column {
        0 => format!("  {cell:width$}"),
        _ => format!("  {cell:>width$}"),
    });
    padded.collect::<String>().trim_end().to_owned() + "\n"
}

fn error(value: Option<f64>) -> String {
    match value {
        None => "-".into(),
        Some(0.0) => "0".into(),
        Some(value) => format!("{value:.1e}"),
    }
}

fn spread(row: &Row) -> String {
    row.ns_spread.map_or("-".into(), |spread| spread.map(format_significant).join("–"))
}

/// Formats memory in kB. The system counts pages, and some are allocated in advance, so small figures
/// are not meaningful.
fn memory(row: &Row) -> String {
    match row.peak_bytes.map(|bytes| bytes / 1024) {
        None => "-".into(),
        Some(..100) => "<100".into(),
        Some(kilobytes) => kilobytes.to_string(),
    }
}

/// Formats three significant digits.
fn format_significant(value: f64) -> String {
    match value {
        value if value >= 100.0 => format!("{value:.0}"),
        value if value >= 10.0 => format!("{value:.1}"),
        value => format!("{value:.2}"),
    }
}

/// The header line of [`csv`].
pub const CSV_HEADER: &str = "family,scene,solver,rate,bodies,steps,position_error,energy_drift,momentum_drift,\
    worst_overlap,collisions,true_collisions,truth,ns_per_body_step,ns_least,ns_most,events_per_second,peak_bytes,\
    remark,accuracy,error_growth\n";

/// Formats the report as comma-separated values without a header line, so that parts can be joined.
/// Unknown values are empty.
pub fn csv(rows: &[Row]) -> String {
    let mut text = String::new();
    for row in rows {
        let growth: Vec<String> = row.error_growth.iter().map(|(level, step)| format!("{level:e}@{step}")).collect();
        let fields = [
            csv_field(&row.family).into(),
            csv_field(&row.scene).into(),
            csv_field(&row.solver).into(),
            row.rate.to_string(),
            row.bodies.to_string(),
            row.steps.to_string(),
            or_empty(row.position_error),
            or_empty(row.energy_drift),
            or_empty(row.momentum_drift),
            or_empty(row.worst_overlap),
            or_empty(row.collisions),
            or_empty(row.true_collisions),
            csv_field(&row.truth).into(),
            or_empty(row.ns_per_body_step),
            or_empty(row.ns_spread.map(|spread| spread[0])),
            or_empty(row.ns_spread.map(|spread| spread[1])),
            or_empty(row.events_per_second),
            or_empty(row.peak_bytes),
            csv_field(row.remark.as_deref().unwrap_or_default()).into(),
            row.accuracy.clone().unwrap_or_default(),
            growth.join(" "),
        ];
        text += &fields.join(",");
        text += "\n";
    }
    text
}

fn or_empty<T: ToString>(value: Option<T>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}
