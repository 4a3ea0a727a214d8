use super::arguments::{ReportOptions, Shard, is_standard_output};
use super::error::CommandError;
use super::output_file::{OutputFile, Overwrite, RefuseInputs};
use super::{Exit, output};
use crate::picture::{Metadata, PictureOptions, PngEffort, StillFormat, TextAs, figures};
use crate::report::{self, Budget, Case, Cost, Expectation, Row, RunSpec, cases};
use crate::scene::{self, Scene, Sweep};
use indicatif::ProgressBar;
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Measures errors and costs, and prints or draws them.
pub fn run(options: &ReportOptions) -> Result<Exit, CommandError> {
    if let Some(number) = options.cost_of {
        return print_cost_of_run(&all_cases(options)?, number);
    }
    let diagram = options.plot.as_deref().map(|path| open_plot(path, options)).transpose()?;
    let rows = if options.read.is_empty() { measure_rows(options)? } else { read_rows(options)? };
    if let Some((output, format)) = diagram {
        plot(&rows, output, format, options)?;
    }
    let text = match (options.json, options.csv) {
        (true, _) => serde_json::to_string_pretty(&rows).expect("plain values with text for keys") + "\n",
        (false, true) => csv_header(options.shard).to_owned() + &report::csv(&rows),
        (false, false) => report::table(&rows),
    };
    output::print(&text)?;
    Ok(Exit::Done)
}

/// Determines the format of the diagram, and returns an error before any work is done if it cannot be written.
fn open_plot(path: &Path, options: &ReportOptions) -> Result<(OutputFile, StillFormat), CommandError> {
    let inputs: Vec<&Path> = options.scenes.iter().chain(&options.read).map(PathBuf::as_path).collect();
    let Some(format) = StillFormat::from_path(path) else {
        return Err(CommandError::UnsupportedOutput { path: path.into(), expected: "expected F.png, F.svg or F.pdf" });
    };
    let mut output = OutputFile::create(path, Overwrite::from_force(options.force), &inputs)?;
    for LoadedScene { path, scene, .. } in scenes(options)? {
        output.refuse_inputs(&scene.image_paths(path.parent().unwrap_or(Path::new(""))))?;
    }
    Ok((output, format))
}

/// Draws error against cost, or cost against the number of bodies and steps.
fn plot(rows: &[Row], output: OutputFile, format: StillFormat, options: &ReportOptions) -> Result<(), CommandError> {
    let is_growth = |row: &Row| cases::GROWTH.contains(&row.family.as_str());
    let diagrams = if rows.iter().any(is_growth) { report::growth(rows) } else { report::work_precision(rows) };
    let (size, theme, caption) = (options.size, options.theme, options.caption.clone());
    let picture_options = PictureOptions { size, theme, caption, ..PictureOptions::default() };
    let list = figures::diagrams(&diagrams, &picture_options)?;
    let entries = vec![
        ("Software".to_owned(), concat!("rebond ", env!("CARGO_PKG_VERSION")).to_owned()),
        (
            Metadata::TITLE.to_owned(),
            diagrams.iter().map(|diagram| diagram.title.as_str()).collect::<Vec<_>>().join("; "),
        ),
    ];
    output.write(|file| Ok(format.write(&list, &Metadata { entries }, TextAs::Outlines, PngEffort::Small, file)?))
}

/// The header of the table. Only the first shard has one, so that the outputs can be concatenated.
fn csv_header(shard: Shard) -> &'static str {
    if shard.number == 1 { report::CSV_HEADER } else { "" }
}

const fn budget(options: &ReportOptions) -> Budget {
    if options.full { Budget::Hours } else { Budget::Minutes }
}

/// All cases that the options allow. `--cost-of` numbers the runs in this order.
fn all_cases(options: &ReportOptions) -> Result<Vec<Case>, CommandError> {
    if options.growth {
        return Ok(cases::growth());
    }
    if options.scenes.is_empty() {
        return Ok(cases::all(budget(options)));
    }
    Ok(scenes(options)?.iter().map(|loaded| Case::of_scene(&loaded.name, &loaded.scene)).collect())
}

/// A scene to measure, with the values of one run.
struct LoadedScene<'a> {
    path: &'a Path,
    /// The name of the file and the values.
    name: String,
    scene: Scene,
}

/// Reads the scenes of the command, each once for every combination of the values.
fn scenes(options: &ReportOptions) -> Result<Vec<LoadedScene<'_>>, CommandError> {
    let mut scenes = Vec::new();
    let runs = Sweep::combinations(&options.set).map_err(CommandError::Set)?;
    for path in &options.scenes {
        refuse_pipe(path)?;
        let file_name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        for overrides in &runs {
            let values: String = overrides.iter().map(|value| format!(" {value}")).collect();
            let name = format!("{file_name}{values}");
            scenes.push(LoadedScene { path, name, scene: scene::load_with(path, overrides)? });
        }
    }
    Ok(scenes)
}

