use std::io::{self, Read, Seek, SeekFrom};

use mcap::{
    MAGIC, McapError,
    records::op,
    sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

use super::{
    Error, limits,
    metadata::Map,
    resync::{self, MessagePlace},
};

/// Reads the top-level records of a file in order, without opening chunks.
///
/// Verifies the checksums of the data section and of the summary section.
pub struct RecordReader<R> {
    source: FixedEnd<R>,
    reader: LinearReader,
    next_offset: u64,
    /// The number of bytes to read next.
    read_bytes: usize,
    /// The place of the messages, which determines the kind of record to search for after damage.
    messages: MessagePlace,
    /// The start and the result of the last search for a record.
    searched: Option<(u64, Option<u64>)>,
    /// The offset at which reading last continued although no record was found.
    unfounded: Option<u64>,
    /// The fields of the current record.
    pub body: Vec<u8>,
}

/// The position and kind of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordHeader {
    /// The offset of the record, in bytes from the start of the file.
    pub offset: u64,
    /// The kind of record.
    pub opcode: u8,
}

/// The error at a place without a valid record.
#[derive(Debug)]
pub struct ReadFault {
    /// The offset at which the record should start, in bytes from the start of the file.
    pub offset: u64,
    /// The cause.
    pub error: McapError,
}

/// Bytes before the fields of a record: opcode and length.
pub const PREFIX_BYTES: usize = 9;

/// The number of bytes to read at once.
const READ_BYTES: usize = 64 << 10;

/// The number of bytes to read first after a seek, where often only one record is needed. It is then doubled up
/// to [`READ_BYTES`].
const FIRST_READ_BYTES: usize = 2 << 10;

impl<R: Read + Seek> RecordReader<R> {
    /// Creates a reader at the start of the file, which reads up to the present end of the file.
    pub fn new(source: R) -> io::Result<RecordReader<R>> {
        let source = FixedEnd::new(source)?;
        Ok(RecordReader {
            source,
            reader: reader_at_start(),
            next_offset: MAGIC.len() as u64,
            read_bytes: READ_BYTES,
            messages: MessagePlace::OutsideOfChunks,
            searched: None,
            unfounded: None,
            body: Vec::new(),
        })
    }

    /// Returns to the start of the file.
    pub fn rewind(&mut self) -> io::Result<()> {
        self.source.rewind()?;
        self.reader = reader_at_start();
        self.next_offset = MAGIC.len() as u64;
        self.messages = MessagePlace::OutsideOfChunks;
        self.searched = None;
        Ok(())
    }

    /// Continues at `offset`, where a record starts. The checksum of the data section is then not
    /// verified.
    pub fn seek(&mut self, offset: u64) -> io::Result<()> {
        self.source.seek(SeekFrom::Start(offset))?;
        self.reader = LinearReader::new_with_options(strict_options().with_skip_start_magic(true));
        self.next_offset = offset;
        self.read_bytes = FIRST_READ_BYTES;
        Ok(())
    }

    /// Continues at the next record found after the damaged one at `offset`, whose length cannot be
    /// trusted. If no record is found, continues where that length points, but only once: returns false if the record
    /// there is damaged, too, because then nothing follows.
    pub fn resume_after(&mut self, offset: u64) -> io::Result<bool> {
        let found = self.find_record_after(offset)?;
        let has_ended = found.is_none() && self.unfounded == Some(offset);
        let next = found.unwrap_or(self.next_offset);
        self.unfounded = found.is_none().then_some(next);
        self.seek(next)?;
        Ok(!has_ended)
    }

    /// Continues at the first record found within the one at `offset` that was just read, whose length is then damaged.
    /// Without one, continues after it.
    pub fn resume_within(&mut self, offset: u64) -> io::Result<()> {
        match self.find_record_after(offset)? {
            Some(found) if found < self.next_offset => self.seek(found),
            Some(_) | None => Ok(()),
        }
    }

    /// Returns the offset of the next chunk, scene attachment or metadata of rebond after the damaged record at
    /// `offset`, or of the next message, schema or channel, if those are outside of chunks.
    ///
    /// Keeps the result, which is also that of a search from any place between: otherwise a long damaged part, in which
    /// many places are tried, would be searched to its end from each of them.
    pub fn find_record_after(&mut self, offset: u64) -> io::Result<Option<u64>> {
        let from = offset + 1;
        if let Some((start, found)) = self.searched
            && start <= from
            && found.is_none_or(|found| from <= found)
        {
            return Ok(found);
        }
        if resync::is_chunk(&mut self.source, offset)? {
            self.messages = MessagePlace::InChunks;
        }
        let found = resync::find_record(&mut self.source, from, self.messages)?;
        self.searched = Some((from, found));
        Ok(found)
    }

