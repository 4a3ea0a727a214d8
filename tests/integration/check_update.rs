//! `rebond check --update` replaces only what it found to differ and what is its own, in any folder.

use crate::check::lecture_folder;
use crate::command_line::SCENE;
use crate::rebond::Workplace;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The contents of all files below a folder, except pages of checks.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && path.file_name().is_some_and(|name| name != "rebond-check") {
                folders.push(path);
            } else if path.is_file() {
                found.insert(path.clone(), fs::read(&path).unwrap());
            }
        }
    }
    found
}

fn json_lines(output: &str) -> Vec<serde_json::Value> {
    output.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"))).collect()
}

/// The state of one recording in a random folder.
#[derive(Clone, Copy, Debug)]
enum Recorded {
    Plain,
    Thinned,
    ForViewers,
    Fewer,
    WithValues,
    WithLiveEvents,
    Missing,
    Cut,
    Foreign,
}

/// The change of its scene since.
#[derive(Clone, Copy, Debug)]
enum Edited {
    Not,
    Mass,
    Steps,
    Rate,
    Comment,
    Invalid,
}

/// A picture of the recording, and what became of it.
#[derive(Clone, Copy, Debug)]
enum Drawn {
    Listed,
    ListedOverPhoto,
    ListedOutside,
    ListedOutsideOverPhoto,
    ListedOutsideOfOtherRun,
    Unlisted,
    Emptied,
    None,
}

fn recorded() -> impl Strategy<Value = Recorded> {
    prop::sample::select(vec![
        Recorded::Plain,
        Recorded::Thinned,
        Recorded::ForViewers,
        Recorded::Fewer,
        Recorded::WithValues,
        Recorded::WithLiveEvents,
        Recorded::Missing,
        Recorded::Cut,
        Recorded::Foreign,
    ])
}

fn edited() -> impl Strategy<Value = Edited> {
    prop::sample::select(vec![
        Edited::Not,
        Edited::Not,
        Edited::Mass,
        Edited::Steps,
        Edited::Rate,
        Edited::Comment,
        Edited::Invalid,
    ])
}

fn drawn() -> impl Strategy<Value = Drawn> {
    prop::sample::select(vec![
        Drawn::Listed,
        Drawn::ListedOverPhoto,
        Drawn::ListedOutside,
        Drawn::ListedOutsideOverPhoto,
        Drawn::ListedOutsideOfOtherRun,
        Drawn::Unlisted,
        Drawn::Emptied,
        Drawn::None,
    ])
}

const PHOTO: &str = "not drawn by rebond";

fn small_scene(number: usize) -> String {
    format!(
        "[world]\nsize = [4.0, 3.0]\nwalls = true\n[run]\nrate = 20\nsteps = 6\n[figure]\nsize = [80, 60]\nshow = []\n\
         [[spawn]]\nname = \"a\"\nat = [{number}.0, 1.0]\nsize = [0.5, 0.5]\nmass = 1.0\nvelocity = [4.0, 1.0]\n"
    )
}

