use super::arguments::ReportOptions;
use super::error::CommandError;
use super::shard::Shard;
use super::{Exit, output, progress};
use crate::figure::{self, DiagramOptions};
use crate::illustration::Format;
use crate::render::Metadata;
use crate::report::{self, Case, Cost, Expectation, Row, Trial, cases};
use crate::scene::{self, Theme};
use indicatif::ProgressBar;
use std::{env, fs, path::Path, process::Command};

/// Measures errors and costs, and shows them.
pub fn run(options: &ReportOptions) -> Result<Exit, CommandError> {
    if let Some(number) = options.cost_of {
        return cost_alone(&all_cases(options)?, number);
    }
    let format = options.plot.as_deref().map(|path| plot_format(path, options.force)).transpose()?;
    let rows = if options.read.is_empty() { measured(options)? } else { read(options)? };
    if let (Some(path), Some(format)) = (&options.plot, format) {
        plot(&rows, path, format, options)?;
    }
    let text = match (options.json, options.csv) {
        (true, _) => serde_json::to_string_pretty(&rows).expect("plain values with text for keys") + "\n",
        (false, true) => heading(options.shard).to_owned() + &report::csv(&rows),
        (false, false) => report::table(&rows),
    };
    output::print(text.as_bytes())?;
    Ok(Exit::Done)
}

/// The format of a diagram, refused before all the work.
fn plot_format(path: &Path, force: bool) -> Result<Format, CommandError> {
    output::refuse_existing(path, force)?;
    match Format::of_name(path).filter(|format| !format.is_animated()) {
        Some(format) => Ok(format),
        None => Err(CommandError::UnknownKind { path: path.into(), expected: "a diagram is F.png, F.svg or F.pdf" }),
    }
}

/// Draws the rows: errors against costs, or costs against numbers of bodies and steps.
fn plot(rows: &[Row], path: &Path, format: Format, options: &ReportOptions) -> Result<(), CommandError> {
    let is_growth = |row: &Row| cases::GROWTH.contains(&row.family.as_str());
    let diagrams = if rows.iter().any(is_growth) { report::growth(rows) } else { report::work_precision(rows) };
    let (theme, caption) = (options.theme.unwrap_or(Theme::Light), options.caption.clone().unwrap_or_default());
    let list = figure::diagrams(&diagrams, &DiagramOptions { size: options.size, theme, caption });
    let entries = vec![("Software".to_owned(), concat!("rebond ", env!("CARGO_PKG_VERSION")).to_owned())];
    output::write_file(path, options.force, |file| Ok(format.write(&list, &Metadata { entries }, file)?))
}

/// Only the first of several parts has one, so that they join.
fn heading(shard: Shard) -> &'static str {
    if shard.number == 1 { report::HEADING } else { "" }
}

/// All cases that could be asked for, in the order by which processes of their own know them.
fn all_cases(options: &ReportOptions) -> Result<Vec<Case>, CommandError> {
    if options.growth {
        return Ok(cases::growth());
    }
    if options.scenes.is_empty() {
        return Ok(cases::all(options.full));
    }
    let own = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        Ok(Case::of_scene(&name, &scene::load(path)?))
    };
    options.scenes.iter().map(own).collect()
}

/// One run of a case, and its number among the runs of all cases.
struct Cell<'a> {
    case: &'a Case,
    trial: Trial,
    number: usize,
}

/// The runs of all cases, case by case.
fn cells(cases: &[Case]) -> Vec<Vec<Cell<'_>>> {
    let mut numbers = 0..;
    let cell = |case| move |(trial, number)| Cell { case, trial, number };
    cases.iter().map(|case| case.trials().into_iter().zip(numbers.by_ref()).map(cell(case)).collect()).collect()
}

