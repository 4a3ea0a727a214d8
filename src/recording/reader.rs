use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
};

use mcap::{MAGIC, McapError, records::op};

use super::{
    BodyTable, Damage, End, Error, Header, Health, Keyframe, RecordedEvent, RecordedState,
    chunk::Chunks,
    course::Course,
    head::{self, Fault, Head},
    inbox::{Inbox, Locus},
    records::{Broken, Place, Records},
    resync::{self, Remedy},
};

/// A recording being read from its start: an iterator of [`Item`]s in file order.
///
/// Memory is that of one chunk. After the last item [`Recording::health`] is final.
pub struct Recording<R> {
    /// What the recording starts with.
    pub header: Header,
    records: Records<R>,
    chunks: Chunks,
    /// The chunk being read or the last one.
    chunk: Locus,
    chunk_count: u64,
    data_end: Option<u64>,
    suspect: Option<Fault>,
    inbox: Inbox,
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
    /// Something could not be read here; events may be missing until the next keyframe.
    Damaged(Damage),
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
        let Head { header, has_scene, pending, faults, suspect } = head::read(&mut records)?;
        let mut inbox = Inbox::new(Course::new(&header, has_scene));
        for Fault { offset, what } in faults {
            inbox.note(Locus { chunk: None, offset }, what);
        }
        let mut recording = Recording {
            header,
            records,
            chunks: Chunks::new(),
            chunk: Locus { chunk: None, offset: 0 },
            chunk_count: 0,
            data_end: None,
            suspect,
            inbox,
            progress: Progress::Reading,
        };
        if let Some(place) = pending {
            recording.record(place)?;
        }
        Ok(recording)
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
