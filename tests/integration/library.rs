//! What the library is for those who test with it.

use crate::check::{lecture, record_by_another_engine};
use rebond::run::{self, NO_LIVE_EVENTS, RecordOptions};
use rebond::scene::draft::{Draft, Spawn};
use rebond::testing::assert_replays;
use std::fs::File;
use std::panic::catch_unwind;
use std::path::Path;

/// What a test that fails there says.
fn failure(path: &Path) -> String {
    *catch_unwind(|| assert_replays(path)).unwrap_err().downcast::<String>().expect("a message")
}

#[test]
fn a_scene_of_code_is_recorded_and_replays() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("draft.mcap");
    let spawn = vec![Spawn { at: [1.0, 1.0], velocity: [1.0, 0.25], ..Spawn::default() }];
    let scene = Draft { spawn, ..Draft::default() }.scene("draft.toml").unwrap();
    run::record(&scene, RecordOptions::whole(&scene), NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
    assert_replays(&path);
    let again = rebond::illustration::Source::open(&path).unwrap().scene;
    assert_eq!(again.inputs, scene.inputs, "the recording carries the scene as text");
}

#[test]
fn a_recording_that_does_not_replay_fails_the_test_and_says_where() {
    let workplace = lecture();
    let path = workplace.path("scene.mcap");
    assert_replays(&path);
    record_by_another_engine(&workplace);
    let told = failure(&path);
    assert!(told.contains("scene.mcap: diverged at step 1: body \"c\" vy recorded "), "{told}");
    std::fs::write(&path, "").unwrap();
    assert!(failure(&path).contains("scene.mcap: "));
}
