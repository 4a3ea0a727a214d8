//! Building scenes in code.
//!
//! A [`SceneBuilder`] has the tables and keys of a scene file, with the same names and units.
//! [`SceneBuilder::build`] writes such a file and parses it, so that a scene from code is checked like a
//! scene from a file, and a recording contains it as text.
//!
//! Write the tables with `..Default::default()`: a later version may add keys to them.
//!
//! Optional keys have the defaults of the file. Keys that a file must give have a default here, too: 600 steps,
//! bodies of 1 m × 1 m and 1 kg at the origin.

use super::{
    PictureOptions, Scene, SceneError,
    options::{DEFAULT_RATE, DEFAULT_SIZE, DEFAULT_SOLVER},
    parse,
};
use crate::physics::{DEFAULT_EVENTS_PER_STEP, SolverKind};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// The tables of a scene file.
///
/// ```
/// use rebond::{SceneBuilder, SpawnTable, WorldTable};
///
/// let scene = SceneBuilder {
///     world: WorldTable { walls: true, gravity: Some([0.0, 9.81]), ..WorldTable::default() },
///     spawn: vec![
///         SpawnTable { name: Some("c".into()), at: [2.0, 3.0], mass: 2.0, velocity: [4.0, 0.0], ..SpawnTable::default() },
///         SpawnTable { at: [8.0, 3.0], size: [2.0, 1.0], ..SpawnTable::default() },
///     ],
///     restitution: [("default".into(), 0.5)].into(),
///     ..SceneBuilder::default()
/// }
/// .build("two-boxes.toml")?;
/// assert_eq!(scene.run.steps, 600);
/// # Ok::<(), rebond::SceneError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SceneBuilder {
    /// The title.
    pub title: Option<String>,
    /// Visible world, walls and gravity.
    pub world: WorldTable,
    /// Duration, rate and solver.
    pub run: RunTable,
    /// The coefficient of restitution of `"default"` and of pairs such as `"steel/wood"`.
    pub restitution: BTreeMap<String, f64>,
    /// Bodies to spawn; those of one step are spawned in this order.
    pub spawn: Vec<SpawnTable>,
    /// Bodies to delete.
    pub delete: Vec<DeleteTable>,
    /// Mouse clicks.
    pub click: Vec<ClickTable>,
    /// Groups of random bodies.
    pub scatter: Vec<ScatterTable>,
    /// Defaults of pictures: only the keys of `[figure]`.
    pub figure: PictureOptions,
}

/// `[world]`: by default 16 m × 9 m, without walls and gravity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorldTable {
    /// Width and height of the visible world, which the walls enclose, m.
    pub size: [f64; 2],
    /// True for four static walls just outside the world.
    pub walls: bool,
    /// The material of the walls.
    pub wall_material: Option<String>,
    /// Gravity, m/s², y down. If absent, no weight is computed at all.
    pub gravity: Option<[f64; 2]>,
}

/// `[run]`: by default 600 steps at 60 Hz with the event-driven solver.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunTable {
    /// Steps per second, Hz.
    pub rate: f64,
    /// The number of steps.
    pub steps: u64,
    /// The solver.
    #[serde(serialize_with = "solver_name")]
    pub solver: SolverKind,
    /// The largest number of events within one step; the run ends with an error beyond it.
    pub events_per_step: u64,
}

/// `[[spawn]]`: by default a body of 1 m × 1 m and 1 kg, at rest at the origin, spawned at step 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpawnTable {
    /// Unique among the bodies alive; a body without a name is called `#K`, the K-th spawned in the run.
    pub name: Option<String>,
    /// The first state that contains the body.
    pub step: u64,
    /// Upper-left corner, m.
    pub at: [f64; 2],
    /// Width and height, m.
    pub size: [f64; 2],
    /// Mass, kg; infinite for a body that nothing can push.
    pub mass: f64,
    /// Initial velocity, m/s.
    pub velocity: [f64; 2],
    /// Constant force, N.
    pub force: [f64; 2],
    /// The material.
    pub material: Option<String>,
    /// Colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

/// `[[delete]]`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DeleteTable {
    /// The first state without the body.
    pub step: u64,
    /// Its name.
    pub name: String,
}

/// `[[click]]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClickTable {
    /// The state that the click changes.
    pub step: u64,
    /// The point, m.
    pub at: [f64; 2],
    /// The body spawned around the point if the click deletes none.
    pub spawn: Option<BlueprintTable>,
}

/// The body that a click spawns: the keys of [`SpawnTable`] without position and step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BlueprintTable {
    /// Unique among the bodies alive.
    pub name: Option<String>,
    /// Width and height, m.
    pub size: [f64; 2],
    /// Mass, kg; infinite for a body that nothing can push.
    pub mass: f64,
    /// Initial velocity, m/s.
    pub velocity: [f64; 2],
    /// Constant force, N.
    pub force: [f64; 2],
    /// The material.
    pub material: Option<String>,
    /// Colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

