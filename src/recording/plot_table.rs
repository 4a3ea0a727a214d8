//! Tables for plotting: MCAP files with one topic per body, which `rebond export -o FILE.mcap` writes. They are not
//! recordings.

use super::{Error, open_file};
use mcap::{MAGIC, records::op};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// The schema of all topics of a table for plotting.
pub const BODY_STATE: &str = "rebond_msgs/msg/BodyState";

/// Returns true if the file at `path` is a table for plotting: the only schema in its summary is that of bodies.
pub fn is_plot_table(path: &Path) -> bool {
    let names = open_file(path).ok().and_then(|mut file| summary_schemas(&mut file).ok());
    names.is_some_and(|names| !names.is_empty() && names.iter().all(|name| name == BODY_STATE.as_bytes()))
}

impl Error {
    /// Returns this error of reading the file at `path`, or the one that names what the file is if it is a table for
    /// plotting.
    pub fn or_plot_table(self, path: &Path) -> Error {
        match self {
            Error::NotARecording { .. } if is_plot_table(path) => Error::PlotTable,
            error => error,
        }
    }
}

/// Bytes of a record before its fields: opcode and length.
const PREFIX: usize = 9;

/// Bytes of the footer and the magic at the end of a file.
const END: usize = PREFIX + 20 + MAGIC.len();

/// The names of the first schemas in the summary of an MCAP file; none if it has no summary.
fn summary_schemas(file: &mut (impl Read + Seek)) -> io::Result<Vec<Vec<u8>>> {
    // Writers put schemas first.
    const MAX_BYTES: u64 = 64 << 10;
    let mut end = [0; END];
    file.seek(SeekFrom::End(-(END as i64)))?;
    file.read_exact(&mut end)?;
    let start = number(&end[PREFIX..PREFIX + 8]);
    if end[0] != op::FOOTER || !end.ends_with(MAGIC) || start == 0 {
        return Ok(Vec::new());
    }
    let mut summary = Vec::new();
    file.seek(SeekFrom::Start(start))?;
    file.take(MAX_BYTES).read_to_end(&mut summary)?;
    let (mut names, mut rest) = (Vec::new(), summary.as_slice());
    while let Some((record, following)) = split_record(rest) {
        names.extend(schema_name(record));
        rest = following;
    }
    Ok(names)
}

/// A record of an MCAP file.
struct Record<'a> {
    opcode: u8,
    fields: &'a [u8],
}

/// Splits the first record from the following ones.
fn split_record(bytes: &[u8]) -> Option<(Record<'_>, &[u8])> {
    let (prefix, rest) = bytes.split_at_checked(PREFIX)?;
    let (fields, following) = rest.split_at_checked(usize::try_from(number(&prefix[1..])).ok()?)?;
    Some((Record { opcode: prefix[0], fields }, following))
}

/// The name in a schema record: its id (2 bytes), the length of the name (4 bytes), the name.
fn schema_name(Record { opcode, fields }: Record) -> Option<Vec<u8>> {
    let (length, rest) = fields.get(2..).filter(|_| opcode == op::SCHEMA)?.split_at_checked(4)?;
    Some(rest.get(..number(length) as usize)?.to_vec())
}

/// A little-endian number of at most 8 bytes.
fn number(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte))
}
