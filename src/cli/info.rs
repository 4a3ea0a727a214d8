use super::arguments::InfoOptions;
use super::error::CommandError;
use super::{Exit, output};
use crate::illustration::{Evidence, Format};
use crate::recording::{self, Change, End, Header, Health, Item, Outline, Recording, Versions};
use crate::scene;
use serde::Serialize;
use std::{
    fs::{self, File},
    io::{Read, Seek},
    path::Path,
};

/// Prints what is inside a recording, or what a picture was drawn from.
pub fn run(options: &InfoOptions) -> Result<Exit, CommandError> {
    let path = &options.file;
    if let Some(text) = of_picture(path, options.json)? {
        output::print(text.as_bytes())?;
        return Ok(Exit::Done);
    }
    let mut recording = recording::open(path).map_err(|error| CommandError::recording(path, error))?;
    let bytes = fs::metadata(path).map_err(|source| CommandError::Unreadable { path: path.clone(), source })?.len();
    let outline = match options.verify || bytes <= READ_ANYWAY {
        true => None,
        false => recording.outline().map_err(|error| CommandError::recording(path, error))?,
    };
    let (info, exit) = match outline {
        Some(outline) => (Info::told(&recording.header, outline, bytes), Exit::Done),
        None => Info::read(path, &mut recording, bytes)?,
    };
    let text = if options.json { info.json() } else { info.lines() };
    output::print(text.as_bytes())?;
    Ok(exit)
}

/// Bytes of a file that is read whole in about a tenth of a second.
const READ_ANYWAY: u64 = 16 << 20;

/// What a picture says of itself; nothing if the file is none.
fn of_picture(path: &Path, json: bool) -> Result<Option<String>, CommandError> {
    let unreadable = |source| CommandError::Unreadable { path: path.into(), source };
    let mut file = File::open(path).map_err(unreadable)?;
    let mut begin = Vec::new();
    file.by_ref().take(16).read_to_end(&mut begin).map_err(unreadable)?;
    if Format::of_content(&begin).is_none() {
        return Ok(None);
    }
    let mut content = begin;
    file.read_to_end(&mut content).map_err(unreadable)?;
    let (format, evidence) = Evidence::read(&content)
        .map_err(|error| CommandError::NoEvidence { path: path.into(), source: Box::new(error) })?;
    let entries = evidence.metadata().entries.into_iter().map(|(key, value)| {
        let key = key.strip_prefix("rebond ").map_or(key.to_lowercase(), str::to_owned);
        (key, value)
    });
    let entries = std::iter::once(("picture".to_owned(), format.name().to_owned())).chain(entries);
    Ok(Some(if json {
        let object: serde_json::Map<String, serde_json::Value> =
            entries.map(|(key, value)| (key, value.into())).collect();
        format!("{:#}\n", serde_json::Value::Object(object))
    } else {
        entries.map(|(key, value)| format!("{key}: {value}\n")).collect()
    }))
}

/// What is inside a recording, in the order in which it is printed.
#[derive(Serialize)]
struct Info {
    title: Option<String>,
    scene: String,
    solver: &'static str,
    versions: String,
    /// Hz.
    rate: f64,
    /// The number of the last state.
    steps: Option<u64>,
    /// Simulated seconds up to it.
    duration: Option<f64>,
    /// States in full are those of every so many steps.
    every: u64,
    /// Bodies that ever lived, walls included.
    bodies: u64,
    /// Spawns and deletes, walls included.
    events: u64,
    spawns: u64,
    deletes: u64,
    /// Unknown until the run has ended.
    collisions: Option<u64>,
    keyframes: u64,
    chunks: u64,
    bytes: u64,
    error: Option<String>,
    identity: Option<String>,
    health: String,
}

