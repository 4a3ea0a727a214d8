//! For the tests of those who use rebond.

use crate::replay::Verdict;
use crate::replay::replay_file;
use std::path::Path;

/// Fails a test unless the recording at `path` is whole and replays the same, to the last bit.
///
/// ```no_run
/// #[test]
/// fn the_lecture_still_runs() {
///     rebond::testing::assert_replays("lecture/cradle.mcap");
/// }
/// ```
///
/// # Panics
/// If it does not, or cannot be read. The message names the file and says where: the step, the
/// body, the field, what was recorded and what came out, how many ulps apart, and the last event
/// before. It is the one documented panic of this crate.
#[track_caller]
pub fn assert_replays(path: impl AsRef<Path>) {
    let path = path.as_ref();
    match replay_file(path) {
        Ok(Verdict::Same { .. }) => {}
        Ok(verdict) => panic!("{}: {verdict}", path.display()),
        Err(error) => panic!("{}: {error}", path.display()),
    }
}
