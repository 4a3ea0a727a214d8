//! Checks the guide's reference of the scene format against the keys of the parser.

use super::{
    KEYS, action, inputs, live,
    options::{self, DEFAULT_RATE, DEFAULT_RESTITUTION, DEFAULT_SIZE, DEFAULT_SOLVER},
    parse, scatter,
    tree::Key,
};
use crate::physics::DEFAULT_EVENTS_PER_STEP;

const GUIDE: &str = include_str!("../guide/scene-format.md");

/// The heading of each table of keys in the guide, and the keys of the parser.
fn sections() -> Vec<(&'static str, Vec<Key>)> {
    vec![
        ("## Top level", [KEYS, inputs::KEYS].concat()),
        ("## `[world]`", options::WORLD_KEYS.to_vec()),
        ("## `[run]`", options::RUN_KEYS.to_vec()),
        ("## `[restitution]`", options::RESTITUTION_KEYS.to_vec()),
        ("## `[[spawn]]`", action::SPAWN_KEYS.to_vec()),
        ("## `[[delete]]`", action::DELETE_KEYS.to_vec()),
        ("## `[[click]]`", action::CLICK_KEYS.to_vec()),
        ("### `spawn` in `[[click]]`", action::BLUEPRINT_KEYS.to_vec()),
        ("## `[[scatter]]`", scatter::KEYS.to_vec()),
        ("## `[figure]`", options::FIGURE_KEYS.to_vec()),
        ("## Live events", live::KEYS.to_vec()),
    ]
}

/// The rows of all tables of keys, each with its heading.
fn rows() -> Vec<(&'static str, Vec<String>)> {
    let (mut heading, mut is_key_table) = ("", false);
    let mut rows = Vec::new();
    for line in GUIDE.lines() {
        if line.starts_with('#') {
            heading = line;
        }
        let Some(row) = line.strip_prefix("| ") else {
            is_key_table = is_key_table && line.starts_with('|');
            continue;
        };
        let cells: Vec<String> = row.split('|').map(|cell| cell.trim().replace('`', "")).collect();
        if cells[0] == "Key" {
            is_key_table = true;
        } else if is_key_table {
            rows.push((heading, cells));
        }
    }
    rows
}

/// The code blocks of a language.
fn blocks(language: &str) -> Vec<&'static str> {
    let fence = format!("```{language}\n");
    GUIDE.split(fence.as_str()).skip(1).map(|rest| rest.split("```").next().unwrap_or_default()).collect()
}

#[test]
fn every_key_of_the_parser_is_in_the_guide_with_its_accepted_values() {
    let rows = rows();
    for (heading, keys) in sections() {
        for Key { name, accepts } in keys {
            let row = rows.iter().find(|(section, cells)| *section == heading && cells[0] == name);
            let (_, cells) = row.unwrap_or_else(|| panic!("{heading} has no key {name}"));
            assert!(cells.iter().any(|cell| cell == accepts), "{heading}, {name}: {accepts}\n{cells:?}");
        }
    }
}

#[test]
fn every_key_in_the_guide_is_a_key_of_the_parser() {
    let sections = sections();
    for (heading, cells) in rows() {
        let section = sections.iter().find(|(section, _)| *section == heading);
        let (_, keys) = section.unwrap_or_else(|| panic!("unexpected table of keys in {heading}"));
        assert!(keys.iter().any(|key| key.name == cells[0]), "{heading}: {}", cells[0]);
    }
}

#[test]
fn the_defaults_in_the_guide_are_those_of_the_parser() {
    let defaults = [
        ("## `[world]`", "size", format!("{DEFAULT_SIZE:?}")),
        ("## `[run]`", "rate", DEFAULT_RATE.to_string()),
        ("## `[run]`", "solver", format!("{:?}", DEFAULT_SOLVER.name())),
        ("## `[run]`", "events_per_step", DEFAULT_EVENTS_PER_STEP.to_string()),
        ("## `[restitution]`", "default", format!("{:?}", DEFAULT_RESTITUTION)),
    ];
    let rows = rows();
    for (heading, name, default) in defaults {
        let row = rows.iter().find(|(section, cells)| *section == heading && cells[0] == name);
        assert_eq!(row.map(|(_, cells)| &cells[2]), Some(&default), "{heading}, {name}");
    }
}

#[test]
fn every_scene_in_the_guide_is_valid() {
    let blocks = blocks("toml");
    assert!(blocks.len() > 3);
    for block in blocks {
        // An excerpt becomes a scene with a number of steps.
        let is_excerpt = !block.contains("[run]");
        let text = if is_excerpt { format!("{block}\n[run]\nsteps = 600\n") } else { block.into() };
        if let Err(error) = parse("scene-format.md", &text) {
            panic!("{error}\n{text}");
        }
    }
}

#[test]
fn every_event_line_in_the_guide_is_valid() {
    for (number, line) in (1..).zip(blocks("json").concat().lines()) {
        live::parse_line(number, line).unwrap_or_else(|error| panic!("{error}"));
    }
}
