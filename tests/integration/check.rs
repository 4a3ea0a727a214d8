//! `rebond check` on folders of users, with everything that can go wrong in them done for real.

use crate::command_line::SCENE;
use crate::rebond::{Outcome, Workplace};
use rebond::physics::{CollisionCount, Engine, Vector};
use rebond::recording::{Header, Outcome as RunOutcome, SceneText, Versions, Writer};
use rebond::render::png;
use rebond::{run, scene};
use std::fs::{self, File};
use std::io::Cursor;

/// A folder as somebody keeps it for a lecture: a scene, its recording, pictures that a manifest
/// lists, and one that says itself how it was drawn.
pub fn lecture() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o scene.mcap");
    workplace.write(
        "lecture.check",
        "# What the slides show.\n\
         rebond render scene.mcap -o fall.png --at 20 --show velocity,name\n\
         rebond render scene.mcap -o fall.gif --to 20 --show 'trail,clock'\n\
         rebond figure collision scene.mcap -o hit.svg \\\n  --caption 'e = ½'\n",
    );
    workplace.done("render scene.mcap -o alone.png --at 40");
    let outcome = workplace.done("check . --update");
    assert!(
        outcome.output.contains("hit.svg: missing")
            && outcome.output.ends_with("accepted: 3 of 5 changed; look at rebond-check/index.html\n"),
        "{outcome:?}"
    );
    workplace
}

/// A check that ends with this code, and the line it has for a file.
#[track_caller]
fn told(workplace: &Workplace, code: i32, name: &str) -> String {
    let outcome = workplace.rebond("check .");
    assert_eq!(outcome.code, code, "{outcome:?}");
    line(&outcome, name)
}

#[track_caller]
fn line(outcome: &Outcome, name: &str) -> String {
    let found = outcome.output.lines().find_map(|line| line.strip_prefix(&format!("{name}: ")));
    found.unwrap_or_else(|| panic!("{name} in {outcome:?}")).to_owned()
}

/// What was accepted is the same from then on, and a page of it is gone.
#[track_caller]
fn accepted(workplace: &Workplace) {
    let outcome = workplace.rebond("check . --update");
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(outcome.output.contains("; accepted\n"), "{outcome:?}");
    assert_eq!(workplace.done("check .").output.lines().last(), Some("same: 1 recordings, 4 pictures"));
    assert!(!workplace.path("rebond-check").exists());
}

#[test]
fn what_is_as_it_was_is_the_same() {
    let workplace = lecture();
    let outcome = workplace.done("check .");
    let expected = "scene.mcap: same: 90 steps, 7 bodies; its scene gives it\nalone.png: same\nfall.gif: same\n\
                    fall.png: same\nhit.svg: same\nsame: 1 recordings, 4 pictures\n";
    assert_eq!((outcome.output.as_str(), outcome.errors.as_str()), (expected, ""));
    assert_eq!(workplace.done("check . --quiet").output, "same: 1 recordings, 4 pictures\n");
    assert_eq!(workplace.done("check scene.mcap fall.png").output.lines().count(), 3, "files, too");
}

#[test]
fn threads_and_shards_change_nothing_that_is_told() {
    let workplace = lecture();
    workplace.write("fall.png", "no picture");
    let whole = workplace.rebond("check . --json --jobs 1");
    assert_eq!(whole.output, workplace.rebond("check . --json --jobs 3").output);
    assert_eq!(whole.output.lines().count(), 5);
    for of in [2, 3, 9] {
        let parts: String =
            (1..=of).map(|part| workplace.rebond(&format!("check . --json --shard {part}/{of}")).output).collect();
        // Pictures of a page are counted, and each part has a page of its own.
        let plain = |text: &str| text.replace("/002-", "/001-");
        assert_eq!(plain(&parts), plain(&whole.output));
    }
    assert_eq!(workplace.rebond("check . --shard 3/2").code, 2);
}

#[test]
fn a_scene_that_was_edited_is_named_with_what_changed() {
    let workplace = lecture();
    workplace.write("scene.toml", &SCENE.replace("mass = 2.0", "mass = 3.0"));
    let line = told(&workplace, 3, "scene.mcap");
    let expected = "drifted: it replays the same, but its scene gives another run now: at step 0 recorded \
                    spawn \"c\" with mass 2.0, now spawn \"c\" with mass 3.0";
    assert_eq!(line, expected);
    accepted(&workplace);
    workplace.write("scene.toml", &SCENE.replace("mass = 2.0", "mass = 3.0 # heavier"));
    assert!(told(&workplace, 3, "scene.mcap").contains("the text of its scene is another; the same happens"));
    accepted(&workplace);
    workplace.write("scene.toml", &SCENE.replace("rate = 60", "rate = 50"));
    assert!(told(&workplace, 3, "scene.mcap").contains("another solver, rate, gravity"));
    let later = SCENE.replace("mass = 2.0", "mass = 3.0 # heavier").replace("step = 60\nname", "step = 61\nname");
    workplace.write("scene.toml", &later);
    assert!(told(&workplace, 3, "scene.mcap").contains("at step 60 recorded delete body 6, now nothing more"));
    workplace.write("scene.toml", "not a scene");
    assert!(told(&workplace, 1, "scene.mcap").starts_with("failed: its scene scene.toml cannot be recorded: "));
}

