use std::{
    io::Write,
    num::NonZero,
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread::{Builder, JoinHandle},
};

use super::{Error, batch::Batch, recorder::Recorder, writer::failed_before};

/// Who encodes, compresses and writes. The bytes are the same.
pub enum Background<W: Write> {
    /// A thread of its own.
    Thread {
        /// What it is to write.
        batches: SyncSender<Batch>,
        /// What it has written, to be filled again.
        used: Receiver<Batch>,
        /// Gives the recorder back, or why it ended.
        thread: JoinHandle<Result<Recorder<W>, Error>>,
    },
    /// The stepping thread, where one more would only take turns with it.
    Nobody(Box<Recorder<W>>),
}

/// Batches that may wait: enough to keep both threads busy.
const WAITING: usize = 2;

impl<W: Write + Send + 'static> Background<W> {
    /// Ready to write with that many processors.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(processors: NonZero<usize>, recorder: Recorder<W>) -> Result<Background<W>, Error> {
        match processors.get() {
            1 => Ok(Background::Nobody(Box::new(recorder))),
            _ => Background::thread(recorder),
        }
    }

    fn thread(mut recorder: Recorder<W>) -> Result<Background<W>, Error> {
        let (batches, incoming) = sync_channel::<Batch>(WAITING);
        let (outgoing, used) = sync_channel(WAITING + 1);
        let work = move || {
            for mut batch in incoming {
                recorder.write(&mut batch)?;
                batch.clear();
                // Whoever does not want it back makes a new one.
                let _ = outgoing.try_send(batch);
            }
            Ok(recorder)
        };
        let thread = Builder::new().name("recording".into()).spawn(work).map_err(Error::Write)?;
        Ok(Background::Thread { batches, used, thread })
    }
}

impl<W: Write> Background<W> {
    /// Takes what is in the batch, and leaves an empty one.
    ///
    /// # Errors
    /// If writing fails; if a thread's did before, [`Background::join`] tells how.
    pub fn write(&mut self, batch: &mut Batch) -> Result<(), Error> {
        match self {
            Background::Thread { batches, used, .. } => {
                let next = used.try_recv().unwrap_or_default();
                // The thread has ended, which it does only with an error.
                batches.send(std::mem::replace(batch, next)).map_err(|_| failed_before())
            }
            Background::Nobody(recorder) => {
                let written = recorder.write(batch);
                batch.clear();
                written
            }
        }
    }

    /// Waits until all is written.
    ///
    /// # Errors
    /// The one that ended a thread.
    pub fn join(self) -> Result<Recorder<W>, Error> {
        match self {
            Background::Thread { batches, used, thread } => {
                drop((batches, used));
                thread.join().unwrap_or_else(|_| Err(failed_before()))
            }
            Background::Nobody(recorder) => Ok(*recorder),
        }
    }
}
