use std::collections::BTreeMap;

use mcap::{
    McapError,
    records::op,
    sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

use super::{
    fields::{Fields, Malformed},
    limits,
    records::PREFIX_BYTES,
};

/// Opens chunks one after the other and hands out their records, each chunk's only once
/// all of it has passed its checksum.
pub struct Chunks {
    /// Kept from chunk to chunk: making one costs as much as reading a small chunk.
    reader: LinearReader,
    /// Whether the reader can take another chunk.
    usable: bool,
    chunk: Option<Chunk>,
}

/// What is known of the chunk being read.
struct Chunk {
    declared: TimeRange,
    found: Option<TimeRange>,
    position: u64,
    index: BTreeMap<u16, Vec<IndexEntry>>,
    exhausted: bool,
}

/// First and last log time of a chunk, simulated nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct TimeRange {
    first: u64,
    last: u64,
}

/// Where a message lies: log time and offset in the uncompressed chunk.
type IndexEntry = (u64, u64);

/// A record inside a chunk.
pub struct ChunkRecord<'a> {
    /// Which kind.
    pub opcode: u8,
    /// Its fields.
    pub body: &'a [u8],
}

/// A message as it lies in the file.
pub struct RawMessage<'a> {
    /// Which channel.
    pub channel: u16,
    /// Simulated nanoseconds.
    pub log_time: u64,
    /// CDR.
    pub data: &'a [u8],
}

impl Chunks {
    /// With no chunk open.
    pub fn new() -> Chunks {
        Chunks { reader: strict(), usable: true, chunk: None }
    }

    /// Opens the chunk whose record has this body.
    ///
    /// # Errors
    /// In words, if its header is not sound. Its checksum is verified by the first
    /// [`Chunks::next`].
    pub fn open(&mut self, body: &[u8]) -> Result<(), String> {
        self.close();
        let (declared, compression, data) = header(body).map_err(|Malformed| "its header is damaged")?;
        if compression.is_empty() && !is_whole_records(data) {
            return Err("its records do not fill it".into());
        }
        let space = self.reader.insert(PREFIX_BYTES + body.len());
        space[0] = op::CHUNK;
        space[1..PREFIX_BYTES].copy_from_slice(&(body.len() as u64).to_le_bytes());
        space[PREFIX_BYTES..][..body.len()].copy_from_slice(body);
        self.reader.notify_read(PREFIX_BYTES + body.len());
        self.chunk = Some(Chunk { declared, found: None, position: 0, index: BTreeMap::new(), exhausted: false });
        Ok(())
    }

    /// Forgets the open chunk.
    pub fn close(&mut self) {
        let unread = self.chunk.take().is_some_and(|chunk| !chunk.exhausted);
        if unread || !self.usable {
            self.reader = strict();
            self.usable = true;
        }
    }

    /// The next record of the open chunk, or none behind the last one.
    ///
    /// # Errors
    /// In words, if the chunk does not fit its checksum or its header; nothing more of it
    /// can be read then.
    pub fn next(&mut self) -> Result<Option<ChunkRecord<'_>>, String> {
        let Some(chunk) = self.chunk.as_mut().filter(|chunk| !chunk.exhausted) else { return Ok(None) };
        match self.reader.next_event() {
            Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                let record = ChunkRecord { opcode, body: data };
                chunk.note(&record);
                Ok(Some(record))
            }
            Some(Err(error)) => {
                chunk.exhausted = true;
                self.usable = false;
                Err(told(&error, chunk.position == 0))
            }
            None | Some(Ok(LinearReadEvent::ReadRequest(_))) => {
                chunk.exhausted = true;
                chunk.check_times()?;
                Ok(None)
            }
        }
    }

    /// Compares a message index record behind the chunk with what the chunk holds.
    ///
    /// # Errors
    /// In words, if they differ.
    pub fn check_index(&self, body: &[u8]) -> Result<(), String> {
        let Some(chunk) = &self.chunk else { return Err("a message index stands behind no chunk".into()) };
        if !self.usable {
            return Ok(()); // The chunk is damaged, as was said already.
        }
        match index(body) {
            Ok((channel, entries)) if chunk.index.get(&channel).is_some_and(|found| *found == entries) => Ok(()),
            Ok(_) | Err(Malformed) => Err("the message index does not fit its chunk".into()),
        }
    }
}