    /// The underlying source.
    pub fn source(&mut self) -> &mut FixedEnd<R> {
        &mut self.source
    }

    /// Reads the next record, whose fields are then in [`RecordReader::body`]. Returns `None` after the
    /// last one.
    ///
    /// # Errors
    /// Returns an error if there is no valid record. Errors of the operating system are
    /// [`McapError::Io`].
    pub fn next_record(&mut self) -> Result<Option<RecordHeader>, ReadFault> {
        let offset = self.next_offset;
        let fault = |error| ReadFault { offset, error };
        loop {
            match self.reader.next_event() {
                None => return Ok(None),
                Some(Err(error)) => return Err(fault(error)),
                Some(Ok(LinearReadEvent::ReadRequest(_))) => {
                    // Never reads the requested amount, because a damaged length can be huge.
                    let buffer = self.reader.insert(self.read_bytes);
                    let count = self.source.read(buffer).map_err(|error| fault(error.into()))?;
                    self.reader.notify_read(count);
                    self.read_bytes = READ_BYTES.min(2 * self.read_bytes);
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    self.body.clear();
                    self.body.extend_from_slice(data);
                    self.next_offset = offset + (PREFIX_BYTES + data.len()) as u64;
                    if opcode == op::CHUNK {
                        self.messages = MessagePlace::InChunks;
                    }
                    return Ok(Some(RecordHeader { offset, opcode }));
                }
            }
        }
    }
}

/// A source that ends where it ended when it was opened. A recording that is still being written grows as fast as it
/// is read, and would otherwise have no end.
pub struct FixedEnd<R> {
    source: R,
    position: u64,
    end: u64,
}

impl<R: Seek> FixedEnd<R> {
    fn new(mut source: R) -> io::Result<FixedEnd<R>> {
        let end = source.seek(SeekFrom::End(0))?;
        source.rewind()?;
        Ok(FixedEnd { source, position: 0, end })
    }
}

impl<R: Read> Read for FixedEnd<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let rest = self.end.saturating_sub(self.position).min(buffer.len() as u64) as usize;
        let count = self.source.read(&mut buffer[..rest])?;
        self.position += count as u64;
        Ok(count)
    }
}

impl<R: Seek> Seek for FixedEnd<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let to = match to {
            SeekFrom::End(offset) => SeekFrom::Start(self.end.saturating_add_signed(offset)),
            SeekFrom::Start(_) | SeekFrom::Current(_) => to,
        };
        self.position = self.source.seek(to)?;
        Ok(self.position)
    }
}

fn reader_at_start() -> LinearReader {
    LinearReader::new_with_options(strict_options().with_validate_data_section_crc(true))
}

fn strict_options() -> LinearReaderOptions {
    LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_validate_summary_section_crc(true)
        .with_check_finishes_after_end_magic(true)
        .with_record_length_limit(limits::RECORD_BYTES)
}

/// Returns true for the opcode of a private record of another program, which may also be a damaged opcode.
pub fn is_private(opcode: u8) -> bool {
    opcode >= 0x80
}

/// The last record, if its length may be damaged: it has unknown fields or a private opcode.
#[derive(Clone, Copy, Debug, Default)]
pub struct SuspectLength(Option<u64>);

impl SuspectLength {
    /// Follows a record, and returns the offset of the one before it, if the length of that may be damaged. Of several
    /// private records, it is the first one.
    pub fn follow(&mut self, RecordHeader { offset, opcode }: RecordHeader, body: &[u8]) -> Option<u64> {
        let before = self.0;
        let is_suspect = is_private(opcode) || has_unknown_fields(opcode, body);
        self.0 = before.filter(|_| is_private(opcode)).or(is_suspect.then_some(offset));
        before
    }

    /// Returns a fault after the last record, at that record if its length may be damaged.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn locate(&mut self, fault: ReadFault) -> Result<ReadFault, Error> {
        match fault.error {
            McapError::Io(error) => Err(Error::Read(error)),
            error => Ok(ReadFault { offset: self.0.take().unwrap_or(fault.offset), error }),
        }
    }
}