impl Info {
    /// Verifies it all.
    fn read<R: Read + Seek>(
        path: &Path,
        recording: &mut Recording<R>,
        bytes: u64,
    ) -> Result<(Info, Exit), CommandError> {
        let mut info = Info::of_header(&recording.header, bytes);
        for item in recording.by_ref() {
            info.count(&item.map_err(|error| CommandError::recording(path, error))?);
        }
        info.chunks = recording.chunks();
        info.health = health(&recording.health());
        let exit = if recording.health() == Health::Whole { Exit::Done } else { Exit::Damaged };
        Ok((info.summed_up(), exit))
    }

    /// What the end and the index of a finished recording tell.
    fn told(header: &Header, outline: Outline, bytes: u64) -> Info {
        let Outline { end, states, keyframes, chunks } = outline;
        let mut info = Info::of_header(header, bytes);
        info.steps = (states > 0).then_some(end.steps);
        info.spawns = end.bodies;
        info.deletes = end.events.saturating_sub(end.bodies);
        info.keyframes = keyframes;
        info.chunks = chunks;
        info.health = "finished, its chunks not read: --verify reads them".into();
        info.end(&end);
        info.summed_up()
    }

    fn summed_up(mut self) -> Info {
        self.duration = self.steps.map(|steps| steps as f64 / self.rate);
        self.events = self.spawns + self.deletes;
        self.bodies = self.spawns;
        self
    }

    fn of_header(header: &Header, bytes: u64) -> Info {
        let Versions { format, semantics } = header.versions;
        Info {
            title: scene::parse(&header.scene.file_name, &header.scene.text).ok().and_then(|scene| scene.title),
            scene: header.scene.file_name.clone(),
            solver: header.settings.solver.name(),
            versions: format!("format {format}, semantics {semantics}"),
            rate: header.settings.rate,
            steps: None,
            duration: None,
            every: header.every,
            bodies: 0,
            events: 0,
            spawns: 0,
            deletes: 0,
            collisions: None,
            keyframes: 0,
            chunks: 0,
            bytes,
            error: None,
            identity: None,
            health: String::new(),
        }
    }

    fn count(&mut self, item: &Item) {
        match item {
            Item::Event(event) => match event.change {
                Change::Spawn { .. } => self.spawns += 1,
                Change::Delete { .. } => self.deletes += 1,
            },
            Item::State(state) | Item::Doubtful(state) => self.steps = Some(state.step),
            Item::Keyframe(_) => self.keyframes += 1,
            Item::View { .. } | Item::Damaged(_) | Item::Gap(_) => {}
            Item::End(end) => self.end(end),
        }
    }

    fn end(&mut self, end: &End) {
        self.collisions = end.collisions;
        self.error = end.error.clone();
        self.identity = Some(end.identity.to_string());
    }

    fn json(&self) -> String {
        let text = serde_json::to_string_pretty(self).expect("plain values with text for keys");
        text + "\n"
    }

    /// One `key: value` a line; what is not known is left out, but for what every recording has.
    fn lines(&self) -> String {
        let value = serde_json::to_value(self).expect("plain values with text for keys");
        let mut lines = String::new();
        for (key, value) in value.as_object().into_iter().flatten() {
            let text = match value {
                serde_json::Value::Null if key == "title" || key == "error" => continue,
                serde_json::Value::Null => "unknown, the recording is unfinished".into(),
                serde_json::Value::String(text) => text.clone(),
                serde_json::Value::Number(number) => whole_or_not(number),
                value => value.to_string(),
            };
            lines += &format!("{key}: {text}\n");
        }
        lines
    }
}

/// 60 rather than 60.0.
fn whole_or_not(number: &serde_json::Number) -> String {
    let text = number.to_string();
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

fn health(health: &Health) -> String {
    match health {
        Health::Whole => "whole".into(),
        Health::Truncated { after: Some(step) } => format!("truncated after step {step}"),
        Health::Truncated { after: None } => "truncated before the first state".into(),
        Health::Corrupt(damage) => format!("corrupt {damage}"),
    }
}
