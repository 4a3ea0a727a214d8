//! Messages as CDR: how ROS 2 and DDS put them into bytes, doubles exact to the bit.

use byteorder::LittleEndian;
use serde::{Serialize, de::DeserializeOwned};

/// What stands before every message: plain CDR, little-endian, no options.
pub const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Replaces the contents of `bytes` by the message.
pub fn encode<T: Serialize>(message: &T, bytes: &mut Vec<u8>) {
    bytes.clear();
    bytes.extend_from_slice(&HEADER);
    cdr_encoding::to_writer::<T, LittleEndian, _>(bytes, message)
        .expect("a message is made of numbers, strings and sequences, and memory takes all bytes");
}

/// The message in `bytes`, which it must fill exactly.
///
/// # Errors
/// In words, if the bytes are not that message.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let body = bytes.strip_prefix(&HEADER).ok_or("the message does not start as little-endian CDR")?;
    let (message, consumed) = cdr_encoding::from_bytes::<T, LittleEndian>(body)
        .map_err(|error| format!("the message is not CDR: {error}"))?;
    match body.len() - consumed {
        0 => Ok(message),
        rest => Err(format!("{rest} bytes follow the message")),
    }
}
