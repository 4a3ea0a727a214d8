//! Assertions for tests of programs that use rebond.
//!
//! | assertion | holds |
//! |---|---|
//! | [`assert_replays`] | one recording replays the same |
#![cfg_attr(
    feature = "draw",
    doc = "
| [`assert_folder`] | all recordings and pictures of a folder, as `rebond check` does |
| [`assert_recording`] | one recording replays the same and matches its scene |
| [`assert_picture`] | one picture is redrawn the same from its recordings |
| [`assert_same_picture`] | a picture that the test has drawn is the same as its reference |

If one of these fails, the new content of each file is written beside it as `NAME.new`, and the message names the page
that shows the differences. `rebond check --review` accepts or rejects the new contents one by one. The environment
variable `REBOND_UPDATE` changes that:

| `REBOND_UPDATE` | changed files |
|---|---|
| `new` | are kept, with the new content beside them; the default, except if the variable `CI` is set |
| `no` | are kept; the default if `CI` is set |
| `always` | are replaced, and the test passes; as with `rebond check --update`, only files that rebond has made |

An assertion runs in the process of its test. A file that ends that process (a picture that needs more memory than there
is) therefore ends the test program: `rebond check` then names the file."
)]

#[cfg(feature = "draw")]
mod held;

use crate::physics::CollisionCount;
use crate::replay::{ALL_STEPS, Replayer, Verdict};
use std::path::Path;

#[cfg(feature = "draw")]
#[doc(hidden)]
pub use held::{Update, hold, hold_picture};
#[cfg(feature = "draw")]
pub use held::{assert_folder, assert_picture, assert_recording, assert_same_picture};

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
