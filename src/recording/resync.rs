//! Finding the next record after damage has made the lengths meaningless.

use std::io::{self, Read, Seek, SeekFrom};

use mcap::{MAGIC, McapError, records::op};

use super::{
    fields::{Fields, Malformed},
    limits, metadata,
    records::Broken,
};

/// What can be done after a place where there should be a record and is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// To go on at this offset, bytes from the start of the file.
    GoOn(u64),
    /// Nothing: the file was cut there.
    Cut,
    /// Nothing, though the file was not cut there.
    None,
}

/// Looks for the next record behind a broken one.
///
/// # Errors
/// If the system cannot read.
pub fn remedy<R: Read + Seek>(read: &mut R, broken: &Broken) -> io::Result<Remedy> {
    match next_record(read, broken.offset + 1)? {
        Some(next) => Ok(Remedy::GoOn(next)),
        None => hopeless(read, broken),
    }
}

/// What to make of a broken record when nothing of interest can follow.
///
/// # Errors
/// If the system cannot read.
pub fn hopeless<R: Read + Seek>(read: &mut R, broken: &Broken) -> io::Result<Remedy> {
    let cut = matches!(broken.why, McapError::UnexpectedEof) && !ends_as_mcap(read)?;
    Ok(if cut { Remedy::Cut } else { Remedy::None })
}

/// Where the next chunk, scene or metadata of ours starts, at `from` or behind it.
///
/// What it finds only looks like a record: its checksum is still to be verified.
///
/// # Errors
/// If the system cannot read.
pub fn next_record<R: Read + Seek>(read: &mut R, from: u64) -> io::Result<Option<u64>> {
    find(read, from, |bytes| looks_like_record(bytes).unwrap_or(false))
}

/// Where the next metadata of ours starts, at `from` or behind it.
///
/// # Errors
/// If the system cannot read.
pub fn next_metadata<R: Read + Seek>(read: &mut R, from: u64) -> io::Result<Option<u64>> {
    find(read, from, |bytes| bytes[0] == op::METADATA && looks_like_record(bytes).unwrap_or(false))
}

fn find<R: Read + Seek>(read: &mut R, from: u64, looks_like: fn(&[u8]) -> bool) -> io::Result<Option<u64>> {
    const WINDOW: usize = 64 << 10;
    let mut window = vec![0; WINDOW + LOOK];
    let mut start = from;
    loop {
        read.seek(SeekFrom::Start(start))?;
        let length = read_up_to(read, &mut window)?;
        match (0..length.min(WINDOW)).find(|place| looks_like(&window[*place..length])) {
            Some(place) => return Ok(Some(start + place as u64)),
            None if length <= WINDOW => return Ok(None),
            None => start += WINDOW as u64,
        }
    }
}

/// Whether the file ends with the bytes every finished MCAP file ends with.
fn ends_as_mcap<R: Read + Seek>(read: &mut R) -> io::Result<bool> {
    let length = read.seek(SeekFrom::End(0))?;
    const MAGIC_BYTES: u64 = MAGIC.len() as u64;
    if length < 2 * MAGIC_BYTES {
        return Ok(false); // What is there may be the magic bytes of the start.
    }
    read.seek(SeekFrom::Start(length - MAGIC_BYTES))?;
    let mut last = [0; MAGIC.len()];
    read.read_exact(&mut last)?;
    Ok(last == *MAGIC)
}

/// Bytes that tell whether a record starts here.
const LOOK: usize = 64;

fn looks_like_record(bytes: &[u8]) -> Result<bool, Malformed> {
    let mut fields = Fields::new(bytes);
    let opcode = fields.bytes(1)?;
    if ![[op::CHUNK], [op::METADATA], [op::ATTACHMENT]].iter().any(|known| known == opcode) {
        return Ok(false); // Most bytes end here.
    }
    let length = fields.u64()?;
    let fits = match opcode {
        [op::CHUNK] => looks_like_chunk(fields, length)?,
        [op::METADATA] => [metadata::START, metadata::END].contains(&fields.text()?),
        _ => fields.bytes(16)? == [0; 16], // The times of an attachment of ours.
    };
    Ok(fits && length <= limits::RECORD_BYTES as u64)
}

fn looks_like_chunk(mut fields: Fields<'_>, length: u64) -> Result<bool, Malformed> {
    fields.bytes(8 + 8 + 8 + 4)?;
    let compression = fields.text()?;
    let compressed_size = fields.u64()?;
    let header = 8 + 8 + 8 + 4 + 4 + compression.len() as u64 + 8;
    Ok(["", "zstd"].contains(&compression) && compressed_size.checked_add(header) == Some(length))
}

/// Fills `bytes` as far as the file reaches; how far that is.
pub fn read_up_to<R: Read>(read: &mut R, bytes: &mut [u8]) -> io::Result<usize> {
    let mut length = 0;
    while length < bytes.len() {
        match read.read(&mut bytes[length..])? {
            0 => break,
            count => length += count,
        }
    }
    Ok(length)
}
