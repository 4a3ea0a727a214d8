//! The tables of a scene that hold no events: `[world]`, `[run]`, `[restitution]` and `[figure]`.

use super::{
    Blueprint, Diagnostic, DiagnosticKind, SpawnRequest, action,
    diagnostic::{ErrorReported, Reporter},
    tree::{Entry, Key, Node, Table, Value, unknown_key},
};
use crate::paint::Paint;
use crate::physics::{BodyId, DEFAULT_EVENTS_PER_STEP, Restitution, RestitutionPair, SolverKind, Spawn, Vector};
use crate::picture_options::{ColorBy, Language, MAX_FPS, MAX_SIDE, Overlay, Overlays, PictureOptions, Theme};
use crate::recording::limits;
use std::{
    collections::{BTreeMap, BTreeSet},
    ops::Range,
};

/// The `[world]` table of a scene. A value that could not be read is an error.
pub struct WorldOptions {
    /// Width and height of the visible world, m.
    pub size: Result<[f64; 2], ErrorReported>,
    /// The walls and the location of their key.
    pub walls: Result<Option<(Walls, Range<usize>)>, ErrorReported>,
    /// Gravity, m/s².
    pub gravity: Result<Option<Vector>, ErrorReported>,
}

/// Default width and height of the world, m.
pub const DEFAULT_SIZE: [f64; 2] = [16.0, 9.0];

const SIZE: Key = action::SIZE;
const SIZE_WITHIN_WALLS: &str = "extents so small that 1 m, the thickness of the walls, is more than a few units in the last place of them; or walls = false";
const WALLS: Key = Key { name: "walls", accepts: "true or false" };
const WALL_MATERIAL: Key = Key { name: "wall_material", accepts: action::MATERIAL.accepts };
const GRAVITY: Key = Key { name: "gravity", accepts: "two finite numbers, m/s²" };

/// The keys of `[world]`.
pub const WORLD_KEYS: &[Key] = &[SIZE, WALLS, WALL_MATERIAL, GRAVITY];

impl Default for WorldOptions {
    fn default() -> WorldOptions {
        WorldOptions { size: Ok(DEFAULT_SIZE), walls: Ok(None), gravity: Ok(None) }
    }
}

impl WorldOptions {
    /// The options of a table that could not be read.
    pub fn unreadable(reported: ErrorReported) -> WorldOptions {
        WorldOptions { size: Err(reported), walls: Err(reported), gravity: Err(reported) }
    }
}

/// Reads `[world]`.
pub fn read_world(table: &Table) -> WorldOptions {
    let material = table.optional(WALL_MATERIAL, action::material).map(|material| material.map(String::from));
    let walls = table.get(WALLS).and_then(|field| {
        let Some(field) = field else { return Ok(None) };
        let has_walls = field.read(Node::boolean)?;
        Ok(if has_walls { Some((Walls { material: material? }, field.node.span.clone())) } else { None })
    });
    let size = read_size(table, walls.as_ref().ok().and_then(Option::as_ref).map(|(walls, _)| walls));
    WorldOptions { size, walls, gravity: table.optional(GRAVITY, Node::vector) }
}

/// Reads the size of the world, whose walls must not be too thin for the precision of their coordinates.
fn read_size(table: &Table, walls: Option<&Walls>) -> Result<[f64; 2], ErrorReported> {
    let Some(field) = table.get(SIZE)? else { return Ok(DEFAULT_SIZE) };
    let size = field.read(Node::size)?;
    let is_resolved = |request: &SpawnRequest| request.rect().is_resolved();
    if walls.is_none_or(|walls| walls.spawn_requests(size).iter().all(is_resolved)) {
        Ok(size)
    } else {
        Err(field.accepting(SIZE_WITHIN_WALLS).refuse(field.node))
    }
}

/// The four static walls just outside the world, each 1 m thick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Walls {
    /// The material of the walls.
    pub material: Option<String>,
}

/// The names of the walls, in creation order.
pub const WALL_NAMES: [&str; 4] = ["wall-top", "wall-bottom", "wall-left", "wall-right"];

