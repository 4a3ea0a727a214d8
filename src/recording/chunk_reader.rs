use std::collections::BTreeMap;

use mcap::{
    McapError,
    records::op,
    sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

use super::{
    limits,
    record_reader::{Cursor, Malformed, PREFIX_BYTES},
};

/// Reads the records of one chunk after another. The checksum of a chunk is verified before its first
/// record is returned.
pub struct ChunkReader {
    /// Reused from chunk to chunk, because creating one costs as much as reading a small chunk.
    reader: LinearReader,
    /// True if the reader has failed and cannot read another chunk.
    has_failed: bool,
    chunk: Option<Chunk>,
}

/// The chunk being read.
struct Chunk {
    /// The time range according to the header.
    declared: TimeRange,
    /// The time range of the messages read so far.
    found: Option<TimeRange>,
    /// The offset of the next record in the uncompressed chunk.
    position: u64,
    /// The messages read so far, by channel.
    index: BTreeMap<u16, Vec<IndexEntry>>,
    is_exhausted: bool,
}

/// The first and last log time of a chunk, in simulated nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct TimeRange {
    first: u64,
    last: u64,
}

/// An entry of a message index: log time and offset in the uncompressed chunk.
type IndexEntry = (u64, u64);

/// A record inside a chunk.
pub struct ChunkRecord<'a> {
    /// The kind of record.
    pub opcode: u8,
    /// The fields.
    pub body: &'a [u8],
}

/// An encoded message.
pub struct RawMessage<'a> {
    /// The id of the channel.
    pub channel: u16,
    /// The log time, in simulated nanoseconds.
    pub log_time: u64,
    /// The message, encoded as its channel declares.
    pub data: &'a [u8],
}

impl ChunkReader {
    /// Creates a reader without an open chunk.
    pub fn new() -> ChunkReader {
        ChunkReader { reader: strict_reader(), has_failed: false, chunk: None }
    }

    /// Opens the chunk whose record has this body.
    ///
    /// # Errors
    /// Returns a description of the damage if the header is invalid. The checksum is verified by the
    /// first call of [`ChunkReader::next_record`].
    pub fn open(&mut self, body: &[u8]) -> Result<(), String> {
        self.close();
        let (declared, compression, data) = parse_header(body).map_err(|Malformed| "the chunk header is damaged")?;
        if compression.is_empty() && !ends_with_a_record(data) {
            return Err("the last record of the chunk is incomplete".into());
        }
        let space = self.reader.insert(PREFIX_BYTES + body.len());
        space[0] = op::CHUNK;
        space[1..PREFIX_BYTES].copy_from_slice(&(body.len() as u64).to_le_bytes());
        space[PREFIX_BYTES..][..body.len()].copy_from_slice(body);
        self.reader.notify_read(PREFIX_BYTES + body.len());
        self.chunk = Some(Chunk { declared, found: None, position: 0, index: BTreeMap::new(), is_exhausted: false });
        Ok(())
    }

    /// Closes the open chunk.
    pub fn close(&mut self) {
        let is_unread = self.chunk.take().is_some_and(|chunk| !chunk.is_exhausted);
        if is_unread || self.has_failed {
            self.reader = strict_reader();
            self.has_failed = false;
        }
    }

    /// Returns the next record of the open chunk, or `None` after the last one.
    ///
    /// # Errors
    /// Returns a description of the damage if the chunk does not match its checksum or its header.
    /// The rest of the chunk is then unreadable.
    pub fn next_record(&mut self) -> Result<Option<ChunkRecord<'_>>, String> {
        let Some(chunk) = self.chunk.as_mut().filter(|chunk| !chunk.is_exhausted) else { return Ok(None) };
        match self.reader.next_event() {
            Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                let record = ChunkRecord { opcode, body: data };
                chunk.add_record(&record);
                Ok(Some(record))
            }
            Some(Err(error)) => {
                chunk.is_exhausted = true;
                self.has_failed = true;
                Err(describe(&error, chunk.position == 0))
            }
            None | Some(Ok(LinearReadEvent::ReadRequest(_))) => {
                chunk.is_exhausted = true;
                chunk.check_time_range()?;
                Ok(None)
            }
        }
    }

    /// Compares a message index record with the messages of the chunk before it.
    ///
    /// # Errors
    /// Returns a description of the damage if they differ.
    pub fn check_message_index(&self, body: &[u8]) -> Result<(), String> {
        let Some(chunk) = &self.chunk else { return Err("a message index does not follow a chunk".into()) };
        if self.has_failed {
            return Ok(()); // The damage of the chunk was already reported.
        }
        match parse_message_index(body) {
            Ok((channel, entries)) if chunk.index.get(&channel).is_some_and(|found| *found == entries) => Ok(()),
            Ok(_) | Err(Malformed) => Err("the message index does not match its chunk".into()),
        }
    }
}

