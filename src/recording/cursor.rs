use super::metadata::Map;

/// Reads the fields of one MCAP record from front to back.
///
/// The parser of the `mcap` crate is not used, because it reserves memory for any length field, and
/// a damaged length can be gigabytes.
pub struct Cursor<'a> {
    rest: &'a [u8],
}

/// The record is too short for its fields, or a text is not UTF-8.
#[derive(Debug, PartialEq, Eq)]
pub struct Malformed;

impl<'a> Cursor<'a> {
    /// Creates a cursor at the first field of a record's body.
    pub fn new(body: &'a [u8]) -> Cursor<'a> {
        Cursor { rest: body }
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

    /// Returns an error if bytes are left.
    pub fn finish(self) -> Result<(), Malformed> {
        match self.rest {
            [] => Ok(()),
            [..] => Err(Malformed),
        }
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
        let mut pairs = Cursor::new(self.bytes(length.into())?);
        let mut map = Map::new();
        while !pairs.is_empty() {
            let key = pairs.text()?;
            map.insert(key.into(), pairs.text()?.into());
        }
        Ok(map)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let (array, rest) = self.rest.split_first_chunk().ok_or(Malformed)?;
        self.rest = rest;
        Ok(*array)
    }
}
