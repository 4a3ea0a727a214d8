use std::{io, path::PathBuf};

/// Why a recording cannot be written or read at all.
///
/// Damage inside a recording is no error: what can be read is read, and
/// [`Health`](super::Health) says what could not.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened.
    #[error("{}: cannot be opened: {source}", path.display())]
    Open {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file cannot be created.
    #[error("{}: cannot be created: {source}", path.display())]
    Create {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is there and is to stay.
    #[error("{}: exists already; --force overwrites it", path.display())]
    Exists {
        /// Which file.
        path: PathBuf,
    },
    /// Reading failed halfway.
    #[error("the recording cannot be read: {0}")]
    Read(#[source] io::Error),
    /// Writing failed; what was flushed before stays readable.
    #[error("the recording cannot be written: {0}")]
    Write(#[source] io::Error),
    /// It is not a recording of this program.
    #[error("not a recording of rebond: {what}")]
    NotARecording {
        /// What gives it away.
        what: &'static str,
    },
    /// It ends before its settings do.
    #[error("truncated before its settings: nothing in it can be read")]
    CutHead,
    /// Its settings are damaged, and there is no second copy of them.
    #[error("corrupt at byte {offset}: {what}; without the settings nothing else can be read")]
    DamagedHead {
        /// Of the damaged record, bytes from the start of the file.
        offset: u64,
        /// What is wrong there.
        what: String,
    },
    /// It is newer than this program.
    #[error(
        "the recording has format version {found}, this rebond reads up to {}; read it with a newer rebond",
        super::FORMAT_VERSION
    )]
    NewerFormat {
        /// Its format version.
        found: u32,
    },
    /// It was made by an engine that computes otherwise.
    #[error(
        "the recording was made with engine semantics {found}, this rebond has {}: it can show the states but not \
         replay them; replay it with the rebond it was made with",
        super::SEMANTICS_VERSION
    )]
    OtherSemantics {
        /// Its engine-semantics version.
        found: u32,
    },
    /// What was to be written is beyond what a recording may hold.
    #[error("{what} is more than a recording holds: {found}, at most {limit}")]
    TooLarge {
        /// What is too large.
        what: &'static str,
        /// How large it is.
        found: u64,
        /// How large it may be.
        limit: u64,
    },
    /// A body that was to be recorded could not be read again.
    #[error("body {name:?} cannot be: its numbers must be finite, its mass and both its sides positive")]
    Impossible {
        /// Its name.
        name: String,
    },
    /// The writer was handed a step that is not the next one.
    #[error("state {found} was to be recorded when state {due} was due")]
    OutOfOrder {
        /// The step that was due.
        due: u64,
        /// The step that came.
        found: u64,
    },
    /// The world has bodies the recording does not know of.
    #[error("step {step}: the world was changed by an event that was not recorded")]
    Unrecorded {
        /// The step.
        step: u64,
    },
}

impl Error {
    /// Whether it is a recording of ours that is cut or damaged, before anything of it can be
    /// read.
    pub const fn is_damage(&self) -> bool {
        matches!(self, Error::CutHead | Error::DamagedHead { .. })
    }
}
