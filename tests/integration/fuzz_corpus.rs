//! Runs the readers on the fuzzing corpus, which includes all past findings.

use std::{fs, path::Path};

#[path = "../fuzz/targets/events.rs"]
mod events;
#[path = "../fuzz/targets/recording.rs"]
mod recording;
#[path = "../fuzz/targets/scene.rs"]
mod scene;

/// Calls `read` with every file in the corpus of a target.
fn replay(target: &str, read: impl Fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(target);
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty());
    for path in paths {
        println!("{}", path.display()); // Printed only if the test fails.
        read(&fs::read(path).unwrap());
    }
}

#[test]
fn recordings_of_the_corpus_are_read_without_a_panic() {
    replay("recording", recording::read);
}

#[test]
fn scenes_of_the_corpus_are_read_without_a_panic() {
    replay("scene", |text| str::from_utf8(text).into_iter().for_each(scene::read));
}

#[test]
fn events_of_the_corpus_are_read_without_a_panic() {
    replay("events", events::read);
}
