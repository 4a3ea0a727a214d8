use std::process::ExitCode;

/// The exit code of a command. (2, wrong usage, is returned by the argument parser.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Success; everything that was compared is the same.
    Done = 0,
    /// Invalid input, an unreadable or missing file, or a result that cannot be written.
    Error = 1,
    /// A replay diverged or a picture differs.
    Diverged = 3,
    /// A recording is truncated or corrupt; the part that could be read is the same.
    Damaged = 4,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}
