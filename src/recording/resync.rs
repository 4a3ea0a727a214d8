//! Resynchronisation: finding the next record after damage, where record lengths cannot be trusted.

use std::io::{self, Read, Seek, SeekFrom};

use mcap::{MAGIC, McapError, records::op};

use super::{
    cdr, limits, metadata,
    record_reader::{FieldReader, Malformed, PREFIX_BYTES, ReadFault, RecordReader},
    topic::Topic,
};

/// The way to continue after a place without a valid record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resync {
    /// Continue at this offset, in bytes from the start of the file.
    ContinueAt(u64),
    /// Stop: the file was cut here.
    Truncated,
    /// Stop: the file is damaged here, but was not cut.
    Corrupt,
}

/// The place of the messages of a file, as far as is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessagePlace {
    /// A chunk was read: reading never continues inside of a damaged one, whose records are not verified.
    InChunks,
    /// No chunk was read.
    OutsideOfChunks,
}

/// Searches for the next record after a fault.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn resync<R: Read + Seek>(records: &mut RecordReader<R>, fault: &ReadFault) -> io::Result<Resync> {
    match records.find_record_after(fault.offset)? {
        Some(next) => Ok(Resync::ContinueAt(next)),
        None => truncated_or_corrupt(records.source(), fault),
    }
}

/// Classifies a fault after which no record of interest can follow.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn truncated_or_corrupt<R: Read + Seek>(source: &mut R, fault: &ReadFault) -> io::Result<Resync> {
    let is_cut = matches!(fault.error, McapError::UnexpectedEof) && !ends_with_magic(source)?;
    Ok(if is_cut { Resync::Truncated } else { Resync::Corrupt })
}

/// Returns the offset of the next chunk, scene attachment or metadata of rebond at or after `from`, or of the next
/// message, schema or channel of rebond, if messages are outside of chunks.
///
/// The bytes there only resemble a record: its checksum is not yet verified.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn find_record<R: Read + Seek>(source: &mut R, from: u64, messages: MessagePlace) -> io::Result<Option<u64>> {
    match messages {
        MessagePlace::InChunks => find(source, from, |bytes| resembles_record(bytes).unwrap_or(false)),
        MessagePlace::OutsideOfChunks => find(source, from, |bytes| {
            resembles_record(bytes) == Ok(true) || resembles_record_of_chunk(bytes) == Ok(true)
        }),
    }
}

/// Returns true if the bytes at `offset` resemble a chunk.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn is_chunk<R: Read + Seek>(source: &mut R, offset: u64) -> io::Result<bool> {
    let mut bytes = [0; LOOKAHEAD];
    source.seek(SeekFrom::Start(offset))?;
    let length = read_up_to(source, &mut bytes)?;
    Ok(bytes[0] == op::CHUNK && resembles_record(&bytes[..length]) == Ok(true))
}

/// Returns the offset of the next metadata of rebond at or after `from`.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn find_metadata<R: Read + Seek>(source: &mut R, from: u64) -> io::Result<Option<u64>> {
    find(source, from, |bytes| bytes[0] == op::METADATA && resembles_record(bytes).unwrap_or(false))
}

fn find<R: Read + Seek>(source: &mut R, from: u64, is_match: fn(&[u8]) -> bool) -> io::Result<Option<u64>> {
    const WINDOW: usize = 64 << 10;
    let mut window = vec![0; WINDOW + LOOKAHEAD];
    let mut start = from;
    loop {
        source.seek(SeekFrom::Start(start))?;
        let length = read_up_to(source, &mut window)?;
        match (0..length.min(WINDOW)).find(|offset| is_match(&window[*offset..length])) {
            Some(offset) => return Ok(Some(start + offset as u64)),
            None if length <= WINDOW => return Ok(None),
            None => start += WINDOW as u64,
        }
    }
}

