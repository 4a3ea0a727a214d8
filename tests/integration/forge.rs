//! Takes recordings apart into their MCAP records and puts altered records together again, with all checksums, indexes
//! and the summary computed anew.

use rebond::internals::{
    physics::CollisionCount,
    recording::Recording,
    replay::{ALL_STEPS, Replayer},
};
use std::{collections::BTreeMap, io::Cursor};
use xxhash_rust::xxh3::Xxh3;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Opcodes of MCAP records.
pub mod op {
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const MESSAGE_INDEX: u8 = 0x07;
    pub const ATTACHMENT: u8 = 0x09;
    pub const METADATA: u8 = 0x0c;
    pub const METADATA_INDEX: u8 = 0x0d;
    pub const SUMMARY_OFFSET: u8 = 0x0e;
    pub const DATA_END: u8 = 0x0f;
}

/// One record: opcode and fields.
pub type Record = (u8, Vec<u8>);

/// A record of the data section.
#[derive(Clone, Debug)]
pub enum Item {
    /// The records of a chunk.
    Chunk(Vec<Record>),
    /// Any other record.
    Record(Record),
}

/// How chunks are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    Zstd,
    Lz4,
    Uncompressed,
    /// Messages outside of chunks.
    Unchunked,
}

/// Splits records.
fn records(mut bytes: &[u8]) -> Vec<Record> {
    let mut records = Vec::new();
    while bytes.len() > 9 {
        let length = u64::from_le_bytes(bytes[1..9].try_into().unwrap()) as usize;
        records.push((bytes[0], bytes[9..9 + length].to_vec()));
        bytes = &bytes[9 + length..];
    }
    records
}

/// Returns the records of the data section.
pub fn take_apart(file: &[u8]) -> Vec<Item> {
    let mut items = Vec::new();
    for (opcode, body) in records(&file[MAGIC.len()..file.len() - MAGIC.len()]) {
        match opcode {
            op::DATA_END => break,
            op::MESSAGE_INDEX => {}
            op::CHUNK => {
                let name = u32::from_le_bytes(body[28..32].try_into().unwrap()) as usize;
                let size = u64::from_le_bytes(body[16..24].try_into().unwrap()) as usize;
                let data = zstd::bulk::decompress(&body[32 + name + 8..], size).unwrap();
                items.push(Item::Chunk(records(&data)));
            }
            _ => items.push(Item::Record((opcode, body))),
        }
    }
    items
}

