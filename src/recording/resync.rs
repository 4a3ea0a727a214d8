//! Finding the next record after damage has made the lengths meaningless.

use std::io::{self, Read, Seek, SeekFrom};

use mcap::{MAGIC, records::op};

use super::{
    fields::{Fields, Malformed},
    limits, metadata,
    records::PREFIX_BYTES,
};

/// Where the next chunk or the end's metadata starts, at `from` or behind it.
///
/// What it finds only looks like a record: its checksum is still to be verified.
pub fn next_record<R: Read + Seek>(read: &mut R, from: u64) -> io::Result<Option<u64>> {
    const WINDOW: usize = 1 << 20;
    let mut window = vec![0; WINDOW + LOOK];
    let mut start = from;
    loop {
        read.seek(SeekFrom::Start(start))?;
        let length = read_up_to(read, &mut window)?;
        let found = (0..length.min(WINDOW)).find(|place| looks_like_record(&window[*place..length]));
        match found {
            Some(place) => return Ok(Some(start + place as u64)),
            None if length <= WINDOW => return Ok(None),
            None => start += WINDOW as u64,
        }
    }
}

/// Whether the file ends with the bytes every finished MCAP file ends with.
pub fn ends_as_mcap<R: Read + Seek>(read: &mut R) -> io::Result<bool> {
    let length = read.seek(SeekFrom::End(0))?;
    let Some(start) = length.checked_sub(MAGIC.len() as u64) else { return Ok(false) };
    read.seek(SeekFrom::Start(start))?;
    let mut last = [0; MAGIC.len()];
    read.read_exact(&mut last)?;
    Ok(last == *MAGIC)
}

/// Bytes that tell whether a record starts here.
const LOOK: usize = 64;

fn looks_like_record(bytes: &[u8]) -> bool {
    match bytes.first() {
        Some(&op::CHUNK) => looks_like_chunk(bytes).unwrap_or(false),
        Some(&op::METADATA) => looks_like_end(bytes).unwrap_or(false),
        Some(_) | None => false,
    }
}

fn looks_like_chunk(bytes: &[u8]) -> Result<bool, Malformed> {
    let mut fields = Fields::new(bytes);
    fields.bytes(1)?;
    let length = fields.u64()?;
    fields.bytes(8 + 8 + 8 + 4)?;
    let compression = fields.text()?;
    let compressed_size = fields.u64()?;
    let header = 8 + 8 + 8 + 4 + 4 + compression.len() as u64 + 8;
    Ok(["", "zstd"].contains(&compression)
        && length <= limits::RECORD_BYTES as u64
        && compressed_size.checked_add(header) == Some(length))
}

fn looks_like_end(bytes: &[u8]) -> Result<bool, Malformed> {
    let mut fields = Fields::new(bytes);
    fields.bytes(PREFIX_BYTES)?;
    Ok(fields.text()? == metadata::END)
}

fn read_up_to<R: Read>(read: &mut R, bytes: &mut [u8]) -> io::Result<usize> {
    let mut length = 0;
    while length < bytes.len() {
        match read.read(&mut bytes[length..])? {
            0 => break,
            count => length += count,
        }
    }
    Ok(length)
}
