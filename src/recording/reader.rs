use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
};

use mcap::{MAGIC, McapError, records::op};

use super::{
    BodyTable, Damage, Error, Gap, Header, Health, Keyframe, RecordedEvent, RecordedState, Trailer,
    chunk_reader::ChunkReader,
    decoder::{Decoder, Location},
    header_section::{self, Defect, HeaderSection},
    index::{self, Index, Summary},
    record_reader::{ReadFault, RecordHeader, RecordReader},
    resync::{self, Resync},
    sequence_validator::SequenceValidator,
    topic::Topic,
};

/// Reads a recording: an iterator over its [`Item`]s in file order.
///
/// Keeps at most one chunk in memory. [`Recording::health`] is final after the last item.
#[doc(alias("mcap", "rosbag"))]
pub struct Recording<R> {
    /// The header.
    pub header: Header,
    records: RecordReader<R>,
    chunks: ChunkReader,
    /// The location of the current or last chunk.
    chunk: Location,
    chunk_count: u64,
    /// The offset of the data end record, once it was read.
    data_end: Option<u64>,
    crc_suspect: Option<Defect>,
    decoder: Decoder,
    /// The index of the chunks, once it was needed.
    index: Option<Index>,
    phase: Phase,
}

/// One item of a recording.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// An event.
    Event(RecordedEvent),
    /// A keyframe.
    Keyframe(Keyframe),
    /// A state.
    State(RecordedState),
    /// A state that does not match its own digest, or has values that are not finite. A replay must
    /// compare it, but it must not be shown.
    SuspectState(RecordedState),
    /// The boxes of the next state, for viewers. The message is not decoded.
    SceneUpdate {
        /// The log time, in simulated nanoseconds.
        time: u64,
        /// An encoded `foxglove.SceneUpdate`.
        message: Vec<u8>,
    },
    /// Unreadable data. Events may be missing until the next keyframe.
    Damaged(Damage),
    /// A gap of a recovered recording. Events may be missing until the next keyframe.
    Gap(Gap),
    /// The end record.
    Trailer(Trailer),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Reading,
    /// The file ends too early.
    Truncated,
    /// The file was read to its end.
    Finished,
}

/// Opens the recording at `path`.
///
/// # Errors
/// Returns an error if the file cannot be opened, is not a recording, or is newer than this program.
pub fn open(path: &Path) -> Result<Recording<BufReader<File>>, Error> {
    let file = File::open(path).map_err(|source| Error::Open { path: path.into(), source })?;
    Recording::read(BufReader::new(file))
}

impl<R: Read + Seek> Recording<R> {
    /// Reads the header section of a recording.
    ///
    /// # Errors
    /// Returns an error if `source` is not a recording or is newer than this program.
    pub fn read(source: R) -> Result<Recording<R>, Error> {
        let mut records = RecordReader::new(source);
        let section = header_section::read(&mut records)?;
        let validator = SequenceValidator::new(&section.header);
        let decoder = Decoder::new(validator, section.header.versions.format);
        let mut recording = Recording {
            header: section.header.clone(),
            records,
            chunks: ChunkReader::new(),
            chunk: Location { chunk: None, offset: 0 },
            chunk_count: 0,
            data_end: None,
            crc_suspect: None,
            decoder,
            index: None,
            phase: Phase::Reading,
        };
        recording.continue_after(section)?;
        Ok(recording)
    }

