use crate::EventLine;
use crate::columns::{ColorKey, push_body};
use crate::scene_text::with_events;
use rebond::internals::scene::{Action, Blueprint, Input, InputLocation};
use rebond::recordings::{Change, Item, Playback, RecordedEvent, Recording, SampledState};
use rebond::{ALL_STEPS, CollisionCount, Replayer, Run, Scene, Verdict, parse_scene};
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
    /// The file name of the scene.
    scene_name: String,
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
            scene_name: source.header.scene.as_ref().map_or(String::new(), |scene| scene.file_name.clone()),
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

    /// The lines of events with which the scene runs as it did. A recording contains the effect of a click, not the
    /// click itself.
    ///
    /// # Errors
    /// If the recording does not contain the scene, or an event that no line causes.
    pub fn lines(&self) -> Result<Vec<EventLine>, String> {
        let scene = self.parsed_scene()?;
        let recording = read(&self.bytes)?;
        if !recording.header.has_live_events {
            return Ok(Vec::new());
        }
        let mut recorded: Vec<RecordedEvent> = Vec::new();
        for item in recording {
            if let Item::Event(event) = item.map_err(|error| error.to_string())? {
                recorded.push(event);
            }
        }
        let mut recorded = recorded.as_slice();
        let mut run = Run::new(&scene);
        let mut lines = Vec::new();
        loop {
            let step = run.engine().current_step();
            let (events, later) = recorded.split_at(recorded.partition_point(|event| event.step <= step));
            let added = added_lines(&scene, &run, events);
            let input =
                |line: &EventLine| Input { step, action: line.action.clone(), location: InputLocation::EventLine(0) };
            let applied = run.apply_inputs(added.iter().map(input).collect(), |error| Err(error.into()));
            let applied = applied.map_err(|error| error.to_string())?;
            // Lines have an order of their own within a step, which does not change the world after it.
            let is_applied = |(at, event): (usize, &RecordedEvent)| applied[at] == *event || applied.contains(event);
            if applied.len() != events.len() || !events.iter().enumerate().all(is_applied) {
                return Err(format!("no lines of events cause what is recorded at step {step}"));
            }
            lines.extend(added);
            recorded = later;
            if recorded.is_empty() {
                return Ok(lines);
            }
            run.step(&mut Vec::new()).map_err(|error| error.to_string())?;
        }
    }

    /// The scene with its events as tables.
    ///
    /// # Errors
    /// Those of [`Film::lines`], or of tables that cannot be appended.
    pub fn scene_with_events(&self) -> Result<String, String> {
        let scene = self.parsed_scene()?;
        with_events(&scene, &self.lines()?, scene.run.steps)
    }

    fn parsed_scene(&self) -> Result<Scene, String> {
        parse_scene(&self.scene_name, &self.scene).map_err(|error| error.to_string())
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

/// The lines for those of `events` that the scene does not cause itself. `events` are the recorded ones of the present
/// step of `run`.
pub fn added_lines(scene: &Scene, run: &Run, events: &[RecordedEvent]) -> Vec<EventLine> {
    if events.is_empty() {
        return Vec::new();
    }
    let step = run.engine().current_step();
    let mut scene_only = Run::restore(scene, &run.snapshot()).ok();
    let of_scene = scene_only.as_mut().and_then(|run| run.apply_inputs(Vec::new(), |error| Err(error.into())).ok());
    let mut of_scene = of_scene.unwrap_or_default().into_iter().peekable();
    let mut lines = Vec::new();
    for RecordedEvent { change, .. } in events {
        let is_same = |other: &RecordedEvent| match (&other.change, change) {
            (Change::Spawn(one), Change::Spawn(two)) => one.spawn == two.spawn && one.paint == two.paint,
            (other, change) => other == change,
        };
        // The events of the scene are in the same order.
        if of_scene.next_if(is_same).is_some() {
            continue;
        }
        lines.extend(action(change, run, events).map(|action| EventLine { step, action }));
    }
    lines
}

/// Returns the action that makes a change, which is one of the events of the present step of `run`.
fn action(change: &Change, run: &Run, events: &[RecordedEvent]) -> Option<Action> {
    let id = match change {
        Change::Spawn(info) => {
            let spawn = &info.spawn;
            let blueprint = Blueprint {
                name: Some(spawn.name.clone()).filter(|name| !name.starts_with('#')),
                size: [spawn.rect.width(), spawn.rect.height()],
                mass: spawn.mass,
                velocity: spawn.velocity,
                force: spawn.force,
                material: spawn.material.clone(),
                paint: info.paint.clone(),
            };
            return Some(Action::Spawn(blueprint.placed_at(spawn.rect.origin)));
        }
        Change::Delete { id } => *id,
    };
    if let Some(body) = run.engine().world().body(id) {
        return Some(Action::Delete { name: body.name.clone() });
    }
    // The body was made in this step. Deletes come before spawns, and clicks after them.
    let made = events.iter().find_map(|event| match &event.change {
        Change::Spawn(made) if made.id == id => Some(made),
        _ => None,
    })?;
    Some(Action::Click { at: made.spawn.rect.center(), spawn: None })
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
