use crate::physics::{Body, BodyId, Engine, EngineConfig, Observer, Snapshot, SnapshotError, StepError, Vector, World};
use crate::recording::{self, BodyInfo, Change, RecordedEvent, error_text};
use crate::scene::{
    Action, Blueprint, DiagnosticKind, Input, InputLocation, Scene, SceneError, SceneSource, SpawnRequest,
};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt::{self, Display, Formatter};
use std::io;
use std::sync::Arc;

/// A run of a scene that is advanced step by step: the engine, and the inputs of later steps.
#[doc(alias = "simulation")]
#[derive(Clone)]
pub struct Run {
    engine: Engine,
    scheduled: VecDeque<Input>,
    source: SceneSource,
    names: Names,
    /// The images that the scene uses, and no other may.
    images: Arc<BTreeSet<String>>,
    idle_clicks: IdleClicks,
}

/// The clicks of a run that hit no body and have none to spawn, so that they change nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IdleClicks {
    /// Their number.
    pub count: u64,
    /// The step and the point (m) of the first one.
    pub first: Option<(u64, Vector)>,
}

/// Formats the number of clicks and the first one; empty if there are none.
impl Display for IdleClicks {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Some((step, at)) = self.first else { return Ok(()) };
        let place = format!("at step {step} on the point ({:?}, {:?})", at.x, at.y);
        match self.count {
            1 => write!(
                f,
                "the click {place} changes nothing: there is no body of finite mass, and the click has no spawn"
            ),
            count => write!(
                f,
                "{count} clicks change nothing, the first one {place}: there is no body of finite mass, and they have no spawn"
            ),
        }
    }
}

impl Run {
    /// A run of `scene` at step 0, before its first inputs.
    pub fn new(scene: &Scene) -> Run {
        Run {
            engine: Engine::new(engine_config(scene)),
            scheduled: scene.inputs.iter().cloned().collect(),
            source: scene.source.clone(),
            names: Names::default(),
            images: Arc::new(scene.image_names()),
            idle_clicks: IdleClicks::default(),
        }
    }

    /// The engine.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The clicks so far that changed nothing, since the run was created or restored.
    pub fn idle_clicks(&self) -> IdleClicks {
        self.idle_clicks
    }

    /// Returns a snapshot from which [`Run::restore`] continues bit for bit. The inputs of the current step must have
    /// been applied.
    pub fn snapshot(&self) -> RunSnapshot {
        RunSnapshot { engine: self.engine.snapshot(), scheduled: self.scheduled.len(), spawns: self.names.spawns }
    }

    /// Restores a run from a snapshot of a run of the same `scene`.
    ///
    /// # Errors
    /// Returns an error if the snapshot is from a run with another solver.
    pub fn restore(scene: &Scene, snapshot: &RunSnapshot) -> Result<Run, SnapshotError> {
        let engine = Engine::restore(engine_config(scene), snapshot.engine.clone())?;
        let alive = engine.world().bodies.iter().map(|body| (body.name.clone(), body.id)).collect();
        let scheduled = scene.inputs.iter().skip(scene.inputs.len() - snapshot.scheduled.min(scene.inputs.len()));
        Ok(Run {
            engine,
            scheduled: scheduled.cloned().collect(),
            source: scene.source.clone(),
            names: Names { alive, spawns: snapshot.spawns },
            images: Arc::new(scene.image_names()),
            idle_clicks: IdleClicks::default(),
        })
    }

    /// Applies the inputs of the current step, those of the scene and `live` ones: deletes, then spawns,
    /// then clicks. Returns the resulting events; a click may cause none.
    ///
    /// In scenes with clicks and for live events, a spawn whose name is in use and a delete of a body that is
    /// not alive are detected only here. `on_refused` is called with the error of a live event; it returns an
    /// error to end the run.
    ///
    /// # Errors
    /// Returns an error if an input of the scene is refused, or if `on_refused` returns an error.
    pub fn apply_inputs(
        &mut self,
        live: Vec<Input>,
        mut on_refused: impl FnMut(SceneError) -> Result<(), RunError>,
    ) -> Result<Vec<RecordedEvent>, RunError> {
        let step = self.engine.current_step();
        let due = self.scheduled.iter().take_while(|input| input.step <= step).count();
        let mut inputs: Vec<Input> = self.scheduled.drain(..due).collect();
        if due > 0 && self.scheduled.is_empty() {
            // The inputs of a million spawns would take 13 % of the memory of the run.
            self.scheduled.shrink_to_fit();
        }
        inputs.extend(live);
        // The sort allocates memory for half of them.
        if !inputs.is_sorted_by_key(|input| input.action.phase()) {
            inputs.sort_by_key(|input| input.action.phase());
        }
        let mut events = Vec::with_capacity(inputs.len());
        for Input { action, location, .. } in inputs {
            match self.resolve(action) {
                Ok(change) => events.extend(change.map(|change| self.apply(change))),
                Err(kind) => {
                    let error = SceneError::at(&self.source, &location, kind);
                    match location {
                        InputLocation::Scene(_) => return Err(error.into()),
                        InputLocation::EventLine(_) => on_refused(error)?,
                    }
                }
            }
        }
        Ok(events)
    }

