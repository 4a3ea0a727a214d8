use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
};

use mcap::{MAGIC, McapError, records::op};

use super::{
    BodyTable, Damage, End, Error, Gap, Header, Health, Keyframe, RecordedEvent, RecordedState,
    chunk::Chunks,
    clock,
    course::Course,
    head::{self, Fault, Head},
    inbox::{Inbox, Locus},
    index::Index,
    records::{Broken, Place, Records},
    resync::{self, Remedy},
    topic::Topic,
};

/// A recording being read from its start: an iterator of [`Item`]s in file order.
///
/// Memory is that of one chunk. After the last item [`Recording::health`] is final.
pub struct Recording<R> {
    /// What the recording starts with.
    pub header: Header,
    pub(super) records: Records<R>,
    chunks: Chunks,
    /// The chunk being read or the last one.
    chunk: Locus,
    chunk_count: u64,
    data_end: Option<u64>,
    suspect: Option<Fault>,
    inbox: Inbox,
    /// Where the chunks are, once that was asked for.
    pub(super) index: Option<Index>,
    progress: Progress,
}

/// One thing in a recording.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Something was done to the world.
    Event(RecordedEvent),
    /// Everything about a step.
    Keyframe(Keyframe),
    /// The state of a step.
    State(RecordedState),
    /// A state whose numbers do not fit its own digest: to be compared, not to be shown.
    Doubtful(RecordedState),
    /// What viewers draw of the state that comes next: it is passed on, not read.
    View {
        /// Simulated nanoseconds.
        time: u64,
        /// A `foxglove.SceneUpdate`.
        message: Vec<u8>,
    },
    /// Something could not be read here; events may be missing until the next keyframe.
    Damaged(Damage),
    /// Here a recovered recording has a gap; events are missing until the next keyframe.
    Gap(Gap),
    /// How the run ended.
    End(End),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progress {
    Reading,
    /// The file ends too early.
    Cut,
    /// There is nothing more to read.
    Done,
}

/// Opens the recording at `path`.
///
/// # Errors
/// If it cannot be opened, is no recording, or is newer than this program.
pub fn open(path: &Path) -> Result<Recording<BufReader<File>>, Error> {
    let file = File::open(path).map_err(|source| Error::Open { path: path.into(), source })?;
    Recording::read(BufReader::new(file))
}

impl<R: Read + Seek> Recording<R> {
    /// Reads the head of a recording.
    ///
    /// # Errors
    /// If it is no recording or newer than this program.
    pub fn read(read: R) -> Result<Recording<R>, Error> {
        let mut records = Records::new(read);
        let head = head::read(&mut records)?;
        let inbox = Inbox::new(Course::new(&head.header, head.has_scene), head.header.versions.format);
        let mut recording = Recording {
            header: head.header.clone(),
            records,
            chunks: Chunks::new(),
            chunk: Locus { chunk: None, offset: 0 },
            chunk_count: 0,
            data_end: None,
            suspect: None,
            inbox,
            index: None,
            progress: Progress::Reading,
        };
        recording.behind(head)?;
        Ok(recording)
    }

    /// Goes to the last keyframe at or before `step`, which is then the next item; to the
    /// start if there is none. Nothing before it is read, so [`Recording::health`] tells
    /// of the rest only.
    ///
    /// # Errors
    /// If the system cannot read.
    pub fn seek(&mut self, step: u64) -> Result<(), Error> {
        let index = self.take_index()?;
        let time = clock::nanoseconds(step, self.header.settings.rate);
        let after = index.chunks.partition_point(|chunk| chunk.first_time <= time);
        let mut found = false;
        for place in (0..after).rev().filter(|place| index.has(*place, Topic::Bodies)) {
            found = self.seek_keyframe(&index, place, step)?;
            if found {
                break;
            }
        }
        self.index = Some(index);
        if found { Ok(()) } else { self.restart() }
    }

    /// Whether the chunk has a keyframe at or before `step`; if so, that is the next item.
    fn seek_keyframe(&mut self, index: &Index, place: usize, step: u64) -> Result<bool, Error> {
        self.go_to_chunk(index, place)?;
        while let Some(item) = self.next_of_chunk() {
            match item {
                Item::Keyframe(keyframe) if keyframe.step <= step => {
                    self.inbox.ready.push_front(Item::Keyframe(keyframe));
                    return Ok(true);
                }
                Item::Keyframe(_) | Item::Damaged(_) => return Ok(false),
                Item::Event(_) | Item::State(_) | Item::Doubtful(_) => {}
                Item::View { .. } | Item::Gap(_) | Item::End(_) => {}
            }
        }
        Ok(false)
    }

    /// Opens the chunk, as if nothing stood before it.
    pub(super) fn go_to_chunk(&mut self, index: &Index, place: usize) -> Result<(), Error> {
        self.go_to(index.chunks[place].offset)?;
        self.inbox.jump(&index.channels);
        self.chunk_count = place as u64;
        self.next_record()
    }

    /// The next thing in the open chunk; none where that ends or cannot be read on.
    pub(super) fn next_of_chunk(&mut self) -> Option<Item> {
        while self.inbox.ready.is_empty() {
            let Ok(Some(record)) = self.chunks.next() else { return None };
            self.inbox.chunk_record(self.chunk, &record);
        }
        self.inbox.ready.pop_front()
    }

    /// Reads on at `offset`, where a record starts.
    fn go_to(&mut self, offset: u64) -> Result<(), Error> {
        self.chunks.close();
        self.data_end = None;
        self.suspect = None;
        self.progress = Progress::Reading;
        self.records.seek(offset).map_err(Error::Read)
    }

