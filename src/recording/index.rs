use std::io::{self, Read, Seek, SeekFrom};

use mcap::{MAGIC, records::op};

use super::{
    Trailer,
    chunk_reader::ChunkRecord,
    decoder::Location,
    metadata,
    record_reader::{FieldReader, Malformed, PREFIX_BYTES, RecordReader},
    resync::{self, Resync},
    tally::{ChunkSummary, Statistics},
    topic::Topic,
};

/// The index of a recording, for random access.
#[derive(Default)]
pub struct Index {
    /// The chunks in file order; for messages outside of chunks, the keyframes.
    pub places: Vec<Place>,
    /// Opcode and body of the schemas and channels of rebond, which are otherwise only before their first message.
    pub definitions: Vec<(u8, Vec<u8>)>,
    /// True if there are messages outside of chunks, which are not in the index except for keyframes.
    pub has_loose_messages: bool,
    /// The latest time of the messages outside of chunks and of the chunks before them, in simulated nanoseconds.
    latest: u64,
    /// True if messages outside of chunks are not in order of time.
    is_disordered: bool,
    /// True if the summary section is damaged, contradicts itself or the end record, or is cut off, or if a scan has
    /// found damage. The summary is then not used, and only reading the whole file finds the damage.
    pub is_doubtful: bool,
    /// The end record, if it is readable.
    pub trailer: Option<Trailer>,
    /// The location and the body of the end record, if it is readable.
    pub trailer_record: Option<(Location, Vec<u8>)>,
    /// The offset of the end record, in bytes from the start of the file.
    trailer_offset: Option<u64>,
    statistics: Option<Statistics>,
}

