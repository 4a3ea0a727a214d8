use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    ops::RangeInclusive,
    path::Path,
};

use crate::{
    physics::{AccuracyProbe, Collision, CollisionCount, Engine, Observer, SnapshotError, SolverSnapshot, StepError},
    recording::{
        BodyTable, Change, Error, Health, IDENTITY_MISMATCH, Item, Keyframe, RecordedError, RecordedEvent,
        RecordedState, Recording, SEMANTICS_VERSION, StateDigest, Trailer, body_state, error_text, open,
    },
};

use super::{Difference, Divergence, Verdict, altered_setting::altered_setting};
use crate::text::counted;

/// All steps of a recording.
pub const ALL_STEPS: RangeInclusive<u64> = 0..=u64::MAX;

/// Runs a recording again and compares its states bit for bit.
///
/// ```no_run
/// use rebond::{ALL_STEPS, CollisionCount, Replayer};
///
/// let replayer = Replayer::open("lecture.mcap".as_ref(), ALL_STEPS)?;
/// let verdict = replayer.run(&mut CollisionCount::default(), |_| ())?;
/// println!("{verdict}");
/// # Ok::<(), rebond::recordings::Error>(())
/// ```
#[doc(alias("verify", "determinism", "checksum", "digest"))]
pub struct Replayer<R> {
    recording: Recording<R>,
    /// The steps to compare.
    steps: RangeInclusive<u64>,
    engine: Engine,
    phase: Phase,
    /// The number of steps between consecutive states that are both the same as recorded.
    same_steps: u64,
    /// The step of the last state that is the same as recorded, if the engine followed it without a break.
    last: Option<u64>,
    /// The number of states that were compared.
    compared: u64,
    /// True if a state after the steps to compare was found, because that at their end is missing.
    is_past_end: bool,
    /// A keyframe, to be compared at the state of its step.
    expected_keyframe: Option<Keyframe>,
    /// The number of collisions since the start; `None` if the engine did not follow the whole run.
    collisions: Option<CollisionCount>,
    /// Estimates the accuracy again, if it is recorded and the whole run is compared.
    probe: Option<AccuracyProbe>,
    last_event: Option<String>,
    reproduced_error: Option<String>,
    digest: StateDigest,
}

/// The relation of the engine to the current position in the recording.
enum Phase {
    /// At the start: step 0 or a keyframe follows.
    Start,
    /// The engine is at the position of the recording.
    InSync,
    /// Events may be missing until the next keyframe.
    OutOfSync,
    /// The replay ended at a difference.
    Diverged(Box<Divergence>),
}

impl Replayer<BufReader<File>> {
    /// Opens the recording at `path` for a replay that compares the states of `steps`.
    ///
    /// # Errors
    /// Returns the errors of [`recording::open`](crate::recording::open) and [`Replayer::new`].
    pub fn open(path: &Path, steps: RangeInclusive<u64>) -> Result<Replayer<BufReader<File>>, Error> {
        Replayer::new(open(path)?, steps)
    }
}

impl<R: Read + Seek> Replayer<R> {
    /// Creates a replay of `recording` that compares the states of `steps`, both ends included.
    ///
    /// The replay starts at the last keyframe before the first of `steps`, so that a keyframe of that step is compared,
    /// too, and continues at the next keyframe after damage.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or if the recording was made with other engine semantics.
    pub fn new(mut recording: Recording<R>, steps: RangeInclusive<u64>) -> Result<Replayer<R>, Error> {
        let found = recording.header.versions.semantics;
        if found != SEMANTICS_VERSION {
            return Err(Error::OtherSemantics { found });
        }
        let before = steps.start().checked_sub(1);
        match before {
            Some(before) => recording.seek(before)?,
            None if steps != ALL_STEPS => recording.read_index()?,
            None => {}
        }
        Ok(Replayer {
            engine: Engine::new(recording.header.config.clone()),
            recording,
            steps,
            phase: Phase::Start,
            same_steps: 0,
            last: None,
            compared: 0,
            is_past_end: false,
            expected_keyframe: None,
            collisions: before.is_none().then(CollisionCount::default),
            probe: None,
            last_event: None,
            reproduced_error: None,
            digest: StateDigest::default(),
        })
    }

