//! Checking a recording: it must replay the same, and match a run of its scene.

use super::case::{Override, RecordCommand, RecordingRecipe, ReferenceRecording};
use super::scene_mismatch::{SceneMismatch, option_changes};
use super::{Basis, CheckResult, Outcome, Replacement};
use crate::physics::CollisionCount;
use crate::picture;
use crate::recording::{self, ColorFn, Error, Header, Identity, Item, RecordedEvent};
use crate::replay::{
    self, ALL_STEPS, LiveEvents, NO_LIVE_EVENTS, OnBadEvent, RecordOptions, Replayer, Run, RunError, Verdict,
};
use crate::scene::{self, Scene};
use crate::temporary::TemporaryRecording;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

/// Checks a recording.
pub fn check_recording(reference: &ReferenceRecording) -> CheckResult {
    let path = &reference.file;
    let (outcome, replacement) = match path.metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => missing(reference),
        Err(error) => (Outcome::Failed(format!("it cannot be read: {error}")), None),
        Ok(metadata) if !metadata.is_file() => (Outcome::Failed("it is no regular file".into()), None),
        Ok(_) => compare_with_recipe(reference, replay_recording(path)),
    };
    let line = reference.line().cloned();
    CheckResult { replacement, line, ..CheckResult::new(path.clone(), outcome) }
}

