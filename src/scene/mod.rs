//! Reading scenes: a TOML file or text becomes a [`Scene`] of plain, checked values.
//!
//! [`load`] reads a file, [`parse`] a text, and [`builder`] builds a scene in code; [`live::parse_line`] reads an
//! [`Action`] from a line of JSON. All of them refuse invalid input with one [`SceneError`], which lists all
//! independent errors with their location in the text and the values that would be accepted.

mod action;
pub mod builder;
mod diagnostic;
#[cfg(test)]
mod guide_tests;
mod images;
mod inputs;
mod lifetimes;
pub mod live;
mod options;
#[cfg(feature = "cli")]
mod overrides;
mod scatter;
mod tree;

use crate::physics::{Restitution, Vector};
use crate::recording::{SceneImage, limits};
use std::{
    borrow::Cow,
    fs::File,
    io::{self, Read},
    path::Path,
};

pub use crate::picture_options::{ColorBy, Overlay, Overlays, PictureOptions, Theme, Window};
pub use action::{Action, Blueprint, Phase, SpawnRequest};
pub use diagnostic::{Diagnostic, DiagnosticKind, Diagnostics, Excerpt, SceneError};
pub use inputs::{Input, InputLocation};
pub use options::{RunOptions, WALL_NAMES, Walls};
#[cfg(feature = "cli")]
pub use overrides::{Override, Sweep, are_applied, settings};

use diagnostic::{ErrorReported, Reporter};
use options::WorldOptions;
use tree::{Field, Key, Node, Table};

/// A scene: the complete input of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The title, if given.
    pub title: Option<String>,
    /// The text that the scene was read from.
    pub source: SceneSource,
    /// Width and height of the visible world, m; positive.
    pub size: [f64; 2],
    /// Gravity, m/s². If absent, no weight is computed at all.
    pub gravity: Option<Vector>,
    /// The four walls, if the scene has them; they are also the first inputs.
    pub walls: Option<Walls>,
    /// Duration, rate and solver.
    pub run: RunOptions,
    /// The coefficient of restitution of each pair of materials.
    pub restitution: Restitution,
    /// The inputs, ordered by step; within a step walls, deletes, spawns, clicks, each in the order of the file.
    pub inputs: Vec<Input>,
    /// Defaults of the pictures.
    pub figure: PictureOptions,
    /// The image files of the bodies, ordered by name, once they were read.
    pub images: Vec<SceneImage>,
}

/// The text of a scene and its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneSource {
    /// The path as given by the user; error messages show it.
    pub path: String,
    /// The complete text.
    pub text: String,
    /// The values that were set with overrides, which the text contains: key and value of each, in their order.
    pub overrides: Vec<[String; 2]>,
}

impl SceneSource {
    /// The last part of the path: the name of the attachment in a recording.
    pub fn file_name(&self) -> &str {
        self.path.rsplit(['/', '\\']).next().unwrap_or(&self.path)
    }
}

/// The largest size of a scene file, bytes: the scene is attached to its recording.
pub const MAX_SCENE_BYTES: u64 = limits::SCENE_BYTES as u64;

const TITLE: Key = Key { name: "title", accepts: "1 to 256 bytes without control characters" };
const WORLD: Key = Key { name: "world", accepts: "the table [world]" };
const RUN: Key = Key { name: "run", accepts: "the table [run] with steps or duration" };
const RESTITUTION: Key = Key { name: "restitution", accepts: "the table [restitution]" };
const FIGURE: Key = Key { name: "figure", accepts: "the table [figure]" };

/// The keys of the document that do not hold events.
const KEYS: &[Key] = &[TITLE, WORLD, RUN, RESTITUTION, FIGURE];

