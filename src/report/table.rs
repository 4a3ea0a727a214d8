//! The report as text: an aligned table, or comma-separated values.

use super::Row;
use crate::text::{counted, csv_field};

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
        text += "\n";
    }
    text
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
    remark\n";

/// Formats the report as comma-separated values without a header line, so that parts can be joined.
/// Unknown values are empty.
pub fn csv(rows: &[Row]) -> String {
    let mut text = String::new();
    for row in rows {
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
        ];
        text += &fields.join(",");
        text += "\n";
    }
    text
}

fn or_empty<T: ToString>(value: Option<T>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}
