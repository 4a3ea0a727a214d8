//! Pictures carry their provenance, from which they are drawn again byte for byte.

use crate::command_line::SCENE;
use crate::rebond::Workplace;
use crate::snapshot::assert_text;
use rebond::internals::picture::{AnimationFormat, Format, Provenance, Source, redraw};
use std::path::Path;

/// A workplace with two recordings, one per solver.
fn workplace_with_recordings() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write("exact.toml", &SCENE.replace("handout", "event-driven").replace("A small run", "Übung “zwei”"));
    workplace.done("record scene.toml -o run.mcap");
    workplace.done("record exact.toml -o exact.mcap");
    workplace
}

/// Draws a picture with a command line, and again from only its file and the recordings.
#[track_caller]
fn assert_redraws(workplace: &Workplace, line: &str, name: &str) {
    workplace.done(&format!("{line} -o {name}"));
    let file = workplace.read(name);
    let open = |name: &str| Source::open(&workplace.path(name)).unwrap();
    let redrawn =
        redraw(&file, &[open("exact.mcap"), open("run.mcap")]).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(redrawn == file, "{name} is drawn differently");
}

const KINDS: [&str; 10] = [
    "collision",
    "minkowski",
    "strobe",
    "spacetime",
    "energy",
    "filmstrip",
    "lines",
    "pressure",
    "speeds",
    "velocity-space",
];

#[test]
fn every_kind_of_figure_in_every_format_redraws_byte_for_byte() {
    let workplace = workplace_with_recordings();
    for kind in KINDS {
        for format in ["png", "svg", "pdf"] {
            let name = format!("{kind}.{format}");
            assert_redraws(&workplace, &format!("figure {kind} run.mcap --caption e=½ --theme dark"), &name);
        }
        let two = format!("figure {kind} run.mcap exact.mcap --title one --title two --color-by material");
        assert_redraws(&workplace, &two, &format!("{kind}-two.svg"));
    }
    assert_redraws(&workplace, "figure spacetime exact.mcap --axis y --from 10 --to 50 --every 5", "y.png");
    assert_redraws(&workplace, "figure strobe exact.mcap --window 0.5,0.25,4,2.25 --color-by speed", "window.png");
    assert_redraws(&workplace, "figure filmstrip exact.mcap --follow c --window 3x2 --show mass,axes", "follow.png");
    assert_redraws(
        &workplace,
        "figure lines run.mcap exact.mcap --quantity E --bodies c --language fr",
        "energies.svg",
    );
    assert_redraws(&workplace, "figure collision run.mcap exact.mcap --frame com", "center.png");
    assert_redraws(&workplace, "figure pressure exact.mcap --bodies c --from 5", "pressure-c.png");
    assert_redraws(&workplace, "figure velocity-space exact.mcap --bodies c --axis y --from 5", "velocities.png");
}

#[test]
fn still_pictures_and_animations_redraw_byte_for_byte() {
    let workplace = workplace_with_recordings();
    let show = "--show velocity,momentum,force,normal,impulse,penetration,com,trail,name,mass,grid,axes,scale,clock";
    for (format, size) in [("png", "320x180"), ("svg", "320x180"), ("pdf", "320x180")] {
        assert_redraws(
            &workplace,
            &format!("render exact.mcap --at 33 {show} --size {size}"),
            &format!("still.{format}"),
        );
    }
    for format in ["gif", "apng"] {
        assert_redraws(&workplace, &format!("render run.mcap --to 40 {show}"), &format!("clip.{format}"));
        let slow = "render exact.mcap --from 5 --to 45 --slow 0.2 --hold 0.25 at collisions --follow c";
        assert_redraws(&workplace, slow, &format!("slow.{format}"));
    }
}

