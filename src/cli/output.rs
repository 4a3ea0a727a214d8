//! Everything that commands print or write: lines on standard output and standard error, progress bars, and files.
//!
//! Files appear complete or not at all: they are written to a temporary file in the same folder and renamed.

use super::Exit;
use super::arguments::is_standard_output;
use super::error::CommandError;
use crate::picture::{self, ReadExtent, ReadStatus, RenderError};
use crate::recording::{self, Durability, Health, Overwrite};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::OnceLock,
};
use tempfile::{Builder, NamedTempFile, TempDir};

/// Writes text to standard output.
pub fn print(text: &[u8]) -> Result<(), CommandError> {
    let mut output = io::stdout().lock();
    output.write_all(text).and_then(|()| output.flush()).map_err(CommandError::StandardOutput)
}

/// Set once, before any command runs.
static QUIET: OnceLock<bool> = OnceLock::new();

/// Suppresses everything but results and errors if `quiet` is true. Only the first call has an effect.
pub fn set_quiet(quiet: bool) {
    let _ = QUIET.set(quiet);
}

/// Returns true if only results and errors are printed.
pub fn is_quiet() -> bool {
    QUIET.get().copied().unwrap_or(false)
}

/// Prints a line on standard error, unless `--quiet` is given.
pub fn info(text: std::fmt::Arguments) {
    if !is_quiet() {
        let _ = writeln!(io::stderr(), "{text}");
    }
}

/// Prints a line about the result at `path`: on standard output, or on standard error if the result itself goes to
/// standard output.
pub fn print_result(path: &Path, text: &str) -> Result<(), CommandError> {
    if is_quiet() {
        return Ok(());
    }
    if is_standard_output(path) {
        info(format_args!("{text}"));
        return Ok(());
    }
    print(format!("{text}\n").as_bytes())
}

/// Warns about each recording that is corrupt, or truncated before the last requested step. Returns the exit code.
pub fn warn_of_damage(statuses: &[ReadStatus]) -> Exit {
    let mut exit = Exit::Done;
    for ReadStatus { path, health, extent } in statuses {
        let path = path.display();
        match (health, extent) {
            (Health::Complete, _) | (Health::Truncated { .. }, ReadExtent::LastStep) => continue,
            (Health::Truncated { after: Some(step) }, ReadExtent::End) => {
                info(format_args!("{path} is truncated after step {step}"));
            }
            (Health::Truncated { after: None }, ReadExtent::End) => {
                info(format_args!("{path} is truncated before its first state"));
            }
            (Health::Corrupt(damage), _) => info(format_args!("{path} is corrupt: {damage}")),
        }
        exit = Exit::Damaged;
    }
    exit
}

/// Creates a progress bar on standard error, which is hidden if standard error is not a terminal.
pub fn progress_bar(label: &'static str, total: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}")
        .expect("the template is a constant that parses");
    let target = if is_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr_with_hz(10) };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    bar.set_style(style);
    bar.set_message(label);
    bar
}

/// Returns a callback that sets the position and length of a bar.
pub fn progress_updater(bar: &ProgressBar) -> impl FnMut(u64, u64) {
    move |done, total| {
        bar.set_length(total);
        bar.set_position(done);
    }
}

/// Opens the output of `record`. Unlike other outputs, this file appears at once and can be read while it grows.
pub fn create_recording(
    path: &Path,
    overwrite: Overwrite,
    durability: Durability,
) -> Result<Box<dyn Write + Send>, CommandError> {
    if is_standard_output(path) {
        return Ok(Box::new(io::stdout()));
    }
    let file = recording::create(path, overwrite, durability).map_err(CommandError::in_recording(path))?;
    Ok(Box::new(file))
}

/// Writes one file with `write` and returns its result; writes to standard output if `path` is `-`.
pub fn write_file<T>(
    path: &Path,
    force: bool,
    write: impl FnOnce(&mut dyn Write) -> Result<T, CommandError>,
) -> Result<T, CommandError> {
    if is_standard_output(path) {
        let mut output = BufWriter::new(io::stdout().lock());
        let result = write(&mut output).map_err(|error| with_path(error, path))?;
        output.flush().map_err(CommandError::StandardOutput)?;
        return Ok(result);
    }
    refuse_existing(path, force)?;
    let file = temp_beside(path).map_err(CommandError::unwritable(path))?;
    let mut output = BufWriter::new(file);
    let result = write(&mut output).map_err(|error| with_path(error, path))?;
    let file = output.into_inner().map_err(|error| CommandError::unwritable(path)(error.into_error()))?;
    persist(file, path, force)?;
    Ok(result)
}

/// Creates a temporary file in the folder of `path`, passes its path to `write`, and renames it to `path`.
pub fn write_by_path(
    path: &Path,
    force: bool,
    write: impl FnOnce(&Path) -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    refuse_existing(path, force)?;
    let file = temp_beside(path).map_err(CommandError::unwritable(path))?;
    write(file.path())?;
    persist(file, path, force)
}

/// Adds the path to a write error of an encoder, which contains none.
fn with_path(error: CommandError, path: &Path) -> CommandError {
    match error {
        CommandError::Render(RenderError::Write(source))
        | CommandError::Picture(picture::Error::Render(RenderError::Write(source))) => {
            CommandError::unwritable(path)(source)
        }
        error => error,
    }
}

/// Returns an error if `path` exists and may not be overwritten.
pub fn refuse_existing(path: &Path, force: bool) -> Result<(), CommandError> {
    if !force && path.symlink_metadata().is_ok() {
        return Err(CommandError::Exists(path.into()));
    }
    Ok(())
}

fn persist(file: NamedTempFile, path: &Path, force: bool) -> Result<(), CommandError> {
    // Another program may have created the file meanwhile.
    let persisted = if force { file.persist(path) } else { file.persist_noclobber(path) };
    match persisted {
        Ok(_) => Ok(()),
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Err(CommandError::Exists(path.into())),
        Err(error) => Err(CommandError::unwritable(path)(error.error)),
    }
}

fn temp_beside(path: &Path) -> io::Result<NamedTempFile> {
    configure(&mut Builder::new()).tempfile_in(parent(path))
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Configures hidden names, and the usual permissions of new files instead of those of private temporary files.
fn configure<'b, 'a: 'b>(builder: &'b mut Builder<'a, 'static>) -> &'b mut Builder<'a, 'static> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.prefix(".rebond-")
}

/// A folder of files that are moved to their place together, by [`Folder::finish`].
pub struct Folder {
    path: PathBuf,
    force: bool,
    staging: TempDir,
    names: Vec<String>,
}

impl Folder {
    /// Opens the folder at `path`, which may exist. Existing files in it are overwritten only if `force` is true.
    pub fn create(path: &Path, force: bool) -> Result<Folder, CommandError> {
        let unwritable = CommandError::unwritable(path);
        if path.exists() && !path.is_dir() {
            return Err(CommandError::Exists(path.into()));
        }
        fs::create_dir_all(parent(path)).map_err(&unwritable)?;
        let staging = Builder::new().prefix(".rebond-").tempdir_in(parent(path)).map_err(&unwritable)?;
        Ok(Folder { path: path.into(), force, staging, names: Vec::new() })
    }

    /// Adds a file to the staging folder.
    pub fn write(&mut self, name: String, content: &[u8]) -> Result<(), CommandError> {
        refuse_existing(&self.path.join(&name), self.force)?;
        let staged = self.staging.path().join(&name);
        fs::write(&staged, content).map_err(CommandError::unwritable(&self.path.join(&name)))?;
        self.names.push(name);
        Ok(())
    }

    /// Moves all files from the staging folder to their place.
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
