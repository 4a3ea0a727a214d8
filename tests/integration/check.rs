//! `rebond check` on a folder with a scene, a recording and pictures, for each way in which one of them can change.

use crate::command_line::SCENE;
use crate::rebond::{Outcome, Workplace};
use rebond::internals::physics::{CollisionCount, Engine, Vector};
use rebond::internals::picture::png;
use rebond::internals::recording::{Header, RunEnd, SceneText, Writer};
use rebond::internals::{replay, scene};
use std::fs::{self, File};
use std::io::Cursor;

/// A folder with a scene, its recording, pictures that a manifest lists, and one that is checked by its own provenance.
/// Everything in it is accepted.
pub fn lecture_folder() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o scene.mcap");
    workplace.write(
        "lecture.check",
        "# Pictures for the slides.\n\
         rebond render scene.mcap -o fall.png --at 20 --show velocity,name\n\
         rebond render scene.mcap -o fall.gif --to 20 --show 'trail,clock'\n\
         rebond figure collision scene.mcap -o hit.svg \\\n  --caption 'e = ½'\n",
    );
    workplace.done("render scene.mcap -o alone.png --at 40");
    let outcome = workplace.done("check . --update");
    assert!(
        outcome.output.contains("hit.svg: missing")
            && outcome.output.ends_with("accepted: 3 of 5 changed; see rebond-check/index.html\n"),
        "{outcome:?}"
    );
    workplace
}

/// Runs a check, asserts its exit code, and returns the line about a file.
#[track_caller]
fn line_about(workplace: &Workplace, code: i32, name: &str) -> String {
    let outcome = workplace.rebond("check .");
    assert_eq!(outcome.code, code, "{outcome:?}");
    line(&outcome, name)
}

#[track_caller]
fn line(outcome: &Outcome, name: &str) -> String {
    let found = outcome.output.lines().find_map(|line| line.strip_prefix(&format!("{name}: ")));
    found.unwrap_or_else(|| panic!("{name} in {outcome:?}")).to_owned()
}

/// Accepts all changes. Afterwards everything is the same and the page is removed.
#[track_caller]
fn accept_changes(workplace: &Workplace) {
    let outcome = workplace.rebond("check . --update");
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(outcome.output.contains("; accepted\n"), "{outcome:?}");
    assert_eq!(workplace.done("check .").output.lines().last(), Some("same: 1 recording, 4 pictures"));
    assert!(!workplace.path("rebond-check").exists());
}

#[test]
fn an_unchanged_folder_is_the_same() {
    let workplace = lecture_folder();
    let outcome = workplace.done("check .");
    let expected = "scene.mcap: same: 90 steps, 7 bodies; matches its scene\nalone.png: same\nfall.gif: same\n\
                    fall.png: same\nhit.svg: same\nsame: 1 recording, 4 pictures\n";
    assert_eq!((outcome.output.as_str(), outcome.errors.as_str()), (expected, ""));
    assert_eq!(workplace.done("check . --quiet").output, "same: 1 recording, 4 pictures\n");
    assert_eq!(
        workplace.done("check scene.mcap fall.png").output.lines().count(),
        3,
        "files can be given instead of folders"
    );
}

#[test]
fn threads_and_shards_do_not_change_the_output() {
    let workplace = lecture_folder();
    workplace.write("fall.png", "not a picture");
    let whole = workplace.rebond("check . --json --jobs 1");
    assert_eq!(whole.output, workplace.rebond("check . --json --jobs 3").output);
    assert_eq!(whole.output.lines().count(), 5);
    for of in [2, 3, 9] {
        let parts: String =
            (1..=of).map(|part| workplace.rebond(&format!("check . --json --shard {part}/{of}")).output).collect();
        // Each part has a page of its own, and numbers the pictures on it.
        let pages = |text: &str| {
            let without_shards = (1..=of).fold(text.to_owned(), |text, part| {
                text.replace(&format!("rebond-check-{part}-of-{of}/"), "rebond-check/")
            });
            without_shards.replace("/002-", "/001-")
        };
        assert_eq!(pages(&parts), pages(&whole.output));
        let page_count = workplace.names().iter().filter(|name| name.ends_with(&format!("-of-{of}"))).count();
        assert_eq!(page_count, 1, "one part has a difference, and its page is kept");
    }
    assert_eq!(workplace.rebond("check . --shard 3/2").code, 2);
}

