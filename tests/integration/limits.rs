//! Each limit is the same in a scene, in its recording and in its pictures: what one accepts, all accept.

use crate::images;
use crate::rebond::Workplace;

/// A scene of one moving box, with more tables.
fn scene(tables: &str) -> String {
    format!(
        "[run]\nsteps = 6\n{tables}\n[[spawn]]\nname = \"a\"\nat = [2.0, 3.0]\nsize = [1.0, 1.0]\nmass = 1.0\nvelocity = [4.0, 1.0]\n"
    )
}

/// Walks a scene that is at a limit: record, replay, export, recover, draw, read the picture, draw it again.
fn assert_accepted(limit: &str, scene: &str, record_options: &str) {
    let workplace = Workplace::with_scene(scene);
    workplace.done(&format!("record scene.toml -o run.mcap {record_options}"));
    let replayed = workplace.done("replay run.mcap");
    assert!(replayed.output.starts_with("same: 6 steps"), "{limit}: {replayed:?}");
    workplace.done("export run.mcap -o run.csv");
    workplace.done("recover run.mcap -o recovered.mcap");
    assert_eq!(workplace.read("recovered.mcap"), workplace.read("run.mcap"), "{limit}");
    std::fs::remove_file(workplace.path("recovered.mcap")).unwrap();
    workplace.done("render run.mcap --at 0 --show name -o still.png");
    workplace.done("figure strobe run.mcap -o strobe.svg");
    workplace.done("info still.png");
    let checked = workplace.done("check .");
    assert!(checked.output.contains("same: 1 recording, 2 pictures"), "{limit}: {checked:?}");
}

/// Asserts that a scene beyond a limit is refused before anything is written, by a message with these words.
fn assert_refused(scene: &str, options: &str, words: &str) {
    let workplace = Workplace::with_scene(scene);
    let outcome = workplace.rebond(&format!("record scene.toml -o run.mcap {options}"));
    assert!([1, 2].contains(&outcome.code) && outcome.errors.contains(words), "{outcome:?}");
    assert!(outcome.errors.len() < 4000, "{} bytes", outcome.errors.len());
    assert_eq!(workplace.names(), ["scene.toml"]);
}

fn with_materials(count: u32) -> String {
    let pairs: String = (1..count).map(|index| format!("\"m0/m{index}\" = 0.5\n")).collect();
    scene(&format!("[restitution]\n{pairs}"))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn a_scene_and_a_recording_have_up_to_256_materials() {
    assert_accepted("materials", &with_materials(256), "");
    assert_refused(&with_materials(257), "", "more than 256 materials");
    // Many pairs of few materials.
    let all = (0..60).flat_map(|a| (a..60).map(move |b| format!("\"m{a}/m{b}\" = 0.5\n"))).collect::<String>();
    assert_accepted("pairs", &scene(&format!("[restitution]\n{all}")), "");
}

#[test]
fn a_scene_and_a_recording_have_up_to_1000_image_files() {
    let spawn = |index: u32| {
        let [x, y] = [index % 40, index / 40].map(f64::from);
        format!("[[spawn]]\nat = [{x:?}, {y:?}]\nsize = [1.0, 1.0]\nmass = inf\nimage = \"{index}.png\"\n")
    };
    let scene = |count: u32| format!("run.steps = 6\n{}", (0..count).map(spawn).collect::<String>());
    let workplace = Workplace::with_scene(&scene(1000));
    let png = images::encoded([1, 1], &[255, 0, 0, 255]);
    (0..1001).for_each(|index| std::fs::write(workplace.path(&format!("{index}.png")), &png).unwrap());
    workplace.done("record scene.toml -o run.mcap");
    let replayed = workplace.done("replay run.mcap");
    assert!(replayed.output.starts_with("same: 6 steps"), "{replayed:?}");
    workplace.done("render run.mcap --at 0 -o still.png");
    workplace.write("more.toml", &scene(1001));
    for command in ["record more.toml -o more.mcap", "render more.toml --at 0 -o more.png"] {
        let refused = workplace.rebond(command);
        assert!(refused.code == 1 && refused.errors.contains("more than 1000 image files"), "{refused:?}");
        // The place of the last one.
        assert!(refused.errors.contains("more.toml:5006:9"), "{refused:?}");
    }
    assert!(!workplace.path("more.mcap").exists() && !workplace.path("more.png").exists());
}

#[test]
fn a_name_has_up_to_256_bytes() {
    let named = |length: usize| scene("").replace("\"a\"", &format!("\"{}\"", "é".repeat(length / 2)));
    assert_accepted("name", &named(256), "");
    assert_refused(&named(258), "", "1 to 256 bytes");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn a_scene_text_has_up_to_32_mebibytes() {
    let text = scene("");
    let padded = |length: usize| format!("{text}#{}\n", " ".repeat(length - text.len() - 2));
    assert_accepted("scene text", &padded(32 << 20), "");
    assert_refused(&padded((32 << 20) + 1), "", "longer than 33554432 bytes");
    let long_line = text.replace("mass = 1.0", &format!("mass = {}-1.0", " ".repeat(30 << 20)));
    assert_refused(&long_line, "", "`spawn.mass` cannot be -1.0");
}

#[test]
fn a_picture_has_up_to_16384_pixels_along_each_side() {
    for size in [[16384, 64], [64, 16384]] {
        assert_accepted("size", &scene(&format!("[figure]\nsize = {size:?}")), "");
    }
    assert_refused(&scene("[figure]\nsize = [16385, 64]"), "", "from 1 to 16384");
    let workplace = Workplace::with_scene(&scene(""));
    let outcome = workplace.rebond("render scene.toml --at 0 --size 16385x64 -o still.png");
    assert!(outcome.code == 2 && outcome.errors.contains("16384"), "{outcome:?}");
}

#[test]
fn full_states_are_up_to_two_to_the_53_steps_apart_which_costs_nothing() {
    for every in ["7", "100000000003", "9007199254740992"] {
        assert_accepted("every", &scene(""), &format!("--every {every}"));
        let workplace = Workplace::with_scene(&scene(""));
        workplace.done(&format!("record scene.toml -o run.mcap --every {every}"));
        for command in ["render run.mcap --at 0 -o run.png", "figure energy run.mcap -o run.svg", "info run.mcap"] {
            workplace.done(command);
        }
    }
    assert_refused(&scene(""), "--every 9007199254740993", "9007199254740993");
    assert_refused(&scene(""), "--every 0", "'0'");
}

#[test]
fn a_run_has_up_to_two_to_the_53_steps_and_584_years() {
    let with_rate =
        |rate: &str, steps: &str| scene("").replace("steps = 6", &format!("rate = {rate}\nsteps = {steps}"));
    assert_refused(&with_rate("1e9", "9007199254740993"), "", "a whole number of steps");
    assert_refused(&with_rate("60", "1200000000000"), "", "2⁵³ and 584 simulated years");
    assert_refused(&with_rate("1e9", "6"), "--steps 9007199254740993", "at most 9007199254740992");
    assert_refused(&scene(""), "--steps 1200000000000", "simulated time in seconds is 20000000000");
}
