//! Tables of recordings, as CSV or JSON Lines.

use crate::physics::{Axis, BodyId, Collision, Engine, Observer};
use crate::picture::{self, EnergySample};
use crate::recording::{BodyInfo, SampledState};
use crate::text::csv_field;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The kind of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Table {
    /// Positions and velocities
    States,
    /// Impulses
    Collisions,
    /// Energy and momentum
    Energy,
    /// Constants of the bodies
    Bodies,
}

impl Table {
    /// The columns, without the source.
    pub const fn columns(self) -> &'static [&'static str] {
        match self {
            Table::States => &["step", "time", "name", "x", "y", "vx", "vy"],
            Table::Collisions => {
                &["time", "step", "a", "b", "axis", "nx", "ny", "e", "vn_before", "vn_after", "impulse"]
            }
            Table::Energy => &["step", "time", "kinetic", "potential", "total", "px", "py"],
            Table::Bodies => &[
                "name",
                "id",
                "mass",
                "width",
                "height",
                "material",
                "e_default",
                "spawned_step",
                "deleted_step",
                "fx",
                "fy",
                "color",
            ],
        }
    }
}

/// The format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated values.
    Csv,
    /// One JSON object a line.
    JsonLines,
}

/// A body with the steps of its spawn and its deletion.
pub struct Lifetime {
    /// The body.
    pub info: Arc<BodyInfo>,
    /// The first step with it.
    pub spawned: EventStep,
    /// The first step without it; `None` if it is alive at the end.
    pub deleted: Option<EventStep>,
}

/// The step of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventStep {
    /// The event is recorded.
    At(u64),
    /// The event is lost in a gap.
    Within {
        /// The first step that is possible.
        from: u64,
        /// The last step that is possible.
        to: u64,
    },
}

impl EventStep {
    /// The first and the last step that are possible.
    pub fn range(self) -> [u64; 2] {
        match self {
            EventStep::At(step) => [step, step],
            EventStep::Within { from, to } => [from, to],
        }
    }
}

/// The rows of a table, written one by one.
pub struct Rows<'a> {
    /// The format.
    pub format: TableFormat,
    /// The file.
    pub output: &'a mut dyn Write,
    /// The names of the columns, without the source.
    pub columns: &'static [&'static str],
    /// The source of the rows, if there are several.
    pub source: Option<&'a str>,
    /// The keys that were set in any of several sources, with the value of this one.
    pub settings: Vec<(String, Option<Value>)>,
}

