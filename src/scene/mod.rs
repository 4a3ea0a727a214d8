//! What a run is asked to be: a TOML file made into plain, checked values.
//!
//! [`load`] or [`parse`] gives a [`Scene`]; [`live::parse_line`] reads one more [`Action`]
//! from a line of JSON. Both refuse what they do not understand with one [`SceneError`]
//! that points at the text and says what would be accepted.

mod figure_options;
mod input;
pub mod live;
mod run_options;
mod scene_error;
mod source;
mod spawn_request;

use crate::physics::{Restitution, Vector};

pub use figure_options::{ColorBy, FigureOptions, Overlay, Theme};
pub use input::{Action, Input};
pub use run_options::RunOptions;
pub use scene_error::{Fault, SceneError};
pub use source::{Place, SceneSource};
pub use spawn_request::{Blueprint, SpawnRequest};

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

/// The four walls just outside the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Walls {
    /// What they are made of.
    pub material: Option<String>,
}

/// The scene in `text`; `path` is what errors call it.
///
/// # Errors
/// The first thing in the text that is not as the scene format has it.
pub fn parse(path: &str, text: &str) -> Result<Scene, SceneError> {
    let _ = (path, text);
    todo!("the types come first")
}

/// The scene in the file at `path`.
///
/// # Errors
/// Those of [`parse`], and the file being unreadable, too long or not text.
pub fn load(path: &std::path::Path) -> Result<Scene, SceneError> {
    let _ = path;
    todo!("the types come first")
}
