//! Replay: runs a recording again and compares every state bit for bit.

mod verdict;

use std::{
    io::{Read, Seek},
    ops::RangeInclusive,
    path::Path,
};

use crate::{
    physics::{Collision, CollisionCount, Engine, EngineConfig, Observer, SolverSnapshot},
    recording::{
        BodyTable, Change, Error, Health, Item, Keyframe, RecordedEvent, RecordedState, Recording, SEMANTICS_VERSION,
        StateDigest, Trailer, body_state, open,
    },
};

pub use verdict::{Difference, Divergence, Verdict, ulps};

/// Replays `recording` and compares the states of `steps` (both ends included).
///
/// The replay starts at the last keyframe before `steps`, and continues at the next keyframe after
/// damage. `progress` is called with each step. `observer` receives the collisions of the replay.
///
/// # Errors
/// Returns an error if the file cannot be read, or if the recording was made with other engine
/// semantics.
pub fn replay<R: Read + Seek, O: Observer>(
    recording: Recording<R>,
    steps: RangeInclusive<u64>,
    observer: &mut O,
    progress: &mut dyn FnMut(u64),
) -> Result<Verdict, Error> {
    let mut replayer = Replayer::new(recording, steps)?;
    loop {
        if let Some(verdict) = replayer.advance(&mut IgnoreStates(observer), progress)? {
            return Ok(verdict);
        }
    }
}

/// Replays all of the recording at `path`.
///
/// # Errors
/// Returns the errors of [`replay`], and an error if the file cannot be opened.
pub fn replay_file(path: &Path) -> Result<Verdict, Error> {
    replay(open(path)?, 0..=u64::MAX, &mut CollisionCount::default(), &mut |_| ())
}

/// An [`Observer`] that also observes the states of a replay.
pub trait StateObserver: Observer {
    /// Called at each compared state that is the same as recorded, before the next step.
    fn state(&mut self, engine: &Engine);
}

/// Adapts an [`Observer`] to a [`StateObserver`] that ignores states.
struct IgnoreStates<'a, O>(&'a mut O);

impl<O: Observer> Observer for IgnoreStates<'_, O> {
    fn collision(&mut self, collision: &Collision) {
        self.0.collision(collision);
    }
}

impl<O: Observer> StateObserver for IgnoreStates<'_, O> {
    fn state(&mut self, _: &Engine) {}
}

/// A replay that is advanced item by item.
pub struct Replayer<R> {
    recording: Recording<R>,
    rerun: Rerun,
}

impl<R: Read + Seek> Replayer<R> {
    /// Creates a replay of `recording` that compares the states of `steps`, both ends included.
    ///
    /// # Errors
    /// Returns the errors of [`replay`].
    pub fn new(mut recording: Recording<R>, steps: RangeInclusive<u64>) -> Result<Replayer<R>, Error> {
        let found = recording.header.versions.semantics;
        if found != SEMANTICS_VERSION {
            return Err(Error::OtherSemantics { found });
        }
        if *steps.start() > 0 {
            recording.seek(*steps.start())?;
        }
        let rerun = Rerun::new(recording.header.config.clone(), steps);
        Ok(Replayer { recording, rerun })
    }

    /// Processes the next item of the recording. Returns the verdict at the end.
    ///
    /// # Errors
    /// Returns the errors of [`replay`].
    pub fn advance<W: StateObserver>(
        &mut self,
        observer: &mut W,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Option<Verdict>, Error> {
        let next = if self.rerun.is_done() { None } else { self.recording.next() };
        let Some(item) = next.transpose()? else {
            return Ok(Some(self.rerun.verdict(self.recording.health())));
        };
        if let Item::State(state) | Item::SuspectState(state) = &item {
            progress(state.step);
        }
        match self.rerun.item(item, self.recording.table(), observer) {
            Ok(()) => Ok(None),
            Err(divergence) => Ok(Some(Verdict::Diverged(divergence))),
        }
    }
}

/// The engine of a replay, with the result of the comparison so far.
struct Rerun {
    config: EngineConfig,
    engine: Engine,
    sync: SyncState,
    steps: RangeInclusive<u64>,
    /// The number of steps between consecutive states that are both the same as recorded.
    same_steps: u64,
    /// The step of the last state that is the same as recorded.
    last: Option<u64>,
    /// The solver snapshot of a keyframe, to be compared at the next state.
    expected_solver: Option<SolverSnapshot>,
    last_event: Option<String>,
    reproduced_error: Option<String>,
    digest: StateDigest,
}

/// The relation of the engine to the current position in the recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SyncState {
    /// At the start: step 0 or a keyframe follows.
    Start,
    /// The engine is at the position of the recording.
    InSync,
    /// Events may be missing until the next keyframe.
    OutOfSync,
}

impl Rerun {
    fn new(config: EngineConfig, steps: RangeInclusive<u64>) -> Rerun {
        Rerun {
            engine: Engine::new(config.clone()),
            config,
            sync: SyncState::Start,
            steps,
            same_steps: 0,
            last: None,
            expected_solver: None,
            last_event: None,
            reproduced_error: None,
            digest: StateDigest::default(),
        }
    }

    /// Returns true if all states were compared.
    fn is_done(&self) -> bool {
        self.last == Some(*self.steps.end())
    }