    /// Advances the world by one step.
    ///
    /// # Errors
    /// Returns an error if the engine cannot complete the step; the run is then over.
    pub fn step<O: Observer>(&mut self, observer: &mut O) -> Result<(), StepError> {
        self.engine.step(observer)
    }

    /// Advances to the state `step` as it would be recorded, with the inputs of that step applied.
    ///
    /// ```
    /// # let builder = rebond::SceneBuilder::default();
    /// # let scene = builder.build("scene.toml")?;
    /// let mut run = rebond::Run::new(&scene);
    /// let mut collisions = Vec::new();
    /// run.go_to(60, &mut collisions)?;
    /// assert_eq!(run.engine().current_step(), 60);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if an input of the scene is refused, or if the engine cannot complete a step.
    pub fn go_to<O: Observer>(&mut self, step: u64, observer: &mut O) -> Result<(), RunError> {
        self.apply_inputs(Vec::new(), |error| Err(error.into()))?;
        while self.engine.current_step() < step {
            self.step(observer)?;
            self.apply_inputs(Vec::new(), |error| Err(error.into()))?;
        }
        Ok(())
    }

    /// Converts an action to a change of the current world; a click may cause none.
    fn resolve(&mut self, action: Action) -> Result<Option<Change>, DiagnosticKind> {
        match action {
            Action::Wall(request) => self.spawn_wall(request).map(Some),
            Action::Spawn(request) => self.spawn(request).map(Some),
            Action::Delete { name } => self.delete(&name).map(Some),
            Action::Click { at, spawn } => self.click(at, spawn),
        }
    }

    fn spawn_wall(&mut self, request: SpawnRequest) -> Result<Change, DiagnosticKind> {
        let name = request.blueprint.name.clone().unwrap_or_default();
        self.spawn_named(name, request)
    }

    fn spawn(&mut self, request: SpawnRequest) -> Result<Change, DiagnosticKind> {
        let number = self.names.count_spawn();
        let name = request.blueprint.name.clone().unwrap_or_else(|| format!("#{number}"));
        self.spawn_named(name, request)
    }

    fn spawn_named(&mut self, name: String, request: SpawnRequest) -> Result<Change, DiagnosticKind> {
        let id = self.engine.next_id();
        let step = self.engine.current_step();
        if let Some(image) = request.blueprint.paint.image().filter(|image| !self.images.contains(*image)) {
            let reason = "the scene does not use it, so the recording does not contain it".into();
            return Err(DiagnosticKind::Image { image: image.into(), reason });
        }
        if !self.names.claim(&name, id) {
            return Err(DiagnosticKind::NameTaken { name, step });
        }
        let paint = request.blueprint.paint.clone();
        Ok(Change::Spawn(BodyInfo { id, spawn: request.spawn(name), paint }.into()))
    }

    fn delete(&mut self, name: &str) -> Result<Change, DiagnosticKind> {
        let step = self.engine.current_step();
        match self.names.release(name) {
            Some(id) => Ok(Change::Delete { id }),
            None => Err(DiagnosticKind::NotAlive { name: name.into(), step, alive: self.names.first_alive() }),
        }
    }

    /// The handout's mouse click. A click that deletes a body never also spawns one. In the handout it does:
    /// the event that removes a box also reaches the canvas below, which creates a new box.
    fn click(&mut self, at: Vector, spawn: Option<Blueprint>) -> Result<Option<Change>, DiagnosticKind> {
        if let Some(name) = topmost_body(self.engine.world(), at) {
            return self.delete(&name).map(Some);
        }
        if spawn.is_none() {
            self.idle_clicks.count += 1;
            self.idle_clicks.first.get_or_insert((self.engine.current_step(), at));
        }
        spawn.map(|blueprint| self.spawn(blueprint.centered_on(at))).transpose()
    }

