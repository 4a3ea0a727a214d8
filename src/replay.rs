//! Running a recording again and comparing every state to the bit.

mod verdict;

use std::{
    io::{Read, Seek},
    ops::RangeInclusive,
    path::Path,
};

use crate::{
    physics::{Collision, CollisionCount, Engine, Memory, Observer, Settings},
    recording::{
        BodyTable, Change, End, Error, Health, Item, Keyframe, RecordedEvent, RecordedState, Recording,
        SEMANTICS_VERSION, StateDigest, numbers, open,
    },
};

pub use verdict::{Difference, Divergence, Verdict, ulps};

/// Runs `recording` again and compares the states of `steps` (both ends included).
///
/// It starts at the last keyframe before them, and goes on from the next keyframe behind
/// what cannot be read. `progress` hears of each step done. The observer sees the
/// collisions of the replay.
///
/// # Errors
/// If the recording cannot be read for reasons outside of it, or is of an engine this
/// program does not have.
pub fn replay<R: Read + Seek, O: Observer>(
    recording: Recording<R>,
    steps: RangeInclusive<u64>,
    observer: &mut O,
    progress: &mut dyn FnMut(u64),
) -> Result<Verdict, Error> {
    watch(recording, steps, &mut Listening(observer), progress)
}

/// [`replay`] of all of the recording at `path`, with nobody to watch.
///
/// # Errors
/// As for [`replay`], and if the file cannot be opened.
pub fn replay_file(path: &Path) -> Result<Verdict, Error> {
    replay(open(path)?, 0..=u64::MAX, &mut CollisionCount::default(), &mut |_| ())
}

/// Whoever wants to see the engine of a replay, too.
pub trait Witness: Observer {
    /// Called at each state of the steps asked for that came out as recorded, before the engine
    /// goes on.
    fn state(&mut self, engine: &Engine);
}

/// An observer that only hears.
struct Listening<'a, O>(&'a mut O);

impl<O: Observer> Observer for Listening<'_, O> {
    fn collision(&mut self, collision: &Collision) {
        self.0.collision(collision);
    }
}

impl<O: Observer> Witness for Listening<'_, O> {
    fn state(&mut self, _: &Engine) {}
}

/// [`replay`] with a witness of the states, too.
///
/// # Errors
/// As for [`replay`].
pub fn watch<R: Read + Seek, W: Witness>(
    recording: Recording<R>,
    steps: RangeInclusive<u64>,
    witness: &mut W,
    progress: &mut dyn FnMut(u64),
) -> Result<Verdict, Error> {
    let mut replaying = Replaying::new(recording, steps)?;
    loop {
        if let Some(verdict) = replaying.advance(witness, progress)? {
            return Ok(verdict);
        }
    }
}

/// A replay that goes on only when it is asked to.
pub struct Replaying<R> {
    recording: Recording<R>,
    again: Again,
}

impl<R: Read + Seek> Replaying<R> {
    /// The replay of `recording` that compares the states of `steps`, both ends included.
    ///
    /// # Errors
    /// As for [`replay`].
    pub fn new(mut recording: Recording<R>, steps: RangeInclusive<u64>) -> Result<Replaying<R>, Error> {
        let found = recording.header.versions.semantics;
        if found != SEMANTICS_VERSION {
            return Err(Error::OtherSemantics { found });
        }
        if *steps.start() > 0 {
            recording.seek(*steps.start())?;
        }
        let again = Again::new(recording.header.settings.clone(), steps);
        Ok(Replaying { recording, again })
    }