impl Chunk {
    fn note(&mut self, record: &ChunkRecord<'_>) {
        let offset = self.position;
        self.position += (PREFIX_BYTES + record.body.len()) as u64;
        let Some(message) = record.message() else { return };
        let RawMessage { channel, log_time, .. } = message;
        let TimeRange { first, last } = self.found.unwrap_or(TimeRange { first: log_time, last: log_time });
        self.found = Some(TimeRange { first: first.min(log_time), last: last.max(log_time) });
        self.index.entry(channel).or_default().push((log_time, offset));
    }

    fn check_times(&self) -> Result<(), String> {
        match self.found {
            Some(found) if found != self.declared => {
                Err("its header tells another time range than its messages".into())
            }
            Some(_) | None => Ok(()),
        }
    }
}

impl ChunkRecord<'_> {
    /// The message this is, if it is one.
    pub fn message(&self) -> Option<RawMessage<'_>> {
        (self.opcode == op::MESSAGE).then(|| RawMessage::parse(self.body).ok()).flatten()
    }
}

impl<'a> RawMessage<'a> {
    fn parse(body: &'a [u8]) -> Result<RawMessage<'a>, Malformed> {
        let mut fields = Fields::new(body);
        let channel = fields.u16()?;
        let _sequence = fields.u32()?;
        let log_time = fields.u64()?;
        let _publish_time = fields.u64()?;
        Ok(RawMessage { channel, log_time, data: fields.rest() })
    }
}

/// Why a chunk cannot be read, in words.
///
/// How far damaged bytes are decompressed before that is noticed, and into what, depends on the
/// processor: the words do not.
fn told(error: &McapError, is_at_start: bool) -> String {
    match error {
        McapError::BadChunkCrc { .. } | McapError::DecompressionError(_) => "its bytes do not fit its checksum".into(),
        McapError::UnexpectedEoc if is_at_start => "its bytes do not fit its checksum".into(),
        error => error.to_string(),
    }
}

fn strict() -> LinearReader {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(limits::RECORD_BYTES);
    LinearReader::new_with_options(options)
}

/// Time range, compression and data of a chunk record that ends with its data.
fn header(body: &[u8]) -> Result<(TimeRange, &str, &[u8]), Malformed> {
    let mut fields = Fields::new(body);
    let declared = TimeRange { first: fields.u64()?, last: fields.u64()? };
    let _uncompressed_size = fields.u64()?;
    let _checksum = fields.u32()?;
    let compression = fields.text()?;
    let compressed_size = fields.u64()?;
    let data = fields.bytes(compressed_size)?;
    fields.end()?;
    Ok((declared, compression, data))
}

/// Whether an uncompressed chunk ends where its last record does: the crate trusts it to.
fn is_whole_records(data: &[u8]) -> bool {
    let mut fields = Fields::new(data);
    loop {
        match (fields.bytes(1), fields.u64()) {
            (Err(Malformed), _) => return true,
            (Ok(_), Ok(length)) if fields.bytes(length).is_ok() => {}
            (Ok(_), _) => return false,
        }
    }
}

fn index(body: &[u8]) -> Result<(u16, Vec<IndexEntry>), Malformed> {
    let mut fields = Fields::new(body);
    let channel = fields.u16()?;
    let length = fields.u32()?;
    let mut records = Fields::new(fields.bytes(length.into())?);
    let mut entries = Vec::new();
    while !records.is_empty() {
        entries.push((records.u64()?, records.u64()?));
    }
    fields.end()?;
    Ok((channel, entries))
}
