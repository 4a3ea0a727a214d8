use std::{
    collections::BTreeMap,
    io::{self, Read, Seek, SeekFrom},
};

use mcap::{MAGIC, records::op};

use super::{
    Trailer, metadata,
    record_reader::{Cursor, Malformed, PREFIX_BYTES, RecordReader},
    resync,
    topic::Topic,
};

/// The index of the chunks of a recording, for random access.
#[derive(Default)]
pub struct Index {
    /// The chunks in file order.
    pub chunks: Vec<IndexedChunk>,
    /// The bodies of the channel records, which are otherwise only in the first chunk.
    pub channels: Vec<Vec<u8>>,
    /// The offset of the end record, in bytes from the start of the file.
    trailer_offset: Option<u64>,
    /// The number of messages of each channel.
    message_counts: BTreeMap<u16, u64>,
}

/// A chunk in the index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexedChunk {
    /// The offset of the chunk record, in bytes from the start of the file.
    pub offset: u64,
    /// The time of the first message, in simulated nanoseconds.
    pub first_time: u64,
    /// The channels of its messages.
    channels: ChannelSet,
}

/// A set of channel ids as a bit mask. The last bit stands for all ids from 15 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ChannelSet(u16);

/// The summary of a finished recording, from its end record and index. The chunks are neither read nor
/// verified.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The end record.
    pub trailer: Trailer,
    /// The number of states, including those recorded as digests only.
    pub states: u64,
    /// The number of keyframes.
    pub keyframes: u64,
    /// The number of chunks.
    pub chunks: u64,
}

impl Index {
    /// Returns the summary, or `None` if the index has no readable end record.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn summary<R: Read + Seek>(&self, records: &mut RecordReader<R>) -> io::Result<Option<Summary>> {
        let Some(offset) = self.trailer_offset else { return Ok(None) };
        records.seek(offset)?;
        let is_metadata = matches!(records.next_record(), Ok(Some(record)) if record.opcode == op::METADATA);
        let parsed = is_metadata.then(|| metadata::parse(&records.body).ok()).flatten();
        let trailer = parsed
            .filter(|(name, _)| *name == metadata::TRAILER)
            .and_then(|(_, map)| metadata::parse_trailer(&map).ok());
        Ok(trailer.map(|trailer| Summary {
            trailer,
            states: self.message_count(Topic::States),
            keyframes: self.message_count(Topic::Bodies),
            chunks: self.chunks.len() as u64,
        }))
    }

    fn message_count(&self, topic: Topic) -> u64 {
        self.channels_of(topic).filter_map(|channel| self.message_counts.get(&channel)).sum()
    }

    /// Returns true if a chunk may contain messages of a topic.
    pub fn may_contain(&self, chunk: usize, topic: Topic) -> bool {
        // An index without channels was built by scanning.
        self.channels.is_empty() || self.channels_of(topic).any(|channel| self.chunks[chunk].channels.contains(channel))
    }

    fn channels_of(&self, topic: Topic) -> impl Iterator<Item = u16> {
        let channel_id = move |body: &Vec<u8>| {
            let mut fields = Cursor::new(body);
            let (id, _schema, name) = (fields.u16().ok()?, fields.u16().ok()?, fields.text().ok()?);
            (name == topic.name()).then_some(id)
        };
        self.channels.iter().filter_map(channel_id)
    }
}

impl ChannelSet {
    /// All channels, for chunks whose channels are unknown.
    const ALL: ChannelSet = ChannelSet(u16::MAX);

    fn with(self, channel: u16) -> ChannelSet {
        ChannelSet(self.0 | ChannelSet::bit(channel))
    }

    fn contains(self, channel: u16) -> bool {
        self.0 & ChannelSet::bit(channel) != 0
    }

    fn bit(channel: u16) -> u16 {
        1 << channel.min(15)
    }
}

/// Reads the index in the summary section of a finished recording. For an unfinished or damaged one,
/// builds the index by scanning all records, without opening chunks.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn read<R: Read + Seek>(records: &mut RecordReader<R>) -> io::Result<Index> {
    if let Some(start) = summary_start(records.source())?
        && let Some(index) = from_summary(records, start)?
    {
        return Ok(index);
    }
    scan(records)
}

/// Bytes of the data end record, which precedes the summary section.
const DATA_END_BYTES: u64 = PREFIX_BYTES as u64 + 4;

/// Bytes of a footer record.
const FOOTER_BYTES: usize = PREFIX_BYTES + 20;