/// A place in the file at which reading can begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The offset of the record, in bytes from the start of the file.
    pub offset: u64,
    /// The time of the first message, in simulated nanoseconds.
    pub first_time: u64,
    /// The time of the last message of the chunk, in simulated nanoseconds.
    pub last_time: u64,
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
    /// Returns the summary, or `None` if the file has no usable summary section or no readable end record.
    pub fn summary(&self) -> Option<Summary> {
        let statistics = self.statistics.as_ref()?;
        Some(Summary {
            trailer: self.trailer.clone()?,
            states: self.message_count(statistics, Topic::States),
            keyframes: self.message_count(statistics, Topic::Bodies),
            chunks: self.places.len() as u64,
        })
    }

    /// Returns true if the index is that of the summary section.
    pub fn is_usable(&self) -> bool {
        self.statistics.is_some()
    }

    /// Returns true if the chunks and the messages outside of chunks are in order of time.
    pub fn is_in_order(&self) -> bool {
        !self.is_disordered && self.places.windows(2).all(|pair| pair[0].last_time <= pair[1].first_time)
    }

    /// Reads the end record.
    fn read_trailer<R: Read + Seek>(&mut self, records: &mut RecordReader<R>) -> io::Result<()> {
        let end = records.source().seek(SeekFrom::End(0))?;
        // A damaged offset can be one that no file has, to which the operating system refuses to move.
        let Some(offset) = self.trailer_offset.filter(|offset| *offset < end) else { return Ok(()) };
        records.seek(offset)?;
        let is_metadata = matches!(records.next_record(), Ok(Some(record)) if record.opcode == op::METADATA);
        self.trailer = is_metadata.then(|| metadata::trailer_of(&records.body)).flatten();
        self.trailer_record = self.trailer.as_ref().map(|_| (Location { chunk: None, offset }, records.body.clone()));
        Ok(())
    }

    fn message_count(&self, statistics: &Statistics, topic: Topic) -> u64 {
        self.channels_of(topic).filter_map(|channel| statistics.channel_messages.get(&channel)).sum()
    }

    /// Returns true if a place may contain messages of a topic.
    pub fn may_contain(&self, place: usize, topic: Topic) -> bool {
        // An index without statistics was built by scanning.
        self.statistics.is_none()
            || self.channels_of(topic).any(|channel| self.places[place].channels.contains(channel))
    }

    /// Returns true if the first message of a topic at some time may be at a place. A place whose messages all have the
    /// time at which the place before it ends only continues that one.
    pub fn may_begin(&self, place: usize, topic: Topic) -> bool {
        let continues = |previous: usize| self.places[previous].last_time == self.places[place].last_time;
        self.may_contain(place, topic) && !place.checked_sub(1).is_some_and(continues)
    }

    fn channels_of(&self, topic: Topic) -> impl Iterator<Item = u16> {
        let channels = self.definitions.iter().filter(|(opcode, _)| *opcode == op::CHANNEL);
        channels.filter_map(|(_, body)| topic_of(body)).filter_map(move |(id, found)| (found == topic).then_some(id))
    }

    /// Adds a schema or channel that is one of rebond.
    fn define(&mut self, opcode: u8, body: &[u8]) {
        let is_ours = match opcode {
            op::CHANNEL => topic_of(body).is_some(),
            _ => schema_name(body).is_ok_and(|name| Topic::ALL.iter().any(|topic| topic.schema_name() == name)),
        };
        /// More definitions than a valid file needs.
        const MANY: usize = 256;
        if is_ours
            && self.definitions.len() < MANY
            && !self.definitions.iter().any(|(known, defined)| (*known, defined.as_slice()) == (opcode, body))
        {
            self.definitions.push((opcode, body.into()));
        }
    }

    /// Returns true if the summary section contradicts itself or the end record.
    fn is_contradictory(&self, data_end: u64, indexed_messages: Option<u64>) -> bool {
        let Some(statistics) = &self.statistics else { return false };
        let [.., chunks] = statistics.counts;
        let has_channels =
            Topic::ALL.into_iter().filter(|topic| topic.is_mandatory()).all(|t| self.channels_of(t).next().is_some());
        let is_ordered = self.places.windows(2).all(|pair| pair[0].offset < pair[1].offset)
            && self.places.last().is_none_or(|last| last.offset < data_end);
        let matches_trailer = self.trailer.as_ref().filter(|trailer| !trailer.recovered).is_none_or(|trailer| {
            let declared = [(Topic::States, trailer.steps + 1), (Topic::Events, trailer.events)];
            declared.into_iter().all(|(topic, count)| self.message_count(statistics, topic) == count)
        });
        !(has_channels
            && chunks == self.places.len() as u64
            && is_ordered
            && indexed_messages.is_none_or(|indexed| indexed == statistics.messages)
            && matches_trailer)
    }
}

/// Returns id and topic of a channel, if it is one of rebond.
fn topic_of(body: &[u8]) -> Option<(u16, Topic)> {
    let mut fields = FieldReader::new(body);
    let (id, _schema, name) = (fields.u16().ok()?, fields.u16().ok()?, fields.text().ok()?);
    Topic::from_name(name).map(|topic| (id, topic))
}

/// Returns the name in a schema record.
///
/// # Errors
/// Returns an error if the record is too short.
pub fn schema_name(body: &[u8]) -> Result<&str, Malformed> {
    let mut fields = FieldReader::new(body);
    let _id = fields.u16()?;
    fields.text()
}

impl ChannelSet {
    /// All channels, for chunks whose channels are unknown.
    const ALL: ChannelSet = ChannelSet(u16::MAX);

    fn of(channels: impl Iterator<Item = u16>) -> ChannelSet {
        ChannelSet(channels.map(ChannelSet::bit).fold(0, |set, bit| set | bit))
    }

    fn contains(self, channel: u16) -> bool {
        self.0 & ChannelSet::bit(channel) != 0
    }

    fn bit(channel: u16) -> u16 {
        1 << channel.min(15)
    }
}

