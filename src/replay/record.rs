use super::{IdleClicks, LiveEvents, Run, RunError, engine_config};
use crate::physics::{AccuracyProbe, CollisionCount, SolverKind, StepError};
use crate::recording::{ColorFn, Header, RecordedError, RunEnd, SceneText, Trailer, Writer};
use crate::scene::{Scene, SceneError};
use std::io::{BufRead, Write};

/// Options of a recording.
#[non_exhaustive]
#[derive(Clone, Copy, Debug)]
pub struct RecordOptions {
    /// The last step, which may differ from that of the scene's [`RunOptions`](crate::scene::RunOptions).
    pub steps: u64,
    /// Every `every`-th state is recorded in full, the others as digests; at least 1.
    pub every: u64,
    /// True to estimate the accuracy of the run, which takes about four times as long.
    pub estimates_accuracy: bool,
    /// True if live events may come; the recording says so.
    pub has_live_events: bool,
    /// The colours of bodies in viewers such as Foxglove; `None` records nothing for viewers.
    pub viewer: Option<ColorFn>,
}

impl RecordOptions {
    /// The complete run of the scene, every state in full, nothing for viewers.
    pub const fn complete(scene: &Scene) -> RecordOptions {
        let steps = scene.run.steps;
        RecordOptions { steps, every: 1, estimates_accuracy: false, has_live_events: false, viewer: None }
    }

    /// Sets the last step.
    pub const fn steps(self, steps: u64) -> RecordOptions {
        RecordOptions { steps, ..self }
    }

    /// Estimates the accuracy of the run, which takes about four times as long. The handout solver has none to
    /// estimate.
    pub const fn estimate_accuracy(self) -> RecordOptions {
        RecordOptions { estimates_accuracy: true, ..self }
    }

    /// Announces live events. [`record`] does so itself.
    pub const fn live_events(self) -> RecordOptions {
        RecordOptions { has_live_events: true, ..self }
    }

    /// Records every `every`-th state in full, the others as digests; at least 1.
    pub const fn every(self, every: u64) -> RecordOptions {
        RecordOptions { every, ..self }
    }
}

/// The result of recording a scene.
#[non_exhaustive]
#[derive(Debug)]
pub struct Recorded {
    /// The end record of the recording.
    pub trailer: Trailer,
    /// The error of the step that the engine could not complete, if any.
    pub error: Option<StepError>,
    /// The clicks that changed nothing.
    pub idle_clicks: IdleClicks,
}

/// Runs `scene` and writes its recording to `output`. Memory does not grow with the number of steps.
/// `progress` is called with the step of each recorded state.
///
/// A step that the engine cannot complete ends the run. The recording is then finished and contains the
/// error and all states before it.
///
/// # Errors
/// Returns an error if an input is refused or the output cannot be written. Chunks flushed before stay readable.
pub fn record<W: Write + Send + 'static>(
    scene: &Scene,
    options: RecordOptions,
    mut live: Option<&mut LiveEvents<impl BufRead>>,
    output: W,
    mut progress: impl FnMut(u64),
) -> Result<Recorded, RunError> {
    let options = if live.is_some() { options.live_events() } else { options };
    let mut recording = RecordingRun::new(scene, options, output)?;
    while let Some(step) = recording.record_state(live.as_deref_mut())? {
        progress(step);
    }
    recording.finish()
}

/// A run that is recorded state by state, by [`record`] or in slices.
pub struct RecordingRun<W: Write> {
    run: Run,
    writer: Writer<W>,
    observers: (CollisionCount, Option<AccuracyProbe>),
    last_step: u64,
    phase: RecordingPhase,
}

/// The next task of a [`RecordingRun`].
enum RecordingPhase {
    /// Applies the inputs of the current step and records its state.
    Record,
    /// Steps first.
    Step,
    /// Nothing: all states are recorded, or the engine could not complete a step.
    End(Option<StepError>),
}

impl<W: Write + Send + 'static> RecordingRun<W> {
    /// Starts a recording of `scene` in `output`.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub fn new(scene: &Scene, options: RecordOptions, output: W) -> Result<RecordingRun<W>, RunError> {
        let run = Run::new(scene);
        let header = header(scene, options);
        let writer = match options.viewer {
            None => Writer::new(output, &header)?,
            Some(color) => Writer::with_scene_updates(output, &header, color)?,
        };
        let probe = if options.estimates_accuracy { AccuracyProbe::new(run.engine()) } else { None };
        let observers = (CollisionCount::default(), probe);
        Ok(RecordingRun { run, writer, observers, last_step: options.steps, phase: RecordingPhase::Record })
    }

    /// Records the next state with the events of `live`, and returns its step; `None` after the last one or if the
    /// engine cannot complete the step.
    ///
    /// # Errors
    /// Returns an error if an input is refused or the output cannot be written.
    pub fn record_state(&mut self, mut live: Option<&mut LiveEvents<impl BufRead>>) -> Result<Option<u64>, RunError> {
        match self.phase {
            RecordingPhase::Record => {}
            RecordingPhase::Step => {
                let error = self.run.step(&mut self.observers).err();
                self.observers.1.iter_mut().for_each(|probe| probe.follow(self.run.engine()));
                if error.is_some() {
                    self.phase = RecordingPhase::End(error);
                    return Ok(None);
                }
            }
            RecordingPhase::End(_) => return Ok(None),
        }
        let step = self.run.engine().current_step();
        let due = live.as_mut().map(|live| live.due(step)).transpose()?;
        let on_refused = |error: SceneError| match &mut live {
            Some(live) => live.refuse(error.into()),
            None => Err(error.into()),
        };
        for event in self.run.apply_inputs(due.unwrap_or_default(), on_refused)? {
            self.writer.write_event(&event)?;
            self.observers.1.iter_mut().for_each(|probe| probe.apply(&event.change.event()));
        }
        self.writer.write_state(self.run.engine())?;
        self.phase = if step < self.last_step { RecordingPhase::Step } else { RecordingPhase::End(None) };
        Ok(Some(step))
    }

    /// Finishes the recording.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub fn finish(self) -> Result<Recorded, RunError> {
        let (collisions, probe) = self.observers;
        let error = match self.phase {
            RecordingPhase::End(error) => error,
            RecordingPhase::Record | RecordingPhase::Step => None,
        };
        let run_end = RunEnd {
            collisions: Some(collisions.0),
            error: error.clone().map(RecordedError::Step),
            accuracy: probe.map(|probe| probe.accuracy()),
        };
        let idle_clicks = self.run.idle_clicks();
        Ok(Recorded { trailer: self.writer.finish(run_end)?.trailer, error, idle_clicks })
    }
}

/// The header of the recording of `scene`.
pub fn header(scene: &Scene, options: RecordOptions) -> Header {
    let text = SceneText { file_name: scene.source.file_name().to_owned(), text: scene.source.text.clone() };
    Header {
        every: options.every,
        images: scene.images.clone(),
        overrides: scene.source.overrides.clone(),
        has_live_events: options.has_live_events,
        estimates_accuracy: options.estimates_accuracy && scene.run.solver == SolverKind::EventDriven,
        ..Header::new(engine_config(scene), options.steps, text)
    }
}
