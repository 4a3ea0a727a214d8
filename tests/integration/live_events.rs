//! Live events from standard input or a JSON Lines file, in addition to those of the scene.

use crate::rebond::Workplace;
use crate::snapshot::assert_text;

const SCENE: &str = r#"
[world]
size = [16.0, 9.0]
[run]
rate = 60
steps = 20
solver = "handout"
[[spawn]]
name = "a"
at = [1.0, 1.0]
size = [1.0, 1.0]
mass = 1.0
"#;

/// The first and the last step of each body except `a`: `name first last`.
fn lifetimes(workplace: &Workplace, recording: &str) -> Vec<String> {
    let table = workplace.done(&format!("export {recording}")).output;
    let mut lifetimes: Vec<(String, String, String)> = Vec::new();
    for row in table.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        match lifetimes.iter_mut().find(|lifetime| lifetime.0 == fields[2]) {
            Some(lifetime) => lifetime.2 = fields[0].into(),
            None => lifetimes.push((fields[2].into(), fields[0].into(), fields[0].into())),
        }
    }
    lifetimes.retain(|lifetime| lifetime.0 != "a");
    lifetimes.into_iter().map(|(name, first, last)| format!("{name} {first} {last}")).collect()
}

#[test]
fn events_take_effect_at_the_step_that_they_name() {
    let workplace = Workplace::with_scene(SCENE);
    let lines = r#"{"spawn": {"step": 3, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}
{"spawn": {"step": 3, "at": [8.0, 5.0], "size": [1.0, 1.0], "mass": "inf"}}

{"delete": {"step": 9, "name": "b"}}
{"click": {"step": 12, "at": [12.0, 4.0], "spawn": {"size": [1.0, 1.0], "mass": 1.0}}}
{"click": {"step": 15, "at": [12.0, 4.0]}}
"#;
    workplace.write("events.jsonl", lines);
    workplace.done("record scene.toml -o file.mcap --events events.jsonl");
    assert_eq!(lifetimes(&workplace, "file.mcap"), ["b 3 8", "#3 3 20", "#4 12 14"]);
    assert_eq!(workplace.done("replay file.mcap").output.lines().last(), Some("same: 20 steps, 4 bodies"));
    let piped = workplace.rebond_with_input("record scene.toml -o pipe.mcap --events -", lines);
    assert_eq!(piped.code, 0, "{piped:?}");
    assert!(workplace.read("file.mcap") == workplace.read("pipe.mcap"), "a pipe and a file give the same bytes");
}

