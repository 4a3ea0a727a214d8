use super::arguments::InfoOptions;
use super::error::CommandError;
use super::replay::missing_json;
use super::source::with_recordings_of_folders;
use super::{Exit, output};
use crate::picture::{EnergySample, Format, Provenance, recorded_world};
use crate::recording::{
    self, Change, Damage, Header, Health, Item, Playback, RecordedError, RecordedEvent, Recording, SampledState,
    Summary, Trailer, Versions,
};
use crate::scene;
use crate::table::shortest_decimal;
use serde::{Serialize, Serializer};
use std::{
    fs::{self, File},
    io::{Read, Seek},
    iter,
    path::Path,
};

/// Prints the contents of recordings, and the provenance of pictures. After a file that cannot be read, goes on with
/// the next one.
pub fn run(options: &InfoOptions) -> Result<Exit, CommandError> {
    let mut exit = Exit::Done;
    let mut separator = "";
    let files = with_recordings_of_folders(&options.files)?;
    for path in &files {
        let described = match Description::read(path, options) {
            Ok(described) => described,
            Err(error) if files.len() == 1 => return Err(error),
            Err(error) => {
                exit = exit.worse(super::error::report(error));
                continue;
            }
        };
        exit = exit.worse(described.exit);
        let name = path.display().to_string();
        let is_named = files.len() > 1;
        let text = if options.json { described.json(name) } else { described.lines(is_named.then_some(name)) };
        output::print(&format!("{separator}{text}"))?;
        separator = if options.json { "" } else { "\n" };
    }
    Ok(exit)
}

/// The keys and values that are printed for one file.
struct Description {
    entries: serde_json::Map<String, serde_json::Value>,
    /// The condition of a recording in words.
    condition: String,
    exit: Exit,
}

impl Description {
    fn read(path: &Path, options: &InfoOptions) -> Result<Description, CommandError> {
        if let Some(entries) = picture_entries(path)? {
            return Ok(Description { entries, condition: String::new(), exit: Exit::Done });
        }
        let mut recording = recording::open(path).map_err(CommandError::in_recording(path))?;
        let bytes = fs::metadata(path).map_err(CommandError::unreadable(path))?.len();
        let summary = if options.verify || bytes <= MAX_ALWAYS_VERIFIED {
            None
        } else {
            recording.summary().map_err(CommandError::in_recording(path))?
        };
        let info = match summary {
            Some(summary) => Info::from_index(&recording.header, summary, bytes),
            None => Info::read(path, &mut recording, bytes)?,
        };
        let (mut info, exit) = info.with_health(&recording.health());
        info.energies = info.steps.and_then(|last| Energies::read(path, last)).unwrap_or_default();
        let value = serde_json::to_value(&info).expect("plain values with text for keys");
        let entries = value.as_object().cloned().unwrap_or_default();
        Ok(Description { entries, condition: info.condition, exit })
    }

    /// Returns one line with a JSON object.
    fn json(self, name: String) -> String {
        let file = ("file".to_owned(), name.into());
        let object: serde_json::Map<String, serde_json::Value> = iter::once(file).chain(self.entries).collect();
        format!("{}\n", serde_json::Value::Object(object))
    }

    /// Returns one `key: value` per line. A missing title or error is left out; other missing values are "unknown".
    fn lines(&self, name: Option<String>) -> String {
        let mut lines = name.map_or(String::new(), |name| format!("file: {name}\n"));
        for (key, value) in &self.entries {
            let text = match value {
                serde_json::Value::Null if ["title", "error", "accuracy_method"].contains(&key.as_str()) => continue,
                serde_json::Value::Object(set) if key == "set" && set.is_empty() => continue,
                serde_json::Value::Bool(false) if key == "live_events" => continue,
                serde_json::Value::Object(set) if key == "set" => set_text(set),
                _ if ["verified", "damage", "missing"].contains(&key.as_str()) => continue,
                _ if key == "health" => self.condition.clone(),
                serde_json::Value::Bool(true) => "yes".into(),
                serde_json::Value::Null => "unknown".into(),
                serde_json::Value::String(text) => text.clone(),
                serde_json::Value::Number(number) => without_trailing_zero(number),
                value => value.to_string(),
            };
            lines += &format!("{key}: {text}\n");
        }
        lines
    }
}

