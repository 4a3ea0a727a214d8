use std::fmt;

/// The condition of a recording, known after it was read to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Health {
    /// The recording is complete and all checksums are correct.
    Complete,
    /// The file ends before the end record: the run is in progress or was killed, or the file was cut.
    Truncated {
        /// The step of the last readable state, if any.
        after: Option<u64>,
    },
    /// The file is damaged; holds the first damage.
    Corrupt(Damage),
}

/// A damaged place in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// The number of the chunk, counted from 1; `None` outside of chunks.
    pub chunk: Option<u64>,
    /// The offset of the damaged record, in bytes from the start of the file.
    pub offset: u64,
    /// A description of the damage.
    pub reason: String,
    /// The step of the last state before the damage, if any.
    pub after: Option<u64>,
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.chunk {
            Some(chunk) => write!(f, "chunk {chunk} at byte {}", self.offset)?,
            None => write!(f, "record at byte {}", self.offset)?,
        }
        match self.after {
            Some(step) => write!(f, " after step {step}: {}", self.reason),
            None => write!(f, " before the first state: {}", self.reason),
        }
    }
}