/// The scales of colours and arrows follow from the states that a recording stores, so a picture is drawn again from
/// the recording that stores the same ones. Only without it, another one that stores the states of the picture is used.
#[test]
fn pictures_of_thinned_recordings_redraw_byte_for_byte_among_other_recordings_of_the_run() {
    let workplace = Workplace::with_scene(SCENE);
    for (name, every) in [("a2", 2), ("b1", 1), ("c10", 10), ("d15", 15), ("e1000", 1000)] {
        workplace.done(&format!("record scene.toml -o {name}.mcap --every {every}"));
    }
    let names = ["b1", "a2", "c10", "d15", "e1000"];
    let open = |name: &str| Source::open(&workplace.path(&format!("{name}.mcap"))).unwrap();
    let all = names.map(open);
    for name in names {
        workplace.done(&format!("render {name}.mcap --at 0 -o {name}.png --show velocity --color-by speed"));
        workplace.done(&format!("figure spacetime {name}.mcap -o {name}.svg --color-by speed"));
        for file in [format!("{name}.png"), format!("{name}.svg")] {
            let drawn = workplace.read(&file);
            assert!(redraw(&drawn, &all).unwrap() == drawn, "{file} is drawn differently");
        }
    }
    workplace.done("figure energy c10.mcap b1.mcap d15.mcap -o mixed.svg");
    let mixed = workplace.read("mixed.svg");
    assert!(String::from_utf8_lossy(&mixed).contains("recorded_every=10,1,15"));
    assert!(redraw(&mixed, &all).unwrap() == mixed);
    assert!(workplace.done("check .").output.contains("same: 5 recordings, 11 pictures"));
    workplace.done("render d15.mcap --at 30 -o at30.png");
    let at_30 = workplace.read("at30.png");
    assert!(redraw(&at_30, &all[..1]).unwrap().starts_with(b"\x89PNG"));
    let error = redraw(&at_30, &all[1..3]).unwrap_err().to_string();
    assert!(
        error.contains("every 2 steps and lacks states of the picture, which was drawn from one every 15 steps"),
        "{error}"
    );
    for name in ["b1", "d15"] {
        std::fs::remove_file(workplace.path(&format!("{name}.mcap"))).unwrap();
    }
    let orphaned = workplace.rebond("check .").output;
    let line = orphaned.lines().find(|line| line.contains("at30.png")).unwrap_or_default();
    assert!(line.contains("a2.mcap") && line.contains("has a full state every 2 steps"), "{orphaned}");
}

/// Two files with the same text, which states no title, have recordings of the same identity.
#[test]
fn titles_that_are_names_of_files_are_part_of_the_provenance() {
    let untitled = SCENE.replace("title = \"A small run\"\n", "");
    let workplace = Workplace::with_scene(&untitled);
    std::fs::remove_file(workplace.path("scene.toml")).unwrap();
    let names = ["alpha", "beta"];
    for name in names {
        workplace.write(&format!("{name}.toml"), &untitled);
        workplace.done(&format!("record {name}.toml -o {name}.mcap"));
    }
    let open = |name: &str| Source::open(&workplace.path(&format!("{name}.mcap"))).unwrap();
    for (command, file) in [
        ("figure energy", "energy.svg"),
        ("figure lines", "lines.pdf"),
        ("figure collision", "collision.svg"),
        ("render --at 20", "state.png"),
        ("render --to 10", "clip.gif"),
    ] {
        workplace.done(&format!("{command} alpha.mcap beta.mcap -o {file}"));
        let drawn = workplace.read(file);
        for sources in [names, ["beta", "alpha"]] {
            assert!(redraw(&drawn, &sources.map(open)).unwrap() == drawn, "{file} from {sources:?}");
        }
        let provenance = workplace.done(&format!("info {file}")).output;
        assert!(names.iter().all(|name| provenance.contains(name)), "{provenance}");
    }
    assert!(workplace.done("check .").output.contains("5 pictures"));
}

#[test]
fn a_picture_of_a_sequence_redraws_on_its_own() {
    let workplace = workplace_with_recordings();
    workplace.done("render run.mcap -o frames --every 10 --show normal,trail,clock");
    let file = workplace.read("frames/000040.png");
    let redrawn = redraw(&file, &[Source::open(&workplace.path("run.mcap")).unwrap()]).unwrap();
    assert!(redrawn == file);
}

#[test]
fn info_prints_the_provenance_of_every_format() {
    let workplace = workplace_with_recordings();
    workplace.done("figure minkowski run.mcap exact.mcap -o figure.png");
    workplace.done("figure strobe exact.mcap -o figure.svg --caption <&>=1");
    workplace.done("figure collision run.mcap -o figure.pdf --caption ½(a+b)\\");
    workplace.done("render run.mcap -o clip.gif --to 10");
    workplace.done("render exact.mcap -o clip.apng --to 10 --slow 0.5");
    let names = ["figure.png", "figure.svg", "figure.pdf", "clip.gif", "clip.apng"];
    let info = |name: &&str| format!("{name}\n{}", workplace.done(&format!("info {name}")).output);
    let printed = names.iter().map(info).collect::<Vec<String>>().join("\n");
    // Identities change with every version of the engine, so the snapshot does not contain them.
    let identity = |name: &str| Source::open(&workplace.path(name)).unwrap().statistics.identity.unwrap();
    let named = printed.replace(&identity("run.mcap"), "RUN").replace(&identity("exact.mcap"), "EXACT");
    assert_text("info-of-pictures", &named);
    let json: serde_json::Value = serde_json::from_str(&workplace.done("info figure.pdf --json").output).unwrap();
    assert_eq!((json["picture"].as_str(), json["steps"].as_str()), (Some("PDF"), Some("36")), "{json}");
}

