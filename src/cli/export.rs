use super::arguments::{ExportOptions, Shard, is_standard_output};
use super::body_topics::BodyTopics;
use super::error::CommandError;
use super::output_file::{OutputFile, Overwrite};
use super::source::{SourceArgument, SourceFile, Verification, with_recordings_of_folders};
use super::{Exit, output};
use crate::physics::BodyId;
use crate::picture::{self, EnergySample, ReadExtent, ReadStatus, recorded_world};
use crate::picture_options::{ReversedRange, StepOrTime};
use crate::recording::{self, Change, Health, Item, Playback, SampledState};
use crate::replay::Replayer;
use crate::scene;
use crate::table::{CollisionRows, EventStep, Lifetime, Rows, Table, TableFormat};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Exports states, collisions, energies or bodies of recordings or scenes as a table.
pub fn run(options: &ExportOptions) -> Result<Exit, CommandError> {
    if options.output.extension().is_some_and(|extension| extension == "mcap") {
        return export_topics(options);
    }
    let format = table_format(&options.output)?;
    let paths = with_recordings_of_folders(&options.sources)?;
    let inputs: Vec<&Path> = paths.iter().map(PathBuf::as_path).collect();
    let mut output = OutputFile::create(&options.output, Overwrite::from_force(options.force), &inputs)?;
    let sources = SourceArgument::all(&paths, &options.set)?;
    if options.shard != Shard::WHOLE && sources.len() > 1 {
        return Err(CommandError::ShardOfSeveral);
    }
    let open = |source| SourceFile::open(source, Verification::Replay, &mut output);
    let files = sources.iter().map(open).collect::<Result<Vec<_>, CommandError>>()?;
    sources.iter().zip(&files).try_for_each(|(source, file)| refuse_empty_range(&source.path, &file.path, options))?;
    let settings = settings_of_several(&sources, &files)?;
    let statuses = output.write(|file| {
        let columns = options.table.columns();
        let mut rows = Rows { format, output: file, columns, source: None, settings: Vec::new() };
        let has_header = options.shard.number == 1;
        let names: Vec<String> = sources.iter().map(|source| source.path.display().to_string()).collect();
        let mut statuses = Vec::new();
        for (index, (SourceArgument { path, .. }, file)) in sources.iter().zip(&files).enumerate() {
            if let Some(settings) = settings.get(index) {
                rows.source = Some(names[index].as_str());
                rows.settings.clone_from(settings);
            }
            if has_header && index == 0 {
                rows.header().map_err(CommandError::unwritable(&options.output))?;
            }
            let (health, extent) = export(path, &file.path, options, &mut rows)?;
            statuses.push(ReadStatus { path: path.clone(), health, extent });
        }
        Ok(statuses)
    })?;
    Ok(files.iter().fold(output::warn_of_damage(&statuses), |exit, file| file.exit(exit)))
}

/// The values that were set with `--set`, for each of several sources: of all keys that were set in any of them, in the
/// order of their first appearance. Empty for a single source.
fn settings_of_several(sources: &[SourceArgument], files: &[SourceFile]) -> Result<Vec<Settings>, CommandError> {
    if sources.len() < 2 {
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    let mut keys: Vec<String> = Vec::new();
    for (source, file) in sources.iter().zip(files) {
        let recording = recording::open(&file.path).map_err(CommandError::in_recording(&source.path))?;
        let settings = scene::settings(&recording.header.overrides);
        for (key, _) in &settings {
            if !keys.contains(key) {
                keys.push(key.clone());
            }
        }
        found.push(settings);
    }
    let of_all_keys = |settings: Vec<(String, Value)>| -> Settings {
        let value = |key: &String| settings.iter().find(|(set, _)| set == key).map(|(_, value)| value.clone());
        keys.iter().map(|key| (key.clone(), value(key))).collect()
    };
    Ok(found.into_iter().map(of_all_keys).collect())
}

/// Keys with their values; `None` where a source does not set the key.
type Settings = Vec<(String, Option<Value>)>;

/// Writes the states of one source as an MCAP file with one topic per body.
fn export_topics(options: &ExportOptions) -> Result<Exit, CommandError> {
    let sources = SourceArgument::all(&with_recordings_of_folders(&options.sources)?, &options.set)?;
    let ([source @ SourceArgument { path, .. }], Table::States, Shard::WHOLE) =
        (&sources[..], options.table, options.shard)
    else {
        return Err(CommandError::UnsupportedOutput {
            path: options.output.clone(),
            expected: "an .mcap file has the states of one source, without --table and --shard",
        });
    };
    let mut output = OutputFile::create(&options.output, Overwrite::from_force(options.force), &[path])?;
    let file = SourceFile::open(source, Verification::Replay, &mut output)?;
    refuse_empty_range(path, &file.path, options)?;
    let recording = recording::open(&file.path).map_err(CommandError::in_recording(path))?;
    let header = recording.header.clone();
    let step = |point: StepOrTime| point.step(header.config.rate);
    let steps = options.from.map_or(0, step)..=options.to.map_or(header.steps, step);
    let unwritable = CommandError::unwritable(&options.output);
    let (health, extent) = output.write(|output| {
        let mut topics = BodyTopics::new(output).map_err(&unwritable)?;
        let read = states(path, recording, steps, &options.output, |state| topics.write(state, &header))?;
        topics.finish().map_err(&unwritable)?;
        Ok(read)
    })?;
    Ok(file.exit(output::warn_of_damage(&[ReadStatus { path: path.clone(), health, extent }])))
}

/// Writes the rows of one recording, the file `file` of the source `path`.
fn export(
    path: &Path,
    file: &Path,
    options: &ExportOptions,
    rows: &mut Rows,
) -> Result<(Health, ReadExtent), CommandError> {
    let recording = recording::open(file).map_err(CommandError::in_recording(path))?;
    let (last, rate) = (recording.header.steps, recording.header.config.rate);
    let (from, to) = match options.table {
        Table::States | Table::Energy | Table::Bodies => {
            (options.from.map_or(0, |from| from.step(rate)), options.to.map_or(last, |to| to.step(rate)))
        }
        Table::Collisions => (
            options.from.map_or(0, |from| from.first_collision_step(rate)),
            options.to.map_or(last, |to| to.last_collision_step(rate)),
        ),
    };
    let to = to.min(last);
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
        Table::Bodies => bodies(path, recording, from..=to, options, rows),
    }
}

