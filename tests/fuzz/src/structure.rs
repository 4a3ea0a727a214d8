//! The records of a recording, from which a file with valid lengths, checksums and index is written again.

use std::{
    collections::BTreeMap,
    io::{Cursor, Read, Write},
};

use lz4_flex::frame::{FrameDecoder, FrameEncoder};
use rebond::internals::recording::{Item, Recording, StateDigest};
use xxhash_rust::xxh3::Xxh3;

/// Opcodes of MCAP records.
mod op {
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const MESSAGE_INDEX: u8 = 0x07;
    pub const CHUNK_INDEX: u8 = 0x08;
    pub const ATTACHMENT: u8 = 0x09;
    pub const STATISTICS: u8 = 0x0b;
    pub const METADATA: u8 = 0x0c;
    pub const METADATA_INDEX: u8 = 0x0d;
    pub const DATA_END: u8 = 0x0f;
}

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// The records of a file in order, without the index and the summary.
pub struct Structure {
    pub parts: Vec<Part>,
}

/// A part of the data section.
pub enum Part {
    /// A record outside the chunks.
    Record(Record),
    /// The records of a chunk.
    Chunk(Vec<Record>),
}

#[derive(Clone)]
pub struct Record {
    pub opcode: u8,
    pub fields: Vec<u8>,
}

/// The index and summary at the end of a file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Summary {
    Written,
    Missing,
}

/// The compression of all chunks.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Compression {
    None,
    Zstd,
    Lz4,
}

impl Structure {
    /// Returns the records of a file up to the first that is damaged, or `None` if it is not an MCAP file.
    pub fn parse(file: &[u8]) -> Option<Structure> {
        let records = records(file.strip_prefix(MAGIC)?);
        let data = records.into_iter().take_while(|record| ![op::DATA_END, op::FOOTER].contains(&record.opcode));
        let parts = data.filter(|record| record.opcode != op::MESSAGE_INDEX).map(|record| match record.opcode {
            op::CHUNK => chunk_records(&record.fields).map_or(Part::Record(record), Part::Chunk),
            _ => Part::Record(record),
        });
        Some(Structure { parts: parts.collect() })
    }

    /// Returns every record, also those in chunks.
    pub fn records_mut(&mut self) -> Vec<&mut Record> {
        let records = self.parts.iter_mut().flat_map(|part| match part {
            Part::Record(record) => std::slice::from_mut(record).iter_mut(),
            Part::Chunk(records) => records.iter_mut(),
        });
        records.collect()
    }

    /// Makes the digest of each state agree with its bodies, and the checksums of metadata and attachments with their
    /// contents.
    pub fn agree(&mut self) {
        let digests = self.digests();
        let states = self.states_channel();
        for record in self.records_mut() {
            match record.opcode {
                op::METADATA => with_checksum(&mut record.fields),
                op::ATTACHMENT => {
                    if let Some((fields, crc)) = record.fields.split_last_chunk_mut::<4>() {
                        *crc = crc32fast::hash(fields).to_le_bytes();
                    }
                }
                op::MESSAGE if states.is_some_and(|channel| record.channel() == Some(channel)) => {
                    let step = record.fields.get(STEP..DIGEST).map(u64_at_start);
                    if let (Some(digest), Some(place)) =
                        (step.and_then(|step| digests.get(&step)), record.fields.get_mut(DIGEST..DIGEST + 8))
                    {
                        place.copy_from_slice(&digest.to_le_bytes());
                    }
                }
                _ => {}
            }
        }
    }

    /// The right digests of the states that have another one, by step, as far as the bodies are known.
    fn digests(&self) -> BTreeMap<u64, u64> {
        let file = self.write(Summary::Missing, Compression::None);
        let Ok(mut recording) = Recording::read(Cursor::new(file.as_slice())) else { return BTreeMap::new() };
        let mut digests = BTreeMap::new();
        while let Some(Ok(item)) = recording.next() {
            if let (Item::SuspectState(state), Some(table)) = (item, recording.table()) {
                let mut digest = StateDigest::default();
                for (info, listed) in table.join_state(&state) {
                    digest.add(info.id, listed.unwrap_or(info.initial_state()));
                }
                digests.insert(state.step, digest.value());
            }
        }
        digests
    }

    /// The channel of the topic `/states`.
    fn states_channel(&self) -> Option<u16> {
        let records = self.parts.iter().flat_map(|part| match part {
            Part::Record(record) => std::slice::from_ref(record),
            Part::Chunk(records) => records.as_slice(),
        });
        let mut channels = records.filter(|record| record.opcode == op::CHANNEL);
        let channel = channels.find(|record| record.fields.get(8..15) == Some(b"/states"))?;
        channel.channel()
    }

