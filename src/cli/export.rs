use super::arguments::{ExportOptions, Shard, Table, is_standard_output};
use super::body_topics::BodyTopics;
use super::error::CommandError;
use super::output_file::{OutputFile, Overwrite};
use super::source::SourceFile;
use super::{Exit, output};
use crate::physics::{Axis, BodyId, Collision, Engine, Observer};
use crate::picture::{self, EnergySample, ReadExtent, ReadStatus, recorded_world};
use crate::picture_options::StepOrTime;
use crate::recording::{self, BodyInfo, Change, Health, Item, Playback, SampledState};
use crate::replay::Replayer;
use crate::text::csv_field;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Exports states, collisions, energies or bodies of recordings or scenes as a table.
pub fn run(options: &ExportOptions) -> Result<Exit, CommandError> {
    if options.output.extension().is_some_and(|extension| extension == "mcap") {
        return export_topics(options);
    }
    let format = Format::from_path(&options.output)?;
    let inputs: Vec<&Path> = options.sources.iter().map(PathBuf::as_path).collect();
    let output = OutputFile::create(&options.output, Overwrite::from_force(options.force), &inputs)?;
    if options.shard != Shard::WHOLE && options.sources.len() > 1 {
        return Err(CommandError::ShardOfSeveral);
    }
    let files = options.sources.iter().map(|path| SourceFile::open(path)).collect::<Result<Vec<_>, CommandError>>()?;
    let statuses = output.write(|file| {
        let mut rows = Rows { format, output: file, columns: options.table.columns(), source: None };
        let has_header = options.shard.number == 1;
        let names: Vec<String> = options.sources.iter().map(|path| path.display().to_string()).collect();
        rows.source = (names.len() > 1).then(|| names[0].as_str());
        if has_header {
            rows.header().map_err(CommandError::unwritable(&options.output))?;
        }
        let mut statuses = Vec::new();
        for ((path, file), name) in options.sources.iter().zip(&files).zip(&names) {
            rows.source = (names.len() > 1).then_some(name.as_str());
            let (health, extent) = export(path, &file.path, options, &mut rows)?;
            statuses.push(ReadStatus { path: path.clone(), health, extent });
        }
        Ok(statuses)
    })?;
    Ok(output::warn_of_damage(&statuses))
}

/// Writes the states of one source as an MCAP file with one topic per body.
fn export_topics(options: &ExportOptions) -> Result<Exit, CommandError> {
    let ([path], Table::States, Shard::WHOLE) = (&options.sources[..], options.table, options.shard) else {
        return Err(CommandError::UnsupportedOutput {
            path: options.output.clone(),
            expected: "an .mcap file has the states of one source, without --table and --shard",
        });
    };
    let output = OutputFile::create(&options.output, Overwrite::from_force(options.force), &[path])?;
    let file = SourceFile::open(path)?;
    let recording = recording::open(&file.path).map_err(CommandError::in_recording(path))?;
    let header = recording.header.clone();
    let step = |point: StepOrTime| point.step(header.config.rate);
    let steps = options.from.map_or(0, step)..=options.to.map_or(header.steps, step);
    let unwritable = CommandError::unwritable(&options.output);
    let (health, extent) = output.write(|file| {
        let mut topics = BodyTopics::new(file).map_err(&unwritable)?;
        let read = states(path, recording, steps, &options.output, |state| topics.write(state, &header))?;
        topics.finish().map_err(&unwritable)?;
        Ok(read)
    })?;
    Ok(output::warn_of_damage(&[ReadStatus { path: path.clone(), health, extent }]))
}

/// Writes the rows of one recording, the file `file` of the source `path`.
fn export(
    path: &Path,
    file: &Path,
    options: &ExportOptions,
    rows: &mut Rows,
) -> Result<(Health, ReadExtent), CommandError> {
    let recording = recording::open(file).map_err(CommandError::in_recording(path))?;
    let last = recording.header.steps;
    let step = |point: StepOrTime| point.step(recording.header.config.rate);
    let (from, to) = (options.from.map_or(0, step), options.to.map_or(last, step).min(last));
    if options.table == Table::Bodies {
        return bodies(path, recording, from..=to, options, rows);
    }
    // A shard or range without steps reads only the condition of the file.
    let empty = from.max(last + 1);
    let steps = options.shard.steps(from, to).unwrap_or_else(|| empty..=empty - 1);
    match options.table {
        Table::States => states(path, recording, steps, &options.output, |state| rows.state(state)),
        Table::Energy => {
            let config = recording.header.config.clone();
            states(path, recording, steps, &options.output, |state| {
                rows.energy(state.step, &EnergySample::of(&recorded_world(state, &config), state.time))
            })
        }
        Table::Collisions => collisions(path, recording, steps, options, rows),
        Table::Bodies => unreachable!("returned above"),
    }
}

type Recording = recording::Recording<io::BufReader<std::fs::File>>;

