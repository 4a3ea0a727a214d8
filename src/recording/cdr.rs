//! CDR (Common Data Representation), the message encoding of ROS 2 and DDS. Doubles are stored exactly.

use byteorder::LittleEndian;
use serde::{Serialize, de::DeserializeOwned};

use crate::text::counted;

use super::record_reader::{FieldReader, Malformed};

/// The encapsulation header before every message: plain CDR, little-endian, no options.
pub const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Replaces the contents of `bytes` by the encoded message.
pub fn encode<T: Serialize>(message: &T, bytes: &mut Vec<u8>) {
    bytes.clear();
    bytes.extend_from_slice(&HEADER);
    cdr_encoding::to_writer::<T, LittleEndian, _>(bytes, message)
        .expect("messages consist of numbers, strings and sequences, and writing to memory cannot fail");
}

/// Decodes the message in `bytes`, which it must fill exactly.
///
/// # Errors
/// Returns a description of the problem if the bytes are not such a message.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let body = body(bytes)?;
    let (message, consumed) = cdr_encoding::from_bytes::<T, LittleEndian>(body)
        .map_err(|error| format!("the message is not valid CDR: {error}"))?;
    check_filled(body.len() - consumed)?;
    Ok(message)
}

/// Reads numbers and columns of numbers. Lengths are checked against the number of bytes left before memory is
/// allocated.
pub struct ColumnReader<'a> {
    body: &'a [u8],
    fields: FieldReader<'a>,
}

impl<'a> ColumnReader<'a> {
    /// Creates a reader at the start of the message in `bytes`.
    ///
    /// # Errors
    /// Returns a description of the problem if the bytes are not CDR.
    pub fn new(bytes: &'a [u8]) -> Result<ColumnReader<'a>, String> {
        let body = body(bytes)?;
        Ok(ColumnReader { body, fields: FieldReader::new(body) })
    }

    /// Reads a `u64`.
    pub fn u64(&mut self) -> Result<u64, Malformed> {
        self.align(8)?;
        self.fields.u64()
    }

    /// Reads a sequence of numbers of N bytes each.
    pub fn column<T, const N: usize>(&mut self, from_bytes: fn([u8; N]) -> T) -> Result<Vec<T>, Malformed> {
        self.align(4)?;
        let length = self.fields.u32()?;
        if length == 0 {
            return Ok(Vec::new());
        }
        self.align(N)?;
        let bytes = self.fields.bytes(u64::from(length) * N as u64)?;
        Ok(bytes.as_chunks().0.iter().map(|bytes| from_bytes(*bytes)).collect())
    }

    /// Returns an error if bytes follow the message.
    pub fn finish(self) -> Result<(), String> {
        check_filled(self.fields.remaining())
    }

    fn align(&mut self, size: usize) -> Result<(), Malformed> {
        let position = self.body.len() - self.fields.remaining();
        self.fields.bytes((position.next_multiple_of(size) - position) as u64).map(drop)
    }
}

/// Appends a sequence of numbers of N bytes each: the aligned length, then the aligned numbers.
pub fn encode_column<T: Copy, const N: usize>(bytes: &mut Vec<u8>, column: &[T], to_bytes: fn(T) -> [u8; N]) {
    align(bytes, 4);
    bytes.extend_from_slice(&(column.len() as u32).to_le_bytes());
    if column.is_empty() {
        return;
    }
    align(bytes, N);
    let start = bytes.len();
    bytes.resize(start + N * column.len(), 0);
    for (slot, number) in bytes[start..].chunks_exact_mut(N).zip(column) {
        slot.copy_from_slice(&to_bytes(*number));
    }
}

/// Pads with zeros to a multiple of `size` bytes, counted from the end of the header.
fn align(bytes: &mut Vec<u8>, size: usize) {
    let length = (bytes.len() - HEADER.len()).next_multiple_of(size);
    bytes.resize(HEADER.len() + length, 0);
}

/// Returns the message without its encapsulation header.
fn body(bytes: &[u8]) -> Result<&[u8], String> {
    let body = bytes.strip_prefix(&HEADER);
    body.ok_or_else(|| "the message does not start with the header of little-endian CDR".into())
}

fn check_filled(rest: usize) -> Result<(), String> {
    match rest {
        0 => Ok(()),
        1 => Err("1 extra byte follows the message".into()),
        _ => Err(format!("{} follow the message", counted(rest, "extra byte"))),
    }
}
