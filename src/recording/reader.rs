use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
};

use mcap::{MAGIC, McapError, records::op};

use super::{
    BodyTable, Damage, Error, Gap, Header, Health, Keyframe, Missing, MissingEnd, RecordedEvent, RecordedState,
    Trailer,
    chunk_reader::{ChunkReader, ChunkRecord},
    decoder::{Decoder, Location},
    header_section::{self, Attached, Defect, HeaderSection, SECOND_SCENE, parse_attachment},
    index::{self, Index, Summary},
    merge::{Merge, Parts},
    metadata,
    record_reader::{PREFIX_BYTES, ReadFault, RecordHeader, RecordReader, has_unknown_fields},
    resync::{self, Resync},
    tally::Tally,
    topic::Topic,
};

/// Reads a recording: an iterator over its [`Item`]s in order of time.
///
/// Keeps at most one chunk in memory, or those that overlap in time if the messages are stored in another order; then
/// the file is read twice. [`Recording::health`] is final after the last item.
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
    /// The first damage before the messages.
    opening_damage: Option<Damage>,
    decoder: Decoder,
    /// The index of the chunks, once it was needed.
    index: Option<Index>,
    /// The condition of the entire file, if the index is doubtful: then it is read to its end before any part of it.
    verified: Option<Health>,
    phase: Phase,
    order: Order,
    /// The end records that were read, which are compared with the messages before and after them: other programs store
    /// them before their last chunk.
    trailers: Vec<(Location, Vec<u8>)>,
    /// The records read so far, while everything is read from the start.
    tally: Option<Tally>,
    settings_offset: u64,
    scene_offset: Option<u64>,
    /// The offsets of the attachments with the images of the scene.
    image_offsets: Vec<u64>,
    /// The offset of the last record, if it has unknown fields.
    padded: Option<u64>,
    /// The offset of the last record, at first that of a record of the header section.
    last_offset: u64,
    /// The offset of the first private record that only schemas and channels have followed: it may be a damaged data
    /// end.
    private: Option<u64>,
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

/// The order in which the file is read.
enum Order {
    /// The messages are read as they are stored, in order of time.
    Stored,
    /// The messages are stored in another order: the file is verified first, and the parts with messages are collected.
    Surveyed(Parts),
    /// After the survey, the messages are read in order of time. Holds the end of the survey.
    ByTime(Merge, Phase),
}

/// Opens the recording at `path`.
///
/// # Errors
/// Returns an error if the file cannot be opened, is not a recording, or is newer than this program.
pub fn open(path: &Path) -> Result<Recording<BufReader<File>>, Error> {
    Recording::read(BufReader::new(open_file(path)?)).map_err(|error| error.or_plot_table(path))
}

/// Opens the file of a recording.
///
/// # Errors
/// Returns an error if the file cannot be opened, or cannot be read at any position.
pub fn open_file(path: &Path) -> Result<File, Error> {
    // Opening a named pipe would wait for its writer, and then take its only reader away.
    if path.metadata().is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir()) {
        return Err(Error::NotARegularFile { path: path.into() });
    }
    File::open(path).map_err(|source| Error::Open { path: path.into(), source })
}

impl<R: Read + Seek> Recording<R> {
    /// Reads the header section of a recording.
    ///
    /// # Errors
    /// Returns an error if `source` is not a recording or is newer than this program.
    pub fn read(source: R) -> Result<Recording<R>, Error> {
        let mut records = RecordReader::new(source).map_err(Error::Read)?;
        let section = header_section::read(&mut records)?;
        let decoder = Decoder::new(&section.header);
        let mut recording = Recording {
            header: section.header.clone(),
            records,
            chunks: ChunkReader::new(),
            chunk: Location::default(),
            chunk_count: 0,
            data_end: None,
            crc_suspect: None,
            opening_damage: None,
            decoder,
            index: None,
            verified: None,
            phase: Phase::Reading,
            order: Order::Stored,
            trailers: Vec::new(),
            tally: None,
            settings_offset: section.settings_offset,
            scene_offset: section.scene_offset,
            image_offsets: section.image_offsets.clone(),
            padded: section.padded,
            last_offset: section.settings_offset,
            private: None,
        };
        if !index::read(&mut recording.records).map_err(Error::Read)?.is_in_order() {
            recording.order = Order::Surveyed(Parts::default());
        }
        recording.restart()?;
        Ok(recording)
    }