/// Creates the folder `checked` with one scene per entry, and the folder `victim` beside it.
fn random_folder(entries: &[(Recorded, Edited, Drawn)]) -> Workplace {
    let workplace = Workplace::new();
    for folder in ["checked", "victim"] {
        fs::create_dir(workplace.path(folder)).unwrap();
    }
    workplace.write("victim/other.toml", &small_scene(2).replace("mass = 1.0", "mass = 7.0"));
    let mut manifest = String::new();
    for (number, &(recorded, edited, drawn)) in entries.iter().enumerate() {
        let (scene, recording) = (format!("checked/s{number}.toml"), format!("checked/s{number}.mcap"));
        let text = small_scene(number);
        workplace.write(&scene, &text);
        let record = |options: &str| drop(workplace.done(&format!("record {scene} -o {recording} {options}")));
        match recorded {
            Recorded::Plain | Recorded::Missing | Recorded::Cut | Recorded::Foreign => record(""),
            Recorded::Thinned => record("--every 3"),
            Recorded::ForViewers => record("--viewer"),
            Recorded::Fewer => record("--steps 4"),
            Recorded::WithValues => record("--set spawn.a.mass=3"),
            Recorded::WithLiveEvents => {
                let line = "{\"spawn\": {\"step\": 2, \"at\": [2.0, 2.0], \"size\": [0.2, 0.2], \"mass\": 1.0}}\n";
                workplace.write("events.jsonl", line);
                record("--events events.jsonl");
            }
        }
        let picture = format!("p{number}.svg");
        let draw = |path: &str, source: &str| {
            drop(workplace.done(&format!("figure strobe {source} -o {path} --size 200x160")));
        };
        let mut list =
            |path: &str| manifest += &format!("rebond figure strobe s{number}.mcap -o {path} --size 200x160\n");
        let (inside, outside) = (format!("checked/{picture}"), format!("victim/{picture}"));
        let listed_outside = format!("../victim/{picture}");
        match drawn {
            Drawn::Listed => {
                draw(&inside, &recording);
                list(&picture);
            }
            Drawn::ListedOverPhoto => {
                workplace.write(&inside, PHOTO);
                list(&picture);
            }
            Drawn::ListedOutside => {
                draw(&outside, &recording);
                list(&listed_outside);
            }
            Drawn::ListedOutsideOverPhoto => {
                workplace.write(&outside, PHOTO);
                list(&listed_outside);
            }
            Drawn::ListedOutsideOfOtherRun => {
                draw(&outside, "victim/other.toml");
                list(&listed_outside);
            }
            Drawn::Unlisted => draw(&inside, &recording),
            Drawn::Emptied => workplace.write(&inside, ""),
            Drawn::None => {}
        }
        let bytes = workplace.read(&recording);
        match recorded {
            Recorded::Missing => fs::remove_file(workplace.path(&recording)).unwrap(),
            Recorded::Cut => fs::write(workplace.path(&recording), &bytes[..bytes.len() * 2 / 3]).unwrap(),
            Recorded::Foreign => workplace.write(&recording, PHOTO),
            _ => {}
        }
        let text = match edited {
            Edited::Not => text,
            Edited::Mass => text.replace("mass = 1.0", "mass = 2.0"),
            Edited::Steps => text.replace("steps = 6", "steps = 9"),
            Edited::Rate => text.replace("rate = 20", "rate = 30"),
            Edited::Comment => text + "# edited\n",
            Edited::Invalid => "[run]\nstep = 6\n".into(),
        };
        workplace.write(&scene, &text);
    }
    workplace.write("checked/all.check", &manifest);
    workplace
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// The laws of `--update`, in a folder in any state: without it nothing is changed; with it, only files that were
    /// found to differ, that rebond has made, and that are inside of the folder or pictures of its recordings. Recordings
    /// with values or events of their own are never changed. Afterwards there is nothing more to accept.
    #[test]
    fn update_replaces_only_what_it_found_to_differ_and_what_is_its_own(
        entries in prop::collection::vec((recorded(), edited(), drawn()), 1..5),
    ) {
        let workplace = random_folder(&entries);
        let before = contents(&workplace.path(""));
        let checked = json_lines(&workplace.rebond("check checked --json").output);
        prop_assert_eq!(&contents(&workplace.path("")), &before, "a check without --update changes nothing");
        let updated = json_lines(&workplace.rebond("check checked --json --update").output);
        let after = contents(&workplace.path(""));
        let about = |lines: &[serde_json::Value], path: &Path| {
            let is_path = |line: &&serde_json::Value| workplace.path(line["path"].as_str().unwrap()) == *path
                || workplace.path(line["path"].as_str().unwrap()).canonicalize().ok() == path.canonicalize().ok();
            lines.iter().find(is_path).cloned()
        };
        for (path, content) in &before {
            let new = after.get(path);
            prop_assert!(new.is_some(), "{} was removed", path.display());
            if new == Some(content) {
                continue;
            }
            let line = about(&updated, path);
            prop_assert!(line.is_some_and(|line| line["accepted"] == true), "{} was not reported", path.display());
            let is_unchanged = about(&checked, path).is_none_or(|line| line["severity"] == "same");
            let follows_recording = path.extension().is_some_and(|extension| extension == "svg");
            prop_assert!(!is_unchanged || follows_recording, "{} was found to be the same", path.display());
            prop_assert!(content != PHOTO.as_bytes() && !content.is_empty(), "{} is not rebond's", path.display());
        }
        for (number, (recorded, _, drawn)) in entries.iter().enumerate() {
            let recording = workplace.path(&format!("checked/s{number}.mcap"));
            if matches!(recorded, Recorded::WithValues | Recorded::WithLiveEvents | Recorded::Foreign) {
                prop_assert_eq!(&after[&recording], &before[&recording], "{:?}", recorded);
            }
            let outside = workplace.path(&format!("victim/p{number}.svg"));
            if matches!(drawn, Drawn::ListedOutsideOverPhoto | Drawn::ListedOutsideOfOtherRun) {
                prop_assert_eq!(&after[&outside], &before[&outside], "{:?}", drawn);
            }
        }
        for path in after.keys().filter(|path| !before.contains_key(*path)) {
            prop_assert!(path.starts_with(workplace.path("checked")), "{} is outside", path.display());
            prop_assert!(about(&checked, path).is_some_and(|line| line["outcome"] == "missing"), "{}", path.display());
        }
        let again = json_lines(&workplace.rebond("check checked --json").output);
        let acceptable: Vec<_> = again.iter().filter(|line| !line["accept_command"].is_null()).collect();
        prop_assert!(acceptable.is_empty(), "{acceptable:?}");
    }
}