/// A value in a row.
enum Cell<'a> {
    Integer(u64),
    Number(f64),
    Text(&'a str),
    Setting(&'a Value),
    Missing,
}

impl Rows<'_> {
    /// Writes the names of the columns, if the format has them.
    ///
    /// # Errors
    /// Those of the file; this holds for all rows.
    pub fn header(&mut self) -> io::Result<()> {
        let source = self.source.map(|_| "source".into());
        let settings = self.settings.iter().map(|(key, _)| csv_field(key));
        let columns = self.columns.iter().map(|column| (*column).into());
        let names: Vec<Cow<str>> = source.into_iter().chain(settings).chain(columns).collect();
        match self.format {
            TableFormat::Csv => writeln!(self.output, "{}", names.join(",")),
            TableFormat::JsonLines => Ok(()),
        }
    }

    /// Writes one row; `cells` are the values of the columns in their order.
    fn row<const N: usize>(&mut self, cells: [Cell; N]) -> io::Result<()> {
        debug_assert_eq!(N, self.columns.len());
        let source = self.source.map(|source| ("source", Cell::Text(source)));
        let settings = self.settings.iter().map(|(key, value)| {
            let cell = value.as_ref().map_or(Cell::Missing, Cell::Setting);
            (key.as_str(), cell)
        });
        let cells = source.into_iter().chain(settings).chain(self.columns.iter().copied().zip(cells));
        for (index, (column, cell)) in cells.enumerate() {
            match self.format {
                TableFormat::Csv => cell.write_csv(if index == 0 { "" } else { "," }, self.output)?,
                TableFormat::JsonLines => {
                    write!(self.output, "{}{}:", if index == 0 { "{" } else { "," }, Value::from(column))?;
                    cell.write_json(self.output)?;
                }
            }
        }
        self.output.write_all(match self.format {
            TableFormat::Csv => b"\n",
            TableFormat::JsonLines => b"}\n",
        })
    }

    /// Writes one row per body.
    ///
    /// # Errors
    /// Those of the file.
    pub fn state(&mut self, state: &SampledState) -> io::Result<()> {
        for body in &state.bodies {
            let [x, y] = [body.position.x, body.position.y].map(Cell::Number);
            let [vx, vy] = [body.velocity.x, body.velocity.y].map(Cell::Number);
            let name = Cell::Text(&body.info.spawn.name);
            self.row([Cell::Integer(state.step), Cell::Number(state.time), name, x, y, vx, vy])?;
        }
        Ok(())
    }

    /// Writes the row of a step.
    ///
    /// # Errors
    /// Those of the file.
    pub fn energy(&mut self, step: u64, sample: &EnergySample) -> io::Result<()> {
        let energies = [sample.kinetic, sample.potential, sample.total()];
        let [kinetic, potential, total] = energies.map(Cell::Number);
        let [px, py] = [sample.momentum.x, sample.momentum.y].map(Cell::Number);
        self.row([Cell::Integer(step), Cell::Number(sample.time), kinetic, potential, total, px, py])
    }

    /// Writes a collision with its bodies in creation order and the normal from the second to the first.
    ///
    /// # Errors
    /// Those of the file.
    pub fn collision(&mut self, collision: &Collision, names: &BTreeMap<BodyId, String>) -> io::Result<()> {
        let [c, b] = collision.bodies;
        let normal = if c < b { collision.normal } else { collision.normal.mult(-1.0) };
        let [a, b] = [c.min(b), c.max(b)].map(|id| Cell::Text(names.get(&id).map_or("", String::as_str)));
        let axis = Cell::Text(match collision.axis {
            Axis::X => "x",
            Axis::Y => "y",
        });
        // Adding 0 turns −0 into 0.
        let [nx, ny] = [normal.x + 0.0, normal.y + 0.0].map(Cell::Number);
        let Collision { instant, restitution, normal_velocity: [before, after], impulse, .. } = *collision;
        let [time, e, before, after, impulse] = [instant, restitution, before, after, impulse].map(Cell::Number);
        self.row([time, Cell::Integer(collision.step), a, b, axis, nx, ny, e, before, after, impulse])
    }

    /// Writes the row of a body.
    ///
    /// # Errors
    /// Those of the file.
    pub fn body(&mut self, Lifetime { info, spawned, deleted }: &Lifetime, default_restitution: f64) -> io::Result<()> {
        let spawn = &info.spawn;
        let [mass, width, height] = [spawn.mass, spawn.rect.width(), spawn.rect.height()].map(Cell::Number);
        let step = |step: &EventStep| match step {
            EventStep::At(step) => Cell::Integer(*step),
            EventStep::Within { .. } => Cell::Text("unknown"),
        };
        let (spawned, deleted) = (step(spawned), deleted.as_ref().map_or(Cell::Missing, step));
        let [fx, fy, e] = [spawn.force.x, spawn.force.y, default_restitution].map(Cell::Number);
        let color = picture::body_color(info).to_string();
        let [name, material, color] = [&spawn.name, &spawn.material, &color].map(|text| Cell::Text(text));
        let id = Cell::Integer(info.id.into());
        self.row([name, id, mass, width, height, material, e, spawned, deleted, fx, fy, color])
    }
}

