//! Checking a recording: it must replay the same and match a new run of the scene next to it.

use super::{CheckResult, Outcome, Replacement};
use crate::physics::{CollisionCount, Spawn, Vector};
use crate::recording::{self, BodyTable, Change, Error, Header, Identity, Item, RecordedState, Recording};
use crate::replay::{self, ALL_STEPS, Difference, Replayer, RunError, Verdict, ulps};
use crate::scene;
use crate::temporary::TemporaryFolder;
use crate::text::counted;
use std::fmt::{self, Display, Formatter};
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};

/// Checks the recording at `path`, and compares it with a new run of the scene, if one is given.
pub fn check_recording(path: &Path, scene: Option<&Path>) -> CheckResult {
    let replayed = replay_recording(path);
    let (outcome, replacement) = match scene {
        Some(scene) => compare_with_scene(path, replayed, scene),
        None => (replayed, None),
    };
    CheckResult { path: path.into(), outcome, replacement }
}

fn replay_recording(path: &Path) -> Outcome {
    let replay = Replayer::open(path, ALL_STEPS);
    match replay.and_then(|replay| replay.run(&mut CollisionCount::default(), |_| ())) {
        Ok(Verdict::Diverged(divergence)) => Outcome::Diverged(divergence),
        Ok(verdict) => Outcome::Replayed { verdict, matches_scene: false },
        Err(Error::OtherSemantics { found }) => Outcome::OtherSemantics { found },
        Err(error) if error.is_damage() => Outcome::Damaged(error.to_string()),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}

/// Runs the scene again and compares the recording at `path` with the new run.
fn compare_with_scene(path: &Path, replayed: Outcome, scene: &Path) -> (Outcome, Option<Replacement>) {
    let new_recording = match record_scene(scene, path) {
        Ok(new_recording) => new_recording,
        Err(error) => {
            return (Outcome::Failed(format!("its scene {} cannot be run: {error}", scene.display())), None);
        }
    };
    let Outcome::Replayed { verdict: verdict @ Verdict::Same { .. }, .. } = replayed else {
        return (replayed, Some(Replacement::Recording(new_recording.file)));
    };
    match compare_with(path, &new_recording) {
        Ok(None) => (Outcome::Replayed { verdict, matches_scene: true }, None),
        Ok(Some(mismatch)) => (Outcome::Drifted(mismatch), Some(Replacement::Recording(new_recording.file))),
        Err(error) => (Outcome::Failed(error.to_string()), None),
    }
}

/// A recording in a temporary folder, which is removed when this is dropped.
#[derive(Debug)]
pub struct TemporaryRecording(TemporaryFolder);

impl TemporaryRecording {
    /// Creates the folder.
    ///
    /// # Errors
    /// If the folder for temporary files is not writable.
    pub fn create() -> io::Result<TemporaryRecording> {
        TemporaryFolder::create_in_system().map(TemporaryRecording)
    }

    /// The path of the recording.
    pub fn path(&self) -> PathBuf {
        self.0.path().join("scene.mcap")
    }
}

/// A recording of a new run of a scene.
struct NewRecording {
    file: TemporaryRecording,
    identity: Identity,
}

/// Records a scene with the number of steps and the thinning of the recording at `path`, or in full if that recording
/// cannot be read.
fn record_scene(scene: &Path, path: &Path) -> Result<NewRecording, RunError> {
    let scene = scene::load(scene)?;
    let (steps, every, estimates_accuracy) = match recording::open(path) {
        Ok(recording) => {
            let header = &recording.header;
            (header.steps, header.every, header.estimates_accuracy)
        }
        Err(_) => (scene.run.steps, 1, false),
    };
    let unwritable = |error| RunError::from(Error::Write(error));
    let recording = TemporaryRecording::create().map_err(unwritable)?;
    let file = File::create_new(recording.path()).map_err(unwritable)?;
    let plan = replay::RecordOptions { steps, every, estimates_accuracy, ..replay::RecordOptions::complete(&scene) };
    let recorded = replay::record(&scene, plan, replay::NO_LIVE_EVENTS, file, |_| ())?;
    Ok(NewRecording { file: recording, identity: recorded.trailer.identity })
}

/// Compares the recording at `path` with a new one. `None` if both have the same identity.
fn compare_with(path: &Path, new_recording: &NewRecording) -> Result<Option<SceneMismatch>, Error> {
    let mut recorded = recording::open(path)?;
    for item in recorded.by_ref() {
        item?;
    }
    if recorded.trailer().is_some_and(|end| end.identity == new_recording.identity) {
        return Ok(None);
    }
    let current = recording::open(&new_recording.file.path())?;
    let lines = |header: &Header| header.scene.as_ref().map(|scene| scene.text.replace("\r\n", "\n"));
    let has_same_lines = lines(&recorded.header) == lines(&current.header);
    match SceneMismatch::between(recording::open(path)?, current)? {
        SceneMismatch::Text if has_same_lines => Ok(None),
        mismatch => Ok(Some(mismatch)),
    }
}

/// The difference between a recording and a new run of the scene next to it.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneMismatch {
    /// Only the text of the scene differs; the runs are the same.
    Text,
    /// The engine configuration differs: solver, rate, gravity, restitution or event limit.
    EngineConfig,
    /// An event differs.
    Events {
        /// The step of the first difference.
        step: u64,
        /// The recorded event in words.
        recorded: String,
        /// The event of the new run in words.
        current: String,
    },
    /// A state differs although all events up to it are the same.
    State {
        /// The step of the first difference.
        step: u64,
        /// The difference; its `replayed` value is the one of the new run.
        difference: Difference,
    },
    /// The number of steps differs.
    Length {
        /// The last step of the recording.
        recorded: u64,
        /// The last step of the new run.
        current: u64,
    },
}

