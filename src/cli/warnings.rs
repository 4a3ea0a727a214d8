//! Warnings about recordings that could be read only in part, and the exit code for them.

use super::{Exit, output};
use crate::picture::{ReadExtent, ReadStatus};
use crate::recording::Health;

/// Warns about each damaged recording of a picture. Returns the exit code of the first one.
pub fn warn_all(statuses: &[ReadStatus]) -> Exit {
    let exits: Vec<Exit> = statuses.iter().map(warn_if_damaged).collect();
    exits.into_iter().find(|exit| *exit != Exit::Done).unwrap_or(Exit::Done)
}

/// Warns if a recording is corrupt, or truncated before the last step that was wanted of it.
pub fn warn_if_damaged(status: &ReadStatus) -> Exit {
    let ReadStatus { path, health, extent } = status;
    let path = path.display();
    match (health, extent) {
        (Health::Complete, _) | (Health::Truncated { .. }, ReadExtent::LastStep) => return Exit::Done,
        (Health::Truncated { after: Some(step) }, ReadExtent::End) => {
            output::info(format_args!("{path} is truncated after step {step}"));
        }
        (Health::Truncated { after: None }, ReadExtent::End) => {
            output::info(format_args!("{path} is truncated before its first state"));
        }
        (Health::Corrupt(damage), _) => output::info(format_args!("{path} is corrupt: {damage}")),
    }
    Exit::Damaged
}
