//! Shards join into exactly the bytes of the whole, and `--set` overrides values of a scene.

use crate::rebond::Workplace;
use std::{fs, path::Path};

fn scene(name: &str) -> String {
    format!("{}/recordings/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// The names and contents of the files of a folder, sorted by name.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap()))
        .collect();
    files.sort();
    files
}

#[test]
fn shards_of_a_picture_sequence_join_into_the_whole() {
    let workplace = Workplace::new();
    workplace.done(&format!("record {} -o run.mcap --steps 20", scene("figure-1")));
    for options in ["--size 160x90", "--size 160x90 --every 3 --from 2", "--size 160x90 --from 7 --to 15"] {
        workplace.done(&format!("render run.mcap -o whole/ --force {options}"));
        let mut joined = Vec::new();
        for number in 1..=3 {
            workplace.done(&format!("render run.mcap -o part/ --force {options} --shard {number}/3"));
            joined.extend(files(&workplace.path("part")));
            fs::remove_dir_all(workplace.path("part")).unwrap();
        }
        let whole = files(&workplace.path("whole"));
        assert!(whole.len() > 3 && joined == whole, "{options}: {} pictures of {}", joined.len(), whole.len());
        fs::remove_dir_all(workplace.path("whole")).unwrap();
    }
}

#[test]
fn shards_of_a_table_join_into_the_whole() {
    let workplace = Workplace::new();
    workplace.done(&format!("record {} -o run.mcap --steps 20", scene("figure-1")));
    for (kind, options) in [("csv", ""), ("jsonl", ""), ("csv", "--from 3 --to 11"), ("csv", "--from 19")] {
        workplace.done(&format!("export run.mcap -o whole.{kind} --force {options}"));
        let mut joined = Vec::new();
        for number in 1..=4 {
            workplace.done(&format!("export run.mcap -o part.{kind} --force {options} --shard {number}/4"));
            joined.extend(workplace.read(&format!("part.{kind}")));
        }
        let whole = workplace.read(&format!("whole.{kind}"));
        assert!(!whole.is_empty() && joined == whole, "{kind} {options}");
    }
}

#[test]
fn a_single_file_cannot_be_sharded() {
    let workplace = Workplace::new();
    let outcome = workplace.rebond(&format!("render {} -o run.gif --shard 1/2", scene("figure-1")));
    assert_eq!(outcome.code, 2);
    assert!(outcome.errors.contains("a single file has no parts"), "{outcome:?}");
    assert_eq!(workplace.rebond("export run.mcap --shard 3/2").code, 2);
}

#[test]
fn a_recording_contains_the_scene_with_its_overrides() {
    let workplace = Workplace::with_scene(&fs::read_to_string(scene("masses")).unwrap());
    let scene_file = workplace.names().into_iter().find(|name| name.ends_with(".toml")).unwrap();
    workplace.done(&format!("record {scene_file} -o as-it-is.mcap"));
    workplace.done(&format!("record {scene_file} -o plastic.mcap --set restitution.default=0 --set run.duration=0.5"));
    let replayed = workplace.done("replay plastic.mcap");
    assert!(replayed.output.starts_with("same: 30 steps"), "{replayed:?}");
    let info = workplace.done("info plastic.mcap").output;
    assert!(info.contains("steps: 30\n") && info.contains(&scene_file), "{info}");
    let table = |name: &str| workplace.done(&format!("export {name} --from 30 --to 30")).output;
    assert_eq!(table("plastic.mcap").lines().count(), table("as-it-is.mcap").lines().count());
}

#[test]
fn an_invalid_override_is_rejected_by_name() {
    let workplace = Workplace::new();
    let masses = scene("masses");
    for (assignment, expected) in [
        ("spawn.nobody.mass=2", "--set spawn.nobody.mass=2"),
        ("restitution.default=1.5", "--set restitution.default=1.5"),
        ("worlds.size=3", "--set worlds.size=3"),
        ("run.rate=fast", "--set run.rate=fast"),
    ] {
        let outcome = workplace.rebond(&format!("record {masses} -o out.mcap --set {assignment}"));
        assert_eq!(outcome.code, 1, "{outcome:?}");
        let errors = outcome.errors.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(errors.contains(expected), "{assignment}: {errors}");
        assert!(!workplace.path("out.mcap").exists());
    }
    assert_eq!(workplace.rebond(&format!("record {masses} -o out.mcap --set mass")).code, 2);
}
