//! What a scene is refused for, and how that reads: one fault each, pointed at in the text.

use crate::snapshot::assert_text;
use miette::{GraphicalReportHandler, GraphicalTheme};
use proptest::prelude::*;
use rebond::scene::{self, SceneError, live};

/// A scene that is fine, to be spoilt in one place.
const GOOD: &str = r#"title = "Two boxes"
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

fn rendered(error: &SceneError) -> String {
    let mut text = String::new();
    let handler =
        GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(100).with_links(false);
    handler.render_report(&mut text, error).expect("a report is text");
    text
}

/// How the scene is refused.
fn refusal(text: &str) -> String {
    match scene::parse("two.toml", text) {
        Ok(_) => panic!("this should be refused:\n{text}"),
        Err(error) => rendered(&error),
    }
}

/// The good scene with `old`, which is in it once, made `new`.
fn spoilt(old: &str, new: &str) -> String {
    assert_eq!(GOOD.matches(old).count(), 1, "{old}");
    GOOD.replace(old, new)
}

/// The good scene with more at its end.
fn followed_by(more: &str) -> String {
    format!("{GOOD}{more}\n")
}

fn assert_refused(name: &str, scenes: &[(&str, String)]) {
    let told: Vec<String> = scenes.iter().map(|(what, text)| format!("# {what}\n{}", refusal(text))).collect();
    assert_text(name, &told.join("\n"));
}

#[test]
fn the_good_scene_is_read() {
    assert_eq!(scene::parse("two.toml", GOOD).map(|scene| scene.inputs.len()).ok(), Some(5));
}

#[test]
fn keys() {
    assert_refused(
        "scene-errors-keys",
        &[
            ("not TOML", spoilt("rate = 60", "rate = 60 Hz")),
            ("the same key twice", spoilt("mass = 2.0", "mass = 2.0\nmass = 3.0")),
            ("a misspelt key", spoilt("mass = 2.0", "masss = 2.0")),
            ("an unknown key", followed_by("position = [1.0, 1.0]")),
            ("an unknown table", followed_by("[camera]\nzoom = 2.0")),
            ("a missing key", spoilt("mass = 2.0\n", "")),
            ("a missing table", "title = \"nothing\"\n".into()),
            ("neither steps nor duration", spoilt("steps = 600\n", "")),
            ("both steps and duration", spoilt("steps = 600", "steps = 600\nduration = 10.0")),
            ("a table where there can be several", spoilt("[[spawn]]", "[spawn]")),
        ],
    );
}

#[test]
fn values() {
    assert_refused(
        "scene-errors-values",
        &[
            ("a wrong type", spoilt("mass = 2.0", "mass = \"heavy\"")),
            ("a mass of zero", spoilt("mass = 2.0", "mass = 0")),
            ("an infinite size", spoilt("size = [1.0, 1.0]", "size = [1.0, inf]")),
            ("a place that is not a number", spoilt("at = [2.0, 3.0]", "at = [nan, 3.0]")),
            ("one number too many", spoilt("at = [2.0, 3.0]", "at = [2.0, 3.0, 4.0]")),
            ("a number beyond all floats", spoilt("rate = 60", "rate = 1e999")),
            (
                "a sum that overflows",
                spoilt("at = [2.0, 3.0]\nsize = [1.0, 1.0]", "at = [1.7e308, 0.0]\nsize = [1e308, 1.0]"),
            ),
            ("a part of a step", spoilt("steps = 600", "steps = 600.5")),
            ("a negative step", followed_by("step = -1")),
            ("a run longer than recordings count", spoilt("rate = 60", "rate = 1e-9")),
            ("an unknown solver", spoilt("\"handout\"", "\"box2d\"")),
            ("a name kept for others", spoilt("name = \"c\"", "name = \"#1\"")),
            ("an empty name", spoilt("name = \"c\"", "name = \"\"")),
            ("a name without end", spoilt("name = \"c\"", &format!("name = \"{}\"", "c".repeat(257)))),
            ("a colour in words", followed_by("color = \"blue\"")),
            ("a material that looks like a pair", followed_by("material = \"steel/wood\"")),
            ("a picture too large", followed_by("[figure]\nsize = [1280, 99999]")),
            ("an overlay twice", followed_by("[figure]\nshow = [\"name\", \"clock\", \"name\"]")),
        ],
    );
}

#[test]
fn restitution() {
    assert_refused(
        "scene-errors-restitution",
        &[
            ("e above 1", spoilt("= 0.7", "= 1.05")),
            ("one material", spoilt("\"steel/wood\"", "steel")),
            ("three materials", spoilt("\"steel/wood\"", "\"steel/wood/cork\"")),
            ("a pair the other way round", spoilt("= 0.7", "= 0.7\n\"wood/steel\" = 0.6")),
        ],
    );
}

