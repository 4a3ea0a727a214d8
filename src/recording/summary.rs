use std::io::{Read, Seek};

use mcap::records::op;

use super::{
    Error, Item, RecordedEvent, Recording, Trailer,
    index::{self, Index},
    metadata,
    topic::Topic,
};

/// The summary of a finished recording, from its end record and index. The chunks are neither read nor
/// verified.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The end record.
    pub trailer: Trailer,
    /// The number of states, including those recorded as digests only.
    pub states: u64,
    /// The number of keyframes.
    pub keyframes: u64,
    /// The number of chunks.
    pub chunks: u64,
}

impl<R: Read + Seek> Recording<R> {
    /// Returns the summary, or `None` if the recording is unfinished or its index is damaged. Reading
    /// then continues at the start of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn summary(&mut self) -> Result<Option<Summary>, Error> {
        let index = self.take_index()?;
        let trailer = self.read_indexed_trailer(&index)?;
        let summary = trailer.map(|trailer| Summary {
            trailer,
            states: index.message_count(Topic::States),
            keyframes: index.message_count(Topic::Bodies),
            chunks: index.chunks.len() as u64,
        });
        self.index = Some(index);
        self.restart()?;
        Ok(summary)
    }

    /// Calls `visit` with every readable event. Opens only chunks that have events according to the
    /// index. Reading then continues at the start of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn for_each_event(&mut self, mut visit: impl FnMut(RecordedEvent)) -> Result<(), Error> {
        let index = self.take_index()?;
        for chunk in (0..index.chunks.len()).filter(|chunk| index.may_contain(*chunk, Topic::Events)) {
            self.open_indexed_chunk(&index, chunk)?;
            while let Some(item) = self.next_in_chunk() {
                if let Item::Event(event) = item {
                    visit(event);
                }
            }
        }
        self.index = Some(index);
        self.restart()
    }

    /// Takes the index out of `self`, after reading it if necessary. The caller must put it back.
    pub(super) fn take_index(&mut self) -> Result<Index, Error> {
        match self.index.take() {
            Some(index) => Ok(index),
            None => index::read(&mut self.records).map_err(Error::Read),
        }
    }

    fn read_indexed_trailer(&mut self, index: &Index) -> Result<Option<Trailer>, Error> {
        let Some(offset) = index.trailer_offset else { return Ok(None) };
        self.records.seek(offset).map_err(Error::Read)?;
        let is_metadata = matches!(self.records.next_record(), Ok(Some(record)) if record.opcode == op::METADATA);
        let parsed = is_metadata.then(|| metadata::parse(&self.records.body).ok()).flatten();
        Ok(parsed
            .filter(|(name, _)| *name == metadata::TRAILER)
            .and_then(|(_, map)| metadata::parse_trailer(&map).ok()))
    }
}
