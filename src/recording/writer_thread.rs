use std::{
    io::Write,
    num::NonZero,
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread::{Builder, JoinHandle},
};

use crate::physics::{Body, BodyId, Engine, Snapshot};

use super::{
    Error, RecordedEvent, batch_writer::BatchWriter, body_state, limits, scene_update::ColorFn, writer::failed_earlier,
};

/// Encodes, compresses and writes batches, either on a thread of its own or inline. The bytes written
/// are the same.
pub enum WriterThread<W: Write> {
    /// On a thread of its own.
    Thread {
        /// Batches to be written.
        batches: SyncSender<Batch>,
        /// Empty batches returned by the thread for reuse.
        used: Receiver<Batch>,
        /// Returns the batch writer, or the error that ended the thread.
        thread: JoinHandle<Result<BatchWriter<W>, Error>>,
    },
    /// On the stepping thread, for a single processor.
    Inline(Box<BatchWriter<W>>),
}

/// Capacity of the queue of batches, enough to keep both threads busy.
const QUEUE_CAPACITY: usize = 2;

impl<W: Write + Send + 'static> WriterThread<W> {
    /// Starts the thread if there are several processors.
    ///
    /// # Errors
    /// Returns an error if the thread cannot be started.
    pub fn new(processors: NonZero<usize>, writer: BatchWriter<W>) -> Result<WriterThread<W>, Error> {
        match processors.get() {
            1 => Ok(WriterThread::Inline(Box::new(writer))),
            _ => WriterThread::thread(writer),
        }
    }

    fn thread(mut writer: BatchWriter<W>) -> Result<WriterThread<W>, Error> {
        let (batches, incoming) = sync_channel::<Batch>(QUEUE_CAPACITY);
        let (outgoing, used) = sync_channel(QUEUE_CAPACITY + 1);
        let work = move || {
            for mut batch in incoming {
                writer.write(&mut batch)?;
                batch.clear();
                // If the queue is full, the batch is dropped and the writer allocates a new one.
                let _ = outgoing.try_send(batch);
            }
            Ok(writer)
        };
        let thread = Builder::new().name("recording".into()).spawn(work).map_err(Error::Write)?;
        Ok(WriterThread::Thread { batches, used, thread })
    }
}

impl<W: Write> WriterThread<W> {
    /// Writes the batch, or submits it to the thread, and leaves an empty one.
    ///
    /// # Errors
    /// Returns an error if writing fails. If the thread has failed earlier, [`WriterThread::join`]
    /// returns its error.
    pub fn write(&mut self, batch: &mut Batch) -> Result<(), Error> {
        match self {
            WriterThread::Thread { batches, used, .. } => {
                let next = used.try_recv().unwrap_or_default();
                // Sending fails only if the thread has ended with an error.
                batches.send(std::mem::replace(batch, next)).map_err(|_| failed_earlier())
            }
            WriterThread::Inline(writer) => {
                let written = writer.write(batch);
                batch.clear();
                written
            }
        }
    }

    /// Waits until all batches are written, and returns the writer.
    ///
    /// # Errors
    /// Returns the error that ended the thread.
    pub fn join(self) -> Result<BatchWriter<W>, Error> {
        match self {
            WriterThread::Thread { batches, used, thread } => {
                drop((batches, used));
                thread.join().unwrap_or_else(|_| Err(failed_earlier()))
            }
            WriterThread::Inline(writer) => Ok(*writer),
        }
    }
}

/// A batch of entries that the stepping thread hands to the writer thread, in chronological order.
///
/// The data is copied out of the world, so that encoding, digesting and compressing cost the
/// stepping thread nothing.
#[derive(Debug, Default)]
pub struct Batch {
    /// The entries.
    pub entries: Vec<Entry>,
    /// The rows of all states of the batch, concatenated.
    pub rows: Vec<Row>,
}

/// One thing to record.
#[derive(Debug)]
pub enum Entry {
    /// Record scene updates for viewers, in these colours. The first entry, if at all.
    Colors(ColorFn),
    /// An event.
    Event(RecordedEvent),
    /// The snapshot of a step, for a keyframe.
    Snapshot(Snapshot),
    /// A state.
    State {
        /// The step.
        step: u64,
        /// The number of its rows, which are the next unused ones of the batch.
        rows: usize,
    },
}

/// One body in a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The body.
    pub id: BodyId,
    /// x, y (m), vx, vy (m/s).
    pub state: [f64; 4],
    /// True if the body has infinite mass.
    pub has_infinite_mass: bool,
}

/// Bytes of a row in the file. (The size in memory differs between machines.)
const RECORDED_BYTES: usize = 36;

impl Batch {
    /// Adds the state of the engine's current step.
    pub fn push_state(&mut self, engine: &Engine) {
        let bodies = &engine.world().bodies;
        self.entries.push(Entry::State { step: engine.current_step(), rows: bodies.len() });
        self.rows.extend(bodies.iter().map(Row::new));
    }

    /// Returns true if the batch is large enough to hand over: it keeps the writer thread busy for
    /// longer than waking the thread takes.
    pub fn is_large(&self) -> bool {
        self.rows.len() * RECORDED_BYTES > limits::CHUNK_BYTES / 16
    }

    /// Removes all entries and keeps the allocated memory.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.rows.clear();
    }
}

impl Row {
    fn new(body: &Body) -> Row {
        Row { id: body.id, state: body_state(body), has_infinite_mass: body.is_infinite() }
    }
}
