use super::figures::CollisionSubject;

use super::trace::GapReason;
use super::{Appearance, Bitmap, Error, RunStatistics, TraceGap, png};
use crate::physics::{Body, BodyId, EngineConfig, Material, Vector, World};
use crate::recording::{
    self, BodyInfo, Change, Gap, Header, Health, Item, Playback, RecordedEvent, Recording, SampledBody, SampledState,
    SceneImage, limits,
};
use crate::scene::{self, Scene, Walls};
use crate::temporary::TemporaryRecording;
use crate::text::counted;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek, SeekFrom};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// A recording to draw.
#[derive(Clone, Debug)]
pub struct Source {
    /// The name of the recording in errors: its path, that of its scene if it is temporary, or that of a recording in
    /// memory.
    pub path: PathBuf,
    /// The path of the file.
    file: PathBuf,
    /// The file, if it is in memory.
    bytes: Option<Arc<[u8]>>,
    /// The folder of the file, if it is temporary: it is removed with the last copy of this source.
    _temporary: Option<Arc<TemporaryRecording>>,
    /// The header of the recording.
    pub header: Header,
    /// The scene stored in the recording.
    pub scene: Scene,
    /// The images of the scene by their names.
    images: Arc<BTreeMap<String, Arc<Bitmap>>>,
    /// Statistics of the whole run.
    pub statistics: RunStatistics,
    /// Collisions that were found by a replay, so that drawing needs no second one, and the health of the recording
    /// as far as it was read for that.
    pub(super) found_collisions: Arc<Mutex<Vec<(CollisionSubject, Health)>>>,
}

impl Source {
    /// Opens the recording at `path` and reads statistics of its run.
    ///
    /// # Errors
    /// If the recording cannot be read or its scene is invalid.
    pub fn open(path: &Path) -> Result<Source, Error> {
        Source::new(path, None)
    }

    /// Opens a temporary recording, which is removed when the source and all copies of it are dropped.
    ///
    /// # Errors
    /// If the recording cannot be read or its scene is invalid.
    pub(crate) fn from_temporary(recording: TemporaryRecording) -> Result<Source, Error> {
        let source = Source::open(&recording.path())?;
        Ok(Source { _temporary: Some(Arc::new(recording)), ..source })
    }

    /// Reads statistics of the run whose recording is `bytes`. Errors call it `name`.
    ///
    /// # Errors
    /// If the recording cannot be read or its scene is invalid.
    pub fn from_bytes(name: &str, bytes: impl Into<Arc<[u8]>>) -> Result<Source, Error> {
        Source::new(name.as_ref(), Some(bytes.into()))
    }

    fn new(path: &Path, bytes: Option<Arc<[u8]>>) -> Result<Source, Error> {
        let header = open(path, bytes.as_ref())?.header;
        let scene = match &header.scene {
            Some(text) => scene::parse(&text.file_name, &text.text)?,
            None => scene_of_states(path, bytes.as_ref())?,
        };
        let world = Vector::new(scene.size[0], scene.size[1]);
        let read_error = |source| Error::Recording { path: path.into(), source };
        let statistics = RunStatistics::read(open(path, bytes.as_ref())?, world).map_err(read_error)?;
        let images = Arc::new(decoded_images(path, &header)?);
        Ok(Source {
            images,
            path: path.into(),
            file: path.into(),
            bytes,
            _temporary: None,
            header,
            scene,
            statistics,
            found_collisions: Arc::default(),
        })
    }

    /// Opens the recording for reading.
    pub(super) fn recording(&self) -> Result<Recording<RecordingFile>, Error> {
        open(&self.file, self.bytes.as_ref())
    }

    /// The same recording, which errors call by another name.
    pub fn named(self, name: &Path) -> Source {
        Source { path: name.into(), ..self }
    }

