use std::{
    io::{self, BufWriter, Write},
    sync::{Arc, Mutex, MutexGuard},
};

use super::{Error, writer::failed_earlier};

/// The output of a recording. Its clones share it: the MCAP writer owns one, and ends a chunk by itself when that is
/// large enough, but flushes only together with the open chunk. Another one flushes the chunks that have ended.
pub struct SharedOutput<W: Write>(Arc<Mutex<Output<W>>>);

struct Output<W: Write> {
    file: BufWriter<W>,
    /// True if a chunk was written after the last flush.
    has_ended_chunk: bool,
}

impl<W: Write> SharedOutput<W> {
    /// Creates an output that writes to `file`.
    pub fn new(file: W) -> SharedOutput<W> {
        SharedOutput(Arc::new(Mutex::new(Output { file: BufWriter::new(file), has_ended_chunk: false })))
    }

    /// Notes that everything written so far precedes the first chunk.
    pub fn begin_chunks(&self) {
        if let Ok(mut output) = self.0.lock() {
            output.has_ended_chunk = false;
        }
    }

    /// Returns true if a chunk was written after the last flush.
    pub fn has_ended_chunk(&self) -> bool {
        self.0.lock().is_ok_and(|output| output.has_ended_chunk)
    }

    /// Flushes the rest and returns the file. This must be the last clone.
    ///
    /// # Errors
    /// Returns an error if writing fails.
    pub fn into_file(self) -> Result<W, Error> {
        let output = Arc::into_inner(self.0).and_then(|output| output.into_inner().ok());
        let mut file = output.ok_or_else(failed_earlier)?.file;
        file.flush().map_err(Error::Write)?;
        file.into_inner().map_err(|error| Error::Write(error.into_error()))
    }

    fn lock(&self) -> io::Result<MutexGuard<'_, Output<W>>> {
        self.0.lock().map_err(|_| io::Error::other("an earlier write has failed"))
    }
}

impl<W: Write> Clone for SharedOutput<W> {
    fn clone(&self) -> SharedOutput<W> {
        SharedOutput(Arc::clone(&self.0))
    }
}

impl<W: Write> Write for SharedOutput<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut output = self.lock()?;
        output.has_ended_chunk = true;
        output.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        let mut output = self.lock()?;
        output.has_ended_chunk = false;
        output.file.flush()
    }
}