#[test]
fn the_change_of_an_edited_scene_is_described() {
    let workplace = lecture_folder();
    workplace.write("scene.toml", &SCENE.replace("mass = 2.0", "mass = 3.0"));
    let line = line_about(&workplace, 3, "scene.mcap");
    let expected = "drifted: it replays the same, but its scene now gives a different run: at step 0 \
                    recorded spawn \"c\" with mass 2.0, now spawn \"c\" with mass 3.0; \
                    line 18 of the scene: \"mass = 2.0\" → \"mass = 3.0\"";
    assert_eq!(line, expected);
    accept_changes(&workplace);
    workplace.write("scene.toml", &SCENE.replace("mass = 2.0", "mass = 3.0 # heavier"));
    assert!(
        line_about(&workplace, 3, "scene.mcap")
            .contains("the text of its scene has changed, without effect on the run")
    );
    accept_changes(&workplace);
    workplace.write("scene.toml", &SCENE.replace("rate = 60", "rate = 50"));
    assert!(line_about(&workplace, 3, "scene.mcap").contains("gives a different run: rate: 60 → 50; line "));
    let later = SCENE.replace("mass = 2.0", "mass = 3.0 # heavier").replace("step = 60\nname", "step = 61\nname");
    workplace.write("scene.toml", &later);
    assert!(
        line_about(&workplace, 3, "scene.mcap").contains("at step 60 recorded delete body 6, now no further event")
    );
    workplace.write("scene.toml", "not a scene");
    assert!(line_about(&workplace, 1, "scene.mcap").starts_with("failed: its scene scene.toml cannot be run: "));
}

/// Records the scene with an engine whose gravity differs by one bit.
pub fn record_with_modified_engine(workplace: &Workplace) {
    let scene = scene::load(&workplace.path("scene.toml")).unwrap();
    let config = replay::engine_config(&scene);
    let text = SceneText { file_name: "scene.toml".into(), text: scene.source.text.clone() };
    let header = Header::new(config.clone(), 90, text);
    let gravity = config.gravity.map(|gravity| Vector::new(gravity.x, gravity.y.next_up()));
    let mut engine = Engine::new(config.with_gravity(gravity));
    let mut run = replay::Run::new(&scene);
    let mut writer = Writer::new(File::create(workplace.path("scene.mcap")).unwrap(), &header).unwrap();
    for step in 0..=90 {
        for event in run.apply_inputs(Vec::new(), |error| Err(error.into())).unwrap() {
            engine.apply(&event.change.event());
            writer.write_event(&event).unwrap();
        }
        writer.write_state(&engine).unwrap();
        if step < 90 {
            run.step(&mut CollisionCount::default()).unwrap();
            engine.step(&mut CollisionCount::default()).unwrap();
        }
    }
    writer.finish(RunEnd::default()).unwrap();
}

#[test]
fn a_divergence_is_reported_with_step_body_field_and_ulps() {
    let workplace = lecture_folder();
    record_with_modified_engine(&workplace);
    let outcome = workplace.rebond("check . --json");
    assert_eq!(outcome.code, 3, "{outcome:?}");
    let found: serde_json::Value = serde_json::from_str(outcome.output.lines().next().unwrap()).unwrap();
    assert_eq!(found["outcome"], "diverged");
    let divergence = &found["divergence"];
    assert_eq!(
        (divergence["step"].as_u64(), divergence["body"].as_str(), divergence["field"].as_str()),
        (Some(1), Some("c"), Some("vy"))
    );
    assert!(divergence["ulps"].as_u64() > Some(0), "{divergence}");
    let line = line_about(&workplace, 3, "scene.mcap");
    assert!(line.starts_with("diverged at step 1: body \"c\" vy recorded ") && line.contains(" ulp"), "{line}");
    let figure = line_about(&workplace, 3, "hit.svg");
    assert!(figure.starts_with("undrawn: scene.mcap: diverged at step 1"), "{figure}");
}