/// Reads the record at `offset` of the data section, if it is intact so far, and returns its opcode, its fields if it
/// is an attachment, and the offset of the next record. Returns `None` at the end of the data section.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn read_attachment<R: Read + Seek>(source: &mut R, offset: u64) -> io::Result<Option<(u8, Vec<u8>, u64)>> {
    let end = source.seek(SeekFrom::End(0))?;
    source.seek(SeekFrom::Start(offset))?;
    let mut prefix = [0; PREFIX_BYTES];
    if read_up_to(source, &mut prefix)? < PREFIX_BYTES {
        return Ok(None);
    }
    let mut fields = FieldReader::new(&prefix);
    let (Ok([opcode]), Ok(length)) = (fields.bytes(1), fields.u64()) else { return Ok(None) };
    let Some(next) = length.checked_add(offset + PREFIX_BYTES as u64).filter(|next| *next <= end) else {
        return Ok(None);
    };
    if [0, op::DATA_END, op::FOOTER].contains(opcode) {
        return Ok(None);
    }
    let is_attachment = *opcode == op::ATTACHMENT && length <= limits::RECORD_BYTES as u64;
    let mut body = vec![0; if is_attachment { length as usize } else { 0 }];
    source.read_exact(&mut body)?;
    Ok(Some((*opcode, body, next)))
}

/// Returns true if the file ends with the magic bytes of a finished MCAP file.
fn ends_with_magic<R: Read + Seek>(source: &mut R) -> io::Result<bool> {
    let length = source.seek(SeekFrom::End(0))?;
    const MAGIC_BYTES: u64 = MAGIC.len() as u64;
    if length < 2 * MAGIC_BYTES {
        return Ok(false); // The last bytes may be the magic at the start of the file.
    }
    source.seek(SeekFrom::Start(length - MAGIC_BYTES))?;
    let mut last = [0; MAGIC.len()];
    source.read_exact(&mut last)?;
    Ok(last == *MAGIC)
}

/// Bytes that are needed to recognise a record.
const LOOKAHEAD: usize = 64;

fn resembles_record(bytes: &[u8]) -> Result<bool, Malformed> {
    let mut fields = FieldReader::new(bytes);
    let opcode = fields.bytes(1)?;
    if ![[op::CHUNK], [op::METADATA], [op::ATTACHMENT]].iter().any(|candidate| candidate == opcode) {
        return Ok(false); // The most frequent case.
    }
    let length = fields.u64()?;
    let matches = match opcode {
        [op::CHUNK] => resembles_chunk(fields, length)?,
        [op::METADATA] => [metadata::HEADER, metadata::TRAILER].contains(&fields.text()?),
        _ => fields.bytes(16)? == [0; 16], // Both times of an attachment of rebond are zero.
    };
    Ok(matches && length <= limits::RECORD_BYTES as u64)
}

/// Returns true for a schema, channel or message of rebond, which are outside of chunks in the files of other programs.
fn resembles_record_of_chunk(bytes: &[u8]) -> Result<bool, Malformed> {
    let mut fields = FieldReader::new(bytes);
    let opcode = fields.bytes(1)?;
    if ![[op::MESSAGE], [op::SCHEMA], [op::CHANNEL]].iter().any(|candidate| candidate == opcode) {
        return Ok(false); // The most frequent case.
    }
    let (length, _id) = (fields.u64()?, fields.u16()?);
    let matches = match opcode {
        [op::MESSAGE] => {
            let (_sequence, times) = (fields.u32()?, [fields.u64()?, fields.u64()?]);
            times[0] == times[1] && fields.bytes(4)? == cdr::HEADER
        }
        [op::SCHEMA] => {
            let name = fields.text()?;
            Topic::ALL.iter().any(|topic| topic.schema_name() == name)
        }
        _ => {
            let (_schema, name) = (fields.u16()?, fields.text()?);
            Topic::from_name(name).is_some()
        }
    };
    Ok(matches && length <= limits::RECORD_BYTES as u64)
}

fn resembles_chunk(mut fields: FieldReader<'_>, length: u64) -> Result<bool, Malformed> {
    fields.bytes(8 + 8 + 8 + 4)?;
    let compression = fields.text()?;
    let compressed_size = fields.u64()?;
    let header = 8 + 8 + 8 + 4 + 4 + compression.len() as u64 + 8;
    Ok(["", "zstd", "lz4"].contains(&compression) && compressed_size.checked_add(header) == Some(length))
}

/// Fills `bytes` as far as the file allows, and returns the number of bytes read.
pub fn read_up_to<R: Read>(source: &mut R, bytes: &mut [u8]) -> io::Result<usize> {
    let mut length = 0;
    while length < bytes.len() {
        match source.read(&mut bytes[length..])? {
            0 => break,
            count => length += count,
        }
    }
    Ok(length)
}