/// Reads the states of `steps` and passes each to `write`.
fn states(
    path: &Path,
    recording: Recording,
    steps: RangeInclusive<u64>,
    output: &Path,
    mut write: impl FnMut(&SampledState) -> io::Result<()>,
) -> Result<(Health, ReadExtent), CommandError> {
    let mut playback = Playback::new(recording);
    playback.seek(*steps.start()).map_err(CommandError::in_recording(path))?;
    for state in playback.by_ref() {
        let state = state.map_err(CommandError::in_recording(path))?;
        if state.step > *steps.end() {
            return Ok((playback.health(), ReadExtent::LastStep));
        }
        if steps.contains(&state.step) {
            write(&state).map_err(CommandError::unwritable(output))?;
        }
    }
    Ok((playback.health(), ReadExtent::End))
}

/// Replays the recording and writes each impulse in `steps`.
fn collisions(
    path: &Path,
    recording: Recording,
    steps: RangeInclusive<u64>,
    options: &ExportOptions,
    rows: &mut Rows,
) -> Result<(Health, ReadExtent), CommandError> {
    // A collision happens between two states: the last step needs the state after it.
    let last = steps.end().saturating_add(1).min(recording.header.steps);
    let bar = output::progress_bar("replaying", last);
    let replayed = *steps.start()..=last;
    let mut replayer = Replayer::new(recording, replayed).map_err(CommandError::in_recording(path))?;
    let mut table = CollisionTable { steps, names: BTreeMap::new(), rows, known: (0, 0), failure: None };
    while let Some(step) = replayer.next_state(&mut table).map_err(CommandError::in_recording(path))? {
        bar.set_position(step);
        if let Some(engine) = replayer.engine() {
            table.update_names(engine);
        }
        if let Some(error) = table.failure.take() {
            return Err(CommandError::unwritable(&options.output)(error));
        }
    }
    bar.finish_and_clear();
    if let Some(error) = table.failure.take() {
        return Err(CommandError::unwritable(&options.output)(error));
    }
    let verdict = replayer.verdict();
    match verdict.health() {
        Some(health) => Ok((health, ReadExtent::End)),
        None => Err(picture::Error::Diverged { path: path.into(), verdict: Box::new(verdict) }.into()),
    }
}

/// Writes the collisions of a replay while it runs.
struct CollisionTable<'a, 'b> {
    steps: RangeInclusive<u64>,
    names: BTreeMap<BodyId, String>,
    rows: &'a mut Rows<'b>,
    /// The next id and the number of bodies when the names were last updated.
    known: (BodyId, usize),
    failure: Option<io::Error>,
}

impl Observer for CollisionTable<'_, '_> {
    fn collision(&mut self, collision: &Collision) {
        if self.failure.is_none() && collision.impulse != 0.0 && self.steps.contains(&collision.step) {
            self.failure = self.rows.collision(collision, &self.names).err();
        }
    }
}

impl CollisionTable<'_, '_> {
    fn update_names(&mut self, engine: &Engine) {
        let bodies = &engine.world().bodies;
        if self.known != (engine.next_id(), bodies.len()) {
            self.known = (engine.next_id(), bodies.len());
            self.names = bodies.iter().map(|body| (body.id, body.name.clone())).collect();
        }
    }
}

/// A body with the steps of its spawn and its deletion, as far as the recording contains them.
struct Lifetime {
    info: Arc<BodyInfo>,
    spawned: Option<u64>,
    deleted: Option<u64>,
}

/// Writes every body that lives in `steps`.
fn bodies(
    path: &Path,
    mut recording: Recording,
    steps: RangeInclusive<u64>,
    options: &ExportOptions,
    rows: &mut Rows,
) -> Result<(Health, ReadExtent), CommandError> {
    let mut bodies: BTreeMap<BodyId, Lifetime> = BTreeMap::new();
    while let Some(item) = recording.next().transpose().map_err(CommandError::in_recording(path))? {
        match item {
            Item::Event(event) => match event.change {
                Change::Spawn { id, spawn, color } => {
                    let info = Arc::new(BodyInfo { id, spawn, color });
                    bodies.insert(id, Lifetime { info, spawned: Some(event.step), deleted: None });
                }
                Change::Delete { id } => {
                    if let Some(lifetime) = bodies.get_mut(&id) {
                        lifetime.deleted = Some(event.step);
                    }
                }
            },
            Item::Keyframe(keyframe) => {
                for body in keyframe.bodies {
                    let unknown = Lifetime { info: body.info.clone(), spawned: None, deleted: None };
                    bodies.entry(body.info.id).or_insert(unknown);
                }
            }
            Item::State(_) | Item::SuspectState(_) | Item::SceneUpdate { .. } => {}
            Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_) => {}
        }
    }
    let is_alive = |body: &&Lifetime| {
        body.spawned.is_none_or(|step| step <= *steps.end()) && body.deleted.is_none_or(|step| step > *steps.start())
    };
    let alive: Vec<&Lifetime> = bodies.values().filter(is_alive).collect();
    let default_restitution = recording.header.config.restitution.default_restitution();
    for body in &alive[options.shard.range(alive.len())] {
        rows.body(body, default_restitution).map_err(CommandError::unwritable(&options.output))?;
    }
    Ok((recording.health(), ReadExtent::End))
}

