//! CDR (Common Data Representation), the message encoding of ROS 2 and DDS. Doubles are stored exactly.

use byteorder::LittleEndian;
use serde::{Serialize, de::DeserializeOwned};

use crate::counted::counted;

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
    let body = bytes.strip_prefix(&HEADER).ok_or("the message does not start with the header of little-endian CDR")?;
    let (message, consumed) = cdr_encoding::from_bytes::<T, LittleEndian>(body)
        .map_err(|error| format!("the message is not valid CDR: {error}"))?;
    match body.len() - consumed {
        0 => Ok(message),
        rest => Err(trailing_bytes(rest)),
    }
}

/// The error for a message that does not fill its bytes.
pub fn trailing_bytes(count: usize) -> String {
    match count {
        1 => "1 extra byte follows the message".into(),
        _ => format!("{} follow the message", counted(count, "extra byte")),
    }
}