    /// Returns a file of these records.
    pub fn write(&self, summary: Summary, compression: Compression) -> Vec<u8> {
        let mut file = MAGIC.to_vec();
        let mut index = SummaryRecords::default();
        for part in &self.parts {
            match part {
                Part::Record(record) => {
                    index.add_record(record, file.len());
                    record.push_to(&mut file);
                }
                Part::Chunk(records) => push_chunk(&mut file, records, compression, &mut index),
            }
        }
        let crc = crc32fast::hash(&file);
        push(&mut file, op::DATA_END, &crc.to_le_bytes());
        let start = file.len();
        let records = if summary == Summary::Written { index.records() } else { Vec::new() };
        for record in &records {
            record.push_to(&mut file);
        }
        let start_field = if records.is_empty() { 0 } else { start as u64 };
        let mut footer = [start_field, 0].map(u64::to_le_bytes).concat();
        let mut covered = file[start..].to_vec();
        covered.push(op::FOOTER);
        covered.extend(20_u64.to_le_bytes());
        covered.extend(&footer);
        footer.extend(crc32fast::hash(&covered).to_le_bytes());
        push(&mut file, op::FOOTER, &footer);
        file.extend(MAGIC);
        file
    }
}

/// Offsets of step and digest in the fields of a message of `/states`.
const STEP: usize = 22 + 4;
const DIGEST: usize = STEP + 8;

impl Record {
    fn push_to(&self, file: &mut Vec<u8>) {
        push(file, self.opcode, &self.fields);
    }

    /// The id of the channel, if this is a message or a channel.
    fn channel(&self) -> Option<u16> {
        Some(u16::from_le_bytes(*self.fields.first_chunk()?))
    }

    /// The log time, if this is a message (ns).
    fn log_time(&self) -> Option<u64> {
        (self.opcode == op::MESSAGE).then(|| self.fields.get(6..14).map(u64_at_start)).flatten()
    }
}

/// The records of the summary section.
#[derive(Default)]
struct SummaryRecords {
    schemas_and_channels: Vec<Record>,
    counts: BTreeMap<u16, u64>,
    times: Option<(u64, u64)>,
    chunks: Vec<Record>,
    attachments: u32,
    metadata: Vec<Record>,
}

impl SummaryRecords {
    fn add_record(&mut self, record: &Record, offset: usize) {
        match record.opcode {
            op::SCHEMA | op::CHANNEL => self.schemas_and_channels.push(record.clone()),
            op::ATTACHMENT => self.attachments += 1,
            op::METADATA => {
                let mut fields = [offset as u64, record.fields.len() as u64 + 9].map(u64::to_le_bytes).concat();
                let name = text(&record.fields).unwrap_or_default();
                fields.extend((name.len() as u32).to_le_bytes());
                fields.extend(name);
                self.metadata.push(Record { opcode: op::METADATA_INDEX, fields });
            }
            op::MESSAGE => {
                if let (Some(channel), Some(time)) = (record.channel(), record.log_time()) {
                    *self.counts.entry(channel).or_default() += 1;
                    self.times = Some(self.times.map_or((time, time), |(a, b)| (a.min(time), b.max(time))));
                }
            }
            _ => {}
        }
    }

    fn records(mut self) -> Vec<Record> {
        // Schemas come first, and each once.
        self.schemas_and_channels.sort_by_key(|record| (record.opcode, record.channel()));
        self.schemas_and_channels.dedup_by_key(|record| (record.opcode, record.channel()));
        let count = |opcode| self.schemas_and_channels.iter().filter(|record| record.opcode == opcode).count() as u32;
        let (first, last) = self.times.unwrap_or_default();
        let mut statistics = self.counts.values().sum::<u64>().to_le_bytes().to_vec();
        statistics.extend((count(op::SCHEMA) as u16).to_le_bytes());
        let counts = [count(op::CHANNEL), self.attachments, self.metadata.len() as u32, self.chunks.len() as u32];
        statistics.extend(counts.map(u32::to_le_bytes).concat());
        statistics.extend([first, last].map(u64::to_le_bytes).concat());
        statistics.extend((self.counts.len() as u32 * 10).to_le_bytes());
        for (channel, count) in &self.counts {
            statistics.extend(channel.to_le_bytes());
            statistics.extend(count.to_le_bytes());
        }
        let mut records = self.schemas_and_channels;
        records.push(Record { opcode: op::STATISTICS, fields: statistics });
        records.extend(self.chunks);
        records.extend(self.metadata);
        records
    }
}

