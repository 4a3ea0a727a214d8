//! Running a recording again and comparing every state to the bit.

use std::{
    io::{Read, Seek},
    ops::RangeInclusive,
};

use crate::{
    physics::Observer,
    recording::{Damage, Error, Recording},
};

/// What a replay found.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Every recorded state came out again.
    Same {
        /// Steps compared.
        steps: u64,
        /// Bodies that ever lived, walls included.
        bodies: u64,
        /// The error the recorded run ended in, which came out again too.
        then_error: Option<String>,
    },
    /// A state came out differently.
    Diverged(Box<Divergence>),
    /// The recording ends before its run does; what is there came out again.
    Truncated {
        /// The last step recorded; none if there was none.
        after: Option<u64>,
        /// Steps compared.
        steps: u64,
    },
    /// Part of the recording cannot be read; what can came out again.
    Corrupt {
        /// The first damage.
        damage: Damage,
        /// Steps compared.
        steps: u64,
    },
}

/// The first difference between a recording and its replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Divergence {
    /// The step whose state differs.
    pub step: u64,
    /// How it differs.
    pub difference: Difference,
    /// The last event before it, in words: `spawn "b" at step 30`.
    pub last_event: Option<String>,
}

/// How a state differs from the recorded one.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// In a number of a body: the first differing body in creation order, and of that the
    /// first field in the order x, y, vx, vy.
    Number {
        /// Name of the body.
        body: String,
        /// `x`, `y`, `vx` or `vy`.
        field: &'static str,
        /// m or m/s.
        recorded: f64,
        /// m or m/s.
        replayed: f64,
    },
    /// Only the digests can be compared and they differ.
    Digest {
        /// Of the recorded state.
        recorded: u64,
        /// Of the replayed state.
        replayed: u64,
    },
    /// The runs do not go on alike: one has a body, a step or an error the other has not.
    Course {
        /// In words.
        what: String,
    },
}

/// Runs `recording` again and compares the states of `steps` (both ends included).
///
/// `progress` hears of each step done. The observer sees the collisions of the replay.
///
/// # Errors
/// If the recording cannot be read for reasons outside of it, or is of an engine this
/// program does not have.
pub fn replay<R: Read + Seek, O: Observer>(
    _recording: Recording<R>,
    _steps: RangeInclusive<u64>,
    _observer: &mut O,
    _progress: &mut dyn FnMut(u64),
) -> Result<Verdict, Error> {
    todo!()
}
