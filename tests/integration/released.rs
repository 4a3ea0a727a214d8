//! Recordings of every released version and format, kept under tests/recordings. A newer program replays
//! them or reports why it cannot, and can read their states in any case.

use crate::rebond::Workplace;
use rebond::internals::recording::{self, Playback, SEMANTICS_VERSION};
use std::{
    fs,
    path::{Path, PathBuf},
};

fn released() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings");
    let versions = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir());
    let mut recordings: Vec<PathBuf> =
        versions.flat_map(|version| fs::read_dir(version).unwrap().map(|entry| entry.unwrap().path())).collect();
    recordings.sort();
    recordings
}

#[test]
fn this_version_has_a_released_recording() {
    let version = env!("CARGO_PKG_VERSION");
    assert!(released().iter().any(|path| path.parent().is_some_and(|folder| folder.ends_with(version))));
}

#[test]
fn released_recordings_replay_or_report_why_not() {
    let workplace = Workplace::new();
    for path in released() {
        let semantics = recording::open(&path).unwrap().header.versions.semantics;
        let replayed = workplace.rebond(&format!("replay {}", path.display()));
        if semantics == SEMANTICS_VERSION {
            assert!(replayed.output.starts_with("same: "), "{}: {replayed:?}", path.display());
            assert_eq!(replayed.code, 0);
        } else {
            let reason = format!("made with engine semantics {semantics}, but this rebond has {SEMANTICS_VERSION}");
            assert!(replayed.errors.contains(&reason), "{}: {replayed:?}", path.display());
            assert_eq!(replayed.code, 1);
        }
    }
}

#[test]
fn all_states_of_released_recordings_are_readable() {
    for path in released() {
        let mut playback = Playback::new(recording::open(&path).unwrap());
        let every = playback.header().every;
        let steps: Vec<u64> = playback.by_ref().map(|state| state.unwrap().step).collect();
        let last = playback.trailer().expect("a complete recording").steps;
        assert!(steps.iter().copied().eq((0..=last).step_by(every as usize)), "{}", path.display());
    }
}