fn encoded((opcode, body): &Record) -> Vec<u8> {
    [&[*opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

/// Everything that the summary of a file lists.
#[derive(Default)]
struct Summary {
    schemas: Vec<Record>,
    channels: Vec<Record>,
    chunks: Vec<Record>,
    attachments: Vec<Record>,
    metadata: Vec<Record>,
    times: Option<(u64, u64)>,
    messages: BTreeMap<u16, u64>,
}

impl Summary {
    fn add(&mut self, record: &Record) -> Option<(u16, u64)> {
        let (opcode, body) = record;
        match *opcode {
            op::SCHEMA if !self.schemas.contains(record) => self.schemas.push(record.clone()),
            op::CHANNEL if !self.channels.contains(record) => self.channels.push(record.clone()),
            op::MESSAGE => {
                let channel = u16::from_le_bytes(body[..2].try_into().unwrap());
                let time = u64::from_le_bytes(body[6..14].try_into().unwrap());
                let (first, last) = self.times.unwrap_or((time, time));
                self.times = Some((first.min(time), last.max(time)));
                *self.messages.entry(channel).or_default() += 1;
                return Some((channel, time));
            }
            _ => {}
        }
        None
    }

    fn statistics(&self) -> Record {
        let mut body = self.messages.values().sum::<u64>().to_le_bytes().to_vec();
        body.extend((self.schemas.len() as u16).to_le_bytes());
        for list in [&self.channels, &self.attachments, &self.metadata, &self.chunks] {
            body.extend((list.len() as u32).to_le_bytes());
        }
        let (first, last) = self.times.unwrap_or_default();
        body.extend([first, last].into_iter().flat_map(u64::to_le_bytes));
        body.extend((self.messages.len() as u32 * 10).to_le_bytes());
        for (channel, count) in &self.messages {
            body.extend(channel.to_le_bytes());
            body.extend(count.to_le_bytes());
        }
        (0x0b, body)
    }
}

/// Writes a file of these records.
pub fn put_together(items: &[Item], layout: Layout) -> Vec<u8> {
    let mut file = MAGIC.to_vec();
    let mut summary = Summary::default();
    for item in items {
        match item {
            Item::Record(record) => put_record(record, &mut file, &mut summary),
            Item::Chunk(records) if layout == Layout::Unchunked => {
                for record in records {
                    summary.add(record);
                    file.extend(encoded(record));
                }
            }
            Item::Chunk(records) => put_chunk(records, layout, &mut file, &mut summary),
        }
    }
    let checksum = crc32fast::hash(&file);
    file.extend(encoded(&(op::DATA_END, checksum.to_le_bytes().to_vec())));
    put_summary(&summary, &mut file);
    file.extend(MAGIC);
    file
}

fn put_record(record: &Record, file: &mut Vec<u8>, summary: &mut Summary) {
    let (opcode, body) = record;
    let place = [file.len() as u64, 9 + body.len() as u64].map(u64::to_le_bytes).concat();
    match *opcode {
        op::ATTACHMENT => {
            let name = u32::from_le_bytes(body[16..20].try_into().unwrap()) as usize;
            let (names, rest) = body[16..].split_at(4 + name);
            let kind = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
            let index = [&place, &body[..16], &rest[4 + kind..12 + kind], names, &rest[..4 + kind]].concat();
            summary.attachments.push((0x0a, index));
        }
        op::METADATA => {
            let name = u32::from_le_bytes(body[..4].try_into().unwrap()) as usize;
            summary.metadata.push((0x0d, [&place, &body[..4 + name]].concat()));
        }
        _ => drop(summary.add(record)),
    }
    file.extend(encoded(record));
}

fn put_chunk(records: &[Record], layout: Layout, file: &mut Vec<u8>, summary: &mut Summary) {
    let mut data = Vec::new();
    let mut index: BTreeMap<u16, Vec<[u64; 2]>> = BTreeMap::new();
    for record in records {
        if let Some((channel, time)) = summary.add(record) {
            index.entry(channel).or_default().push([time, data.len() as u64]);
        }
        data.extend(encoded(record));
    }
    let times = index.values().flatten().map(|[time, _]| *time);
    let times = [times.clone().min().unwrap_or(0), times.max().unwrap_or(0)].map(u64::to_le_bytes).concat();
    let (name, compressed) = match layout {
        Layout::Zstd => ("zstd", zstd::bulk::compress(&data, 1).unwrap()),
        Layout::Lz4 => {
            let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
            std::io::Write::write_all(&mut encoder, &data).unwrap();
            ("lz4", encoder.finish().unwrap())
        }
        Layout::Uncompressed | Layout::Unchunked => ("", data.clone()),
    };
    let sizes = [compressed.len() as u64, data.len() as u64].map(u64::to_le_bytes);
    let header = [&times[..], &sizes[1], &crc32fast::hash(&data).to_le_bytes(), &text(name), &sizes[0]].concat();
    let start = file.len() as u64;
    file.extend(encoded(&(op::CHUNK, [header, compressed].concat())));
    let end = file.len() as u64;
    let mut offsets = Vec::new();
    for (channel, entries) in &index {
        offsets.extend(channel.to_le_bytes());
        offsets.extend((file.len() as u64).to_le_bytes());
        let entries: Vec<u8> = entries.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        let body = [&channel.to_le_bytes()[..], &(entries.len() as u32).to_le_bytes(), &entries].concat();
        file.extend(encoded(&(op::MESSAGE_INDEX, body)));
    }
    let place = [start, end - start].map(u64::to_le_bytes).concat();
    let indexes =
        [&(offsets.len() as u32).to_le_bytes()[..], &offsets, &(file.len() as u64 - end).to_le_bytes()].concat();
    summary.chunks.push((0x08, [&times[..], &place, &indexes, &text(name), &sizes[0], &sizes[1]].concat()));
}

fn put_summary(summary: &Summary, file: &mut Vec<u8>) {
    let start = file.len();
    let statistics = vec![summary.statistics()];
    let lists = [&summary.schemas, &summary.channels, &statistics, &summary.chunks];
    for record in lists.into_iter().chain([&summary.attachments, &summary.metadata]).flatten() {
        file.extend(encoded(record));
    }
    let mut footer = vec![0x02];
    footer.extend(20_u64.to_le_bytes());
    footer.extend((start as u64).to_le_bytes());
    footer.extend(0_u64.to_le_bytes());
    let checksum = crc32fast::hash(&[&file[start..], &footer].concat());
    file.extend(footer);
    file.extend(checksum.to_le_bytes());
}

/// The verdict of a replay of the whole recording, or its error.
pub fn verdict(file: &[u8]) -> String {
    let replayed = Recording::read(Cursor::new(file)).and_then(|recording| Replayer::new(recording, ALL_STEPS));
    match replayed.and_then(|replayer| replayer.run(&mut CollisionCount::default(), |_| ())) {
        Ok(verdict) => verdict.to_string(),
        Err(error) => format!("error: {error}"),
    }
}

/// Calls `visit` with every record of the data section, inside and outside of chunks.
pub fn each_record(items: &mut [Item], mut visit: impl FnMut(&mut Record)) {
    for item in items {
        match item {
            Item::Chunk(records) => records.iter_mut().for_each(&mut visit),
            Item::Record(record) => visit(record),
        }
    }
}

/// Returns the keys and values of a metadata record.
pub fn parse_metadata(body: &[u8]) -> (String, BTreeMap<String, String>) {
    let mut rest = body;
    let mut take = || {
        let length = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
        let text = &rest[4..4 + length];
        rest = &rest[4 + length..];
        text.to_vec()
    };
    let name = String::from_utf8(take()).unwrap();
    let map = take();
    let mut rest = map.as_slice();
    let mut pairs = BTreeMap::new();
    let text = |rest: &mut &[u8]| {
        let length = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
        let text = String::from_utf8(rest[4..4 + length].to_vec()).unwrap();
        *rest = &rest[4 + length..];
        text
    };
    while !rest.is_empty() {
        let key = text(&mut rest);
        pairs.insert(key, text(&mut rest));
    }
    (name, pairs)
}

/// Writes a metadata record with its checksum.
pub fn metadata(name: &str, mut map: BTreeMap<String, String>) -> Record {
    map.remove("checksum");
    let mut hash = Xxh3::new();
    for part in map.iter().flat_map(|(key, value)| [key, value]) {
        hash.update(&(part.len() as u64).to_le_bytes());
        hash.update(part.as_bytes());
    }
    map.insert("checksum".into(), format!("{:016x}", hash.digest()));
    let pairs: Vec<u8> = map.iter().flat_map(|(key, value)| [text(key), text(value)]).flatten().collect();
    (op::METADATA, [text(name), (pairs.len() as u32).to_le_bytes().to_vec(), pairs].concat())
}

/// Writes an attachment with its checksum.
pub fn attachment(name: &str, media_type: &str, time: u64, content: &[u8]) -> Record {
    let times = [time, time].map(u64::to_le_bytes).concat();
    let length = (content.len() as u64).to_le_bytes();
    let mut body = [&times, &*text(name), &text(media_type), &length, content, &[0; 4]].concat();
    seal_attachment(&mut body);
    (op::ATTACHMENT, body)
}

/// Computes the checksum at the end of an attachment anew.
pub fn seal_attachment(body: &mut [u8]) {
    let end = body.len() - 4;
    let checksum = crc32fast::hash(&body[..end]);
    body[end..].copy_from_slice(&checksum.to_le_bytes());
}
