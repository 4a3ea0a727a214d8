//! A scene being run: its inputs become events, the engine steps, a recording is written.
//!
//! [`record`] does it all for a scene. [`Run`] is the same by hand, a step at a time, for
//! who wants to look at the world in between.

mod error;
mod live_events;
mod names;
mod record;

use crate::physics::{Engine, Observer, Settings, StepError, Vector, World};
use crate::recording::{Change, RecordedEvent};
use crate::scene::{Action, Blueprint, Fault, Input, Place, Scene, SceneError, SceneSource, SpawnRequest};
use names::Names;
use std::collections::VecDeque;

pub use error::RunError;
pub use live_events::{LiveEvents, Manners, NO_LIVE_EVENTS};
pub use record::{RecordOptions, Recorded, record};

/// A scene being run: the engine, and the inputs that are still to come.
pub struct Run {
    engine: Engine,
    scheduled: VecDeque<Input>,
    source: SceneSource,
    names: Names,
}

impl Run {
    /// The run of `scene`, before anything has happened.
    pub fn new(scene: &Scene) -> Run {
        Run {
            engine: Engine::new(settings(scene)),
            scheduled: scene.inputs.iter().cloned().collect(),
            source: scene.source.clone(),
            names: Names::default(),
        }
    }

    /// The engine, to look at.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// Lets the inputs of the present step happen, the scene's and `live` ones: deletes, then
    /// spawns, then clicks. What they came to is returned; a click may come to nothing.
    ///
    /// That a name is not alive or is taken shows only now in a scene with clicks and in live
    /// events. Of a live one `refused` decides whether the run goes on without it.
    ///
    /// # Errors
    /// When an input of the scene is refused, or `refused` says so.
    pub fn happen(
        &mut self,
        live: Vec<Input>,
        mut refused: impl FnMut(SceneError) -> Result<(), RunError>,
    ) -> Result<Vec<RecordedEvent>, RunError> {
        let step = self.engine.present_step();
        let mut inputs = Vec::new();
        while self.scheduled.front().is_some_and(|input| input.step <= step) {
            inputs.extend(self.scheduled.pop_front());
        }
        inputs.extend(live);
        inputs.sort_by_key(|input| phase(&input.action));
        let mut events = Vec::new();
        for Input { action, place, .. } in inputs {
            match self.resolve(action) {
                Ok(change) => events.extend(change.map(|change| self.apply(change))),
                Err(fault) => {
                    let error = SceneError::at(&self.source, &place, fault);
                    match place {
                        Place::Scene(_) => return Err(error.into()),
                        Place::Line(_) => refused(error)?,
                    }
                }
            }
        }
        Ok(events)
    }

    /// Moves the world on by one step.
    ///
    /// # Errors
    /// When the engine cannot complete the step; the run is then over.
    pub fn step<O: Observer>(&mut self, observer: &mut O) -> Result<(), StepError> {
        self.engine.step(observer)
    }

    /// Runs up to the state `step` as it is recorded: what the scene has happen then has happened.
    ///
    /// ```
    /// # let draft = rebond::scene::draft::Draft::default();
    /// # let scene = draft.scene("scene.toml")?;
    /// let mut run = rebond::run::Run::new(&scene);
    /// let mut collisions = Vec::new();
    /// run.go_to(60, &mut collisions)?;
    /// assert_eq!(run.engine().present_step(), 60);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When an input of the scene is refused, or the engine cannot complete a step.
    pub fn go_to<O: Observer>(&mut self, step: u64, observer: &mut O) -> Result<(), RunError> {
        self.happen(Vec::new(), |error| Err(error.into()))?;
        while self.engine.present_step() < step {
            self.step(observer)?;
            self.happen(Vec::new(), |error| Err(error.into()))?;
        }
        Ok(())
    }

    /// What an input comes to in the world as it is now.
    fn resolve(&mut self, action: Action) -> Result<Option<Change>, Fault> {
        match action {
            Action::Wall(request) => self.spawn_wall(request).map(Some),
            Action::Spawn(request) => self.spawn(request).map(Some),
            Action::Delete { name } => self.delete(&name).map(Some),
            Action::Click { at, spawn } => self.click(at, spawn),
        }
    }

    fn spawn_wall(&mut self, request: SpawnRequest) -> Result<Change, Fault> {
        let name = request.name.clone().unwrap_or_default();
        self.spawn_named(name, request)
    }

    fn spawn(&mut self, request: SpawnRequest) -> Result<Change, Fault> {
        let number = self.names.count_spawn();
        let name = request.name.clone().unwrap_or_else(|| format!("#{number}"));
        self.spawn_named(name, request)
    }

    fn spawn_named(&mut self, name: String, request: SpawnRequest) -> Result<Change, Fault> {
        let id = self.engine.next_id();
        let step = self.engine.present_step();
        if !self.names.take(&name, id) {
            return Err(Fault::NameTaken { name, step });
        }
        Ok(Change::Spawn { id, color: request.color.clone(), spawn: request.spawn(name) })
    }

    fn delete(&mut self, name: &str) -> Result<Change, Fault> {
        let step = self.engine.present_step();
        match self.names.free(name) {
            Some(id) => Ok(Change::Delete { id }),
            None => Err(Fault::NotAlive { name: name.into(), step, alive: self.names.first_alive() }),
        }
    }

    /// The handout's mouse. What it hits it deletes, and then it spawns nothing: in the handout
    /// the click that removed a box went on to the canvas below, which made a new one.
    fn click(&mut self, at: Vector, spawn: Option<Blueprint>) -> Result<Option<Change>, Fault> {
        if let Some(name) = topmost(self.engine.world(), at) {
            return self.delete(&name).map(Some);
        }
        spawn.map(|blueprint| self.spawn(blueprint.centered_on(at))).transpose()
    }

    fn apply(&mut self, change: Change) -> RecordedEvent {
        self.engine.apply(&change.event());
        RecordedEvent { step: self.engine.present_step(), change }
    }
}

/// What the engine is told of a scene.
pub fn settings(scene: &Scene) -> Settings {
    Settings {
        solver: scene.run.solver,
        rate: scene.run.rate,
        gravity: scene.gravity,
        restitution: scene.restitution.clone(),
        events_per_step: scene.run.events_per_step,
    }
}

/// Deletes come first, so that their names are free for the spawns; clicks see both.
fn phase(action: &Action) -> u8 {
    match action {
        Action::Delete { .. } => 0,
        Action::Wall(_) | Action::Spawn(_) => 1,
        Action::Click { .. } => 2,
    }
}

/// The name of the body of finite mass created last that covers the point.
fn topmost(world: &World, point: Vector) -> Option<String> {
    let hit = world.bodies.iter().rev().find(|body| !body.is_infinite() && body.rect.has_point(point));
    hit.map(|body| body.name.clone())
}
