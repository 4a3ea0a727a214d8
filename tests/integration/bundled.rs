//! The scenes and recordings that come with rebond.

use crate::rebond::{Workplace, bundled_scenes};
use rebond::{
    physics::CollisionCount,
    recording,
    replay::{Verdict, replay},
    scene,
};

#[test]
fn every_bundled_scene_is_read() {
    let scenes = bundled_scenes();
    assert!(scenes.len() >= 12, "{} scenes", scenes.len());
    for path in scenes {
        let scene = scene::load(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(scene.title.is_some(), "{}: a lecturer wants a title", path.display());
    }
}

/// The recordings were made once and committed: a change of the engine by one bit shows here.
#[test]
fn every_committed_recording_replays_the_same() {
    let mut replayed = 0;
    for path in bundled_scenes() {
        let path = path.with_extension("mcap");
        if !path.exists() {
            continue;
        }
        let recording = recording::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let verdict = replay(recording, 0..=u64::MAX, &mut CollisionCount::default(), &mut |_| ());
        let verdict = verdict.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(matches!(verdict, Verdict::Same { .. }), "{}: {verdict}", path.display());
        replayed += 1;
    }
    assert!(replayed >= 6, "{replayed} recordings");
}

/// A committed recording is what recording its scene gives today, byte for byte.
#[test]
fn committed_recordings_are_what_their_scenes_give() {
    for path in bundled_scenes().into_iter().filter(|path| path.with_extension("mcap").exists()) {
        let workplace = Workplace::new();
        workplace.done(&format!("record {} -o run.mcap", path.display()));
        let committed = std::fs::read(path.with_extension("mcap")).unwrap();
        assert!(workplace.read("run.mcap") == committed, "{}", path.display());
    }
}