#[test]
fn names_and_steps() {
    let body = "at = [9.0, 3.0]\nsize = [1.0, 1.0]\nmass = 2.0\n";
    assert_refused(
        "scene-errors-names",
        &[
            ("a name taken", followed_by(&format!("[[spawn]]\nname = \"c\"\nstep = 9\n{body}"))),
            ("the name of a wall", followed_by(&format!("[[spawn]]\nname = \"wall-top\"\n{body}"))),
            ("a delete of nobody", followed_by("[[delete]]\nstep = 9\nname = \"d\"")),
            ("a delete before the spawn", followed_by("[[delete]]\nname = \"c\"")),
            ("a second delete", followed_by("[[delete]]\nstep = 7\nname = \"c\"\n[[delete]]\nstep = 9\nname = \"c\"")),
            ("a number that is not given out", followed_by("[[delete]]\nstep = 9\nname = \"#2\"")),
            ("an event after the last step", followed_by("[[delete]]\nstep = 601\nname = \"c\"")),
        ],
    );
}

#[test]
fn scatter() {
    let scatter = |count: &str, region: &str, size: &str, mass: &str| {
        followed_by(&format!("[[scatter]]\ncount = {count}\nregion = {region}\nsize = {size}\nmass = {mass}"))
    };
    let (region, size, mass) = ("[4.0, 0.0, 9.0, 9.0]", "[[1.0, 1.0], [1.0, 1.0]]", "[1.0, 1.0]");
    assert_refused(
        "scene-errors-scatter",
        &[
            ("more than fit", scatter("80", region, size, mass)),
            ("more than a scene may have", scatter("1000001", region, size, mass)),
            ("a region smaller than a body", scatter("10", "[4.0, 0.0, 0.5, 9.0]", size, mass)),
            ("a range that goes down", scatter("10", region, "[[1.0, 2.0], [1.0, 1.0]]", mass)),
            ("a range to infinity", scatter("10", region, size, "[1.0, inf]")),
        ],
    );
}

#[test]
fn lines_of_events() {
    let lines = [
        ("not JSON", r#"{"spawn": {"name": "b" "at": [2.0, 5.0]}}"#),
        ("cut short", r#"{"spawn": {"name": "b","#),
        ("no event", "{}"),
        ("two events", r#"{"delete": {"name": "b"}, "click": {"at": [1, 2]}}"#),
        ("a key twice", r#"{"delete": {"name": "b", "name": "c"}}"#),
        ("a misspelt key", r#"{"delete": {"nam": "b"}}"#),
        ("infinity where it means nothing", r#"{"click": {"at": ["inf", 2.0]}}"#),
        ("a negative mass", r#"{"spawn": {"at": [2.0, 5.0], "size": [1, 1], "mass": -1e3}}"#),
        ("nothing", "null"),
    ];
    let told: Vec<String> = lines
        .iter()
        .map(|(what, line)| match live::parse_line(17, line) {
            Ok(event) => panic!("this should be refused: {event:?}"),
            Err(error) => format!("# {what}\n{}", rendered(&error)),
        })
        .collect();
    assert_text("scene-errors-events", &told.join("\n"));
}

/// Pieces that mean something to one of the parsers or to the checks behind them.
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
    fn no_text_makes_reading_panic_or_an_error_point_outside(
        cut in 0..=GOOD.len(),
        skip in 0_usize..40,
        pieces in prop::collection::vec(prop::sample::select(&PIECES[..]), 0..6),
    ) {
        let text = format!("{}{}{}", &GOOD[..cut], pieces.join(" "), &GOOD[GOOD.len().min(cut + skip)..]);
        if let Err(error) = scene::parse("two.toml", &text) {
            rendered(&error);
        }
    }

    #[test]
    fn no_line_makes_reading_panic_or_an_error_point_outside(
        cut in 0..=EVENT.len(),
        skip in 0_usize..20,
        pieces in prop::collection::vec(prop::sample::select(&PIECES[..]), 0..6),
    ) {
        let line = format!("{}{}{}", &EVENT[..cut], pieces.join(""), &EVENT[EVENT.len().min(cut + skip)..]);
        if let Err(error) = live::parse_line(3, &line) {
            rendered(&error);
        }
    }
}

/// A line that is fine.
const EVENT: &str = r#"{"spawn": {"step": 30, "name": "b", "at": [2.0, 5.0], "size": [1.0, 1.0], "mass": "inf"}}"#;
