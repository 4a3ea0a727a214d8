//! Events one a line: JSON objects with the keys of the scene format.

use super::{Action, SceneError};

/// One event of a JSON Lines file or pipe.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveEvent {
    /// The step it names; without one it takes effect at the next step.
    pub step: Option<u64>,
    /// What it does.
    pub action: Action,
}

/// The event on line `number` (from 1), whose text is `line`.
///
/// # Errors
/// [`SceneError::Event`] for the first thing in the line that is not as the format has it.
pub fn parse_line(number: u64, line: &str) -> Result<LiveEvent, SceneError> {
    let _ = (number, line);
    todo!("the types come first")
}
