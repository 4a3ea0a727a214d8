//! The report as diagrams: what accuracy costs, and how costs grow.

use super::{Row, cases};
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
    let curves = rows.chunk_by(|a, b| (&a.scene, &a.solver) == (&b.scene, &b.solver));
    let mut told: Vec<String> = Vec::new();
    let curve = |rows: &[Row]| {
        let first = &rows[0];
        // Rates are told once for each solver: the others are in the same order.
        let tells = !told.contains(&first.solver);
        told.push(first.solver.clone());
        let point = |row: &Row| {
            let x = row.ns_per_body_step? * row.rate;
            let label = if tells { format!("{} Hz", row.rate) } else { String::new() };
            Some(Point { x, y: error(row)?, label })
        };
        let label = if scenes > 1 { first.scene.clone() } else { String::new() };
        Curve { name: first.solver.clone(), label, points: rows.iter().filter_map(point).collect() }
    };
    let curves: Vec<Curve> = curves.map(curve).filter(|curve| !curve.points.is_empty()).collect();
    let title = rows[0].family.clone();
    let x = "\"ns for each body and simulated second\"".to_owned();
    (!curves.is_empty()).then(|| Diagram { title, x, y: y.to_owned(), curves })
}

/// A number of a row, and what its scale is called.
struct Quantity {
    name: &'static str,
    of: fn(&Row) -> Option<f64>,
}

const BODIES: Quantity = Quantity { name: "bodies", of: |row| Some(row.bodies as f64) };
const STEPS: Quantity = Quantity { name: "steps", of: |row| Some(row.steps as f64) };
const TIME: Quantity = Quantity { name: "ns for each body and step", of: |row| row.ns_per_body_step };
const RATE: Quantity = Quantity { name: "collisions in a second", of: |row| row.events_per_second };
const POSITION: Quantity = Quantity { name: "position error / m", of: |row| row.position_error };
const MEMORY: Quantity = Quantity {
    name: "bytes for each body",
    of: |row| row.peak_bytes.filter(|&bytes| bytes > 0).map(|bytes| bytes as f64 / row.bodies as f64),
};

/// How costs grow: time and memory with the number of bodies, error and time with the number of steps.
pub fn growth(rows: &[Row]) -> Vec<Diagram> {
    let [bodies, steps] = cases::GROWTH;
    let all = [
        (bodies, "time", [BODIES, TIME]),
        (bodies, "memory", [BODIES, MEMORY]),
        (bodies, "collisions", [BODIES, RATE]),
        (steps, "time of a bounce", [STEPS, TIME]),
        (steps, "error of a bounce", [STEPS, POSITION]),
    ];
    let drawn = all.into_iter().map(|(family, title, axes)| grown(rows, family, title, &axes));
    drawn.filter(|diagram| !diagram.curves.is_empty()).collect()
}

/// One number of the rows of a family against another one, a curve for each solver.
fn grown(rows: &[Row], family: &str, title: &str, [across, up]: &[Quantity; 2]) -> Diagram {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows.iter().filter(|row| row.family == family) {
        let (Some(x), Some(y)) = ((across.of)(row), (up.of)(row)) else { continue };
        let point = Point { x, y, label: String::new() };
        match curves.iter_mut().find(|curve| curve.name == row.solver) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve { name: row.solver.clone(), label: String::new(), points: vec![point] }),
        }
    }
    let [x, y] = [across, up].map(|quantity| format!("\"{}\"", quantity.name));
    Diagram { title: title.to_owned(), x, y, curves }
}
