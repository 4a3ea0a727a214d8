//! The results as Markdown and as JSON.

use crate::{
    engine::Engine, machine::Conditions, oracle::Oracle, recording_cost::RecordingCost, result::Cell, scenes::Scene,
};

/// The table, complete and as shown in the guide.
pub struct Text {
    /// All scenes at all rates, and the conditions of the measurement.
    pub full: String,
    /// A selection of scenes and rates for the guide, and the conditions of the measurement.
    pub guide: String,
}

/// All results as JSON that `rebond report --read` accepts, ordered by scene, engine and rate, one per line.
pub fn json(cells: &[Cell]) -> String {
    let order = |cell: &Cell| {
        let scene = cells.iter().position(|other| other.scene == cell.scene);
        let engine = Engine::ALL.into_iter().position(|engine| engine.name() == cell.solver);
        (scene, engine, cell.rate)
    };
    let mut ordered: Vec<&Cell> = cells.iter().collect();
    ordered.sort_by_key(|cell| order(cell));
    let lines: Vec<String> = ordered.into_iter().map(|cell| serde_json::to_string(cell).expect("plain data")).collect();
    format!("[\n{}\n]\n", lines.join(",\n"))
}

/// Returns both texts.
pub fn write(scenes: &[Scene], cells: &[Cell], recordings: &[RecordingCost], conditions: &Conditions) -> Text {
    let notes = [faster_engines(cells), recording_costs(cells, recordings), measured_on(cells, conditions)].join("\n");
    let table = |keep: &dyn Fn(&Scene) -> bool| matrix(scenes.iter().filter(|scene| keep(scene)), cells);
    Text {
        full: format!(
            "# Error and cost of rebond and other engines, by `tests/peers/run`\n\n{}\n{notes}",
            table(&|_| true)
        ),
        guide: format!("{}\n{notes}", table(&|scene| is_in_guide(scene))),
    }
}

/// Returns true for the scenes in the guide: all at 60 Hz, and those at 960 Hz in which smaller steps should help.
fn is_in_guide(scene: &Scene) -> bool {
    match scene.oracle {
        Oracle::Galperin { digits } => matches!(digits, 2 | 4) && scene.rate != 240,
        Oracle::Cradle { gap } => scene.rate == 60 || (gap > 0.0 && scene.rate == 960),
        Oracle::Bounce | Oracle::BetweenWalls | Oracle::Gas => scene.rate != 240,
        Oracle::ShotAtFixed | Oracle::ShotAtFree | Oracle::Rest | Oracle::Fall | Oracle::Slide => scene.rate == 60,
        Oracle::Row { .. } | Oracle::Seams { .. } | Oracle::Corners => scene.rate != 240,
    }
}

fn matrix<'a>(scenes: impl Iterator<Item = &'a Scene>, cells: &[Cell]) -> String {
    let mut text = "| scene | errors |".to_owned();
    Engine::ALL.iter().for_each(|engine| text += &format!(" {} |", engine.name()));
    text += "\n|---|---|";
    text += &"---|".repeat(Engine::ALL.len());
    for scene in scenes {
        text += &format!("\n| {}, {} Hz | {} |", scene.name, scene.rate, error_names(scene.oracle));
        for engine in Engine::ALL {
            let found = cells
                .iter()
                .find(|cell| cell.scene == scene.name && cell.rate == scene.rate && cell.solver == engine.name());
            text += &format!(" {} |", found.map_or_else(String::new, |cell| format_cell(scene.oracle, cell)));
        }
    }
    text + "\n"
}

/// The errors shown in the cells of a scene, with their units.
fn error_names(oracle: Oracle) -> &'static str {
    match oracle {
        Oracle::Bounce | Oracle::BetweenWalls => "position, m; energy",
        Oracle::ShotAtFixed | Oracle::ShotAtFree => "velocity, m/s; position, m",
        Oracle::Cradle { .. } => "velocity, m/s; position, m",
        Oracle::Galperin { .. } => "collisions; velocity, m/s",
        Oracle::Rest => "displacement, m",
        Oracle::Row { .. } => "velocity, m/s; overlap, m",
        Oracle::Seams { .. } => "velocity, m/s; position, m",
        Oracle::Corners => "position, m; overlap, m",
        Oracle::Gas => "energy; overlap, m",
        Oracle::Slide => "energy gained; overlap, m",
        Oracle::Fall => "overlap, m; final speed, m/s",
    }
}