impl Chunk {
    fn add_record(&mut self, record: &ChunkRecord<'_>) {
        let offset = self.position;
        self.position += (PREFIX_BYTES + record.body.len()) as u64;
        let Some(message) = record.message() else { return };
        let RawMessage { channel, log_time, .. } = message;
        let TimeRange { first, last } = self.found.unwrap_or(TimeRange { first: log_time, last: log_time });
        self.found = Some(TimeRange { first: first.min(log_time), last: last.max(log_time) });
        self.index.entry(channel).or_default().push((log_time, offset));
    }

    fn check_time_range(&self) -> Result<(), String> {
        match self.found {
            Some(found) if found != self.declared => {
                Err("the time range in the chunk header does not match the messages".into())
            }
            Some(_) | None => Ok(()),
        }
    }
}

impl ChunkRecord<'_> {
    /// Returns the message, if the record is one.
    pub fn message(&self) -> Option<RawMessage<'_>> {
        (self.opcode == op::MESSAGE).then(|| RawMessage::parse(self.body).ok()).flatten()
    }
}

impl<'a> RawMessage<'a> {
    fn parse(body: &'a [u8]) -> Result<RawMessage<'a>, Malformed> {
        let mut fields = Cursor::new(body);
        let channel = fields.u16()?;
        let _sequence = fields.u32()?;
        let log_time = fields.u64()?;
        let _publish_time = fields.u64()?;
        Ok(RawMessage { channel, log_time, data: fields.rest() })
    }
}

/// Describes why a chunk cannot be read.
///
/// How many damaged bytes are decompressed before the error is detected depends on the processor;
/// the description does not.
fn describe(error: &McapError, is_at_start: bool) -> String {
    match error {
        McapError::BadChunkCrc { .. } | McapError::DecompressionError(_) => {
            "the chunk does not match its checksum".into()
        }
        McapError::UnexpectedEoc if is_at_start => "the chunk does not match its checksum".into(),
        error => error.to_string(),
    }
}

fn strict_reader() -> LinearReader {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(limits::RECORD_BYTES);
    LinearReader::new_with_options(options)
}

/// Returns time range, compression and data of a chunk record, which must end with its data.
fn parse_header(body: &[u8]) -> Result<(TimeRange, &str, &[u8]), Malformed> {
    let mut fields = Cursor::new(body);
    let declared = TimeRange { first: fields.u64()?, last: fields.u64()? };
    let _uncompressed_size = fields.u64()?;
    let _checksum = fields.u32()?;
    let compression = fields.text()?;
    let compressed_size = fields.u64()?;
    let data = fields.bytes(compressed_size)?;
    fields.finish()?;
    Ok((declared, compression, data))
}

/// Returns true if an uncompressed chunk ends at the end of a record, which the `mcap` crate does not check.
fn ends_with_a_record(data: &[u8]) -> bool {
    let mut fields = Cursor::new(data);
    loop {
        match (fields.bytes(1), fields.u64()) {
            (Err(Malformed), _) => return true,
            (Ok(_), Ok(length)) if fields.bytes(length).is_ok() => {}
            (Ok(_), _) => return false,
        }
    }
}

fn parse_message_index(body: &[u8]) -> Result<(u16, Vec<IndexEntry>), Malformed> {
    let mut fields = Cursor::new(body);
    let channel = fields.u16()?;
    let length = fields.u32()?;
    let mut records = Cursor::new(fields.bytes(length.into())?);
    let mut entries = Vec::new();
    while !records.is_empty() {
        entries.push((records.u64()?, records.u64()?));
    }
    fields.finish()?;
    Ok((channel, entries))
}
