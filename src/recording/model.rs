//! The contents of a recording, apart from the states.

use std::{
    fmt::{self, Display, Formatter},
    sync::Arc,
};

use crate::physics::{Accuracy, Body, BodyId, EngineConfig, Event, Rect, Snapshot, SolverSnapshot, StepError, Vector};

use super::{BodyInfo, BodyTable, Gap, Identity, StateBounds};

/// The version of the file format that this program writes: topics, schemas, metadata.
///
/// The reader accepts every older version and rejects newer ones. Version 2 added the state bounds
/// to the end record, and stores the solver's numbers in keyframes by columns. Version 3 stores the name, length and
/// digest of the scene in the metadata, errors by their fields, and large keyframes in several messages.
pub const FORMAT_VERSION: u32 = 3;

/// The version of the engine semantics. It is incremented whenever the same events may give different
/// states, even by one bit.
pub const SEMANTICS_VERSION: u32 = 2;

/// The header of a recording: settings and versions.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The versions of the program that recorded.
    pub versions: Versions,
    /// The configuration of the engine.
    pub config: EngineConfig,
    /// The planned number of steps. An error may end the run earlier.
    pub steps: u64,
    /// The state of every `every`-th step is recorded in full, the others as digests only.
    pub every: u64,
    /// True if the accuracy of the run is estimated; the end record contains it.
    pub estimates_accuracy: bool,
    /// The scene's source text; `None` if that part of the recording is lost.
    pub scene: Option<SceneText>,
    /// The images that the scene draws into boxes.
    pub images: Vec<SceneImage>,
    /// The values of the scene that were set for this run (`record --set`): key and value of each, in the order in
    /// which they were applied. The text of the scene contains them.
    pub overrides: Vec<[String; 2]>,
    /// True if the run read live events (`record --events`), which the scene does not contain.
    pub has_live_events: bool,
    /// The gaps of a recovered recording; empty for any other.
    pub gaps: Vec<Gap>,
}

impl Header {
    /// A header of the present versions for `steps` steps, each recorded in full.
    pub fn new(config: EngineConfig, steps: u64, scene: SceneText) -> Header {
        Header {
            versions: Versions::CURRENT,
            config,
            steps,
            every: 1,
            estimates_accuracy: false,
            scene: Some(scene),
            images: Vec::new(),
            overrides: Vec::new(),
            has_live_events: false,
            gaps: Vec::new(),
        }
    }

    /// Sets the distance of the states that are recorded in full, in steps.
    pub fn with_every(self, every: u64) -> Header {
        Header { every, ..self }
    }

    /// Returns the log time of the messages of `step`: the simulated time in nanoseconds since the start of the run.
    pub fn log_time(&self, step: u64) -> u64 {
        nanoseconds(step, self.config.rate)
    }

    /// Returns true if the end record stores the bounds of all states, which a recording with gaps does not know.
    pub(super) fn has_state_bounds(&self) -> bool {
        const FIRST_FORMAT_WITH_BOUNDS: u32 = 2;
        self.gaps.is_empty() && self.versions.format >= FIRST_FORMAT_WITH_BOUNDS
    }

    /// Returns the number of steps nearest to a second of simulated time, at least 1. Keyframes are this far apart,
    /// and the writer flushes as often.
    pub fn steps_per_second(&self) -> u64 {
        steps_per_second(self.config.rate)
    }
}

/// The versions that a recording was made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Versions {
    /// The format version; see [`FORMAT_VERSION`].
    pub format: u32,
    /// The engine-semantics version; see [`SEMANTICS_VERSION`].
    pub semantics: u32,
}

impl Versions {
    /// The versions of this program.
    pub const CURRENT: Versions = Versions { format: FORMAT_VERSION, semantics: SEMANTICS_VERSION };
}

/// The scene file at the time of recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneText {
    /// The file name without directories.
    pub file_name: String,
    /// The TOML text.
    pub text: String,
}

