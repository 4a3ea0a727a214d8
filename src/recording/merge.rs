use std::io::{self, Read, Seek, SeekFrom};

use mcap::records::op;

use super::{
    Error,
    chunk_reader::{ChunkReader, ChunkRecord, RawMessage},
    decoder::Location,
    limits,
    record_reader::PREFIX_BYTES,
};

/// The parts of a file whose messages are not stored in order of time, for example because each topic has chunks of its
/// own.
#[derive(Default)]
pub struct Parts {
    parts: Vec<Part>,
    /// True if the next message follows data that is not readable.
    is_interrupted: bool,
}

/// A chunk, or consecutive messages outside of chunks that are in order of time.
#[derive(Clone, Copy)]
struct Part {
    /// The location of the chunk or of the first message.
    location: Location,
    /// The offset of the chunk or of the last message.
    last_offset: u64,
    /// The time of the first message, in simulated nanoseconds.
    first_time: u64,
    /// The time of the last message, in simulated nanoseconds.
    last_time: u64,
}

impl Parts {
    /// Adds a chunk with the times of its first and last message.
    pub fn add_chunk(&mut self, location: Location, [first_time, last_time]: [u64; 2]) {
        self.parts.push(Part { location, last_offset: location.offset, first_time, last_time });
    }

    /// Notes that the next record does not follow the last one directly: data between them is not readable.
    pub fn interrupt(&mut self) {
        self.is_interrupted = true;
    }

    /// Adds a message outside of chunks.
    ///
    /// # Errors
    /// Returns an error if the messages have too many parts.
    pub fn add_message(&mut self, offset: u64, time: u64) -> Result<(), Error> {
        /// More than 2 MB of parts.
        const MANY: usize = 1 << 16;
        if let Some(last) = self.parts.last_mut()
            && !std::mem::take(&mut self.is_interrupted)
            && last.location.chunk.is_none()
            && last.last_time <= time
        {
            (last.last_offset, last.last_time) = (offset, time);
            return Ok(());
        }
        if self.parts.len() >= MANY {
            return Err(Error::Unsorted);
        }
        self.add_chunk(Location { chunk: None, offset }, [time; 2]);
        Ok(())
    }

    /// Returns true if the parts are in order of time as they are stored.
    pub fn are_in_order(&self) -> bool {
        self.parts.windows(2).all(|pair| pair[0].last_time <= pair[1].first_time)
    }
}

/// Reads the messages of a file in order of time; those of the same time in the order in which they are stored.
///
/// Only the parts that overlap in time are open together.
pub struct Merge {
    /// The parts that were not opened yet, the first one last.
    waiting: Vec<Part>,
    open: Vec<OpenPart>,
    /// The current message.
    body: Vec<u8>,
}

/// A part that is being read.
struct OpenPart {
    part: Part,
    source: PartSource,
    /// The offset of the next message, or of its chunk.
    offset: u64,
    /// The time of the next message, in simulated nanoseconds.
    time: u64,
    /// The next message.
    body: Vec<u8>,
}

enum PartSource {
    Chunk(Box<ChunkReader>),
    /// Messages outside of chunks; holds the offset of the next record.
    Messages(u64),
}

impl Merge {
    /// Creates a merge of all messages in `parts`.
    pub fn new(Parts { mut parts, .. }: Parts) -> Merge {
        parts.sort_by_key(|part| std::cmp::Reverse((part.first_time, part.location.offset)));
        Merge { waiting: parts, open: Vec::new(), body: Vec::new() }
    }

    /// Returns the next message and its location, or `None` after the last one.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or if too many of its parts overlap in time.
    pub fn next_message<R: Read + Seek>(
        &mut self,
        source: &mut R,
    ) -> Result<Option<(Location, ChunkRecord<'_>)>, Error> {
        let first = loop {
            let next = self.open.iter().enumerate().min_by_key(|(_, open)| (open.time, open.offset));
            let next = next.map(|(index, open)| (index, open.time));
            let starts_before = |part: &Part| next.is_none_or(|(_, time)| part.first_time <= time);
            match (self.waiting.pop_if(|part| starts_before(part)), next) {
                (Some(part), _) => self.open_part(part, source)?,
                (None, Some((index, _))) => break index,
                (None, None) => return Ok(None),
            }
        };
        let open = &mut self.open[first];
        let location = Location { offset: open.offset, ..open.part.location };
        std::mem::swap(&mut self.body, &mut open.body);
        if !open.advance(source).map_err(Error::Read)? {
            self.open.swap_remove(first);
        }
        Ok(Some((location, ChunkRecord { opcode: op::MESSAGE, body: &self.body })))
    }

    fn open_part<R: Read + Seek>(&mut self, part: Part, source: &mut R) -> Result<(), Error> {
        let offset = part.location.offset;
        let part_source = match part.location.chunk {
            None => PartSource::Messages(offset),
            Some(_) => {
                read_record(source, offset, &mut self.body).map_err(Error::Read)?;
                let mut chunk = ChunkReader::new();
                chunk.open(offset, &self.body).map_err(|reason| Error::Read(io::Error::other(reason)))?;
                PartSource::Chunk(Box::new(chunk))
            }
        };
        let mut opened = OpenPart { part, source: part_source, offset, time: 0, body: Vec::new() };
        if opened.advance(source).map_err(Error::Read)? {
            self.open.push(opened);
        }
        let chunk_bytes = self.open.iter().map(|open| match &open.source {
            PartSource::Chunk(chunk) => chunk.uncompressed_bytes(),
            PartSource::Messages(_) => 0,
        });
        let is_too_much = self.open.len() > 1 && chunk_bytes.sum::<usize>() > limits::OPEN_CHUNK_BYTES;
        if is_too_much || self.open.len() > limits::OPEN_PARTS { Err(Error::Unsorted) } else { Ok(()) }
    }
}

impl OpenPart {
    /// Reads the next message. Returns false after the last one.
    fn advance<R: Read + Seek>(&mut self, source: &mut R) -> io::Result<bool> {
        match &mut self.source {
            // The chunk was verified before.
            PartSource::Chunk(chunk) => loop {
                let Ok(Some(record)) = chunk.next_record() else { return Ok(false) };
                if let Some(message) = record.message() {
                    self.time = message.log_time;
                    self.body.clear();
                    self.body.extend_from_slice(record.body);
                    return Ok(true);
                }
            },
            PartSource::Messages(next) => {
                while *next <= self.part.last_offset {
                    self.offset = *next;
                    let opcode = read_record(source, *next, &mut self.body)?;
                    *next += (PREFIX_BYTES + self.body.len()) as u64;
                    if opcode == op::MESSAGE
                        && let Ok(RawMessage { log_time, .. }) = RawMessage::parse(&self.body)
                    {
                        self.time = log_time;
                        return Ok(true);
                    }
                }
                Ok(false)
            }
        }
    }
}

/// Reads the record at `offset` into `body` and returns its opcode.
fn read_record<R: Read + Seek>(source: &mut R, offset: u64, body: &mut Vec<u8>) -> io::Result<u8> {
    let mut prefix = [0; PREFIX_BYTES];
    source.seek(SeekFrom::Start(offset))?;
    source.read_exact(&mut prefix)?;
    let [opcode, length @ ..] = prefix;
    let length = u64::from_le_bytes(length);
    if length > limits::RECORD_BYTES as u64 {
        return Err(io::Error::other("the file was changed while it was read"));
    }
    body.resize(length as usize, 0);
    source.read_exact(body)?;
    Ok(opcode)
}