#[test]
fn a_difference_of_one_pixel_is_found_shown_and_accepted() {
    let workplace = lecture_folder();
    let good = workplace.read("fall.png");
    let (mut picture, metadata) = png::decode(Cursor::new(&good)).unwrap();
    picture.pixels[100 * 320 + 7][0] ^= 1;
    let mut file = Vec::new();
    png::encode(&picture, &metadata, png::PngEffort::Small, &mut file).unwrap();
    fs::write(workplace.path("fall.png"), &file).unwrap();
    let summary = workplace.rebond("check .").output;
    let expected = "not the same: 1 of 5; see rebond-check/index.html, and accept intended changes with --update\n";
    assert!(summary.ends_with(expected), "{summary}");
    let line = line_about(&workplace, 3, "fall.png");
    assert_eq!(line, "differs: 1 pixel differs, at (7, 100)");
    let page = String::from_utf8(workplace.read("rebond-check/index.html")).unwrap();
    assert!(page.contains("<h2>fall.png <b>differs</b></h2>") && page.contains("src=\"001-fall-png.png\""), "{page}");
    for part in page.split("src=\"").skip(1).chain(page.split("href=\"").skip(1)) {
        let name = part.split('"').next().unwrap();
        if let Some(id) = name.strip_prefix('#') {
            assert!(page.contains(&format!("<section id=\"{id}\">")), "{name} is not on the page");
            continue;
        }
        assert!(workplace.path("rebond-check").join(name).is_file(), "{name} is not next to the page");
    }
    assert!(!page.contains("http") && page.contains("color-scheme: light dark"), "{page}");
    let shown = png::decode(Cursor::new(workplace.read("rebond-check/001-fall-png.png"))).unwrap().0;
    assert_eq!(shown.size, [3 * 320 + 16, 180], "expected, difference and actual side by side");
    accept_changes(&workplace);
    assert!(workplace.read("fall.png") == good);
}

