//! The errors of scenes and event lines as the user sees them, with the location in the text.

use crate::snapshot::assert_text;
use miette::{GraphicalReportHandler, GraphicalTheme};
use proptest::prelude::*;
use rebond::internals::cli::ErrorReport;
use rebond::internals::scene::{self, SceneError, live};

/// A valid scene, which the tests make invalid in one place.
const VALID: &str = r#"title = "Two boxes"
[world]
size = [16.0, 9.0]
walls = true
[run]
rate = 60
steps = 600
solver = "handout"
[restitution]
"steel/wood" = 0.7
[[spawn]]
name = "c"
at = [2.0, 3.0]
size = [1.0, 1.0]
mass = 2.0
"#;

fn rendered(error: SceneError) -> String {
    let mut text = String::new();
    let handler =
        GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(100).with_links(false);
    for (index, report) in ErrorReport::of_scene(&error).iter().enumerate() {
        text.push_str(if index > 0 { "\n" } else { "" });
        handler.render_report(&mut text, report).expect("a report is text");
    }
    text
}

/// The rendered error of an invalid scene.
fn rendered_error(text: &str) -> String {
    match scene::parse("two.toml", text) {
        Ok(_) => panic!("the scene should be invalid:\n{text}"),
        Err(error) => rendered(error),
    }
}

/// The valid scene with `old`, which it contains once, replaced by `new`.
fn with_replaced(old: &str, new: &str) -> String {
    assert_eq!(VALID.matches(old).count(), 1, "{old}");
    VALID.replace(old, new)
}

/// The valid scene with more text at its end.
fn with_appended(more: &str) -> String {
    format!("{VALID}{more}\n")
}

fn assert_errors(name: &str, scenes: &[(&str, String)]) {
    let errors: Vec<String> =
        scenes.iter().map(|(title, text)| format!("# {title}\n{}", rendered_error(text))).collect();
    assert_text(name, &errors.join("\n"));
}

#[test]
fn the_valid_scene_is_accepted() {
    assert_eq!(scene::parse("two.toml", VALID).map(|scene| scene.inputs.len()).ok(), Some(5));
}

#[test]
fn errors_of_keys_match_their_snapshot() {
    assert_errors(
        "scene-errors-keys",
        &[
            ("not TOML", with_replaced("rate = 60", "rate = 60 Hz")),
            ("the same key twice", with_replaced("mass = 2.0", "mass = 2.0\nmass = 3.0")),
            ("a misspelled key", with_replaced("mass = 2.0", "masss = 2.0")),
            ("an unknown key", with_appended("position = [1.0, 1.0]")),
            ("an unknown table", with_appended("[camera]\nzoom = 2.0")),
            ("a missing key", with_replaced("mass = 2.0\n", "")),
            ("a missing table", "title = \"nothing\"\n".into()),
            ("neither steps nor duration", with_replaced("steps = 600\n", "")),
            ("both steps and duration", with_replaced("steps = 600", "steps = 600\nduration = 10.0")),
            ("a single table instead of an array of tables", with_replaced("[[spawn]]", "[spawn]")),
        ],
    );
}

#[test]
fn errors_of_values_match_their_snapshot() {
    assert_errors(
        "scene-errors-values",
        &[
            ("a wrong type", with_replaced("mass = 2.0", "mass = \"heavy\"")),
            ("a mass of zero", with_replaced("mass = 2.0", "mass = 0")),
            ("an infinite size", with_replaced("size = [1.0, 1.0]", "size = [1.0, inf]")),
            ("a position that is not a number", with_replaced("at = [2.0, 3.0]", "at = [nan, 3.0]")),
            ("one number too many", with_replaced("at = [2.0, 3.0]", "at = [2.0, 3.0, 4.0]")),
            ("a number beyond f64", with_replaced("rate = 60", "rate = 1e999")),
            (
                "a sum that overflows",
                with_replaced("at = [2.0, 3.0]\nsize = [1.0, 1.0]", "at = [1.7e308, 0.0]\nsize = [1e308, 1.0]"),
            ),
            ("a fractional step", with_replaced("steps = 600", "steps = 600.5")),
            ("a negative step", with_appended("step = -1")),
            ("a run longer than a recording can be", with_replaced("rate = 60", "rate = 1e-9")),
            ("an unknown solver", with_replaced("\"handout\"", "\"box2d\"")),
            ("a reserved name", with_replaced("name = \"c\"", "name = \"#1\"")),
            ("an empty name", with_replaced("name = \"c\"", "name = \"\"")),
            ("a name that is too long", with_replaced("name = \"c\"", &format!("name = \"{}\"", "c".repeat(257)))),
            ("a colour in words", with_appended("color = \"blue\"")),
            ("a material with a slash", with_appended("material = \"steel/wood\"")),
            ("a picture too large", with_appended("[figure]\nsize = [1280, 99999]")),
            ("an overlay twice", with_appended("[figure]\nshow = [\"name\", \"clock\", \"name\"]")),
        ],
    );
}

#[test]
fn several_errors_are_reported_together() {
    let bodies = "[[spawn]]\nname = \"d\"\nat = [9.0, 3.0]\nsize = [1.0, 1.0]\nmass = -1.0\n";
    let deletes = "[[delete]]\nstep = 9\nname = \"d\"\n[[delete]]\nstep = 9\nname = \"e\"\n";
    assert_errors(
        "scene-errors-several",
        &[
            ("independent errors", with_appended(&format!("{bodies}{deletes}")).replace("walls", "wals")),
            ("more errors than are listed", with_appended(&"[[delete]]\nname = \"e\"\n".repeat(22))),
        ],
    );
}

