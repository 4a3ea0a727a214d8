//! Scenes written in code.
//!
//! A [`Draft`] has the tables of a scene file and the keys of its tables, under the same names and
//! with the same units and defaults; [`Draft::scene`] writes it as such a file and reads that. So
//! what code asks for is checked as what people write is, and a recording carries it as its scene.

use super::{ColorBy, Overlay, Scene, SceneError, Theme, parse};
use crate::physics::{DEFAULT_EVENTS_PER_STEP, SolverKind};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// A scene as code writes it.
///
/// ```
/// use rebond::scene::draft::{Draft, Spawn, World};
///
/// let scene = Draft {
///     world: World { walls: true, gravity: Some([0.0, 9.81]), ..World::default() },
///     spawn: vec![
///         Spawn { name: Some("c".into()), at: [2.0, 3.0], mass: 2.0, velocity: [4.0, 0.0], ..Spawn::default() },
///         Spawn { at: [8.0, 3.0], size: [2.0, 1.0], ..Spawn::default() },
///     ],
///     restitution: [("default".into(), 0.5)].into(),
///     ..Draft::default()
/// }
/// .scene("two-boxes.toml")?;
/// assert_eq!(scene.run.steps, 600);
/// # Ok::<(), rebond::scene::SceneError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Draft {
    /// What it calls itself.
    pub title: Option<String>,
    /// What the camera shows, walls and gravity.
    pub world: World,
    /// How far, how finely and by which solver.
    pub run: Run,
    /// e for `"default"` and for pairs such as `"steel/wood"`.
    pub restitution: BTreeMap<String, f64>,
    /// Bodies, in the order in which those of one step come into being.
    pub spawn: Vec<Spawn>,
    /// Bodies that go.
    pub delete: Vec<Delete>,
    /// Clicks of the handout's mouse.
    pub click: Vec<Click>,
    /// Many bodies from a seed.
    pub scatter: Vec<Scatter>,
    /// How pictures look.
    pub figure: Figure,
}

/// `[world]`: 16 m × 9 m without walls and gravity, unless told otherwise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct World {
    /// Width and height of what the camera shows and walls stand around, m.
    pub size: [f64; 2],
    /// Whether the handout's four walls stand just outside.
    pub walls: bool,
    /// What they are made of.
    pub wall_material: Option<String>,
    /// m/s², y down; none means that nothing is computed for it.
    pub gravity: Option<[f64; 2]>,
}

/// `[run]`: 600 steps at 60 Hz by the event-driven solver, unless told otherwise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// Steps per second, Hz.
    pub rate: f64,
    /// Steps from the first state to the last.
    pub steps: u64,
    /// Which solver.
    #[serde(serialize_with = "solver_name")]
    pub solver: SolverKind,
    /// How much may happen within one step before the run is given up.
    pub events_per_step: u64,
}

/// `[[spawn]]`: at rest at the origin, 1 m × 1 m, 1 kg, from the start, unless told otherwise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spawn {
    /// Unique while alive; one without is called `#K`, the K-th of the run.
    pub name: Option<String>,
    /// The state in which it is there first.
    pub step: u64,
    /// Upper-left corner, m.
    pub at: [f64; 2],
    /// Width and height, m.
    pub size: [f64; 2],
    /// kg; infinity for what is never pushed.
    pub mass: f64,
    /// First velocity, m/s.
    pub velocity: [f64; 2],
    /// Constant force, N.
    pub force: [f64; 2],
    /// What it is made of.
    pub material: Option<String>,
    /// Its colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

/// `[[delete]]`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Delete {
    /// The first state without the body.
    pub step: u64,
    /// Its name.
    pub name: String,
}

/// `[[click]]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Click {
    /// The state it changes.
    pub step: u64,
    /// Where, m.
    pub at: [f64; 2],
    /// What is spawned around that point if nothing is there to be deleted.
    pub spawn: Option<Blueprint>,
}

