use std::{io, path::PathBuf};

use crate::text::steps_up_to;

/// The reason why a recording cannot be written, or cannot be read at all.
///
/// Damage inside a recording is not an error: the readable part is read, and
/// [`Health`](super::Health) reports the damage.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened.
    #[error("{}: cannot be opened: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The file is a pipe or a device, and a recording is read at any position.
    #[error("{} is not a regular file; save the recording to a file first", path.display())]
    NotARegularFile {
        /// The file.
        path: PathBuf,
    },
    /// Reading failed.
    #[error("the recording cannot be read: {0}")]
    Read(#[source] io::Error),
    /// Writing failed. All data flushed before stays readable.
    #[error("the recording cannot be written: {0}")]
    Write(#[source] io::Error),
    /// The file is not a recording of this program.
    #[error("not a recording of rebond: {reason}")]
    NotARecording {
        /// The reason.
        reason: &'static str,
    },
    /// The file is a table for plotting, which `rebond export` has written.
    #[error(
        "a table for plotting, written by rebond export, not a recording; use the recording or the scene that it was \
         made from"
    )]
    PlotTable,
    /// The file ends before its settings.
    #[error("truncated before its settings: nothing in the file can be read")]
    TruncatedHeader,
    /// The settings are damaged, and there is no second copy of them.
    #[error("corrupt at byte {offset}: {reason}; without the settings nothing else can be read")]
    CorruptHeader {
        /// The offset of the damaged record, in bytes from the start of the file.
        offset: u64,
        /// A description of the damage.
        reason: String,
    },
    /// The format is newer than this program.
    #[error(
        "the recording has format version {found}, but this rebond reads versions up to {}; use a newer rebond",
        super::FORMAT_VERSION
    )]
    NewerFormat {
        /// The format version of the recording.
        found: u32,
    },
    /// The recording was made by an engine with other semantics.
    #[error(
        "the recording was made with engine semantics {found}, but this rebond has {}: it can show the states but not \
         replay them; replay them with the version of rebond that recorded them",
        super::SEMANTICS_VERSION
    )]
    OtherSemantics {
        /// The engine-semantics version of the recording.
        found: u32,
    },
    /// No state is recorded in the steps that were asked for.
    #[error("there is no state {}: the recording has {}", steps_in_words(*from, *to), steps_up_to(*last))]
    NoStates {
        /// The first step asked for.
        from: u64,
        /// The last step asked for.
        to: u64,
        /// The last step of the recording.
        last: u64,
    },
    /// The states in the steps that were asked for are missing or cannot be read.
    #[error("there is no state {}: the recording is {health}", steps_in_words(*from, *to))]
    MissingStates {
        /// The first step asked for.
        from: u64,
        /// The last step asked for.
        to: u64,
        /// The condition of the recording.
        health: Box<super::Health>,
    },
    /// A recording has no state at all that can be read.
    #[error("no state of the recording is readable")]
    NoReadableState,
    /// The messages are too far from the order of time.
    #[error(
        "the messages are too far from the order of time to be read: more than {} chunks, or chunks of more than {} MB, \
         overlap; sort the file by log time first, for example with \"mcap sort\"",
        super::limits::OPEN_PARTS,
        super::limits::OPEN_CHUNK_BYTES >> 20
    )]
    Unsorted,
    /// Nothing of a recording can be recovered.
    #[error("nothing can be recovered: no state is readable{}", damage.as_ref().map(|damage| format!("; {damage}")).unwrap_or_default())]
    NothingToRecover {
        /// The first damage, if there is any.
        damage: Option<super::Damage>,
    },
    /// A quantity exceeds a limit of the format.
    #[error("{quantity} is {found}, but a recording can hold at most {limit}")]
    TooLarge {
        /// The quantity, a noun phrase in the singular.
        quantity: &'static str,
        /// Its value.
        found: u64,
        /// The largest allowed value.
        limit: u64,
    },
    /// A body has invalid constants, which the reader would reject.
    #[error(
        "body {name:?} cannot be recorded: its mass and both its sides must be positive, and all its other numbers finite"
    )]
    InvalidBody {
        /// The name of the body.
        name: String,
    },
    /// A state other than the next one was passed to the writer.
    #[error("state {found} cannot be recorded, because the next state is {expected}")]
    OutOfOrder {
        /// The expected step.
        expected: u64,
        /// The step of the state.
        found: u64,
    },
    /// The world differs from the recorded events.
    #[error("step {step}: the world was changed by an event that was not recorded")]
    UnrecordedEvent {
        /// The step.
        step: u64,
    },
}

impl Error {
    /// Returns true if the file is a recording of rebond whose settings, or all of whose states that are needed, are
    /// damaged or cut off.
    pub const fn is_damage(&self) -> bool {
        matches!(
            self,
            Error::TruncatedHeader
                | Error::CorruptHeader { .. }
                | Error::NothingToRecover { .. }
                | Error::MissingStates { .. }
                | Error::NoReadableState
        )
    }
}

/// The steps from `from` to `to`, which may have no end, in words that follow a noun.
pub fn steps_in_words(from: u64, to: u64) -> String {
    match to {
        u64::MAX => format!("from step {from} on"),
        to if to == from => format!("at step {from}"),
        to => format!("in the steps {from} to {to}"),
    }
}
