//! Errors have a message of one sentence and the documented exit code, and change no file.

use crate::command_line::SCENE;
use crate::rebond::Workplace;
use crate::snapshot::assert_text;
use std::process::Stdio;

#[test]
fn an_error_is_one_sentence_on_standard_error() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    workplace.write("broken.toml", &SCENE.replace("mass = 2.0", "mass = -2.0"));
    workplace.write("not-a-recording.mcap", "hello");
    let lines = [
        "record missing.toml -o out.mcap",
        "record broken.toml -o out.mcap",
        "record scene.toml -o run.mcap",
        "record scene.toml -o no/such/folder/out.mcap",
        "record scene.toml -o out.mcap --events missing.jsonl",
        "replay missing.mcap",
        "replay not-a-recording.mcap",
        "info not-a-recording.mcap",
        "export run.mcap -o table.xlsx",
        "export run.mcap -o run.mcap",
        "render missing.toml -o out.gif",
        "render run.mcap -o out.png",
        "render run.mcap -o out.bmp",
        "render run.mcap -o out.png --at 91",
        "render run.mcap -o out.gif --from 80 --to 70",
        "render run.mcap -o scene.toml/frames",
    ];
    let mut messages = String::new();
    for line in lines {
        let before = workplace.names();
        let outcome = workplace.rebond(line);
        let is_usage = ["table.xlsx", "out.bmp", "-o out.png"].iter().any(|part| line.contains(part));
        let is_usage = is_usage && !line.contains("--at 91");
        assert_eq!(outcome.code, if is_usage { 2 } else { 1 }, "{line}: {outcome:?}");
        assert_eq!(outcome.output, "", "{line}: errors go to standard error");
        assert_eq!(workplace.names(), before, "{line}: no file is created or removed");
        messages += &format!("$ rebond {line}\n{}\n", outcome.errors);
    }
    assert_text("errors-of-commands", &messages);
}

#[test]
fn every_command_has_the_same_words_for_a_missing_recording() {
    let workplace = Workplace::new();
    let messages =
        ["replay x.mcap", "info x.mcap", "export x.mcap", "recover x.mcap -o y.mcap", "render x.mcap -o y.gif"];
    let mut messages = messages.map(|line| workplace.rebond(line).errors).to_vec();
    messages.dedup();
    assert!(matches!(&messages[..], [one] if one.contains("cannot read x.mcap: ")), "{messages:?}");
}

/// Only a line feed ends a line, so that the message shows the carriage returns in it.
#[test]
fn lines_that_end_in_carriage_returns_are_shown_as_one() {
    let workplace = Workplace::with_scene(&SCENE.replace('\n', "\r"));
    let refused = workplace.rebond("record scene.toml -o run.mcap");
    assert!(refused.code == 1 && refused.errors.contains(" 1 │ ") && !refused.errors.contains(" 0 │"), "{refused:?}");
}

/// The device refuses all data.
#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_written_is_an_error() {
    let workplace = Workplace::new();
    for line in ["--help", "--version", "help record", "record --help"] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let ended = workplace.start(line, Stdio::null(), full.into()).wait_with_output().unwrap();
        let errors = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.code() == Some(1) && errors.contains("standard output"), "{line}: {errors}");
    }
}

#[test]
fn wrong_usage_exits_with_2() {
    let workplace = Workplace::with_scene(SCENE);
    let lines = [
        "",
        "recrod scene.toml",
        "record scene.toml",
        "record scene.toml -o out.mcap --every 0",
        "render scene.toml -o out.gif --show speed",
        "render scene.toml -o out.gif --theme pink",
        "render scene.toml -o out.gif --size 1280",
        "render scene.toml -o out.gif --fps 0",
        "render scene.toml -o out.gif --fps 1001",
        "render scene.toml -o out.gif --at 3 --from 2",
        "render scene.toml -o out.png --at 3 --slow 0.5",
        "render scene.toml -o out.png --at 3 --hold 0.5 at collisions",
        "render scene.toml -o out.gif --size 16385x10",
        "render scene.toml -o out.gif --size 0x10",
        "render scene.toml -o out.gif --at 3",
        "render scene.toml -o out.GIF",
        "render scene.toml -o out.gif --title a --title b",
        "render scene.toml -o out.gif --from 1e300s",
        "figure energy scene.toml -o out.svg --pair a,b",
        "export scene.toml scene.toml --shard 1/2",
    ];
    for line in lines {
        let outcome = workplace.rebond(line);
        assert_eq!(outcome.code, 2, "{line}: {outcome:?}");
        assert!(!outcome.errors.is_empty());
    }
}