    /// Moves to the last keyframe at or before `step`, which is then the next item, or to the start if that is the
    /// first one, if there is none, or if the messages are not stored in order of time. Skipped data is not read, so
    /// [`Recording::health`] covers only the records before the messages and the rest.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn seek(&mut self, step: u64) -> Result<(), Error> {
        let index = self.take_index()?;
        if !matches!(self.order, Order::Stored) {
            self.index = Some(index);
            return self.restart();
        }
        let time = self.header.log_time(step);
        let mut is_found = false;
        // From the start, the end record is compared with everything before it.
        let candidates = (1..index.places.len()).rev().filter(|place| index.places[*place].first_time <= time);
        for place in candidates.filter(|place| index.may_begin(*place, Topic::Bodies)) {
            is_found = self.seek_keyframe(&index, place, step)?;
            if is_found {
                break;
            }
        }
        self.index = Some(index);
        if is_found { Ok(()) } else { self.restart() }
    }

    /// Searches the steps that begin at a place for a keyframe at or before `step`, and returns true if there is one,
    /// which is then the next item. Later places must have been searched before, so that each is read only once.
    fn seek_keyframe(&mut self, index: &Index, place: usize, step: u64) -> Result<bool, Error> {
        // A keyframe may begin in the chunk before, where the search then finds it whole.
        let continued = place.checked_sub(1).map(|previous| index.places[previous].last_time);
        let last_time = index.places[place].last_time;
        let later = index.places[place + 1..].iter().find(|later| later.first_time > last_time);
        let end = later.map_or(u64::MAX, |later| later.offset);
        self.open_place(index, place)?;
        while let Some(item) = self.next_before(end, last_time)? {
            match item {
                Item::Keyframe(keyframe) if keyframe.step <= step => {
                    if continued == Some(self.header.log_time(keyframe.step)) {
                        continue;
                    }
                    self.decoder.ready.push_front(Item::Keyframe(keyframe));
                    return Ok(true);
                }
                Item::State(state) | Item::SuspectState(state) if state.step < step => {}
                Item::Event(_) | Item::SceneUpdate { .. } | Item::Gap(_) => {}
                Item::Keyframe(_) | Item::State(_) | Item::SuspectState(_) => return Ok(false),
                Item::Damaged(_) | Item::Trailer(_) => return Ok(false),
            }
        }
        Ok(false)
    }

    /// Returns the next item, or `None` where all records before the offset `end` are read and the step at `last_time`
    /// (simulated nanoseconds), which may continue after it, is complete.
    fn next_before(&mut self, end: u64, last_time: u64) -> Result<Option<Item>, Error> {
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

    /// Returns the summary, or `None` if the recording is unfinished or has no usable summary section. Afterwards,
    /// reading restarts at the beginning of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn summary(&mut self) -> Result<Option<Summary>, Error> {
        self.read_index()?;
        Ok(self.index.as_ref().and_then(Index::summary))
    }

    /// Reads the index and the end record, so that [`Recording::health`] knows the declared gaps and the end before
    /// everything is read. Afterwards, reading restarts at the beginning of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn read_index(&mut self) -> Result<(), Error> {
        self.index = Some(self.take_index()?);
        self.restart()
    }

    /// Calls `visit` with every readable event, and with every readable keyframe if parts are missing or damaged: then
    /// the spawns of its bodies may be lost, and events before damage are visited twice. Opens only chunks that have
    /// events according to the index. Afterwards, reading restarts at the beginning of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn for_each_event(&mut self, mut visit: impl FnMut(Item)) -> Result<(), Error> {
        let index = self.take_index()?;
        let is_stored_in_order = matches!(self.order, Order::Stored);
        let mut is_indexed =
            is_stored_in_order && index.is_usable() && !index.has_loose_messages && self.header.gaps.is_empty();
        for place in (0..index.places.len()).filter(|place| index.may_contain(*place, Topic::Events)) {
            if !is_indexed {
                break;
            }
            self.open_place(&index, place)?;
            while let Some(item) = self.next_in_chunk() {
                if let Item::Event(_) = item {
                    visit(item);
                }
            }
            is_indexed = self.decoder.damage.is_none();
        }
        self.index = Some(index);
        self.restart()?;
        if !is_indexed {
            while let Some(item) = self.next().transpose()? {
                if let Item::Event(_) | Item::Keyframe(_) = item {
                    visit(item);
                }
            }
            self.restart()?;
        }
        Ok(())
    }

    /// Takes the index out of `self`, after reading it if necessary. The caller must put it back, and restart or move
    /// to a place.
    fn take_index(&mut self) -> Result<Index, Error> {
        if let Some(index) = self.index.take() {
            return Ok(index);
        }
        let index = index::read(&mut self.records).map_err(Error::Read)?;
        if index.is_doubtful {
            self.restart()?;
            while self.next().transpose()?.is_some() {}
            self.verified = Some(self.health());
        }
        Ok(index)
    }

    /// Moves to a place of the index and discards the state of everything read before.
    fn open_place(&mut self, index: &Index, place: usize) -> Result<(), Error> {
        self.seek_record(index.places[place].offset)?;
        self.decoder.reset(&index.definitions);
        let skipped = index.trailer_record.iter().filter(|(location, _)| location.offset < index.places[place].offset);
        self.trailers.extend(skipped.cloned());
        self.chunk_count = place as u64;
        self.next_record()
    }

    /// Returns the next event of the open chunk, or `None` at its end or at damage.
    fn next_in_chunk(&mut self) -> Option<Item> {
        while self.decoder.ready.is_empty() {
            if self.decoder.resume() {
                continue;
            }
            let Ok(Some(record)) = self.chunks.next_record() else { return None };
            self.decoder.decode_record(self.chunk, &record);
        }
        self.decoder.ready.pop_front()
    }

    /// Continues at `offset`, where a record starts.
    fn seek_record(&mut self, offset: u64) -> Result<(), Error> {
        self.chunks.close();
        self.data_end = None;
        self.crc_suspect = None;
        self.tally = None;
        self.trailers.clear();
        self.phase = Phase::Reading;
        self.records.seek(offset).map_err(Error::Read)
    }

    /// Returns to the start.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn restart(&mut self) -> Result<(), Error> {
        if let Order::ByTime(..) = self.order {
            self.order = Order::Surveyed(Parts::default());
        }
        self.seek_record(0)?;
        self.records.rewind().map_err(Error::Read)?;
        let section = header_section::read(&mut self.records)?;
        self.decoder = Decoder::new(&section.header);
        self.padded = section.padded;
        self.chunk_count = 0;
        self.continue_after(section)?;
        match self.order {
            Order::Stored => Ok(()),
            Order::Surveyed(_) | Order::ByTime(..) => self.survey(),
        }
    }

    /// Verifies everything except the contents of messages, which are then read in order of time.
    fn survey(&mut self) -> Result<(), Error> {
        while self.phase == Phase::Reading {
            self.next_stored()?;
        }
        let Order::Surveyed(parts) = std::mem::replace(&mut self.order, Order::Stored) else { return Ok(()) };
        if parts.are_in_order() {
            return self.restart(); // Only the index or a chunk header claims another order.
        }
        let end = std::mem::replace(&mut self.phase, Phase::Reading);
        self.order = Order::ByTime(Merge::new(parts), end);
        Ok(())
    }

    /// Continues after the header section.
    fn continue_after(&mut self, section: HeaderSection) -> Result<(), Error> {
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

    /// Returns the condition of the part read so far; final once the iterator has ended. Before that, the end and the
    /// gaps are those that the metadata declare, if a seek has read the index; if that is doubtful, the condition is
    /// that of the entire file.
    pub fn health(&self) -> Health {
        if let Some(verified) = &self.verified {
            return verified.clone();
        }
        let validator = &self.decoder.validator;
        let index = self.index.as_ref();
        let mut found = validator.found_gaps().to_vec();
        let (trailer, after) = match (self.phase, index) {
            (Phase::Reading, Some(index)) => {
                found.extend(validator.open_gap());
                (index.trailer.as_ref(), index.trailer.as_ref().map(|trailer| trailer.steps))
            }
            _ => (self.decoder.trailer.as_ref(), validator.last_usable_step()),
        };
        let missing = self.missing(trailer, after, found);
        match self.opening_damage.as_ref().or(self.decoder.damage.as_ref()) {
            Some(damage) => Health::Corrupt { damage: damage.clone(), missing },
            None if missing.is_empty() => Health::Whole,
            None => Health::Incomplete(missing),
        }
    }

    /// Returns the parts that are missing in a recording with this end record, last state and gaps.
    fn missing(&self, trailer: Option<&Trailer>, after: Option<u64>, found: Vec<Gap>) -> Missing {
        let last = match trailer {
            None => self.header.steps,
            Some(Trailer { error: Some(_), steps, .. }) => *steps,
            Some(trailer) => trailer.steps.max(self.header.steps),
        };
        let is_cut = trailer.is_none() || self.phase == Phase::Truncated;
        let is_ended = !is_cut && after.is_some_and(|after| after >= last);
        let end = (!is_ended).then_some(MissingEnd { after, last, is_cut });
        // The end begins within a declared gap if no keyframe follows that.
        let end_begins = end.and_then(|end| end.after).map_or(u64::MAX, |after| after.saturating_add(1));
        let declared = self.header.gaps.iter().copied().filter(|gap| gap.first_missing() < end_begins);
        Missing {
            gaps: Gap::merged(found.into_iter().chain(declared).collect()),
            end,
            scene: self.header.scene.is_none(),
            keyframes: self.decoder.validator.lacks_keyframes(),
            images: self
                .header
                .images
                .iter()
                .filter(|image| image.png.is_none())
                .map(|image| image.name.clone())
                .collect(),
            recovered: trailer.is_some_and(|trailer| trailer.recovered),
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
            if self.decoder.resume() {
                continue;
            }
            match &mut self.order {
                Order::Stored | Order::Surveyed(_) => self.next_stored()?,
                Order::ByTime(merge, end) => match merge.next_message(self.records.source())? {
                    Some((location, message)) => self.decoder.decode_record(location, &message),
                    None => {
                        self.phase = *end;
                        self.finish();
                    }
                },
            }
        }
        Ok(())
    }

    /// Reads the next record as it is stored.
    fn next_stored(&mut self) -> Result<(), Error> {
        match self.chunks.next_record() {
            Ok(Some(record)) => {
                self.tally.iter_mut().for_each(|tally| tally.add_record(&record));
                let is_skipped = matches!(self.order, Order::Surveyed(_)) && record.opcode == op::MESSAGE;
                if !is_skipped {
                    self.decoder.decode_record(self.chunk, &record);
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
                self.decoder.padded = None;
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
    fn finish(&mut self) {
        self.close_step();
        if let Order::Surveyed(_) = self.order {
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
        if let (Order::Surveyed(parts), Some(times)) = (&mut self.order, self.chunks.times()) {
            parts.add_chunk(self.chunk, times);
        }
        if let (Some(chunk), Some(tally)) = (self.chunks.close(), &mut self.tally) {
            tally.add_chunk(&chunk);
        }
    }

    fn read_record(&mut self, RecordHeader { offset, opcode }: RecordHeader) -> Result<(), Error> {
        let location = Location { chunk: None, offset };
        let last_offset = std::mem::replace(&mut self.last_offset, offset);
        if opcode >= 0x80 {
            self.padded = self.padded.or(Some(offset));
            self.private = self.private.or(Some(offset));
            return Ok(()); // A private record of another program, or one with a damaged opcode.
        }
        let private = self.private;
        if !matches!(opcode, op::SCHEMA | op::CHANNEL) {
            self.private = None;
        }
        self.decoder.padded = self.padded.take();
        self.padded = has_unknown_fields(opcode, &self.records.body).then_some(offset);
        if opcode == op::MESSAGE_INDEX {
            if let Err(reason) = self.chunks.check_message_index(offset, &self.records.body) {
                // Without a chunk, the record before is a chunk whose opcode is damaged.
                let damaged = if self.chunks.is_open() { offset } else { last_offset };
                self.decoder.report_damage(Location { offset: damaged, ..self.chunk }, reason);
                return self.resume_after(offset);
            }
            return Ok(());
        }
        self.close_chunk();
        let body = &self.records.body;
        match opcode {
            op::CHUNK => return self.open_chunk(offset),
            op::MESSAGE | op::SCHEMA | op::CHANNEL => {
                let record = ChunkRecord { opcode, body };
                self.tally.iter_mut().for_each(|tally| tally.add_record(&record));
                match (&mut self.order, record.message()) {
                    (Order::Surveyed(parts), Some(message)) => parts.add_message(offset, message.log_time)?,
                    _ => self.decoder.decode_record(location, &record),
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
                if let Err(reason) = self.check_attachment(offset) {
                    self.decoder.report_damage(location, reason);
                }
            }
            op::DATA_END => {
                self.finish();
                self.decoder.padded = None;
                self.data_end = Some(offset);
                let end = offset + (PREFIX_BYTES + self.records.body.len()) as u64;
                self.tally.iter_mut().for_each(|tally| tally.end_data(end));
            }
            other => {
                let location = Location { chunk: None, offset: private.unwrap_or(offset) };
                self.decoder.mark_lost(location, format!("a record with opcode {other:#04x} is not allowed here"));
                return self.resume_after(self.decoder.padded.unwrap_or(offset));
            }
        }
        Ok(())
    }

    /// Returns an error for a damaged attachment, and for a second one with the scene or with the same image. Other
    /// programs may attach other TOML.
    fn check_attachment(&self, offset: u64) -> Result<(), String> {
        match parse_attachment(&self.records.body)? {
            Attached::Scene(_) if self.scene_offset == Some(offset) => Ok(()),
            Attached::Scene(found) => match &self.header.scene {
                Some(scene) if metadata::describes_scene(&self.header) && found.as_ref() != Ok(scene) => Ok(()),
                Some(_) | None => found.and(Err(SECOND_SCENE.into())),
            },
            Attached::Image(name, _)
                if !self.image_offsets.contains(&offset)
                    && self.header.images.iter().any(|image| image.name == name) =>
            {
                Err(format!("another attachment with the image {name:?}"))
            }
            Attached::Image(..) | Attached::Other => Ok(()),
        }
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
        if let Order::Surveyed(parts) = &mut self.order {
            parts.interrupt();
        }
    }

    /// Continues at the next valid record after a fault.
    fn recover_from(&mut self, mut fault: ReadFault) -> Result<(), Error> {
        self.close_step();
        self.tally = None;
        // The length of the record before may be damaged.
        fault.offset = self.padded.take().unwrap_or(fault.offset);
        if let McapError::Io(error) = fault.error {
            return Err(Error::Read(error));
        }
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