    /// Replays to the end and returns the verdict. `progress` is called with the step of each recorded state.
    ///
    /// If all steps are compared and the recording has an estimate of the accuracy, that is computed again, too, which
    /// takes about four times as long.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or if it has no state in the steps to compare. A recording that is
    /// compared from start to end may be so damaged that there is none, which the verdict says.
    pub fn run<O: Observer>(mut self, observer: &mut O, mut progress: impl FnMut(u64)) -> Result<Verdict, Error> {
        let is_at_start = self.compared == 0 && self.engine.current_step() == 0;
        if is_at_start && self.steps == ALL_STEPS && self.recording.header.estimates_accuracy {
            self.probe = AccuracyProbe::new(&self.engine);
        }
        while let Some(step) = self.next_state(observer)? {
            progress(step);
        }
        let verdict = self.verdict();
        let (from, to) = (*self.steps.start(), *self.steps.end());
        match verdict.health().filter(|_| self.compared == 0) {
            Some(Health::Whole) => {
                let last = self.recording.trailer().map_or(self.recording.header.steps, |end| end.steps);
                Err(Error::NoStates { from, to, last })
            }
            Some(health) if self.steps != ALL_STEPS => Err(Error::MissingStates { from, to, health: Box::new(health) }),
            Some(_) | None => Ok(verdict),
        }
    }