/// Returns the offset of the summary section, if there is one.
fn summary_start<R: Read + Seek>(source: &mut R) -> io::Result<Option<u64>> {
    const TAIL: usize = FOOTER_BYTES + MAGIC.len();
    let length = source.seek(SeekFrom::End(0))?;
    let Some(start) = length.checked_sub(TAIL as u64) else { return Ok(None) };
    source.seek(SeekFrom::Start(start))?;
    let mut tail = [0; TAIL];
    resync::read_up_to(source, &mut tail)?;
    Ok(parse_footer(&tail).ok().filter(|summary| (DATA_END_BYTES..start).contains(summary)))
}

fn parse_footer(tail: &[u8]) -> Result<u64, Malformed> {
    let mut fields = Cursor::new(tail);
    match (fields.bytes(1)?, fields.u64()?) {
        ([op::FOOTER], 20) => fields.u64(),
        _ => Err(Malformed),
    }
}

/// Reads the summary section. Returns `None` if it is damaged.
fn from_summary<R: Read + Seek>(records: &mut RecordReader<R>, start: u64) -> io::Result<Option<Index>> {
    records.seek(start - DATA_END_BYTES)?;
    let mut index = Index::default();
    while let Ok(next) = records.next_record() {
        let Some(record) = next else { return Ok(Some(index)) };
        if index.add_record(record.opcode, &records.body).is_err() {
            return Ok(None);
        }
    }
    Ok(None)
}

impl Index {
    /// Adds a record of the summary section.
    fn add_record(&mut self, opcode: u8, body: &[u8]) -> Result<(), Malformed> {
        match opcode {
            op::CHUNK_INDEX => self.chunks.push(parse_chunk_index(body)?),
            op::CHANNEL => self.channels.push(body.into()),
            op::STATISTICS => self.message_counts = parse_message_counts(body)?,
            op::METADATA_INDEX => self.trailer_offset = parse_trailer_offset(body)?.or(self.trailer_offset),
            _ => {}
        }
        Ok(())
    }
}

fn parse_chunk_index(body: &[u8]) -> Result<IndexedChunk, Malformed> {
    let mut fields = Cursor::new(body);
    let first_time = fields.u64()?;
    let _last_time = fields.u64()?;
    let offset = fields.u64()?;
    let _length = fields.u64()?;
    let bytes = fields.u32()?;
    let mut message_indexes = Cursor::new(fields.bytes(bytes.into())?);
    let mut channels = ChannelSet(0);
    while !message_indexes.is_empty() {
        channels = channels.with(message_indexes.u16()?);
        message_indexes.u64()?;
    }
    Ok(IndexedChunk { first_time, offset, channels: if bytes == 0 { ChannelSet::ALL } else { channels } })
}

fn parse_message_counts(body: &[u8]) -> Result<BTreeMap<u16, u64>, Malformed> {
    let mut fields = Cursor::new(body);
    let _other_counts_and_times = fields.bytes(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8)?;
    let bytes = fields.u32()?;
    let mut pairs = Cursor::new(fields.bytes(bytes.into())?);
    let mut counts = BTreeMap::new();
    while !pairs.is_empty() {
        counts.insert(pairs.u16()?, pairs.u64()?);
    }
    Ok(counts)
}

/// Returns the offset in a metadata index record, if it is the one of the end record.
fn parse_trailer_offset(body: &[u8]) -> Result<Option<u64>, Malformed> {
    let mut fields = Cursor::new(body);
    let (offset, _length) = (fields.u64()?, fields.u64()?);
    Ok((fields.text()? == metadata::TRAILER).then_some(offset))
}

fn scan<R: Read + Seek>(records: &mut RecordReader<R>) -> io::Result<Index> {
    let mut index = Index::default();
    records.rewind()?;
    loop {
        match records.next_record() {
            Ok(Some(record)) if record.opcode == op::CHUNK => {
                let first_time = Cursor::new(&records.body).u64();
                index.chunks.extend(first_time.map(|first_time| IndexedChunk {
                    first_time,
                    offset: record.offset,
                    channels: ChannelSet::ALL,
                }));
            }
            Ok(Some(record)) if record.opcode != op::DATA_END => {}
            Ok(_) => return Ok(index),
            Err(fault) => match resync::resync(records.source(), &fault)? {
                resync::Resync::ContinueAt(next) => records.seek(next)?,
                resync::Resync::Truncated | resync::Resync::Corrupt => return Ok(index),
            },
        }
    }
}
