use std::io::{Read, Seek};

use mcap::records::op;

use super::{
    End, Error, Item, RecordedEvent, Recording,
    index::{self, Index},
    metadata,
    topic::Topic,
};

/// What a finished recording tells without its chunks being read: its end and its index.
///
/// Nothing of the chunks is verified.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// How the run ended.
    pub end: End,
    /// States, those thinned away included.
    pub states: u64,
    /// Keyframes.
    pub keyframes: u64,
    /// Chunks.
    pub chunks: u64,
}

impl<R: Read + Seek> Recording<R> {
    /// The outline; none if the recording is unfinished or its index is damaged. What is read
    /// next is the start of the recording.
    ///
    /// # Errors
    /// If the system cannot read.
    pub fn outline(&mut self) -> Result<Option<Outline>, Error> {
        let index = self.take_index()?;
        let end = self.indexed_end(&index)?;
        let outline = end.map(|end| Outline {
            end,
            states: index.messages(Topic::States),
            keyframes: index.messages(Topic::Bodies),
            chunks: index.chunks.len() as u64,
        });
        self.index = Some(index);
        self.restart()?;
        Ok(outline)
    }

    /// Every event that can be read, from those chunks alone that have any as far as the index
    /// tells. What is read next is the start of the recording.
    ///
    /// # Errors
    /// If the system cannot read.
    pub fn events(&mut self, mut take: impl FnMut(RecordedEvent)) -> Result<(), Error> {
        let index = self.take_index()?;
        for place in (0..index.chunks.len()).filter(|place| index.has(*place, Topic::Events)) {
            self.go_to_chunk(&index, place)?;
            while let Some(item) = self.next_of_chunk() {
                if let Item::Event(event) = item {
                    take(event);
                }
            }
        }
        self.index = Some(index);
        self.restart()
    }

    /// The index, read if it was not yet; to be put back.
    pub(super) fn take_index(&mut self) -> Result<Index, Error> {
        match self.index.take() {
            Some(index) => Ok(index),
            None => index::read(&mut self.records).map_err(Error::Read),
        }
    }

    fn indexed_end(&mut self, index: &Index) -> Result<Option<End>, Error> {
        let Some(offset) = index.end else { return Ok(None) };
        self.records.seek(offset).map_err(Error::Read)?;
        let is_metadata = matches!(self.records.advance(), Ok(Some(place)) if place.opcode == op::METADATA);
        let parsed = is_metadata.then(|| metadata::parse(&self.records.body).ok()).flatten();
        Ok(parsed.filter(|(name, _)| *name == metadata::END).and_then(|(_, map)| metadata::end(&map).ok()))
    }
}