/// An engine that takes gravity to be another by one bit.
pub fn record_by_another_engine(workplace: &Workplace) {
    let scene = scene::load(&workplace.path("scene.toml")).unwrap();
    let settings = run::settings(&scene);
    let text = SceneText { file_name: "scene.toml".into(), text: scene.source.text.clone() };
    let header = Header {
        versions: Versions::CURRENT,
        settings: settings.clone(),
        steps: 90,
        every: 1,
        scene: text,
        gaps: Vec::new(),
    };
    let gravity = settings.gravity.map(|gravity| Vector::new(gravity.x, gravity.y.next_up()));
    let mut engine = Engine::new(rebond::physics::Settings { gravity, ..settings });
    let mut run = run::Run::new(&scene);
    let mut writer = Writer::new(File::create(workplace.path("scene.mcap")).unwrap(), &header).unwrap();
    for step in 0..=90 {
        for event in run.happen(Vec::new(), |error| Err(error.into())).unwrap() {
            engine.apply(&event.change.event());
            writer.event(&event).unwrap();
        }
        writer.state(&engine).unwrap();
        if step < 90 {
            run.step(&mut CollisionCount::default()).unwrap();
            engine.step(&mut CollisionCount::default()).unwrap();
        }
    }
    writer.finish(RunOutcome { collisions: None, error: None }).unwrap();
}

#[test]
fn an_engine_that_computes_otherwise_is_named_with_step_body_field_and_ulps() {
    let workplace = lecture();
    record_by_another_engine(&workplace);
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
    let line = told(&workplace, 3, "scene.mcap");
    assert!(line.starts_with("diverged at step 1: body \"c\" vy recorded ") && line.contains(" ulp"), "{line}");
    let collision = told(&workplace, 3, "hit.svg");
    assert!(collision.starts_with("undrawn: scene.mcap: diverged at step 1"), "{collision}");
}

#[test]
fn one_pixel_is_seen_shown_and_accepted() {
    let workplace = lecture();
    let good = workplace.read("fall.png");
    let (mut picture, metadata) = png::decode(Cursor::new(&good)).unwrap();
    picture.pixels[100 * 320 + 7][0] ^= 1;
    let mut file = Vec::new();
    png::encode(&picture, &metadata, &mut file).unwrap();
    fs::write(workplace.path("fall.png"), &file).unwrap();
    let summary = workplace.rebond("check .").output;
    let expected = "not the same: 1 of 5; look at rebond-check/index.html, and accept what is meant with --update\n";
    assert!(summary.ends_with(expected), "{summary}");
    let line = told(&workplace, 3, "fall.png");
    assert_eq!(line, "differs: 1 pixels differ, the first at (7, 100), all from (7, 100) to (7, 100)");
    let page = String::from_utf8(workplace.read("rebond-check/index.html")).unwrap();
    assert!(page.contains("<h2>fall.png <b>differs</b></h2>") && page.contains("src=\"001-fall-png.png\""), "{page}");
    let shown = png::decode(Cursor::new(workplace.read("rebond-check/001-fall-png.png"))).unwrap().0;
    assert_eq!(shown.size, [3 * 320 + 16, 180], "expected, difference and actual");
    accepted(&workplace);
    assert!(workplace.read("fall.png") == good);
}