/// The cases asked for, and the part of them that is this one's.
fn chosen<'a>(cells: Vec<Vec<Cell<'a>>>, options: &ReportOptions) -> Result<Vec<Vec<Cell<'a>>>, CommandError> {
    let mut known: Vec<String> = cells.iter().flatten().map(|cell| cell.case.family.clone()).collect();
    known.dedup();
    if let Some(name) = options.only.iter().find(|name| !known.contains(name)) {
        return Err(CommandError::NoFamily { name: name.clone(), known: known.join(", ") });
    }
    let asked = |cells: &Vec<Cell>| {
        options.only.is_empty() || cells.iter().any(|cell| options.only.contains(&cell.case.family))
    };
    let all: Vec<Vec<Cell>> = cells.into_iter().filter(asked).collect();
    let part = options.shard.range(all.len());
    Ok(all.into_iter().skip(part.start).take(part.len()).collect())
}

fn measured(options: &ReportOptions) -> Result<Vec<Row>, CommandError> {
    let cases = all_cases(options)?;
    let chosen = chosen(cells(&cases), options)?;
    let bar = progress::bar("measuring", chosen.iter().map(Vec::len).sum::<usize>() as u64);
    let mut rows = Vec::new();
    for cells in &chosen {
        rows.extend(block(cells, options, &bar)?);
    }
    bar.finish_and_clear();
    Ok(rows)
}

/// All runs of one case.
fn block(cells: &[Cell], options: &ReportOptions, bar: &ProgressBar) -> Result<Vec<Row>, CommandError> {
    let Some(first) = cells.first() else { return Ok(Vec::new()) };
    let expectation = Expectation::of(first.case);
    let mut rows = Vec::new();
    for cell in cells {
        let row = Row::of(cell.case, cell.trial, &expectation, options.full)?;
        let row = if row.was_run() { row.with(&cost(cell, options)?) } else { row };
        rows.push(row);
        bar.inc(1);
    }
    Ok(rows)
}

/// What a run costs, found by a process of its own, whose memory nothing else has touched.
fn cost(cell: &Cell, options: &ReportOptions) -> Result<Cost, CommandError> {
    let failed = |reason: String| CommandError::NoCost { scene: cell.case.name.clone(), reason };
    let program = env::current_exe().map_err(|error| failed(error.to_string()))?;
    let mut command = Command::new(program);
    command.arg("report").arg("--cost-of").arg(cell.number.to_string());
    command.args(options.full.then_some("--full")).args(options.growth.then_some("--growth"));
    let result = command.arg("--").args(&options.scenes).output().map_err(|error| failed(error.to_string()))?;
    match serde_json::from_slice(&result.stdout) {
        Ok(cost) if result.status.success() => Ok(cost),
        Ok(_) | Err(_) => Err(failed(String::from_utf8_lossy(&result.stderr).trim().to_owned())),
    }
}

/// What such a process does.
fn cost_alone(cases: &[Case], number: usize) -> Result<Exit, CommandError> {
    let cells = cells(cases);
    let Some(cell) = cells.iter().flatten().find(|cell| cell.number == number) else { return Ok(Exit::Error) };
    let scene = cell.case.scene(cell.trial)?;
    let cost = Cost::of(cell.case, &scene, cell.trial)?;
    output::print(serde_json::to_string(&cost).expect("plain values with text for keys").as_bytes())?;
    Ok(Exit::Done)
}

/// Rows that were measured before.
fn read(options: &ReportOptions) -> Result<Vec<Row>, CommandError> {
    let rows = |path: &Path| -> Result<Vec<Row>, CommandError> {
        let text = fs::read(path).map_err(|source| CommandError::Unreadable { path: path.into(), source })?;
        serde_json::from_slice(&text).map_err(|source| CommandError::NoReport { path: path.into(), source })
    };
    let mut all = Vec::new();
    for path in &options.read {
        all.extend(rows(path)?);
    }
    all.retain(|row| options.only.is_empty() || options.only.contains(&row.family));
    Ok(all)
}
