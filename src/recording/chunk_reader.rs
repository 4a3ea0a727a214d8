use std::{collections::BTreeMap, io::Read, iter, vec};

use mcap::records::op;

use super::{
    limits,
    record_reader::{FieldReader, Malformed, PREFIX_BYTES},
    tally::ChunkSummary,
};

/// Reads the records of one chunk after another, the messages of each chunk in order of time. The checksum of a chunk
/// is verified before its first record is returned.
pub struct ChunkReader {
    decompressor: Option<zstd::bulk::Decompressor<'static>>,
    /// The uncompressed records of the open chunk. Reused from chunk to chunk.
    records: Vec<u8>,
    chunk: Option<Chunk>,
}

/// The chunk being read.
struct Chunk {
    /// The time range according to the header.
    declared: TimeRange,
    /// The time range of the messages read so far.
    found: Option<TimeRange>,
    /// The offset of the next record in the uncompressed chunk.
    position: usize,
    /// The offsets of the records that follow, if they are not stored in order of time.
    order: Option<vec::IntoIter<u32>>,
    /// The messages read so far, by channel.
    index: BTreeMap<u16, Vec<IndexEntry>>,
    is_exhausted: bool,
    /// True if part of the chunk could not be read.
    has_failed: bool,
    summary: ChunkSummary,
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
#[derive(Clone, Copy)]
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
    /// The time of publication, in simulated nanoseconds.
    pub publish_time: u64,
    /// The message, encoded as its channel declares.
    pub data: &'a [u8],
}

impl ChunkReader {
    /// Creates a reader without an open chunk.
    pub fn new() -> ChunkReader {
        ChunkReader { decompressor: None, records: Vec::new(), chunk: None }
    }

    /// Opens the chunk whose record starts at `offset` and has this body, and verifies its checksum.
    ///
    /// # Errors
    /// Returns a description of the damage if the chunk cannot be decompressed or does not match its checksum.
    pub fn open(&mut self, offset: u64, body: &[u8]) -> Result<(), String> {
        self.close();
        let header = ChunkHeader::parse(body).map_err(|Malformed| "the chunk header is damaged")?;
        let declared = TimeRange { first: header.first_time, last: header.last_time };
        let summary = ChunkSummary {
            first_time: header.first_time,
            last_time: header.last_time,
            offset,
            length: (PREFIX_BYTES + body.len()) as u64,
            message_indexes: BTreeMap::new(),
            message_index_length: 0,
            compression: header.compression.into(),
            compressed_size: header.data.len() as u64,
            uncompressed_size: header.uncompressed_size,
        };
        self.chunk = Some(Chunk {
            declared,
            found: None,
            position: 0,
            order: None,
            index: BTreeMap::new(),
            is_exhausted: false,
            has_failed: false,
            summary,
        });
        let opened = self.decompress(&header);
        if let Some(chunk) = &mut self.chunk {
            match opened {
                Ok(()) => chunk.order = time_order(&self.records).map(Vec::into_iter),
                Err(_) => (chunk.is_exhausted, chunk.has_failed) = (true, true),
            }
        }
        opened
    }

    fn decompress(&mut self, header: &ChunkHeader<'_>) -> Result<(), String> {
        let size = header.uncompressed_size;
        if size > limits::RECORD_BYTES as u64 {
            return Err(format!(
                "the chunk has {size} bytes uncompressed, but at most {} are allowed",
                limits::RECORD_BYTES
            ));
        }
        self.records.clear();
        let is_readable = match header.compression {
            "" => {
                self.records.extend_from_slice(header.data);
                true
            }
            "zstd" => self.decompress_zstd(header.data, size as usize),
            "lz4" => {
                let frame = lz4_flex::frame::FrameDecoder::new(header.data);
                frame.take(size + 1).read_to_end(&mut self.records).is_ok()
            }
            other => {
                let name: String = other.chars().take(32).collect();
                return Err(format!("the chunk has the compression {name:?}, but only zstd and lz4 can be read"));
            }
        };
        let is_same = |checksum| checksum == 0 || checksum == crc32fast::hash(&self.records);
        if !is_readable || self.records.len() as u64 != size || !is_same(header.checksum) {
            return Err("the chunk does not match its checksum".into());
        }
        if ends_with_a_record(&self.records) {
            Ok(())
        } else {
            Err("the last record of the chunk is incomplete".into())
        }
    }

    fn decompress_zstd(&mut self, data: &[u8], size: usize) -> bool {
        if self.decompressor.is_none() {
            self.decompressor = zstd::bulk::Decompressor::new().ok();
        }
        self.records.reserve(size);
        let Some(decompressor) = &mut self.decompressor else { return false };
        decompressor.decompress_to_buffer(data, &mut self.records).is_ok()
    }

    /// Closes the open chunk and returns its entry in the summary, unless it was damaged.
    pub fn close(&mut self) -> Option<ChunkSummary> {
        let chunk = self.chunk.take()?;
        (chunk.is_exhausted && !chunk.has_failed).then_some(chunk.summary)
    }

    /// Returns the times of the first and last message read so far of the open chunk, in simulated nanoseconds.
    pub fn times(&self) -> Option<[u64; 2]> {
        let TimeRange { first, last } = self.chunk.as_ref().filter(|chunk| !chunk.has_failed)?.found?;
        Some([first, last])
    }

    /// Returns the size of the records of the chunk.
    pub fn uncompressed_bytes(&self) -> usize {
        self.records.len()
    }

