use std::process::ExitCode;

/// How a command ended, as a script sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Done, and the same.
    Done = 0,
    /// Bad input, unreadable, no such file. (2 is wrong usage; the argument parser ends with it.)
    Error = 1,
    /// A replay diverged or an image differs.
    Diverged = 3,
    /// Truncated or corrupt; the part that could be read is the same.
    Damaged = 4,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}