    /// Replays up to the next recorded state, compares it and returns its step; `None` at the end of the steps to
    /// compare or of the recording, and at a difference. `observer` receives the collisions on the way.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn next_state<O: Observer>(&mut self, observer: &mut O) -> Result<Option<u64>, Error> {
        while !self.is_finished() {
            let Some(item) = self.recording.next().transpose()? else { break };
            let step = match &item {
                Item::State(state) | Item::SuspectState(state) => Some(state.step),
                Item::Event(_) | Item::Keyframe(_) | Item::Trailer(_) => None,
                Item::SceneUpdate { .. } | Item::Damaged(_) | Item::Gap(_) => None,
            };
            if step.is_some_and(|step| step > *self.steps.end()) {
                self.is_past_end = true;
                break;
            }
            match self.replay_item(item, observer) {
                Ok(()) if step.is_some() => return Ok(step),
                Ok(()) => {}
                Err(divergence) => self.phase = Phase::Diverged(divergence),
            }
        }
        Ok(None)
    }

    /// Returns the engine if it is at a state that was compared and is the same as recorded.
    pub fn engine(&self) -> Option<&Engine> {
        let is_at_last = self.last == Some(self.engine.current_step());
        (is_at_last && matches!(self.phase, Phase::InSync)).then_some(&self.engine)
    }

    /// Returns the last event of the recording so far, such as `spawn "b" at step 30`.
    pub fn last_event(&self) -> Option<&str> {
        self.last_event.as_deref()
    }

    /// Returns the verdict on the part replayed so far; final once [`Replayer::next_state`] has returned `None`.
    pub fn verdict(&self) -> Verdict {
        if let Phase::Diverged(divergence) = &self.phase {
            return Verdict::Diverged(divergence.clone());
        }
        let steps = self.same_steps;
        match self.recording.health() {
            Health::Corrupt { mut damage, missing } => {
                if damage.reason == IDENTITY_MISMATCH
                    && let Some(setting) = altered_setting(&self.recording.header)
                {
                    damage.reason = format!("{IDENTITY_MISMATCH}: {setting}");
                }
                Verdict::Corrupt { damage, missing, steps }
            }
            Health::Incomplete(missing) => Verdict::Incomplete { missing, steps },
            Health::Whole => {
                Verdict::Same { steps, bodies: self.engine.next_id().into(), error: self.reproduced_error.clone() }
            }
        }
    }

    fn is_finished(&self) -> bool {
        self.has_compared_all() || self.is_past_end || matches!(self.phase, Phase::Diverged(_))
    }

    fn has_compared_all(&self) -> bool {
        self.last == Some(*self.steps.end())
    }

    fn replay_item(&mut self, item: Item, observer: &mut dyn Observer) -> Result<(), Box<Divergence>> {
        match (item, &self.phase) {
            (Item::Keyframe(keyframe), Phase::InSync) => self.expected_keyframe = Some(keyframe),
            (Item::Keyframe(keyframe), Phase::Start) if self.is_at_start() => self.expected_keyframe = Some(keyframe),
            (Item::Keyframe(keyframe), _) => return self.restore(&keyframe),
            (Item::SceneUpdate { .. }, _) => {}
            (Item::Damaged(_), _) if self.recording.table().is_some() => {}
            (Item::Damaged(_) | Item::Gap(_), _) => self.phase = Phase::OutOfSync,
            (Item::Event(_) | Item::State(_) | Item::SuspectState(_) | Item::Trailer(_), Phase::OutOfSync) => {}
            (Item::Event(event), _) => return self.apply_event(event, observer),
            (Item::State(state) | Item::SuspectState(state), _) => return self.compare_state(&state, observer),
            (Item::Trailer(trailer), _) => {
                self.compare_error(&trailer, observer)?;
                return self.compare_end(&trailer);
            }
        }
        Ok(())
    }

    /// Returns true if the engine is at the start of a run that is replayed from there.
    fn is_at_start(&self) -> bool {
        self.collisions.is_some() && self.engine.current_step() == 0
    }

    fn restore(&mut self, keyframe: &Keyframe) -> Result<(), Box<Divergence>> {
        let config = &self.recording.header.config;
        match Engine::restore(config.clone(), keyframe.snapshot(config)) {
            Ok(engine) => {
                self.engine = engine;
                self.phase = Phase::InSync;
                self.last = None;
                self.expected_keyframe = None;
                self.collisions = None;
                self.probe = None;
                Ok(())
            }
            Err(SnapshotError { step, reason }) => {
                Err(self.mismatch(format!("the keyframe of step {step} does not fit the solver: {reason}")))
            }
        }
    }

    fn apply_event(&mut self, event: RecordedEvent, observer: &mut dyn Observer) -> Result<(), Box<Divergence>> {
        self.phase = Phase::InSync;
        self.run_to(event.step, observer)?;
        let (verb, name) = match &event.change {
            Change::Spawn(info) => ("spawn", (info.id == self.engine.next_id()).then(|| info.spawn.name.clone())),
            Change::Delete { id } => ("delete", self.engine.world().body(*id).map(|body| body.name.clone())),
        };
        let Some(name) = name else {
            return Err(self.mismatch(format!("the recorded {verb} cannot be applied in the replay")));
        };
        let change = event.change.event();
        self.probe.iter_mut().for_each(|probe| probe.apply(&change));
        self.engine.apply(&change);
        self.last_event = Some(format!("{verb} {name:?} at step {}", event.step));
        Ok(())
    }

    fn compare_state(&mut self, state: &RecordedState, observer: &mut dyn Observer) -> Result<(), Box<Divergence>> {
        self.phase = Phase::InSync;
        self.run_to(state.step, observer)?;
        let keyframe = self.expected_keyframe.take();
        if !self.steps.contains(&state.step) {
            return Ok(());
        }
        if let Some(difference) = self.difference(state) {
            return Err(self.divergence(difference));
        }
        self.compared += 1;
        let is_consecutive = self.last.is_some_and(|last| last + 1 == state.step);
        self.same_steps += u64::from(is_consecutive);
        self.last = Some(state.step);
        match keyframe.and_then(|keyframe| self.keyframe_difference(&keyframe)) {
            Some(difference) => Err(self.mismatch(difference)),
            None => Ok(()),
        }
    }

    /// Returns the first difference between a recorded keyframe and the engine, in words. Its bodies were compared with
    /// the events when it was read.
    fn keyframe_difference(&self, keyframe: &Keyframe) -> Option<String> {
        let snapshot = self.engine.snapshot();
        if keyframe.next_id != snapshot.next_id || keyframe.bodies.len() != snapshot.bodies.len() {
            return Some("the keyframe has other bodies than the replay".into());
        }
        for (recorded, body) in keyframe.bodies.iter().zip(&snapshot.bodies) {
            let (position, velocity, force) = (recorded.position, recorded.velocity, recorded.force);
            let fields = [
                ("x", position.x, body.rect.origin.x),
                ("y", position.y, body.rect.origin.y),
                ("vx", velocity.x, body.velocity.x),
                ("vy", velocity.y, body.velocity.y),
                ("fx", force.x, body.force.x),
                ("fy", force.y, body.force.y),
            ];
            let different = fields.into_iter().find(|(_, recorded, replayed)| recorded.to_bits() != replayed.to_bits());
            if let Some((field, recorded, replayed)) = different {
                let name = &body.name;
                return Some(format!(
                    "the keyframe has {field} {recorded:?} of body {name:?}, the replay {replayed:?}"
                ));
            }
        }
        let (recorded, replayed) = (&keyframe.solver, &snapshot.solver);
        let bits = |solver: &SolverSnapshot| solver.numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        let fields = [
            ("solver_integers", recorded.integers == replayed.integers),
            ("solver_numbers", bits(recorded) == bits(replayed)),
        ];
        let (field, _) = fields.into_iter().find(|(_, is_same)| !is_same)?;
        Some(format!("the keyframe has other {field} than the replay"))
    }

    /// Compares the end record with the replay, if that followed the whole run.
    fn compare_end(&self, trailer: &Trailer) -> Result<(), Box<Divergence>> {
        let Some(CollisionCount(collisions)) = self.collisions.filter(|_| self.steps == ALL_STEPS) else {
            return Ok(());
        };
        // A recovered recording whose end was lost has no accuracy.
        let accuracy = self.probe.as_ref().map(AccuracyProbe::accuracy);
        if let (Some(recorded), Some(replayed)) = (trailer.accuracy, accuracy)
            && recorded != replayed
        {
            return Err(self.mismatch(format!("the end record has the accuracy {recorded}, the replay {replayed}")));
        }
        let recorded = trailer.collisions.unwrap_or(collisions);
        let numbers = [
            ("step", trailer.steps, self.engine.current_step()),
            ("body", trailer.bodies, self.engine.next_id().into()),
            ("collision", recorded, collisions),
        ];
        match numbers.into_iter().find(|(_, recorded, replayed)| recorded != replayed) {
            Some((noun, recorded, replayed)) => Err(self.mismatch(format!(
                "the end record has {}, the replay {}",
                counted(recorded, noun),
                counted(replayed, noun)
            ))),
            None => Ok(()),
        }
    }

    /// Checks that the replay ends with the recorded error, if there is one.
    fn compare_error(&mut self, trailer: &Trailer, observer: &mut dyn Observer) -> Result<(), Box<Divergence>> {
        let Some(recorded) = &trailer.error else { return Ok(()) };
        match self.step(observer) {
            Err(error) if are_same_errors(recorded, &error) => {
                self.reproduced_error = Some(recorded.to_string());
                Ok(())
            }
            Err(error) => Err(self.mismatch(format!(
                "the recorded run ends with the error \"{recorded}\", the replay with \"{}\"",
                error_text(&error)
            ))),
            Ok(()) => Err(self.mismatch(format!("the replay does not reproduce the recorded error \"{recorded}\""))),
        }
    }

    fn run_to(&mut self, step: u64, observer: &mut dyn Observer) -> Result<(), Box<Divergence>> {
        while self.engine.current_step() < step {
            if let Err(error) = self.step(observer) {
                return Err(self.mismatch(format!("the replay ends with an error that was not recorded: {error}")));
            }
        }
        Ok(())
    }

    fn step(&mut self, observer: &mut dyn Observer) -> Result<(), StepError> {
        let mut observers = Observers { observer, collisions: &mut self.collisions, probe: &mut self.probe };
        let stepped = self.engine.step(&mut observers);
        self.probe.iter_mut().for_each(|probe| probe.follow(&self.engine));
        stepped
    }

    /// Returns the first difference between the recorded state and the engine's state.
    fn difference(&mut self, state: &RecordedState) -> Option<Difference> {
        if !state.id.is_empty()
            && let Some(table) = self.recording.table()
            && let Some(difference) = self.value_difference(state, table)
        {
            return Some(difference);
        }
        self.digest.clear();
        for body in &self.engine.world().bodies {
            self.digest.add(body.id, body_state(body));
        }
        let (recorded, replayed) = (state.digest, self.digest.value());
        (recorded != replayed).then_some(Difference::Digest { recorded, replayed })
    }

    fn value_difference(&self, state: &RecordedState, table: &BodyTable) -> Option<Difference> {
        for (info, recorded) in table.join_state(state) {
            let Some(body) = self.engine.world().body(info.id) else {
                return Some(Difference::Mismatch {
                    description: format!("the replay has no body {:?}", info.spawn.name),
                });
            };
            let recorded = recorded.unwrap_or_else(|| info.initial_state());
            let pairs = recorded.into_iter().zip(body_state(body)).zip(["x", "y", "vx", "vy"]);
            for ((recorded, replayed), field) in pairs {
                if recorded.to_bits() != replayed.to_bits() {
                    let body = body.name.clone();
                    return Some(Difference::Value { body, field, recorded, replayed });
                }
            }
        }
        None
    }

    fn mismatch(&self, description: String) -> Box<Divergence> {
        self.divergence(Difference::Mismatch { description })
    }

    fn divergence(&self, difference: Difference) -> Box<Divergence> {
        Box::new(Divergence { step: self.engine.current_step(), difference, last_event: self.last_event.clone() })
    }
}

/// The observers of the collisions of a replay. The solver is compiled once for all of them, not for each type of
/// observer.
struct Observers<'a> {
    observer: &'a mut dyn Observer,
    collisions: &'a mut Option<CollisionCount>,
    probe: &'a mut Option<AccuracyProbe>,
}

impl Observer for Observers<'_> {
    fn collision(&mut self, collision: &Collision) {
        self.collisions.iter_mut().for_each(|count| count.collision(collision));
        self.probe.iter_mut().for_each(|probe| probe.collision(collision));
        self.observer.collision(collision);
    }
}

/// Compares a recorded error with that of a replay, by its fields if they are recorded.
fn are_same_errors(recorded: &RecordedError, replayed: &StepError) -> bool {
    match recorded {
        RecordedError::Step(recorded) => recorded == replayed,
        RecordedError::Text(text) => *text == error_text(replayed),
    }
}