    /// Returns true if the file at `path` is a recording, false if it is a scene. A file is a recording if it begins
    /// with the MCAP magic or its extension is `mcap`.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn is_recording(path: &Path) -> io::Result<bool> {
        let mut magic = Vec::new();
        File::open(path)?.take(mcap::MAGIC.len() as u64).read_to_end(&mut magic)?;
        Ok(magic == mcap::MAGIC || path.extension().is_some_and(|extension| extension == "mcap"))
    }

    /// Width and height of the world, m.
    pub fn world(&self) -> Vector {
        Vector::new(self.scene.size[0], self.scene.size[1])
    }

    /// The time of the last state, s.
    pub fn duration(&self) -> f64 {
        self.statistics.end_step.unwrap_or(0) as f64 / self.header.config.rate
    }

    /// The title of the recording in a picture of several recordings: that of its scene, else the scene's file name.
    pub fn title(&self) -> &str {
        let file = self.header.scene.as_ref().map_or("", |scene| &scene.file_name);
        self.scene.title.as_deref().unwrap_or(file.strip_suffix(".toml").unwrap_or(file))
    }

    /// The title with the values that were set in the scene, unless the title is one of them.
    #[cfg(feature = "cli")]
    pub(super) fn title_with_settings(&self) -> String {
        let settings = scene::settings(&self.header.overrides);
        let value = |(key, value): &(String, serde_json::Value)| match value.as_str() {
            Some(text) => format!("{key} = {text}"),
            None => format!("{key} = {value}"),
        };
        let is_titled = settings.iter().any(|(key, _)| key == "title");
        let values = if is_titled { Vec::new() } else { settings.iter().map(value).collect() };
        let title = Some(self.title().to_owned()).filter(|title| !title.is_empty());
        title.into_iter().chain(values).collect::<Vec<String>>().join(", ")
    }

    /// The appearance of a body.
    pub(super) fn appearance(&self, info: &BodyInfo) -> Appearance {
        let image = info.paint.image().and_then(|name| self.images.get(name).cloned());
        Appearance { image, ..Appearance::new(info, self.header.config.gravity) }
    }

    /// The appearance of every body that is ever spawned.
    pub(super) fn appearances(&self) -> Result<BTreeMap<BodyId, Arc<Appearance>>, Error> {
        let mut bodies = BTreeMap::new();
        let mut add = |info: &BodyInfo| {
            let new = || Arc::new(self.appearance(info));
            bodies.entry(info.id).or_insert_with(new);
        };
        // The spawn of a body may be lost; keyframes have it, too.
        let visit = |item: Item| match item {
            Item::Event(RecordedEvent { change: Change::Spawn(info), .. }) => add(&info),
            Item::Keyframe(keyframe) => keyframe.bodies.iter().for_each(|body| add(&body.info)),
            _ => {}
        };
        self.recording()?.for_each_event(visit).map_err(|error| self.read_error(error))?;
        Ok(bodies)
    }

    /// Returns true if this engine can run the recording again, so that pictures can show states that it does not store.
    pub(super) const fn is_replayable(&self) -> bool {
        self.header.versions.semantics == recording::SEMANTICS_VERSION
    }

    /// The steps to read for a replay from `first` to `last`: to the end of the file if `last` is the last full state or
    /// a later one, because the rest of the file may be damaged. What is read after `last` is not shown.
    pub(super) fn steps_to_read(&self, first: u64, last: u64) -> RangeInclusive<u64> {
        let is_to_the_end = self.statistics.last_step.is_none_or(|full| last >= full);
        first..=if is_to_the_end { u64::MAX } else { last }
    }

    /// The parts of `steps` that a recovered recording lacks.
    pub(super) fn gaps_in(&self, steps: &RangeInclusive<u64>) -> Vec<TraceGap> {
        let gaps = self.header.gaps.iter();
        gaps.filter_map(|gap| self.gap_in(gap, steps, GapReason::Lost)).collect()
    }

    /// The parts of `steps` that are missing in the recording, given its health.
    pub(super) fn missing_in(&self, steps: &RangeInclusive<u64>, health: &Health) -> Vec<TraceGap> {
        let found = health.missing().into_iter().flat_map(|missing| &missing.gaps);
        let reason = |gap: &Gap| {
            let mut declared = self.header.gaps.iter();
            let is_declared =
                declared.any(|lost| lost.first_missing() < gap.before && lost.before > gap.first_missing());
            if is_declared { GapReason::Lost } else { GapReason::Unreadable }
        };
        found.filter_map(|gap| self.gap_in(gap, steps, reason(gap))).collect()
    }

    fn gap_in(&self, gap: &Gap, steps: &RangeInclusive<u64>, reason: GapReason) -> Option<TraceGap> {
        let has_missing =
            gap.missing_states() > 0 && gap.first_missing() <= *steps.end() && gap.before > *steps.start();
        has_missing.then(|| TraceGap {
            steps: gap.first_missing()..=gap.before - 1,
            times: [gap.after.unwrap_or(0), gap.before].map(|step| step as f64 / self.header.config.rate),
            reason,
        })
    }

    /// The error for steps whose states are missing in the recording, given its health.
    pub(super) fn missing_states(&self, steps: &RangeInclusive<u64>, health: Health) -> Error {
        let (from, to) = (*steps.start(), *steps.end());
        self.read_error(match health {
            Health::Whole => recording::Error::NoStates { from, to, last: self.header.steps },
            health => recording::Error::MissingStates { from, to, health: Box::new(health) },
        })
    }

    /// The health of the recording as far as its metadata give it: gaps, the end, the scene.
    pub(super) fn declared_health(&self) -> Result<ReadStatus, Error> {
        let mut recording = self.recording()?;
        recording.read_index().map_err(|error| self.read_error(error))?;
        Ok(ReadStatus { path: self.path.clone(), health: recording.health(), extent: ReadExtent::LastStep })
    }

    /// The error for a body that does not exist in this recording.
    pub(super) fn unknown_body(&self, name: &str) -> Error {
        const MAX_LISTED: usize = 8;
        let names = &self.statistics.names;
        let count = names.len();
        let names = names.iter().take(MAX_LISTED).map(|name| format!("{name:?}")).collect::<Vec<String>>().join(", ");
        let reason = match count {
            0 => format!("no body is named {name:?}, because the recording contains no bodies"),
            1 => format!("no body is named {name:?}; the only body is {names}"),
            2..=MAX_LISTED => format!("no body is named {name:?}; the bodies are {names}"),
            _ => format!("no body is named {name:?}; the first of {} are {names}", counted(count, "body")),
        };
        self.nothing_to_show(reason)
    }

    /// The error for a subject that the recording does not contain, or that a damaged one may have lost.
    pub(super) fn nothing_to_show(&self, reason: impl Into<String>) -> Error {
        let reason = reason.into();
        let health = self.recording().map(|mut recording| {
            recording.by_ref().for_each(drop);
            recording.health()
        });
        match health {
            Ok(Health::Whole) | Err(_) => Error::NothingToShow { reason },
            Ok(health) => Error::NothingReadable { path: self.path.clone(), reason, health: Box::new(health) },
        }
    }

    /// Adds the path of the recording to an error of reading it.
    pub(super) fn read_error(&self, source: recording::Error) -> Error {
        Error::Recording { path: self.path.clone(), source }
    }
}