/// Only pixels are compared, not the compressed bytes.
#[test]
fn a_picture_compressed_by_another_program_is_the_same() {
    let workplace = lecture_folder();
    let (picture, _) = png::decode(Cursor::new(workplace.read("fall.png"))).unwrap();
    let mut encoder = ::png::Encoder::new(File::create(workplace.path("fall.png")).unwrap(), 320, 180);
    encoder.set_color(::png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(picture.pixels.as_flattened()).unwrap();
    writer.finish().unwrap();
    assert_eq!(line_about(&workplace, 0, "fall.png"), "same");
}

#[test]
fn animations_are_compared_frame_by_frame() {
    let workplace = lecture_folder();
    let good = workplace.read("fall.gif");
    workplace.done("render scene.mcap -o fall.gif --force --to 20 --show trail,clock --slow 0.5");
    let line = line_about(&workplace, 3, "fall.gif");
    assert!(line.starts_with("differs: ") && line.contains("frame"), "{line}");
    workplace.done("render scene.mcap -o fall.gif --force --to 20 --show trail");
    let line = line_about(&workplace, 3, "fall.gif");
    assert!(line.starts_with("differs: show: trail → trail,clock; frame 1 of 11: "), "{line}");
    assert!(workplace.names().contains(&"rebond-check".to_owned()));
    let delay = good.windows(4).position(|bytes| bytes == [0x21, 0xf9, 4, 0] || bytes == [0x21, 0xf9, 4, 4]).unwrap();
    let mut slower = good.clone();
    slower[delay + 4] += 1;
    fs::write(workplace.path("fall.gif"), &slower).unwrap();
    let line = line_about(&workplace, 3, "fall.gif");
    assert!(line.contains("shown for "), "{line}");
    accept_changes(&workplace);
    assert!(workplace.read("fall.gif") == good);
}

#[test]
fn vector_graphics_are_compared_byte_by_byte() {
    let workplace = lecture_folder();
    let good = String::from_utf8(workplace.read("hit.svg")).unwrap();
    workplace.write("hit.svg", &good.replacen("½", "¼", 1).replacen("½", "¼", 1));
    let line = line_about(&workplace, 3, "hit.svg");
    assert!(line.starts_with("differs: caption: \"e = ¼\" → \"e = ½\"; line "), "{line}");
    accept_changes(&workplace);
    assert_eq!(String::from_utf8(workplace.read("hit.svg")).unwrap(), good);
}

/// The first differing line is reported; if the drawings are the same, the difference in provenance.
#[test]
fn the_difference_of_a_figure_of_another_run_is_described() {
    let workplace = lecture_folder();
    workplace.write("scene.toml", &SCENE.replace("mass = 1.0", "mass = 1.5"));
    workplace.done("record scene.toml -o scene.mcap --force");
    let line = line_about(&workplace, 3, "hit.svg");
    assert!(line.starts_with("differs: recording: ") && line.contains("; line "), "{line}");
    assert!(!line.contains("rebond recording"), "{line}");
    workplace.write("scene.toml", &SCENE.replace("steps = 90", "steps = 91"));
    workplace.done("record scene.toml -o scene.mcap --force");
    let line = line_about(&workplace, 3, "hit.svg");
    assert!(line.starts_with("differs: recording: ") && line.ends_with("; the drawing is the same"), "{line}");
}

#[test]
fn another_version_of_rebond_is_named_only_if_it_draws_differently() {
    let workplace = lecture_folder();
    let ours = concat!("rebond ", env!("CARGO_PKG_VERSION"));
    let older = String::from_utf8(workplace.read("hit.svg")).unwrap().replace(ours, "rebond 0.0.1");
    workplace.write("hit.svg", &older);
    assert_eq!(line_about(&workplace, 0, "hit.svg"), "same");
    workplace.write("hit.svg", &older.replacen("</svg>", "<g/></svg>", 1));
    let line = line_about(&workplace, 3, "hit.svg");
    assert!(line.ends_with(&format!("; it was drawn by rebond 0.0.1, and {ours} draws it differently")), "{line}");
    accept_changes(&workplace);
    assert!(String::from_utf8(workplace.read("hit.svg")).unwrap().contains(ours));
}

#[test]
fn pictures_of_a_missing_recording_are_orphaned() {
    let workplace = lecture_folder();
    fs::remove_file(workplace.path("scene.mcap")).unwrap();
    fs::remove_file(workplace.path("scene.toml")).unwrap();
    let recording = line_about(&workplace, 3, "scene.mcap");
    assert!(recording.starts_with("missing: the recording does not exist, and there is no scene"), "{recording}");
    assert!(line_about(&workplace, 3, "fall.png").starts_with("orphaned: its recording scene.mcap does not exist"));
    assert!(line_about(&workplace, 3, "alone.png").starts_with("orphaned: its recording with identity "));
    let outcome = workplace.rebond("check . --update");
    assert_eq!(outcome.code, 3, "an orphaned picture cannot be accepted: {outcome:?}");
}

/// A picture that no manifest lists is redrawn from the recording that replaced its own.
#[test]
fn unlisted_pictures_are_updated_with_their_recording() {
    let workplace = lecture_folder();
    let before = workplace.read("alone.png");
    workplace.write("scene.toml", &SCENE.replace("velocity = [3.0", "velocity = [2.0"));
    assert_eq!(line_about(&workplace, 3, "alone.png"), "same", "the recording has not changed yet");
    accept_changes(&workplace);
    let [old, new] = [before, workplace.read("alone.png")].map(|file| png::decode(Cursor::new(file)).unwrap().0);
    assert!(old != new && old.size == new.size);
}

#[test]
fn damage_exits_with_4_and_a_failed_check_with_1() {
    let workplace = lecture_folder();
    fs::remove_file(workplace.path("scene.toml")).unwrap();
    let good = workplace.read("scene.mcap");
    let mut bad = good.clone();
    bad[good.len() / 2] ^= 1;
    fs::write(workplace.path("scene.mcap"), &bad).unwrap();
    assert!(line_about(&workplace, 4, "scene.mcap").starts_with("corrupt chunk"));
    fs::write(workplace.path("scene.mcap"), &good[..good.len() * 2 / 3]).unwrap();
    assert!(line_about(&workplace, 4, "scene.mcap").starts_with("incomplete: "));
    fs::write(workplace.path("scene.mcap"), &good[..40]).unwrap();
    assert!(line_about(&workplace, 4, "scene.mcap").starts_with("damaged: truncated before its settings"));
    workplace.write("wrong.check", "rebond figure strobe scene.mcap -o a.svg --themes dark\n");
    let line = line_about(&workplace, 1, "wrong.check");
    assert!(line.starts_with("failed: line 1: unexpected argument '--themes'"), "{line}");
}

#[test]
fn a_scene_is_missing_unless_a_recording_of_any_name_was_made_from_it() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o first-try.mcap");
    assert_eq!(workplace.rebond("check .").code, 0);
    workplace.write("other.toml", SCENE);
    let checked = workplace.rebond("check .");
    assert!(checked.code == 3 && checked.output.contains("missing: the recording of other.toml"), "{checked:?}");
}

