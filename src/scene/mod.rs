//! What a run is asked to be: a TOML file made into plain, checked values.
//!
//! [`load`] or [`parse`] gives a [`Scene`], as does a [`draft`] in code; [`live::parse_line`] reads one more [`Action`]
//! from a line of JSON. Both refuse what they do not understand with one [`SceneError`]
//! that points at the text and says what would be accepted.

mod action;
pub mod draft;
mod fault;
mod figure_options;
mod input;
mod lifetimes;
pub mod live;
mod random;
mod refusal;
mod restitution;
mod room;
mod run_options;
mod scatter;
mod scene_error;
mod setting;
mod source;
mod spawn_request;
mod timeline;
mod tree;
mod walls;
mod world_options;

use std::{fs::File, io::Read, path::Path};

use crate::physics::{Restitution, Vector};

pub use action::Action;
pub use fault::Fault;
pub use figure_options::{ColorBy, FigureOptions, Overlay, Theme};
pub use input::Input;
pub use run_options::RunOptions;
pub use scene_error::{Excerpt, Flaw, SceneError};
pub use setting::Setting;
pub use source::{Place, SceneSource};
pub use spawn_request::{Blueprint, SpawnRequest};
pub use walls::Walls;

use refusal::Refusal;
use tree::{Key, Node, Table};

/// A scene: all that a run starts from.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What the scene calls itself.
    pub title: Option<String>,
    /// The text it was made of.
    pub source: SceneSource,
    /// Width and height of what the camera shows, m; positive.
    pub size: [f64; 2],
    /// m/s²; absent means that nothing is computed for it.
    pub gravity: Option<Vector>,
    /// The handout's four walls, if the scene asks for them; they are also the first of its inputs.
    pub walls: Option<Walls>,
    /// How far, how finely and by which solver.
    pub run: RunOptions,
    /// e for each pair of materials.
    pub restitution: Restitution,
    /// What happens to the world, ordered by step, within a step deletes before spawns
    /// before clicks, and otherwise as the file has it. Walls come first of all.
    pub inputs: Vec<Input>,
    /// How pictures look.
    pub figure: FigureOptions,
}

/// The longest scene that is read, bytes: it is attached to the recording, whose records
/// have this limit.
pub const LONGEST_SCENE: u64 = 32 << 20;

const TITLE: Key = Key { name: "title", accepts: "1 to 256 bytes without control characters" };
const WORLD: Key = Key { name: "world", accepts: "the table [world] with at least size" };
const RUN: Key = Key { name: "run", accepts: "the table [run] with at least rate, steps or duration, and solver" };
const RESTITUTION: Key = Key { name: "restitution", accepts: "the table [restitution] of pairs of materials" };
const FIGURE: Key = Key { name: "figure", accepts: "the table [figure]" };

/// The scene in `text`; `path` is what errors call it.
///
/// # Errors
/// [`SceneError::Scene`] for the first thing in the text that is not as the format has it.
pub fn parse(path: &str, text: &str) -> Result<Scene, SceneError> {
    let source = SceneSource { path: path.into(), text: text.into() };
    match read(&source) {
        Ok(scene) => Ok(scene),
        Err(refusal) => Err(SceneError::in_scene(&source, refusal)),
    }
}

/// The scene in the file at `path`.
///
/// # Errors
/// Those of [`parse`], and the file being unreadable, too long or not text.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    parse(&path.to_string_lossy(), &text_of(path)?)
}

/// The scene in the file at `path` with some values set anew: for studies of a parameter.
///
/// Its source is the text so changed: a recording of it stands alone.
///
/// # Errors
/// Those of [`load`], and [`SceneError::Setting`] where the scene has no place for a value.
pub fn load_with(path: &Path, settings: &[Setting]) -> Result<Scene, SceneError> {
    let text = setting::set(path, &text_of(path)?, settings)?;
    let settings: Vec<String> = settings.iter().map(|setting| format!(" --set {setting}")).collect();
    let called = path.to_string_lossy();
    let mut scene = parse(&(called.to_string() + &settings.concat()), &text)?;
    scene.source.path = called.into();
    Ok(scene)
}

fn text_of(path: &Path) -> Result<String, SceneError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LONGEST_SCENE + 1).read_to_end(&mut bytes))
        .map_err(|error| SceneError::Unreadable { path: path.into(), error })?;
    if bytes.len() as u64 > LONGEST_SCENE {
        return Err(SceneError::TooLong { path: path.into(), limit: LONGEST_SCENE });
    }
    String::from_utf8(bytes)
        .map_err(|error| SceneError::NotText { path: path.into(), byte: error.utf8_error().valid_up_to() })
}

fn read(source: &SceneSource) -> Result<Scene, Refusal> {
    let root = tree::parse_toml(&source.text)?;
    let keys = [&[TITLE, WORLD, RUN, RESTITUTION, FIGURE], timeline::KEYS.as_slice()].concat();
    let root = Table::open("", &root, &keys)?;
    let world = world_options::read(root.require(WORLD)?.node)?;
    let run = run_options::read(root.require(RUN)?.node)?;
    Ok(Scene {
        title: root.optional(TITLE, Node::text)?.map(String::from),
        restitution: root
            .get(RESTITUTION)
            .map_or_else(|| Ok(Restitution::new(1.0, &[])), |field| restitution::read(field.node))?,
        figure: root
            .get(FIGURE)
            .map_or_else(|| Ok(FigureOptions::default()), |field| figure_options::read(field.node))?,
        inputs: timeline::read(&root, &world, run.steps)?,
        size: world.size,
        gravity: world.gravity,
        walls: world.walls.map(|(walls, _)| walls),
        run,
        source: source.clone(),
    })
}