#[test]
fn a_limit_is_named_where_a_value_exceeds_it() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write("light.toml", &SCENE.replace("mass = 2.0", "mass = 5e-324"));
    for (line, expected) in [
        ("render scene.toml -o out.gif --size 0x10", "each from 1 to 16384 pixels"),
        ("render scene.toml -o out.GIF", "write the extension in lower case"),
        ("figure energy scene.toml -o out.SVG", "write the extension in lower case"),
        ("render scene.toml -o out.gif --from 1e300s", "a run has at most 18446744073 s"),
        ("record light.toml -o out.mcap", "a mass of 5.6e-309 kg or more"),
    ] {
        let refused = workplace.rebond(line);
        assert!(refused.code != 0 && refused.errors.contains(expected), "{line}: {refused:?}");
    }
}

#[test]
fn a_negative_number_is_refused_with_what_is_expected() {
    let workplace = Workplace::with_scene(SCENE);
    for (line, expected) in [
        ("render scene.toml -o out.png --at -1", "expected a step such as 90"),
        ("render scene.toml -o out.gif --from -1.5s", "expected a step such as 90"),
        ("render scene.toml -o out.gif --fps -1", "expected a positive number"),
        ("render scene.toml -o out.gif --slow -2", "expected a number from"),
        ("render scene.toml -o out.gif --hold -1 at collisions", "expected 0.05 to 60 seconds"),
        ("render scene.toml -o out.gif --hold 0.5 at start", "expected seconds, or seconds at collisions"),
        ("report --read a.json --shard 1/2", "cannot be used with"),
        ("report scene.toml --only zeno", "cannot be used with"),
        ("figure collision scene.toml -o out.svg --step -1", "expected a step such as 90"),
        ("export scene.toml --to -1", "expected a step such as 90"),
        ("record scene.toml -o out.mcap --every -1", "invalid value '-1' for '--every <N>'"),
    ] {
        let refused = workplace.rebond(line);
        let is_clear = refused.errors.contains(expected) && !refused.errors.contains("tip:");
        assert!(refused.code == 2 && is_clear, "{line}: {refused:?}");
    }
}

#[test]
#[cfg(unix)]
fn an_unusable_folder_is_named_with_the_setting_that_selects_it() {
    let workplace = Workplace::with_scene(SCENE);
    for command in ["export", "check"] {
        let refused = workplace.run(
            assert_cmd::Command::new(env!("CARGO_BIN_EXE_rebond"))
                .args([command, "scene.toml"])
                .current_dir(workplace.path("."))
                .env("TMPDIR", "/nonexistent"),
        );
        let is_named = refused.errors.contains("cannot write temporary files to /nonexistent: ")
            && refused.errors.contains("; set TMPDIR to a writable folder");
        assert!(refused.code == 1 && is_named, "{command}: {refused:?}");
    }
    let page = workplace.rebond("check . --report scene.toml/page");
    let is_named = page.errors.contains("cannot write the page of differences to scene.toml/page: ")
        && page.errors.contains("; choose another folder with --report");
    assert!(page.code == 1 && is_named, "{page:?}");
}

#[test]
fn nothing_is_overwritten_without_force() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    for (line, kept) in [
        ("record scene.toml --steps 10 -o kept.mcap", "kept.mcap"),
        ("render run.mcap -o kept.gif", "kept.gif"),
        ("render run.mcap -o kept.png --at 7", "kept.png"),
        ("export run.mcap -o kept.csv", "kept.csv"),
    ] {
        workplace.write(kept, "precious");
        let outcome = workplace.rebond(line);
        assert_eq!(outcome.code, 1, "{line}");
        assert_eq!(workplace.read(kept), b"precious", "{line}");
        workplace.done(&format!("{line} --force"));
        assert_ne!(workplace.read(kept), b"precious", "{line}");
    }
    workplace.done("render run.mcap -o frames --every 45");
    let first = workplace.read("frames/000045.png");
    assert_eq!(workplace.rebond("render run.mcap -o frames --every 45 --theme dark").code, 1);
    assert!(first == workplace.read("frames/000045.png"));
    workplace.done("render run.mcap -o frames --every 45 --theme dark --force");
    assert!(first != workplace.read("frames/000045.png"));
}

