//! Events one a line: JSON objects with the keys of the scene format.

use super::{
    Action, Fault, SceneError,
    action::{Request, read_click, read_delete, read_spawn},
    refusal::Refusal,
    tree::{Key, Table, parse_json},
};

/// One event of a JSON Lines file or pipe.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveEvent {
    /// The step it names; without one it takes effect at the next step.
    pub step: Option<u64>,
    /// What it does.
    pub action: Action,
}

const SPAWN: Key = Key { name: "spawn", accepts: "the keys of a body" };
const DELETE: Key = Key { name: "delete", accepts: "the name of a body" };
const CLICK: Key = Key { name: "click", accepts: "a point" };

/// The event on line `number` (from 1), whose text is `line`.
///
/// # Errors
/// [`SceneError::Event`] for the first thing in the line that is not as the format has it.
pub fn parse_line(number: u64, line: &str) -> Result<LiveEvent, SceneError> {
    read(line).map_err(|refusal| SceneError::in_event(number, line, refusal))
}

fn read(line: &str) -> Result<LiveEvent, Refusal> {
    let root = parse_json(line)?;
    let table = Table::open("", &root, &[SPAWN, DELETE, CLICK])?;
    let request = match (table.get(SPAWN), table.get(DELETE), table.get(CLICK)) {
        (Some(spawn), None, None) => read_spawn(spawn.node)?,
        (None, Some(delete), None) => read_delete(delete.node)?,
        (None, None, Some(click)) => read_click(click.node)?,
        (None | Some(_), None | Some(_), None | Some(_)) => return Err(Refusal::new(Fault::NotOneEvent, root.span)),
    };
    let Request { step, action, .. } = request;
    Ok(LiveEvent { step: step.map(|(step, _)| step), action })
}
