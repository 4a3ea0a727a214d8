use super::arguments::ReportOptions;
use super::error::CommandError;
use super::shard::Shard;
use super::{Exit, output, progress};
use crate::figure::{self, DiagramOptions};
use crate::picture::Format;
use crate::render::Metadata;
use crate::report::{self, Case, Cost, Expectation, Row, RunSpec, cases};
use crate::scene::{self, Theme};
use indicatif::ProgressBar;
use std::{env, fs, path::Path, process::Command};

/// Measures errors and costs, and prints or draws them.
pub fn run(options: &ReportOptions) -> Result<Exit, CommandError> {
    if let Some(number) = options.cost_of {
        return print_cost_of_run(&all_cases(options)?, number);
    }
    let format = options.plot.as_deref().map(|path| plot_format(path, options.force)).transpose()?;
    let rows = if options.read.is_empty() { measure_rows(options)? } else { read_rows(options)? };
    if let (Some(path), Some(format)) = (&options.plot, format) {
        plot(&rows, path, format, options)?;
    }
    let text = match (options.json, options.csv) {
        (true, _) => serde_json::to_string_pretty(&rows).expect("plain values with text for keys") + "\n",
        (false, true) => csv_header(options.shard).to_owned() + &report::csv(&rows),
        (false, false) => report::table(&rows),
    };
    output::print(text.as_bytes())?;
    Ok(Exit::Done)
}

/// Determines the format of the diagram, and returns an error before any work is done if it cannot be written.
fn plot_format(path: &Path, force: bool) -> Result<Format, CommandError> {
    output::refuse_existing(path, force)?;
    match Format::from_path(path).filter(|format| !format.is_animated()) {
        Some(format) => Ok(format),
        None => Err(CommandError::UnsupportedOutput { path: path.into(), expected: "expected F.png, F.svg or F.pdf" }),
    }
}

/// Draws error against cost, or cost against the number of bodies and steps.
fn plot(rows: &[Row], path: &Path, format: Format, options: &ReportOptions) -> Result<(), CommandError> {
    let is_growth = |row: &Row| cases::GROWTH.contains(&row.family.as_str());
    let diagrams = if rows.iter().any(is_growth) { report::growth(rows) } else { report::work_precision(rows) };
    let (theme, caption) = (options.theme.unwrap_or(Theme::Light), options.caption.clone().unwrap_or_default());
    let list = figure::diagrams(&diagrams, &DiagramOptions { size: options.size, theme, caption });
    let entries = vec![("Software".to_owned(), concat!("rebond ", env!("CARGO_PKG_VERSION")).to_owned())];
    output::write_file(path, options.force, |file| Ok(format.write(&list, &Metadata { entries }, file)?))
}

/// The header of the table. Only the first shard has one, so that the outputs can be concatenated.
fn csv_header(shard: Shard) -> &'static str {
    if shard.number == 1 { report::HEADING } else { "" }
}

/// All cases that the options allow. Their order numbers the runs for `--cost-of`.
fn all_cases(options: &ReportOptions) -> Result<Vec<Case>, CommandError> {
    if options.growth {
        return Ok(cases::growth());
    }
    if options.scenes.is_empty() {
        return Ok(cases::all(options.full));
    }
    let load_case = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        Ok(Case::of_scene(&name, &scene::load(path)?))
    };
    options.scenes.iter().map(load_case).collect()
}

/// One run of a case, and its number among the runs of all cases.
struct CaseRun<'a> {
    case: &'a Case,
    spec: RunSpec,
    number: usize,
}

/// The runs of all cases, grouped by case.
fn case_runs(cases: &[Case]) -> Vec<Vec<CaseRun<'_>>> {
    let mut numbers = 0..;
    let case_run = |case| move |(spec, number)| CaseRun { case, spec, number };
    cases.iter().map(|case| case.run_specs().into_iter().zip(numbers.by_ref()).map(case_run(case)).collect()).collect()
}