type Recording = recording::Recording<io::BufReader<std::fs::File>>;

/// Returns an error if the recording `file` of the source `path` has no state in the range that the options name.
fn refuse_empty_range(path: &Path, file: &Path, options: &ExportOptions) -> Result<(), CommandError> {
    if options.from.or(options.to).is_none() {
        return Ok(());
    }
    let in_recording = CommandError::in_recording(path);
    let recording = recording::open(file).map_err(&in_recording)?;
    let (rate, every) = (recording.header.config.rate, recording.header.every);
    let (from, to) = (options.from.unwrap_or(0.into()), options.to.unwrap_or(u64::MAX.into()));
    ReversedRange::refuse(options.from, options.to, rate)?;
    let (from, to) = (from.step(rate), to.step(rate));
    let (first, recording) = first_state(recording, from, options.table).map_err(&in_recording)?;
    if first.is_some_and(|step| step <= to) {
        return Ok(());
    }
    let last = recording.trailer().map_or(recording.header.steps, |end| end.steps);
    match recording.health() {
        Health::Whole if from <= last => Err(CommandError::NoFullState { path: path.into(), from, to, every }),
        Health::Whole => Err(in_recording(recording::Error::NoStates { from, to, last })),
        // The bodies that may live within a gap are known.
        _ if options.table == Table::Bodies => Ok(()),
        health => Err(in_recording(recording::Error::MissingStates { from, to, health: Box::new(health) })),
    }
}

/// The step of the first state at or after step `from` that has rows in `table`, and the recording read up to there.
fn first_state(
    mut recording: Recording,
    from: u64,
    table: Table,
) -> Result<(Option<u64>, Recording), recording::Error> {
    if let Table::States | Table::Energy = table {
        let mut playback = Playback::new(recording);
        playback.seek(from)?;
        let first = playback.next().transpose()?.map(|state| state.step);
        return Ok((first, playback.into_recording()));
    }
    recording.seek(from)?;
    while let Some(item) = recording.next().transpose()? {
        match item {
            Item::State(state) if state.step >= from => return Ok((Some(state.step), recording)),
            _ => {}
        }
    }
    Ok((None, recording))
}

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

/// Replays the recording and writes each impulse in `steps`, and at the times that the options name.
fn collisions(
    path: &Path,
    recording: Recording,
    steps: RangeInclusive<u64>,
    options: &ExportOptions,
    rows: &mut Rows,
) -> Result<(Health, ReadExtent), CommandError> {
    // A collision happens between two states: the last step needs the state after it. The last state needs the rest of
    // the file, which may be damaged.
    let planned = recording.header.steps;
    let last = Some(steps.end().saturating_add(1)).filter(|last| *last < planned);
    let bar = output::progress_bar("replaying", last.unwrap_or(planned));
    let replayed = *steps.start()..=last.unwrap_or(u64::MAX);
    let mut replayer = Replayer::new(recording, replayed).map_err(CommandError::in_recording(path))?;
    let instant = |point: Option<StepOrTime>, open: f64| point.and_then(StepOrTime::time).unwrap_or(open);
    let instants = instant(options.from, f64::NEG_INFINITY)..=instant(options.to, f64::INFINITY);
    let mut table = CollisionRows::new(steps, rows).within(instants);
    while let Some(step) = replayer.next_state(&mut table).map_err(CommandError::in_recording(path))? {
        bar.set_position(step);
        if let Some(engine) = replayer.engine() {
            table.update_names(engine);
        }
        if let Some(error) = table.take_failure() {
            return Err(CommandError::unwritable(&options.output)(error));
        }
    }
    bar.finish_and_clear();
    if let Some(error) = table.take_failure() {
        return Err(CommandError::unwritable(&options.output)(error));
    }
    Ok((picture::Error::unless_diverged(replayer.verdict(), path)?, ReadExtent::End))
}

