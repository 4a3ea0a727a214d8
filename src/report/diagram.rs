//! The report as diagrams: what accuracy costs, and how costs grow.

use super::Row;
use crate::figure::{Curve, Diagram, Point};

/// What of a row is an error, and what its scale is called, as markup.
type Measure = (fn(&Row) -> Option<f64>, &'static str);

/// In the order of preference.
const MEASURES: [Measure; 3] = [
    (|row| row.position_error, "\"position error / m\""),
    (|row| row.worst_overlap, "\"worst overlap / m\""),
    (|row| row.energy_drift, "\"energy drift\""),
];

/// A work–precision diagram for each family of scenes: error against cost, a curve for each
/// solver and scene, rates as points.
///
/// Cost is processor time for each body and simulated second, so that rates can be compared. The
/// error is that of positions where they are known, else overlap, else energy. Families that
/// nobody gets wrong have none.
pub fn work_precision(rows: &[Row]) -> Vec<Diagram> {
    let families = rows.chunk_by(|a, b| a.family == b.family);
    families.filter_map(family).collect()
}

fn family(rows: &[Row]) -> Option<Diagram> {
    let tells = |(error, _): &&Measure| rows.iter().any(|row| error(row) > Some(0.0));
    let (error, y) = *MEASURES.iter().find(tells)?;
    let scenes = rows.chunk_by(|a, b| a.scene == b.scene).count();
    let curves = rows.chunk_by(|a, b| (&a.scene, &a.solver) == (&b.scene, &b.solver)).enumerate();
    let curve = |(_, rows): (usize, &[Row])| {
        let first = &rows[0];
        let point = |row: &Row| {
            let x = row.ns_per_body_step? * row.rate;
            Some(Point { x, y: error(row)?, label: format!("{} Hz", row.rate) })
        };
        let label = if scenes > 1 { first.scene.clone() } else { String::new() };
        Curve { name: first.solver.clone(), label, points: rows.iter().filter_map(point).collect() }
    };
    let curves: Vec<Curve> = curves.map(curve).filter(|curve| !curve.points.is_empty()).collect();
    let title = rows[0].family.clone();
    let x = "\"ns for each body and simulated second\"".to_owned();
    (!curves.is_empty()).then(|| Diagram { title, x, y: y.to_owned(), curves })
}

/// How costs grow: time and memory with the number of bodies, error and time with the number of steps.
pub fn growth(rows: &[Row]) -> Vec<Diagram> {
    let bodies = |row: &Row| row.bodies as f64;
    let steps = |row: &Row| row.steps as f64;
    let bytes = |row: &Row| row.peak_bytes.map(|bytes| bytes as f64 / row.bodies as f64);
    [
        grown(rows, "bodies", "time", (&bodies, "bodies"), (&|row| row.ns_per_body_step, "ns for each body and step")),
        grown(rows, "bodies", "memory", (&bodies, "bodies"), (&bytes, "bytes for each body")),
        grown(rows, "bodies", "collisions", (&bodies, "bodies"), (&|row| row.events_per_second, "collisions in a second")),
        grown(rows, "steps", "time of a bounce", (&steps, "steps"), (&|row| row.ns_per_body_step, "ns for each step")),
        grown(rows, "steps", "error of a bounce", (&steps, "steps"), (&|row| row.position_error, "position error / m")),
    ]
    .into()
}

/// One number of the rows of a family against another one.
fn grown(
    rows: &[Row],
    family: &str,
    title: &str,
    (across, x): (&dyn Fn(&Row) -> f64, &str),
    (up, y): (&dyn Fn(&Row) -> Option<f64>, &str),
) -> Diagram {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows.iter().filter(|row| row.family == family) {
        let Some(y) = up(row) else { continue };
        let point = Point { x: across(row), y, label: String::new() };
        match curves.iter_mut().find(|curve| curve.name == row.solver) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve { name: row.solver.clone(), label: String::new(), points: vec![point] }),
        }
    }
    Diagram { title: title.to_owned(), x: format!("\"{x}\""), y: format!("\"{y}\""), curves }
}