impl SceneMismatch {
    /// Returns the first difference between two recordings of different identity.
    ///
    /// # Errors
    /// If one of them cannot be read.
    pub fn between<R: Read + Seek, S: Read + Seek>(
        mut recorded: Recording<R>,
        mut current: Recording<S>,
    ) -> Result<SceneMismatch, Error> {
        if recorded.header.config != current.header.config {
            return Ok(SceneMismatch::EngineConfig);
        }
        let mut last = 0;
        loop {
            match (next_item(&mut recorded)?, next_item(&mut current)?) {
                (None, None) => return Ok(SceneMismatch::Text),
                (Some(Item::State(old)), Some(Item::State(new))) => {
                    if let Some(difference) = difference(&old, &new, recorded.table()) {
                        return Ok(SceneMismatch::State { step: old.step, difference });
                    }
                    last = old.step;
                }
                (Some(Item::State(_)), None) => {
                    return Ok(SceneMismatch::Length { recorded: recorded.header.steps, current: last });
                }
                (None, Some(Item::State(new))) => {
                    return Ok(SceneMismatch::Length { recorded: last, current: current.header.steps.max(new.step) });
                }
                (old, new) if old == new => {}
                (old, new) => return Ok(event_mismatch(old.as_ref(), new.as_ref())),
            }
        }
    }
}

/// Returns the next event or state.
fn next_item<R: Read + Seek>(recording: &mut Recording<R>) -> Result<Option<Item>, Error> {
    for item in recording.by_ref() {
        match item? {
            item @ (Item::Event(_) | Item::State(_)) => return Ok(Some(item)),
            Item::SuspectState(_) | Item::Keyframe(_) | Item::SceneUpdate { .. } => {}
            Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_) => {}
        }
    }
    Ok(None)
}

fn difference(old: &RecordedState, new: &RecordedState, table: Option<&BodyTable>) -> Option<Difference> {
    if old.id == new.id {
        for (index, &id) in old.id.iter().enumerate() {
            let pairs = old.body_state(index).into_iter().zip(new.body_state(index)).zip(["x", "y", "vx", "vy"]);
            for ((recorded, replayed), field) in pairs {
                if ulps(recorded, replayed) > 0 {
                    let info =
                        table.and_then(|table| table.join_state(old).map(|(info, _)| info).find(|info| info.id == id));
                    let body = info.map_or(format!("{id}"), |info| info.spawn.name.clone());
                    return Some(Difference::Value { body, field, recorded, replayed });
                }
            }
        }
    }
    (old.digest != new.digest).then_some(Difference::Digest { recorded: old.digest, replayed: new.digest })
}