/// Parses a scene; error messages call it `path`.
///
/// Line ends `\r\n` are read as `\n`, so that a recording does not depend on the system that stored the scene.
///
/// # Errors
/// [`SceneError::Scene`] with all independent errors of the text.
pub fn parse(path: &str, text: &str) -> Result<Scene, SceneError> {
    let source = SceneSource { path: path.into(), text: text.replace("\r\n", "\n"), overrides: Vec::new() };
    let reporter = Reporter::default();
    let scene = read(&source, &reporter);
    let excerpt = || Excerpt { name: source.path.clone(), line: 1, text: source.text.clone() };
    reporter.finish(scene, excerpt).map_err(SceneError::Scene)
}

/// Reads the scene in the file at `path` and its images; `-` stands for standard input.
///
/// # Errors
/// Those of [`parse`] and [`Scene::load_images`], and errors of a file that is unreadable, too long or not text.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let mut scene = parse(&name(path), &read_text(path)?)?;
    scene.load_images(path.parent().unwrap_or(Path::new("")))?;
    Ok(scene)
}

/// Reads the scene in the file at `path` with some values overridden, for parameter studies.
///
/// The source of the scene is the text with the overrides applied, so that a recording is self-contained.
///
/// # Errors
/// Those of [`load`], and [`SceneError::Override`] if a value cannot be set.
#[cfg(feature = "cli")]
pub fn load_with(path: &Path, overrides: &[Override]) -> Result<Scene, SceneError> {
    load_text(path, &read_text(path)?, overrides)
}

/// Parses the text of the file at `path`, which may be a pipe that cannot be read again, as [`load_with`] does, and
/// reads its images.
///
/// # Errors
/// Those of [`load_with`].
#[cfg(feature = "cli")]
pub fn load_text(path: &Path, text: &str, overrides: &[Override]) -> Result<Scene, SceneError> {
    let text = match overrides {
        [] => text.into(),
        [_, ..] => Cow::from(overrides::apply(path, text, overrides)?),
    };
    let options: String = overrides.iter().map(|value| format!(" --set {value}")).collect();
    let name = name(path);
    let mut scene = parse(&(name.to_string() + &options), &text)?;
    scene.load_images(path.parent().unwrap_or(Path::new("")))?;
    scene.source.path = name.into();
    scene.source.overrides = overrides.iter().map(Override::stored).collect();
    Ok(scene)
}

/// The path that stands for standard input.
const STANDARD_INPUT: &str = "-";

/// The name of a scene in its recording and in errors.
fn name(path: &Path) -> Cow<'_, str> {
    if path == Path::new(STANDARD_INPUT) { "stdin.toml".into() } else { path.to_string_lossy() }
}

fn read_text(path: &Path) -> Result<String, SceneError> {
    if path == Path::new(STANDARD_INPUT) {
        read_text_of(path, io::stdin())
    } else {
        let file = File::open(path).map_err(|error| SceneError::Unreadable { path: path.into(), error })?;
        read_text_of(path, file)
    }
}

/// Reads the text of a scene from an open file; error messages call it `path`.
///
/// # Errors
/// If the file is unreadable, too long or not text.
pub fn read_text_of(path: &Path, file: impl Read) -> Result<String, SceneError> {
    let mut bytes = Vec::new();
    let read = file.take(MAX_SCENE_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|error| SceneError::Unreadable { path: path.into(), error })?;
    if bytes.len() as u64 > MAX_SCENE_BYTES {
        return Err(SceneError::TooLong { path: path.into(), limit: MAX_SCENE_BYTES });
    }
    String::from_utf8(bytes)
        .map_err(|error| SceneError::NotText { path: path.into(), byte: error.utf8_error().valid_up_to() })
}