/// A step of the handout solver fails only by overflow.
#[test]
fn an_error_inside_a_step_names_step_and_body_and_leaves_a_recording() {
    let scene = "[world]\nsize = [16.0, 9.0]\n[run]\nrate = 1\nsteps = 50\nsolver = \"handout\"\n\
                 [[spawn]]\nname = \"rocket\"\nat = [0.0, 0.0]\nsize = [1.0, 1.0]\nmass = 1e-300\nforce = [1e7, 0.0]\n";
    let workplace = Workplace::with_scene(scene);
    let outcome = workplace.rebond("record scene.toml -o run.mcap");
    assert_eq!(outcome.code, 1, "{outcome:?}");
    assert_text("error-inside-a-step", &outcome.errors);
    let replayed = workplace.done("replay run.mcap");
    assert_text("replay-of-an-error", &replayed.output);
    workplace.done("export run.mcap");
    workplace.done("info run.mcap");
}

#[test]
fn an_error_in_the_first_step_leaves_only_the_step_0() {
    let scene = "[run]\nsteps = 5\nsolver = \"handout\"\n[[spawn]]\nname = \"rocket\"\nat = [1.0, 1.0]\n\
                 size = [1.0, 1.0]\nmass = 1.0\nvelocity = [1e308, 0.0]\nforce = [1e308, 0.0]\n";
    let workplace = Workplace::with_scene(&scene.replace("steps = 5", "steps = 5\nrate = 0.01"));
    let failed = workplace.rebond("record scene.toml -o run.mcap");
    assert!(failed.code == 1 && failed.errors.contains("; run.mcap has only the step 0"), "{failed:?}");
    let table = workplace.rebond("export scene.toml");
    assert!(table.errors.contains("; using only the step 0") && table.output.contains("\n0,"), "{table:?}");
    let beyond = workplace.rebond("export run.mcap --from 9");
    assert!(beyond.code != 0 && !beyond.errors.contains("0 to 0"), "{beyond:?}");
}

#[test]
fn an_error_in_the_events_names_the_steps_that_are_recorded() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write("events.jsonl", "{\"delete\": {\"step\": 1500, \"name\": \"nobody\"}}\n");
    let failed = workplace.rebond("record scene.toml -o run.mcap --steps 2000 --events events.jsonl");
    assert_eq!(failed.code, 1, "{failed:?}");
    assert!(failed.errors.contains("; run.mcap is unfinished and has the steps 0 to 1"), "{failed:?}");
}

#[test]
fn the_verdict_of_a_truncated_recording_counts_the_steps_that_are_the_same() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    let bytes = workplace.read("run.mcap");
    std::fs::write(workplace.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).unwrap();
    let outcome = workplace.rebond("replay cut.mcap");
    assert_eq!(outcome.code, 4, "{outcome:?}");
    let verdict = outcome.output.lines().last().unwrap();
    assert!(verdict.starts_with("incomplete: "), "{verdict}");
    assert!(verdict.ends_with(" steps same"), "{verdict}");
}

/// Every command names the output that it could not write, and suggests what to do.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_with_the_output_path() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    for line in ["export run.mcap", "info run.mcap", "render run.mcap -o -", "figure strobe run.mcap -o -"] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full exists on Linux");
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_rebond"))
            .args(line.split_whitespace())
            .current_dir(workplace.path("."))
            .env("NO_COLOR", "1")
            .stdout(full)
            .output()
            .expect("the program runs");
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{line}: {errors}");
        assert!(errors.contains("cannot write to standard output: No space left"), "{line}: {errors}");
        assert!(errors.contains("help: ") && !errors.contains("-o"), "{line}: {errors}");
    }
    let outcome = workplace.rebond("record scene.toml -o /dev/full --force");
    assert!(outcome.errors.contains("cannot write /dev/full: No space left"), "{outcome:?}");
}