#[test]
fn provenance_contains_no_path_and_no_number_of_jobs() {
    let workplace = workplace_with_recordings();
    workplace.done("render run.mcap -o one.gif --jobs 1");
    workplace.done("render run.mcap -o three.gif --jobs 3");
    assert!(workplace.read("one.gif") == workplace.read("three.gif"));
    let printed = workplace.done("info one.gif").output;
    assert!(!printed.contains("run.mcap") && !printed.contains("jobs") && !printed.contains('/'), "{printed}");
}

#[test]
fn the_error_of_a_picture_that_cannot_be_redrawn_gives_the_reason() {
    let workplace = workplace_with_recordings();
    workplace.done("figure strobe run.mcap -o figure.png");
    let file = workplace.read("figure.png");
    let other = Source::open(&workplace.path("exact.mcap")).unwrap();
    let error = redraw(&file, &[other]).unwrap_err().to_string();
    assert!(error.starts_with("the picture cannot be drawn again: recording "), "{error}");
    workplace.done("record scene.toml -o thin.mcap --every 10");
    let thin = Source::open(&workplace.path("thin.mcap")).unwrap();
    let error = redraw(&file, &[thin]).unwrap_err().to_string();
    assert!(
        error.contains("every 10 steps and lacks states of the picture, which was drawn from one every 1 step"),
        "{error}"
    );
    for (content, reason) in [("hello", "neither PNG"), ("<svg xmlns=\"\"></svg>", "no \"rebond options\"")] {
        let error = Provenance::read(content.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
    workplace.write("foreign.svg", "<svg xmlns=\"\"></svg>");
    workplace.write("empty.png", "");
    for name in ["foreign.svg", "empty.png"] {
        let outcome = workplace.rebond(&format!("info {name}"));
        assert_eq!(outcome.code, 1);
        assert!(outcome.errors.contains(&format!("{name}: the file carries no rebond provenance")), "{outcome:?}");
    }
}

/// Replaces text of the same chunk of a PNG file, with a right checksum.
fn with_text(file: &[u8], old: &str, new: &str) -> Vec<u8> {
    let mut altered = file[..8].to_vec();
    let mut rest = &file[8..];
    while !rest.is_empty() {
        let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        let (chunk, after) = rest.split_at(12 + length);
        let mut body = chunk[4..8 + length].to_vec();
        if let Some(text) = std::str::from_utf8(&body).ok().filter(|_| chunk[4..8] == *b"iTXt") {
            body = text.replace(old, new).into_bytes();
        }
        altered.extend((body.len() as u32 - 4).to_be_bytes());
        altered.extend(&body);
        altered.extend(crc32fast::hash(&body).to_be_bytes());
        rest = after;
    }
    altered
}

#[test]
fn absurd_provenance_is_reported_and_the_other_files_are_still_read() {
    let workplace = workplace_with_recordings();
    workplace.done("record scene.toml -o thin.mcap --every 5 --set title=thin");
    workplace.done("render thin.mcap --at 30 -o good.png --size 640x360");
    let good = workplace.read("good.png");
    let cases = [
        ("size=640x360", "size=0x0", 1),
        ("size=640x360", "size=100000x100000", 0),
        ("recorded_every=5", "recorded_every=abc", 1),
        ("recorded_every=5", "recorded_every=0", 1),
        ("recorded_every=5", "recorded_every=99999999999999999999999", 1),
        ("theme=light", "theme=pink", 1),
        ("theme=light", "theme", 1),
    ];
    for (old, new, code) in cases {
        std::fs::write(workplace.path("evil.png"), with_text(&good, old, new)).unwrap();
        assert_ne!(workplace.read("evil.png"), good, "{new}");
        let info = workplace.rebond("info evil.png good.png thin.mcap");
        assert_eq!(info.code, code, "{new}: {info:?}");
        assert!(
            info.output.contains("file: good.png\n") && info.output.contains("file: thin.mcap\n"),
            "{new}: {info:?}"
        );
        assert_eq!(
            info.errors.contains("evil.png: the rebond provenance of the file is damaged"),
            code == 1,
            "{info:?}"
        );
        let json = workplace.rebond("info evil.png good.png thin.mcap --json").output;
        let mut names =
            json.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()["file"].clone());
        assert_eq!(names.next_back().unwrap(), "thin.mcap", "{json}");
        let check = workplace.rebond("check evil.png good.png thin.mcap");
        assert!(check.code == 1 || check.code == 3, "{new}: {check:?}");
        assert!(check.output.contains("evil.png: ") && check.output.contains("good.png: same"), "{new}: {check:?}");
    }
}

#[test]
fn reading_damaged_pictures_does_not_panic() {
    let workplace = workplace_with_recordings();
    for name in ["figure.png", "figure.svg", "figure.pdf"] {
        workplace.done(&format!("figure strobe run.mcap -o {name}"));
        let file = workplace.read(name);
        for length in (0..file.len()).step_by(file.len() / 40 + 1) {
            let _ = Provenance::read(&file[..length]);
        }
        assert!(Provenance::read(&file).is_ok());
    }
    workplace.done("render run.mcap -o clip.gif --to 10");
    let file = workplace.read("clip.gif");
    for length in 0..400 {
        let _ = Provenance::read(&file[..length]);
    }
}

#[test]
fn formats_are_detected_by_extension_and_content() {
    assert_eq!(Format::from_path(Path::new("a.apng")), Some(Format::Animation(AnimationFormat::Apng)));
    assert_eq!(Format::from_path(Path::new("a.tiff")), None);
    assert_eq!(Format::from_content(b"GIF89a"), Some(Format::Animation(AnimationFormat::Gif)));
    assert_eq!(Format::from_content(b"MCAP"), None);
}

#[test]
fn provenance_is_bounded_like_options() {
    let workplace = workplace_with_recordings();
    workplace.done("render run.mcap --at 30 -o good.png");
    workplace.done("render run.mcap --to 10 -o good.apng");
    let identity = Source::open(&workplace.path("run.mcap")).unwrap().statistics.identity.unwrap();
    let option = |key: &str, value: &str| format!("color_by=body {key}=\"{value}\"");
    let names = (0..1001).map(|number| format!("b{number}")).collect::<Vec<String>>().join(",");
    let cases = [
        ("good.png", "color_by=body", option("caption", &"w".repeat(4097)), "the caption has 4097 bytes; at most 4096"),
        ("good.png", "color_by=body", option("title", &"t ".repeat(2049)), "a title has 4098 bytes; at most 4096"),
        ("good.png", "color_by=body", option("bodies", &names), "\"rebond options\" entry cannot be parsed"),
        ("good.png", identity.as_str(), [identity.as_str(); 10_001].join("; "), "a picture of 10001 recordings"),
        ("good.png", identity.as_str(), "x".repeat(100_000), "\"rebond recording\" entry cannot be parsed"),
        ("good.png", identity.as_str(), "../run.mcap".into(), "\"rebond recording\" entry cannot be parsed"),
        ("good.png", "rebond 0", "x".repeat(100_000), "\"Software\" entry cannot be parsed"),
        ("good.apng", "0 to 10 every 2", "0 to 9007199254740992 every 1".into(), "the animation ends with step 900"),
        ("good.apng", "color_by=body", "color_by=body parts=1000000".into(), "an animation of 10000001 frames"),
    ];
    for (name, old, new, reason) in cases {
        let file = workplace.read(name);
        std::fs::write(workplace.path("evil.png"), with_text(&file, old, &new)).unwrap();
        assert_ne!(workplace.read("evil.png"), file, "{reason}");
        let check = workplace.rebond("check evil.png run.mcap");
        assert!(check.code == 1 && check.output.contains(reason), "{reason}: {check:?}");
        assert!(check.output.len() < 1000, "{reason}: {check:?}");
    }
    let caption = "w".repeat(4097);
    let drawn = workplace.rebond(&format!("render run.mcap --at 30 -o new.png --caption {caption}"));
    assert!(drawn.code == 1 && drawn.errors.contains("the caption has 4097 bytes; at most 4096"), "{drawn:?}");
    // No character fits into a line.
    let narrow = workplace.rebond("render run.mcap --at 30 -o new.png --size 1x16384 --caption abc");
    assert!(narrow.code == 1 && narrow.errors.contains("too small"), "{narrow:?}");
    assert!(!workplace.path("new.png").exists());
}

#[test]
fn the_description_of_a_french_picture_is_french() {
    let workplace = Workplace::with_scene("[run]\nsteps = 20\n[world]\nwalls = true\n");
    for (steps, expected) in [("--every 1", "Pas 0 à 20"), ("--every 2", "Pas 0 à 20 tous les 2")] {
        let command = format!("figure strobe scene.toml {steps} --language fr --force -o figure.svg");
        workplace.done(&command);
        let picture = String::from_utf8(workplace.read("figure.svg")).unwrap();
        let found = picture.split("</desc>").next().unwrap().rsplit('>').next().unwrap();
        assert_eq!(found, expected, "{steps}");
    }
}