/// An image file of the scene at the time of recording: a PNG file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneImage {
    /// The path of the file relative to the folder of the scene, as the scene names it.
    pub name: String,
    /// Its length, bytes.
    pub bytes: u64,
    /// The XXH3-64 of the file.
    pub digest: u64,
    /// The file; `None` if that part of the recording is lost.
    pub png: Option<Arc<[u8]>>,
}

impl SceneImage {
    /// The image in a file.
    pub fn new(name: &str, png: Vec<u8>) -> SceneImage {
        let digest = xxhash_rust::xxh3::xxh3_64(&png);
        SceneImage { name: name.into(), bytes: png.len() as u64, digest, png: Some(png.into()) }
    }
}

/// The end record of a finished recording (metadata `rebond_end`): how the run ended.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub struct Trailer {
    /// The number of steps, which is also the step of the last state.
    pub steps: u64,
    /// The number of collisions with an impulse; `None` if the original end record was lost.
    pub collisions: Option<u64>,
    /// The number of bodies ever spawned, walls included.
    pub bodies: u64,
    /// The number of spawns and deletes.
    pub events: u64,
    /// The engine's error, if the run ended in one.
    pub error: Option<RecordedError>,
    /// The accuracy of the run, if it was estimated.
    pub accuracy: Option<Accuracy>,
    /// True if the recording was recovered from a damaged or unfinished one.
    pub recovered: bool,
    /// Bounds of all states recorded in full; `None` if states are missing, if the top speed is not
    /// finite, and before format 2.
    pub state_bounds: Option<StateBounds>,
    /// The identity of the run.
    pub identity: Identity,
}

/// The error in which a recorded run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordedError {
    /// The error of the engine.
    Step(StepError),
    /// The text of the error, in recordings before format 3 and for errors that this program does not know.
    Text(String),
}

impl RecordedError {
    /// Parses an error of the end record: an object of JSON, or any text before format 3.
    pub(super) fn parse(text: &str) -> RecordedError {
        serde_json::from_str(text).map_or_else(|_| RecordedError::Text(text.into()), RecordedError::Step)
    }

    /// Returns the error as it is stored: its fields as JSON, or before format 3 its text.
    pub(super) fn stored(&self, format: u32) -> String {
        const FIRST_FORMAT_WITH_FIELDS: u32 = 3;
        match self {
            RecordedError::Step(error) if format >= FIRST_FORMAT_WITH_FIELDS => {
                serde_json::to_string(error).unwrap_or_else(|_| error.to_string())
            }
            error => error.to_string(),
        }
    }
}

/// Formats the message for people.
impl Display for RecordedError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            RecordedError::Step(error) => f.write_str(&error_text(error)),
            RecordedError::Text(text) => f.write_str(text),
        }
    }
}

/// Returns the message of an error that ended a run. Adds the scene key that raises an exceeded limit; the engine
/// itself does not depend on scenes.
pub fn error_text(error: &StepError) -> String {
    match error {
        StepError::TooManyEvents { .. } => format!("{error}; raise run.events_per_step if this is meant"),
        _ => error.to_string(),
    }
}

/// An event as it was applied to the engine, with all values resolved. Replay applies it again.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedEvent {
    /// The step whose state the event changed, before that state was recorded.
    pub step: u64,
    /// The change.
    pub change: Change,
}

/// The effect of an event.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A body was created.
    Spawn(Arc<BodyInfo>),
    /// A body was removed.
    Delete {
        /// The id of the body.
        id: BodyId,
    },
}

impl Change {
    /// Returns the event in the form that the engine applies.
    pub fn event(&self) -> Event {
        match self {
            Change::Spawn(info) => Event::Spawn(info.spawn.clone()),
            Change::Delete { id } => Event::Delete(*id),
        }
    }
}