impl Cell<'_> {
    fn write_csv(&self, separator: &str, output: &mut dyn Write) -> io::Result<()> {
        match self {
            Cell::Integer(number) => write!(output, "{separator}{number}"),
            Cell::Number(number) => write!(output, "{separator}{}", shortest_decimal(*number)),
            Cell::Text(text) => write!(output, "{separator}{}", csv_field(text)),
            Cell::Setting(Value::String(text)) => write!(output, "{separator}{}", csv_field(text)),
            Cell::Setting(value) => write!(output, "{separator}{}", csv_field(&value.to_string())),
            Cell::Missing => output.write_all(separator.as_bytes()),
        }
    }

    /// Writes the value as JSON, which has no infinite numbers: these are strings, as in CSV.
    fn write_json(&self, output: &mut dyn Write) -> io::Result<()> {
        match self {
            Cell::Integer(number) => write!(output, "{number}"),
            Cell::Number(number) if number.is_finite() => output.write_all(shortest_decimal(*number).as_bytes()),
            Cell::Number(number) => write!(output, "\"{}\"", shortest_decimal(*number)),
            Cell::Text(text) => Ok(serde_json::to_writer(output, text)?),
            Cell::Setting(value) => write!(output, "{value}"),
            Cell::Missing => output.write_all(b"null"),
        }
    }
}

/// The shortest decimal that reads back to the same bits. It contains a point or an exponent, or is `inf` or `nan`.
pub fn shortest_decimal(number: f64) -> String {
    if number.is_nan() { "nan".to_owned() } else { format!("{number:?}") }
}

/// Writes the collisions of a replay while it runs.
pub struct CollisionRows<'a, 'b> {
    steps: RangeInclusive<u64>,
    /// Seconds since step 0.
    instants: RangeInclusive<f64>,
    names: BTreeMap<BodyId, String>,
    rows: &'a mut Rows<'b>,
    /// The next id and the number of bodies when the names were last updated.
    known: (BodyId, usize),
    failure: Option<io::Error>,
}

impl Observer for CollisionRows<'_, '_> {
    fn collision(&mut self, collision: &Collision) {
        let is_chosen = self.steps.contains(&collision.step) && self.instants.contains(&collision.instant);
        if self.failure.is_none() && collision.impulse != 0.0 && is_chosen {
            self.failure = self.rows.collision(collision, &self.names).err();
        }
    }
}

impl<'a, 'b> CollisionRows<'a, 'b> {
    /// Writes the collisions of `steps` as `rows`.
    pub fn new(steps: RangeInclusive<u64>, rows: &'a mut Rows<'b>) -> CollisionRows<'a, 'b> {
        let instants = f64::NEG_INFINITY..=f64::INFINITY;
        CollisionRows { steps, instants, names: BTreeMap::new(), rows, known: (0, 0), failure: None }
    }

    /// Writes only the collisions at these instants, s.
    pub fn within(self, instants: RangeInclusive<f64>) -> CollisionRows<'a, 'b> {
        CollisionRows { instants, ..self }
    }

    /// The error of the file, once.
    pub fn take_failure(&mut self) -> Option<io::Error> {
        self.failure.take()
    }

    /// Takes the names of the bodies alive, to be called after each step.
    pub fn update_names(&mut self, engine: &Engine) {
        let bodies = &engine.world().bodies;
        if self.known != (engine.next_id(), bodies.len()) {
            self.known = (engine.next_id(), bodies.len());
            self.names = bodies.iter().map(|body| (body.id, body.name.clone())).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_same_bits_and_look_like_floats() {
        for number in [-0.0, 5e-324, 0.1 + 0.2, 1e300, -1.7976931348623157e308, 3.0, f64::NEG_INFINITY, f64::NAN] {
            let text = shortest_decimal(number);
            assert!(text.len() < 25 && [".", "e", "inf", "nan"].iter().any(|mark| text.contains(mark)), "{text}");
            let read: f64 = text.parse().unwrap();
            assert!(read.to_bits() == number.to_bits() || read.is_nan() && number.is_nan(), "{text}");
        }
    }
}