#[test]
fn a_folder_with_nothing_to_check_is_an_error() {
    let workplace = Workplace::new();
    workplace.write("Cargo.toml", "[package]\nname = \"lecture\"\n");
    let outcome = workplace.rebond("check .");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("nothing to check in ."), "{outcome:?}");
    assert_eq!(workplace.rebond("check nowhere").code, 1);
    workplace.write("scene.toml", SCENE);
    workplace.done("record scene.toml -o scene.mcap");
    let outcome = workplace.rebond("check . --report .");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("choose another folder with --report"), "{outcome:?}");
}

#[test]
fn a_named_file_is_checked_or_an_error() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o scene.mcap");
    workplace.write("short.toml", "run={steps=60}\n");
    workplace.write("bad.toml", "run={stepz=60}\n");
    workplace.write("Cargo.toml", "[package]\nname = \"lecture\"\n");
    workplace.write("notes.txt", "");
    workplace.write("scene.scene", SCENE);
    let checked = workplace.rebond("check .");
    assert_eq!(checked.code, 1, "{checked:?}");
    assert_eq!(line(&checked, "short.mcap"), "missing: the recording of short.toml does not exist");
    assert!(line(&checked, "bad.mcap").starts_with("failed: its scene bad.toml cannot be run: "), "{checked:?}");
    assert!(!checked.output.contains("Cargo") && !checked.output.contains("notes"), "{checked:?}");
    let named = workplace.rebond("check scene.mcap notes.txt scene.scene Cargo.toml");
    assert_eq!(named.code, 1, "{named:?}");
    for name in ["notes.txt", "scene.scene"] {
        assert!(line(&named, name).starts_with("failed: only recordings (.mcap)"), "{named:?}");
    }
    assert!(line(&named, "Cargo.mcap").starts_with("failed: its scene Cargo.toml cannot be run: "), "{named:?}");
    assert!(line(&named, "scene.mcap").starts_with("same"), "{named:?}");
}

