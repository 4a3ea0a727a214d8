use super::metadata::Map;

/// The fields of one MCAP record, taken from its front one after the other.
///
/// Parsing here rather than with the crate's parser: that one reserves whatever a length
/// field asks for, and a damaged field asks for gigabytes.
pub struct Fields<'a> {
    rest: &'a [u8],
}

/// The record ends before its fields do, or text in it is not UTF-8.
#[derive(Debug, PartialEq, Eq)]
pub struct Malformed;

impl<'a> Fields<'a> {
    /// The fields of a record's body.
    pub fn new(body: &'a [u8]) -> Fields<'a> {
        Fields { rest: body }
    }

    /// The next `count` bytes.
    pub fn bytes(&mut self, count: u64) -> Result<&'a [u8], Malformed> {
        let count = usize::try_from(count).map_err(|_| Malformed)?;
        let (bytes, rest) = self.rest.split_at_checked(count).ok_or(Malformed)?;
        self.rest = rest;
        Ok(bytes)
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// How many bytes are left.
    pub fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// All that is left.
    pub fn rest(self) -> &'a [u8] {
        self.rest
    }

    /// Nothing, if nothing is left.
    pub fn end(self) -> Result<(), Malformed> {
        match self.rest {
            [] => Ok(()),
            [..] => Err(Malformed),
        }
    }

    /// A number of 2 bytes.
    pub fn u16(&mut self) -> Result<u16, Malformed> {
        self.array().map(u16::from_le_bytes)
    }

    /// A number of 4 bytes.
    pub fn u32(&mut self) -> Result<u32, Malformed> {
        self.array().map(u32::from_le_bytes)
    }

    /// A number of 8 bytes.
    pub fn u64(&mut self) -> Result<u64, Malformed> {
        self.array().map(u64::from_le_bytes)
    }

    /// A text with its length before it.
    pub fn text(&mut self) -> Result<&'a str, Malformed> {
        let length = self.u32()?;
        str::from_utf8(self.bytes(length.into())?).map_err(|_| Malformed)
    }

    /// Keys and values with the length of them all before them.
    pub fn map(&mut self) -> Result<Map, Malformed> {
        let length = self.u32()?;
        let mut pairs = Fields::new(self.bytes(length.into())?);
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