fn read(source: &SceneSource, reporter: &Reporter) -> Result<Scene, ErrorReported> {
    let root = tree::parse_toml(&source.text).map_err(|error| reporter.report(error))?;
    let root = Table::open("", &root, &[KEYS, inputs::KEYS].concat(), reporter)?;
    let title = root.optional(TITLE, Node::text).map(|title| title.map(String::from));
    let world = read_world(root.get(WORLD), reporter);
    let (run, last) =
        match root.require(RUN).and_then(|field| Table::open("run", field.node, options::RUN_KEYS, reporter)) {
            Ok(table) => options::read_run(&table),
            Err(reported) => (Err(reported), Err(reported)),
        };
    let restitution = root.get(RESTITUTION).and_then(|field| match field {
        Some(field) => options::read_restitution(field.node, reporter),
        None => Ok(Restitution::new(options::DEFAULT_RESTITUTION, &[])),
    });
    let figure = root.get(FIGURE).and_then(|field| match field {
        Some(field) => options::read_figure(&Table::open("figure", field.node, options::FIGURE_KEYS, reporter)?),
        None => Ok(PictureOptions::default()),
    });
    let inputs = inputs::read(&root, &world, last.ok(), reporter);
    Ok(Scene {
        title: title?,
        source: source.clone(),
        size: world.size?,
        gravity: world.gravity?,
        walls: world.walls?.map(|(walls, _)| walls),
        run: run?,
        restitution: restitution?,
        inputs: inputs?,
        figure: figure?,
        images: Vec::new(),
    })
}

