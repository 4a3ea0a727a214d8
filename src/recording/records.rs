use std::io::{self, Read, Seek, SeekFrom};

use mcap::{
    MAGIC, McapError,
    sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

use super::{limits, resync};

/// The top-level records of a file in order, chunks unopened.
///
/// The checksums of the data section and of the summary are verified on the way.
pub struct Records<R> {
    read: R,
    reader: LinearReader,
    next_offset: u64,
    /// The fields of the present record.
    pub body: Vec<u8>,
}

/// Where a record lies and of which kind it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Where it starts, bytes from the start of the file.
    pub offset: u64,
    /// Which kind.
    pub opcode: u8,
}

/// Why there is no next record.
#[derive(Debug)]
pub struct Broken {
    /// Where it should start, bytes from the start of the file.
    pub offset: u64,
    /// What is wrong there.
    pub why: McapError,
}

/// Bytes before the fields of a record: its kind and its length.
pub const PREFIX_BYTES: usize = 9;

const READ_BYTES: usize = 64 << 10;

impl<R: Read + Seek> Records<R> {
    /// The records from the start of the file.
    pub fn new(read: R) -> Records<R> {
        Records { read, reader: from_start(), next_offset: MAGIC.len() as u64, body: Vec::new() }
    }

    /// Starts again from the start of the file.
    pub fn rewind(&mut self) -> io::Result<()> {
        self.read.rewind()?;
        self.reader = from_start();
        self.next_offset = MAGIC.len() as u64;
        Ok(())
    }

    /// Goes on from `offset`, where a record starts. The checksum of the data section
    /// cannot be verified then.
    pub fn seek(&mut self, offset: u64) -> io::Result<()> {
        self.read.seek(SeekFrom::Start(offset))?;
        self.reader = LinearReader::new_with_options(strict().with_skip_start_magic(true));
        self.next_offset = offset;
        Ok(())
    }

    /// Goes on with the next record behind a damaged one, whose length is not to be
    /// trusted. If there is none, where its length says.
    pub fn resume_after(&mut self, offset: u64) -> io::Result<()> {
        let next = resync::next_record(&mut self.read, offset + 1)?.unwrap_or(self.next_offset);
        self.seek(next)
    }

    /// What is read from.
    pub fn read(&mut self) -> &mut R {
        &mut self.read
    }

    /// Goes to the next record, whose fields are then in [`Records::body`]; none behind
    /// the last one.
    ///
    /// # Errors
    /// If there should be one and is none; a system that cannot read is
    /// [`McapError::Io`].
    pub fn advance(&mut self) -> Result<Option<Place>, Broken> {
        let offset = self.next_offset;
        let broken = |why| Broken { offset, why };
        loop {
            match self.reader.next_event() {
                None => return Ok(None),
                Some(Err(why)) => return Err(broken(why)),
                Some(Ok(LinearReadEvent::ReadRequest(_))) => {
                    // Never as much as asked for: a damaged length asks for a lot.
                    let count = self.read.read(self.reader.insert(READ_BYTES)).map_err(|e| broken(e.into()))?;
                    self.reader.notify_read(count);
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    self.body.clear();
                    self.body.extend_from_slice(data);
                    self.next_offset = offset + (PREFIX_BYTES + data.len()) as u64;
                    return Ok(Some(Place { offset, opcode }));
                }
            }
        }
    }
}

fn from_start() -> LinearReader {
    LinearReader::new_with_options(strict().with_validate_data_section_crc(true))
}

fn strict() -> LinearReaderOptions {
    LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_validate_summary_section_crc(true)
        .with_check_finishes_after_end_magic(true)
        .with_record_length_limit(limits::RECORD_BYTES)
}