    /// Goes on by one item of the recording; gives the verdict at the end.
    ///
    /// # Errors
    /// As for [`replay`].
    pub fn advance<W: Witness>(
        &mut self,
        witness: &mut W,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Option<Verdict>, Error> {
        let next = if self.again.is_done() { None } else { self.recording.next() };
        let Some(item) = next.transpose()? else {
            return Ok(Some(self.again.verdict(self.recording.health())));
        };
        if let Item::State(state) | Item::Doubtful(state) = &item {
            progress(state.step);
        }
        match self.again.item(item, self.recording.table(), witness) {
            Ok(()) => Ok(None),
            Err(divergence) => Ok(Some(Verdict::Diverged(divergence))),
        }
    }
}

/// The engine that does it all again, and how far it agreed.
struct Again {
    settings: Settings,
    engine: Engine,
    course: Course,
    steps: RangeInclusive<u64>,
    /// Steps from one state that came out again to the next.
    same: u64,
    /// The last state that came out again.
    last: Option<u64>,
    /// What a keyframe says the solver remembers at the next state.
    memory: Option<Memory>,
    last_event: Option<String>,
    then_error: Option<String>,
    digest: StateDigest,
}

/// How the engine stands to the recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    /// Nothing has happened: the first thing is step 0, or a keyframe.
    Fresh,
    /// The engine is where the recording is.
    On,
    /// Events may be missing until the next keyframe.
    Lost,
}

impl Again {
    fn new(settings: Settings, steps: RangeInclusive<u64>) -> Again {
        Again {
            engine: Engine::new(settings.clone()),
            settings,
            course: Course::Fresh,
            steps,
            same: 0,
            last: None,
            memory: None,
            last_event: None,
            then_error: None,
            digest: StateDigest::default(),
        }
    }

    /// Whether there is nothing more to compare.
    fn is_done(&self) -> bool {
        self.last == Some(*self.steps.end())
    }

    fn item<W: Witness>(
        &mut self,
        item: Item,
        table: Option<&BodyTable>,
        observer: &mut W,
    ) -> Result<(), Box<Divergence>> {
        match (item, self.course) {
            (Item::Keyframe(keyframe), Course::On) => {
                self.memory = Some(keyframe.memory);
                Ok(())
            }
            (Item::Keyframe(keyframe), Course::Fresh | Course::Lost) => self.restore(&keyframe),
            (Item::View { .. }, _) => Ok(()),
            (Item::Damaged(_), course) => {
                self.course = if table.is_some() { course } else { Course::Lost };
                Ok(())
            }
            (Item::Gap(_), _) => {
                self.course = Course::Lost;
                Ok(())
            }
            (_, Course::Lost) => Ok(()),
            (Item::Event(event), Course::Fresh | Course::On) => self.event(event, observer),
            (Item::State(state) | Item::Doubtful(state), Course::Fresh | Course::On) => {
                self.state(&state, table, observer)
            }
            (Item::End(end), Course::Fresh | Course::On) => self.end(end, observer),
        }
    }

    fn restore(&mut self, keyframe: &Keyframe) -> Result<(), Box<Divergence>> {
        match Engine::restore(self.settings.clone(), keyframe.snapshot(&self.settings)) {
            Ok(engine) => {
                self.engine = engine;
                self.course = Course::On;
                self.last = None;
                self.memory = None;
                Ok(())
            }
            Err(error) => Err(self.off_course(error.to_string())),
        }
    }

    fn event<W: Witness>(&mut self, event: RecordedEvent, observer: &mut W) -> Result<(), Box<Divergence>> {
        self.course = Course::On;
        self.go_to(event.step, observer)?;
        let (verb, name) = match &event.change {
            Change::Spawn { id, spawn, .. } => ("spawn", (*id == self.engine.next_id()).then(|| spawn.name.clone())),
            Change::Delete { id } => ("delete", self.engine.world().body(*id).map(|body| body.name.clone())),
        };
        let Some(name) = name else {
            return Err(self.off_course(format!("the replay has no place for a recorded {verb}")));
        };
        self.engine.apply(&event.change.event());
        self.last_event = Some(format!("{verb} {name:?} at step {}", event.step));
        Ok(())
    }