/// Adds a chunk and the index of its messages.
fn push_chunk(file: &mut Vec<u8>, records: &[Record], compression: Compression, summary: &mut SummaryRecords) {
    let mut data = Vec::new();
    let mut times: Option<(u64, u64)> = None;
    let mut entries: BTreeMap<u16, Vec<u8>> = BTreeMap::new();
    for record in records {
        summary.add_record(record, 0);
        if let (Some(channel), Some(time)) = (record.channel(), record.log_time()) {
            times = Some(times.map_or((time, time), |(first, last)| (first.min(time), last.max(time))));
            entries.entry(channel).or_default().extend([time, data.len() as u64].map(u64::to_le_bytes).concat());
        }
        record.push_to(&mut data);
    }
    let (first, last) = times.unwrap_or_default();
    let (name, compressed) = match compression {
        Compression::None => (&b""[..], data.clone()),
        Compression::Zstd => (&b"zstd"[..], zstd::bulk::compress(&data, 1).expect("memory")),
        Compression::Lz4 => {
            let mut encoder = FrameEncoder::new(Vec::new());
            encoder.write_all(&data).expect("memory");
            (&b"lz4"[..], encoder.finish().expect("memory"))
        }
    };
    let mut fields = [first, last, data.len() as u64].map(u64::to_le_bytes).concat();
    fields.extend(crc32fast::hash(&data).to_le_bytes());
    fields.extend((name.len() as u32).to_le_bytes());
    fields.extend(name);
    fields.extend((compressed.len() as u64).to_le_bytes());
    fields.extend(&compressed);
    let offset = file.len() as u64;
    push(file, op::CHUNK, &fields);
    let indexes_start = file.len() as u64;
    let mut offsets = Vec::new();
    for (channel, entries) in entries {
        offsets.extend(channel.to_le_bytes());
        offsets.extend((file.len() as u64).to_le_bytes());
        let length = (entries.len() as u32).to_le_bytes();
        push(file, op::MESSAGE_INDEX, &[&channel.to_le_bytes()[..], &length, &entries].concat());
    }
    let mut index = [first, last, offset, indexes_start - offset].map(u64::to_le_bytes).concat();
    index.extend((offsets.len() as u32).to_le_bytes());
    index.extend(offsets);
    index.extend((file.len() as u64 - indexes_start).to_le_bytes());
    index.extend((name.len() as u32).to_le_bytes());
    index.extend(name);
    index.extend([compressed.len() as u64, data.len() as u64].map(u64::to_le_bytes).concat());
    summary.chunks.push(Record { opcode: op::CHUNK_INDEX, fields: index });
}

fn push(file: &mut Vec<u8>, opcode: u8, fields: &[u8]) {
    file.push(opcode);
    file.extend((fields.len() as u64).to_le_bytes());
    file.extend(fields);
}

/// Splits bytes into records, up to the first that is incomplete.
fn records(mut bytes: &[u8]) -> Vec<Record> {
    let mut records = Vec::new();
    while let Some((&opcode, rest)) = bytes.split_first()
        && let Some((length, rest)) = rest.split_first_chunk()
        && let Ok(length) = usize::try_from(u64::from_le_bytes(*length))
        && let Some((fields, rest)) = rest.split_at_checked(length)
    {
        records.push(Record { opcode, fields: fields.into() });
        bytes = rest;
    }
    records
}

/// Returns the records of a chunk, if it can be decompressed.
fn chunk_records(fields: &[u8]) -> Option<Vec<Record>> {
    const MAX_BYTES: usize = 1 << 20;
    let (_times_size_and_checksum, rest) = fields.split_at_checked(28)?;
    let compression = text(rest)?;
    let data = rest.get(4 + compression.len() + 8..)?;
    match compression {
        b"" => Some(records(data)),
        b"zstd" => Some(records(&zstd::bulk::decompress(data, MAX_BYTES).ok()?)),
        b"lz4" => {
            let mut bytes = Vec::new();
            FrameDecoder::new(data).take(MAX_BYTES as u64).read_to_end(&mut bytes).ok()?;
            Some(records(&bytes))
        }
        _ => None,
    }
}

/// Returns the length-prefixed text at the start.
fn text(bytes: &[u8]) -> Option<&[u8]> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.get(..usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

fn u64_at_start(bytes: &[u8]) -> u64 {
    u64::from_le_bytes(*bytes.first_chunk().expect("eight bytes"))
}

/// Replaces the value of the key `checksum` in metadata by the right one.
fn with_checksum(fields: &mut [u8]) {
    const KEY: &[u8] = b"checksum";
    let Some(pairs_start) = text(fields).map(|name| 4 + name.len() + 4) else { return };
    let mut pairs = BTreeMap::new();
    let mut place = None;
    let mut offset = pairs_start;
    while let Some(key) = fields.get(offset..).and_then(text)
        && let Some(value) = fields.get(offset + 4 + key.len()..).and_then(text)
    {
        let start = offset + 4 + key.len() + 4;
        match key {
            KEY => place = Some(start..start + value.len()),
            _ => _ = pairs.insert(key, value),
        }
        offset = start + value.len();
    }
    let mut sum = Xxh3::new();
    for part in pairs.into_iter().flat_map(|(key, value)| [key, value]) {
        sum.update(&(part.len() as u64).to_le_bytes());
        sum.update(part);
    }
    let sum = format!("{:016x}", sum.digest());
    if let Some(place) = place.filter(|place| place.len() == sum.len()) {
        fields[place].copy_from_slice(sum.as_bytes());
    }
}