impl Walls {
    /// The wall bodies around a world of that size, m, in creation order.
    ///
    /// The horizontal walls cover the corners.
    pub fn spawn_requests(&self, [width, height]: [f64; 2]) -> [SpawnRequest; 4] {
        let [top, bottom, left, right] = WALL_NAMES;
        [
            self.request(top, Vector::new(-1.0, -1.0), [width + 2.0, 1.0]),
            self.request(bottom, Vector::new(-1.0, height), [width + 2.0, 1.0]),
            self.request(left, Vector::new(-1.0, 0.0), [1.0, height]),
            self.request(right, Vector::new(width, 0.0), [1.0, height]),
        ]
    }

    /// Returns true if a body is one of the walls of its scene, which are its first bodies: it has the id, the name,
    /// the place and the mass of one. A body that is only named like a wall is none.
    pub fn is_wall(id: BodyId, spawn: &Spawn) -> bool {
        let Spawn { name, rect, mass, velocity, force, .. } = spawn;
        let [x, y] = [rect.origin.x, rect.origin.y];
        let is_in_place = match id {
            0 => x == -1.0 && y == -1.0 && rect.height() == 1.0,
            1 => x == -1.0 && rect.height() == 1.0,
            2 => x == -1.0 && y == 0.0 && rect.width() == 1.0,
            3 => y == 0.0 && rect.width() == 1.0,
            _ => return false,
        };
        let is_static = *mass == f64::INFINITY && *velocity == Vector::ZERO && *force == Vector::ZERO;
        is_in_place && is_static && name == WALL_NAMES[id as usize]
    }

    fn request(&self, name: &str, origin: Vector, size: [f64; 2]) -> SpawnRequest {
        let blueprint = Blueprint {
            name: Some(name.into()),
            size,
            mass: f64::INFINITY,
            velocity: Vector::ZERO,
            force: Vector::ZERO,
            material: self.material.clone().unwrap_or_default(),
            paint: Paint::default(),
        };
        blueprint.placed_at(origin)
    }
}

/// The `[run]` table of a scene: duration, rate and solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Steps per second, Hz; finite and positive.
    pub rate: f64,
    /// The number of steps; the run has the states 0..=steps.
    pub steps: u64,
    /// The solver.
    pub solver: SolverKind,
    /// The largest number of events within one step; the run ends with an error beyond it.
    pub events_per_step: u64,
}

/// The default rate, Hz.
pub const DEFAULT_RATE: f64 = 60.0;

/// The default solver.
pub const DEFAULT_SOLVER: SolverKind = SolverKind::EventDriven;

const RATE: Key = Key { name: "rate", accepts: "a positive number of steps per second whose reciprocal is finite" };
const STEPS: Key = Key { name: "steps", accepts: "a whole number of steps, at most 2⁵³ and 584 simulated years" };
const DURATION: Key =
    Key { name: "duration", accepts: "a number of seconds, 0 or more, at most 584 years and 2⁵³ steps" };
const SOLVER: Key = Key { name: "solver", accepts: "\"handout\" or \"event-driven\"" };
const EVENTS_PER_STEP: Key = Key { name: "events_per_step", accepts: "a whole number of events, 1 or more" };

/// The keys of `[run]`.
pub const RUN_KEYS: &[Key] = &[RATE, STEPS, DURATION, SOLVER, EVENTS_PER_STEP];

/// Reads `[run]`. The number of steps is returned on its own because it may be known even if other options
/// are not.
pub fn read_run(table: &Table) -> (Result<RunOptions, ErrorReported>, Result<u64, ErrorReported>) {
    let rate = table
        .optional(RATE, |node| node.number_where(|rate| rate > 0.0 && (1.0 / rate).is_finite()))
        .map(|rate| rate.unwrap_or(DEFAULT_RATE));
    let steps = read_steps(table, rate);
    let solver = table.optional(SOLVER, |node| SolverKind::from_name(node.text()?).ok_or(node));
    let events_per_step = table.optional(EVENTS_PER_STEP, |node| node.count_in(1..=u64::MAX));
    let options = || {
        Ok(RunOptions {
            rate: rate?,
            steps: steps?,
            solver: solver?.unwrap_or(DEFAULT_SOLVER),
            events_per_step: events_per_step?.unwrap_or(DEFAULT_EVENTS_PER_STEP),
        })
    };
    (options(), steps)
}