/// Reads the index in the summary section of a finished recording. If there is none, or if it is doubtful, builds the
/// index by scanning all records, without opening chunks.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn read<R: Read + Seek>(records: &mut RecordReader<R>) -> io::Result<Index> {
    let tail = tail(records.source())?;
    let summary = match tail {
        Tail::Summary(start) => from_summary(records, start)?,
        Tail::Footer | Tail::Cut => Err(Unusable::Absent),
    };
    match summary {
        Ok(index) => Ok(index),
        Err(unusable) => {
            let mut index = scan(records)?;
            index.read_trailer(records)?;
            // Without an end record, the end is missing anyway.
            index.is_doubtful |= unusable == Unusable::Doubtful || tail == Tail::Cut && index.trailer.is_some();
            Ok(index)
        }
    }
}

/// The reason why a summary section is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unusable {
    /// There is none, or it has no index of the chunks.
    Absent,
    /// It is damaged or contradicts itself or the end record.
    Doubtful,
}

/// The end of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tail {
    /// A footer that refers to a summary section at this offset.
    Summary(u64),
    /// A footer without a summary section.
    Footer,
    /// Something else.
    Cut,
}

/// Bytes of the data end record, which precedes the summary section.
const DATA_END_BYTES: u64 = PREFIX_BYTES as u64 + 4;

/// Bytes of a footer record.
const FOOTER_BYTES: usize = PREFIX_BYTES + 20;

/// Reads the footer of a file.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn tail<R: Read + Seek>(source: &mut R) -> io::Result<Tail> {
    const TAIL: usize = FOOTER_BYTES + MAGIC.len();
    let length = source.seek(SeekFrom::End(0))?;
    let Some(start) = length.checked_sub(TAIL as u64) else { return Ok(Tail::Cut) };
    source.seek(SeekFrom::Start(start))?;
    let mut tail = [0; TAIL];
    resync::read_up_to(source, &mut tail)?;
    Ok(match parse_footer(&tail) {
        Ok(0) => Tail::Footer,
        Ok(summary) if (DATA_END_BYTES..start).contains(&summary) => Tail::Summary(summary),
        Ok(_) | Err(Malformed) => Tail::Cut,
    })
}

fn parse_footer(tail: &[u8]) -> Result<u64, Malformed> {
    let mut fields = FieldReader::new(tail);
    match (fields.bytes(1)?, fields.u64()?) {
        ([op::FOOTER], 20) => fields.u64(),
        _ => Err(Malformed),
    }
}

/// Reads the summary section, which starts at `start`.
fn from_summary<R: Read + Seek>(records: &mut RecordReader<R>, start: u64) -> io::Result<Result<Index, Unusable>> {
    records.seek(start - DATA_END_BYTES)?;
    let mut index = Index::default();
    let mut indexed_messages = Some(0);
    loop {
        match records.next_record() {
            Ok(None) => break,
            Ok(Some(record)) => {
                if index.add_record(record.opcode, &records.body, &mut indexed_messages).is_err() {
                    return Ok(Err(Unusable::Doubtful));
                }
            }
            Err(_) => return Ok(Err(Unusable::Doubtful)),
        }
    }
    let has_chunks = index.statistics.as_ref().is_some_and(|statistics| statistics.counts[4] > 0);
    if !has_chunks || index.places.is_empty() {
        // Other programs may leave out the chunks or their index.
        return Ok(Err(Unusable::Absent));
    }
    index.read_trailer(records)?;
    let has_lost_trailer = index.trailer_offset.is_some() && index.trailer.is_none();
    Ok(if has_lost_trailer || index.is_contradictory(start, indexed_messages) {
        Err(Unusable::Doubtful)
    } else {
        Ok(index)
    })
}

