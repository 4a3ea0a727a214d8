use super::Row;
use crate::counted::counted;

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
    let cells: Vec<Vec<String>> =
        rows.iter().map(|row| COLUMNS.iter().map(|column| (column.cell)(row)).collect()).collect();
    let width = |column: usize| {
        let longest = cells.iter().map(|cells: &Vec<String>| cells[column].chars().count()).max().unwrap_or(0);
        longest.max(COLUMNS[column].title.chars().count())
    };
    let widths: Vec<usize> = (0..COLUMNS.len()).map(width).collect();
    let titles = line(COLUMNS.iter().map(|column| column.title), &widths);
    let mut text = String::new();
    for (block, cells) in blocks(rows, &cells) {
        let first = &block[0];
        let collisions =
            first.true_collisions.map_or(String::new(), |count| format!(", {}", counted(count, "collision")));
        let bodies = counted(first.bodies, "body");
        text += &format!("{}: {bodies}{collisions}; reference: {}\n{titles}", first.scene, first.truth);
        cells.iter().for_each(|cells| text += &line(cells.iter().map(String::as_str), &widths));
        block.iter().for_each(|row| text += &remark(row));
        text += "\n";
    }
    text
}

/// Groups rows and their cells by scene.
fn blocks<'a>(rows: &'a [Row], cells: &'a [Vec<String>]) -> impl Iterator<Item = (&'a [Row], &'a [Vec<String>])> {
    let same = |a: &Row, b: &Row| a.family == b.family && a.scene == b.scene;
    let mut start = 0;
    rows.chunk_by(same).map(move |block| {
        start += block.len();
        (block, &cells[start - block.len()..start])
    })
}

/// Formats a line: the first column left-aligned, numbers right-aligned.
fn line<'a>(cells: impl Iterator<Item = &'a str>, widths: &[usize]) -> String {
    let padded = cells.zip(widths).enumerate().map(|(column, (cell, width))| match column {
        0 => format!("  {cell:width$}"),
        _ => format!("  {cell:>width$}"),
    });
    padded.collect::<String>().trim_end().to_owned() + "\n"
}

fn remark(row: &Row) -> String {
    let line = |remark: &String| format!("  {}, {} Hz: {remark}\n", row.solver, row.rate);
    row.remark.as_ref().map_or(String::new(), line)
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
pub const HEADING: &str = "family,scene,solver,rate,bodies,steps,position_error,energy_drift,momentum_drift,worst_overlap,\
    collisions,true_collisions,truth,ns_per_body_step,ns_least,ns_most,events_per_second,peak_bytes,remark\n";

/// Formats the report as comma-separated values without a header line, so that parts can be joined.
/// Unknown values are empty.
pub fn csv(rows: &[Row]) -> String {
    fn optional<T: ToString>(value: Option<T>) -> String {
        value.map_or(String::new(), |value| value.to_string())
    }
    let row = |row: &Row| {
        let fields = [
            quoted(&row.family),
            quoted(&row.scene),
            quoted(&row.solver),
            row.rate.to_string(),
            row.bodies.to_string(),
            row.steps.to_string(),
            optional(row.position_error),
            optional(row.energy_drift),
            optional(row.momentum_drift),
            optional(row.worst_overlap),
            optional(row.collisions),
            optional(row.true_collisions),
            quoted(&row.truth),
            optional(row.ns_per_body_step),
            optional(row.ns_spread.map(|spread| spread[0])),
            optional(row.ns_spread.map(|spread| spread[1])),
            optional(row.events_per_second),
            optional(row.peak_bytes),
            quoted(row.remark.as_deref().unwrap_or("")),
        ];
        fields.join(",") + "\n"
    };
    rows.iter().map(row).collect()
}

fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
