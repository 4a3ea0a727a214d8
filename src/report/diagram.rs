//! Diagrams of the report: error against cost, and growth of cost.

use super::{Row, cases};
use crate::picture::figures::{Curve, Diagram, Point};

/// An error of a row, and the label of its axis as markup.
type Measure = (fn(&Row) -> Option<f64>, &'static str);

/// The errors that a diagram can show, in order of preference.
const MEASURES: [Measure; 3] = [
    (|row| row.position_error, "\"position error / m\""),
    (|row| row.worst_overlap, "\"worst overlap / m\""),
    (|row| row.energy_drift, "\"energy drift\""),
];

/// Returns a work–precision diagram for each family of scenes: error against cost, with a curve for
/// each solver and scene and a point for each rate.
///
/// Cost is processor time per body and simulated second, so that rates can be compared. The error is
/// that of positions if they are known, else overlap, else energy. Families without any error have
/// no diagram.
pub fn work_precision(rows: &[Row]) -> Vec<Diagram> {
    let families = rows.chunk_by(|a, b| a.family == b.family);
    families.filter_map(family).collect()
}

fn family(rows: &[Row]) -> Option<Diagram> {
    let has_errors = |(error, _): &&Measure| rows.iter().any(|row| error(row) > Some(0.0));
    let (error, y) = *MEASURES.iter().find(has_errors)?;
    let scenes = rows.chunk_by(|a, b| a.scene == b.scene).count();
    let curves = rows.chunk_by(|a, b| (&a.scene, &a.solver) == (&b.scene, &b.solver));
    let mut labelled: Vec<String> = Vec::new();
    let curve = |rows: &[Row]| {
        let first = &rows[0];
        // Rates are written at the first curve of each solver; other curves have the same order.
        let is_labelled = !labelled.contains(&first.solver);
        labelled.push(first.solver.clone());
        let point = |row: &Row| {
            let x = row.ns_per_body_step? * row.rate;
            let label = if is_labelled { format!("{} Hz", row.rate) } else { String::new() };
            Some(Point { x, y: error(row)?, label })
        };
        let label = if scenes > 1 { first.scene.clone() } else { String::new() };
        Curve { name: first.solver.clone(), label, points: rows.iter().filter_map(point).collect() }
    };
    let curves: Vec<Curve> = curves.map(curve).filter(|curve| !curve.points.is_empty()).collect();
    let title = rows[0].family.clone();
    let x = "\"ns per body and simulated second\"".to_owned();
    (!curves.is_empty()).then(|| Diagram { title, x, y: y.to_owned(), curves })
}

/// A quantity of a row, and the label of its axis.
struct Quantity {
    name: &'static str,
    of: fn(&Row) -> Option<f64>,
}

const BODIES: Quantity = Quantity { name: "bodies", of: |row| Some(row.bodies as f64) };
const STEPS: Quantity = Quantity { name: "steps", of: |row| Some(row.steps as f64) };
const TIME: Quantity = Quantity { name: "ns per body and step", of: |row| row.ns_per_body_step };
const RATE: Quantity = Quantity { name: "collisions per second", of: |row| row.events_per_second };
const POSITION: Quantity = Quantity { name: "position error / m", of: |row| row.position_error };
const MEMORY: Quantity = Quantity {
    name: "bytes per body",
    of: |row| row.peak_bytes.filter(|&bytes| bytes > 0).map(|bytes| bytes as f64 / row.bodies as f64),
};

/// Returns diagrams of the growth of time and memory with the number of bodies, and of error and time
/// with the number of steps.
pub fn growth(rows: &[Row]) -> Vec<Diagram> {
    let [bodies, steps] = cases::GROWTH;
    let all = [
        (bodies, "time", [BODIES, TIME]),
        (bodies, "memory", [BODIES, MEMORY]),
        (bodies, "collisions", [BODIES, RATE]),
        (steps, "time of a bounce", [STEPS, TIME]),
        (steps, "error of a bounce", [STEPS, POSITION]),
    ];
    let drawn = all.into_iter().map(|(family, title, axes)| growth_diagram(rows, family, title, &axes));
    drawn.filter(|diagram| !diagram.curves.is_empty()).collect()
}

/// Returns a diagram of one quantity of a family against another, with a curve for each solver.
fn growth_diagram(rows: &[Row], family: &str, title: &str, [horizontal, vertical]: &[Quantity; 2]) -> Diagram {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows.iter().filter(|row| row.family == family) {
        let (Some(x), Some(y)) = ((horizontal.of)(row), (vertical.of)(row)) else { continue };
        let point = Point { x, y, label: String::new() };
        match curves.iter_mut().find(|curve| curve.name == row.solver) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve { name: row.solver.clone(), label: String::new(), points: vec![point] }),
        }
    }
    let [x, y] = [horizontal, vertical].map(|quantity| format!("\"{}\"", quantity.name));
    Diagram { title: title.to_owned(), x, y, curves }
}
