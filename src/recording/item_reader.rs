use std::io::{Read, Seek};

use mcap::{MAGIC, McapError, records::op};

use super::{
    Damage, Error, Header, Item,
    chunk_reader::{ChunkReader, ChunkRecord},
    decoder::{Decoder, Location},
    header_section::{self, Attachments, Defect},
    index::Index,
    merge::Parts,
    metadata,
    record_reader::{PREFIX_BYTES, ReadFault, RecordHeader, RecordReader, SuspectLength, is_private},
    resync::{self, Resync},
    tally::Tally,
};

/// Reads the records of a recording as they are stored, decodes them to [`Item`]s, and continues after damage.
pub struct ItemReader<R> {
    pub records: RecordReader<R>,
    pub decoder: Decoder,
    pub phase: Phase,
    /// The number of chunks up to and including the current one, skipped ones included.
    pub chunk_count: u64,
    /// The first damage before the messages.
    pub opening_damage: Option<Damage>,
    /// The parts with messages, if only they are collected and no message is decoded.
    pub survey: Option<Parts>,
    header: Header,
    /// The offset of the metadata record with the settings.
    settings_offset: u64,
    attachments: Attachments,
    chunks: ChunkReader,
    /// The location of the current or last chunk.
    chunk: Location,
    /// The offset of the data end record, once it was read.
    data_end: Option<u64>,
    crc_suspect: Option<Defect>,
    /// The end records that were read, which are compared with the messages before and after them: other programs store
    /// them before their last chunk.
    trailers: Vec<(Location, Vec<u8>)>,
    /// The records read so far, while everything is read from the start.
    tally: Option<Tally>,
    suspect: SuspectLength,
    /// The offset of the last record, at first that of a record of the header section.
    last_offset: u64,
    /// The offset of the first private record that only schemas and channels have followed: it may be a damaged data
    /// end.
    private: Option<u64>,
}

/// The progress through a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Reading,
    /// The file ends too early.
    Truncated,
    /// The file was read to its end.
    Finished,
}

impl<R: Read + Seek> ItemReader<R> {
    /// Reads the header section.
    ///
    /// # Errors
    /// Returns an error if `source` is not a recording or is newer than this program.
    pub fn new(source: R) -> Result<ItemReader<R>, Error> {
        let mut records = RecordReader::new(source).map_err(Error::Read)?;
        let section = header_section::read(&mut records)?;
        Ok(ItemReader {
            decoder: Decoder::new(&section.header),
            phase: Phase::Reading,
            chunk_count: 0,
            opening_damage: None,
            survey: None,
            header: section.header,
            settings_offset: section.settings_offset,
            attachments: section.attachments,
            chunks: ChunkReader::new(),
            chunk: Location::default(),
            data_end: None,
            crc_suspect: None,
            trailers: Vec::new(),
            tally: None,
            suspect: section.suspect,
            last_offset: section.settings_offset,
            private: None,
            records,
        })
    }

