//! Says what of a recording could not be read, and how a script sees that.

use super::{Exit, output};
use crate::illustration::{Condition, Reached};
use crate::recording::Health;

/// Tells of all recordings of a picture.
pub fn tell_all(conditions: &[Condition]) -> Exit {
    let exits: Vec<Exit> = conditions.iter().map(tell).collect();
    exits.into_iter().find(|exit| *exit != Exit::Done).unwrap_or(Exit::Done)
}

/// Tells of one recording.
pub fn tell(condition: &Condition) -> Exit {
    let Condition { path, health, reached } = condition;
    let path = path.display();
    match (health, reached) {
        (Health::Whole, _) | (Health::Truncated { .. }, Reached::LastStep) => return Exit::Done,
        (Health::Truncated { after: Some(step) }, Reached::End) => {
            output::note(format_args!("{path} is truncated after step {step}"));
        }
        (Health::Truncated { after: None }, Reached::End) => {
            output::note(format_args!("{path} is truncated before its first state"));
        }
        (Health::Corrupt(damage), _) => output::note(format_args!("{path} is corrupt: {damage}")),
    }
    Exit::Damaged
}
