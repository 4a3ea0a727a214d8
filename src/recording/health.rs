use std::{fmt, str::FromStr};

use crate::text::counted;

use super::topic::Topic;

/// The condition of a recording, known after it was read to its end.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Health {
    /// Everything is there, and all checksums are correct.
    Whole,
    /// Parts are missing: the file was cut or recovered, or the run is in progress.
    Incomplete(Missing),
    /// The file is damaged.
    Corrupt {
        /// The first damage.
        damage: Damage,
        /// The parts that are missing.
        missing: Missing,
    },
}

impl Health {
    /// Returns `whole`, `incomplete` or `corrupt`.
    pub const fn word(&self) -> &'static str {
        match self {
            Health::Whole => "whole",
            Health::Incomplete(_) => "incomplete",
            Health::Corrupt { .. } => "corrupt",
        }
    }

    /// Returns the parts that are missing, if any.
    pub fn missing(&self) -> Option<&Missing> {
        match self {
            Health::Whole => None,
            Health::Incomplete(missing) | Health::Corrupt { missing, .. } => {
                Some(missing).filter(|missing| !missing.is_empty())
            }
        }
    }

    /// Returns the damage, if there is any.
    pub const fn damage(&self) -> Option<&Damage> {
        match self {
            Health::Whole | Health::Incomplete(_) => None,
            Health::Corrupt { damage, .. } => Some(damage),
        }
    }
}

/// Formats the condition as `whole`, `incomplete: …` or `corrupt: …`.
impl fmt::Display for Health {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Health::Whole => f.write_str("whole"),
            Health::Incomplete(missing) => write!(f, "incomplete: {missing}"),
            Health::Corrupt { damage, missing } if missing.is_empty() => write!(f, "corrupt: {damage}"),
            Health::Corrupt { damage, missing } => write!(f, "corrupt: {damage}; {missing}"),
        }
    }
}

/// The parts of a recording that are missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Missing {
    /// The gaps between the first and the last state.
    pub gaps: Vec<Gap>,
    /// The missing end.
    pub end: Option<MissingEnd>,
    /// True if the text of the scene is missing.
    pub scene: bool,
    /// True if no state has the keyframe that it should have: the topic `/bodies` is missing.
    pub keyframes: bool,
    /// The names of images of the scene that are missing.
    pub images: Vec<String>,
    /// True if the recording was recovered from a damaged or unfinished one.
    pub recovered: bool,
}

/// The missing end of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissingEnd {
    /// The step of the last state; `None` if there is none, or if it is not known.
    pub after: Option<u64>,
    /// The last step of the run, as far as it is known: as planned, or as the end record declares.
    pub last: u64,
    /// True if there is no end record, because the file was cut or the run is in progress.
    pub is_cut: bool,
}

impl Missing {
    /// Returns true if nothing is missing.
    pub fn is_empty(&self) -> bool {
        *self == Missing::default()
    }

    /// Returns the first and last step of each range of missing states, in ascending order.
    pub fn steps(&self) -> Vec<(u64, u64)> {
        let gaps = self.gaps.iter().filter(|gap| gap.missing_states() > 0);
        let end = self.end.iter().filter(|end| end.after.is_some() || !end.is_cut);
        let end =
            end.map(|end| (end.after.map_or(0, |after| after + 1), end.last)).filter(|(first, last)| first <= last);
        gaps.map(|gap| (gap.first_missing(), gap.before - 1)).chain(end).collect()
    }
}

/// Formats the parts in words, for example `recovered; steps 240 to 299 are missing`.
impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const LISTED: usize = 10;
        let mut parts = Vec::new();
        if self.recovered {
            parts.push("recovered".to_owned());
        }
        parts.extend(self.gaps.iter().take(LISTED).map(Gap::missing));
        if self.gaps.len() > LISTED {
            parts.push(format!("{} more", counted(self.gaps.len() - LISTED, "gap")));
        }
        parts.extend(self.end.map(MissingEnd::describe));
        if self.scene {
            parts.push("the text of the scene is missing".into());
        }
        if self.keyframes {
            parts.push(format!("the topic {} is missing", Topic::Bodies.name()));
        }
        parts.extend(self.images.iter().map(|name| format!("the image {name:?} is missing")));
        f.write_str(&parts.join("; "))
    }
}

impl MissingEnd {
    /// Returns true if states are missing, as far as it is known.
    pub fn has_states(self) -> bool {
        self.after.is_none_or(|after| after < self.last)
    }

    fn describe(self) -> String {
        let MissingEnd { after, last, is_cut } = self;
        match (after, is_cut) {
            (Some(after), true) if after >= last => format!("truncated after step {after}, the last one"),
            (Some(after), true) => format!("truncated after step {after} of {last}"),
            (None, true) => "the end is missing".into(),
            (after, false) => Gap { after, before: last + 1 }.missing(),
        }
    }
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

/// A gap in a recording, where data was lost.
///
/// It ends at a keyframe, because the living bodies are unknown until then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gap {
    /// The step of the last state before the gap; `None` if the start was lost.
    pub after: Option<u64>,
    /// The step of the keyframe after the gap. All states between the two steps are lost; if there
    /// are none in between, only events or keyframes are lost.
    pub before: u64,
}

impl Gap {
    /// Returns the number of missing states.
    pub fn missing_states(self) -> u64 {
        self.before.saturating_sub(self.first_missing())
    }

    /// Sorts gaps, and merges those that overlap or follow each other without a state in between.
    pub fn merged(mut gaps: Vec<Gap>) -> Vec<Gap> {
        gaps.sort_by_key(|gap| (gap.first_missing(), gap.before));
        gaps.dedup_by(|next, gap| {
            let is_joined = next.first_missing() <= gap.before;
            if is_joined {
                gap.before = gap.before.max(next.before);
            }
            is_joined
        });
        gaps
    }

    /// Returns the missing part in words.
    fn missing(&self) -> String {
        let (first, before) = (self.first_missing(), self.before);
        match self.missing_states() {
            0 => format!("events at step {before} may be missing"),
            1 => format!("step {first} is missing"),
            _ => format!("steps {first} to {} are missing", before - 1),
        }
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
        let invalid = || format!("{:?} is not a valid gap", text.chars().take(60).collect::<String>());
        let (after, before) = text.split_once('>').ok_or_else(invalid)?;
        let number = |text: &str| text.parse().map_err(|_| invalid());
        let after = if after.is_empty() { None } else { Some(number(after)?) };
        Ok(Gap { after, before: number(before)? })
    }
}
