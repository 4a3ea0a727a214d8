use std::io::{self, Read, Seek, SeekFrom};

use mcap::{MAGIC, records::op};

use super::{
    fields::{Fields, Malformed},
    records::{PREFIX_BYTES, Records},
    resync,
};

/// Where the chunks of a recording are: enough to read on at any of them.
pub struct Index {
    /// In file order.
    pub chunks: Vec<IndexedChunk>,
    /// The bodies of the channel records, which stand in the first chunk otherwise.
    pub channels: Vec<Vec<u8>>,
}

/// A chunk as the index knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexedChunk {
    /// Of its record, bytes from the start of the file.
    pub offset: u64,
    /// Of its first message, simulated nanoseconds.
    pub first_time: u64,
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
    let mut index = Index { chunks: Vec::new(), channels: Vec::new() };
    while let Ok(next) = records.advance() {
        match next.map(|place| place.opcode) {
            None => return Ok(Some(index)),
            Some(op::CHUNK_INDEX) => match chunk_index(&records.body) {
                Ok(chunk) => index.chunks.push(chunk),
                Err(Malformed) => return Ok(None),
            },
            Some(op::CHANNEL) => index.channels.push(records.body.clone()),
            Some(_) => {}
        }
    }
    Ok(None)
}

fn chunk_index(body: &[u8]) -> Result<IndexedChunk, Malformed> {
    let mut fields = Fields::new(body);
    let first_time = fields.u64()?;
    let _last_time = fields.u64()?;
    Ok(IndexedChunk { first_time, offset: fields.u64()? })
}

fn from_records<R: Read + Seek>(records: &mut Records<R>) -> io::Result<Index> {
    let mut index = Index { chunks: Vec::new(), channels: Vec::new() };
    records.rewind()?;
    loop {
        match records.advance() {
            Ok(Some(place)) if place.opcode == op::CHUNK => {
                let first_time = Fields::new(&records.body).u64();
                index.chunks.extend(first_time.map(|first_time| IndexedChunk { first_time, offset: place.offset }));
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