fn read_steps(table: &Table, rate: Result<f64, ErrorReported>) -> Result<u64, ErrorReported> {
    let fits = |steps: f64, rate: f64| steps <= limits::STEPS as f64 && steps / rate <= limits::SECONDS;
    match (table.get(STEPS)?, table.get(DURATION)?) {
        (Some(steps), None) => steps.read(|node| {
            let count = node.count()?;
            let is_accepted = count <= limits::STEPS && rate.map_or(true, |rate| fits(count as f64, rate));
            if is_accepted { Ok(count) } else { Err(node) }
        }),
        (None, Some(duration)) => {
            let seconds = |rate: f64, node| {
                Node::number_where(node, |seconds| seconds >= 0.0 && fits((seconds * rate).round(), rate))
            };
            match rate {
                Ok(rate) => Ok((duration.read(|node| seconds(rate, node))? * rate).round() as u64),
                Err(reported) => {
                    duration.read(|node| node.number_where(|seconds| seconds >= 0.0))?;
                    Err(reported)
                }
            }
        }
        (Some(_), Some(duration)) => {
            let kind = DiagnosticKind::ExclusiveKeys { keys: ["run.steps", "run.duration"] };
            Err(duration.report(Diagnostic::new(kind, duration.node.span.clone())))
        }
        (None, None) => {
            let accepts = "a whole number of steps; or give duration, in seconds";
            Err(table.report_missing(Key { name: "steps", accepts }))
        }
    }
}

/// The default coefficient of restitution.
pub const DEFAULT_RESTITUTION: f64 = 1.0;

const COEFFICIENT: &str = "a coefficient of restitution from 0 (perfectly inelastic) to 1 (elastic)";
const DEFAULT: Key = Key { name: "default", accepts: COEFFICIENT };
const PAIR: Key = Key { name: "\"a/b\" for two materials a and b", accepts: COEFFICIENT };

/// The keys of `[restitution]`; a pair stands for the names of any two materials.
pub const RESTITUTION_KEYS: &[Key] = &[DEFAULT, PAIR];

/// Reads `[restitution]`.
pub fn read_restitution(node: &Node, reporter: &Reporter) -> Result<Restitution, ErrorReported> {
    let table = Table::with_any_keys("restitution", node, reporter)?;
    let default = table.optional(DEFAULT, coefficient);
    let mut pairs = Vec::new();
    let mut refused = None;
    let mut seen = BTreeMap::new();
    let mut materials = BTreeSet::new();
    for entry in table.entries().iter().filter(|entry| entry.key != DEFAULT.name) {
        match read_pair(&table, entry, &mut seen, reporter) {
            Ok(pair) => {
                materials.extend(pair.materials.clone());
                pairs.push(pair);
            }
            Err(reported) => refused = Some(reported),
        }
        if materials.len() > limits::MATERIALS {
            let kind = DiagnosticKind::TooMany { what: "materials in [restitution]", limit: limits::MATERIALS as u64 };
            return Err(reporter.report(Diagnostic::new(kind, entry.span.clone())));
        }
    }
    match refused {
        Some(reported) => Err(reported),
        None => Ok(Restitution::new(default?.unwrap_or(DEFAULT_RESTITUTION), &pairs)),
    }
}

/// Reads one pair; `seen` has the locations of the pairs before it.
fn read_pair(
    table: &Table,
    entry: &Entry,
    seen: &mut BTreeMap<[String; 2], Range<usize>>,
    reporter: &Reporter,
) -> Result<RestitutionPair, ErrorReported> {
    let side = |text: &str| {
        let node = Node { span: entry.span.clone(), value: Value::Text(text.into()) };
        action::material(&node).map(String::from).ok()
    };
    let sides = entry.key.split_once('/').map(|(a, b)| (side(a), side(b)));
    let Some((Some(a), Some(b))) = sides else {
        return Err(reporter.report(unknown_key(table.name, entry, RESTITUTION_KEYS)));
    };
    let restitution = table.field(entry, COEFFICIENT).read(coefficient);
    let materials = [a, b];
    let mut sorted = materials.clone();
    sorted.sort();
    if let Some(earlier) = seen.insert(sorted, entry.span.clone()) {
        let kind = DiagnosticKind::DuplicatePair { pair: entry.key.clone() };
        return Err(reporter.report(Diagnostic::new(kind, entry.span.clone()).conflicting_with(earlier)));
    }
    Ok(RestitutionPair { materials, restitution: restitution? })
}

fn coefficient(node: &Node) -> Result<f64, &Node> {
    node.number_where(|e| (0.0..=1.0).contains(&e))
}