fn replay_recording(path: &Path) -> Outcome {
    let replay = Replayer::open(path, ALL_STEPS);
    match replay.and_then(|replay| replay.run(&mut CollisionCount::default(), |_| ())) {
        Ok(Verdict::Diverged(divergence)) => Outcome::Diverged(divergence),
        Ok(verdict) => Outcome::Replayed { verdict, basis: Basis::NoScene },
        Err(Error::OtherSemantics { found }) => Outcome::OtherSemantics { found },
        Err(error) if error.is_damage() => Outcome::Damaged(error.to_string()),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}

/// The outcome of a recording that does not exist. It is made only when that is accepted, because its run may be long.
fn missing(reference: &ReferenceRecording) -> (Outcome, Option<Replacement>) {
    let Some(scene) = reference.scene() else {
        return (Outcome::Missing("the recording does not exist".into()), None);
    };
    match scene_of(&reference.recipe) {
        Ok(_) => {
            let missing = Outcome::Missing(format!("the recording of {} does not exist", scene.display()));
            (missing, Some(Replacement::Run(Box::new(reference.clone()))))
        }
        Err(error) => (Outcome::Failed(format!("its scene {} cannot be run: {error}", scene.display())), None),
    }
}

/// The scene of a recipe, with the values that a command overrides.
fn scene_of(recipe: &RecordingRecipe) -> Result<Option<Scene>, RunError> {
    Ok(match recipe {
        RecordingRecipe::OwnEvents => None,
        RecordingRecipe::Scene(scene) => Some(load(scene, &[])?),
        RecordingRecipe::Listed { command, .. } => Some(command.scene()?),
    })
}

/// Makes a recording that does not exist. `None` if it has no scene.
///
/// # Errors
/// If the scene cannot be run.
pub fn make_recording(reference: &ReferenceRecording) -> Result<Option<TemporaryRecording>, RunError> {
    let new = match (&reference.recipe, scene_of(&reference.recipe)?) {
        (RecordingRecipe::Listed { command, .. }, _) => NewRecording::of_command(command)?,
        (_, Some(scene)) => NewRecording::of_scene(&scene, RecordOptions::complete(&scene))?,
        (_, None) => return Ok(None),
    };
    Ok(Some(new.file))
}

/// Compares a recording that was replayed with a new run. A recording with values or events of its own is not compared
/// with a run of the scene next to it, and never replaced by one without them.
fn compare_with_recipe(reference: &ReferenceRecording, replayed: Outcome) -> (Outcome, Option<Replacement>) {
    let Some(scene_path) = reference.scene() else { return (replayed, None) };
    let recorded = RecordedRun::read(&reference.file);
    let noted = recorded.as_ref().ok().and_then(RecordedRun::noted_inputs);
    let new = match (&reference.recipe, &noted) {
        (RecordingRecipe::OwnEvents, _) => return (replayed, None),
        (RecordingRecipe::Scene(_), Some(own)) => return (replayed.with_basis(Basis::OwnEvents(own.clone())), None),
        (RecordingRecipe::Listed { command, .. }, _) => NewRecording::of_command(command),
        (RecordingRecipe::Scene(scene), None) => load(scene, &[]).and_then(|scene| {
            let options = recorded.as_ref().map(|recorded| recorded.options(&scene));
            NewRecording::of_scene(&scene, options.unwrap_or(RecordOptions::complete(&scene)))
        }),
    };
    let new = match new {
        Ok(new) => new,
        Err(error) => {
            return (Outcome::Failed(format!("its scene {} cannot be run: {error}", scene_path.display())), None);
        }
    };
    let has_foreign_events = || recorded.as_ref().is_ok_and(|recorded| recorded.has_foreign_events(&replayed));
    let is_protected = || match &noted {
        Some(_) => !new.has_own_inputs,
        None => !new.has_own_inputs && has_foreign_events(),
    };
    if !matches!(replayed, Outcome::Replayed { verdict: Verdict::Same { .. }, .. }) {
        let replacement = (!is_protected()).then_some(Replacement::Recording(new.file));
        return (replayed, replacement);
    }
    match recorded
        .as_ref()
        .map_err(ToString::to_string)
        .and_then(|recorded| recorded.difference(&new, reference).map_err(|error| error.to_string()))
    {
        Ok(None) => (replayed.with_basis(Basis::Scene), None),
        Ok(Some(mismatch)) if is_protected() => match reference.line() {
            Some(_) => (Outcome::Drifted(mismatch), None),
            None => (replayed.with_basis(Basis::OwnEvents("events that its scene does not have".into())), None),
        },
        Ok(Some(mismatch)) => (Outcome::Drifted(mismatch), Some(Replacement::Recording(new.file))),
        Err(error) => (Outcome::Failed(error), None),
    }
}

impl RecordCommand {
    /// Reads the scene with the values that the command overrides.
    fn scene(&self) -> Result<Scene, RunError> {
        load(&self.scene, &self.overrides)
    }
}

/// Reads a scene with some values overridden.
pub fn load(path: &Path, overrides: &[Override]) -> Result<Scene, RunError> {
    #[cfg(feature = "cli")]
    let scene = scene::load_with(path, overrides);
    #[cfg(not(feature = "cli"))]
    let scene = match overrides {
        [] => scene::load(path),
        [value, ..] => match *value {},
    };
    Ok(scene?)
}

/// A recording of a new run.
struct NewRecording {
    file: TemporaryRecording,
    identity: Identity,
    options: RecordOptions,
    /// True if the run has live events or values given with `--set`.
    has_own_inputs: bool,
}

impl NewRecording {
    fn of_scene(scene: &Scene, options: RecordOptions) -> Result<NewRecording, RunError> {
        NewRecording::record(scene, options, None)
    }

    fn of_command(command: &RecordCommand) -> Result<NewRecording, RunError> {
        let scene = command.scene()?;
        let mut options = RecordOptions::complete(&scene);
        options.steps = command.steps.unwrap_or(options.steps);
        options.every = command.every;
        options.estimates_accuracy = command.accuracy;
        options.viewer = command.viewer.then_some(picture::body_color as ColorFn);
        NewRecording::record(&scene, options, command.events.as_deref().map(|events| (events, command.lenient)))
    }

    /// Records, with the live events of a file and a note if its invalid lines are skipped.
    fn record(scene: &Scene, options: RecordOptions, live: Option<(&Path, bool)>) -> Result<NewRecording, RunError> {
        let unwritable = |error| RunError::from(Error::Write(error));
        let file = TemporaryRecording::create().map_err(unwritable)?;
        let output = File::create_new(file.path()).map_err(unwritable)?;
        let recorded = match live {
            None => replay::record(scene, options, NO_LIVE_EVENTS, output, |_| ())?,
            Some((path, is_lenient)) => {
                let events = File::open(path).map_err(|source| RunError::Events { line: 0, source })?;
                let on_bad_event = if is_lenient { OnBadEvent::Skip } else { OnBadEvent::Fail };
                let mut live = LiveEvents::new(BufReader::new(events), on_bad_event, options.steps);
                let options = RecordOptions { has_live_events: true, ..options };
                replay::record(scene, options, Some(&mut live), output, |_| ())?
            }
        };
        let has_own_inputs = live.is_some() || !scene.source.overrides.is_empty();
        Ok(NewRecording { file, identity: recorded.trailer.identity, options, has_own_inputs })
    }
}

/// The contents of a recording that its replay does not show.
struct RecordedRun {
    path: PathBuf,
    header: Header,
    identity: Option<Identity>,
    has_viewer_topic: bool,
    events: Vec<RecordedEvent>,
}

impl RecordedRun {
    fn read(path: &Path) -> Result<RecordedRun, Error> {
        let mut recording = recording::open(path)?;
        let (mut has_viewer_topic, mut events) = (false, Vec::new());
        for item in recording.by_ref() {
            match item? {
                Item::SceneUpdate { .. } => has_viewer_topic = true,
                Item::Event(event) => events.push(event),
                Item::State(_) | Item::SuspectState(_) | Item::Keyframe(_) => {}
                Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_) => {}
            }
        }
        let identity = recording.trailer().map(|end| end.identity);
        Ok(RecordedRun { path: path.into(), header: recording.header.clone(), identity, has_viewer_topic, events })
    }

    /// The options to record `scene` with as this recording was: the same thinning, topics and estimate, and the number
    /// of steps given with `--steps`, if that was not the one of the scene.
    fn options(&self, scene: &Scene) -> RecordOptions {
        let mut options = RecordOptions::complete(scene);
        options.every = self.header.every;
        options.estimates_accuracy = self.header.estimates_accuracy;
        options.viewer = self.has_viewer_topic.then_some(picture::body_color as ColorFn);
        if self.own_scene().is_some_and(|own| own.run.steps != self.header.steps) {
            options.steps = self.header.steps;
        }
        options
    }

    /// The scene as it was recorded.
    fn own_scene(&self) -> Option<Scene> {
        let text = self.header.scene.as_ref()?;
        scene::parse(&text.file_name, &text.text).ok()
    }

    /// The values and events that the recording says it has beside those of the scene, in words.
    fn noted_inputs(&self) -> Option<String> {
        let values = self.header.overrides.iter().map(|[key, value]| format!("--set {key}={value}"));
        let live = self.header.has_live_events.then(|| "live events".to_owned());
        let parts: Vec<String> = values.chain(live).collect();
        (!parts.is_empty()).then(|| parts.join(" "))
    }

    /// Returns true if the recorded events are not all those of the scene in the recording. Older versions did not note
    /// that there were live events.
    ///
    /// If the engine has changed, clicks may have other effects than they had.
    fn has_foreign_events(&self, replayed: &Outcome) -> bool {
        let Some(scene) = self.own_scene() else { return !self.events.is_empty() };
        let is_comparable = match replayed {
            Outcome::Replayed { verdict, .. } => !matches!(verdict, Verdict::Diverged(_)),
            _ => !scene.inputs.iter().any(|input| matches!(input.action, scene::Action::Click { .. })),
        };
        let last = self.events.last().map_or(0, |event| event.step);
        is_comparable && !self.events.is_empty() && !are_events_of(&self.events, &scene, last)
    }

    /// The difference to a new run. `None` if both are the same.
    fn difference(&self, new: &NewRecording, reference: &ReferenceRecording) -> Result<Option<SceneMismatch>, Error> {
        let current = recording::open(&new.file.path())?;
        let mut changes = Vec::new();
        if reference.line().is_some() {
            let viewer = [self.has_viewer_topic, new.options.viewer.is_some()];
            changes = option_changes(&self.header, &current.header, viewer);
        }
        if changes.is_empty() && self.identity == Some(new.identity) {
            return Ok(None);
        }
        let mismatch = SceneMismatch::between(recording::open(&self.path)?, current)?;
        let mismatch = SceneMismatch { changes: [changes, mismatch.changes].concat(), ..mismatch };
        Ok(Some(mismatch).filter(|mismatch| !mismatch.is_empty()))
    }
}

/// Returns true if each of the events up to step `last` is one that the scene has in that step.
fn are_events_of(events: &[RecordedEvent], scene: &Scene, last: u64) -> bool {
    let mut recorded: BTreeMap<u64, Vec<&RecordedEvent>> = BTreeMap::new();
    for event in events {
        recorded.entry(event.step).or_default().push(event);
    }
    let mut run = Run::new(scene);
    loop {
        let step = run.engine().current_step();
        let Ok(applied) = run.apply_inputs(Vec::new(), |error| Err(error.into())) else { return false };
        // Both are in the order of the scene.
        let mut applied = applied.iter();
        if !recorded.remove(&step).unwrap_or_default().into_iter().all(|event| applied.any(|other| other == event)) {
            return false;
        }
        // A run that fails has recorded no later event.
        if step >= last || run.step(&mut CollisionCount::default()).is_err() {
            return true;
        }
    }
}