#[test]
fn line_ends_are_no_difference() {
    let scene = "[world]\r\nwalls = true\r\n[run]\r\nsteps = 30\r\n[[spawn]]\r\nat = [2.0, 3.0]\r\nsize = [1.0, 1.0]\r\n\
                 mass = 1.0\r\nvelocity = [4.0, 1.0]\r\n";
    let workplace = Workplace::new();
    workplace.write("run.toml", &scene.replace("\r\n", "\n"));
    workplace.done("record run.toml -o run.mcap");
    workplace.done("figure strobe run.mcap -o strobe.svg");
    workplace.done("figure spacetime run.mcap -o listed.svg");
    workplace.write("pictures.check", "# comment\n\nrebond figure spacetime \\\n  run.mcap -o listed.svg\n");
    let recorded = workplace.read("run.mcap");
    workplace.write("run.toml", scene);
    workplace.done("record run.toml -o windows.mcap");
    assert!(workplace.read("windows.mcap") == recorded, "the recordings have the same bytes");
    std::fs::remove_file(workplace.path("windows.mcap")).unwrap();
    for name in ["strobe.svg", "listed.svg", "pictures.check"] {
        let text = String::from_utf8(workplace.read(name)).unwrap();
        workplace.write(name, &text.replace('\n', "\r\n"));
    }
    let checked = workplace.done("check .");
    assert!(checked.output.contains("run.mcap: same: 30 steps, 5 bodies; matches its scene"), "{checked:?}");
    assert!(checked.output.contains("same: 1 recording, 2 pictures"), "{checked:?}");
    assert!(workplace.done("info strobe.svg").output.contains("strobe"));
}

#[test]
fn renders_of_several_sources_are_checked_by_a_manifest_and_by_their_provenance() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o scene.mcap");
    workplace.done("record scene.toml -o heavy.mcap --set spawn.c.mass=20");
    workplace.write(
        "pairs.check",
        "rebond render scene.mcap heavy.mcap -o both.gif --to 20\n\
         rebond render scene.mcap heavy.mcap -o both.png --at 20 --title light --title heavy\n\
         rebond render scene.toml --set 'spawn.c.mass=[1 | 20]' -o sweep.gif --to 20\n",
    );
    workplace.done("check . --update");
    workplace.done("render scene.mcap heavy.mcap -o alone.gif --to 10");
    assert!(workplace.done("check .").output.contains("same: 2 recordings, 4 pictures"));
    let both = workplace.read("both.gif");
    for name in ["both.gif", "alone.gif"] {
        workplace.done(&format!("render heavy.mcap scene.mcap -o {name} --to 20 --force"));
    }
    assert!(line_about(&workplace, 3, "both.gif").starts_with("differs: "));
    assert_eq!(line(&workplace.rebond("check ."), "alone.gif"), "same", "its provenance has the new order");
    workplace.done("check . --update");
    assert!(workplace.read("both.gif") == both);
    std::fs::remove_file(workplace.path("heavy.mcap")).unwrap();
    let outcome = workplace.rebond("check .");
    for name in ["both.gif", "both.png", "alone.gif"] {
        assert!(!line(&outcome, name).starts_with("same"), "{outcome:?}");
    }
    assert!(outcome.code != 0 && line(&outcome, "sweep.gif") == "same", "{outcome:?}");
}