/// The body that a click spawns: the keys of [`Spawn`] but for its place and step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blueprint {
    /// Unique while alive.
    pub name: Option<String>,
    /// Width and height, m.
    pub size: [f64; 2],
    /// kg; infinity for what is never pushed.
    pub mass: f64,
    /// First velocity, m/s.
    pub velocity: [f64; 2],
    /// Constant force, N.
    pub force: [f64; 2],
    /// What it is made of.
    pub material: Option<String>,
    /// Its colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

/// `[[scatter]]`: many bodies in a region, none, 0.2 m × 0.2 m, 1 kg, at rest, unless told otherwise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scatter {
    /// The state in which they are there first.
    pub step: u64,
    /// How many.
    pub count: u64,
    /// The same seed means the same bodies.
    pub seed: u64,
    /// x, y, width and height, m.
    pub region: [f64; 4],
    /// The smallest and the largest width and height, m.
    pub size: [[f64; 2]; 2],
    /// The smallest and the largest, kg.
    pub mass: [f64; 2],
    /// The lowest and the highest along each axis, m/s.
    pub velocity: [[f64; 2]; 2],
    /// Whether bodies may be spawned inside each other.
    pub overlap: bool,
    /// Constant force, N.
    pub force: [f64; 2],
    /// What they are made of.
    pub material: Option<String>,
    /// Their colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

/// `[figure]`: what is left open the defaults of pictures say.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figure {
    /// Width and height, px.
    pub size: Option<[u32; 2]>,
    /// Light or dark.
    #[serde(serialize_with = "theme_name")]
    pub theme: Option<Theme>,
    /// Frames per second of animations.
    pub fps: Option<f64>,
    /// What is drawn beside the boxes.
    #[serde(serialize_with = "overlay_names")]
    pub show: Option<Vec<Overlay>>,
    /// What colours tell.
    #[serde(serialize_with = "color_by_name")]
    pub color_by: Option<ColorBy>,
}

impl Default for World {
    fn default() -> World {
        World { size: [16.0, 9.0], walls: false, wall_material: None, gravity: None }
    }
}

impl Default for Run {
    fn default() -> Run {
        let events_per_step = DEFAULT_EVENTS_PER_STEP;
        Run { rate: 60.0, steps: 600, solver: SolverKind::EventDriven, events_per_step }
    }
}

impl Default for Spawn {
    fn default() -> Spawn {
        Spawn {
            name: None,
            step: 0,
            at: [0.0, 0.0],
            size: [1.0, 1.0],
            mass: 1.0,
            velocity: [0.0, 0.0],
            force: [0.0, 0.0],
            material: None,
            color: None,
        }
    }
}

impl Default for Blueprint {
    fn default() -> Blueprint {
        let Spawn { name, size, mass, velocity, force, material, color, .. } = Spawn::default();
        Blueprint { name, size, mass, velocity, force, material, color }
    }
}

impl Default for Scatter {
    fn default() -> Scatter {
        Scatter {
            step: 0,
            count: 1,
            seed: 0,
            region: [0.0, 0.0, 16.0, 9.0],
            size: [[0.2, 0.2]; 2],
            mass: [1.0, 1.0],
            velocity: [[0.0, 0.0]; 2],
            overlap: false,
            force: [0.0, 0.0],
            material: None,
            color: None,
        }
    }
}

impl Draft {
    /// The scene that was drafted; `name` is what errors and recordings call it.
    ///
    /// # Errors
    /// As for [`parse`]: what is wrong is shown in [`Draft::text`].
    pub fn scene(&self, name: &str) -> Result<Scene, SceneError> {
        parse(name, &self.text())
    }

    /// The draft as a scene file, which gives the same scene.
    pub fn text(&self) -> String {
        // Only a count beyond 2⁶³ cannot be written; what is then missing is refused.
        toml::to_string(self).unwrap_or_else(|error| format!("# {error}\n"))
    }
}