    /// Returns the next record of the open chunk, or `None` after the last one.
    ///
    /// # Errors
    /// Returns a description of the damage if the messages do not match the header of the chunk.
    pub fn next_record(&mut self) -> Result<Option<ChunkRecord<'_>>, String> {
        let Some(chunk) = self.chunk.as_mut().filter(|chunk| !chunk.is_exhausted) else { return Ok(None) };
        if let Some(order) = &mut chunk.order {
            chunk.position = order.next().map_or(self.records.len(), |position| position as usize);
        }
        match record_at(&self.records, chunk.position) {
            Some(record) => {
                chunk.add_record(&record);
                Ok(Some(record))
            }
            None => {
                chunk.is_exhausted = true;
                chunk.check_time_range().map(|()| None)
            }
        }
    }

    /// Returns true from the start of a chunk until the next record that does not belong to it.
    pub fn is_open(&self) -> bool {
        self.chunk.is_some()
    }

    /// Compares a message index record at `offset` with the messages of the chunk before it.
    ///
    /// # Errors
    /// Returns a description of the damage if they differ.
    pub fn check_message_index(&mut self, offset: u64, body: &[u8]) -> Result<(), String> {
        let Some(chunk) = &mut self.chunk else { return Err("a message index does not follow a chunk".into()) };
        if chunk.has_failed {
            return Ok(()); // The damage of the chunk was already reported.
        }
        let Ok((channel, mut entries)) = parse_message_index(body) else {
            return Err("the message index is damaged".into());
        };
        chunk.summary.message_indexes.insert(channel, offset);
        chunk.summary.message_index_length += (PREFIX_BYTES + body.len()) as u64;
        let mut found = chunk.index.get(&channel).cloned().unwrap_or_default();
        found.sort_unstable();
        entries.sort_unstable();
        if found == entries { Ok(()) } else { Err("the message index does not match its chunk".into()) }
    }
}

impl Chunk {
    fn add_record(&mut self, record: &ChunkRecord<'_>) {
        let offset = self.position as u64;
        self.position += PREFIX_BYTES + record.body.len();
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
    /// Parses the body of a message record.
    pub fn parse(body: &'a [u8]) -> Result<RawMessage<'a>, Malformed> {
        let mut fields = FieldReader::new(body);
        let channel = fields.u16()?;
        let _sequence = fields.u32()?;
        let (log_time, publish_time) = (fields.u64()?, fields.u64()?);
        Ok(RawMessage { channel, log_time, publish_time, data: fields.rest() })
    }
}

/// The fields of a chunk record. Fields that later versions of MCAP may add are ignored.
struct ChunkHeader<'a> {
    first_time: u64,
    last_time: u64,
    uncompressed_size: u64,
    checksum: u32,
    compression: &'a str,
    data: &'a [u8],
}

impl<'a> ChunkHeader<'a> {
    fn parse(body: &'a [u8]) -> Result<ChunkHeader<'a>, Malformed> {
        let mut fields = FieldReader::new(body);
        let (first_time, last_time, uncompressed_size) = (fields.u64()?, fields.u64()?, fields.u64()?);
        let (checksum, compression) = (fields.u32()?, fields.text()?);
        let compressed_size = fields.u64()?;
        let data = fields.bytes(compressed_size)?;
        Ok(ChunkHeader { first_time, last_time, uncompressed_size, checksum, compression, data })
    }
}

/// Returns the record at `position`, or `None` at the end.
fn record_at(records: &[u8], position: usize) -> Option<ChunkRecord<'_>> {
    let mut fields = FieldReader::new(records.get(position..)?);
    let opcode = *fields.bytes(1).ok()?.first()?;
    let length = fields.u64().ok()?;
    Some(ChunkRecord { opcode, body: fields.bytes(length).ok()? })
}

/// Returns the offsets of the records in order of time, those that are not messages first; `None` if they are stored in
/// this order.
fn time_order(records: &[u8]) -> Option<Vec<u32>> {
    let time = |position: u32| record_at(records, position as usize)?.message().map(|message| message.log_time);
    let first = (!records.is_empty()).then_some(0);
    let offsets = || {
        iter::successors(first, |position: &u32| {
            let end = *position as usize + PREFIX_BYTES + record_at(records, *position as usize)?.body.len();
            u32::try_from(end).ok().filter(|_| end < records.len())
        })
    };
    if offsets().is_sorted_by_key(time) {
        return None;
    }
    let mut order: Vec<u32> = offsets().collect();
    order.sort_by_key(|position| time(*position));
    Some(order)
}

/// Returns true if the data ends at the end of a record.
fn ends_with_a_record(data: &[u8]) -> bool {
    let mut fields = FieldReader::new(data);
    while !fields.is_empty() {
        let record = fields.bytes(1).and_then(|_| fields.u64()).and_then(|length| fields.bytes(length));
        if record.is_err() {
            return false;
        }
    }
    true
}

fn parse_message_index(body: &[u8]) -> Result<(u16, Vec<IndexEntry>), Malformed> {
    let mut fields = FieldReader::new(body);
    let channel = fields.u16()?;
    let length = fields.u32()?;
    let mut records = FieldReader::new(fields.bytes(length.into())?);
    let mut entries = Vec::new();
    while !records.is_empty() {
        entries.push((records.u64()?, records.u64()?));
    }
    Ok((channel, entries))
}
