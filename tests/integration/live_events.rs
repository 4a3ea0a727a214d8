//! Events on standard input or from a JSON Lines file, beside the scene's own.

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

/// The step of the first and the last row of each body but `a`: `name first last`.
fn lives(workplace: &Workplace, recording: &str) -> Vec<String> {
    let table = workplace.done(&format!("export {recording}")).output;
    let mut lives: Vec<(String, String, String)> = Vec::new();
    for row in table.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        match lives.iter_mut().find(|life| life.0 == fields[2]) {
            Some(life) => life.2 = fields[0].into(),
            None => lives.push((fields[2].into(), fields[0].into(), fields[0].into())),
        }
    }
    lives.retain(|life| life.0 != "a");
    lives.into_iter().map(|(name, first, last)| format!("{name} {first} {last}")).collect()
}

#[test]
fn events_take_effect_at_the_step_they_name() {
    let workplace = Workplace::with_scene(SCENE);
    let lines = r#"{"spawn": {"step": 3, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}
{"spawn": {"step": 3, "at": [8.0, 5.0], "size": [1.0, 1.0], "mass": "inf"}}

{"delete": {"step": 9, "name": "b"}}
{"click": {"step": 12, "at": [12.0, 4.0], "spawn": {"size": [1.0, 1.0], "mass": 1.0}}}
{"click": {"step": 15, "at": [12.0, 4.0]}}
"#;
    workplace.write("events.jsonl", lines);
    workplace.done("record scene.toml -o file.mcap --events events.jsonl");
    assert_eq!(lives(&workplace, "file.mcap"), ["b 3 8", "#3 3 20", "#4 12 14"]);
    assert_eq!(workplace.done("replay file.mcap").output.lines().last(), Some("same: 20 steps, 4 bodies"));
    let piped = workplace.rebond_with_input("record scene.toml -o pipe.mcap --events -", lines);
    assert_eq!(piped.code, 0, "{piped:?}");
    assert!(workplace.read("file.mcap") == workplace.read("pipe.mcap"), "a pipe and a file give the same bytes");
}

#[test]
fn without_a_step_they_take_effect_at_the_next() {
    let workplace = Workplace::with_scene(SCENE);
    let spawn =
        |name: &str| format!(r#"{{"spawn": {{"name": "{name}", "at": [9.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}}}"#);
    let lines = [spawn("b"), r#"{"delete": {"step": 4, "name": "b"}}"#.into(), spawn("c")].join("\n");
    let outcome = workplace.rebond_with_input("record scene.toml -o run.mcap --events -", &lines);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert_eq!(lives(&workplace, "run.mcap"), ["b 1 3", "c 5 20"]);
}

#[test]
fn lines_that_cannot_be_obeyed_are_errors_with_their_number_or_are_counted() {
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
    let mut told = String::new();
    for (what, bad) in bad_lines {
        let workplace = Workplace::with_scene(SCENE);
        let lines = format!("{good}\n{bad}\n");
        let outcome = workplace.rebond_with_input("record scene.toml -o run.mcap --events -", &lines);
        assert_eq!(outcome.code, 1, "{what}: {outcome:?}");
        assert!(outcome.errors.contains("line 2"), "{what}: {outcome:?}");
        told += &format!("{what}\n{}\n", outcome.errors);
        let lenient = workplace.rebond_with_input("record scene.toml -o lenient.mcap --events - --lenient", &lines);
        assert_eq!(lenient.code, 0, "{what}: {lenient:?}");
        assert!(lenient.errors.contains("1 event line"), "{what}: {lenient:?}");
        assert_eq!(lives(&workplace, "lenient.mcap"), ["b 5 20"], "{what}");
    }
    assert_text("errors-of-live-events", &told);
}

/// What comes out of broken programs, wrong files and hostile pipes.
fn abuse() -> Vec<(&'static str, Vec<u8>)> {
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
        ("beyond the numbers", of(&at("1e400"))),
        ("no number", of(&at("NaN"))),
        ("half a step", of(r#"{"delete": {"step": 6.5, "name": "a"}}"#)),
        ("a step beyond the numbers", of(r#"{"delete": {"step": 99999999999999999999, "name": "a"}}"#)),
        ("lists in lists", vec![b'['; 5000]),
        ("a colour for the terminal", of("\u{1b}[31mred")),
    ]
}

#[test]
fn abuse_is_refused_in_a_few_words_and_skipped_if_asked_for() {
    let good = br#"{"spawn": {"step": 5, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}"#;
    let after = br#"{"delete": {"step": 11, "name": "b"}}"#;
    let mut told = String::new();
    for (what, bad) in abuse() {
        let workplace = Workplace::with_scene(SCENE);
        let lines = [good.as_slice(), &bad, after].join(&b'\n');
        let outcome = workplace.rebond_with_input("record scene.toml -o run.mcap --events -", &lines);
        assert_eq!(outcome.code, 1, "{what}: {outcome:?}");
        assert!(outcome.errors.contains("line 2"), "{what}: {outcome:?}");
        assert!(!outcome.errors.contains(['\0', '\u{1b}']), "{what}: {outcome:?}");
        let first = outcome.errors.lines().next().unwrap_or_default();
        told += &format!("{what}: {first}\n");
        let lenient = workplace.rebond_with_input("record scene.toml -o lenient.mcap --events - --lenient", &lines);
        assert_eq!(lenient.code, 0, "{what}: {lenient:?}");
        assert_eq!(lenient.errors, "1 event line(s) skipped\n", "{what}");
        assert_eq!(lives(&workplace, "lenient.mcap"), ["b 5 10"], "{what}");
        assert_eq!(workplace.done("replay lenient.mcap").output, "same: 20 steps, 2 bodies\n", "{what}");
    }
    assert_text("errors-of-abused-events", &told);
}

#[test]
fn lines_end_as_they_do_elsewhere() {
    let lines = [
        r#"{"spawn": {"step": 5, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": 2.0}}"#,
        r#"{"delete": {"step": 11, "name": "b"}}"#,
    ];
    let [unix, dos, marked, unended, nothing] = [
        lines.join("\n") + "\n",
        lines.join("\r\n") + "\r\n",
        format!("\u{feff}{}\n", lines.join("\n")),
        lines.join("\n\n \t\n"),
        String::new(),
    ];
    for (input, expected) in [(unix, 1), (dos, 1), (marked, 1), (unended, 1), (nothing, 0)] {
        let workplace = Workplace::with_scene(SCENE);
        let outcome = workplace.rebond_with_input("record scene.toml -o run.mcap --events -", &input);
        assert_eq!(outcome.code, 0, "{input:?}: {outcome:?}");
        assert_eq!(lives(&workplace, "run.mcap").len(), expected, "{input:?}");
    }
}