/// A picture is what is seen: how it is packed is the business of whoever packs it.
#[test]
fn a_picture_packed_by_another_program_is_the_same() {
    let workplace = lecture();
    let (picture, _) = png::decode(Cursor::new(workplace.read("fall.png"))).unwrap();
    let mut encoder = ::png::Encoder::new(File::create(workplace.path("fall.png")).unwrap(), 320, 180);
    encoder.set_color(::png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(picture.pixels.as_flattened()).unwrap();
    writer.finish().unwrap();
    assert_eq!(told(&workplace, 0, "fall.png"), "same");
}

#[test]
fn moving_pictures_are_compared_instant_by_instant() {
    let workplace = lecture();
    let good = workplace.read("fall.gif");
    workplace.done("render scene.mcap -o fall.gif --force --to 20 --show trail,clock --slow 0.5");
    let line = told(&workplace, 3, "fall.gif");
    assert!(line.starts_with("differs: ") && line.contains("picture"), "{line}");
    workplace.done("render scene.mcap -o fall.gif --force --to 20 --show trail");
    let line = told(&workplace, 3, "fall.gif");
    assert!(line.starts_with("differs: picture 1 of 11: "), "{line}");
    assert!(workplace.names().contains(&"rebond-check".to_owned()));
    let delay = good.windows(4).position(|bytes| bytes == [0x21, 0xf9, 4, 0] || bytes == [0x21, 0xf9, 4, 4]).unwrap();
    let mut slower = good.clone();
    slower[delay + 4] += 1;
    fs::write(workplace.path("fall.gif"), &slower).unwrap();
    let line = told(&workplace, 3, "fall.gif");
    assert!(line.contains("it is seen for "), "{line}");
    accepted(&workplace);
    assert!(workplace.read("fall.gif") == good);
}

#[test]
fn shapes_are_compared_byte_by_byte() {
    let workplace = lecture();
    let good = String::from_utf8(workplace.read("hit.svg")).unwrap();
    workplace.write("hit.svg", &good.replacen("½", "¼", 1).replacen("½", "¼", 1));
    let line = told(&workplace, 3, "hit.svg");
    assert!(line.starts_with("differs: line "), "{line}");
    accepted(&workplace);
    assert_eq!(String::from_utf8(workplace.read("hit.svg")).unwrap(), good);
}

#[test]
fn another_version_is_named_only_if_it_draws_otherwise() {
    let workplace = lecture();
    let ours = concat!("rebond ", env!("CARGO_PKG_VERSION"));
    let older = String::from_utf8(workplace.read("hit.svg")).unwrap().replace(ours, "rebond 0.0.1");
    workplace.write("hit.svg", &older);
    assert_eq!(told(&workplace, 0, "hit.svg"), "same");
    workplace.write("hit.svg", &older.replacen("</svg>", "<g/></svg>", 1));
    let line = told(&workplace, 3, "hit.svg");
    assert!(line.ends_with(&format!("; it was drawn by rebond 0.0.1, and {ours} draws it differently")), "{line}");
    accepted(&workplace);
    assert!(String::from_utf8(workplace.read("hit.svg")).unwrap().contains(ours));
}

#[test]
fn pictures_of_a_recording_that_is_gone_are_orphans() {
    let workplace = lecture();
    fs::remove_file(workplace.path("scene.mcap")).unwrap();
    assert!(told(&workplace, 3, "fall.png").starts_with("orphaned: its recording scene.mcap is not there"));
    assert!(told(&workplace, 3, "alone.png").starts_with("orphaned: its recording "));
    let outcome = workplace.rebond("check . --update");
    assert_eq!(outcome.code, 3, "nothing is made of nothing: {outcome:?}");
}

/// A picture that no manifest lists is drawn of the recording that took the place of its own.
#[test]
fn pictures_that_list_themselves_follow_their_recording() {
    let workplace = lecture();
    let before = workplace.read("alone.png");
    workplace.write("scene.toml", &SCENE.replace("velocity = [3.0", "velocity = [2.0"));
    assert_eq!(told(&workplace, 3, "alone.png"), "same", "it is of the recording, which is as it was");
    accepted(&workplace);
    let [old, new] = [before, workplace.read("alone.png")].map(|file| png::decode(Cursor::new(file)).unwrap().0);
    assert!(old != new && old.size == new.size);
}

#[test]
fn damage_ends_with_4_and_what_cannot_be_checked_with_1() {
    let workplace = lecture();
    fs::remove_file(workplace.path("scene.toml")).unwrap();
    let good = workplace.read("scene.mcap");
    let mut bad = good.clone();
    bad[good.len() / 2] ^= 1;
    fs::write(workplace.path("scene.mcap"), &bad).unwrap();
    assert!(told(&workplace, 4, "scene.mcap").starts_with("corrupt chunk"));
    fs::write(workplace.path("scene.mcap"), &good[..good.len() * 2 / 3]).unwrap();
    assert!(told(&workplace, 4, "scene.mcap").starts_with("truncated "));
    fs::write(workplace.path("scene.mcap"), &good[..40]).unwrap();
    assert!(told(&workplace, 4, "scene.mcap").starts_with("damaged: truncated before its settings"));
    workplace.write("wrong.check", "rebond figure strobe scene.mcap -o a.svg --themes dark\n");
    let line = told(&workplace, 1, "wrong.check");
    assert!(line.starts_with("failed: line 1: unexpected argument '--themes'"), "{line}");
}

#[test]
fn where_there_is_nothing_to_check_that_is_an_error() {
    let workplace = Workplace::with_scene(SCENE);
    let outcome = workplace.rebond("check .");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("there is nothing to check in ."), "{outcome:?}");
    assert_eq!(workplace.rebond("check nowhere").code, 1);
    workplace.done("record scene.toml -o scene.mcap");
    let outcome = workplace.rebond("check . --report .");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("name another folder with --report"), "{outcome:?}");
}
