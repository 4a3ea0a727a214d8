use std::{
    fs::{File, OpenOptions},
    io::{self, ErrorKind, Write},
    path::Path,
};

use super::Error;

/// Whether an existing file may be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// `--force`.
    Allowed,
    /// An existing file is an error.
    Refused,
}

/// How far down a flush reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sync {
    /// To the operating system: survives the death of the program.
    Program,
    /// To the disk: survives a power loss (`--sync`).
    Disk,
}

/// A file to record into, whose flush reaches as far down as was asked for.
#[derive(Debug)]
pub struct RecordingFile {
    file: File,
    sync: Sync,
}

/// Opens `path` to record into, in place, so that it can be read while the run goes on.
///
/// What is no ordinary file (`/dev/null`, a named pipe) is written to without further ado.
///
/// # Errors
/// If the file exists and is to stay, or cannot be created.
pub fn create(path: &Path, overwrite: Overwrite, sync: Sync) -> Result<RecordingFile, Error> {
    let special = path.metadata().is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir());
    let mut options = OpenOptions::new();
    options.write(true);
    match overwrite {
        _ if special => &mut options,
        Overwrite::Allowed => options.create(true).truncate(true),
        Overwrite::Refused => options.create_new(true),
    };
    let file = options.open(path).map_err(|source| match source.kind() {
        ErrorKind::AlreadyExists => Error::Exists { path: path.into() },
        _ => Error::Create { path: path.into(), source },
    })?;
    Ok(RecordingFile { file, sync })
}

impl Write for RecordingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.sync {
            Sync::Program => Ok(()),
            Sync::Disk => self.file.sync_data(),
        }
    }
}
