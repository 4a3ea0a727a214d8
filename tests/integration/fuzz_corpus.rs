//! What fuzzing has found worth keeping, its findings included, thrown at the readers again.

use std::{fs, path::Path};

#[path = "../fuzz/targets/events.rs"]
mod events;
#[path = "../fuzz/targets/recording.rs"]
mod recording;
#[path = "../fuzz/targets/scene.rs"]
mod scene;

/// Hands every file of a target's corpus to it.
fn replay(target: &str, read: impl Fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(target);
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty());
    for path in paths {
        println!("{}", path.display()); // Shown should the test fail.
        read(&fs::read(path).unwrap());
    }
}

#[test]
fn recordings_of_the_corpus_are_read() {
    replay("recording", recording::read);
}

#[test]
fn scenes_of_the_corpus_are_read() {
    replay("scene", |text| str::from_utf8(text).into_iter().for_each(scene::read));
}

#[test]
fn events_of_the_corpus_are_read() {
    replay("events", events::read);
}