/// The bodies of a recording, and when they were spawned and deleted.
#[derive(Default)]
struct BodyLifetimes {
    bodies: BTreeMap<BodyId, Lifetime>,
    /// The step after the last state.
    next_step: u64,
    /// The first step after the last state before a gap, until a keyframe names the bodies alive after it.
    lost_since: Option<u64>,
}

impl BodyLifetimes {
    /// Follows the next item of the recording.
    fn add(&mut self, item: Item) {
        match item {
            Item::Event(event) => match event.change {
                Change::Spawn(info) => {
                    self.bodies.insert(info.id, Lifetime { info, spawned: EventStep::At(event.step), deleted: None });
                }
                Change::Delete { id } => {
                    if let Some(lifetime) = self.bodies.get_mut(&id) {
                        lifetime.deleted = Some(EventStep::At(event.step));
                    }
                }
            },
            Item::Keyframe(keyframe) => {
                let Some(from) = self.lost_since.take() else { return };
                let within = EventStep::Within { from, to: keyframe.step };
                let alive: BTreeSet<BodyId> = keyframe.bodies.iter().map(|body| body.info.id).collect();
                let lost = self.bodies.iter_mut().filter(|(id, body)| body.deleted.is_none() && !alive.contains(id));
                lost.for_each(|(_, body)| body.deleted = Some(within));
                for body in keyframe.bodies {
                    let unknown = Lifetime { info: body.info.clone(), spawned: within, deleted: None };
                    self.bodies.entry(body.info.id).or_insert(unknown);
                }
            }
            Item::State(state) | Item::SuspectState(state) => self.next_step = state.step + 1,
            Item::Damaged(_) | Item::Gap(_) => self.lost_since = self.lost_since.or(Some(self.next_step)),
            Item::SceneUpdate { .. } | Item::Trailer(_) => {}
        }
    }

    /// Leaves open if bodies were deleted in the states that are missing at the end, up to the step `last`.
    fn end_unknown(&mut self, last: u64) {
        let unknown = EventStep::Within { from: self.lost_since.unwrap_or(self.next_step), to: last };
        self.bodies.values_mut().for_each(|body| body.deleted = body.deleted.or(Some(unknown)));
    }
}

/// Writes every body that lives or is spawned in `steps`.
fn bodies(
    path: &Path,
    mut recording: Recording,
    steps: RangeInclusive<u64>,
    options: &ExportOptions,
    rows: &mut Rows,
) -> Result<(Health, ReadExtent), CommandError> {
    let mut lifetimes = BodyLifetimes::default();
    while let Some(item) = recording.next().transpose().map_err(CommandError::in_recording(path))? {
        lifetimes.add(item);
    }
    let health = recording.health();
    // A body may have been deleted in the states that are missing at the end.
    if let Some(end) = health.missing().and_then(|missing| missing.end).filter(|end| end.has_states()) {
        lifetimes.end_unknown(end.last);
    }
    let is_alive = |body: &&Lifetime| {
        let ([first, _], last) = (body.spawned.range(), body.deleted.map(EventStep::range));
        let is_alive_later = last.is_none_or(|[_, last]| last > *steps.start());
        // A body that is spawned and deleted at the same step is in no state.
        first <= *steps.end() && (is_alive_later || first >= *steps.start())
    };
    let alive: Vec<&Lifetime> = lifetimes.bodies.values().filter(is_alive).collect();
    let default_restitution = recording.header.config.restitution.default_restitution();
    for body in &alive[options.shard.range(alive.len())] {
        rows.body(body, default_restitution).map_err(CommandError::unwritable(&options.output))?;
    }
    Ok((health, ReadExtent::End))
}

/// The format that the name of the output asks for.
fn table_format(path: &Path) -> Result<TableFormat, CommandError> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension {
        None if is_standard_output(path) => Ok(TableFormat::Csv),
        Some("csv") => Ok(TableFormat::Csv),
        Some("jsonl") => Ok(TableFormat::JsonLines),
        None | Some(_) => Err(CommandError::UnsupportedOutput {
            path: path.into(),
            expected: "expected F.csv, F.jsonl or F.mcap, or - for CSV on standard output",
        }),
    }
}