/// `[[scatter]]`: random bodies in a region; by default one body of 0.2 m × 0.2 m and 1 kg at rest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScatterTable {
    /// The first state that contains the bodies.
    pub step: u64,
    /// The number of bodies.
    pub count: u64,
    /// The seed: the same seed gives the same bodies.
    pub seed: u64,
    /// x, y, width and height of the region, m.
    pub region: [f64; 4],
    /// The smallest and the largest width and height, m.
    pub size: [[f64; 2]; 2],
    /// The smallest and the largest mass, kg.
    pub mass: [f64; 2],
    /// The lowest and the highest velocity along each axis, m/s.
    pub velocity: [[f64; 2]; 2],
    /// True if bodies may overlap when they are spawned.
    pub overlap: bool,
    /// Constant force, N.
    pub force: [f64; 2],
    /// The material.
    pub material: Option<String>,
    /// Colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

impl Default for WorldTable {
    fn default() -> WorldTable {
        WorldTable { size: DEFAULT_SIZE, walls: false, wall_material: None, gravity: None }
    }
}

impl Default for RunTable {
    fn default() -> RunTable {
        let events_per_step = DEFAULT_EVENTS_PER_STEP;
        RunTable { rate: DEFAULT_RATE, steps: 600, solver: DEFAULT_SOLVER, events_per_step }
    }
}

impl Default for SpawnTable {
    fn default() -> SpawnTable {
        SpawnTable {
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

impl Default for BlueprintTable {
    fn default() -> BlueprintTable {
        let SpawnTable { name, size, mass, velocity, force, material, color, .. } = SpawnTable::default();
        BlueprintTable { name, size, mass, velocity, force, material, color }
    }
}

impl Default for ScatterTable {
    fn default() -> ScatterTable {
        ScatterTable {
            step: 0,
            count: 1,
            seed: 0,
            region: [0.0, 0.0, DEFAULT_SIZE[0], DEFAULT_SIZE[1]],
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

impl SceneBuilder {
    /// Builds the scene; errors and recordings show `path` as the path of its file.
    ///
    /// # Errors
    /// Those of [`parse`], which refer to [`SceneBuilder::text`].
    pub fn build(&self, path: &str) -> Result<Scene, SceneError> {
        parse(path, &self.text())
    }

    /// The text of a scene file with these tables.
    pub fn text(&self) -> String {
        // Only an integer of 2⁶³ or more cannot be written. The text is then a comment, which is not a valid scene
        // because [run] is missing.
        toml::to_string(self).unwrap_or_else(|error| format!("# {error}\n"))
    }
}

fn solver_name<S: Serializer>(solver: &SolverKind, out: S) -> Result<S::Ok, S::Error> {
    out.serialize_str(solver.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Action, ColorBy, Overlay, Theme};

    #[test]
    fn the_default_builder_gives_an_empty_scene() {
        let scene = SceneBuilder::default().build("empty").unwrap();
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
    fn numbers_are_kept_to_the_bit() {
        let numbers = [0.1 + 0.2, 5e-324, -1.7976931348623157e308, 1e17, 123_456_789.123_456_79, -0.0];
        for number in numbers {
            let spawn = SpawnTable { velocity: [number, 0.0], mass: f64::INFINITY, ..SpawnTable::default() };
            let spawn = SpawnTable { mass: 1.0, ..spawn };
            let scene = SceneBuilder { spawn: vec![spawn], ..SceneBuilder::default() }.build("numbers").unwrap();
            let Action::Spawn(request) = &scene.inputs[0].action else { panic!("a spawn") };
            assert_eq!(request.velocity.x.to_bits(), number.to_bits(), "{number}");
        }
    }

    #[test]
    fn every_table_is_written_and_read() {
        let builder = SceneBuilder {
            title: Some("All \"of\" it".into()),
            world: WorldTable {
                walls: true,
                wall_material: Some("steel".into()),
                gravity: Some([0.0, 9.81]),
                ..WorldTable::default()
            },
            restitution: [("default".into(), 0.5), ("steel/steel".into(), 0.95)].into(),
            spawn: vec![SpawnTable {
                name: Some("c".into()),
                mass: f64::INFINITY,
                color: Some("#3366cc".into()),
                ..SpawnTable::default()
            }],
            delete: vec![DeleteTable { step: 3, name: "c".into() }],
            click: vec![
                ClickTable { step: 4, at: [9.0, 5.0], spawn: Some(BlueprintTable::default()) },
                ClickTable { step: 5, at: [0.0, 0.0], spawn: None },
            ],
            scatter: vec![ScatterTable { count: 10, seed: 7, region: [2.0, 2.0, 5.0, 5.0], ..ScatterTable::default() }],
            figure: PictureOptions {
                size: Some([320, 180]),
                theme: Some(Theme::Dark),
                fps: Some(25.0),
                show: Some([Overlay::Clock].into()),
                color_by: Some(ColorBy::Speed),
                ..PictureOptions::default()
            },
            ..SceneBuilder::default()
        };
        let scene = builder.build("all").unwrap();
        assert_eq!(scene.inputs.len(), 4 + 1 + 1 + 2 + 10);
        assert_eq!(scene.figure, builder.figure);
        assert_eq!(scene.restitution.pairs().len(), 1);
    }

    #[test]
    fn errors_are_those_of_a_file() {
        let spawn = vec![SpawnTable { mass: -1.0, ..SpawnTable::default() }];
        let error = SceneBuilder { spawn, ..SceneBuilder::default() }.build("wrong").unwrap_err();
        assert_eq!(error.to_string(), "`spawn.mass` cannot be -1.0");
    }
}
