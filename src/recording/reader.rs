use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
    sync::Arc,
};

use super::{
    BodyTable, Damage, Error, Gap, Header, Health, Keyframe, Missing, MissingEnd, RecordedEvent, RecordedState,
    Trailer,
    index::{self, Index, Summary},
    item_reader::{ItemReader, Phase},
    merge::{Merge, Parts},
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
    items: ItemReader<R>,
    index: Arc<Index>,
    known: KnownEnd,
    order: Order,
}

/// The knowledge of parts of the file before they are read.
enum KnownEnd {
    /// Nothing.
    Unknown,
    /// The gaps and the end are those that the metadata declare and the index contains.
    Declared,
    /// The index is doubtful, so the entire file was read first: its condition.
    Verified(Health),
}

/// The order in which the file is read.
enum Order {
    /// The messages are read as they are stored, in order of time.
    Stored,
    /// The messages are stored in another order: the file is verified first, and then the messages are read in order
    /// of time. Holds the end of the first pass.
    ByTime(Option<(Merge, Phase)>),
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
        let mut items = ItemReader::new(source)?;
        let index = index::read(&mut items.records).map_err(Error::Read)?;
        let order = if index.is_in_order() { Order::Stored } else { Order::ByTime(None) };
        let header = items.header().clone();
        let mut recording = Recording { header, items, index: Arc::new(index), known: KnownEnd::Unknown, order };
        recording.restart()?;
        Ok(recording)
    }

    /// Returns to the start.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn restart(&mut self) -> Result<(), Error> {
        match self.order {
            Order::Stored => self.items.restart(),
            Order::ByTime(_) => self.survey(),
        }
    }

    /// Verifies everything except the contents of messages, which are then read in order of time.
    fn survey(&mut self) -> Result<(), Error> {
        self.items.survey = Some(Parts::default());
        self.items.restart()?;
        while self.items.phase == Phase::Reading {
            self.items.next_stored()?;
        }
        let parts = self.items.survey.take().unwrap_or_default();
        if parts.are_in_order() {
            self.order = Order::Stored; // Only the index or a chunk header claims another order.
            return self.items.restart();
        }
        let end = std::mem::replace(&mut self.items.phase, Phase::Reading);
        self.order = Order::ByTime(Some((Merge::new(parts), end)));
        Ok(())
    }

    /// Reads until an item is ready or the file ends.
    fn advance(&mut self) -> Result<(), Error> {
        let items = &mut self.items;
        while items.decoder.ready.is_empty() && items.phase == Phase::Reading {
            if items.decoder.resume() {
                continue;
            }
            match &mut self.order {
                Order::Stored | Order::ByTime(None) => items.next_stored()?,
                Order::ByTime(Some((merge, end))) => match merge.next_message(items.records.source())? {
                    Some((location, message)) => {
                        // The merge has found where its records end.
                        let _ = items.decoder.decode_record(location, &message);
                    }
                    None => {
                        items.phase = *end;
                        items.finish();
                    }
                },
            }
        }
        Ok(())
    }

    /// Moves to the last keyframe at or before `step`, which is then the next item, or to the start if that is the
    /// first one, if there is none, or if the messages are not stored in order of time. Skipped data is not read, so
    /// [`Recording::health`] covers only the records before the messages and the rest.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn seek(&mut self, step: u64) -> Result<(), Error> {
        let index = self.use_index()?;
        if let Order::ByTime(_) = self.order {
            return self.restart();
        }
        let time = self.header.log_time(step);
        // From the start, the end record is compared with everything before it.
        let candidates = (1..index.places.len()).rev().filter(|place| index.places[*place].first_time <= time);
        for place in candidates.filter(|place| index.may_begin(*place, Topic::Bodies)) {
            if self.seek_keyframe(&index, place, step)? {
                return Ok(());
            }
        }
        self.restart()
    }

    /// Searches the steps that begin at a place for a keyframe at or before `step`, and returns true if there is one,
    /// which is then the next item. Later places must have been searched before, so that each is read only once.
    fn seek_keyframe(&mut self, index: &Index, place: usize, step: u64) -> Result<bool, Error> {
        // A keyframe may begin in the chunk before, where the search then finds it whole.
        let continued = place.checked_sub(1).map(|previous| index.places[previous].last_time);
        let last_time = index.places[place].last_time;
        let later = index.places[place + 1..].iter().find(|later| later.first_time > last_time);
        let end = later.map_or(u64::MAX, |later| later.offset);
        self.items.open_place(index, place)?;
        while let Some(item) = self.items.next_before(end, last_time)? {
            match item {
                Item::Keyframe(keyframe) if keyframe.step <= step => {
                    if continued == Some(self.header.log_time(keyframe.step)) {
                        continue;
                    }
                    self.items.decoder.ready.push_front(Item::Keyframe(keyframe));
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

    /// Returns the summary, or `None` if the recording is unfinished or has no usable summary section. Afterwards,
    /// reading restarts at the beginning of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn summary(&mut self) -> Result<Option<Summary>, Error> {
        self.read_index()?;
        Ok(self.index.summary())
    }

    /// Reads the end record, so that [`Recording::health`] knows the declared gaps and the end before everything is
    /// read. Afterwards, reading restarts at the beginning of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn read_index(&mut self) -> Result<(), Error> {
        self.use_index()?;
        self.restart()
    }

    /// Calls `visit` with every readable event, and with every readable keyframe if parts are missing or damaged: then
    /// the spawns of its bodies may be lost, and events before damage are visited twice. Opens only chunks that have
    /// events according to the index. Afterwards, reading restarts at the beginning of the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn for_each_event(&mut self, mut visit: impl FnMut(Item)) -> Result<(), Error> {
        let index = self.use_index()?;
        let is_stored_in_order = matches!(self.order, Order::Stored);
        let mut is_indexed =
            is_stored_in_order && index.is_usable() && !index.has_loose_messages && self.header.gaps.is_empty();
        for place in (0..index.places.len()).filter(|place| index.may_contain(*place, Topic::Events)) {
            if !is_indexed {
                break;
            }
            self.items.open_place(&index, place)?;
            while let Some(item) = self.items.next_in_chunk() {
                if let Item::Event(_) = item {
                    visit(item);
                }
            }
            is_indexed = self.items.decoder.damage.is_none();
        }
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

    /// Returns the index, after reading everything if that is doubtful. The caller must then restart or move to a place.
    fn use_index(&mut self) -> Result<Arc<Index>, Error> {
        if let KnownEnd::Unknown = self.known {
            self.known = if self.index.is_doubtful {
                self.restart()?;
                while self.next().transpose()?.is_some() {}
                KnownEnd::Verified(self.health())
            } else {
                KnownEnd::Declared
            };
        }
        Ok(self.index.clone())
    }

    /// Returns the condition of the part read so far; final once the iterator has ended. Before that, the end and the
    /// gaps are those that the metadata declare, if a seek has read the index; if that is doubtful, the condition is
    /// that of the entire file.
    pub fn health(&self) -> Health {
        let ItemReader { decoder, phase, opening_damage, .. } = &self.items;
        let mut found = decoder.validator.found_gaps().to_vec();
        let (trailer, after) = match (&self.known, phase) {
            (KnownEnd::Verified(health), _) => return health.clone(),
            (KnownEnd::Declared, Phase::Reading) => {
                found.extend(decoder.validator.open_gap());
                let trailer = self.index.trailer.as_ref();
                (trailer, trailer.map(|trailer| trailer.steps))
            }
            _ => (decoder.trailer.as_ref(), decoder.validator.last_usable_step()),
        };
        let missing = self.missing(trailer, after, found);
        match opening_damage.as_ref().or(decoder.damage.as_ref()) {
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
        let is_cut = trailer.is_none() || self.items.phase == Phase::Truncated;
        let is_ended = !is_cut && after.is_some_and(|after| after >= last);
        let end = (!is_ended).then_some(MissingEnd { after, last, is_cut });
        // The end begins within a declared gap if no keyframe follows that.
        let end_begins = end.and_then(|end| end.after).map_or(u64::MAX, |after| after.saturating_add(1));
        let declared = self.header.gaps.iter().copied().filter(|gap| gap.first_missing() < end_begins);
        Missing {
            gaps: Gap::merged(found.into_iter().chain(declared).collect()),
            end,
            scene: self.header.scene.is_none(),
            keyframes: self.items.decoder.validator.lacks_keyframes(),
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
        self.items.decoder.validator.table()
    }

    /// The end record, once it was read.
    pub fn trailer(&self) -> Option<&Trailer> {
        self.items.decoder.trailer.as_ref()
    }

    /// The number of chunks up to and including the current one, skipped ones included.
    pub fn chunk_count(&self) -> u64 {
        self.items.chunk_count
    }
}

impl<R: Read + Seek> Iterator for Recording<R> {
    type Item = Result<Item, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.advance() {
            Ok(()) => self.items.decoder.ready.pop_front().map(Ok),
            Err(error) => {
                self.items.phase = Phase::Truncated;
                Some(Err(error))
            }
        }
    }
}
