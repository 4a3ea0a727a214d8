//! Work shared out: parts made apart join into the very bytes of the whole. And studies of a parameter.

use crate::rebond::Workplace;
use std::{fs, path::Path};

fn scene(name: &str) -> String {
    format!("{}/recordings/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// The files of a folder by name.
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
fn shards_of_a_folder_of_pictures_are_the_whole() {
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
fn shards_of_a_table_are_the_whole() {
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
fn one_file_has_no_shards() {
    let workplace = Workplace::new();
    let refused = workplace.rebond(&format!("render {} -o run.gif --shard 1/2", scene("figure-1")));
    assert_eq!(refused.code, 1);
    assert!(refused.errors.contains("a single file has no parts"), "{refused:?}");
    assert_eq!(workplace.rebond("export run.mcap --shard 3/2").code, 2);
}

#[test]
fn a_value_set_anew_is_that_of_the_recorded_scene() {
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
fn what_cannot_be_set_is_refused_by_name() {
    let workplace = Workplace::new();
    let masses = scene("masses");
    for (setting, expected) in [
        ("spawn.nobody.mass=2", "cannot set spawn.nobody.mass=2 in the scene"),
        ("restitution.default=1.5", "--set restitution.default=1.5"),
        ("worlds.size=3", "--set worlds.size=3"),
        ("run.rate=fast", "--set run.rate=fast"),
    ] {
        let refused = workplace.rebond(&format!("record {masses} -o out.mcap --set {setting}"));
        assert_eq!(refused.code, 1, "{refused:?}");
        let errors = refused.errors.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(errors.contains(expected), "{setting}: {errors}");
        assert!(!workplace.path("out.mcap").exists());
    }
    assert_eq!(workplace.rebond(&format!("record {masses} -o out.mcap --set mass")).code, 2);
}
