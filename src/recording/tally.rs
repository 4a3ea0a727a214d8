use std::collections::BTreeMap;

use mcap::records::op;
use xxhash_rust::xxh3::xxh3_64;

use super::{
    chunk_reader::ChunkRecord,
    record_reader::{FieldReader, Malformed, PREFIX_BYTES},
};

/// Counts the records of the data section, and compares them with the summary section.
///
/// Needs a constant amount of memory: entries of the index are compared by the sum of their hashes.
#[derive(Default)]
pub struct Tally {
    data: Records,
    summary: Records,
    statistics: Option<Statistics>,
    /// The number of records of the summary section.
    summary_records: u64,
    layout: SummaryLayout,
}

/// The places of the records after the data section, and the places that the summary declares.
#[derive(Default)]
struct SummaryLayout {
    /// The first byte after the data section.
    start: u64,
    /// The first byte of each kind of record, and the first byte after the last one.
    groups: BTreeMap<u8, (u64, u64)>,
    /// The kind, first byte and length of the groups that the summary offset records list.
    listed: Vec<(u8, u64, u64)>,
    /// The offset of the first summary offset record.
    offsets_start: Option<u64>,
    /// The offset of the footer, and its offsets of the summary section and of the summary offset records.
    footer: Option<(u64, u64, u64)>,
}

/// The records of one section.
#[derive(Default)]
struct Records {
    /// The hash of each definition, by its id.
    schemas: BTreeMap<u16, u64>,
    channels: BTreeMap<u16, u64>,
    chunks: Entries,
    attachments: Entries,
    metadata: Entries,
    messages: BTreeMap<u16, u64>,
    times: Option<(u64, u64)>,
}

/// A number of entries and the sum of their hashes, which does not depend on their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Entries {
    count: u64,
    sum: u64,
}

/// The contents of a chunk index record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChunkSummary {
    /// The log time of the first message, in simulated nanoseconds.
    pub first_time: u64,
    /// The log time of the last message, in simulated nanoseconds.
    pub last_time: u64,
    /// The offset of the chunk record, in bytes from the start of the file.
    pub offset: u64,
    /// The length of the chunk record in bytes.
    pub length: u64,
    /// The offsets of the message indexes, by channel.
    pub message_indexes: BTreeMap<u16, u64>,
    /// The length of all message indexes in bytes.
    pub message_index_length: u64,
    /// The name of the compression; empty for none.
    pub compression: String,
    /// The length of the compressed records in bytes.
    pub compressed_size: u64,
    /// The length of the uncompressed records in bytes.
    pub uncompressed_size: u64,
}

/// The contents of a statistics record.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// The number of messages.
    pub messages: u64,
    /// The numbers of schemas, channels, attachments, metadata records and chunks.
    pub counts: [u64; 5],
    /// The log times of the first and last message, in simulated nanoseconds.
    pub times: (u64, u64),
    /// The number of messages of each channel.
    pub channel_messages: BTreeMap<u16, u64>,
}

impl Tally {
    /// Adds a schema, channel or message of the data section, inside or outside of a chunk.
    pub fn add_record(&mut self, record: &ChunkRecord<'_>) {
        match record.opcode {
            op::SCHEMA => self.data.schemas.extend(definition(record.opcode, record.body)),
            op::CHANNEL => self.data.channels.extend(definition(record.opcode, record.body)),
            op::MESSAGE => {
                if let Some(message) = record.message() {
                    *self.data.messages.entry(message.channel).or_default() += 1;
                    let (first, last) = self.data.times.unwrap_or((message.log_time, message.log_time));
                    self.data.times = Some((first.min(message.log_time), last.max(message.log_time)));
                }
            }
            _ => {}
        }
    }

    /// Adds a chunk of the data section.
    pub fn add_chunk(&mut self, chunk: &ChunkSummary) {
        self.data.chunks.add(&chunk.bytes());
    }

    /// Notes the first byte after the data section.
    pub fn end_data(&mut self, end: u64) {
        self.layout.start = end;
    }

    /// Adds an attachment or a metadata record of the data section, which starts at `offset`.
    pub fn add_indexed(&mut self, opcode: u8, offset: u64, body: &[u8]) {
        self.add_entry(opcode, &entry(opcode, offset, body));
    }

    /// Adds the entry of an attachment or a metadata record.
    pub fn add_entry(&mut self, opcode: u8, entry: &[u8]) {
        match opcode {
            op::ATTACHMENT => self.data.attachments.add(entry),
            _ => self.data.metadata.add(entry),
        }
    }

