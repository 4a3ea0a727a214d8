use std::{
    io::{self, Write},
    num::NonZero,
    thread,
};

use crate::physics::{Accuracy, Engine};

use super::{
    BodyInfo, Change, Error, Header, RecordedError, RecordedEvent, Trailer,
    batch_writer::BatchWriter,
    limits,
    mcap_writer::Profile,
    scene_update::ColorFn,
    writer_thread::{Batch, Entry, WriterThread},
};

/// Writes a recording while the engine runs. Memory does not grow with the number of steps.
///
/// For each step, call [`Writer::write_event`] for the events applied to it, then
/// [`Writer::write_state`]. A writer dropped without [`Writer::finish`] leaves a file that is
/// readable up to the last flush. Flushes happen after the events of a step, about once per
/// simulated second, and at 4 MiB.
///
/// With several processors, encoding and compression run on a thread of their own, in the same
/// order. An error of that thread is returned by a later call.
pub struct Writer<W: Write> {
    thread: Option<WriterThread<W>>,
    batch: Batch,
    steps_per_second: u64,
    last_step: Option<u64>,
    unflushed_events: bool,
}

/// How a run ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunEnd {
    /// The number of collisions with an impulse, if they were counted.
    pub collisions: Option<u64>,
    /// The engine's error, if the run ended in one.
    pub error: Option<RecordedError>,
    /// The accuracy, if it was estimated.
    pub accuracy: Option<Accuracy>,
}

/// The result of [`Writer::finish`].
#[derive(Debug)]
pub struct Finished<W> {
    /// The end record that was written.
    pub trailer: Trailer,
    /// The output.
    pub output: W,
}

impl<W: Write + Send + 'static> Writer<W> {
    /// Creates a writer and writes the header section of the recording to `output`.
    ///
    /// # Errors
    /// Returns an error if writing fails or the header is too large.
    pub fn new(output: W, header: &Header) -> Result<Writer<W>, Error> {
        Writer::with_processors(processors(), output, Profile::Ros2, header)
    }

    /// Creates a writer that also records the boxes of every full state for viewers such as Foxglove, in these
    /// colours. A replay ignores them.
    ///
    /// # Errors
    /// Returns an error if writing fails or the header is too large.
    pub fn with_scene_updates(output: W, header: &Header, color: ColorFn) -> Result<Writer<W>, Error> {
        let mut writer = Writer::with_processors(processors(), output, Profile::SceneUpdates, header)?;
        writer.batch.entries.push(Entry::Colors(color));
        Ok(writer)
    }

    /// Creates a writer for a number of processors, on which the bytes do not depend.
    pub(super) fn with_processors(
        processors: NonZero<usize>,
        output: W,
        profile: Profile,
        header: &Header,
    ) -> Result<Writer<W>, Error> {
        if let Some(scene) = &header.scene {
            check("the size of the scene's text in bytes", scene.text.len(), limits::SCENE_BYTES)?;
            check("the length of the scene's file name in bytes", scene.file_name.len(), limits::STRING_BYTES)?;
        }
        check("the number of images of the scene", header.images.len(), limits::IMAGES)?;
        let image_bytes = header.images.iter().map(|image| image.bytes).sum::<u64>();
        check("the size of the scene's images in bytes", image_bytes as usize, limits::IMAGES_BYTES)?;
        let Header { steps, every, config, .. } = header;
        check_step("the number of steps", *steps)?;
        check_step("the number of steps between two full states", *every)?;
        if *steps as f64 / config.rate > limits::SECONDS {
            let (found, limit) = ((*steps as f64 / config.rate) as u64, limits::SECONDS as u64);
            return Err(Error::TooLarge { quantity: "the simulated time in seconds", found, limit });
        }
        check("the number of materials", header.config.restitution.names().len(), limits::MATERIALS)?;
        Ok(Writer {
            thread: Some(WriterThread::new(processors, BatchWriter::new(output, profile, header)?)?),
            batch: Batch::default(),
            steps_per_second: header.steps_per_second(),
            last_step: None,
            unflushed_events: false,
        })
    }

    /// Records an event that was applied to the current step.
    ///
    /// # Errors
    /// Returns an error if writing has failed, a string is too long or a body is invalid.
    pub fn write_event(&mut self, event: &RecordedEvent) -> Result<(), Error> {
        if let Change::Spawn(info) = &event.change {
            let BodyInfo { spawn, paint, .. } = &**info;
            for text in [&spawn.name, &spawn.material, paint.as_str()] {
                check("the length of a name in bytes", text.len(), limits::STRING_BYTES)?;
            }
            if !spawn.is_valid() {
                return Err(Error::InvalidBody { name: spawn.name.clone() });
            }
        }
        self.unflushed_events = true;
        self.batch.entries.push(Entry::Event(event.clone()));
        Ok(())
    }

    /// Records the state of the engine's current step, and a keyframe once per simulated second.
    ///
    /// # Errors
    /// Returns an error if writing has failed, there are too many bodies, or an event was not recorded.
    pub fn write_state(&mut self, engine: &Engine) -> Result<(), Error> {
        let step = engine.current_step();
        self.check_order(step)?;
        check("the number of bodies", engine.world().bodies.len(), limits::BODIES)?;
        if step.is_multiple_of(self.steps_per_second) {
            self.batch.entries.push(Entry::Snapshot(engine.snapshot()));
        }
        self.batch.push_state(engine);
        let ends_second = (step + 1).is_multiple_of(self.steps_per_second);
        let is_flush_due = std::mem::take(&mut self.unflushed_events) || ends_second;
        if is_flush_due || self.batch.is_large() { self.submit_batch() } else { Ok(()) }
    }

    /// Writes the end record and the summary.
    ///
    /// # Errors
    /// Returns an error if writing fails; the file is then readable up to its last flush.
    pub fn finish(mut self, run_end: RunEnd) -> Result<Finished<W>, Error> {
        self.submit_batch()?;
        let thread = self.thread.take().ok_or_else(failed_earlier)?;
        let (trailer, output) = thread.join()?.finish(run_end, false)?;
        Ok(Finished { trailer, output })
    }

    fn check_order(&mut self, step: u64) -> Result<(), Error> {
        let expected = self.last_step.map_or(0, |last| last + 1);
        if step != expected {
            return Err(Error::OutOfOrder { expected, found: step });
        }
        check_step("the number of steps", step)?;
        self.last_step = Some(step);
        Ok(())
    }

    fn submit_batch(&mut self) -> Result<(), Error> {
        let mut thread = self.thread.take().ok_or_else(failed_earlier)?;
        match thread.write(&mut self.batch) {
            Ok(()) => self.thread = Some(thread),
            Err(error) => return Err(thread.join().err().unwrap_or(error)),
        }
        Ok(())
    }
}

impl<W: Write> Drop for Writer<W> {
    /// Waits until all submitted batches are written. Errors are ignored.
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The error of a call after an earlier write error.
pub fn failed_earlier() -> Error {
    Error::Write(io::Error::other("an earlier write has failed"))
}

/// The number of processors; 1 on WebAssembly, which has no threads.
fn processors() -> NonZero<usize> {
    thread::available_parallelism().unwrap_or(NonZero::<usize>::MIN)
}

fn check_step(quantity: &'static str, found: u64) -> Result<(), Error> {
    if found <= limits::STEPS { Ok(()) } else { Err(Error::TooLarge { quantity, found, limit: limits::STEPS }) }
}

fn check(quantity: &'static str, found: usize, limit: usize) -> Result<(), Error> {
    if found <= limit { Ok(()) } else { Err(Error::TooLarge { quantity, found: found as u64, limit: limit as u64 }) }
}