#[test]
fn a_manifest_that_names_foreign_files_changes_none_of_them() {
    let workplace = Workplace::new();
    for folder in ["lecture", "victim"] {
        fs::create_dir(workplace.path(folder)).unwrap();
    }
    workplace.write("lecture/scene.toml", SCENE);
    workplace.done("record lecture/scene.toml -o lecture/scene.mcap");
    workplace.write("victim/photo.png", PHOTO);
    workplace.write("victim/photo.mcap", PHOTO);
    let absolute = workplace.path("victim/photo.png");
    workplace.write(
        "lecture/all.check",
        &format!(
            "rebond render scene.mcap -o ../victim/photo.png --at 3\nrebond render scene.mcap -o {} --at 4\n\
             rebond record scene.toml -o ../victim/photo.mcap\nrebond render scene.mcap -o ../victim/new.png --at 3\n",
            absolute.display()
        ),
    );
    let outcome = workplace.rebond("check lecture --update");
    assert_eq!(outcome.code, 1, "the second line names the same file as the first: {outcome:?}");
    for name in ["victim/photo.png", "victim/photo.mcap"] {
        assert_eq!(workplace.read(name), PHOTO.as_bytes(), "{name}");
    }
    assert!(!workplace.path("victim/new.png").exists());
    assert!(outcome.output.contains("victim/photo.png: differs: the reference is not a valid PNG file; not accepted: it carries no rebond provenance"), "{outcome:?}");
    assert!(
        outcome.output.contains("victim/new.png: missing: the picture does not exist; not accepted: it is outside"),
        "{outcome:?}"
    );
}

#[test]
#[cfg(unix)]
fn a_link_out_of_the_folder_is_not_followed_to_foreign_files() {
    let workplace = lecture_folder();
    fs::create_dir(workplace.path("victim")).unwrap();
    let workplace_outside = Workplace::new();
    workplace_outside.write("photo.png", PHOTO);
    fs::remove_file(workplace.path("fall.png")).unwrap();
    std::os::unix::fs::symlink(workplace_outside.path("photo.png"), workplace.path("fall.png")).unwrap();
    let outcome = workplace.rebond("check . --update");
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert_eq!(workplace_outside.read("photo.png"), PHOTO.as_bytes());
}

#[test]
fn the_options_of_a_recording_are_kept_and_its_number_of_steps_follows_the_scene() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o scene.mcap --every 5 --viewer");
    workplace.write("scene.toml", &SCENE.replace("steps = 90", "steps = 120"));
    let outcome = workplace.rebond("check .");
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(
        outcome.output.contains(
            "scene.mcap: drifted: it replays the same, but its scene now gives a different run: steps: 90 → 120; line "
        ),
        "{outcome:?}"
    );
    workplace.done("check . --update");
    workplace.done("record scene.toml -o again.mcap --every 5 --viewer");
    assert!(workplace.read("scene.mcap") == workplace.read("again.mcap"), "--every, --viewer and the present steps");
}