/// The point up to which a recording was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadExtent {
    /// The end of the recording.
    End,
    /// The last requested step. The rest of the recording was not read.
    LastStep,
}

/// The health of a recording, as far as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadStatus {
    /// The recording.
    pub path: PathBuf,
    /// The damage found in the part that was read.
    pub health: Health,
    /// The point up to which it was read.
    pub extent: ReadExtent,
}

/// Decodes the images in a header. Lost ones are left out.
fn decoded_images(path: &Path, header: &Header) -> Result<BTreeMap<String, Arc<Bitmap>>, Error> {
    let mut images = BTreeMap::new();
    let mut pixels = 0;
    for SceneImage { name, png, .. } in &header.images {
        let Some(file) = png else { continue };
        let failed = |reason| Error::Image { path: path.into(), image: name.clone(), reason };
        let bitmap = png::decode_bitmap(file).map_err(failed)?;
        pixels += bitmap.pixels.len() as u64;
        if pixels > limits::IMAGES_PIXELS {
            return Err(failed(format!("all images together have more than {} pixels", limits::IMAGES_PIXELS)));
        }
        images.insert(name.clone(), Arc::new(bitmap));
    }
    Ok(images)
}

/// A scene for a recording that has lost the text of its own: the world reaches to the walls or, without walls, as far
/// as the bodies come.
fn scene_of_states(path: &Path, bytes: Option<&Arc<[u8]>>) -> Result<Scene, Error> {
    let default = scene::parse("", "[run]\nsteps = 1\n")?;
    let read_error = |source| Error::Recording { path: path.into(), source };
    let world = Vector::new(default.size[0], default.size[1]);
    let reach = RunStatistics::read(open(path, bytes)?, world).map_err(read_error)?.bounds;
    let first = Playback::new(open(path, bytes)?).next().transpose().map_err(read_error)?;
    let wall = |name: &str| {
        let bodies = first.iter().flat_map(|state| &state.bodies);
        let is_wall = |info: &BodyInfo| info.spawn.name == name && Walls::is_wall(info.id, &info.spawn);
        bodies.filter(|body| is_wall(&body.info)).map(|body| body.position).next()
    };
    let far = reach.map(|reach| reach.far_corner());
    let width = wall("wall-right").map(|position| position.x).or(far.map(|far| far.x));
    let height = wall("wall-bottom").map(|position| position.y).or(far.map(|far| far.y));
    let (Some(width), Some(height)) = (width, height) else { return Ok(default) };
    let text = format!("[world]\nsize = [{width:?}, {height:?}]\n[run]\nsteps = 1\n");
    Ok(scene::parse("", &text).unwrap_or(default))
}