#[cfg(unix)]
#[test]
fn a_case_that_ends_the_process_is_one_line_of_the_result_and_the_others_are_checked() {
    let workplace = lecture_folder();
    // A picture that needs 1 GiB, of which the process gets less: the allocation ends it.
    workplace.write("large.check", "rebond render scene.mcap -o large.png --at 20 --size 16384x16384\n");
    let limited = |arguments: &str| {
        let script = format!("ulimit -v 900000; exec '{}' {arguments}", env!("CARGO_BIN_EXE_rebond"));
        workplace.run(assert_cmd::Command::new("sh").arg("-c").arg(script).current_dir(workplace.path("")))
    };
    for jobs in [1, 2] {
        let outcome = limited(&format!("check . --jobs {jobs} --junit report.xml"));
        assert_eq!(outcome.code, 1, "{outcome:?}");
        let ended =
            "failed: rebond was ended by signal 6 (SIGABRT) at this file; if there was enough memory, please report it";
        assert!(line(&outcome, "large.png").starts_with(ended), "{outcome:?}");
        for name in ["alone.png", "fall.gif", "fall.png", "hit.svg"] {
            assert_eq!(line(&outcome, name), "same");
        }
        assert_eq!(outcome.output.lines().count(), 7, "each line once: {outcome:?}");
        assert!(outcome.output.contains("not the same: 1 of 6"), "{outcome:?}");
        let report = String::from_utf8(workplace.read("report.xml")).unwrap();
        assert!(report.contains("tests=\"6\" failures=\"0\" errors=\"1\""), "{report}");
    }
    workplace.write("fall.png", "");
    workplace.done("render scene.mcap -o fall.gif --to 10 --force");
    let outcome = limited("check . --update");
    assert!(line(&outcome, "fall.gif").ends_with("; accepted"), "{outcome:?}");
    assert!(outcome.output.contains("not the same: 2 of 6, 1 accepted"), "{outcome:?}");
    assert!(workplace.names().iter().all(|name| !name.starts_with(".rebond")), "{:?}", workplace.names());
}

#[cfg(unix)]
#[test]
fn a_review_goes_on_after_a_case_that_ends_the_process() {
    for large in ["a.png", "g.png", "z.png"] {
        let workplace = lecture_folder();
        let before = workplace.read("fall.png");
        workplace.done("render scene.mcap -o fall.png --force --at 21");
        workplace.done("figure collision scene.mcap -o hit.svg --force --caption other");
        let rejected = workplace.read("hit.svg");
        workplace.write("large.check", &format!("rebond render scene.mcap -o {large} --at 20 --size 16384x16384\n"));
        let script = format!("ulimit -v 900000; exec '{}' check . --review --jobs 1", env!("CARGO_BIN_EXE_rebond"));
        let mut command = assert_cmd::Command::new("sh");
        command.arg("-c").arg(script).current_dir(workplace.path("")).write_stdin("a\nr\na\n");
        let outcome = workplace.run(&mut command);
        assert_eq!(outcome.code, 1, "{outcome:?}");
        assert_eq!(outcome.errors.matches("(a)ccept").count(), 2, "{outcome:?}");
        assert!(line(&outcome, large).starts_with("failed: rebond was ended by signal 6"), "{outcome:?}");
        assert!(outcome.output.contains("not the same: 2 of 6, 1 accepted"), "{outcome:?}");
        assert!(workplace.read("fall.png") == before && workplace.read("hit.svg") == rejected);
    }
}

#[cfg(unix)]
#[test]
fn the_processes_that_check_and_review_end_with_the_command() {
    use std::io::Read;
    use std::process::{Command, Stdio};
    use std::{sync::mpsc, thread, time::Duration};
    let workplace = Workplace::with_scene(&SCENE.replace("steps = 90", "steps = 100000000"));
    workplace.write("long.check", "rebond figure strobe scene.toml -o long.svg\n");
    workplace.write("long.svg.new", "new content");
    for (arguments, signal) in [("", "TERM"), ("", "KILL"), (" --review", "TERM"), (" --review", "KILL")] {
        // Nobody answers a review.
        let mut command = workplace.start(&format!("check .{arguments}"), Stdio::piped(), Stdio::null());
        let _answers = command.stdin.take();
        let mut errors = command.stderr.take().unwrap();
        let (sender, ended) = mpsc::channel();
        // The pipe has its end when all processes that hold it have ended.
        thread::spawn(move || sender.send(errors.read_to_end(&mut Vec::new())));
        assert!(ended.recv_timeout(Duration::from_millis(500)).is_err(), "it is still drawing, or asking");
        let id = command.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
        assert!(!command.wait().unwrap().success());
        assert!(ended.recv_timeout(Duration::from_secs(20)).is_ok(), "{arguments} {signal}: a process is left");
        let names = workplace.names();
        assert!(names.iter().all(|name| !name.starts_with(".rebond")), "{arguments} {signal}: {names:?}");
    }
}