fn event_mismatch(old: Option<&Item>, new: Option<&Item>) -> SceneMismatch {
    let step = [old, new].into_iter().flatten().filter_map(step).min().unwrap_or(0);
    match (old, new) {
        (Some(Item::Event(old)), Some(Item::Event(new))) if old.step == new.step => {
            let (recorded, current) = describe_difference(&old.change, &new.change);
            SceneMismatch::Events { step, recorded, current }
        }
        (old, new) => {
            SceneMismatch::Events { step, recorded: describe_item(old, step), current: describe_item(new, step) }
        }
    }
}

fn step(item: &Item) -> Option<u64> {
    match item {
        Item::Event(event) => Some(event.step),
        Item::State(state) | Item::SuspectState(state) => Some(state.step),
        Item::Keyframe(_) | Item::SceneUpdate { .. } | Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_) => None,
    }
}

/// Describes an item if it is an event of step `step`.
fn describe_item(item: Option<&Item>, step: u64) -> String {
    match item {
        Some(Item::Event(event)) if event.step == step => describe(&event.change),
        Some(_) | None => "no further event".into(),
    }
}

fn describe(change: &Change) -> String {
    match change {
        Change::Spawn { spawn, .. } => format!("spawn {:?}", spawn.name),
        Change::Delete { id } => format!("delete body {id}"),
    }
}

/// Describes two events, including the first property in which they differ.
fn describe_difference(old: &Change, new: &Change) -> (String, String) {
    let (Change::Spawn { spawn: a, color: a_color, .. }, Change::Spawn { spawn: b, color: b_color, .. }) = (old, new)
    else {
        return (describe(old), describe(new));
    };
    let pair = |vector: Vector| format!("[{:?}, {:?}]", vector.x, vector.y);
    let size = |spawn: &Spawn| format!("[{:?}, {:?}]", spawn.rect.width(), spawn.rect.height());
    let color = |color: &Option<String>| color.clone().unwrap_or_else(|| "none".into());
    let (property, [a_value, b_value]) = if a.name != b.name {
        return (describe(old), describe(new));
    } else if a.rect.origin != b.rect.origin {
        ("at", [a, b].map(|spawn| pair(spawn.rect.origin)))
    } else if a.mass != b.mass {
        ("mass", [a, b].map(|spawn| format!("{:?}", spawn.mass)))
    } else if a.velocity != b.velocity {
        ("velocity", [a, b].map(|spawn| pair(spawn.velocity)))
    } else if a.force != b.force {
        ("force", [a, b].map(|spawn| pair(spawn.force)))
    } else if a.material != b.material {
        ("material", [a, b].map(|spawn| format!("{:?}", spawn.material)))
    } else if a_color != b_color {
        ("color", [a_color, b_color].map(color))
    } else {
        ("size", [a, b].map(size))
    };
    (format!("{} with {property} {a_value}", describe(old)), format!("{} with {property} {b_value}", describe(new)))
}

impl Display for SceneMismatch {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        match self {
            SceneMismatch::Text => write!(out, "the text of its scene has changed, without effect on the run"),
            SceneMismatch::EngineConfig => {
                write!(out, "its scene now has a different solver, rate, gravity, restitution or event limit")
            }
            SceneMismatch::Events { step, recorded, current } => {
                write!(out, "its scene now gives a different run: at step {step} recorded {recorded}, now {current}")
            }
            SceneMismatch::State { step, difference } => {
                write!(
                    out,
                    "its scene now gives a different run, called \"replayed\" here: at step {step} {difference}"
                )
            }
            SceneMismatch::Length { recorded, current } => {
                write!(out, "its scene now runs {}, the recording has {recorded}", counted(*current, "step"))
            }
        }
    }
}