fn format_cell(oracle: Oracle, cell: &Cell) -> String {
    let Some(errors) = &cell.errors else {
        return cell.remark.clone().unwrap_or_default();
    };
    let number = |value: Option<f64>| value.map_or("unknown".to_owned(), format_number);
    let error_text = match oracle {
        Oracle::Bounce | Oracle::BetweenWalls => {
            format!("{}; {}", number(errors.position_error), number(errors.energy_drift))
        }
        Oracle::Rest => number(errors.position_error),
        Oracle::ShotAtFixed | Oracle::ShotAtFree if errors.velocity_error.is_some_and(|error| error > 10_000.0) => {
            "passes through".to_owned()
        }
        Oracle::Row { .. } => format!("{}; {}", number(errors.velocity_error), format_number(errors.worst_overlap)),
        Oracle::Corners => format!("{}; {}", number(errors.position_error), format_number(errors.worst_overlap)),
        Oracle::ShotAtFixed | Oracle::ShotAtFree | Oracle::Cradle { .. } | Oracle::Seams { .. } => {
            format!("{}; {}", number(errors.velocity_error), number(errors.position_error))
        }
        Oracle::Galperin { .. } => {
            let correct = errors.true_collisions.unwrap_or_default();
            format!("{} of {correct}; {}", errors.collisions.unwrap_or_default(), number(errors.velocity_error))
        }
        Oracle::Gas | Oracle::Slide => {
            format!("{}; {}", number(errors.energy_drift), format_number(errors.worst_overlap))
        }
        Oracle::Fall => format!("{}; {}", format_number(errors.worst_overlap), number(errors.velocity_error)),
    };
    let costs: Vec<String> = cell.phases.iter().map(|cost| format_number(cost.median)).collect();
    let stopped =
        if cell.steps < cell.of_steps { format!("<br>stopped after {} steps", cell.steps) } else { String::new() };
    format!("{error_text}<br>**{} ns**{stopped}", costs.join(", "))
}

/// Formats a number with few digits, enough to compare magnitudes.
pub fn format_number(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        value if !value.is_finite() => "not finite".to_owned(),
        value if (10.0..1e6).contains(&value) => format!("{value:.0}"),
        value if (0.1..10.0).contains(&value) => format!("{value:.1}"),
        value if (0.001..0.1).contains(&value) => {
            let digits = if value < 0.01 { 4 } else { 3 };
            format!("{value:.digits$}").trim_end_matches('0').to_owned()
        }
        value => format!("{value:.0e}"),
    }
}

/// Lists the runs in which another engine needs less time than the event-driven solver.
fn faster_engines(cells: &[Cell]) -> String {
    let mut runs = Vec::new();
    for ours in cells.iter().filter(|cell| cell.solver == Engine::EventDriven.name()) {
        let peers = cells.iter().filter(|cell| same_run(cell, ours) && is_peer(cell));
        for (index, phase) in ours.phases.iter().enumerate() {
            let faster: Vec<String> = peers
                .clone()
                .filter_map(|peer| Some((peer.solver, peer.phases.get(index)?.median)))
                .filter(|(_, cost)| *cost < phase.median)
                .map(|(name, cost)| format!("{name} {} ns", format_number(cost)))
                .collect();
            if !faster.is_empty() {
                let when = if index == 0 { "" } else { ", at rest" };
                let costs = faster.join(", ");
                let scene = format!("{} at {} Hz{when}", ours.scene, ours.rate);
                runs.push(format!("- {scene}: {costs}, rebond {} ns\n", format_number(phase.median)));
            }
        }
    }
    if runs.is_empty() {
        return "No other engine needs less time per step than rebond's event-driven solver in any run.\n".to_owned();
    }
    format!(
        "Runs in which another engine needs less time per step than rebond's event-driven solver:\n\n{}",
        runs.concat()
    )
}

fn same_run(one: &Cell, other: &Cell) -> bool {
    one.scene == other.scene && one.rate == other.rate
}

fn is_peer(cell: &Cell) -> bool {
    Engine::ALL.into_iter().any(|engine| engine.name() == cell.solver && !engine.is_ours())
}

/// Compares the cost of recording with the cost of stepping in rebond and in the fastest other engine.
fn recording_costs(cells: &[Cell], recordings: &[RecordingCost]) -> String {
    let mut text = "Costs of `rebond record`, including the start of the program and writing the file:\n\n".to_owned();
    for run in recordings {
        let is_complete = |cell: &&Cell| cell.scene == run.scene && cell.rate == 60 && cell.steps == cell.of_steps;
        let seconds = |cell: &Cell| Some(cell.ns_per_body_step? * 1e-9 * cell.bodies as f64 * cell.steps as f64);
        let ours =
            cells.iter().filter(is_complete).find(|cell| cell.solver == Engine::EventDriven.name()).and_then(seconds);
        let peers = cells.iter().filter(is_complete).filter(|cell| is_peer(cell));
        let fastest =
            peers.filter_map(|cell| Some((cell.solver, seconds(cell)?))).min_by(|one, other| one.1.total_cmp(&other.1));
        let (Some(ours), Some((name, stepping))) = (ours, fastest) else { continue };
        text += &format!(
            "- {}, {:.1} MB: {:.2} s of processor time, {:.2} s of wall-clock time. Stepping alone takes {ours:.2} s, \
             and {stepping:.2} s in {name}, the fastest other engine.\n",
            run.scene,
            run.bytes as f64 * 1e-6,
            run.cpu,
            run.wall,
        );
    }
    if recordings.is_empty() { String::new() } else { text }
}

fn measured_on(cells: &[Cell], conditions: &Conditions) -> String {
    let versions: Vec<String> = Engine::ALL
        .into_iter()
        .filter(|engine| *engine != Engine::Handout)
        .filter_map(|engine| cells.iter().find(|cell| cell.solver == engine.name() && cell.remark.is_none()))
        .map(|cell| format!("{} {}", cell.solver, cell.version))
        .collect();
    format!(
        "Measured on {} on {} ({}), load average {} at the start and {} at the end; {}; {}.\n",
        conditions.date,
        conditions.processor,
        conditions.system,
        conditions.load[0],
        conditions.load[1],
        versions.join(", "),
        conditions.tools.join(", "),
    )
}
