//! The results as Markdown and as JSON.

use crate::{engine::Engine, machine::Conditions, recorded::Recorded, result::Cell, scenes::Scene, truth::Truth};

/// The table, at length and as the README shows it.
pub struct Text {
    /// All scenes at all rates, with what it was made under.
    pub whole: String,
    /// What tells most.
    pub readme: String,
}

/// All results, for programs: as `rebond report --read` takes them, scene by scene and engine by
/// engine. A line for each, so that a change of one shows as one.
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

/// Both texts.
pub fn write(scenes: &[Scene], cells: &[Cell], recorded: &[Recorded], conditions: &Conditions) -> Text {
    let closing = [remarks(cells), recordings(cells, recorded), made_under(cells, conditions)].join("\n");
    let table = |keep: &dyn Fn(&Scene) -> bool| matrix(scenes.iter().filter(|scene| keep(scene)), cells);
    Text {
        whole: format!("# What accuracy costs, by `tests/peers/run`\n\n{}\n{closing}", table(&|_| true)),
        readme: format!("{}\n{closing}", table(&|scene| is_telling(scene))),
    }
}

/// What the README shows: everything at 60 Hz, and at 960 Hz where smaller steps are meant to help.
fn is_telling(scene: &Scene) -> bool {
    match scene.truth {
        Truth::Galperin { digits } => matches!(digits, 2 | 4) && scene.rate != 240,
        Truth::Cradle { gap } => scene.rate == 60 || (gap > 0.0 && scene.rate == 960),
        Truth::Bounce | Truth::BetweenWalls | Truth::Gas => scene.rate != 240,
        Truth::ShotAtFixed | Truth::ShotAtFree | Truth::Rest | Truth::Fall | Truth::Slide => scene.rate == 60,
    }
}

fn matrix<'a>(scenes: impl Iterator<Item = &'a Scene>, cells: &[Cell]) -> String {
    let mut text = "| scene | error |".to_owned();
    Engine::ALL.iter().for_each(|engine| text += &format!(" {} |", engine.name()));
    text += "\n|---|---|";
    text += &"---|".repeat(Engine::ALL.len());
    for scene in scenes {
        text += &format!("\n| {}, {} Hz | {} |", scene.name, scene.rate, measure(scene.truth));
        for engine in Engine::ALL {
            let found = cells
                .iter()
                .find(|cell| cell.scene == scene.name && cell.rate == scene.rate && cell.solver == engine.name());
            text += &format!(" {} |", found.map_or_else(String::new, |cell| shown(scene.truth, cell)));
        }
    }
    text + "\n"
}

/// What stands first in the cells of such a scene.
fn measure(truth: Truth) -> &'static str {
    match truth {
        Truth::Bounce | Truth::BetweenWalls => "position, m; energy",
        Truth::ShotAtFixed | Truth::ShotAtFree => "velocity, m/s; position, m",
        Truth::Cradle { .. } => "velocity, m/s; position, m",
        Truth::Galperin { .. } => "collisions; velocity, m/s",
        Truth::Rest => "moved, m",
        Truth::Gas => "energy; overlap, m",
        Truth::Slide => "energy gained; overlap, m",
        Truth::Fall => "overlap, m; speed left, m/s",
    }
}

fn shown(truth: Truth, cell: &Cell) -> String {
    let Some(errors) = &cell.errors else {
        return cell.remark.clone().unwrap_or_default();
    };
    let number = |value: Option<f64>| value.map_or("?".to_owned(), brief);
    let wrong = match truth {
        Truth::Bounce | Truth::BetweenWalls => {
            format!("{}; {}", number(errors.position_error), number(errors.energy_drift))
        }
        Truth::Rest => number(errors.position_error),
        Truth::ShotAtFixed | Truth::ShotAtFree if errors.velocity_error.is_some_and(|error| error > 10_000.0) => {
            "goes through".to_owned()
        }
        Truth::ShotAtFixed | Truth::ShotAtFree | Truth::Cradle { .. } => {
            format!("{}; {}", number(errors.velocity_error), number(errors.position_error))
        }
        Truth::Galperin { .. } => {
            let of = errors.true_collisions.unwrap_or_default();
            format!("{} of {of}; {}", errors.collisions.unwrap_or_default(), number(errors.velocity_error))
        }
        Truth::Gas | Truth::Slide => format!("{}; {}", number(errors.energy_drift), brief(errors.worst_overlap)),
        Truth::Fall => format!("{}; {}", brief(errors.worst_overlap), number(errors.velocity_error)),
    };
    let costs: Vec<String> = cell.phases.iter().map(|cost| brief(cost.median)).collect();
    let stopped = if cell.steps < cell.of_steps { format!("<br>after {} steps", cell.steps) } else { String::new() };
    format!("{wrong}<br>**{} ns**{stopped}", costs.join(", "))
}