fn solver_name<S: Serializer>(solver: &SolverKind, out: S) -> Result<S::Ok, S::Error> {
    out.serialize_str(solver.name())
}

fn theme_name<S: Serializer>(theme: &Option<Theme>, out: S) -> Result<S::Ok, S::Error> {
    theme.map(Theme::name).serialize(out)
}

fn color_by_name<S: Serializer>(color_by: &Option<ColorBy>, out: S) -> Result<S::Ok, S::Error> {
    color_by.map(ColorBy::name).serialize(out)
}

fn overlay_names<S: Serializer>(show: &Option<Vec<Overlay>>, out: S) -> Result<S::Ok, S::Error> {
    let names = show.as_ref().map(|show| show.iter().map(|overlay| overlay.name()).collect::<Vec<&str>>());
    names.serialize(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Action;

    #[test]
    fn an_empty_draft_is_an_empty_scene() {
        let scene = Draft::default().scene("empty").unwrap();
        assert!(scene.inputs.is_empty() && scene.title.is_none() && scene.walls.is_none());
        assert_eq!(
            scene.run,
            crate::scene::RunOptions {
                rate: 60.0,
                steps: 600,
                solver: SolverKind::EventDriven,
                events_per_step: 1_000_000
            }
        );
    }

    #[test]
    fn numbers_come_through_to_the_bit() {
        let strange = [0.1 + 0.2, 5e-324, -1.7976931348623157e308, 1e17, 123_456_789.123_456_79, -0.0];
        for number in strange {
            let spawn = Spawn { velocity: [number, 0.0], mass: f64::INFINITY, ..Spawn::default() };
            let spawn = Spawn { mass: 1.0, ..spawn };
            let scene = Draft { spawn: vec![spawn], ..Draft::default() }.scene("numbers").unwrap();
            let Action::Spawn(request) = &scene.inputs[0].action else { panic!("a spawn") };
            assert_eq!(request.velocity.x.to_bits(), number.to_bits(), "{number}");
        }
    }

    #[test]
    fn every_table_is_written_and_read() {
        let draft = Draft {
            title: Some("All \"of\" it".into()),
            world: World {
                walls: true,
                wall_material: Some("steel".into()),
                gravity: Some([0.0, 9.81]),
                ..World::default()
            },
            restitution: [("default".into(), 0.5), ("steel/steel".into(), 0.95)].into(),
            spawn: vec![Spawn {
                name: Some("c".into()),
                mass: f64::INFINITY,
                color: Some("#3366cc".into()),
                ..Spawn::default()
            }],
            delete: vec![Delete { step: 3, name: "c".into() }],
            click: vec![
                Click { step: 4, at: [9.0, 5.0], spawn: Some(Blueprint::default()) },
                Click { step: 5, at: [0.0, 0.0], spawn: None },
            ],
            scatter: vec![Scatter { count: 10, seed: 7, region: [2.0, 2.0, 5.0, 5.0], ..Scatter::default() }],
            figure: Figure {
                size: Some([320, 180]),
                theme: Some(Theme::Dark),
                fps: Some(25.0),
                show: Some(vec![Overlay::Clock]),
                color_by: Some(ColorBy::Speed),
            },
            ..Draft::default()
        };
        let scene = draft.scene("all").unwrap();
        assert_eq!(scene.inputs.len(), 4 + 1 + 1 + 2 + 10);
        assert_eq!(scene.figure.show.as_deref(), Some(&[Overlay::Clock][..]));
        assert_eq!(scene.restitution.pairs().len(), 1);
    }

    #[test]
    fn what_is_wrong_is_refused_as_in_a_file() {
        let spawn = vec![Spawn { mass: -1.0, ..Spawn::default() }];
        let error = Draft { spawn, ..Draft::default() }.scene("wrong").unwrap_err();
        assert_eq!(error.to_string(), "`spawn.mass` cannot be -1.0");
    }
}
