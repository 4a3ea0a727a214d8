use crate::columns::{ColorKey, push_body};
use rebond::recordings::{Playback, Recording, SampledState};
use rebond::{ALL_STEPS, CollisionCount, Replayer, Verdict};
use std::io::Cursor;
use std::sync::Arc;

/// A recording that is shown.
pub struct Film {
    bytes: Arc<[u8]>,
    playback: Playback<Cursor<Arc<[u8]>>>,
    state: Option<SampledState>,
    /// The last step with a full state.
    pub steps: u64,
    /// Width and height of the world, m.
    pub size: [f64; 2],
    /// The scene in the recording; empty if it has none.
    pub scene: String,
    /// The title of the scene, or the name of the file.
    pub title: String,
    /// The highest speed, m/s.
    pub top_speed: f64,
    materials: Vec<String>,
}

impl Film {
    /// Opens the recording `bytes`, which messages call `name`.
    ///
    /// # Errors
    /// The message of a file that is not a recording.
    pub fn open(name: &str, bytes: Vec<u8>) -> Result<Film, String> {
        let bytes: Arc<[u8]> = bytes.into();
        let source = rebond::Source::from_bytes(name, bytes.clone()).map_err(|error| error.to_string())?;
        Ok(Film {
            playback: Playback::new(read(&bytes)?),
            bytes,
            state: None,
            steps: source.statistics.last_step.unwrap_or(0),
            size: source.scene.size,
            scene: source.header.scene.as_ref().map_or(String::new(), |scene| scene.text.clone()),
            title: source.title().to_owned(),
            top_speed: source.statistics.top_speed,
            materials: source.statistics.materials.clone(),
        })
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> &Arc<[u8]> {
        &self.bytes
    }

    /// Steps per second.
    pub fn rate(&self) -> f64 {
        self.playback.header().config.rate
    }

    /// The name of the solver.
    pub fn solver(&self) -> &'static str {
        self.playback.header().config.solver.name()
    }

    /// Shows the state of `step`, or the next one that is recorded in full, and returns its step.
    ///
    /// # Errors
    /// The message of a file that cannot be read there.
    pub fn show(&mut self, step: u64) -> Result<u64, String> {
        let shown = self.state.as_ref().map(|state| state.step);
        if shown == Some(step) {
            return Ok(step);
        }
        if shown.is_none_or(|shown| shown + 1 != step) {
            self.playback = Playback::new(read(&self.bytes)?);
            self.playback.seek(step).map_err(|error| error.to_string())?;
        }
        let next = self.playback.next().transpose().map_err(|error| error.to_string())?;
        self.state = next.or(self.state.take());
        self.state.as_ref().map(|state| state.step).ok_or_else(|| format!("no state is recorded from step {step} on"))
    }

    /// Appends the columns of the bodies shown.
    pub fn fill_columns(&self, key: ColorKey, columns: &mut Vec<f64>) {
        let materials: Vec<&str> = self.materials.iter().map(String::as_str).collect();
        for body in self.state.iter().flat_map(|state| &state.bodies) {
            let mut rect = body.info.spawn.rect;
            rect.origin = body.position;
            push_body(columns, &body.info, &rect, body.velocity, key, self.top_speed, &materials);
        }
    }

    /// Names and materials of the bodies shown, as JSON.
    pub fn names(&self) -> String {
        let bodies = self.state.iter().flat_map(|state| &state.bodies);
        let bodies = bodies.map(|body| [&body.info.spawn.name as &str, &body.info.spawn.material]);
        serde_json::to_string(&bodies.collect::<Vec<_>>()).unwrap_or_default()
    }
}

/// A replay of a recording, in slices.
pub struct LiveVerdict {
    replayer: Replayer<Cursor<Arc<[u8]>>>,
    /// The last step that was compared.
    pub step: u64,
    compared: u64,
}

impl LiveVerdict {
    /// Starts to replay the recording `bytes`.
    ///
    /// # Errors
    /// The message of a recording that cannot be replayed.
    pub fn new(bytes: &Arc<[u8]>) -> Result<LiveVerdict, String> {
        let replayer = Replayer::new(read(bytes)?, ALL_STEPS).map_err(|error| error.to_string())?;
        Ok(LiveVerdict { replayer, step: 0, compared: 0 })
    }

    /// Compares up to `states` states, and returns true at the end or at a difference.
    ///
    /// # Errors
    /// The message of a file that cannot be read, or that has no state to compare.
    pub fn advance(&mut self, states: u64) -> Result<bool, String> {
        for _ in 0..states {
            match self.replayer.next_state(&mut CollisionCount::default()).map_err(|error| error.to_string())? {
                Some(step) => {
                    self.step = step;
                    self.compared += 1;
                }
                None if self.compared == 0 && matches!(self.replayer.verdict(), Verdict::Same { .. }) => {
                    return Err("the recording contains no states, so nothing was compared".into());
                }
                None => return Ok(true),
            }
        }
        Ok(false)
    }

    /// The verdict so far.
    pub fn verdict(&self) -> Verdict {
        self.replayer.verdict()
    }
}

fn read(bytes: &Arc<[u8]>) -> Result<Recording<Cursor<Arc<[u8]>>>, String> {
    Recording::read(Cursor::new(bytes.clone())).map_err(|error| error.to_string())
}