    /// Goes to the start.
    ///
    /// # Errors
    /// If the system cannot read.
    pub fn restart(&mut self) -> Result<(), Error> {
        self.go_to(0)?;
        self.records.rewind().map_err(Error::Read)?;
        let head = head::read(&mut self.records)?;
        self.inbox.jump(&[]);
        self.inbox.course = Course::new(&head.header, head.has_scene);
        self.chunk_count = 0;
        self.behind(head)
    }

    /// Goes on behind the head.
    fn behind(&mut self, head: Head) -> Result<(), Error> {
        self.suspect = head.suspect;
        for Fault { offset, what } in head.faults {
            self.inbox.note(Locus { chunk: None, offset }, what);
        }
        head.pending.map_or(Ok(()), |place| self.record(place))
    }

    /// What reading has shown so far; final once the iterator has ended.
    pub fn health(&self) -> Health {
        match (&self.inbox.damage, self.progress, &self.inbox.end) {
            (Some(damage), _, _) => Health::Corrupt(damage.clone()),
            (None, Progress::Done, Some(_)) => Health::Whole,
            (None, _, _) => Health::Truncated { after: self.inbox.course.last_step() },
        }
    }

    /// The bodies alive after the last item; unknown between damage and the next keyframe.
    pub fn table(&self) -> Option<&BodyTable> {
        self.inbox.course.table()
    }

    /// How the run ended, once that has been read.
    pub fn end(&self) -> Option<&End> {
        self.inbox.end.as_ref()
    }

    /// The number of chunks met so far.
    pub fn chunks(&self) -> u64 {
        self.chunk_count
    }

    /// Goes on until something is ready or nothing more comes.
    fn advance(&mut self) -> Result<(), Error> {
        while self.inbox.ready.is_empty() && self.progress == Progress::Reading {
            match self.chunks.next() {
                Ok(Some(record)) => self.inbox.chunk_record(self.chunk, &record),
                Ok(None) => self.next_record()?,
                Err(what) => self.inbox.lose(self.chunk, what),
            }
        }
        Ok(())
    }

    fn next_record(&mut self) -> Result<(), Error> {
        match self.records.advance() {
            Ok(Some(place)) if self.data_end.is_none() => self.record(place)?,
            Ok(Some(_)) => {} // Nothing but copies and the index: its checksum is enough.
            Ok(None) => self.progress = Progress::Done,
            Err(broken) => self.mend(broken)?,
        }
        Ok(())
    }

    fn record(&mut self, Place { offset, opcode }: Place) -> Result<(), Error> {
        let body = &self.records.body;
        let outside = Locus { chunk: None, offset };
        match opcode {
            op::CHUNK => return self.open_chunk(offset),
            op::MESSAGE_INDEX => {
                if let Err(what) = self.chunks.check_index(body) {
                    self.inbox.note(Locus { offset, ..self.chunk }, what);
                    return self.resume_after(offset);
                }
            }
            op::METADATA => self.inbox.metadata(outside, body),
            op::ATTACHMENT => {}
            op::DATA_END => self.data_end = Some(offset),
            other => {
                self.inbox.lose(outside, format!("a record of kind {other:#04x} does not belong here"));
                return self.resume_after(offset);
            }
        }
        Ok(())
    }

    fn open_chunk(&mut self, offset: u64) -> Result<(), Error> {
        self.chunk_count += 1;
        self.chunk = Locus { chunk: Some(self.chunk_count), offset };
        match self.chunks.open(&self.records.body) {
            Ok(()) => Ok(()),
            Err(what) => {
                self.inbox.lose(self.chunk, what);
                self.resume_after(offset)
            }
        }
    }

    fn resume_after(&mut self, offset: u64) -> Result<(), Error> {
        self.chunks.close();
        self.records.resume_after(offset).map_err(Error::Read)
    }

    /// Goes on at the next record that is one, after one that is not.
    fn mend(&mut self, broken: Broken) -> Result<(), Error> {
        self.chunks.close();
        if let McapError::Io(error) = broken.why {
            return Err(Error::Read(error));
        }
        let remedy = match self.data_end {
            Some(_) => resync::hopeless(self.records.read(), &broken),
            None => resync::remedy(self.records.read(), &broken),
        };
        let Fault { offset, what } = self.blame(broken);
        let locus = Locus { chunk: None, offset };
        match remedy.map_err(Error::Read)? {
            Remedy::GoOn(next) => {
                self.inbox.lose(locus, what);
                self.records.seek(next).map_err(Error::Read)?;
            }
            Remedy::Cut => self.progress = Progress::Cut,
            Remedy::None => {
                self.inbox.note(locus, what);
                self.progress = Progress::Done;
            }
        }
        Ok(())
    }

    /// Where the fault lies: what no checksum of its own guards is only known by section.
    fn blame(&self, Broken { offset, why }: Broken) -> Fault {
        let section =
            |what: &str, from: u64| Fault { offset: from, what: format!("{what}, up to byte {offset}: {why}") };
        match (&why, self.data_end, &self.suspect) {
            (McapError::BadDataCrc { .. }, _, Some(fault)) => fault.clone(),
            (McapError::BadDataCrc { .. }, _, None) => section("somewhere between the chunks", MAGIC.len() as u64),
            (_, Some(data_end), _) => section("somewhere in the index", data_end),
            (_, None, _) => Fault { offset, what: why.to_string() },
        }
    }
}

impl<R: Read + Seek> Iterator for Recording<R> {
    type Item = Result<Item, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.advance() {
            Ok(()) => self.inbox.ready.pop_front().map(Ok),
            Err(error) => {
                self.progress = Progress::Cut;
                Some(Err(error))
            }
        }
    }
}