    fn item<W: StateObserver>(
        &mut self,
        item: Item,
        table: Option<&BodyTable>,
        observer: &mut W,
    ) -> Result<(), Box<Divergence>> {
        match (item, self.sync) {
            (Item::Keyframe(keyframe), SyncState::InSync) => {
                self.expected_solver = Some(keyframe.solver);
                Ok(())
            }
            (Item::Keyframe(keyframe), SyncState::Start | SyncState::OutOfSync) => self.restore(&keyframe),
            (Item::SceneUpdate { .. }, _) => Ok(()),
            (Item::Damaged(_), sync) => {
                self.sync = if table.is_some() { sync } else { SyncState::OutOfSync };
                Ok(())
            }
            (Item::Gap(_), _) => {
                self.sync = SyncState::OutOfSync;
                Ok(())
            }
            (_, SyncState::OutOfSync) => Ok(()),
            (Item::Event(event), SyncState::Start | SyncState::InSync) => self.apply_event(event, observer),
            (Item::State(state) | Item::SuspectState(state), SyncState::Start | SyncState::InSync) => {
                self.compare_state(&state, table, observer)
            }
            (Item::Trailer(trailer), SyncState::Start | SyncState::InSync) => self.compare_error(trailer, observer),
        }
    }

    fn restore(&mut self, keyframe: &Keyframe) -> Result<(), Box<Divergence>> {
        match Engine::restore(self.config.clone(), keyframe.snapshot(&self.config)) {
            Ok(engine) => {
                self.engine = engine;
                self.sync = SyncState::InSync;
                self.last = None;
                self.expected_solver = None;
                Ok(())
            }
            Err(error) => Err(self.mismatch(error.to_string())),
        }
    }

    fn apply_event<W: StateObserver>(&mut self, event: RecordedEvent, observer: &mut W) -> Result<(), Box<Divergence>> {
        self.sync = SyncState::InSync;
        self.run_to(event.step, observer)?;
        let (verb, name) = match &event.change {
            Change::Spawn { id, spawn, .. } => ("spawn", (*id == self.engine.next_id()).then(|| spawn.name.clone())),
            Change::Delete { id } => ("delete", self.engine.world().body(*id).map(|body| body.name.clone())),
        };
        let Some(name) = name else {
            return Err(self.mismatch(format!("the recorded {verb} cannot be applied in the replay")));
        };
        self.engine.apply(&event.change.event());
        self.last_event = Some(format!("{verb} {name:?} at step {}", event.step));
        Ok(())
    }

    fn compare_state<W: StateObserver>(
        &mut self,
        state: &RecordedState,
        table: Option<&BodyTable>,
        observer: &mut W,
    ) -> Result<(), Box<Divergence>> {
        self.sync = SyncState::InSync;
        self.run_to(state.step, observer)?;
        if !self.steps.contains(&state.step) {
            return Ok(());
        }
        if let Some(difference) = self.difference(state, table) {
            return Err(self.divergence(difference));
        }
        observer.state(&self.engine);
        let is_consecutive = self.last.is_some_and(|last| last + 1 == state.step);
        self.same_steps += u64::from(is_consecutive);
        self.last = Some(state.step);
        match self.expected_solver.take() {
            Some(solver) if !are_identical(&solver, &self.engine.snapshot().solver) => {
                Err(self.mismatch("the internal state of the solver differs from the keyframe".into()))
            }
            Some(_) | None => Ok(()),
        }
    }

    /// Checks that the replay ends with the recorded error, if there is one.
    fn compare_error<W: StateObserver>(&mut self, trailer: Trailer, observer: &mut W) -> Result<(), Box<Divergence>> {
        let Some(recorded) = trailer.error else { return Ok(()) };
        match self.engine.step(observer) {
            Err(error) if error.to_string() == recorded => {
                self.reproduced_error = Some(recorded);
                Ok(())
            }
            Err(error) => Err(self
                .mismatch(format!("the recorded run ends with the error {recorded:?}, the replay with \"{error}\""))),
            Ok(()) => Err(self.mismatch(format!("the replay does not reproduce the recorded error {recorded:?}"))),
        }
    }

    fn run_to<W: StateObserver>(&mut self, step: u64, observer: &mut W) -> Result<(), Box<Divergence>> {
        while self.engine.current_step() < step {
            if let Err(error) = self.engine.step(observer) {
                return Err(self.mismatch(format!("the replay ends with an error that was not recorded: {error}")));
            }
        }
        Ok(())
    }

    /// Returns the first difference between the recorded state and the engine's state.
    fn difference(&mut self, state: &RecordedState, table: Option<&BodyTable>) -> Option<Difference> {
        if !state.id.is_empty()
            && let Some(difference) = table.and_then(|table| self.value_difference(state, table))
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

    fn verdict(&mut self, health: Health) -> Verdict {
        let (steps, is_done) = (self.same_steps, self.is_done());
        match health {
            Health::Corrupt(damage) => Verdict::Corrupt { damage, steps },
            Health::Truncated { after } if !is_done => Verdict::Truncated { after, steps },
            Health::Truncated { .. } | Health::Complete => {
                Verdict::Same { steps, bodies: self.engine.next_id().into(), error: self.reproduced_error.take() }
            }
        }
    }

    fn mismatch(&self, description: String) -> Box<Divergence> {
        self.divergence(Difference::Mismatch { description })
    }

    fn divergence(&self, difference: Difference) -> Box<Divergence> {
        Box::new(Divergence { step: self.engine.current_step(), difference, last_event: self.last_event.clone() })
    }
}

/// Compares two solver snapshots bit for bit.
fn are_identical(a: &SolverSnapshot, b: &SolverSnapshot) -> bool {
    let bits = |solver: &SolverSnapshot| solver.numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
    a.integers == b.integers && bits(a) == bits(b)
}

#[cfg(test)]
mod tests;
