//! Results appear whole or not at all: they are written beside their place and renamed.

use super::error::CommandError;
use crate::illustration;
use crate::render::RenderError;
use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::OnceLock,
};
use tempfile::{Builder, NamedTempFile, TempDir};

/// Whether that path means standard output.
pub fn is_standard_output(path: &Path) -> bool {
    path == Path::new("-")
}

/// Writes text to standard output.
pub fn print(text: &[u8]) -> Result<(), CommandError> {
    let mut output = io::stdout().lock();
    output.write_all(text).and_then(|()| output.flush()).map_err(CommandError::StandardOutput)
}

/// Set once, before any command runs.
static QUIET: OnceLock<bool> = OnceLock::new();

/// From now on nothing but results and errors is told, if that is wished.
pub fn be_quiet(quiet: bool) {
    let _ = QUIET.set(quiet); // Whoever runs several commands in one program decides at the first.
}

/// Whether nothing but results and errors is told.
pub fn is_quiet() -> bool {
    QUIET.get().copied().unwrap_or(false)
}

/// Tells the user something on standard error; results go to standard output.
pub fn note(text: std::fmt::Arguments) {
    if !is_quiet() {
        let _ = writeln!(io::stderr(), "{text}");
    }
}

/// Says what became of the result at `path`: on standard output, unless the result itself is there.
pub fn tell(path: &Path, text: &str) -> Result<(), CommandError> {
    if is_quiet() {
        return Ok(());
    }
    if is_standard_output(path) {
        note(format_args!("{text}"));
        return Ok(());
    }
    print(format!("{text}\n").as_bytes())
}

/// Writes one file with `write`, or standard output for `-`.
pub fn write_file(
    path: &Path,
    force: bool,
    write: impl FnOnce(&mut dyn Write) -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    if is_standard_output(path) {
        let mut output = BufWriter::new(io::stdout().lock());
        write(&mut output).map_err(|error| with_place(error, path))?;
        return output.flush().map_err(CommandError::StandardOutput);
    }
    refuse_existing(path, force)?;
    let file = beside(path).map_err(CommandError::unwritable(path))?;
    let mut output = BufWriter::new(file);
    write(&mut output).map_err(|error| with_place(error, path))?;
    let file = output.into_inner().map_err(|error| CommandError::unwritable(path)(error.into_error()))?;
    put(file, path, force)
}

/// Has one file written at a place beside the one it is to have, by a program of its own.
pub fn write_beside(
    path: &Path,
    force: bool,
    write: impl FnOnce(&Path) -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    refuse_existing(path, force)?;
    let file = beside(path).map_err(CommandError::unwritable(path))?;
    write(file.path())?;
    put(file, path, force)
}

/// An encoder knows what the system said but not where it was writing.
fn with_place(error: CommandError, path: &Path) -> CommandError {
    match error {
        CommandError::Render(RenderError::Write(source))
        | CommandError::Illustration(illustration::Error::Render(RenderError::Write(source))) => {
            CommandError::unwritable(path)(source)
        }
        error => error,
    }
}

/// The error of a file that exists and is to stay.
pub fn refuse_existing(path: &Path, force: bool) -> Result<(), CommandError> {
    if !force && path.symlink_metadata().is_ok() {
        return Err(CommandError::Exists(path.into()));
    }
    Ok(())
}

fn put(file: NamedTempFile, path: &Path, force: bool) -> Result<(), CommandError> {
    // Without force a file that came to stand there meanwhile stays, too.
    let persisted = if force { file.persist(path) } else { file.persist_noclobber(path) };
    match persisted {
        Ok(_) => Ok(()),
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Err(CommandError::Exists(path.into())),
        Err(error) => Err(CommandError::unwritable(path)(error.error)),
    }
}

fn beside(path: &Path) -> io::Result<NamedTempFile> {
    builder(&mut Builder::new()).tempfile_in(parent(path))
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Hidden names, and the permissions any new file gets rather than those of a secret.
fn builder<'b, 'a: 'b>(builder: &'b mut Builder<'a, 'static>) -> &'b mut Builder<'a, 'static> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.prefix(".rebond-")
}

/// A folder of files that appear in their place together, at [`Folder::finish`].
pub struct Folder {
    path: PathBuf,
    force: bool,
    staging: TempDir,
    names: Vec<String>,
}

impl Folder {
    /// The folder at `path`, which may exist: only files in it are never replaced without force.
    pub fn create(path: &Path, force: bool) -> Result<Folder, CommandError> {
        let unwritable = CommandError::unwritable(path);
        if path.exists() && !path.is_dir() {
            return Err(CommandError::Exists(path.into()));
        }
        fs::create_dir_all(parent(path)).map_err(&unwritable)?;
        let staging = Builder::new().prefix(".rebond-").tempdir_in(parent(path)).map_err(&unwritable)?;
        Ok(Folder { path: path.into(), force, staging, names: Vec::new() })
    }

    /// Adds a file.
    pub fn write(&mut self, name: String, content: &[u8]) -> Result<(), CommandError> {
        refuse_existing(&self.path.join(&name), self.force)?;
        let staged = self.staging.path().join(&name);
        fs::write(&staged, content).map_err(CommandError::unwritable(&self.path.join(&name)))?;
        self.names.push(name);
        Ok(())
    }

    /// Moves all files to their place.
    pub fn finish(self) -> Result<(), CommandError> {
        for name in &self.names {
            refuse_existing(&self.path.join(name), self.force)?;
        }
        fs::create_dir_all(&self.path).map_err(CommandError::unwritable(&self.path))?;
        for name in &self.names {
            let place = self.path.join(name);
            fs::rename(self.staging.path().join(name), &place).map_err(CommandError::unwritable(&place))?;
        }
        Ok(())
    }
}
