use std::{fmt, str::FromStr};

/// The condition of a recording, known after it was read to its end.
#[non_exhaustive]
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

/// A gap in a recovered recording, where data was lost.
///
/// After a gap the living bodies are unknown until the next keyframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gap {
    /// The step of the last state before the gap; `None` if the start was lost.
    pub after: Option<u64>,
    /// The step of the first item after the gap. All states between the two steps are lost; if there
    /// are none in between, only events or keyframes are lost.
    pub before: u64,
}

impl Gap {
    /// Returns the number of missing states.
    pub fn missing_states(self) -> u64 {
        self.before.saturating_sub(self.first_missing())
    }

    /// Returns the first step that may be missing.
    pub fn first_missing(self) -> u64 {
        self.after.map_or(0, |after| after.saturating_add(1))
    }
}

/// Formats the gap as in the metadata: `59>120`, or `>120` if the start was lost.
impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.after {
            Some(after) => write!(f, "{after}>{}", self.before),
            None => write!(f, ">{}", self.before),
        }
    }
}

impl FromStr for Gap {
    type Err = String;

    fn from_str(text: &str) -> Result<Gap, String> {
        let invalid = || format!("{text:?} is not a valid gap");
        let (after, before) = text.split_once('>').ok_or_else(invalid)?;
        let number = |text: &str| text.parse().map_err(|_| invalid());
        let after = if after.is_empty() { None } else { Some(number(after)?) };
        Ok(Gap { after, before: number(before)? })
    }
}