    /// Adds a record of the summary section, which starts at `offset`.
    ///
    /// # Errors
    /// Returns an error if the record is malformed.
    pub fn add_summary_record(&mut self, opcode: u8, offset: u64, body: &[u8]) -> Result<(), Malformed> {
        self.layout.add(opcode, offset, body)?;
        match opcode {
            op::SCHEMA => self.summary.schemas.extend([definition(opcode, body)?]),
            op::CHANNEL => self.summary.channels.extend([definition(opcode, body)?]),
            op::CHUNK_INDEX => self.summary.chunks.add(&ChunkSummary::parse(body)?.bytes()),
            op::ATTACHMENT_INDEX => {
                let mut fields = FieldReader::new(body);
                let mut bytes = fields.bytes(5 * 8)?.to_vec();
                for _ in 0..2 {
                    bytes.extend(text_field(fields.text()?));
                }
                self.summary.attachments.add(&bytes);
            }
            op::METADATA_INDEX => {
                let mut fields = FieldReader::new(body);
                let place = fields.bytes(2 * 8)?;
                self.summary.metadata.add(&[place, &text_field(fields.text()?)].concat());
            }
            op::STATISTICS => self.statistics = Some(Statistics::parse(body)?),
            op::DATA_END | op::FOOTER | 0x80.. => return Ok(()),
            _ => {}
        }
        self.summary_records += 1;
        Ok(())
    }

    /// Returns a description of the first difference between the summary and the data section, if any. A summary may
    /// leave out the statistics and each kind of index.
    pub fn difference(&self) -> Option<String> {
        let Tally { data, summary, statistics, summary_records, layout } = self;
        if *summary_records == 0 {
            return layout.difference();
        }
        let lists = |what: &str, listed: u64, found: u64| {
            Some(format!("the summary lists {listed} {what}, but the file has {found}")).filter(|_| listed != found)
        };
        let entries = |what: &str, listed: Entries, found: Entries| match listed {
            Entries { count: 0, .. } => None,
            listed if listed == found => None,
            listed if listed.count == found.count => Some(format!("the summary does not match the {what} of the file")),
            listed => lists(what, listed.count, found.count),
        };
        let definitions = |what: &str, listed: &BTreeMap<u16, u64>, found: &BTreeMap<u16, u64>| {
            let (id, _) = listed.iter().find(|(id, hash)| found.get(id) != Some(hash))?;
            Some(format!("the summary has another {what} {id} than the file"))
        };
        // An index of chunks refers to channels; without one they need not be repeated.
        let has_channels = summary.chunks.count > 0 || !summary.channels.is_empty();
        lists("schemas", summary.schemas.len() as u64, data.schemas.len() as u64)
            .or_else(|| {
                lists("channels", summary.channels.len() as u64, data.channels.len() as u64).filter(|_| has_channels)
            })
            .or_else(|| definitions("schema", &summary.schemas, &data.schemas))
            .or_else(|| definitions("channel", &summary.channels, &data.channels).filter(|_| has_channels))
            .or_else(|| entries("chunks", summary.chunks, data.chunks))
            .or_else(|| entries("attachments", summary.attachments, data.attachments))
            .or_else(|| entries("metadata records", summary.metadata, data.metadata))
            .or_else(|| statistics.as_ref().and_then(|statistics| statistics.difference(data)))
            .or_else(|| layout.difference())
    }
}

impl SummaryLayout {
    /// Adds a record that starts at `offset`.
    fn add(&mut self, opcode: u8, offset: u64, body: &[u8]) -> Result<(), Malformed> {
        let end = offset + (PREFIX_BYTES + body.len()) as u64;
        let mut fields = FieldReader::new(body);
        match opcode {
            op::SUMMARY_OFFSET => {
                if self.listed.len() > usize::from(u8::MAX) {
                    return Err(Malformed); // There are not so many kinds of records.
                }
                let kind = *fields.bytes(1)?.first().ok_or(Malformed)?;
                self.listed.push((kind, fields.u64()?, fields.u64()?));
                self.offsets_start.get_or_insert(offset);
            }
            op::FOOTER => self.footer = Some((offset, fields.u64()?, fields.u64()?)),
            _ => self.groups.entry(opcode).or_insert((offset, end)).1 = end,
        }
        Ok(())
    }

    /// Returns a description of the first offset that does not match, if any.
    fn difference(&self) -> Option<String> {
        let is_wrong = |(kind, start, length): &&(u8, u64, u64)| match self.groups.get(kind) {
            Some((first, end)) => (first, end - first) != (start, *length),
            None => *length > 0,
        };
        if self.listed.iter().any(|listed| is_wrong(&listed)) {
            return Some("a summary offset does not match the summary".into());
        }
        let (footer, summary, offsets) = self.footer?;
        // Without records there, an offset is 0 or that of the place where they would be.
        let has_records = !self.groups.is_empty() || self.offsets_start.is_some();
        if summary != self.start && (has_records || ![0, footer].contains(&summary)) {
            return Some("the footer does not refer to the summary".into());
        }
        let is_right = self.offsets_start.map_or([0, footer].contains(&offsets), |start| start == offsets);
        (!is_right).then(|| "the footer does not refer to the summary offsets".into())
    }
}