/// Returns true if a record has bytes after its known fields. Later versions of MCAP may add fields, but the length of
/// the record may also be damaged.
fn has_unknown_fields(opcode: u8, body: &[u8]) -> bool {
    let mut fields = FieldReader::new(body);
    let mut skip = || {
        match opcode {
            op::HEADER => [fields.text()?, fields.text()?].len(),
            op::CHUNK => {
                fields.bytes(8 + 8 + 8 + 4)?;
                fields.text()?;
                let length = fields.u64()?;
                fields.bytes(length)?.len()
            }
            op::MESSAGE_INDEX => {
                fields.u16()?;
                let length = fields.u32()?;
                fields.bytes(length.into())?.len()
            }
            op::METADATA => {
                fields.text()?;
                let length = fields.u32()?;
                fields.bytes(length.into())?.len()
            }
            op::ATTACHMENT => {
                fields.bytes(8 + 8)?;
                let _names = [fields.text()?, fields.text()?];
                let length = fields.u64()?;
                fields.bytes(length)?;
                fields.bytes(4)?.len()
            }
            _ => return Ok(false),
        };
        Ok(!fields.is_empty())
    };
    let has_more: Result<bool, Malformed> = skip();
    has_more == Ok(true)
}

/// Reads the fields of one MCAP record from front to back.
///
/// The parser of the `mcap` crate is not used, because it reserves memory for any length field, and
/// a damaged length can be gigabytes.
pub struct FieldReader<'a> {
    rest: &'a [u8],
}

/// The record is too short for its fields, or a text is not UTF-8.
#[derive(Debug, PartialEq, Eq)]
pub struct Malformed;

impl<'a> FieldReader<'a> {
    /// Creates a reader at the first field of a record's body.
    pub fn new(body: &'a [u8]) -> FieldReader<'a> {
        FieldReader { rest: body }
    }

    /// Reads `count` bytes.
    pub fn bytes(&mut self, count: u64) -> Result<&'a [u8], Malformed> {
        let count = usize::try_from(count).map_err(|_| Malformed)?;
        let (bytes, rest) = self.rest.split_at_checked(count).ok_or(Malformed)?;
        self.rest = rest;
        Ok(bytes)
    }

    /// Returns true if no bytes are left.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// The number of bytes left.
    pub fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// Returns all remaining bytes.
    pub fn rest(self) -> &'a [u8] {
        self.rest
    }

    /// Reads a little-endian `u16`.
    pub fn u16(&mut self) -> Result<u16, Malformed> {
        self.array().map(u16::from_le_bytes)
    }

    /// Reads a little-endian `u32`.
    pub fn u32(&mut self) -> Result<u32, Malformed> {
        self.array().map(u32::from_le_bytes)
    }

    /// Reads a little-endian `u64`.
    pub fn u64(&mut self) -> Result<u64, Malformed> {
        self.array().map(u64::from_le_bytes)
    }

    /// Reads a length-prefixed string.
    pub fn text(&mut self) -> Result<&'a str, Malformed> {
        let length = self.u32()?;
        str::from_utf8(self.bytes(length.into())?).map_err(|_| Malformed)
    }

    /// Reads a map of strings, prefixed by its length in bytes.
    pub fn map(&mut self) -> Result<Map, Malformed> {
        let length = self.u32()?;
        let mut pairs = FieldReader::new(self.bytes(length.into())?);
        let mut map = Map::new();
        while !pairs.is_empty() {
            let key = pairs.text()?;
            if map.insert(key.into(), pairs.text()?.into()).is_some() {
                return Err(Malformed); // A key occurs twice.
            }
        }
        Ok(map)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let (array, rest) = self.rest.split_first_chunk().ok_or(Malformed)?;
        self.rest = rest;
        Ok(*array)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file that grows as fast as it is read.
    struct Growing(u64);

    impl Read for Growing {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.0 += buffer.len() as u64;
            Ok(buffer.len())
        }
    }

    impl Seek for Growing {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0 = match to {
                SeekFrom::Start(offset) => offset,
                SeekFrom::End(_) => self.0 + 100,
                SeekFrom::Current(offset) => self.0.saturating_add_signed(offset),
            };
            Ok(self.0)
        }
    }

    #[test]
    fn a_growing_file_ends_where_it_ended_when_it_was_opened() {
        let mut source = FixedEnd::new(Growing(0)).unwrap();
        assert_eq!(source.read_to_end(&mut Vec::new()).unwrap(), 100);
        assert_eq!(source.seek(SeekFrom::End(0)).unwrap(), 100);
        assert_eq!(source.seek(SeekFrom::Start(90)).unwrap(), 90);
        assert_eq!(source.read_to_end(&mut Vec::new()).unwrap(), 10);
    }
}