#[test]
fn a_recording_with_values_or_events_of_its_own_is_checked_by_its_own_events() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write("clicks.jsonl", "{\"delete\": {\"step\": 30, \"name\": \"c\"}}\n");
    for (options, words) in [
        ("--set spawn.c.mass=3.5", "--set spawn.c.mass=3.5"),
        ("--events clicks.jsonl", "live events"),
        ("--set spawn.c.mass=3.5 --events clicks.jsonl", "--set spawn.c.mass=3.5 live events"),
    ] {
        workplace.done(&format!("record scene.toml -o scene.mcap --force {options}"));
        let before = workplace.read("scene.mcap");
        for command in ["check .", "check . --update"] {
            let outcome = workplace.done(command);
            let expected = format!("same: 90 steps, 7 bodies; it has {words}, and was checked by its own events");
            assert!(outcome.output.contains(&expected), "{outcome:?}");
            assert!(workplace.read("scene.mcap") == before);
        }
    }
}

#[test]
fn a_deleted_reference_is_missing_and_can_be_made_again() {
    let workplace = lecture_folder();
    let before = contents(&workplace.path(""));
    for name in ["scene.mcap", "fall.png", "hit.svg"] {
        fs::remove_file(workplace.path(name)).unwrap();
    }
    let outcome = workplace.rebond("check .");
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(outcome.output.contains("scene.mcap: missing: the recording of scene.toml does not exist"), "{outcome:?}");
    assert!(outcome.output.contains("not the same: 5 of 5"), "{outcome:?}");
    workplace.done("check . --update");
    assert_eq!(contents(&workplace.path("")), before);
    fs::remove_file(workplace.path("fall.png")).unwrap();
    let outcome = workplace.rebond("check fall.png alone.png");
    assert_eq!(outcome.code, 3, "a file that was given and is missing: {outcome:?}");
    assert_eq!(outcome.output.lines().count(), 3, "{outcome:?}");
    fs::remove_file(workplace.path("scene.mcap")).unwrap();
    workplace.done("check scene.mcap fall.png --update");
    assert_eq!(contents(&workplace.path("")), before);
}

#[test]
fn a_scene_may_be_skipped_and_configurations_are_no_scenes() {
    let workplace = lecture_folder();
    workplace.write("Cargo.toml", "[package]\nname = \"a\"\n");
    workplace.write("large.toml", SCENE);
    assert_eq!(workplace.rebond("check .").code, 3);
    workplace.write("skipped.check", "skip large.toml # too large to keep\n");
    let outcome = workplace.done("check .");
    assert!(outcome.output.ends_with("same: 1 recording, 4 pictures; skipped: 1 scene\n"), "{outcome:?}");
}

#[test]
fn pictures_that_are_damaged_or_stripped_are_reported_and_foreign_ones_counted() {
    let workplace = lecture_folder();
    workplace.done("figure strobe scene.mcap -o strobe.pdf");
    workplace.done("figure strobe scene.mcap -o strobe.svg");
    let pdf = workplace.read("strobe.pdf");
    fs::write(workplace.path("strobe.pdf"), &pdf[..pdf.len() / 2]).unwrap();
    workplace.write("alone.png", "");
    let svg = String::from_utf8(workplace.read("strobe.svg")).unwrap();
    let (start, end) = (svg.find("<metadata>").unwrap(), svg.find("</metadata>").unwrap() + "</metadata>".len());
    workplace.write("strobe.svg", &(svg[..start].to_owned() + &svg[end..]));
    workplace.write("photo.png", PHOTO);
    let outcome = workplace.rebond("check . --update");
    assert_eq!(outcome.code, 1, "{outcome:?}");
    for expected in [
        "alone.png: failed: it is empty",
        "strobe.pdf: failed: ",
        "strobe.svg: failed: another program has removed the provenance",
        "photo.png: unchecked: it carries no rebond provenance",
        "not the same: 3 of 7; unchecked: 1 picture without provenance",
    ] {
        assert!(outcome.output.contains(expected), "{expected}: {outcome:?}");
    }
    assert_eq!((workplace.read("photo.png").as_slice(), workplace.read("alone.png").len()), (PHOTO.as_bytes(), 0));
    workplace.write("second.png", PHOTO);
    let outcome = workplace.rebond("check photo.png second.png alone.png");
    assert!(outcome.output.contains("photo.png: unchecked: it carries"), "a line about each given file: {outcome:?}");
    let outcome = workplace.rebond("check .");
    assert!(outcome.output.contains("\n.: unchecked: 2 pictures without rebond provenance\n"), "{outcome:?}");
    assert!(!outcome.output.contains("photo.png"), "{outcome:?}");
    assert!(outcome.output.contains("; unchecked: 2 pictures without provenance"), "{outcome:?}");
    assert_eq!(workplace.rebond("check . --json").output.matches("\"unchecked\"").count(), 2);
}

