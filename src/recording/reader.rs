use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
};

use mcap::{McapError, records::op};

use super::{
    BodyTable, Damage, End, Error, Header, Health, Keyframe, RecordedEvent, RecordedState, SceneText,
    chunk::Chunk,
    fields::{Fields, Malformed},
    inbox::{Inbox, Locus},
    metadata,
    records::{Broken, Place, Records},
    resync,
};

/// A recording being read from its start: an iterator of [`Item`]s in file order.
///
/// Memory is that of one chunk. After the last item [`Recording::health`] is final.
pub struct Recording<R> {
    /// What the recording starts with.
    pub header: Header,
    records: Records<R>,
    chunk: Option<OpenChunk>,
    chunks: u64,
    in_summary: bool,
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

struct OpenChunk {
    locus: Locus,
    chunk: Chunk,
    exhausted: bool,
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
        let header = read_header(&mut records)?;
        let inbox = Inbox::new(&header);
        Ok(Recording { header, records, chunk: None, chunks: 0, in_summary: false, inbox, progress: Progress::Reading })
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
        self.chunks
    }

    /// Goes on until something is ready or nothing more comes.
    fn advance(&mut self) -> Result<(), Error> {
        while self.inbox.ready.is_empty() && self.progress == Progress::Reading {
            match &mut self.chunk {
                Some(open) if !open.exhausted => open.next(&mut self.inbox),
                Some(_) | None => self.next_record()?,
            }
        }
        Ok(())
    }

    fn next_record(&mut self) -> Result<(), Error> {
        match self.records.advance() {
            Ok(Some(place)) if !self.in_summary => self.record(place),
            Ok(Some(_)) => {} // Nothing but copies and the index: its checksum is enough.
            Ok(None) => self.progress = Progress::Done,
            Err(broken) => self.mend(broken)?,
        }
        Ok(())
    }

    fn record(&mut self, Place { offset, opcode }: Place) {
        let body = &self.records.body;
        let outside = Locus { chunk: None, offset };
        match opcode {
            op::CHUNK => self.open_chunk(offset),
            op::MESSAGE_INDEX => {
                let checked = self.chunk.as_ref().map_or(Ok(()), |open| open.chunk.check_index(body));
                if let Err(what) = checked {
                    self.inbox.note(Locus { chunk: Some(self.chunks), offset }, what);
                }
            }
            op::METADATA => self.inbox.metadata(outside, body),
            op::ATTACHMENT => {}
            op::DATA_END => self.in_summary = true,
            other => self.inbox.lose(outside, format!("a record of kind {other:#04x} does not belong here")),
        }
    }

    fn open_chunk(&mut self, offset: u64) {
        self.chunks += 1;
        let locus = Locus { chunk: Some(self.chunks), offset };
        self.chunk = match Chunk::open(&self.records.body) {
            Ok(chunk) => Some(OpenChunk { locus, chunk, exhausted: false }),
            Err(what) => {
                self.inbox.lose(locus, what);
                None
            }
        };
    }

    /// Goes on at the next record that is one, after one that is not.
    fn mend(&mut self, Broken { offset, why }: Broken) -> Result<(), Error> {
        self.chunk = None;
        let read = self.records.read();
        let cut = match why {
            McapError::Io(error) => return Err(Error::Read(error)),
            McapError::UnexpectedEof => !resync::ends_as_mcap(read).map_err(Error::Read)?,
            _ => false,
        };
        let next = match self.in_summary {
            true => None,
            false => resync::next_record(read, offset + 1).map_err(Error::Read)?,
        };
        let locus = Locus { chunk: None, offset };
        match next {
            Some(next) => {
                self.inbox.lose(locus, why.to_string());
                self.records.seek(next).map_err(Error::Read)?;
            }
            None if cut => self.progress = Progress::Cut,
            None => {
                self.inbox.note(locus, why.to_string());
                self.progress = Progress::Done;
            }
        }
        Ok(())
    }
}

impl OpenChunk {
    fn next(&mut self, inbox: &mut Inbox) {
        match self.chunk.next() {
            Ok(Some(record)) => inbox.chunk_record(self.locus, &record),
            Ok(None) => self.exhausted = true,
            Err(what) => {
                self.exhausted = true;
                inbox.lose(self.locus, what);
            }
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

/// Reads up to the scene's text.
fn read_header<R: Read + Seek>(records: &mut Records<R>) -> Result<Header, Error> {
    let mut start = None;
    let damaged = |what: &str| Error::NotARecording { what: what.into() };
    while let Some(place) = records.advance().map_err(head_error)? {
        let mut fields = Fields::new(&records.body);
        match place.opcode {
            op::METADATA => {
                let name = fields.text().map_err(|Malformed| damaged("its metadata is damaged"))?;
                if name == metadata::START {
                    start = Some(fields.map().map_err(|Malformed| damaged("its metadata is damaged"))?);
                }
            }
            op::ATTACHMENT => {
                let start = start.ok_or_else(|| damaged("it has no metadata \"rebond\""))?;
                let scene = scene(fields).map_err(|Malformed| damaged("the scene's text is damaged"))?;
                return metadata::header(&start, scene);
            }
            op::CHUNK | op::DATA_END => break,
            _ => {}
        }
    }
    Err(damaged("it has no metadata \"rebond\" or no scene at its start"))
}

fn scene(mut fields: Fields<'_>) -> Result<SceneText, Malformed> {
    let _log_time = fields.u64()?;
    let _create_time = fields.u64()?;
    let file_name = fields.text()?.into();
    let _media_type = fields.text()?;
    let length = fields.u64()?;
    let text = str::from_utf8(fields.bytes(length)?).map_err(|_| Malformed)?.into();
    Ok(SceneText { file_name, text })
}

fn head_error(Broken { offset, why }: Broken) -> Error {
    match why {
        McapError::Io(error) => Error::Read(error),
        McapError::BadMagic => Error::NotARecording { what: "it does not start as an MCAP file".into() },
        other => Error::NotARecording { what: format!("its record at byte {offset} cannot be read: {other}") },
    }
}