    /// Moves to the last keyframe at or before `step`, which is then the next item, or to the start if
    /// there is none. Skipped data is not read, so [`Recording::health`] covers only the rest.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn seek(&mut self, step: u64) -> Result<(), Error> {
        let index = self.take_index()?;
        let time = self.header.log_time(step);
        let count = index.chunks.partition_point(|chunk| chunk.first_time <= time);
        let mut is_found = false;
        for chunk in (0..count).rev().filter(|chunk| index.may_contain(*chunk, Topic::Bodies)) {
            is_found = self.seek_keyframe(&index, chunk, step)?;
            if is_found {
                break;
            }
        }
        self.index = Some(index);
        if is_found { Ok(()) } else { self.restart() }
    }

    /// Searches a chunk for a keyframe at or before `step`, and returns true if there is one, which is
    /// then the next item.
    fn seek_keyframe(&mut self, index: &Index, chunk: usize, step: u64) -> Result<bool, Error> {
        self.open_indexed_chunk(index, chunk)?;
        while let Some(item) = self.next_in_chunk() {
            match item {
                Item::Keyframe(keyframe) if keyframe.step <= step => {
                    self.decoder.ready.push_front(Item::Keyframe(keyframe));
                    return Ok(true);
                }
                Item::Keyframe(_) | Item::Damaged(_) => return Ok(false),
                Item::Event(_) | Item::State(_) | Item::SuspectState(_) => {}
                Item::SceneUpdate { .. } | Item::Gap(_) | Item::Trailer(_) => {}
            }
        }
        Ok(false)
    }

    /// Returns the summary, or `None` if the recording is unfinished or its index is damaged. Afterwards,
    /// reading restarts at the beginning of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn summary(&mut self) -> Result<Option<Summary>, Error> {
        let index = self.take_index()?;
        let summary = index.summary(&mut self.records).map_err(Error::Read)?;
        self.index = Some(index);
        self.restart()?;
        Ok(summary)
    }

    /// Calls `visit` with every readable event. Opens only chunks that have events according to the
    /// index. Afterwards, reading restarts at the beginning of the recording.
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
    fn take_index(&mut self) -> Result<Index, Error> {
        match self.index.take() {
            Some(index) => Ok(index),
            None => index::read(&mut self.records).map_err(Error::Read),
        }
    }

    /// Opens a chunk of the index and discards the state of everything read before.
    fn open_indexed_chunk(&mut self, index: &Index, chunk: usize) -> Result<(), Error> {
        self.seek_record(index.chunks[chunk].offset)?;
        self.decoder.reset(&index.channels);
        self.chunk_count = chunk as u64;
        self.next_record()
    }

    /// Returns the next item of the open chunk, or `None` at its end or at damage.
    fn next_in_chunk(&mut self) -> Option<Item> {
        while self.decoder.ready.is_empty() {
            let Ok(Some(record)) = self.chunks.next_record() else { return None };
            self.decoder.decode_chunk_record(self.chunk, &record);
        }
        self.decoder.ready.pop_front()
    }

    /// Continues at `offset`, where a record starts.
    fn seek_record(&mut self, offset: u64) -> Result<(), Error> {
        self.chunks.close();
        self.data_end = None;
        self.crc_suspect = None;
        self.phase = Phase::Reading;
        self.records.seek(offset).map_err(Error::Read)
    }

    /// Returns to the start.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn restart(&mut self) -> Result<(), Error> {
        self.seek_record(0)?;
        self.records.rewind().map_err(Error::Read)?;
        let section = header_section::read(&mut self.records)?;
        self.decoder.reset(&[]);
        self.decoder.validator = SequenceValidator::new(&section.header);
        self.chunk_count = 0;
        self.continue_after(section)
    }

    /// Continues after the header section.
    fn continue_after(&mut self, section: HeaderSection) -> Result<(), Error> {
        self.crc_suspect = section.crc_suspect;
        for Defect { offset, reason } in section.defects {
            self.decoder.report_damage(Location { chunk: None, offset }, reason);
        }
        section.pending.map_or(Ok(()), |record| self.read_record(record))
    }

    /// Returns the condition of the part read so far; final once the iterator has ended.
    pub fn health(&self) -> Health {
        match (&self.decoder.damage, self.phase, &self.decoder.trailer) {
            (Some(damage), _, _) => Health::Corrupt(damage.clone()),
            (None, Phase::Finished, Some(_)) => Health::Complete,
            (None, _, _) => Health::Truncated { after: self.decoder.validator.last_step() },
        }
    }

    /// The living bodies after the last item; `None` (unknown) between damage and the next keyframe.
    pub fn table(&self) -> Option<&BodyTable> {
        self.decoder.validator.table()
    }

    /// The end record, once it was read.
    pub fn trailer(&self) -> Option<&Trailer> {
        self.decoder.trailer.as_ref()
    }

    /// The number of chunks up to and including the current one, skipped ones included.
    pub fn chunk_count(&self) -> u64 {
        self.chunk_count
    }

    /// Reads until an item is ready or the file ends.
    fn advance(&mut self) -> Result<(), Error> {
        while self.decoder.ready.is_empty() && self.phase == Phase::Reading {
            match self.chunks.next_record() {
                Ok(Some(record)) => self.decoder.decode_chunk_record(self.chunk, &record),
                Ok(None) => self.next_record()?,
                Err(reason) => self.decoder.mark_lost(self.chunk, reason),
            }
        }
        Ok(())
    }

    fn next_record(&mut self) -> Result<(), Error> {
        match self.records.next_record() {
            Ok(Some(record)) if self.data_end.is_none() => self.read_record(record)?,
            Ok(Some(_)) => {} // The summary section: copies and the index, verified by its checksum.
            Ok(None) => self.phase = Phase::Finished,
            Err(fault) => self.recover_from(fault)?,
        }
        Ok(())
    }

    fn read_record(&mut self, RecordHeader { offset, opcode }: RecordHeader) -> Result<(), Error> {
        let body = &self.records.body;
        let location = Location { chunk: None, offset };
        match opcode {
            op::CHUNK => return self.open_chunk(offset),
            op::MESSAGE_INDEX => {
                if let Err(reason) = self.chunks.check_message_index(body) {
                    self.decoder.report_damage(Location { offset, ..self.chunk }, reason);
                    return self.resume_after(offset);
                }
            }
            op::METADATA => self.decoder.decode_metadata(location, body),
            op::ATTACHMENT => {}
            op::DATA_END => self.data_end = Some(offset),
            other => {
                self.decoder.mark_lost(location, format!("a record with opcode {other:#04x} is not allowed here"));
                return self.resume_after(offset);
            }
        }
        Ok(())
    }

    fn open_chunk(&mut self, offset: u64) -> Result<(), Error> {
        self.chunk_count += 1;
        self.chunk = Location { chunk: Some(self.chunk_count), offset };
        match self.chunks.open(&self.records.body) {
            Ok(()) => Ok(()),
            Err(reason) => {
                self.decoder.mark_lost(self.chunk, reason);
                self.resume_after(offset)
            }
        }
    }

    fn resume_after(&mut self, offset: u64) -> Result<(), Error> {
        self.chunks.close();
        self.records.resume_after(offset).map_err(Error::Read)
    }

    /// Continues at the next valid record after a fault.
    fn recover_from(&mut self, fault: ReadFault) -> Result<(), Error> {
        self.chunks.close();
        if let McapError::Io(error) = fault.error {
            return Err(Error::Read(error));
        }
        let resync = match self.data_end {
            Some(_) => resync::truncated_or_corrupt(self.records.source(), &fault),
            None => resync::resync(self.records.source(), &fault),
        };
        let Defect { offset, reason } = self.locate(fault);
        let location = Location { chunk: None, offset };
        match resync.map_err(Error::Read)? {
            Resync::ContinueAt(next) => {
                self.decoder.mark_lost(location, reason);
                self.records.seek(next).map_err(Error::Read)?;
            }
            Resync::Truncated => self.phase = Phase::Truncated,
            Resync::Corrupt => {
                self.decoder.report_damage(location, reason);
                self.phase = Phase::Finished;
            }
        }
        Ok(())
    }

    /// Locates a fault. A fault in data without a checksum of its own can only be located by section.
    fn locate(&self, ReadFault { offset, error }: ReadFault) -> Defect {
        let section =
            |name: &str, from: u64| Defect { offset: from, reason: format!("{name}, up to byte {offset}: {error}") };
        match (&error, self.data_end, &self.crc_suspect) {
            (McapError::BadDataCrc { .. }, _, Some(defect)) => defect.clone(),
            (McapError::BadDataCrc { .. }, _, None) => section("somewhere outside the chunks", MAGIC.len() as u64),
            (_, Some(data_end), _) => section("somewhere in the index", data_end),
            (_, None, _) => Defect { offset, reason: error.to_string() },
        }
    }
}

impl<R: Read + Seek> Iterator for Recording<R> {
    type Item = Result<Item, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.advance() {
            Ok(()) => self.decoder.ready.pop_front().map(Ok),
            Err(error) => {
                self.phase = Phase::Truncated;
                Some(Err(error))
            }
        }
    }
}