impl Statistics {
    /// Parses a statistics record.
    pub fn parse(body: &[u8]) -> Result<Statistics, Malformed> {
        let mut fields = FieldReader::new(body);
        let messages = fields.u64()?;
        let schemas = u64::from(fields.u16()?);
        let [channels, attachments, metadata, chunks] = [fields.u32()?, fields.u32()?, fields.u32()?, fields.u32()?];
        let counts = [schemas, channels.into(), attachments.into(), metadata.into(), chunks.into()];
        let times = (fields.u64()?, fields.u64()?);
        let bytes = fields.u32()?;
        let mut pairs = FieldReader::new(fields.bytes(bytes.into())?);
        let mut channel_messages = BTreeMap::new();
        while !pairs.is_empty() {
            channel_messages.insert(pairs.u16()?, pairs.u64()?);
        }
        Ok(Statistics { messages, counts, times, channel_messages })
    }

    fn difference(&self, data: &Records) -> Option<String> {
        let counts = [
            data.schemas.len() as u64,
            data.channels.len() as u64,
            data.attachments.count,
            data.metadata.count,
            data.chunks.count,
        ];
        let names = ["schemas", "channels", "attachments", "metadata records", "chunks"];
        let pairs = names.into_iter().zip(self.counts.into_iter().zip(counts));
        let messages = ("messages", (self.messages, data.messages.values().sum()));
        let mut all = pairs.chain([messages]);
        if let Some((what, (listed, found))) = all.find(|(_, (listed, found))| listed != found) {
            return Some(format!("the statistics count {listed} {what}, but the file has {found}"));
        }
        let mut listed = self.channel_messages.clone();
        listed.retain(|_, count| *count > 0);
        if !listed.is_empty() && listed != data.messages {
            return Some("the statistics count other messages on a channel than the file has".into());
        }
        (self.times != data.times.unwrap_or_default()).then(|| "the times in the statistics are wrong".into())
    }
}

impl ChunkSummary {
    /// Parses a chunk index record.
    pub fn parse(body: &[u8]) -> Result<ChunkSummary, Malformed> {
        let mut fields = FieldReader::new(body);
        let [first_time, last_time, offset, length] = [fields.u64()?, fields.u64()?, fields.u64()?, fields.u64()?];
        let bytes = fields.u32()?;
        let mut pairs = FieldReader::new(fields.bytes(bytes.into())?);
        let mut message_indexes = BTreeMap::new();
        while !pairs.is_empty() {
            message_indexes.insert(pairs.u16()?, pairs.u64()?);
        }
        Ok(ChunkSummary {
            first_time,
            last_time,
            offset,
            length,
            message_indexes,
            message_index_length: fields.u64()?,
            compression: fields.text()?.into(),
            compressed_size: fields.u64()?,
            uncompressed_size: fields.u64()?,
        })
    }

    fn bytes(&self) -> Vec<u8> {
        let numbers = [
            self.first_time,
            self.last_time,
            self.offset,
            self.length,
            self.message_index_length,
            self.compressed_size,
            self.uncompressed_size,
        ];
        let indexes = self.message_indexes.iter().flat_map(|(channel, offset)| [u64::from(*channel), *offset]);
        let mut bytes: Vec<u8> = numbers.into_iter().chain(indexes).flat_map(u64::to_le_bytes).collect();
        bytes.extend(self.compression.as_bytes());
        bytes
    }
}

impl Entries {
    fn add(&mut self, bytes: &[u8]) {
        self.count += 1;
        self.sum = self.sum.wrapping_add(xxh3_64(bytes));
    }
}

/// Returns the id of a schema or channel, and the hash of its fields. The order of the metadata of a channel is free.
fn definition(opcode: u8, body: &[u8]) -> Result<(u16, u64), Malformed> {
    let mut fields = FieldReader::new(body);
    let id = fields.u16()?;
    let bytes = match opcode {
        op::SCHEMA => {
            let texts = [text_field(fields.text()?), text_field(fields.text()?)].concat();
            let length = fields.u32()?;
            [texts.as_slice(), fields.bytes(length.into())?].concat()
        }
        _ => {
            let schema = fields.bytes(2)?;
            let names = [text_field(fields.text()?), text_field(fields.text()?)].concat();
            let metadata = fields.map()?.into_iter().flat_map(|(key, value)| [text_field(&key), text_field(&value)]);
            [schema, &names, &metadata.flatten().collect::<Vec<u8>>()].concat()
        }
    };
    Ok((id, xxh3_64(&bytes)))
}

/// Returns the fields that the index of an attachment or a metadata record has, which starts at `offset`.
pub fn entry(opcode: u8, offset: u64, body: &[u8]) -> Vec<u8> {
    let length = (PREFIX_BYTES + body.len()) as u64;
    let place = [offset.to_le_bytes(), length.to_le_bytes()].concat();
    let fields = match opcode {
        op::ATTACHMENT => attachment_fields(body).unwrap_or_default(),
        _ => text_field(FieldReader::new(body).text().unwrap_or_default()),
    };
    [place, fields].concat()
}

/// Returns times, length, name and media type of an attachment, as in an attachment index.
fn attachment_fields(body: &[u8]) -> Result<Vec<u8>, Malformed> {
    let mut fields = FieldReader::new(body);
    let times = fields.bytes(2 * 8)?;
    let (name, media_type) = (fields.text()?, fields.text()?);
    let length = fields.u64()?.to_le_bytes();
    Ok([times, &length, &text_field(name), &text_field(media_type)].concat())
}

fn text_field(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}