#[test]
fn events_without_a_step_take_effect_one_step_after_the_line_before() {
    let workplace = Workplace::with_scene(SCENE);
    let spawn =
        |name: &str| format!(r#"{{"spawn": {{"name": "{name}", "at": [9.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}}}"#);
    let lines = [spawn("b"), r#"{"delete": {"step": 4, "name": "b"}}"#.into(), spawn("c")].join("\n");
    let outcome = workplace.rebond_with_input("record scene.toml -o run.mcap --events -", &lines);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert_eq!(lifetimes(&workplace, "run.mcap"), ["b 1 3", "c 5 20"]);
}

#[test]
fn invalid_lines_are_errors_that_name_the_line_or_are_skipped_and_counted() {
    let good = r#"{"spawn": {"step": 5, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}"#;
    let bad_lines = [
        ("malformed", r#"{"spawn": {"step": 6, "#),
        ("unknown event", r#"{"explode": {"step": 6}}"#),
        ("unknown key", r#"{"delete": {"step": 6, "nam": "a"}}"#),
        ("wrong type", r#"{"delete": {"step": "six", "name": "a"}}"#),
        ("negative mass", r#"{"spawn": {"step": 6, "at": [9.0, 5.0], "size": [1.0, 1.0], "mass": -2.0}}"#),
        ("late", r#"{"delete": {"step": 4, "name": "a"}}"#),
        ("after the last step", r#"{"delete": {"step": 21, "name": "a"}}"#),
        ("not alive", r#"{"delete": {"step": 6, "name": "nobody"}}"#),
        ("name taken", r#"{"spawn": {"step": 6, "name": "a", "at": [9.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}"#),
    ];
    let mut errors = String::new();
    for (title, bad) in bad_lines {
        let workplace = Workplace::with_scene(SCENE);
        let lines = format!("{good}\n{bad}\n");
        let outcome = workplace.rebond_with_input("record scene.toml -o run.mcap --events -", &lines);
        assert_eq!(outcome.code, 1, "{title}: {outcome:?}");
        assert!(outcome.errors.contains("line 2"), "{title}: {outcome:?}");
        errors += &format!("{title}\n{}\n", outcome.errors);
        let lenient = workplace.rebond_with_input("record scene.toml -o lenient.mcap --events - --lenient", &lines);
        assert_eq!(lenient.code, 0, "{title}: {lenient:?}");
        assert!(lenient.errors.contains("1 event line"), "{title}: {lenient:?}");
        assert_eq!(lifetimes(&workplace, "lenient.mcap"), ["b 5 20"], "{title}");
    }
    assert_text("errors-of-live-events", &errors);
}

/// Lines as from broken programs, wrong files and hostile pipes.
fn hostile_lines() -> Vec<(&'static str, Vec<u8>)> {
    let of = |text: &str| text.as_bytes().to_vec();
    let named = |name: String| format!(r#"{{"spawn": {{"name": "{name}", "at": [9, 5], "size": [1, 1], "mass": 2}}}}"#);
    let at = |x: &str| format!(r#"{{"spawn": {{"at": [{x}, 5], "size": [1, 1], "mass": 2}}}}"#);
    vec![
        ("half a line", of(r#"{"delete": {"step": 9, "na"#)),
        ("a megabyte", vec![b'x'; 1_000_000]),
        ("a megabyte of spaces before an event", [vec![b' '; 1_000_000], of(&named("c".into()))].concat()),
        ("a long name", of(&named("n".repeat(300)))),
        ("zeros", vec![0; 5]),
        ("a zero in a name", of(&named("c\0".into()))),
        ("an escaped zero in a name", of(&named(r"c\u0000".into()))),
        ("half a surrogate", of(&named(r"\ud800".into()))),
        ("not UTF-8", [of(r#"{"delete": {"name": ""#), vec![0xff, 0xfe], of(r#""}}"#)].concat()),
        ("UTF-16", "{}".encode_utf16().chain([0xd800]).flat_map(u16::to_le_bytes).collect()),
        ("a key twice", of(r#"{"delete": {"name": "a", "name": "a"}}"#)),
        ("two events", of(r#"{"delete": {"name": "a"}} {"delete": {"name": "a"}}"#)),
        ("a number beyond f64", of(&at("1e400"))),
        ("not a number", of(&at("NaN"))),
        ("a fractional step", of(r#"{"delete": {"step": 6.5, "name": "a"}}"#)),
        ("a step beyond u64", of(r#"{"delete": {"step": 99999999999999999999, "name": "a"}}"#)),
        ("nested lists", vec![b'['; 5000]),
        ("a terminal escape sequence", of("\u{1b}[31mred")),
    ]
}

#[test]
fn hostile_lines_are_rejected_with_a_short_message_or_skipped() {
    let good = br#"{"spawn": {"step": 5, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}"#;
    let after = br#"{"delete": {"step": 11, "name": "b"}}"#;
    let mut errors = String::new();
    for (title, bad) in hostile_lines() {
        let workplace = Workplace::with_scene(SCENE);
        let lines = [good.as_slice(), &bad, after].join(&b'\n');
        let outcome = workplace.rebond_with_input("record scene.toml -o run.mcap --events -", &lines);
        assert_eq!(outcome.code, 1, "{title}: {outcome:?}");
        assert!(outcome.errors.contains("line 2"), "{title}: {outcome:?}");
        assert!(!outcome.errors.contains(['\0', '\u{1b}']), "{title}: {outcome:?}");
        let first = outcome.errors.lines().next().unwrap_or_default();
        errors += &format!("{title}: {first}\n");
        let lenient = workplace.rebond_with_input("record scene.toml -o lenient.mcap --events - --lenient", &lines);
        assert_eq!(lenient.code, 0, "{title}: {lenient:?}");
        assert_eq!(lenient.errors, "skipped 1 event line\n", "{title}");
        assert_eq!(lifetimes(&workplace, "lenient.mcap"), ["b 5 10"], "{title}");
        assert_eq!(workplace.done("replay lenient.mcap").output, "same: 20 steps, 2 bodies\n", "{title}");
    }
    assert_text("errors-of-abused-events", &errors);
}

#[test]
fn all_common_line_ends_and_a_byte_order_mark_are_accepted() {
    let lines = [
        r#"{"spawn": {"step": 5, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}"#,
        r#"{"delete": {"step": 11, "name": "b"}}"#,
    ];
    let [unix, dos, with_bom, unterminated, empty] = [
        lines.join("\n") + "\n",
        lines.join("\r\n") + "\r\n",
        format!("\u{feff}{}\n", lines.join("\n")),
        lines.join("\n\n \t\n"),
        String::new(),
    ];
    for (input, expected) in [(unix, 1), (dos, 1), (with_bom, 1), (unterminated, 1), (empty, 0)] {
        let workplace = Workplace::with_scene(SCENE);
        let outcome = workplace.rebond_with_input("record scene.toml -o run.mcap --events -", &input);
        assert_eq!(outcome.code, 0, "{input:?}: {outcome:?}");
        assert_eq!(lifetimes(&workplace, "run.mcap").len(), expected, "{input:?}");
    }
}

#[test]
fn a_folder_of_events_is_refused_by_its_name() {
    let refused = Workplace::with_scene(SCENE).rebond("record scene.toml -o run.mcap --events .");
    assert!(refused.code == 1 && refused.errors.contains("cannot read .: is a directory"), "{refused:?}");
}

/// The device has neither a line break nor an end.
#[cfg(target_os = "linux")]
#[test]
fn an_endless_line_is_refused() {
    let workplace = Workplace::with_scene(SCENE);
    for (option, problem) in
        [("", "is longer than 8192 bytes"), ("--lenient", "has no line break within 16777216 bytes")]
    {
        let refused = workplace.rebond(&format!("record scene.toml -o run.mcap --events /dev/zero {option}"));
        assert_eq!(refused.code, 1, "{refused:?}");
        assert!(refused.errors.contains(&format!("line 1 of the events {problem}")), "{refused:?}");
    }
}

/// The end of the line does not count.
#[test]
fn a_line_may_have_8192_bytes() {
    let workplace = Workplace::with_scene(SCENE);
    let event = r#"{"click": {"step": 3, "at": [4.0, 5.0]}}"#;
    for end in ["", "\n", "\r\n"] {
        for (length, code) in [(8192, 0), (8193, 1)] {
            workplace.write("events.jsonl", &format!("{event}{}{end}", " ".repeat(length - event.len())));
            let recorded = workplace.rebond("record scene.toml --events events.jsonl -o run.mcap --force");
            assert_eq!(recorded.code, code, "{length} bytes and {end:?}: {recorded:?}");
        }
    }
}
