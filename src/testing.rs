//! Assertions for tests of programs that use rebond.

use crate::physics::CollisionCount;
use crate::replay::{ALL_STEPS, Replayer, Verdict};
use std::path::Path;

/// Asserts that the recording at `path` is complete and replays bit for bit.
///
/// ```no_run
/// #[test]
/// fn the_lecture_still_runs() {
///     rebond::testing::assert_replays("lecture/cradle.mcap");
/// }
/// ```
///
/// # Panics
/// If the recording does not replay the same or cannot be read. The message contains the path and the first difference:
/// the step, body and field, the recorded and the replayed value, their distance in ulps, and the last event before it.
/// This is the only documented panic of the public API.
#[track_caller]
pub fn assert_replays(path: impl AsRef<Path>) {
    let path = path.as_ref();
    let replay = Replayer::open(path, ALL_STEPS);
    match replay.and_then(|replay| replay.run(&mut CollisionCount::default(), |_| ())) {
        Ok(Verdict::Same { .. }) => {}
        Ok(verdict) => panic!("{}: {verdict}", path.display()),
        Err(error) => panic!("{}: {error}", path.display()),
    }
}