/// The complete state of a step, from which a run can be continued bit for bit.
///
/// In the file it follows the events of its step and precedes the state.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframe {
    /// The step.
    pub step: u64,
    /// The id of the next body to be spawned.
    pub next_id: BodyId,
    /// The living bodies, in creation order.
    pub bodies: Vec<KeyframeBody>,
    /// The internal state of the solver.
    pub solver: SolverSnapshot,
}

/// A body in a [`Keyframe`].
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframeBody {
    /// The constants and the initial state.
    pub info: Arc<BodyInfo>,
    /// The upper-left corner, m.
    pub position: Vector,
    /// The velocity, m/s.
    pub velocity: Vector,
    /// The accumulated force of the engine, N.
    pub force: Vector,
}

impl Keyframe {
    /// Creates the keyframe of a snapshot, whose bodies must be those of `table`.
    pub fn new(snapshot: Snapshot, table: &BodyTable) -> Keyframe {
        let bodies = snapshot.bodies.iter().zip(table.bodies()).map(|(body, info)| KeyframeBody {
            info: info.clone(),
            position: body.rect.origin,
            velocity: body.velocity,
            force: body.force,
        });
        Keyframe { step: snapshot.step, next_id: snapshot.next_id, bodies: bodies.collect(), solver: snapshot.solver }
    }

    /// Returns the snapshot for [`Engine::restore`](crate::physics::Engine::restore).
    pub fn snapshot(&self, config: &EngineConfig) -> Snapshot {
        Snapshot {
            step: self.step,
            next_id: self.next_id,
            bodies: self.bodies.iter().map(|body| body.body(config)).collect(),
            solver: self.solver.clone(),
        }
    }

    /// Returns the living bodies.
    pub fn table(&self) -> BodyTable {
        self.bodies.iter().map(|body| body.info.clone()).collect()
    }
}

impl KeyframeBody {
    /// Returns the body as the engine stores it.
    fn body(&self, config: &EngineConfig) -> Body {
        let BodyInfo { id, spawn, .. } = &*self.info;
        Body {
            id: *id,
            name: spawn.name.clone(),
            rect: Rect::new(self.position, spawn.rect.width(), spawn.rect.height()),
            mass: spawn.mass,
            inverse_mass: 1.0 / spawn.mass,
            velocity: self.velocity,
            force: self.force,
            constant_force: spawn.force,
            material: config.restitution.material(&spawn.material),
        }
    }
}

/// The unit of times in a recording is the nanosecond.
pub(super) const NANOSECONDS_PER_SECOND: u64 = 1_000_000_000;

/// Returns the simulated time of state `step`, in nanoseconds since the start of the run.
///
/// Exact (rounded down) if `rate` (Hz) is an integer, else to the precision of f64. Saturates at
/// `u64::MAX` (584 years).
fn nanoseconds(step: u64, rate: f64) -> u64 {
    const SECOND: u128 = NANOSECONDS_PER_SECOND as u128;
    let whole = rate as u64;
    if whole as f64 == rate {
        u64::try_from(u128::from(step) * SECOND / u128::from(whole)).unwrap_or(u64::MAX)
    } else {
        (step as f64 * SECOND as f64 / rate) as u64
    }
}

/// Returns the number of steps nearest to a second of simulated time, at least 1.
fn steps_per_second(rate: f64) -> u64 {
    (rate.round() as u64).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integer_rates_are_exact() {
        assert_eq!(nanoseconds(1, 60.0), 16_666_666);
        assert_eq!(nanoseconds(86_400 * 60, 60.0), 86_400_000_000_000);
        assert_eq!(nanoseconds(3, 0.5), 6_000_000_000);
        assert_eq!(nanoseconds(u64::MAX, 1.0), u64::MAX);
    }

    #[test]
    fn a_second_has_at_least_one_step() {
        assert_eq!([0.1, 1.0, 59.94, 60.0].map(steps_per_second), [1, 1, 60, 60]);
    }
}
