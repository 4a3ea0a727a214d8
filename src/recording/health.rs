use std::fmt;

/// What reading a recording to its end has shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Health {
    /// Complete, every checksum right.
    Whole,
    /// The file ends before the recording does: a run in progress, a kill, a cut.
    Truncated {
        /// The last step whose state could be read; none if there was none.
        after: Option<u64>,
    },
    /// Something in the file is not as it was written; the first such place.
    Corrupt(Damage),
}

/// A place in a recording that is not as it was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// Chunk it lies in, counted from 1; none outside of chunks.
    pub chunk: Option<u64>,
    /// Offset of the damaged record, bytes from the start of the file.
    pub offset: u64,
    /// What is wrong there.
    pub what: String,
    /// The last step whose state was read before it; none if there was none.
    pub after: Option<u64>,
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.chunk {
            Some(chunk) => write!(f, "chunk {chunk} at byte {}", self.offset)?,
            None => write!(f, "record at byte {}", self.offset)?,
        }
        match self.after {
            Some(step) => write!(f, " after step {step}: {}", self.what),
            None => write!(f, " before the first state: {}", self.what),
        }
    }
}