/// Selects the requested families, and of these the requested shard.
fn select<'a>(runs: Vec<Vec<CaseRun<'a>>>, options: &ReportOptions) -> Result<Vec<Vec<CaseRun<'a>>>, CommandError> {
    let mut known: Vec<String> = runs.iter().flatten().map(|run| run.case.family.clone()).collect();
    known.dedup();
    if let Some(name) = options.only.iter().find(|name| !known.contains(name)) {
        return Err(CommandError::UnknownFamily { name: name.clone(), known: known.join(", ") });
    }
    let is_requested =
        |runs: &Vec<CaseRun>| options.only.is_empty() || runs.iter().any(|run| options.only.contains(&run.case.family));
    let requested: Vec<Vec<CaseRun>> = runs.into_iter().filter(is_requested).collect();
    let range = options.shard.range(requested.len());
    Ok(requested.into_iter().skip(range.start).take(range.len()).collect())
}

fn measure_rows(options: &ReportOptions) -> Result<Vec<Row>, CommandError> {
    let cases = all_cases(options)?;
    let selected = select(case_runs(&cases), options)?;
    let bar = progress::bar("measuring", selected.iter().map(Vec::len).sum::<usize>() as u64);
    let mut rows = Vec::new();
    for runs in &selected {
        rows.extend(measure_case(runs, options, &bar)?);
    }
    bar.finish_and_clear();
    Ok(rows)
}

/// Measures all runs of one case.
fn measure_case(runs: &[CaseRun], options: &ReportOptions, bar: &ProgressBar) -> Result<Vec<Row>, CommandError> {
    let Some(first) = runs.first() else { return Ok(Vec::new()) };
    let expectation = Expectation::compute(first.case);
    let mut rows = Vec::new();
    for run in runs {
        let row = Row::measure_errors(run.case, run.spec, &expectation, options.full)?;
        let row = if row.was_run() { row.with_cost(&measure_cost(run, options)?) } else { row };
        rows.push(row);
        bar.inc(1);
    }
    Ok(rows)
}

/// Measures the cost of a run in a separate process, so that other runs do not affect its memory.
fn measure_cost(run: &CaseRun, options: &ReportOptions) -> Result<Cost, CommandError> {
    let failed = |reason: String| CommandError::CostNotMeasured { scene: run.case.name.clone(), reason };
    let program = env::current_exe().map_err(|error| failed(error.to_string()))?;
    let mut command = Command::new(program);
    command.arg("report").arg("--cost-of").arg(run.number.to_string());
    command.args(options.full.then_some("--full")).args(options.growth.then_some("--growth"));
    let result = command.arg("--").args(&options.scenes).output().map_err(|error| failed(error.to_string()))?;
    match serde_json::from_slice(&result.stdout) {
        Ok(cost) if result.status.success() => Ok(cost),
        Ok(_) | Err(_) => {
            let message = String::from_utf8_lossy(&result.stderr).trim().to_owned();
            Err(failed(if message.is_empty() { result.status.to_string() } else { message }))
        }
    }
}

/// Measures one run and prints its cost as JSON. This is the other end of [`measure_cost`].
fn print_cost_of_run(cases: &[Case], number: usize) -> Result<Exit, CommandError> {
    let runs = case_runs(cases);
    let Some(run) = runs.iter().flatten().find(|run| run.number == number) else { return Ok(Exit::Error) };
    let scene = run.case.scene(run.spec)?;
    let cost = Cost::measure(run.case, &scene, run.spec)?;
    output::print(serde_json::to_string(&cost).expect("plain values with text for keys").as_bytes())?;
    Ok(Exit::Done)
}

/// Reads rows that were measured before.
fn read_rows(options: &ReportOptions) -> Result<Vec<Row>, CommandError> {
    let rows = |path: &Path| -> Result<Vec<Row>, CommandError> {
        let text = fs::read(path).map_err(|source| CommandError::Unreadable { path: path.into(), source })?;
        serde_json::from_slice(&text).map_err(|source| CommandError::NotAReport { path: path.into(), source })
    };
    let mut all = Vec::new();
    for path in &options.read {
        all.extend(rows(path)?);
    }
    all.retain(|row| options.only.is_empty() || options.only.contains(&row.family));
    Ok(all)
}