#[test]
fn a_manifest_lists_pictures_of_scenes_with_other_values() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write(
        "pictures.check",
        "skip scene.toml\n\
         rebond render scene.toml -o heavy.png --at 21 --set spawn.c.mass=4\n\
         rebond figure energy scene.toml -o energies.svg --set 'restitution.default=[0.1 | 0.9]'\n",
    );
    assert_eq!(workplace.rebond("check .").code, 3);
    workplace.done("check . --update");
    let outcome = workplace.done("check .");
    assert!(outcome.output.contains("energies.svg: same\nheavy.png: same\n"), "{outcome:?}");
    // The files are those that the commands make.
    workplace.done("render scene.toml -o other.png --at 21 --set spawn.c.mass=4");
    assert!(workplace.read("heavy.png") == workplace.read("other.png"));
    workplace.done("figure energy scene.toml -o other.svg --set restitution.default=[0.1|0.9]");
    assert!(workplace.read("energies.svg") == workplace.read("other.svg"));
    for other in ["other.png", "other.svg"] {
        fs::remove_file(workplace.path(other)).unwrap();
    }
    workplace.write("scene.toml", &SCENE.replace("mass = 2.0", "mass = 3.0"));
    let outcome = workplace.rebond("check .");
    assert!(outcome.output.contains("energies.svg: differs"), "{outcome:?}");
    assert!(outcome.output.contains("heavy.png: same"), "its mass is set: {outcome:?}");
    workplace.done("check . --update");
    workplace.done("record scene.toml -o run.mcap");
    workplace.write("pictures.check", "rebond render run.mcap -o heavy.png --at 21 --set spawn.c.mass=4\n");
    let outcome = workplace.rebond("check .");
    assert_eq!(outcome.code, 1, "{outcome:?}");
    assert!(
        outcome.output.contains("heavy.png: undrawn: --set changes values of a scene, but it is drawn from"),
        "{outcome:?}"
    );
}

#[test]
fn a_manifest_lists_recordings_with_the_options_of_the_command() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write("clicks.jsonl", "{\"delete\": {\"step\": 30, \"name\": \"c\"}}\n");
    workplace.write(
        "runs.check",
        "rebond record scene.toml -o heavy.mcap --set spawn.c.mass=4 --every 3\n\
         rebond record scene.toml -o clicked.mcap --events clicks.jsonl --steps 60\n\
         rebond render heavy.mcap -o heavy.png --at 21\n",
    );
    let outcome = workplace.rebond("check .");
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(!outcome.output.contains("scene.mcap"), "the scene has recordings: {outcome:?}");
    workplace.done("check runs.check --update");
    workplace.done("record scene.toml -o other.mcap --set spawn.c.mass=4 --every 3");
    assert!(workplace.read("heavy.mcap") == workplace.read("other.mcap"));
    fs::remove_file(workplace.path("other.mcap")).unwrap();
    let outcome = workplace.done("check .");
    assert!(outcome.output.contains("heavy.mcap: same: 90 steps, 7 bodies; matches its scene"), "{outcome:?}");
    workplace.done("record scene.toml -o heavy.mcap --set spawn.c.mass=4 --force");
    let outcome = workplace.rebond("check .");
    assert!(
        outcome.output.contains(
            "heavy.mcap: drifted: it replays the same, but its scene now gives a different run: every: 1 → 3"
        ),
        "{outcome:?}"
    );
    workplace.done("record scene.toml -o heavy.mcap --events clicks.jsonl --force");
    let before = workplace.read("heavy.mcap");
    workplace.write("runs.check", "rebond record scene.toml -o heavy.mcap\n");
    assert_ne!(workplace.rebond("check . --update").code, 0, "live events are not replaced by a run without them");
    assert!(workplace.read("heavy.mcap") == before);
}

#[test]
fn accepting_one_recording_keeps_its_pictures_in_step() {
    let workplace = lecture_folder();
    workplace.write("scene.toml", &SCENE.replace("velocity = [3.0", "velocity = [2.0"));
    workplace.done("check scene.mcap --update");
    let outcome = workplace.done("check .");
    assert!(outcome.output.ends_with("same: 1 recording, 4 pictures\n"), "{outcome:?}");
}