    fn apply(&mut self, change: Change) -> RecordedEvent {
        self.engine.apply(&change.event());
        RecordedEvent { step: self.engine.current_step(), change }
    }
}

/// The complete state of a [`Run`], from which it continues bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSnapshot {
    engine: Snapshot,
    /// The number of inputs of the scene that are still to come.
    scheduled: usize,
    /// The number of spawns so far.
    spawns: u64,
}

impl RunSnapshot {
    /// The step of the state.
    pub fn step(&self) -> u64 {
        self.engine.step
    }

    /// The memory that it occupies, bytes.
    pub fn bytes(&self) -> usize {
        let Snapshot { bodies, solver, .. } = &self.engine;
        let names: usize = bodies.iter().map(|body| body.name.capacity()).sum();
        let numbers = solver.integers.capacity() + solver.numbers.capacity();
        size_of::<RunSnapshot>() + bodies.capacity() * size_of::<Body>() + names + numbers * size_of::<u64>()
    }
}

/// The engine configuration of a scene.
pub fn engine_config(scene: &Scene) -> EngineConfig {
    EngineConfig {
        solver: scene.run.solver,
        rate: scene.run.rate,
        gravity: scene.gravity,
        restitution: scene.restitution.clone(),
        events_per_step: scene.run.events_per_step,
    }
}

/// The name of the body of finite mass created last that contains the point.
fn topmost_body(world: &World, point: Vector) -> Option<String> {
    let hit = world.bodies.iter().rev().find(|body| !body.is_infinite() && body.rect.has_point(point));
    hit.map(|body| body.name.clone())
}

/// The names of the bodies alive, and the number of spawns, from which the default names `#K` are formed.
#[derive(Clone, Debug, Default)]
struct Names {
    alive: BTreeMap<String, BodyId>,
    spawns: u64,
}

impl Names {
    /// Counts a spawn and returns its number: 1 for the first of the run; walls are not counted.
    fn count_spawn(&mut self) -> u64 {
        self.spawns += 1;
        self.spawns
    }

    /// Gives `name` to a body; returns false if another body has it.
    fn claim(&mut self, name: &str, id: BodyId) -> bool {
        let is_free = !self.alive.contains_key(name);
        if is_free {
            self.alive.insert(name.to_owned(), id);
        }
        is_free
    }

    /// Removes `name` and returns the body that had it.
    fn release(&mut self, name: &str) -> Option<BodyId> {
        self.alive.remove(name)
    }

    /// The first few names alive, for a message.
    fn first_alive(&self) -> Vec<String> {
        self.alive.keys().take(8).cloned().collect()
    }
}

/// The error that ended a run or its recording.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// An input of the scene or of the live events is refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The recording cannot be written.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// The engine could not complete a step. [`record`](super::record) returns it in
    /// [`Recorded`](super::Recorded) instead and stores it in the recording.
    #[error("{}", error_text(.0))]
    Step(#[from] StepError),
    /// Live events cannot be read.
    #[error("cannot read the events after line {line}: {source}")]
    Events {
        /// The number of lines read before.
        line: u64,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A line of live events is not text.
    #[error("line {line} of the events is not UTF-8; write it as UTF-8, or skip such lines with --lenient")]
    NotText {
        /// The number of the line, from 1.
        line: u64,
    },
    /// A line of live events is too long.
    #[error(
        "line {line} of the events is longer than {limit} bytes; write one JSON object per line, or skip such lines with --lenient"
    )]
    TooLong {
        /// The number of the line, from 1.
        line: u64,
        /// The limit, bytes.
        limit: usize,
    },
    /// A line of live events is so long that it is not even skipped.
    #[error("line {line} of the events has no line break within {limit} bytes; write one JSON object per line")]
    Endless {
        /// The number of the line, from 1.
        line: u64,
        /// The limit, bytes.
        limit: usize,
    },
    /// A live event names a step that is already recorded.
    #[error(
        "line {line} of the events names step {named}, but the run is already at step {current}; order the lines by step, or skip such lines with --lenient"
    )]
    Late {
        /// The number of the line, from 1.
        line: u64,
        /// The step that it names.
        named: u64,
        /// The step of the run.
        current: u64,
    },
    /// A live event names a step after the end of the run.
    #[error(
        "line {line} of the events names step {named}, but the run ends at step {last}; increase the number of steps with --steps, or skip such lines with --lenient"
    )]
    AfterLastStep {
        /// The number of the line, from 1.
        line: u64,
        /// The step that it names.
        named: u64,
        /// The last step.
        last: u64,
    },
}
