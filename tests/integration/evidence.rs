//! Pictures carry what they were drawn from, and are drawn again from it byte for byte.

use crate::command_line::SCENE;
use crate::rebond::Workplace;
use crate::snapshot::assert_text;
use rebond::illustration::{Evidence, Format, Source, again};
use std::path::Path;

/// Two recordings: one of each solver.
fn recorded() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write("exact.toml", &SCENE.replace("handout", "event-driven").replace("A small run", "Übung “zwei”"));
    workplace.done("record scene.toml -o run.mcap");
    workplace.done("record exact.toml -o exact.mcap");
    workplace
}

/// Draws with these words, and again from nothing but the file and the recordings.
#[track_caller]
fn assert_drawn_again(workplace: &Workplace, line: &str, name: &str) {
    workplace.done(&format!("{line} -o {name}"));
    let file = workplace.read(name);
    let open = |name: &str| Source::open(&workplace.path(name)).unwrap();
    let drawn = again(&file, &[open("exact.mcap"), open("run.mcap")]).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(drawn == file, "{name} comes out differently");
}

const KINDS: [&str; 6] = ["collision", "minkowski", "strobe", "spacetime", "energy", "filmstrip"];

#[test]
fn every_kind_of_figure_in_every_format_is_drawn_again_byte_for_byte() {
    let workplace = recorded();
    for kind in KINDS {
        for format in ["png", "svg", "pdf"] {
            let name = format!("{kind}.{format}");
            assert_drawn_again(&workplace, &format!("figure {kind} run.mcap --caption e=½ --theme dark"), &name);
        }
        let two = format!("figure {kind} run.mcap exact.mcap --title one --title two --color-by material");
        assert_drawn_again(&workplace, &two, &format!("{kind}-two.svg"));
    }
    assert_drawn_again(&workplace, "figure spacetime exact.mcap --axis y --from 10 --to 50 --every 5", "y.png");
    assert_drawn_again(&workplace, "figure strobe exact.mcap --window 0.5,0.25,4,2.25 --color-by speed", "window.png");
    assert_drawn_again(
        &workplace,
        "figure filmstrip exact.mcap --follow c --window 3x2 --show mass,axes",
        "follow.png",
    );
}

#[test]
fn frames_and_animations_are_drawn_again_byte_for_byte() {
    let workplace = recorded();
    let show = "--show velocity,force,normal,impulse,penetration,trail,name,mass,grid,axes,scale,clock";
    for (format, size) in [("png", "320x180"), ("svg", "320x180"), ("pdf", "320x180")] {
        assert_drawn_again(
            &workplace,
            &format!("render exact.mcap --at 33 {show} --size {size}"),
            &format!("still.{format}"),
        );
    }
    for format in ["gif", "apng"] {
        assert_drawn_again(&workplace, &format!("render run.mcap --to 40 {show}"), &format!("clip.{format}"));
        let slow = "render exact.mcap --from 5 --to 45 --slow 0.2 --hold 0.25 at collisions --follow c";
        assert_drawn_again(&workplace, slow, &format!("slow.{format}"));
    }
}

#[test]
fn a_picture_of_a_sequence_is_drawn_again_by_itself() {
    let workplace = recorded();
    workplace.done("render run.mcap -o frames --every 10 --show normal,trail,clock");
    let file = workplace.read("frames/000040.png");
    let drawn = again(&file, &[Source::open(&workplace.path("run.mcap")).unwrap()]).unwrap();
    assert!(drawn == file);
}

#[test]
fn info_prints_the_evidence_of_every_format() {
    let workplace = recorded();
    workplace.done("figure minkowski run.mcap exact.mcap -o figure.png");
    workplace.done("figure strobe exact.mcap -o figure.svg --caption <&>=1");
    workplace.done("figure collision run.mcap -o figure.pdf --caption ½(a+b)\\");
    workplace.done("render run.mcap -o clip.gif --to 10");
    workplace.done("render exact.mcap -o clip.apng --to 10 --slow 0.5");
    let names = ["figure.png", "figure.svg", "figure.pdf", "clip.gif", "clip.apng"];
    let told = |name: &&str| format!("{name}\n{}", workplace.done(&format!("info {name}")).output);
    let told = names.iter().map(told).collect::<Vec<String>>().join("\n");
    // Identities change with every version of the engine; that they are told is what matters here.
    let identity = |name: &str| Source::open(&workplace.path(name)).unwrap().survey.identity.unwrap();
    let named = told.replace(&identity("run.mcap"), "RUN").replace(&identity("exact.mcap"), "EXACT");
    assert_text("info-of-pictures", &named);
    let json: serde_json::Value = serde_json::from_str(&workplace.done("info figure.pdf --json").output).unwrap();
    assert_eq!((json["picture"].as_str(), json["steps"].as_str()), (Some("PDF"), Some("36")), "{json}");
}

#[test]
fn evidence_names_no_path_and_no_way_of_working() {
    let workplace = recorded();
    workplace.done("render run.mcap -o one.gif --jobs 1");
    workplace.done("render run.mcap -o three.gif --jobs 3");
    assert!(workplace.read("one.gif") == workplace.read("three.gif"));
    let told = workplace.done("info one.gif").output;
    assert!(!told.contains("run.mcap") && !told.contains("jobs") && !told.contains('/'), "{told}");
}

#[test]
fn what_cannot_be_drawn_again_says_why() {
    let workplace = recorded();
    workplace.done("figure strobe run.mcap -o figure.png");
    let file = workplace.read("figure.png");
    let other = Source::open(&workplace.path("exact.mcap")).unwrap();
    let error = again(&file, &[other]).unwrap_err().to_string();
    assert!(error.starts_with("the picture cannot be drawn again: recording "), "{error}");
    workplace.done("record scene.toml -o thin.mcap --every 10");
    let thin = Source::open(&workplace.path("thin.mcap")).unwrap();
    let error = again(&file, &[thin]).unwrap_err().to_string();
    assert!(error.contains("thinned more"), "{error}");
    for (content, reason) in [("hello", "neither PNG"), ("<svg xmlns=\"\"></svg>", "no \"rebond options\"")] {
        let error = Evidence::read(content.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
    workplace.write("foreign.svg", "<svg xmlns=\"\"></svg>");
    let outcome = workplace.rebond("info foreign.svg");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("foreign.svg: no picture that says"), "{outcome:?}");
}

/// Damaged pictures are refused, not believed and not a crash.
#[test]
fn damaged_pictures_do_no_harm() {
    let workplace = recorded();
    for name in ["figure.png", "figure.svg", "figure.pdf"] {
        workplace.done(&format!("figure strobe run.mcap -o {name}"));
        let file = workplace.read(name);
        for length in (0..file.len()).step_by(file.len() / 40 + 1) {
            let _ = Evidence::read(&file[..length]);
        }
        assert!(Evidence::read(&file).is_ok());
    }
    workplace.done("render run.mcap -o clip.gif --to 10");
    let file = workplace.read("clip.gif");
    for length in 0..400 {
        let _ = Evidence::read(&file[..length]);
    }
}

#[test]
fn formats_are_known_by_name_and_content() {
    assert_eq!(Format::of_name(Path::new("a.apng")), Some(Format::Apng));
    assert_eq!(Format::of_name(Path::new("a.tiff")), None);
    assert_eq!(Format::of_content(b"GIF89a"), Some(Format::Gif));
    assert_eq!(Format::of_content(b"MCAP"), None);
}