/// As many digits as tell sizes apart, no more.
pub fn brief(value: f64) -> String {
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

/// Where another engine takes less time than the exact solver.
fn remarks(cells: &[Cell]) -> String {
    let mut wins = Vec::new();
    for ours in cells.iter().filter(|cell| cell.solver == Engine::EventDriven.name()) {
        let peers = cells.iter().filter(|cell| same_run(cell, ours) && is_peer(cell));
        for (place, phase) in ours.phases.iter().enumerate() {
            let faster: Vec<String> = peers
                .clone()
                .filter_map(|peer| Some((peer.solver, peer.phases.get(place)?.median)))
                .filter(|(_, cost)| *cost < phase.median)
                .map(|(name, cost)| format!("{name} {}", brief(cost)))
                .collect();
            if !faster.is_empty() {
                let part = if place == 0 { "" } else { ", settled" };
                let costs = faster.join(", ");
                let scene = format!("{} at {} Hz{part}", ours.scene, ours.rate);
                wins.push(format!("{scene}: {costs} against {} ns", brief(phase.median)));
            }
        }
    }
    if wins.is_empty() {
        return "In none of these runs does another engine take less time a step than rebond's exact solver.\n"
            .to_owned();
    }
    format!("Less time a step than rebond's exact solver takes: {}.\n", wins.join("; "))
}

fn same_run(one: &Cell, other: &Cell) -> bool {
    one.scene == other.scene && one.rate == other.rate
}

fn is_peer(cell: &Cell) -> bool {
    Engine::ALL.into_iter().any(|engine| engine.name() == cell.solver && !engine.is_ours())
}

/// Recording beside the bare stepping of the fastest other engine.
fn recordings(cells: &[Cell], recorded: &[Recorded]) -> String {
    let mut text = String::new();
    for run in recorded {
        let bare = |cell: &&Cell| cell.scene == run.scene && cell.rate == 60 && cell.steps == cell.of_steps;
        let seconds = |cell: &Cell| Some(cell.ns_per_body_step? * 1e-9 * cell.bodies as f64 * cell.steps as f64);
        let ours = cells.iter().filter(bare).find(|cell| cell.solver == Engine::EventDriven.name()).and_then(seconds);
        let peers = cells.iter().filter(bare).filter(|cell| is_peer(cell));
        let fastest =
            peers.filter_map(|cell| Some((cell.solver, seconds(cell)?))).min_by(|one, other| one.1.total_cmp(&other.1));
        let (Some(ours), Some((name, bare))) = (ours, fastest) else { continue };
        text += &format!(
            "`rebond record` on the {}, start and file of {:.1} MB included: {:.2} s of processor time, {:.2} s on the \
             clock; its bare stepping {ours:.2} s, that of the fastest other engine, {name}, {bare:.2} s.\n",
            run.scene,
            run.bytes as f64 * 1e-6,
            run.cpu,
            run.wall,
        );
    }
    text
}

fn made_under(cells: &[Cell], conditions: &Conditions) -> String {
    let versions: Vec<String> = Engine::ALL
        .into_iter()
        .filter(|engine| *engine != Engine::Handout)
        .filter_map(|engine| cells.iter().find(|cell| cell.solver == engine.name() && cell.remark.is_none()))
        .map(|cell| format!("{} {}", cell.solver, cell.version))
        .collect();
    format!(
        "Measured on {} on {} ({}), load average {} at the begin and {} at the end; {}; {}.\n",
        conditions.date,
        conditions.processor,
        conditions.system,
        conditions.load[0],
        conditions.load[1],
        versions.join(", "),
        conditions.tools.join(", "),
    )
}
