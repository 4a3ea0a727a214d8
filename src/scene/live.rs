//! Events one a line: JSON objects with the keys of the scene format.

use super::{
    Action, Fault, SceneError,
    action::{Request, read_click, read_delete, read_spawn},
    refusal::Refusal,
    tree::{Key, Table, Value, parse_json},
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
    let Value::Table(_) = root.value else { return Err(Refusal::new(Fault::NotOneEvent, root.span)) };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Vector;

    #[test]
    fn a_line_has_the_keys_of_the_scene_format() {
        let line = r#"{"spawn": {"step": 30, "name": "b", "at": [2.0, 5.0], "size": [1, 1], "mass": "inf", "velocity": [-0.0, 2]}}"#;
        let LiveEvent { step, action: Action::Spawn(request) } = parse_line(1, line).unwrap() else {
            panic!("a spawn")
        };
        assert_eq!((step, request.name.as_deref(), request.mass), (Some(30), Some("b"), f64::INFINITY));
        assert!(request.velocity.x.is_sign_positive(), "an infinite mass at rest has one zero only");
        assert_eq!(request.rect.origin, Vector::new(2.0, 5.0));
    }

    #[test]
    fn a_line_without_a_step_leaves_it_to_the_run() {
        let delete = LiveEvent { step: None, action: Action::Delete { name: "#3".into() } };
        assert_eq!(parse_line(1, r##"{"delete": {"name": "#3"}}"##).unwrap(), delete);
        let click = LiveEvent { step: None, action: Action::Click { at: Vector::new(4.0, 5.0), spawn: None } };
        assert_eq!(parse_line(2, r#"{"click": {"at": [4, 5e0]}}"#).unwrap(), click);
    }
}