    fn state<W: Witness>(
        &mut self,
        state: &RecordedState,
        table: Option<&BodyTable>,
        observer: &mut W,
    ) -> Result<(), Box<Divergence>> {
        self.course = Course::On;
        self.go_to(state.step, observer)?;
        if !self.steps.contains(&state.step) {
            return Ok(());
        }
        if let Some(difference) = self.difference(state, table) {
            return Err(self.diverged(difference));
        }
        observer.state(&self.engine);
        let follows = self.last.is_some_and(|last| last + 1 == state.step);
        self.same += u64::from(follows);
        self.last = Some(state.step);
        match self.memory.take() {
            Some(memory) if !same_memory(&memory, &self.engine.snapshot().memory) => {
                Err(self.off_course("the solver remembers other things than the keyframe says".into()))
            }
            Some(_) | None => Ok(()),
        }
    }

    /// The recorded error must come again; its words are the recording's.
    fn end<W: Witness>(&mut self, end: End, observer: &mut W) -> Result<(), Box<Divergence>> {
        let Some(recorded) = end.error else { return Ok(()) };
        match self.engine.step(observer) {
            Err(error) if error.to_string() == recorded => {
                self.then_error = Some(recorded);
                Ok(())
            }
            Err(error) => {
                Err(self.off_course(format!("the recorded error is {recorded:?}, the replay's is \"{error}\"")))
            }
            Ok(()) => Err(self.off_course(format!("the recorded error {recorded:?} does not come again"))),
        }
    }

    fn go_to<W: Witness>(&mut self, step: u64, observer: &mut W) -> Result<(), Box<Divergence>> {
        while self.engine.present_step() < step {
            if let Err(error) = self.engine.step(observer) {
                return Err(self.off_course(format!("the replay ends in an error that was not recorded: {error}")));
            }
        }
        Ok(())
    }

    /// The first difference between the recorded state and the engine's.
    fn difference(&mut self, state: &RecordedState, table: Option<&BodyTable>) -> Option<Difference> {
        if !state.id.is_empty()
            && let Some(difference) = table.and_then(|table| self.different_number(state, table))
        {
            return Some(difference);
        }
        self.digest.clear();
        for body in &self.engine.world().bodies {
            self.digest.body(body.id, numbers(body));
        }
        let (recorded, replayed) = (state.digest, self.digest.value());
        (recorded != replayed).then_some(Difference::Digest { recorded, replayed })
    }

    fn different_number(&self, state: &RecordedState, table: &BodyTable) -> Option<Difference> {
        for (known, moved) in table.with_state(state) {
            let Some(body) = self.engine.world().body(known.id) else {
                return Some(Difference::Course { what: format!("the replay has no body {:?}", known.spawn.name) });
            };
            let recorded = moved.unwrap_or_else(|| known.first_numbers());
            let pairs = recorded.into_iter().zip(numbers(body)).zip(["x", "y", "vx", "vy"]);
            for ((recorded, replayed), field) in pairs {
                if recorded.to_bits() != replayed.to_bits() {
                    let body = body.name.clone();
                    return Some(Difference::Number { body, field, recorded, replayed });
                }
            }
        }
        None
    }

    fn verdict(&mut self, health: Health) -> Verdict {
        let (steps, done) = (self.same, self.is_done());
        match health {
            Health::Corrupt(damage) => Verdict::Corrupt { damage, steps },
            Health::Truncated { after } if !done => Verdict::Truncated { after, steps },
            Health::Truncated { .. } | Health::Whole => {
                Verdict::Same { steps, bodies: self.engine.next_id().into(), then_error: self.then_error.take() }
            }
        }
    }

    fn off_course(&self, what: String) -> Box<Divergence> {
        self.diverged(Difference::Course { what })
    }

    fn diverged(&self, difference: Difference) -> Box<Divergence> {
        Box::new(Divergence { step: self.engine.present_step(), difference, last_event: self.last_event.clone() })
    }
}

fn same_memory(a: &Memory, b: &Memory) -> bool {
    let bits = |memory: &Memory| memory.numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
    a.integers == b.integers && bits(a) == bits(b)
}

#[cfg(test)]
mod tests;