impl Index {
    /// Adds a record of the summary section. `messages` counts the messages in the message indexes of the chunks, if
    /// all chunks have them.
    fn add_record(&mut self, opcode: u8, body: &[u8], messages: &mut Option<u64>) -> Result<(), Malformed> {
        match opcode {
            op::CHUNK_INDEX => {
                let chunk = ChunkSummary::parse(body)?;
                *messages = messages.zip(messages_of(&chunk)).and_then(|(sum, more)| sum.checked_add(more));
                self.places.push(place(&chunk));
            }
            op::SCHEMA | op::CHANNEL => self.define(opcode, body),
            op::STATISTICS => self.statistics = Some(Statistics::parse(body)?),
            op::METADATA_INDEX => self.trailer_offset = parse_trailer_offset(body)?.or(self.trailer_offset),
            _ => {}
        }
        Ok(())
    }
}

fn place(chunk: &ChunkSummary) -> Place {
    let channels = if chunk.message_indexes.is_empty() {
        ChannelSet::ALL
    } else {
        ChannelSet::of(chunk.message_indexes.keys().copied())
    };
    Place { offset: chunk.offset, first_time: chunk.first_time, last_time: chunk.last_time, channels }
}

/// Returns the number of messages of a chunk according to the length of its message indexes, if it has any.
fn messages_of(chunk: &ChunkSummary) -> Option<u64> {
    /// Bytes of a message index without entries, and of an entry.
    const EMPTY: u64 = PREFIX_BYTES as u64 + 2 + 4;
    const ENTRY: u64 = 16;
    let indexes = chunk.message_indexes.len() as u64;
    let entries = chunk.message_index_length.checked_sub(indexes * EMPTY)?;
    (indexes > 0 && entries.is_multiple_of(ENTRY)).then_some(entries / ENTRY)
}

/// Returns the offset in a metadata index record, if it is the one of the end record.
fn parse_trailer_offset(body: &[u8]) -> Result<Option<u64>, Malformed> {
    let mut fields = FieldReader::new(body);
    let (offset, _length) = (fields.u64()?, fields.u64()?);
    Ok((fields.text()? == metadata::TRAILER).then_some(offset))
}

fn scan<R: Read + Seek>(records: &mut RecordReader<R>) -> io::Result<Index> {
    let mut index = Index::default();
    records.rewind()?;
    loop {
        match records.next_record() {
            Ok(Some(record)) if record.opcode == op::DATA_END => return Ok(index),
            Ok(Some(record)) => index.add_scanned(record.opcode, record.offset, &records.body),
            Ok(None) => return Ok(index),
            Err(fault) => match resync::resync(records, &fault)? {
                Resync::ContinueAt(next) => {
                    index.is_doubtful = true;
                    records.seek(next)?;
                }
                Resync::Corrupt => {
                    index.is_doubtful = true;
                    return Ok(index);
                }
                Resync::Truncated => return Ok(index),
            },
        }
    }
}

impl Index {
    /// Adds a record of the data section.
    fn add_scanned(&mut self, opcode: u8, offset: u64, body: &[u8]) {
        match opcode {
            op::CHUNK => {
                let mut times = FieldReader::new(body);
                if let (Ok(first_time), Ok(last_time)) = (times.u64(), times.u64()) {
                    self.is_disordered |= first_time < self.latest;
                    self.latest = self.latest.max(last_time);
                    self.places.push(Place { offset, first_time, last_time, channels: ChannelSet::ALL });
                }
            }
            op::SCHEMA | op::CHANNEL => self.define(opcode, body),
            op::MESSAGE => {
                self.has_loose_messages = true;
                let record = ChunkRecord { opcode, body };
                let Some(message) = record.message() else { return };
                self.is_disordered |= message.log_time < self.latest;
                self.latest = self.latest.max(message.log_time);
                if self.channels_of(Topic::Bodies).any(|channel| channel == message.channel)
                    && self.places.last().is_none_or(|last| last.last_time != message.log_time)
                {
                    let (first_time, last_time) = (message.log_time, message.log_time);
                    self.places.push(Place { offset, first_time, last_time, channels: ChannelSet::ALL });
                }
            }
            op::METADATA if metadata::is_trailer(body) => {
                self.trailer_offset = Some(offset);
            }
            _ => {}
        }
    }
}