const FIGURE_SIZE: Key = Key { name: "size", accepts: "width and height, px: two whole numbers from 1 to 16384" };
const THEME: Key = Key { name: "theme", accepts: Theme::ACCEPTED };
const FPS: Key = Key { name: "fps", accepts: "a positive number of frames per second, at most 1000" };
const SHOW: Key = Key { name: "show", accepts: Overlay::ACCEPTED };
const COLOR_BY: Key = Key { name: "color_by", accepts: ColorBy::ACCEPTED };
const LANGUAGE: Key = Key { name: "language", accepts: Language::ACCEPTED };

/// The keys of `[figure]`.
pub(super) const FIGURE_KEYS: &[Key] = &[FIGURE_SIZE, THEME, FPS, SHOW, COLOR_BY, LANGUAGE];

/// Reads `[figure]`.
pub(super) fn read_figure(table: &Table) -> Result<PictureOptions, ErrorReported> {
    let size = table.optional(FIGURE_SIZE, |node| node.each(pixels));
    let theme = table.optional(THEME, |node| Theme::named(node.text()?).ok_or(node));
    let fps = table.optional(FPS, |node| node.number_where(|fps| 0.0 < fps && fps <= MAX_FPS));
    let show = table.optional(SHOW, overlays);
    let color_by = table.optional(COLOR_BY, |node| ColorBy::named(node.text()?).ok_or(node));
    let language = table.optional(LANGUAGE, |node| Language::named(node.text()?).ok_or(node));
    Ok(PictureOptions {
        size: size?,
        theme: theme?,
        fps: fps?,
        show: show?,
        color_by: color_by?,
        language: language?,
        ..PictureOptions::default()
    })
}

fn pixels(node: &Node) -> Result<u32, &Node> {
    node.count_in(1..=u64::from(MAX_SIDE)).map(|count| count as u32)
}

fn overlays(node: &Node) -> Result<Overlays, &Node> {
    let mut overlays = Overlays::default();
    for node in node.nodes()? {
        let overlay = Overlay::named(node.text()?).ok_or(node)?;
        if !overlays.insert(overlay) {
            return Err(node);
        }
    }
    Ok(overlays)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Rect;
    use crate::scene::{diagnostic::Reporter, tree::parse_toml};

    fn run(keys: &str) -> RunOptions {
        read_run(&Table::open("run", &parse_toml(keys).unwrap(), RUN_KEYS, &Reporter::default()).unwrap()).0.unwrap()
    }

    #[test]
    fn walls_and_bodies_of_their_names_are_distinguished() {
        let spawns = Walls { material: None }.spawn_requests([16.0, 9.0]).map(|request| {
            let name = request.blueprint.name.clone().unwrap_or_default();
            Spawn::new(name, request.rect(), request.blueprint.mass)
        });
        for (id, spawn) in (0..).zip(&spawns) {
            assert!(Walls::is_wall(id, spawn), "{spawn:?}");
            let moved = Spawn { rect: Rect::new(Vector::new(0.25, 0.25), 1.0, 1.0), ..spawn.clone() };
            let others = [
                (id + 4, spawn.clone()),
                ((id + 1) % 4, spawn.clone()),
                (id, moved),
                (id, Spawn { mass: 1.0, ..spawn.clone() }),
                (id, Spawn { name: "wall-plate".into(), ..spawn.clone() }),
                (id, spawn.clone().with_velocity(Vector::new(-2.0, 0.0))),
            ];
            for (id, other) in others {
                assert!(!Walls::is_wall(id, &other), "{id}: {other:?}");
            }
        }
    }

    #[test]
    fn a_duration_is_rounded_to_the_nearest_step() {
        let steps = |keys: &str| run(&format!("solver = \"handout\"\n{keys}")).steps;
        assert_eq!(steps("rate = 60\nduration = 10.0"), 600);
        assert_eq!(steps("rate = 0.3\nduration = 10"), 3);
        assert_eq!(steps("rate = 7\nduration = 0.5"), 4, "3.5 is rounded away from 0");
        assert_eq!(steps("rate = 1e-300\nduration = 1"), 0);
    }

    #[test]
    fn all_keys_but_the_steps_have_defaults() {
        let expected = RunOptions { rate: 60.0, steps: 5, solver: SolverKind::EventDriven, events_per_step: 1_000_000 };
        assert_eq!(run("steps = 5"), expected);
        assert_eq!(run("duration = 0.25").steps, 15);
    }
}