#[test]
fn one_bad_case_is_one_line_and_the_rest_is_checked() {
    let workplace = lecture_folder();
    workplace.done("render scene.mcap -o size.svg --at 3 --size 300x200");
    let svg = String::from_utf8(workplace.read("size.svg")).unwrap();
    for size in ["0x0", "100000x100000", "4294967295x4294967295"] {
        workplace.write("size.svg", &svg.replace("size=300x200", &format!("size={size}")));
        let outcome = workplace.rebond("check . nowhere");
        assert_eq!(outcome.code, 1, "{outcome:?}");
        assert!(outcome.output.contains("nowhere: failed: it cannot be read"), "{outcome:?}");
        assert!(
            outcome.output.contains("size.svg: ") && outcome.output.contains("not the same: 2 of 7"),
            "{outcome:?}"
        );
    }
    #[cfg(unix)]
    {
        let status = std::process::Command::new("mkfifo").arg(workplace.path("pipe.png")).status().unwrap();
        assert!(status.success());
        let outcome = workplace.rebond("check .");
        assert!(outcome.output.contains("pipe.png: failed: it is no regular file"), "{outcome:?}");
        assert_eq!(workplace.rebond("check pipe.png").code, 1);
    }
}

/// Recordings are searched in the given paths; a file given as such is checked with the files next to it.
#[test]
fn the_command_on_the_page_accepts_the_case_alone() {
    let workplace = lecture_folder();
    workplace.write("scene.toml", &SCENE.replace("velocity = [3.0", "velocity = [2.0"));
    workplace.done("check scene.mcap --update");
    workplace.done("render scene.mcap -o fall.png --at 19 --force");
    workplace.done("render scene.mcap -o fall.gif --to 10 --force");
    let lines = json_lines(&workplace.rebond("check . --json").output);
    let commands: Vec<&str> = lines.iter().filter_map(|line| line["accept_command"].as_str()).collect();
    assert_eq!(commands, ["rebond check fall.gif --update", "rebond check fall.png --update"]);
    let page = String::from_utf8(workplace.read("rebond-check/index.html")).unwrap();
    for command in commands {
        assert!(page.contains(&format!("<code>{command}</code>")), "{page}");
        workplace.done(command.strip_prefix("rebond ").unwrap());
    }
    workplace.done("check .");
}

#[test]
fn the_options_and_settings_that_changed_are_named() {
    let workplace = lecture_folder();
    workplace.done("render scene.mcap -o fall.png --force --at 20 --show velocity,name --theme dark");
    let scene = SCENE.replace("rate = 60", "rate = 120").replace("default = 0.5", "default = 0.25");
    let outcome = workplace.rebond("check .");
    assert!(outcome.output.contains("fall.png: differs: theme: dark → light; "), "{outcome:?}");
    workplace.write("scene.toml", &scene);
    let outcome = workplace.rebond("check .");
    assert!(outcome.output.contains("rate: 60 → 120, restitution.default: 0.5 → 0.25"), "{outcome:?}");
}

#[test]
fn a_picture_of_a_corrupt_recording_names_it_as_the_cause() {
    let workplace = lecture_folder();
    fs::remove_file(workplace.path("scene.toml")).unwrap();
    let good = workplace.read("scene.mcap");
    let mut explained = 0;
    for place in (1..16).step_by(if cfg!(debug_assertions) { 3 } else { 1 }) {
        let mut bytes = good.clone();
        bytes[good.len() * place / 16] ^= 1;
        fs::write(workplace.path("scene.mcap"), &bytes).unwrap();
        let outcome = workplace.rebond("check .");
        let pictures =
            outcome.output.lines().filter(|line| ["alone", "fall", "hit"].iter().any(|name| line.starts_with(name)));
        for line in pictures.filter(|line| !line.ends_with(": same")) {
            assert!(
                line.contains("its recording scene.mcap is corrupt") || line.contains("scene.mcap, which is"),
                "{outcome:?}"
            );
            explained += 1;
        }
        let pictures = ["alone.png", "fall.gif", "fall.png", "hit.svg"].map(|name| workplace.read(name));
        workplace.rebond("check . --update");
        let after = ["alone.png", "fall.gif", "fall.png", "hit.svg"].map(|name| workplace.read(name));
        assert!(after == pictures, "a picture of what remains of a recording is no reference");
    }
    assert!(explained > 0, "no picture was affected");
}