/// Returns an error for a scene that can be read only once: each measurement reads it again in a process of its own.
fn refuse_pipe(path: &Path) -> Result<(), CommandError> {
    let is_special = || path.metadata().is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir());
    if is_standard_output(path) || is_special() {
        Err(CommandError::SceneReadOnce { path: path.into() })
    } else {
        Ok(())
    }
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
    let mut all = Vec::new();
    for case in cases {
        let numbered = case.run_specs().into_iter().zip(numbers.by_ref());
        all.push(numbered.map(|(spec, number)| CaseRun { case, spec, number }).collect());
    }
    all
}

/// Selects the requested families, and of these the requested shard.
fn select<'a>(mut runs: Vec<Vec<CaseRun<'a>>>, options: &ReportOptions) -> Result<Vec<Vec<CaseRun<'a>>>, CommandError> {
    let mut known: Vec<String> = Vec::new();
    for CaseRun { case, .. } in runs.iter().flatten() {
        if !known.contains(&case.family) {
            known.push(case.family.clone());
        }
    }
    if let Some(name) = options.only.iter().find(|name| !known.contains(name)) {
        return Err(CommandError::UnknownFamily { name: name.clone(), known: known.join(", ") });
    }
    if !options.only.is_empty() {
        runs.retain(|runs| runs.iter().any(|run| options.only.contains(&run.case.family)));
    }
    let range = options.shard.range(runs.len());
    Ok(runs.drain(range).collect())
}

fn measure_rows(options: &ReportOptions) -> Result<Vec<Row>, CommandError> {
    let cases = all_cases(options)?;
    let selected = select(case_runs(&cases), options)?;
    let bar = output::progress_bar("measuring", selected.iter().map(Vec::len).sum::<usize>() as u64);
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
        let row = Row::measure_errors(run.case, run.spec, &expectation, budget(options))?;
        rows.push(if row.was_run() { row.with_cost(measure_cost(run, options)?.as_ref()) } else { row });
        bar.inc(1);
    }
    Ok(rows)
}

/// Measures the cost of a run, if it has one, in a separate process, so that other runs do not affect its memory.
fn measure_cost(run: &CaseRun, options: &ReportOptions) -> Result<Option<Cost>, CommandError> {
    let cost = cost_of_process(run.number, options);
    cost.map_err(|reason| CommandError::CostNotMeasured { scene: run.case.name.clone(), reason })
}

fn cost_of_process(number: usize, options: &ReportOptions) -> Result<Option<Cost>, String> {
    let mut command = Command::new(env::current_exe().map_err(|error| error.to_string())?);
    command.arg("report").arg("--cost-of").arg(number.to_string());
    command.args(options.full.then_some("--full")).args(options.growth.then_some("--growth"));
    options.set.iter().for_each(|sweep| _ = command.arg("--set").arg(sweep.to_string()));
    let result = command.arg("--").args(&options.scenes).output().map_err(|error| error.to_string())?;
    match serde_json::from_slice(&result.stdout) {
        Ok(cost) if result.status.success() => Ok(cost),
        Ok(_) | Err(_) => {
            let message = String::from_utf8_lossy(&result.stderr).trim().to_owned();
            Err(if message.is_empty() { result.status.to_string() } else { message })
        }
    }
}

/// Measures one run and prints its cost as JSON, null if it has none, in the process started by [`cost_of_process`].
fn print_cost_of_run(cases: &[Case], number: usize) -> Result<Exit, CommandError> {
    let runs = case_runs(cases);
    let Some(run) = runs.iter().flatten().find(|run| run.number == number) else { return Ok(Exit::Error) };
    let scene = run.case.scene(run.spec)?;
    let cost = Cost::measure(run.case, &scene, run.spec)?;
    output::print(&serde_json::to_string(&cost).expect("plain values with text for keys"))?;
    Ok(Exit::Done)
}

/// Reads rows that were measured before.
fn read_rows(options: &ReportOptions) -> Result<Vec<Row>, CommandError> {
    let mut all: Vec<Row> = Vec::new();
    for path in &options.read {
        let text = fs::read(path).map_err(CommandError::unreadable(path))?;
        let rows: Vec<Row> =
            serde_json::from_slice(&text).map_err(|source| CommandError::NotAReport { path: path.into(), source })?;
        all.extend(rows);
    }
    all.retain(|row| options.only.is_empty() || options.only.contains(&row.family));
    Ok(all)
}
