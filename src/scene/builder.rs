//! Building scenes in code.
//!
//! A [`SceneBuilder`] has the tables of a scene file; each table has a method for each of its keys, with the same name
//! and unit. [`SceneBuilder::build`] writes such a file and parses it, so that a scene from code is checked like a
//! scene from a file, and a recording contains it as text.
//!
//! Optional keys have the defaults of the file. Keys that a file must give have a default here, too: 600 steps,
//! bodies of 1 m × 1 m and 1 kg.

use super::{
    PictureOptions, Scene, SceneError,
    options::{DEFAULT_RATE, DEFAULT_SIZE, DEFAULT_SOLVER},
    parse,
};
use crate::physics::{DEFAULT_EVENTS_PER_STEP, SolverKind};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Declares a table of the scene file, each key once: the method that sets it, its type and its default.
macro_rules! table {
    ($(#[$table_doc:meta])* $table:ident {
        $($(#[doc = $doc:literal])* $(#[serde($($serde:tt)*)])? $key:ident($given:ty): $type:ty = $default:expr;)+
    }) => {
        $(#[$table_doc])*
        #[must_use]
        #[derive(Clone, Debug, PartialEq, Serialize)]
        pub struct $table { $($(#[serde($($serde)*)])? $key: $type,)+ }

        impl $table {
            $($(#[doc = $doc])* pub fn $key(self, $key: $given) -> $table {
                $table { $key: $key.into(), ..self }
            })+
        }

        impl Default for $table {
            fn default() -> $table {
                $table { $($key: $default,)+ }
            }
        }
    };
}

/// Declares a method that creates a table with the defaults.
macro_rules! new_table {
    ($($table:ident)+) => {
        $(impl $table {
            /// The table with its defaults.
            pub fn new() -> $table {
                $table::default()
            }
        })+
    };
}

/// The tables of a scene file.
///
/// ```
/// use rebond::{BlueprintTable, SceneBuilder, SpawnTable, WorldTable};
///
/// let scene = SceneBuilder::new()
///     .world(WorldTable::new().walls(true).gravity([0.0, 9.81]))
///     .restitution("default", 0.5)
///     .spawn(SpawnTable::new([2.0, 3.0], BlueprintTable::new().name("c").mass(2.0).velocity([4.0, 0.0])))
///     .spawn(SpawnTable::new([8.0, 3.0], BlueprintTable::new().size([2.0, 1.0])).step(60))
///     .build("two-boxes.toml")?;
/// assert_eq!(scene.run.steps, 600);
/// # Ok::<(), rebond::SceneError>(())
/// ```
#[must_use]
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SceneBuilder {
    #[serde(skip_serializing_if = "String::is_empty")]
    title: String,
    world: WorldTable,
    run: RunTable,
    restitution: BTreeMap<String, f64>,
    spawn: Vec<SpawnTable>,
    delete: Vec<DeleteTable>,
    click: Vec<ClickTable>,
    scatter: Vec<ScatterTable>,
    figure: PictureOptions,
}

table! {
    /// `[world]`: by default 16 m × 9 m, without walls and gravity.
    WorldTable {
        /// Sets width and height of the visible world, which the walls enclose, m.
        size([f64; 2]): [f64; 2] = DEFAULT_SIZE;
        /// Adds four static walls just outside the world.
        walls(bool): bool = false;
        /// Sets the material of the walls.
        #[serde(skip_serializing_if = "String::is_empty")]
        wall_material(impl Into<String>): String = String::new();
        /// Sets gravity, m/s², y down. Without it, no weight is computed at all.
        gravity([f64; 2]): Option<[f64; 2]> = None;
    }
}

table! {
    /// `[run]`: by default 600 steps at 60 Hz with the event-driven solver.
    RunTable {
        /// Sets the steps per second, Hz.
        rate(f64): f64 = DEFAULT_RATE;
        /// Sets the number of steps.
        steps(u64): u64 = 600;
        /// Sets the solver.
        #[serde(serialize_with = "solver_name")]
        solver(SolverKind): SolverKind = DEFAULT_SOLVER;
        /// Sets the largest number of events within one step; the run ends with an error beyond it.
        events_per_step(u64): u64 = DEFAULT_EVENTS_PER_STEP;
    }
}

table! {
    /// The keys of a body in `[[spawn]]` and `[[click]]`, except its position: by default 1 m × 1 m and 1 kg, at rest.
    BlueprintTable {
        /// Sets the name, unique among the bodies alive; a body without a name is called `#K`, the K-th spawned in the
        /// run.
        #[serde(skip_serializing_if = "String::is_empty")]
        name(impl Into<String>): String = String::new();
        /// Sets width and height, m.
        size([f64; 2]): [f64; 2] = [1.0, 1.0];
        /// Sets the mass, kg; infinite for a body that nothing can push.
        mass(f64): f64 = 1.0;
        /// Sets the initial velocity, m/s.
        velocity([f64; 2]): [f64; 2] = [0.0, 0.0];
        /// Sets the constant force, N.
        force([f64; 2]): [f64; 2] = [0.0, 0.0];
        /// Sets the material.
        #[serde(skip_serializing_if = "String::is_empty")]
        material(impl Into<String>): String = String::new();
        /// Sets the colour in pictures, `#rrggbb`.
        #[serde(skip_serializing_if = "String::is_empty")]
        color(impl Into<String>): String = String::new();
        /// Sets the path of a PNG file that pictures draw into the box, relative to the folder of the scene. The files
        /// are read by [`Scene::load_images`].
        #[serde(skip_serializing_if = "String::is_empty")]
        image(impl Into<String>): String = String::new();
    }
}

/// `[[spawn]]`.
#[must_use]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpawnTable {
    step: u64,
    at: [f64; 2],
    #[serde(flatten)]
    blueprint: BlueprintTable,
}

/// `[[delete]]`.
#[must_use]
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DeleteTable {
    step: u64,
    name: String,
}

/// `[[click]]`.
#[must_use]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClickTable {
    step: u64,
    at: [f64; 2],
    spawn: Option<BlueprintTable>,
}

table! {
    /// `[[scatter]]`: random bodies in a region; by default one body of 0.2 m × 0.2 m and 1 kg at rest.
    ScatterTable {
        /// Sets the first state that contains the bodies.
        step(u64): u64 = 0;
        /// Sets the number of bodies.
        count(u64): u64 = 1;
        /// Sets the seed: the same seed gives the same bodies.
        seed(u64): u64 = 0;
        /// Sets x, y, width and height of the region, m.
        region([f64; 4]): [f64; 4] = [0.0, 0.0, DEFAULT_SIZE[0], DEFAULT_SIZE[1]];
        /// Sets the smallest and the largest width and height, m.
        size([[f64; 2]; 2]): [[f64; 2]; 2] = [[0.2, 0.2]; 2];
        /// Sets the smallest and the largest mass, kg.
        mass([f64; 2]): [f64; 2] = [1.0, 1.0];
        /// Sets the lowest and the highest velocity along each axis, m/s.
        velocity([[f64; 2]; 2]): [[f64; 2]; 2] = [[0.0, 0.0]; 2];
        /// Allows bodies to overlap when they are spawned.
        overlap(bool): bool = false;
        /// Sets the constant force, N.
        force([f64; 2]): [f64; 2] = [0.0, 0.0];
        /// Sets the material.
        #[serde(skip_serializing_if = "String::is_empty")]
        material(impl Into<String>): String = String::new();
        /// Sets the colour in pictures, `#rrggbb`.
        #[serde(skip_serializing_if = "String::is_empty")]
        color(impl Into<String>): String = String::new();
        /// Sets the path of a PNG file that pictures draw into the box, relative to the folder of the scene. The files
        /// are read by [`Scene::load_images`].
        #[serde(skip_serializing_if = "String::is_empty")]
        image(impl Into<String>): String = String::new();
    }
}

new_table! { SceneBuilder WorldTable RunTable BlueprintTable ScatterTable }

impl SpawnTable {
    /// Spawns a body at step 0 with its upper-left corner at `at`, m.
    pub fn new(at: [f64; 2], blueprint: BlueprintTable) -> SpawnTable {
        SpawnTable { step: 0, at, blueprint }
    }

    /// Sets the first state that contains the body.
    pub fn step(self, step: u64) -> SpawnTable {
        SpawnTable { step, ..self }
    }
}

impl DeleteTable {
    /// Deletes the body of that name; `step` is the first state without it.
    pub fn new(step: u64, name: impl Into<String>) -> DeleteTable {
        DeleteTable { step, name: name.into() }
    }
}

impl ClickTable {
    /// A click on the point `at`, m, which changes the state `step`.
    pub fn new(step: u64, at: [f64; 2]) -> ClickTable {
        ClickTable { step, at, spawn: None }
    }

    /// Sets the body that is spawned around the point if the click deletes none.
    pub fn spawn(self, blueprint: BlueprintTable) -> ClickTable {
        ClickTable { spawn: Some(blueprint), ..self }
    }
}

impl SceneBuilder {
    /// Sets the title.
    pub fn title(self, title: impl Into<String>) -> SceneBuilder {
        SceneBuilder { title: title.into(), ..self }
    }

    /// Sets visible world, walls and gravity.
    pub fn world(self, world: WorldTable) -> SceneBuilder {
        SceneBuilder { world, ..self }
    }

    /// Sets duration, rate and solver.
    pub fn run(self, run: RunTable) -> SceneBuilder {
        SceneBuilder { run, ..self }
    }

    /// Sets the coefficient of restitution of `"default"` or of a pair such as `"steel/wood"`.
    pub fn restitution(mut self, pair: impl Into<String>, coefficient: f64) -> SceneBuilder {
        self.restitution.insert(pair.into(), coefficient);
        self
    }

    /// Adds a body; those of one step are spawned in the order of these calls.
    pub fn spawn(mut self, spawn: SpawnTable) -> SceneBuilder {
        self.spawn.push(spawn);
        self
    }

    /// Adds the deletion of a body.
    pub fn delete(mut self, delete: DeleteTable) -> SceneBuilder {
        self.delete.push(delete);
        self
    }

    /// Adds a mouse click.
    pub fn click(mut self, click: ClickTable) -> SceneBuilder {
        self.click.push(click);
        self
    }

    /// Adds a group of random bodies.
    pub fn scatter(mut self, scatter: ScatterTable) -> SceneBuilder {
        self.scatter.push(scatter);
        self
    }

    /// Sets defaults of pictures: only the keys of `[figure]`.
    pub fn figure(self, figure: PictureOptions) -> SceneBuilder {
        SceneBuilder { figure, ..self }
    }

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
    use crate::picture_options::Language;
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
            let spawn = SpawnTable::new([0.0, 0.0], BlueprintTable::new().velocity([number, 0.0]));
            let scene = SceneBuilder::new().spawn(spawn).build("numbers").unwrap();
            let Action::Spawn(request) = &scene.inputs[0].action else { panic!("a spawn") };
            assert_eq!(request.blueprint.velocity.x.to_bits(), number.to_bits(), "{number}");
        }
    }

    #[test]
    fn every_table_is_written_and_read() {
        let blueprint = BlueprintTable::new().name("c").mass(f64::INFINITY).color("#3366cc");
        let figure = PictureOptions {
            size: Some([320, 180]),
            theme: Some(Theme::Dark),
            fps: Some(25.0),
            show: Some([Overlay::Clock].into()),
            color_by: Some(ColorBy::Speed),
            language: Some(Language::French),
            ..PictureOptions::default()
        };
        let builder = SceneBuilder::new()
            .title("All \"of\" it")
            .world(WorldTable::new().walls(true).wall_material("steel").gravity([0.0, 9.81]))
            .run(RunTable::new().rate(100.0).steps(20).solver(SolverKind::Handout).events_per_step(7))
            .restitution("default", 0.5)
            .restitution("steel/steel", 0.95)
            .spawn(SpawnTable::new([0.0, 0.0], blueprint).step(1))
            .delete(DeleteTable::new(3, "c"))
            .click(ClickTable::new(4, [9.0, 5.0]).spawn(BlueprintTable::new().material("wood").force([1.0, 0.0])))
            .click(ClickTable::new(5, [0.0, 0.0]))
            .scatter(ScatterTable::new().count(10).seed(7).region([2.0, 2.0, 5.0, 5.0]))
            .figure(figure);
        let scene = builder.build("all").unwrap();
        assert_eq!(scene.inputs.len(), 4 + 1 + 1 + 2 + 10);
        assert_eq!(scene.figure, builder.figure);
        assert_eq!(scene.restitution.pairs().len(), 1);
        assert_eq!((scene.run.rate, scene.run.steps, scene.run.events_per_step), (100.0, 20, 7));
    }

    #[test]
    fn errors_are_those_of_a_file() {
        let spawn = SpawnTable::new([0.0, 0.0], BlueprintTable::new().mass(-1.0));
        let error = SceneBuilder::new().spawn(spawn).build("wrong").unwrap_err();
        assert_eq!(error.to_string(), "`spawn.mass` cannot be -1.0");
    }
}