fn read_world(field: Result<Option<Field>, ErrorReported>, reporter: &Reporter) -> WorldOptions {
    match field.and_then(|field| {
        field.map(|field| Table::open("world", field.node, options::WORLD_KEYS, reporter)).transpose()
    }) {
        Ok(Some(table)) => options::read_world(&table),
        Ok(None) => WorldOptions::default(),
        Err(reported) => WorldOptions::unreadable(reported),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use options::{DEFAULT_RATE, DEFAULT_SIZE, DEFAULT_SOLVER};

    fn messages(text: &str) -> Vec<String> {
        let error = parse("scene.toml", text).expect_err("an error");
        error.diagnostics().expect("errors of the text").listed().map(ToString::to_string).collect()
    }

    #[test]
    fn the_number_of_steps_is_all_that_a_scene_needs() {
        let scene = parse("scene.toml", "[run]\nsteps = 5\n").unwrap();
        assert_eq!((scene.size, scene.run.rate, scene.run.solver), (DEFAULT_SIZE, DEFAULT_RATE, DEFAULT_SOLVER));
        let explicit = "[world]\nsize = [16.0, 9.0]\n[run]\nsteps = 5\nrate = 60\nsolver = \"event-driven\"\n";
        let explicit = parse("scene.toml", explicit).unwrap();
        assert_eq!(Scene { source: scene.source.clone(), ..explicit }, scene);
    }

    #[test]
    fn all_independent_errors_are_reported_in_the_order_of_the_file() {
        let text = "[world]\nwals = true\n[run]\nsteps = 10\nsolver = \"box2d\"\n\
                    [[delete]]\nname = \"nobody\"\n\
                    [[spawn]]\nname = \"a\"\nat = [1.0, 2.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
                    [[spawn]]\nat = [1.0, 2.0]\nsize = [1.0, 1.0]\nmass = -1.0\n\
                    [[delete]]\nstep = 11\nname = \"a\"\n";
        let expected = [
            "unknown key `world.wals`",
            "`run.solver` cannot be \"box2d\"",
            "no body named \"nobody\" is alive at step 0",
            "`spawn.mass` cannot be -1.0",
            "step 11 is after the last step of the run, 10",
        ];
        assert_eq!(messages(text), expected);
    }

    #[test]
    fn a_force_that_gives_an_infinite_acceleration_is_refused() {
        let text = "[run]\nsteps = 10\n[[spawn]]\nat = [1.0, 2.0]\nsize = [1.0, 1.0]\nmass = 1e-300\nforce = [0.0, 1e300]\n\
                    [[scatter]]\ncount = 1\nregion = [0, 0, 9, 9]\nsize = [[1, 1], [1, 1]]\nmass = [1e-300, 1]\n\
                    force = [1e300, 0.0]\n";
        assert_eq!(messages(text), ["`spawn.force` cannot be [0.0, 1e300]", "`scatter.force` cannot be [1e300, 0.0]"]);
    }

    /// At 1e17 m a thickness of 1 m is rounded away.
    #[test]
    fn a_world_is_not_so_large_that_its_walls_cannot_be_spawned() {
        let scene = |size: &str, walls| format!("[world]\nsize = {size}\nwalls = {walls}\n[run]\nsteps = 10\n");
        for size in ["[1e17, 9.0]", "[16.0, 1e308]"] {
            assert_eq!(messages(&scene(size, true)), [format!("`world.size` cannot be {size}")]);
            assert!(parse("scene.toml", &scene(size, false)).is_ok());
        }
        assert!(parse("scene.toml", &scene("[1e14, 1e14]", true)).is_ok());
    }

    #[test]
    fn a_misspelled_key_is_not_also_reported_as_missing() {
        let text = "[rum]\nsteps = 10\n[[spawn]]\nat = [1.0, 2.0]\nsiz = [1.0, 1.0]\n";
        assert_eq!(messages(text), ["unknown key `rum`", "`spawn.mass` is missing", "unknown key `spawn.siz`"]);
        let text = "[[spawn]]\nposition = [1.0, 2.0]\nsize = [1.0, 1.0]\nmass = 1.0\n[run]\nsteps = 10\n";
        assert_eq!(messages(text), ["unknown key `spawn.position`"]);
    }

    #[test]
    fn errors_that_follow_from_another_one_are_not_reported() {
        let walls = "[world]\nwalls = 1\n[run]\nsteps = 10\n[[delete]]\nstep = 3\nname = \"wall-top\"\n";
        assert_eq!(messages(walls), ["`world.walls` cannot be 1"]);
        let steps = "[run]\nsteps = -1\n[[delete]]\nstep = 11\nname = \"a\"\n[[spawn]]\nname = \"a\"\nmass = \"x\"\n\
                     at = [1.0, 2.0]\nsize = [1.0, 1.0]\n";
        assert_eq!(messages(steps), ["`run.steps` cannot be -1", "`spawn.mass` cannot be \"x\""]);
        let rate = "[run]\nrate = 0\nduration = 1.0\n[[scatter]]\ncount = 5\nregion = [0, 0, 9, 9]\n\
                    size = [[2, 2], [1, 1]]\nmass = [1, 1]\n[[delete]]\nname = \"#5\"\nstep = 1\n";
        assert_eq!(messages(rate), ["`run.rate` cannot be 0", "`scatter.size` cannot be [[2, 2], [1, 1]]"]);
    }

    #[test]
    fn a_syntax_error_is_reported_alone() {
        let messages = messages("[world]\nwals = true\n[run]\nsteps = 10 Hz\n");
        assert!(matches!(&messages[..], [syntax] if syntax.starts_with("invalid TOML: ")), "{messages:?}");
    }

    #[test]
    fn unbalanced_brackets_before_deep_nesting_do_not_exhaust_the_stack() {
        for unbalanced in ["[]", "{}", "]", "}", "[", "{", "[}", "{]"] {
            for nested in ["[", "{a=", "[{a="] {
                let unbalanced = unbalanced.repeat(4000);
                let text = format!("a={{{unbalanced}}}\nb={{{unbalanced}\nc={}", nested.repeat(4000));
                assert!(parse("scene.toml", &text).is_err());
            }
        }
    }

    #[test]
    fn the_first_20_errors_are_listed_and_the_others_counted() {
        let text = format!("[run]\nsteps = 10\n{}", "[[delete]]\nname = \"nobody\"\n".repeat(50));
        let error = parse("scene.toml", &text).unwrap_err();
        let diagnostics = error.diagnostics().unwrap();
        assert_eq!((diagnostics.listed().count(), diagnostics.omitted()), (20, 30));
    }

    #[test]
    fn a_file_name_contains_no_folder() {
        let named = |path: &str| SceneSource { path: path.into(), text: String::new(), overrides: Vec::new() };
        assert_eq!(named("recordings/gas.toml").file_name(), "gas.toml");
        assert_eq!(named(r"C:\scenes\gas.toml").file_name(), "gas.toml");
        assert_eq!(named("gas.toml").file_name(), "gas.toml");
    }
}
