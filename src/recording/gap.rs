use std::{fmt, str::FromStr};

/// A place in a recovered recording where something was lost.
///
/// The bodies alive behind it are unknown until the next keyframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gap {
    /// The last state before it; none if the start was lost.
    pub after: Option<u64>,
    /// The step of what comes next. The states between the two are lost; if there are
    /// none, other things are.
    pub before: u64,
}

impl Gap {
    /// The number of states that are missing.
    pub fn missing_states(self) -> u64 {
        self.before.saturating_sub(self.first_missing())
    }

    /// The first step that may be missing.
    pub fn first_missing(self) -> u64 {
        self.after.map_or(0, |after| after.saturating_add(1))
    }
}

/// As it stands in metadata: `59>120`, or `>120` if the start was lost.
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
        let damaged = || format!("{text:?} is no gap");
        let (after, before) = text.split_once('>').ok_or_else(damaged)?;
        let number = |text: &str| text.parse().map_err(|_| damaged());
        let after = if after.is_empty() { None } else { Some(number(after)?) };
        Ok(Gap { after, before: number(before)? })
    }
}
