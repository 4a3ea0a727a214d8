use std::{
    collections::BTreeMap,
    io::{self, Read, Seek, SeekFrom},
};

use mcap::{MAGIC, records::op};

use super::{
    fields::{Fields, Malformed},
    metadata,
    records::{PREFIX_BYTES, Records},
    resync,
    topic::Topic,
};

/// Where the chunks of a recording are: enough to read on at any of them.
#[derive(Default)]
pub struct Index {
    /// In file order.
    pub chunks: Vec<IndexedChunk>,
    /// The bodies of the channel records, which stand in the first chunk otherwise.
    pub channels: Vec<Vec<u8>>,
    /// Where the metadata at the end is, bytes from the start of the file.
    pub end: Option<u64>,
    /// How many messages each channel has.
    counts: BTreeMap<u16, u64>,
}

/// A chunk as the index knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexedChunk {
    /// Of its record, bytes from the start of the file.
    pub offset: u64,
    /// Of its first message, simulated nanoseconds.
    pub first_time: u64,
    /// Which channels it has messages of.
    channels: ChannelSet,
}

/// Channels by their number, one bit each; the last is for all that are too high for one of
/// their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ChannelSet(u16);

impl Index {
    /// How many messages there are of a topic.
    pub fn messages(&self, topic: Topic) -> u64 {
        self.channels_of(topic).filter_map(|channel| self.counts.get(&channel)).sum()
    }

    /// Whether the chunk there may have messages of a topic.
    pub fn has(&self, place: usize, topic: Topic) -> bool {
        // An index that names no channels is one that was made here.
        self.channels.is_empty() || self.channels_of(topic).any(|channel| self.chunks[place].channels.has(channel))
    }

    fn channels_of(&self, topic: Topic) -> impl Iterator<Item = u16> {
        let number = move |body: &Vec<u8>| {
            let mut fields = Fields::new(body);
            let (number, _schema, name) = (fields.u16().ok()?, fields.u16().ok()?, fields.text().ok()?);
            (name == topic.name()).then_some(number)
        };
        self.channels.iter().filter_map(number)
    }
}

impl ChannelSet {
    /// What is not known may be anything.
    const ALL: ChannelSet = ChannelSet(u16::MAX);

    fn with(self, channel: u16) -> ChannelSet {
        ChannelSet(self.0 | ChannelSet::bit(channel))
    }

    fn has(self, channel: u16) -> bool {
        self.0 & ChannelSet::bit(channel) != 0
    }

    fn bit(channel: u16) -> u16 {
        1 << channel.min(15)
    }
}

/// Reads the index at the end of a finished recording; of any other one, makes it by
/// passing over all records without opening a chunk.
///
/// # Errors
/// If the system cannot read.
pub fn read<R: Read + Seek>(records: &mut Records<R>) -> io::Result<Index> {
    if let Some(start) = summary_start(records.read())?
        && let Some(index) = from_summary(records, start)?
    {
        return Ok(index);
    }
    from_records(records)
}

/// Bytes of a data end record, which stands before the summary.
const DATA_END_BYTES: u64 = PREFIX_BYTES as u64 + 4;

/// Bytes of a footer record.
const FOOTER_BYTES: usize = PREFIX_BYTES + 20;

/// Where the summary starts, if there is one.
fn summary_start<R: Read + Seek>(read: &mut R) -> io::Result<Option<u64>> {
    const TAIL: usize = FOOTER_BYTES + MAGIC.len();
    let length = read.seek(SeekFrom::End(0))?;
    let Some(start) = length.checked_sub(TAIL as u64) else { return Ok(None) };
    read.seek(SeekFrom::Start(start))?;
    let mut tail = [0; TAIL];
    resync::read_up_to(read, &mut tail)?;
    Ok(footer(&tail).ok().filter(|summary| (DATA_END_BYTES..start).contains(summary)))
}

fn footer(tail: &[u8]) -> Result<u64, Malformed> {
    let mut fields = Fields::new(tail);
    match (fields.bytes(1)?, fields.u64()?) {
        ([op::FOOTER], 20) => fields.u64(),
        _ => Err(Malformed),
    }
}

/// None if the summary is not as it was written.
fn from_summary<R: Read + Seek>(records: &mut Records<R>, start: u64) -> io::Result<Option<Index>> {
    records.seek(start - DATA_END_BYTES)?;
    let mut index = Index::default();
    while let Ok(next) = records.advance() {
        let Some(place) = next else { return Ok(Some(index)) };
        if index.take(place.opcode, &records.body).is_err() {
            return Ok(None);
        }
    }
    Ok(None)
}

impl Index {
    /// Takes a record of the summary.
    fn take(&mut self, opcode: u8, body: &[u8]) -> Result<(), Malformed> {
        match opcode {
            op::CHUNK_INDEX => self.chunks.push(chunk_index(body)?),
            op::CHANNEL => self.channels.push(body.into()),
            op::STATISTICS => self.counts = message_counts(body)?,
            op::METADATA_INDEX => self.end = end_offset(body)?.or(self.end),
            _ => {}
        }
        Ok(())
    }
}

fn chunk_index(body: &[u8]) -> Result<IndexedChunk, Malformed> {
    let mut fields = Fields::new(body);
    let first_time = fields.u64()?;
    let _last_time = fields.u64()?;
    let offset = fields.u64()?;
    let _length = fields.u64()?;
    let bytes = fields.u32()?;
    let mut message_indexes = Fields::new(fields.bytes(bytes.into())?);
    let mut channels = ChannelSet(0);
    while !message_indexes.is_empty() {
        channels = channels.with(message_indexes.u16()?);
        message_indexes.u64()?;
    }
    Ok(IndexedChunk { first_time, offset, channels: if bytes == 0 { ChannelSet::ALL } else { channels } })
}

fn message_counts(body: &[u8]) -> Result<BTreeMap<u16, u64>, Malformed> {
    let mut fields = Fields::new(body);
    let _other_counts_and_times = fields.bytes(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8)?;
    let bytes = fields.u32()?;
    let mut pairs = Fields::new(fields.bytes(bytes.into())?);
    let mut counts = BTreeMap::new();
    while !pairs.is_empty() {
        counts.insert(pairs.u16()?, pairs.u64()?);
    }
    Ok(counts)
}

/// Where the metadata is that the record tells of, if that is the one at the end.
fn end_offset(body: &[u8]) -> Result<Option<u64>, Malformed> {
    let mut fields = Fields::new(body);
    let (offset, _length) = (fields.u64()?, fields.u64()?);
    Ok((fields.text()? == metadata::END).then_some(offset))
}

fn from_records<R: Read + Seek>(records: &mut Records<R>) -> io::Result<Index> {
    let mut index = Index::default();
    records.rewind()?;
    loop {
        match records.advance() {
            Ok(Some(place)) if place.opcode == op::CHUNK => {
                let first_time = Fields::new(&records.body).u64();
                index.chunks.extend(first_time.map(|first_time| IndexedChunk {
                    first_time,
                    offset: place.offset,
                    channels: ChannelSet::ALL,
                }));
            }
            Ok(Some(place)) if place.opcode != op::DATA_END => {}
            Ok(_) => return Ok(index),
            Err(broken) => match resync::remedy(records.read(), &broken)? {
                resync::Remedy::GoOn(next) => records.seek(next)?,
                resync::Remedy::Cut | resync::Remedy::None => return Ok(index),
            },
        }
    }
}
