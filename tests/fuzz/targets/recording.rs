//! Reads, seeks, recovers and replays any bytes as a recording, without a panic.

use std::io::Cursor;

use rebond::internals::{
    physics::CollisionCount,
    recording::{Error, Item, Playback, Recording, recover},
    replay::{ALL_STEPS, Replayer},
};

/// Reads the file in every way that the library has.
pub fn read(file: &[u8]) {
    let open = || Recording::read(Cursor::new(file));
    let Ok(mut recording) = open() else { return };
    let steps = steps(&mut recording);
    for step in [0, 1, steps.last().copied().unwrap_or(0), u64::MAX] {
        recording.seek(step).expect("memory can be read");
        let _ = recording.by_ref().count();
    }
    let _ = Playback::new(recording).count();
    recover_twice(file);
    if steps.len() <= SHORT {
        let replayer = Replayer::new(open().expect("it opened before"), ALL_STEPS);
        let _ = replayer.and_then(|replayer| replayer.run(&mut CollisionCount::default(), |_| ()));
    }
}

/// The largest number of states of a recording that is replayed, to save time.
const SHORT: usize = 64;

fn steps(recording: &mut Recording<Cursor<&[u8]>>) -> Vec<u64> {
    recording
        .filter_map(|item| match item.expect("memory can be read") {
            Item::State(state) | Item::SuspectState(state) => Some(state.step),
            Item::Event(_)
            | Item::Keyframe(_)
            | Item::Damaged(_)
            | Item::Gap(_)
            | Item::Trailer(_)
            | Item::SceneUpdate { .. } => None,
        })
        .collect()
}

/// Asserts that a recovered recording is complete, and that recovering it again changes nothing.
fn recover_twice(file: &[u8]) {
    let mut recording = Recording::read(Cursor::new(file)).expect("it opened before");
    let (_, once) = match recover(&mut recording, Vec::new()) {
        Ok(recovered) => recovered,
        Err(Error::NothingToRecover { .. }) => return,
        Err(error) => panic!("memory can be written: {error}"),
    };
    let mut recording = Recording::read(Cursor::new(once.as_slice())).expect("a recording that was just written");
    let (recovery, twice) = recover(&mut recording, Vec::new()).expect("memory can be written");
    assert_eq!(recovery.health.damage(), None);
    assert!(once == twice, "recovering twice changes something");
}