/// The values of `--set` as they are typed.
fn set_text(set: &serde_json::Map<String, serde_json::Value>) -> String {
    let value = |(key, value): (&String, &serde_json::Value)| match value {
        serde_json::Value::String(text) => format!("{key}={text}"),
        serde_json::Value::Number(number) => format!("{key}={}", without_trailing_zero(number)),
        value => format!("{key}={value}"),
    };
    set.iter().map(value).collect::<Vec<String>>().join(", ")
}

/// Recordings up to this size are verified without `--verify`, bytes: that takes about 0.1 s.
const MAX_ALWAYS_VERIFIED: u64 = 16 << 20;

/// The provenance of a picture. `None` if neither the content of the file nor its name is that of a picture; the name
/// of an MCAP file does not count.
fn picture_entries(path: &Path) -> Result<Option<serde_json::Map<String, serde_json::Value>>, CommandError> {
    let mut file = File::open(path).map_err(CommandError::unreadable(path))?;
    let mut magic = Vec::new();
    file.by_ref().take(16).read_to_end(&mut magic).map_err(CommandError::unreadable(path))?;
    let is_named_picture = || !magic.starts_with(mcap::MAGIC) && Format::from_path(path).is_some();
    if Format::from_content(&magic).is_none() && !is_named_picture() {
        return Ok(None);
    }
    let mut content = magic;
    file.read_to_end(&mut content).map_err(CommandError::unreadable(path))?;
    let provenance = Provenance::read(&content)
        .map_err(|error| CommandError::NoProvenance { path: path.into(), source: Box::new(error) })?;
    let entries = provenance.metadata().entries.into_iter().map(|(key, value)| {
        let key = key.strip_prefix("rebond ").map_or(key.to_lowercase(), str::to_owned);
        (key, value)
    });
    let entries = std::iter::once(("picture".to_owned(), provenance.picture.format().name().to_owned())).chain(entries);
    Ok(Some(entries.map(|(key, value)| (key, value.into())).collect()))
}

/// The health of a recording that has an end and an index, and whose chunks were not verified.
const FINISHED: &str = "finished";

/// The contents of a recording, in the order in which they are printed.
#[derive(Serialize)]
struct Info {
    title: Option<String>,
    scene: Option<String>,
    /// The values of `--set`.
    set: serde_json::Map<String, serde_json::Value>,
    live_events: bool,
    solver: &'static str,
    versions: String,
    /// Hz.
    rate: f64,
    /// The number of the last state.
    steps: Option<u64>,
    /// The last step that was planned.
    planned_steps: u64,
    /// Simulated time of the last state, s.
    duration: Option<f64>,
    /// Full states are recorded every `every` steps.
    every: u64,
    /// Bodies that ever existed, walls included.
    bodies: Option<u64>,
    /// Spawns and deletes, walls included.
    events: Option<u64>,
    spawns: Option<u64>,
    deletes: Option<u64>,
    /// Unknown until the run has ended.
    collisions: Option<u64>,
    #[serde(flatten)]
    energies: Energies,
    keyframes: u64,
    chunks: u64,
    bytes: u64,
    error: Option<String>,
    /// The steps in which rounding errors do not matter.
    accuracy: Option<String>,
    accuracy_method: Option<&'static str>,
    identity: Option<String>,
    /// `whole`, `incomplete` or `corrupt`, or [`FINISHED`].
    health: &'static str,
    /// True if all chunks were verified.
    verified: bool,
    damage: Option<String>,
    missing: Option<serde_json::Value>,
    /// The health with its details.
    #[serde(skip)]
    condition: String,
}