#[test]
fn errors_of_restitution_match_their_snapshot() {
    assert_errors(
        "scene-errors-restitution",
        &[
            ("e above 1", with_replaced("= 0.7", "= 1.05")),
            ("one material", with_replaced("\"steel/wood\"", "steel")),
            ("three materials", with_replaced("\"steel/wood\"", "\"steel/wood/cork\"")),
            ("a pair the other way round", with_replaced("= 0.7", "= 0.7\n\"wood/steel\" = 0.6")),
        ],
    );
}

#[test]
fn errors_of_names_and_steps_match_their_snapshot() {
    let body = "at = [9.0, 3.0]\nsize = [1.0, 1.0]\nmass = 2.0\n";
    assert_errors(
        "scene-errors-names",
        &[
            ("a name in use", with_appended(&format!("[[spawn]]\nname = \"c\"\nstep = 9\n{body}"))),
            ("the name of a wall", with_appended(&format!("[[spawn]]\nname = \"wall-top\"\n{body}"))),
            ("a delete of an unknown name", with_appended("[[delete]]\nstep = 9\nname = \"d\"")),
            ("a delete before the spawn", with_appended("[[delete]]\nname = \"c\"")),
            (
                "a second delete",
                with_appended("[[delete]]\nstep = 7\nname = \"c\"\n[[delete]]\nstep = 9\nname = \"c\""),
            ),
            ("a number without a body", with_appended("[[delete]]\nstep = 9\nname = \"#2\"")),
            ("an event after the last step", with_appended("[[delete]]\nstep = 601\nname = \"c\"")),
        ],
    );
}

#[test]
fn errors_of_scatters_match_their_snapshot() {
    let scatter = |count: &str, region: &str, size: &str, mass: &str| {
        with_appended(&format!("[[scatter]]\ncount = {count}\nregion = {region}\nsize = {size}\nmass = {mass}"))
    };
    let (region, size, mass) = ("[4.0, 0.0, 9.0, 9.0]", "[[1.0, 1.0], [1.0, 1.0]]", "[1.0, 1.0]");
    assert_errors(
        "scene-errors-scatter",
        &[
            ("more than fit", scatter("80", region, size, mass)),
            ("more than a scene may have", scatter("1000001", region, size, mass)),
            ("a region smaller than a body", scatter("10", "[4.0, 0.0, 0.5, 9.0]", size, mass)),
            ("a descending range", scatter("10", region, "[[1.0, 2.0], [1.0, 1.0]]", mass)),
            ("a range to infinity", scatter("10", region, size, "[1.0, inf]")),
        ],
    );
}

#[test]
fn errors_of_event_lines_match_their_snapshot() {
    let lines = [
        ("not JSON", r#"{"spawn": {"name": "b" "at": [2.0, 5.0]}}"#),
        ("cut short", r#"{"spawn": {"name": "b","#),
        ("no event", "{}"),
        ("two events", r#"{"delete": {"name": "b"}, "click": {"at": [1, 2]}}"#),
        ("a key twice", r#"{"delete": {"name": "b", "name": "c"}}"#),
        ("a misspelled key", r#"{"delete": {"nam": "b"}}"#),
        ("infinity where it is not accepted", r#"{"click": {"at": ["inf", 2.0]}}"#),
        ("a negative mass", r#"{"spawn": {"at": [2.0, 5.0], "size": [1, 1], "mass": -1e3}}"#),
        ("null", "null"),
    ];
    let errors: Vec<String> = lines
        .iter()
        .map(|(title, line)| match live::parse_line(17, line) {
            Ok(event) => panic!("the line should be invalid: {event:?}"),
            Err(error) => format!("# {title}\n{}", rendered(error)),
        })
        .collect();
    assert_text("scene-errors-events", &errors.join("\n"));
}

/// Pieces of text that are significant to one of the parsers or to the checks after them.
const PIECES: [&str; 24] = [
    "[[spawn]]",
    "[spawn]",
    "[[click]]",
    "[[scatter]]",
    "[[delete]]",
    "name = \"c\"",
    "name = \"#1\"",
    "step = 9",
    "inf",
    "-inf",
    "nan",
    "1e308",
    "-1",
    "0",
    "18446744073709551616",
    "\"",
    "'",
    "\n",
    "[",
    "]",
    "{",
    "}",
    "é\u{0}",
    "\r",
];

proptest! {
    #[test]
    fn no_text_makes_the_parser_panic_or_an_error_point_outside_the_text(
        cut in 0..=VALID.len(),
        skip in 0_usize..40,
        pieces in prop::collection::vec(prop::sample::select(&PIECES[..]), 0..6),
    ) {
        let text = format!("{}{}{}", &VALID[..cut], pieces.join(" "), &VALID[VALID.len().min(cut + skip)..]);
        if let Err(error) = scene::parse("two.toml", &text) {
            rendered(error);
        }
    }

    #[test]
    fn no_line_makes_the_parser_panic_or_an_error_point_outside_the_line(
        cut in 0..=EVENT.len(),
        skip in 0_usize..20,
        pieces in prop::collection::vec(prop::sample::select(&PIECES[..]), 0..6),
    ) {
        let line = format!("{}{}{}", &EVENT[..cut], pieces.join(""), &EVENT[EVENT.len().min(cut + skip)..]);
        if let Err(error) = live::parse_line(3, &line) {
            rendered(error);
        }
    }
}

/// A valid line.
const EVENT: &str = r#"{"spawn": {"step": 30, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": "inf"}}"#;