impl Table {
    /// The columns, without the source.
    const fn columns(self) -> &'static [&'static str] {
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
enum Format {
    Csv,
    JsonLines,
}

impl Format {
    fn from_path(path: &Path) -> Result<Format, CommandError> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        match extension {
            None if is_standard_output(path) => Ok(Format::Csv),
            Some("csv") => Ok(Format::Csv),
            Some("jsonl") => Ok(Format::JsonLines),
            None | Some(_) => Err(CommandError::UnsupportedOutput {
                path: path.into(),
                expected: "expected F.csv, F.jsonl or F.mcap, or - for CSV on standard output",
            }),
        }
    }
}

/// The rows of a table, written one by one.
struct Rows<'a> {
    format: Format,
    output: &'a mut dyn Write,
    columns: &'static [&'static str],
    /// The source of the rows, if there are several.
    source: Option<&'a str>,
}

/// A value in a row.
enum Cell<'a> {
    Integer(u64),
    Number(f64),
    Text(&'a str),
    Unknown,
}

impl Rows<'_> {
    fn header(&mut self) -> io::Result<()> {
        match self.format {
            Format::Csv if self.source.is_some() => writeln!(self.output, "source,{}", self.columns.join(",")),
            Format::Csv => writeln!(self.output, "{}", self.columns.join(",")),
            Format::JsonLines => Ok(()),
        }
    }

    /// Writes one row; `cells` are the values of the columns in their order.
    fn row<const N: usize>(&mut self, cells: [Cell; N]) -> io::Result<()> {
        debug_assert_eq!(N, self.columns.len());
        let source = self.source.map(|source| ("source", Cell::Text(source)));
        let cells = source.into_iter().chain(self.columns.iter().copied().zip(cells));
        for (index, (column, cell)) in cells.enumerate() {
            match self.format {
                Format::Csv => cell.write_csv(if index == 0 { "" } else { "," }, self.output)?,
                Format::JsonLines => {
                    write!(self.output, "{}\"{column}\":", if index == 0 { "{" } else { "," })?;
                    cell.write_json(self.output)?;
                }
            }
        }
        self.output.write_all(match self.format {
            Format::Csv => b"\n",
            Format::JsonLines => b"}\n",
        })
    }

    /// Writes one row per body.
    fn state(&mut self, state: &SampledState) -> io::Result<()> {
        for body in &state.bodies {
            let [x, y] = [body.position.x, body.position.y].map(Cell::Number);
            let [vx, vy] = [body.velocity.x, body.velocity.y].map(Cell::Number);
            let name = Cell::Text(&body.info.spawn.name);
            self.row([Cell::Integer(state.step), Cell::Number(state.time), name, x, y, vx, vy])?;
        }
        Ok(())
    }

    fn energy(&mut self, step: u64, sample: &EnergySample) -> io::Result<()> {
        let energies = [sample.kinetic, sample.potential, sample.total()];
        let [kinetic, potential, total] = energies.map(Cell::Number);
        let [px, py] = [sample.momentum.x, sample.momentum.y].map(Cell::Number);
        self.row([Cell::Integer(step), Cell::Number(sample.time), kinetic, potential, total, px, py])
    }

    /// Writes a collision with its bodies in creation order and the normal from the second to the first.
    fn collision(&mut self, collision: &Collision, names: &BTreeMap<BodyId, String>) -> io::Result<()> {
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

    fn body(&mut self, Lifetime { info, spawned, deleted }: &Lifetime, default_restitution: f64) -> io::Result<()> {
        let spawn = &info.spawn;
        let [mass, width, height] = [spawn.mass, spawn.rect.width(), spawn.rect.height()].map(Cell::Number);
        let [spawned, deleted] = [spawned, deleted].map(|step| step.map_or(Cell::Unknown, Cell::Integer));
        let [fx, fy, e] = [spawn.force.x, spawn.force.y, default_restitution].map(Cell::Number);
        let [r, g, b] = picture::body_color(info);
        let color = format!("#{r:02x}{g:02x}{b:02x}");
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
            Cell::Unknown => output.write_all(separator.as_bytes()),
        }
    }

    /// Writes the value as JSON, which has no infinite numbers: these are strings, as in CSV.
    fn write_json(&self, output: &mut dyn Write) -> io::Result<()> {
        match self {
            Cell::Integer(number) => write!(output, "{number}"),
            Cell::Number(number) if number.is_finite() => output.write_all(shortest_decimal(*number).as_bytes()),
            Cell::Number(number) => write!(output, "\"{}\"", shortest_decimal(*number)),
            Cell::Text(text) => Ok(serde_json::to_writer(output, text)?),
            Cell::Unknown => output.write_all(b"null"),
        }
    }
}

/// The shortest decimal that reads back to the same bits. It contains a point or an exponent, or is `inf` or `nan`.
fn shortest_decimal(number: f64) -> String {
    if number.is_nan() { "nan".to_owned() } else { format!("{number:?}") }
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