impl Info {
    /// Reads and verifies the whole recording.
    fn read<R: Read + Seek>(path: &Path, recording: &mut Recording<R>, bytes: u64) -> Result<Info, CommandError> {
        let mut info = Info::from_header(&recording.header, bytes);
        while let Some(item) = recording.next().transpose().map_err(CommandError::in_recording(path))? {
            // A state whose bodies are unknown is one of the missing ones.
            let is_unusable = matches!(item, Item::State(_) | Item::SuspectState(_)) && recording.table().is_none();
            if !is_unusable {
                info.count(&item);
            }
        }
        info.chunks = recording.chunk_count();
        // Ids are consecutive, and keyframes know the next one, so lost events can be counted, too.
        let alive = recording.table().map(|table| table.bodies().len() as u64);
        info.spawns = alive.and(info.spawns);
        info.deletes = alive.zip(info.spawns).map(|(alive, spawns)| spawns.saturating_sub(alive));
        Ok(info.with_totals())
    }

    /// Takes the information from the end record and the index of a finished recording.
    fn from_index(header: &Header, summary: Summary, bytes: u64) -> Info {
        let Summary { trailer, states, keyframes, chunks } = summary;
        let mut info = Info::from_header(header, bytes);
        info.steps = (states > 0).then_some(trailer.steps);
        info.spawns = Some(trailer.bodies);
        let is_counted = header.gaps.is_empty();
        info.deletes = is_counted.then(|| trailer.events.saturating_sub(trailer.bodies));
        info.keyframes = keyframes;
        info.chunks = chunks;
        info.verified = false;
        info.set_end_record(&trailer);
        info.with_totals()
    }

    fn with_totals(mut self) -> Info {
        self.duration = self.steps.map(|steps| steps as f64 / self.rate);
        self.events = self.spawns.zip(self.deletes).map(|(spawns, deletes)| spawns + deletes);
        self.bodies = self.spawns;
        self
    }

    /// Adds the health, and returns the exit code.
    fn with_health(mut self, health: &Health) -> (Info, Exit) {
        self.damage = health.damage().map(Damage::to_string);
        self.missing = health.missing().map(missing_json);
        if *health == Health::Whole && !self.verified {
            self.health = FINISHED;
            self.condition = format!("{FINISHED}; chunks not verified, verify them with --verify");
            return (self, Exit::Done);
        }
        self.health = health.word();
        self.condition = health.to_string();
        (self, if *health == Health::Whole { Exit::Done } else { Exit::Damaged })
    }

    fn from_header(header: &Header, bytes: u64) -> Info {
        let Versions { format, semantics } = header.versions;
        Info {
            title: header.scene.as_ref().and_then(|text| scene::parse(&text.file_name, &text.text).ok()?.title),
            scene: header.scene.as_ref().map(|scene| scene.file_name.clone()),
            set: scene::settings(&header.overrides).into_iter().collect(),
            live_events: header.has_live_events,
            solver: header.config.solver.name(),
            versions: format!("format {format}, semantics {semantics}"),
            rate: header.config.rate,
            steps: None,
            planned_steps: header.steps,
            duration: None,
            every: header.every,
            bodies: None,
            events: None,
            spawns: Some(0),
            deletes: None,
            collisions: None,
            energies: Energies::default(),
            keyframes: 0,
            chunks: 0,
            bytes,
            error: None,
            accuracy: (!header.estimates_accuracy).then(|| "not computed".into()),
            accuracy_method: header.estimates_accuracy.then_some("estimate by random rounding"),
            identity: None,
            health: "",
            verified: true,
            damage: None,
            missing: None,
            condition: String::new(),
        }
    }

    fn count(&mut self, item: &Item) {
        match item {
            Item::Event(RecordedEvent { change: Change::Spawn(info), .. }) => {
                self.spawns = Some(u64::from(info.id) + 1);
            }
            Item::Event(_) => {}
            Item::State(state) | Item::SuspectState(state) => self.steps = Some(state.step),
            Item::Keyframe(keyframe) => {
                self.keyframes += 1;
                self.spawns = Some(keyframe.next_id.into());
            }
            Item::SceneUpdate { .. } | Item::Damaged(_) | Item::Gap(_) => {}
            Item::Trailer(trailer) => self.set_end_record(trailer),
        }
    }

