use std::{fs::File, io::Write, path::Path};

use crate::physics::{Engine, World};

use super::{End, Error, Header, RecordedEvent};

/// Whether an existing file may be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// `--force`.
    Allowed,
    /// An existing file is an error.
    Refused,
}

/// How far down a flush reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sync {
    /// To the operating system: survives the death of the program.
    Program,
    /// To the disk: survives a power loss (`--sync`).
    Disk,
}

/// Opens `path` to record into, in place, so that it can be read while the run goes on.
///
/// # Errors
/// If the file exists and is to stay, or cannot be created.
pub fn create(path: &Path, _overwrite: Overwrite, _sync: Sync) -> Result<File, Error> {
    File::create(path).map_err(|source| Error::Open { path: path.into(), source })
}

/// Streams a recording out while the engine runs. Memory does not grow with the run.
///
/// For each step: the events applied to it, then [`Writer::state`]. A writer dropped
/// without [`Writer::finish`] leaves a file that is readable up to its last flush, which
/// happens after every batch of events and about every second of simulated time.
pub struct Writer<W> {
    write: W,
}

/// How a run ended, as the one who ran it knows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Collisions that gave an impulse.
    pub collisions: u64,
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
    /// If writing fails or the scene is too large.
    pub fn new(write: W, _header: &Header) -> Result<Writer<W>, Error> {
        Ok(Writer { write })
    }

    /// Records one event that was applied to the present step.
    ///
    /// # Errors
    /// If writing fails or a name is too long.
    pub fn event(&mut self, _event: &RecordedEvent) -> Result<(), Error> {
        todo!()
    }

    /// Records the state of the engine's present step, with a keyframe when one is due.
    ///
    /// # Errors
    /// If writing fails or there are too many bodies.
    pub fn state(&mut self, engine: &Engine) -> Result<(), Error> {
        let _: &World = engine.world();
        todo!()
    }

    /// Writes the end of the recording and its index.
    ///
    /// # Errors
    /// If writing fails; the file is then readable up to its last flush.
    pub fn finish(self, outcome: &Outcome) -> Result<Finished<W>, Error> {
        let _ = (self.write, outcome);
        todo!()
    }
}
