use std::collections::BTreeMap;

use mcap::{
    records::op,
    sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

use super::{
    fields::{Fields, Malformed},
    limits,
    records::PREFIX_BYTES,
};

/// The records of one chunk, handed out only once all of it has passed its checksum.
pub struct Chunk {
    reader: LinearReader,
    declared: TimeRange,
    found: Option<TimeRange>,
    position: u64,
    index: BTreeMap<u16, Vec<IndexEntry>>,
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

impl Chunk {
    /// Opens the chunk whose record has this body.
    ///
    /// # Errors
    /// In words, if its header is not sound. Its checksum is verified by the first
    /// [`Chunk::next`].
    pub fn open(body: &[u8]) -> Result<Chunk, String> {
        let (declared, compression, data) = header(body).map_err(|Malformed| "its header is damaged")?;
        if compression.is_empty() && !is_whole_records(data) {
            return Err("its records do not fill it".into());
        }
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(limits::RECORD_BYTES);
        let mut reader = LinearReader::new_with_options(options);
        let total = PREFIX_BYTES as usize + body.len();
        let space = reader.insert(total);
        space[0] = op::CHUNK;
        space[1..PREFIX_BYTES as usize].copy_from_slice(&(body.len() as u64).to_le_bytes());
        space[PREFIX_BYTES as usize..total].copy_from_slice(body);
        reader.notify_read(total);
        Ok(Chunk { reader, declared, found: None, position: 0, index: BTreeMap::new() })
    }

    /// The next record, or none behind the last one.
    ///
    /// # Errors
    /// In words, if the chunk does not fit its checksum or its header.
    pub fn next(&mut self) -> Result<Option<ChunkRecord<'_>>, String> {
        match self.reader.next_event() {
            Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                let offset = self.position;
                self.position += PREFIX_BYTES + data.len() as u64;
                if opcode == op::MESSAGE
                    && let Ok(message) = RawMessage::parse(data)
                {
                    let RawMessage { channel, log_time, .. } = message;
                    let range = self.found.get_or_insert(TimeRange { first: log_time, last: log_time });
                    *range = TimeRange { first: range.first.min(log_time), last: range.last.max(log_time) };
                    self.index.entry(channel).or_default().push((log_time, offset));
                }
                Ok(Some(ChunkRecord { opcode, body: data }))
            }
            Some(Err(error)) => Err(error.to_string()),
            None | Some(Ok(LinearReadEvent::ReadRequest(_))) => match self.found {
                Some(found) if found != self.declared => {
                    Err("its header tells another time range than its messages".into())
                }
                Some(_) | None => Ok(None),
            },
        }
    }

    /// Compares a message index record behind the chunk with what the chunk holds.
    ///
    /// # Errors
    /// In words, if they differ.
    pub fn check_index(&self, body: &[u8]) -> Result<(), String> {
        match index(body) {
            Ok((channel, entries)) if self.index.get(&channel).is_some_and(|found| *found == entries) => Ok(()),
            Ok(_) | Err(Malformed) => Err("the message index does not fit its chunk".into()),
        }
    }
}

impl<'a> RawMessage<'a> {
    /// The message of a record's body.
    pub fn parse(body: &'a [u8]) -> Result<RawMessage<'a>, Malformed> {
        let mut fields = Fields::new(body);
        let channel = fields.u16()?;
        let _sequence = fields.u32()?;
        let log_time = fields.u64()?;
        let _publish_time = fields.u64()?;
        Ok(RawMessage { channel, log_time, data: fields.rest() })
    }
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
    match fields.rest() {
        [] => Ok((declared, compression, data)),
        [..] => Err(Malformed),
    }
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
    match fields.rest() {
        [] => Ok((channel, entries)),
        [..] => Err(Malformed),
    }
}