    /// Returns the header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Returns to the start, and continues after the header section.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn restart(&mut self) -> Result<(), Error> {
        self.seek(0)?;
        self.records.rewind().map_err(Error::Read)?;
        let section = header_section::read(&mut self.records)?;
        self.decoder = Decoder::new(&section.header);
        self.suspect = section.suspect;
        self.chunk_count = 0;
        self.crc_suspect = section.crc_suspect;
        if section.defects.is_empty() {
            let mut tally = Tally::default();
            section.indexed.iter().for_each(|(opcode, entry)| tally.add_entry(*opcode, entry));
            self.tally = Some(tally);
        }
        for Defect { offset, reason } in section.defects {
            self.decoder.report_damage(Location { chunk: None, offset }, reason);
        }
        self.opening_damage.clone_from(&self.decoder.damage);
        let trailers = section.trailers.into_iter();
        self.trailers.extend(trailers.map(|(offset, body)| (Location { chunk: None, offset }, body)));
        section.pending.map_or(Ok(()), |record| self.read_record(record))
    }

    /// Moves to a place of the index and discards the state of everything read before.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn open_place(&mut self, index: &Index, place: usize) -> Result<(), Error> {
        let offset = index.places[place].offset;
        self.seek(offset)?;
        self.decoder.reset(&index.definitions);
        let skipped = index.trailer_record.iter().filter(|(location, _)| location.offset < offset);
        self.trailers.extend(skipped.cloned());
        self.chunk_count = place as u64;
        self.next_record()
    }

    /// Continues at `offset`, where a record starts.
    fn seek(&mut self, offset: u64) -> Result<(), Error> {
        self.chunks.close();
        self.data_end = None;
        self.crc_suspect = None;
        self.tally = None;
        self.trailers.clear();
        self.phase = Phase::Reading;
        self.records.seek(offset).map_err(Error::Read)
    }

    /// Returns the next item, or `None` where all records before the offset `end` are read and the step at `last_time`
    /// (simulated nanoseconds), which may continue after it, is complete.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn next_before(&mut self, end: u64, last_time: u64) -> Result<Option<Item>, Error> {
        while self.decoder.ready.is_empty() && self.phase == Phase::Reading {
            if self.last_offset >= end && !self.decoder.is_reading_step_at(last_time) {
                return Ok(None);
            }
            if !self.decoder.resume() {
                self.next_stored()?;
            }
        }
        Ok(self.decoder.ready.pop_front())
    }

    /// Returns the next event of the open chunk, or `None` at its end or at damage.
    pub fn next_in_chunk(&mut self) -> Option<Item> {
        while self.decoder.ready.is_empty() {
            if self.decoder.resume() {
                continue;
            }
            let Ok(Some(record)) = self.chunks.next_record() else { return None };
            // Its length is certain, because the checksum of the chunk was verified.
            let _ = self.decoder.decode_record(self.chunk, &record);
        }
        self.decoder.ready.pop_front()
    }

    /// Reads the next record.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn next_stored(&mut self) -> Result<(), Error> {
        match self.chunks.next_record() {
            Ok(Some(record)) => {
                self.tally.iter_mut().for_each(|tally| tally.add_record(&record));
                let is_skipped = self.survey.is_some() && record.opcode == op::MESSAGE;
                if !is_skipped {
                    let _ = self.decoder.decode_record(self.chunk, &record);
                }
            }
            Ok(None) => self.next_record()?,
            Err(reason) => self.decoder.mark_lost(self.chunk, reason),
        }
        Ok(())
    }

    fn next_record(&mut self) -> Result<(), Error> {
        match self.records.next_record() {
            Ok(Some(record)) => match self.data_end {
                None => self.read_record(record)?,
                Some(_) => {
                    let body = &self.records.body;
                    let RecordHeader { offset, opcode } = record;
                    let added = self.tally.as_mut().map(|tally| tally.add_summary_record(opcode, offset, body));
                    if added.is_some_and(|added| added.is_err()) {
                        self.report_summary("a record of the summary is malformed".into());
                    }
                }
            },
            Ok(None) => {
                self.finish();
                self.phase = Phase::Finished;
                self.decoder.suspect = None;
                let difference =
                    self.tally.as_ref().filter(|_| self.decoder.damage.is_none()).and_then(Tally::difference);
                difference.into_iter().for_each(|reason| self.report_summary(reason));
            }
            Err(fault) => self.recover_from(fault)?,
        }
        Ok(())
    }

    fn report_summary(&mut self, reason: String) {
        self.tally = None;
        let location = Location { chunk: None, offset: self.data_end.unwrap_or(0) };
        self.decoder.report_damage(location, reason);
    }

    /// Ends the open chunk and the open step.
    fn close_step(&mut self) {
        self.close_chunk();
        self.decoder.finish_step();
    }

    /// Ends the open step, and decodes the end record. No message follows.
    pub fn finish(&mut self) {
        self.close_step();
        if self.survey.is_some() {
            return;
        }
        self.decoder.report_renamed_topics();
        let last_step = self.decoder.validator.last_step();
        for (location, body) in self.trailers.drain(..) {
            // In a file that was cut, the end record may precede messages that are lost.
            let is_at_end = metadata::trailer_of(&body).is_some_and(|trailer| Some(trailer.steps) == last_step);
            if self.phase != Phase::Truncated || is_at_end {
                self.decoder.decode_metadata(location, &body, self.settings_offset);
            }
        }
    }

    fn close_chunk(&mut self) {
        if let (Some(parts), Some(times)) = (&mut self.survey, self.chunks.times()) {
            parts.add_chunk(self.chunk, times);
        }
        if let (Some(chunk), Some(tally)) = (self.chunks.close(), &mut self.tally) {
            tally.add_chunk(&chunk);
        }
    }

    fn read_record(&mut self, RecordHeader { offset, opcode }: RecordHeader) -> Result<(), Error> {
        let location = Location { chunk: None, offset };
        let last_offset = std::mem::replace(&mut self.last_offset, offset);
        let suspect = self.suspect.follow(RecordHeader { offset, opcode }, &self.records.body);
        if is_private(opcode) {
            self.private = self.private.or(Some(offset));
            return Ok(()); // A private record of another program, or one with a damaged opcode.
        }
        let private = self.private;
        if !matches!(opcode, op::SCHEMA | op::CHANNEL) {
            self.private = None;
        }
        self.decoder.suspect = suspect;
        if opcode == op::MESSAGE_INDEX {
            return self.check_message_index(offset, last_offset);
        }
        self.close_chunk();
        let body = &self.records.body;
        match opcode {
            op::CHUNK => return self.open_chunk(offset),
            op::MESSAGE | op::SCHEMA | op::CHANNEL => {
                let record = ChunkRecord { opcode, body };
                self.tally.iter_mut().for_each(|tally| tally.add_record(&record));
                match (&mut self.survey, record.message()) {
                    (Some(parts), Some(message)) => parts.add_message(offset, message.log_time)?,
                    _ => {
                        if self.decoder.decode_record(location, &record).is_err() {
                            self.records.resume_within(offset).map_err(Error::Read)?;
                        }
                    }
                }
            }
            op::METADATA => {
                self.tally.iter_mut().for_each(|tally| tally.add_indexed(opcode, offset, body));
                if metadata::is_trailer(body) && self.trailers.len() < 2 {
                    self.trailers.push((location, body.clone()))
                } else {
                    self.decoder.decode_metadata(location, body, self.settings_offset)
                }
            }
            op::ATTACHMENT => {
                self.tally.iter_mut().for_each(|tally| tally.add_indexed(opcode, offset, body));
                if let Err(reason) = self.attachments.check(offset, body, &self.header) {
                    self.decoder.report_damage(location, reason);
                }
            }
            op::DATA_END => {
                self.finish();
                self.decoder.suspect = None;
                self.data_end = Some(offset);
                let end = offset + (PREFIX_BYTES + self.records.body.len()) as u64;
                self.tally.iter_mut().for_each(|tally| tally.end_data(end));
            }
            other => {
                let location = Location { chunk: None, offset: private.unwrap_or(offset) };
                self.decoder.mark_lost(location, format!("a record with opcode {other:#04x} is not allowed here"));
                return self.resume_after(self.decoder.suspect.unwrap_or(offset));
            }
        }
        Ok(())
    }

    fn check_message_index(&mut self, offset: u64, last_offset: u64) -> Result<(), Error> {
        let Err(reason) = self.chunks.check_message_index(offset, &self.records.body) else { return Ok(()) };
        // Without a chunk, the record before is a chunk whose opcode is damaged.
        let damaged = if self.chunks.is_open() { offset } else { last_offset };
        self.decoder.report_damage(Location { offset: damaged, ..self.chunk }, reason);
        self.resume_after(offset)
    }

    fn open_chunk(&mut self, offset: u64) -> Result<(), Error> {
        self.chunk_count += 1;
        self.chunk = Location { chunk: Some(self.chunk_count), offset };
        match self.chunks.open(offset, &self.records.body) {
            Ok(()) => Ok(()),
            Err(reason) => {
                self.decoder.mark_lost(self.chunk, reason);
                self.resume_after(offset)
            }
        }
    }

    fn resume_after(&mut self, offset: u64) -> Result<(), Error> {
        self.interrupt_parts();
        self.chunks.close();
        self.tally = None;
        if !self.records.resume_after(offset).map_err(Error::Read)? {
            self.phase = Phase::Finished;
            self.finish();
        }
        Ok(())
    }

    fn interrupt_parts(&mut self) {
        if let Some(parts) = &mut self.survey {
            parts.interrupt();
        }
    }

    /// Continues at the next valid record after a fault.
    fn recover_from(&mut self, fault: ReadFault) -> Result<(), Error> {
        self.close_step();
        self.tally = None;
        let fault = self.suspect.locate(fault)?;
        let resync = match self.data_end {
            Some(_) => resync::truncated_or_corrupt(self.records.source(), &fault),
            None => resync::resync(&mut self.records, &fault),
        };
        let Defect { offset, reason } = self.locate(fault);
        let location = Location { chunk: None, offset };
        match resync.map_err(Error::Read)? {
            Resync::ContinueAt(next) => {
                self.interrupt_parts();
                self.decoder.mark_lost(location, reason);
                self.records.seek(next).map_err(Error::Read)?;
            }
            Resync::Truncated => {
                self.phase = Phase::Truncated;
                self.finish();
            }
            Resync::Corrupt => {
                self.decoder.report_damage(location, reason);
                self.phase = Phase::Finished;
                self.finish();
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
