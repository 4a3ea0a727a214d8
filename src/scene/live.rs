//! Live events: one JSON object per line, with the keys of the scene format.

use super::{
    Action, Diagnostic, DiagnosticKind, Excerpt, SceneError,
    action::{self, Request, read_click, read_delete, read_spawn},
    diagnostic::{ErrorReported, Reporter},
    tree::{Key, Table, Value, parse_json},
};

/// An event of a JSON Lines file or pipe.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveEvent {
    /// The step at which it takes effect; if absent, one step after the previous event.
    pub step: Option<u64>,
    /// The action.
    pub action: Action,
}

const SPAWN: Key = Key { name: "spawn", accepts: "the keys of [[spawn]]" };
const DELETE: Key = Key { name: "delete", accepts: "the keys of [[delete]]" };
const CLICK: Key = Key { name: "click", accepts: "the keys of [[click]]" };

/// The keys of an event line.
pub(super) const KEYS: &[Key] = &[SPAWN, DELETE, CLICK];

/// Parses the event on line `number` (from 1), whose text is `line`.
///
/// # Errors
/// [`SceneError::Event`] with all independent errors of the line.
pub fn parse_line(number: u64, line: &str) -> Result<LiveEvent, SceneError> {
    let reporter = Reporter::default();
    let event = read(line, &reporter);
    let in_line = |diagnostics| SceneError::Event { line: number, diagnostics };
    reporter.finish(event, || excerpt(number, line)).map_err(in_line)
}

/// The line with control characters replaced, because they could control the terminal that shows it.
fn excerpt(number: u64, line: &str) -> Excerpt {
    let text = line.replace(|letter: char| letter.is_ascii_control() && letter != '\t', "?");
    Excerpt { name: "events".into(), line: number, text }
}

fn read(line: &str, reporter: &Reporter) -> Result<LiveEvent, ErrorReported> {
    let root = parse_json(line).map_err(|error| reporter.report(error))?;
    let not_one_event = || Diagnostic::new(DiagnosticKind::NotOneEvent, root.span.clone());
    let Value::Table(_) = root.value else { return Err(reporter.report(not_one_event())) };
    let table = Table::open("", &root, KEYS, reporter)?;
    let Request { step, event, .. } = match (table.get(SPAWN)?, table.get(DELETE)?, table.get(CLICK)?) {
        (Some(spawn), None, None) => read_spawn(&Table::open("spawn", spawn.node, action::SPAWN_KEYS, reporter)?),
        (None, Some(delete), None) => read_delete(&Table::open("delete", delete.node, action::DELETE_KEYS, reporter)?),
        (None, None, Some(click)) => read_click(&Table::open("click", click.node, action::CLICK_KEYS, reporter)?),
        (None, None, None) => return Err(table.first_unknown().unwrap_or_else(|| reporter.report(not_one_event()))),
        (None | Some(_), None | Some(_), None | Some(_)) => return Err(reporter.report(not_one_event())),
    };
    Ok(LiveEvent { step: step?.map(|(step, _)| step), action: event? })
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
        assert_eq!(
            (step, request.blueprint.name.as_deref(), request.blueprint.mass),
            (Some(30), Some("b"), f64::INFINITY)
        );
        assert!(request.blueprint.velocity.x.is_sign_positive(), "the velocity of an infinite mass has no −0");
        assert_eq!(request.origin, Vector::new(2.0, 5.0));
    }

    #[test]
    fn all_independent_errors_of_a_line_are_reported() {
        let error =
            parse_line(3, r#"{"spawn": {"at": [2.0, 5.0], "size": [1, 0], "mass": -1, "colour": "red"}}"#).unwrap_err();
        let messages: Vec<String> = error.diagnostics().unwrap().listed().map(ToString::to_string).collect();
        let expected = ["`spawn.size` cannot be 0", "`spawn.mass` cannot be -1", "unknown key `spawn.colour`"];
        assert_eq!(messages, expected);
        assert_eq!(error.to_string(), "line 3 of the events: `spawn.size` cannot be 0 (and 2 more errors)");
    }

    #[test]
    fn the_step_of_a_line_may_be_absent() {
        let delete = LiveEvent { step: None, action: Action::Delete { name: "#3".into() } };
        assert_eq!(parse_line(1, r##"{"delete": {"name": "#3"}}"##).unwrap(), delete);
        let click = LiveEvent { step: None, action: Action::Click { at: Vector::new(4.0, 5.0), spawn: None } };
        assert_eq!(parse_line(2, r#"{"click": {"at": [4, 5e0]}}"#).unwrap(), click);
    }
}
