use std::{
    io::{self, Write},
    num::NonZero,
    thread,
};

use crate::physics::Engine;

use super::{
    Change, End, Error, Header, RecordedEvent, background::Background, batch::Batch, batch::Entry, clock, limits,
    recorder::Recorder, view::Paint,
};

/// Streams a recording out while the engine runs. Memory does not grow with the run.
///
/// For each step: the events applied to it, then [`Writer::state`]. A writer dropped
/// without [`Writer::finish`] leaves a file that is readable up to its last flush, which
/// happens after every batch of events and about every second of simulated time.
///
/// Where there are several processors, encoding and compressing happen on a thread of its
/// own, in the same order; an error there is returned by a later call.
pub struct Writer<W: Write> {
    background: Option<Background<W>>,
    batch: Batch,
    rate: f64,
    last_step: Option<u64>,
    unflushed_events: bool,
}

/// How a run ended, as the one who ran it knows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Collisions that gave an impulse, if they were counted.
    pub collisions: Option<u64>,
    /// The engine's error, if the run ended in one.
    pub error: Option<String>,
}

/// What [`Writer::finish`] gives back.
#[derive(Debug)]
pub struct Finished<W> {
    /// What was written at the end.
    pub end: End,
    /// Where it was written to.
    pub write: W,
}

impl<W: Write + Send + 'static> Writer<W> {
    /// Writes the head of a recording.
    ///
    /// # Errors
    /// If writing fails or the header is too large.
    pub fn new(write: W, header: &Header) -> Result<Writer<W>, Error> {
        // WebAssembly has no threads, and says so here.
        Writer::on(thread::available_parallelism().unwrap_or(NonZero::<usize>::MIN), write, header)
    }

    /// The same bytes, written with that many processors.
    pub(super) fn on(processors: NonZero<usize>, write: W, header: &Header) -> Result<Writer<W>, Error> {
        check("the scene's text in bytes", header.scene.text.len(), limits::SCENE_BYTES)?;
        check("the scene's file name in bytes", header.scene.file_name.len(), limits::STRING_BYTES)?;
        check("the number of materials", header.settings.restitution.names().len(), limits::MATERIALS)?;
        Ok(Writer {
            background: Some(Background::new(processors, Recorder::new(write, header)?)?),
            batch: Batch::default(),
            rate: header.settings.rate,
            last_step: None,
            unflushed_events: false,
        })
    }

    /// Adds to every state recorded in full from now on what viewers such as Foxglove draw, in
    /// these colours. Nothing of it takes part in a replay.
    pub fn show(&mut self, paint: Paint) {
        self.batch.entries.push(Entry::Paint(paint));
    }

    /// Records one event that was applied to the present step.
    ///
    /// # Errors
    /// If writing has failed, a name is too long or a body impossible.
    pub fn event(&mut self, event: &RecordedEvent) -> Result<(), Error> {
        if let Change::Spawn { spawn, color, .. } = &event.change {
            for text in [&spawn.name, &spawn.material, color.as_ref().unwrap_or(&String::new())] {
                check("a name in bytes", text.len(), limits::STRING_BYTES)?;
            }
            if !spawn.is_possible() {
                return Err(Error::Impossible { name: spawn.name.clone() });
            }
        }
        self.unflushed_events = true;
        self.batch.entries.push(Entry::Event(event.clone()));
        Ok(())
    }

    /// Records the state of the engine's present step, with a keyframe when one is due.
    ///
    /// # Errors
    /// If writing has failed, there are too many bodies, or events were not recorded.
    pub fn state(&mut self, engine: &Engine) -> Result<(), Error> {
        let step = engine.present_step();
        self.check_order(step)?;
        check("the number of bodies", engine.world().bodies.len(), limits::BODIES)?;
        if step.is_multiple_of(clock::steps_per_second(self.rate)) {
            self.batch.entries.push(Entry::Snapshot(engine.snapshot()));
        }
        self.batch.push_state(engine);
        let flushes = std::mem::take(&mut self.unflushed_events) || clock::ends_second(step, self.rate);
        match flushes || self.batch.is_large() {
            true => self.hand_over(),
            false => Ok(()),
        }
    }

    /// Writes the end of the recording and its index.
    ///
    /// # Errors
    /// If writing fails; the file is then readable up to its last flush.
    pub fn finish(mut self, outcome: Outcome) -> Result<Finished<W>, Error> {
        self.hand_over()?;
        let background = self.background.take().ok_or_else(failed_before)?;
        let (end, write) = background.join()?.finish(outcome, false)?;
        Ok(Finished { end, write })
    }

    fn check_order(&mut self, step: u64) -> Result<(), Error> {
        let due = self.last_step.map_or(0, |last| last + 1);
        if step != due {
            return Err(Error::OutOfOrder { due, found: step });
        }
        if step > limits::STEPS {
            return Err(Error::TooLarge { what: "the number of the step", found: step, limit: limits::STEPS });
        }
        self.last_step = Some(step);
        Ok(())
    }

    fn hand_over(&mut self) -> Result<(), Error> {
        let mut background = self.background.take().ok_or_else(failed_before)?;
        match background.write(&mut self.batch) {
            Ok(()) => self.background = Some(background),
            Err(error) => return Err(background.join().err().unwrap_or(error)),
        }
        Ok(())
    }
}

impl<W: Write> Drop for Writer<W> {
    /// What was handed over is still written; nobody is left to hear of errors.
    fn drop(&mut self) {
        if let Some(background) = self.background.take() {
            let _ = background.join();
        }
    }
}

/// The error of whoever goes on after an error.
pub fn failed_before() -> Error {
    Error::Write(io::Error::other("writing has failed before"))
}

fn check(what: &'static str, found: usize, limit: usize) -> Result<(), Error> {
    match found <= limit {
        true => Ok(()),
        false => Err(Error::TooLarge { what, found: found as u64, limit: limit as u64 }),
    }
}
