use std::{
    fs::{File, OpenOptions},
    io::{self, ErrorKind, Write},
    path::Path,
};

use super::Error;

/// Policy for an output file that already exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// It is replaced (`--force`).
    Allowed,
    /// It is kept, and opening it is an error.
    Refused,
}

/// The layer to which a flush writes the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sync {
    /// The operating system: data survives a crash of the program.
    Program,
    /// The disk: data survives a power loss (`--sync`).
    Disk,
}

/// A file to record into, with flushes to the chosen layer.
#[derive(Debug)]
pub struct RecordingFile {
    file: File,
    sync: Sync,
}

/// Opens `path` for recording, in place, so that the file can be read during the run.
///
/// Special files (`/dev/null`, a named pipe) are opened regardless of `overwrite`.
///
/// # Errors
/// Returns an error if the file exists and may not be replaced, or if it cannot be created.
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