/// The file of a recording.
pub enum RecordingFile {
    /// On disk.
    Disk(BufReader<File>),
    /// In memory.
    Memory(Cursor<Arc<[u8]>>),
}

impl Read for RecordingFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            RecordingFile::Disk(file) => file.read(buffer),
            RecordingFile::Memory(bytes) => bytes.read(buffer),
        }
    }
}

impl Seek for RecordingFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            RecordingFile::Disk(file) => file.seek(to),
            RecordingFile::Memory(bytes) => bytes.seek(to),
        }
    }
}

/// Opens the recording at `path`, or the one in `bytes`, which errors call `path`.
fn open(path: &Path, bytes: Option<&Arc<[u8]>>) -> Result<Recording<RecordingFile>, Error> {
    let read_error = |source| Error::Recording { path: path.into(), source };
    let file = match bytes {
        Some(bytes) => RecordingFile::Memory(Cursor::new(bytes.clone())),
        None => RecordingFile::Disk(BufReader::new(recording::open_file(path).map_err(read_error)?)),
    };
    Recording::read(file).map_err(|error| match bytes {
        Some(_) => read_error(error),
        None => read_error(error.or_plot_table(path)),
    })
}

/// The world in a recorded state, as far as energy and momentum depend on it: names and materials are missing.
pub fn recorded_world(state: &SampledState, config: &EngineConfig) -> World {
    let body = |recorded: &SampledBody| {
        let spawn = &recorded.info.spawn;
        let mut rect = spawn.rect;
        rect.origin = recorded.position;
        Body {
            id: recorded.info.id,
            name: String::new(),
            rect,
            mass: spawn.mass,
            inverse_mass: 1.0 / spawn.mass,
            velocity: recorded.velocity,
            force: Vector::ZERO,
            constant_force: spawn.force,
            material: Material::default(),
        }
    };
    let bodies = state.bodies.iter().map(body).collect();
    World { bodies, gravity: config.gravity, restitution: config.restitution.clone() }
}