    fn set_end_record(&mut self, trailer: &Trailer) {
        self.collisions = trailer.collisions;
        self.error = trailer.error.as_ref().map(RecordedError::to_string);
        if let Some(accuracy) = &trailer.accuracy {
            self.accuracy = Some(accuracy.to_string());
        }
        self.identity = Some(trailer.identity.to_string());
    }
}

/// The energies of the first and of the last state that is recorded in full, J; unknown if one of them is lost.
#[derive(Default, Serialize)]
struct Energies {
    kinetic_start: Option<Energy>,
    potential_start: Option<Energy>,
    total_start: Option<Energy>,
    kinetic_end: Option<Energy>,
    potential_end: Option<Energy>,
    total_end: Option<Energy>,
}

impl Energies {
    /// Reads them from the recording at `path`, whose last state is that of step `last`.
    fn read(path: &Path, last: u64) -> Option<Energies> {
        let recording = recording::open(path).ok()?;
        let header = recording.header.clone();
        let mut playback = Playback::new(recording);
        let sample = |state: &SampledState| EnergySample::of(&recorded_world(state, &header.config), state.time);
        let first = playback.next()?.ok().filter(|state| state.step == 0)?;
        let full = last - last % header.every;
        let end = match full {
            0 => sample(&first),
            full => {
                playback.seek(full).ok()?;
                sample(&playback.next()?.ok().filter(|state| state.step == full)?)
            }
        };
        let start = sample(&first);
        Some(Energies {
            kinetic_start: Some(Energy(start.kinetic)),
            potential_start: Some(Energy(start.potential)),
            total_start: Some(Energy(start.total())),
            kinetic_end: Some(Energy(end.kinetic)),
            potential_end: Some(Energy(end.potential)),
            total_end: Some(Energy(end.total())),
        })
    }
}

/// An energy, J. One that is not finite is text, as in tables, because JSON has no such numbers.
#[derive(Clone, Copy)]
struct Energy(f64);

impl Serialize for Energy {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() {
            self.0.serialize(serializer)
        } else {
            serializer.serialize_str(&shortest_decimal(self.0))
        }
    }
}

/// Formats 60.0 as 60.
fn without_trailing_zero(number: &serde_json::Number) -> String {
    let text = number.to_string();
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Missing;
    use crate::replay::{self, NO_LIVE_EVENTS, RecordOptions};

    #[test]
    fn an_infinite_energy_is_not_unknown() {
        let energies = Energies { kinetic_start: Some(Energy(f64::INFINITY)), ..Energies::default() };
        let value = serde_json::to_value(&energies).unwrap();
        assert_eq!((&value["kinetic_start"], &value["kinetic_end"]), (&"inf".into(), &serde_json::Value::Null));
    }

    #[test]
    fn a_recording_that_was_not_verified_is_not_called_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let scene = scene::parse("scene.toml", "run.steps = 3\n").unwrap();
        let file = File::create(&path).unwrap();
        replay::record(&scene, RecordOptions::complete(&scene), NO_LIVE_EVENTS, file, |_| ()).unwrap();
        let mut recording = recording::open(&path).unwrap();
        let mut described = |health: Health| {
            let summary = recording.summary().unwrap().unwrap();
            let (info, exit) = Info::from_index(&recording.header, summary, 0).with_health(&health);
            (info.health, info.verified, info.condition, exit)
        };
        let finished = "finished; chunks not verified, verify them with --verify";
        assert_eq!(described(Health::Whole), ("finished", false, finished.to_owned(), Exit::Done));
        let recovered = Health::Incomplete(Missing { recovered: true, ..Missing::default() });
        let expected = ("incomplete", false, "incomplete: recovered".to_owned(), Exit::Damaged);
        assert_eq!(described(recovered), expected);
        let (info, exit) = Info::read(&path, &mut recording, 0).unwrap().with_health(&Health::Whole);
        assert_eq!((info.health, info.verified, exit), ("whole", true, Exit::Done));
    }
}
