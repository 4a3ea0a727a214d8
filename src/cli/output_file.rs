//! The files that commands write.
//!
//! A file appears complete or not at all: it is written to a temporary folder beside its place, synced and renamed. A
//! recording is renamed when its first chunk is written, with live events when the first states after the initial one
//! are, and grows from there. Until then an existing file stays as it is, and a command that fails leaves nothing
//! behind. Devices, named pipes and sockets are written to and never replaced. An input is never overwritten.

use super::arguments::is_standard_output;
use super::error::CommandError;
use crate::picture::{self, RenderError};
use crate::temporary::{TemporaryFile, TemporaryFolder, uninterrupted};
use same_file::Handle;
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;
use tempfile::TempPath;

/// An output that is never one of the inputs of its command.
pub trait RefuseInputs {
    /// Returns an error if the output would replace one of `inputs`, which were not known when it was opened.
    fn refuse_inputs(&mut self, inputs: &[PathBuf]) -> Result<(), CommandError>;
}

/// A file to be written, which was checked to be writable before any work is done.
#[derive(Debug)]
pub struct OutputFile {
    /// The path as given, for messages.
    name: PathBuf,
    destination: Destination,
}

#[derive(Debug)]
enum Destination {
    StandardOutput,
    /// A device, a named pipe or a socket.
    Special,
    Regular {
        /// The place of the file, behind all symbolic links.
        place: PathBuf,
        overwrite: Overwrite,
        staging: TemporaryFolder,
    },
}

/// Policy for an output file that exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// It is replaced (`--force`).
    Allowed,
    /// It is kept, and writing it is an error.
    Refused,
}

impl Overwrite {
    /// The policy that `--force` selects.
    pub const fn from_force(force: bool) -> Overwrite {
        if force { Overwrite::Allowed } else { Overwrite::Refused }
    }

    /// The policy for a JUnit report: an earlier report is replaced, any other file only with `--force`.
    pub fn for_junit(path: &Path, force: bool) -> Overwrite {
        let is_report = || {
            let mut start = String::new();
            let read = File::open(path).and_then(|file| file.take(200).read_to_string(&mut start));
            read.is_ok() && start.contains("<testsuites>")
        };
        // Reading a pipe would wait for ever.
        Overwrite::from_force(force || path.is_file() && is_report())
    }
}

impl OutputFile {
    /// Checks that `path` can be written: it does not exist or may be overwritten, is none of the `inputs`, is not
    /// being recorded by another process, and its folder is writable. `-` stands for standard output.
    pub fn create(path: &Path, overwrite: Overwrite, inputs: &[&Path]) -> Result<OutputFile, CommandError> {
        let name = path.to_owned();
        let metadata = path.metadata();
        if goes_to_standard_output(path) {
            if let Ok(output) = Handle::stdout() {
                refuse_input(output, path, inputs)?;
            }
            return Ok(OutputFile { name, destination: Destination::StandardOutput });
        }
        match &metadata {
            Ok(metadata) if metadata.is_dir() => return Err(CommandError::IsFolder(name)),
            Ok(metadata) if !metadata.is_file() || is_descriptor(path) => {
                return Ok(OutputFile { name, destination: Destination::Special });
            }
            Ok(_) => refuse_input(Handle::from_path(path).map_err(CommandError::unwritable(path))?, path, inputs)?,
            // Devices of Windows, such as NUL, can be opened but have no metadata.
            Err(error) if cfg!(windows) && error.kind() != ErrorKind::NotFound && open_special(path).is_ok() => {
                return Ok(OutputFile { name, destination: Destination::Special });
            }
            Err(_) => {}
        }
        if overwrite == Overwrite::Refused && path.symlink_metadata().is_ok() {
            return Err(CommandError::Exists(name));
        }
        let place = behind_links(path).last().unwrap_or_else(|| path.to_owned());
        OldFile::hold(&place).map_err(CommandError::unwritable(path))?;
        let staging = TemporaryFolder::create(parent(&place)).map_err(CommandError::unwritable(path))?;
        Ok(OutputFile { name, destination: Destination::Regular { place, overwrite, staging } })
    }

    /// The path as given, for messages.
    pub fn name(&self) -> &Path {
        &self.name
    }

    /// Writes the file with `write` and returns its result.
    pub fn write<T>(self, write: impl FnOnce(&mut dyn Write) -> Result<T, CommandError>) -> Result<T, CommandError> {
        let unwritable = CommandError::unwritable(&self.name);
        let into = |file: &mut dyn Write| {
            let mut output = BufWriter::new(file);
            let result = write(&mut output).map_err(|error| with_path(error, &self.name))?;
            output.flush().map_err(&unwritable)?;
            Ok(result)
        };
        match &self.destination {
            Destination::StandardOutput if io::stdout().is_terminal() => {
                into(&mut TerminalWriter { terminal: io::stdout().lock(), is_lead_pending: false })
            }
            Destination::StandardOutput => into(&mut io::stdout().lock()),
            Destination::Special => into(&mut open_special(&self.name).map_err(&unwritable)?),
            Destination::Regular { place, overwrite, staging } => {
                let staged = staging.path().join("output");
                let mut file = staging.add_open(File::create_new(&staged).map_err(&unwritable)?);
                let result = into(&mut file)?;
                file.with(|file| file.sync_all()).map_err(&unwritable)?;
                file.close();
                uninterrupted(|| put(&staged, place, *overwrite)).map_err(&unwritable)?;
                Ok(result)
            }
        }
    }

    /// Passes `write` the path of a file that does not exist yet, for a program that writes it.
    pub fn write_by_path(self, write: impl FnOnce(&Path) -> Result<(), CommandError>) -> Result<(), CommandError> {
        let name = self.name.clone();
        let unwritable = CommandError::unwritable(&name);
        let staged = |staging: &TemporaryFolder| staging.path().join("output");
        if let Destination::Regular { place, overwrite, staging } = &self.destination {
            let staged = staged(staging);
            write(&staged)?;
            sync(&staged).map_err(&unwritable)?;
            return uninterrupted(|| put(&staged, place, *overwrite)).map_err(&unwritable);
        }
        let staging = TemporaryFolder::create_in_system().map_err(CommandError::TemporaryFiles)?;
        let staged = staged(&staging);
        write(&staged)?;
        let mut content = File::open(&staged).map_err(&unwritable)?;
        self.write(|output| io::copy(&mut content, output).map(drop).map_err(&unwritable))
    }

    /// Opens the file for a recording, which can be read while it grows.
    pub fn record(
        self,
        durability: Durability,
        placement: Placement,
    ) -> Result<(Box<dyn Write + Send>, Begun), CommandError> {
        let unwritable = CommandError::unwritable(&self.name);
        let begun = Begun::default();
        let file: Box<dyn Write + Send> = match self.destination {
            Destination::StandardOutput => Box::new(io::stdout()),
            Destination::Special => {
                let file = open_special(&self.name).map_err(&unwritable)?;
                Box::new(RecordingFile { file: file.into(), durability, pending: None })
            }
            Destination::Regular { place, overwrite, staging } => {
                let staged = staging.path().join("output");
                let file = exclusive(OpenOptions::new().write(true).create_new(true)).open(&staged);
                let file = staging.add_open(file.and_then(lock).map_err(&unwritable)?);
                let begun = begun.clone();
                let pending = PendingRecording { placement, staged, place, overwrite, begun, _staging: staging };
                Box::new(RecordingFile { file, durability, pending: Some(pending) })
            }
        };
        Ok((file, begun))
    }
}

impl RefuseInputs for OutputFile {
    fn refuse_inputs(&mut self, inputs: &[PathBuf]) -> Result<(), CommandError> {
        let output = match &self.destination {
            Destination::StandardOutput => Handle::stdout(),
            Destination::Regular { place, .. } => Handle::from_path(place),
            Destination::Special => return Ok(()),
        };
        // A file that does not exist, or cannot be read, is no input.
        output.map_or(Ok(()), |output| refuse_input(output, &self.name, inputs))
    }
}

/// A flag that a recording has appeared at its place, where it stays if writing fails later.
#[derive(Clone, Debug, Default)]
pub struct Begun(Arc<AtomicBool>);

impl Begun {
    /// Returns true if the file is at its place.
    pub fn is_in_place(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}

/// The layer to which a flush of a recording writes the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Durability {
    /// The operating system: data survives a crash of the program.
    Program,
    /// The disk: data survives a power loss (`--sync`).
    Disk,
}

/// The flush that puts a recording at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// The first one, which has a chunk.
    FirstFlush,
    /// The second one, for live events: the first one has the initial state alone, after which the first of them may
    /// still be refused.
    SecondFlush,
}

/// A file to record into, which is locked until it is closed.
struct RecordingFile {
    file: TemporaryFile,
    durability: Durability,
    pending: Option<PendingRecording>,
}

/// A recording that is not at its place yet.
struct PendingRecording {
    /// The flush that puts it there, counted from the next one.
    placement: Placement,
    staged: PathBuf,
    place: PathBuf,
    overwrite: Overwrite,
    begun: Begun,
    /// Removed when this is dropped.
    _staging: TemporaryFolder,
}

impl Write for RecordingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        if let Some(PendingRecording { placement, staged, place, overwrite, begun, .. }) = &mut self.pending {
            if std::mem::replace(placement, Placement::FirstFlush) == Placement::SecondFlush {
                return Ok(());
            }
            self.file.with(|file| file.sync_all())?;
            uninterrupted(|| put(staged, place, *overwrite))?;
            begun.0.store(true, Ordering::Release);
            self.pending = None;
        }
        match self.durability {
            Durability::Program => Ok(()),
            Durability::Disk => self.file.with(|file| file.sync_data()),
        }
    }
}

/// A folder of files that are moved to their place together, by [`OutputFolder::finish`].
pub struct OutputFolder {
    path: PathBuf,
    overwrite: Overwrite,
    staging: TemporaryFolder,
    names: Vec<String>,
    /// Files that the command reads.
    inputs: Vec<PathBuf>,
}

impl OutputFolder {
    /// Opens the folder at `path`, which may exist. Existing files in it are overwritten only if that is allowed, and
    /// none of the `inputs`.
    pub fn create(path: &Path, overwrite: Overwrite, inputs: &[&Path]) -> Result<OutputFolder, CommandError> {
        // Without a slash at its end, which hides a file.
        let path = &path.components().collect::<PathBuf>();
        if path.exists() && !path.is_dir() {
            return Err(CommandError::IsNoFolder(path.into()));
        }
        // The nearest folder that exists is on the same disk, so that files can be renamed.
        let existing = path.ancestors().find(|folder| folder.is_dir()).unwrap_or(Path::new("."));
        let staging = TemporaryFolder::create(existing).map_err(CommandError::unwritable(path))?;
        let inputs = inputs.iter().map(PathBuf::from).collect();
        Ok(OutputFolder { path: path.into(), overwrite, staging, names: Vec::new(), inputs })
    }

    /// Adds a file.
    pub fn write(&mut self, name: String, content: &[u8]) -> Result<(), CommandError> {
        let place = self.path.join(&name);
        self.refuse_existing(&place)?;
        fs::write(self.staging.path().join(&name), content).map_err(CommandError::unwritable(&place))?;
        self.names.push(name);
        Ok(())
    }

    /// The other files in the folder whose names are a number with the same extension, sorted: they may be frames of an
    /// earlier run.
    pub fn other_frames(&self, extension: &str) -> Vec<String> {
        let written: BTreeSet<&String> = self.names.iter().collect();
        let is_other = |name: &String| {
            let number = name.strip_suffix(extension).and_then(|name| name.strip_suffix('.'));
            let is_frame = number.is_some_and(|number| number.len() >= 6 && number.bytes().all(|b| b.is_ascii_digit()));
            is_frame && !written.contains(name)
        };
        let entries = fs::read_dir(&self.path).into_iter().flatten().flatten();
        let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
        let mut others: Vec<String> = names.filter(is_other).collect();
        others.sort();
        others
    }

    /// Moves all files to their place.
    pub fn finish(self) -> Result<(), CommandError> {
        for name in &self.names {
            self.refuse_existing(&self.path.join(name))?;
            sync(&self.staging.path().join(name)).map_err(CommandError::unwritable(&self.path.join(name)))?;
        }
        uninterrupted(|| {
            fs::create_dir_all(&self.path).map_err(CommandError::unwritable(&self.path))?;
            for name in &self.names {
                let place = self.path.join(name);
                put(&self.staging.path().join(name), &place, self.overwrite)
                    .map_err(CommandError::unwritable(&place))?;
            }
            Ok(())
        })
    }

    fn refuse_existing(&self, place: &Path) -> Result<(), CommandError> {
        match place.symlink_metadata() {
            Ok(metadata) if !metadata.is_file() => {
                let kind = match metadata.file_type() {
                    kind if kind.is_dir() => "a folder",
                    kind if kind.is_symlink() => "a symbolic link",
                    _ => "no regular file",
                };
                Err(CommandError::Irreplaceable { path: place.into(), kind })
            }
            Ok(_) if self.overwrite == Overwrite::Refused => Err(CommandError::Exists(place.into())),
            Ok(_) => Handle::from_path(place).map_or(Ok(()), |output| refuse_input(output, place, &self.inputs)),
            Err(_) => Ok(()),
        }
    }
}

impl RefuseInputs for OutputFolder {
    /// The names of the files are not known yet: the error is that of [`OutputFolder::write`].
    fn refuse_inputs(&mut self, inputs: &[PathBuf]) -> Result<(), CommandError> {
        self.inputs.extend_from_slice(inputs);
        Ok(())
    }
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

fn refuse_input(output: Handle, path: &Path, inputs: &[impl AsRef<Path>]) -> Result<(), CommandError> {
    if !output.as_file().metadata().is_ok_and(|metadata| metadata.is_file()) {
        return Ok(());
    }
    let handle = |input: &Path| match input.metadata() {
        _ if is_standard_output(input) => Handle::stdin().ok(),
        // A named pipe that is opened and closed here would lose its writer.
        Ok(metadata) if !metadata.is_file() => None,
        Ok(_) | Err(_) => Handle::from_path(input).ok(),
    };
    if inputs.iter().any(|input| handle(input.as_ref()).is_some_and(|input| input == output)) {
        Err(CommandError::IsInput(path.into()))
    } else {
        Ok(())
    }
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The path and, if it is a symbolic link, the paths to which it leads in turn. The last one is no link, and may not
/// exist.
fn behind_links(path: &Path) -> impl Iterator<Item = PathBuf> {
    const MAX_LINKS: usize = 40;
    let follow = |link: &PathBuf| fs::read_link(link).ok().map(|target| parent(link).join(target));
    std::iter::successors(Some(path.to_owned()), follow).take(MAX_LINKS)
}

/// Returns true if `path` is a name of an open file, such as `/dev/stdout` or `/dev/fd/3` on Linux. The file behind it
/// is written to, whatever it is: the shell has opened it for that.
fn is_descriptor(path: &Path) -> bool {
    let in_process = |path: PathBuf| parent(&path).canonicalize().is_ok_and(|folder| folder.starts_with("/proc"));
    behind_links(path).any(in_process)
}

/// Returns true for `-` and for other names of standard output, such as `/dev/stdout`.
pub fn goes_to_standard_output(path: &Path) -> bool {
    is_standard_output(path) || is_descriptor_of_standard_output(path)
}

fn is_descriptor_of_standard_output(path: &Path) -> bool {
    is_descriptor(path)
        && matches!((Handle::from_path(path), Handle::stdout()), (Ok(path), Ok(output)) if path == output)
}

/// Opens a device, a named pipe or a file that another program has opened, without truncating it.
fn open_special(path: &Path) -> io::Result<File> {
    OpenOptions::new().append(true).open(path)
}

/// Moves the finished file `staged` to its `place`, and syncs the folder.
///
/// A file that is replaced is locked meanwhile, so that of several processes that record to the same place only the
/// first one succeeds.
fn put(staged: &Path, place: &Path, overwrite: Overwrite) -> io::Result<()> {
    loop {
        let old = match overwrite {
            Overwrite::Allowed => OldFile::hold(place)?,
            Overwrite::Refused => None,
        };
        let result = match old {
            Some(old) => old.replace_with(staged, place),
            None => TempPath::try_from_path(staged)?.persist_noclobber(place).map_err(|error| {
                // Dropping the path would remove the file, which another attempt needs.
                let _ = error.path.keep();
                error.error
            }),
        };
        match result {
            // Another process has created the file meanwhile.
            Err(error) if error.kind() == ErrorKind::AlreadyExists && overwrite == Overwrite::Allowed => {}
            Err(error) => return Err(error),
            Ok(()) => break,
        }
    }
    // The name of the file is on the disk as well, as far as the system can sync folders.
    if cfg!(unix) {
        let _ = File::open(parent(place)).and_then(|folder| folder.sync_all());
    }
    Ok(())
}

/// A file to be replaced. No other process can replace it while this exists.
struct OldFile {
    /// `None` for a file that may not be read and so cannot be locked.
    lock: Option<File>,
}

impl OldFile {
    /// Locks the file at `place`. Returns `None` if there is no file, and an error if another process is recording to
    /// it.
    fn hold(place: &Path) -> io::Result<Option<OldFile>> {
        loop {
            let file = match exclusive(OpenOptions::new().read(true)).open(place) {
                Ok(file) => lock(file)?,
                Err(error) => match error.kind() {
                    ErrorKind::NotFound => return Ok(None),
                    ErrorKind::PermissionDenied => return Ok(Some(OldFile { lock: None })),
                    _ if cfg!(windows) && error.raw_os_error() == Some(SHARING_VIOLATION) => {
                        return Err(io::Error::new(ErrorKind::ResourceBusy, Busy));
                    }
                    _ => return Err(error),
                },
            };
            match (Handle::from_file(file.try_clone()?), Handle::from_path(place)) {
                // Another process has replaced the file meanwhile.
                (Ok(held), Ok(current)) if held != current => {}
                _ => return Ok(Some(OldFile { lock: Some(file) })),
            }
        }
    }

    /// Replaces the file, and gives the new one the same permissions.
    fn replace_with(self, staged: &Path, place: &Path) -> io::Result<()> {
        let _ = place.metadata().and_then(|old| fs::set_permissions(staged, old.permissions()));
        if cfg!(windows) {
            drop(self.lock); // Windows replaces no open file.
            return fs::rename(staged, place);
        }
        fs::rename(staged, place)
    }
}

/// Waits until no process is recording to the file at `path`.
pub fn wait_for_writer(path: &Path) {
    const INTERVAL: Duration = Duration::from_millis(20);
    let place = behind_links(path).last().unwrap_or_else(|| path.to_owned());
    while OldFile::hold(&place).is_err_and(|error| is_busy(&error)) {
        thread::sleep(INTERVAL);
    }
}

/// Returns true for the error of a file to which another process is recording.
pub fn is_busy(error: &io::Error) -> bool {
    error.get_ref().is_some_and(|source| source.is::<Busy>())
}

/// The error of a file to which another process is recording.
#[derive(Debug, thiserror::Error)]
#[error("another process is writing it")]
struct Busy;

/// The error of Windows for a file that another process has opened for itself.
const SHARING_VIOLATION: i32 = 32;

/// Locks a file against other processes of this program, as far as its file system has locks.
#[cfg(not(windows))]
fn lock(file: File) -> io::Result<File> {
    match file.try_lock() {
        Err(fs::TryLockError::WouldBlock) => Err(io::Error::new(ErrorKind::ResourceBusy, Busy)),
        Err(fs::TryLockError::Error(_)) | Ok(()) => Ok(file),
    }
}

#[cfg(not(windows))]
fn exclusive(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// A lock of Windows would also keep others from reading; there, [`exclusive`] locks.
#[cfg(windows)]
fn lock(file: File) -> io::Result<File> {
    Ok(file)
}

/// Lets other processes read, rename and delete the file while it is open, but not write it.
#[cfg(windows)]
fn exclusive(options: &mut OpenOptions) -> &mut OpenOptions {
    use std::os::windows::fs::OpenOptionsExt;
    const FILE_SHARE_READ: u32 = 1;
    const FILE_SHARE_DELETE: u32 = 4;
    options.write(true).share_mode(FILE_SHARE_READ | FILE_SHARE_DELETE)
}

/// Waits until the content of a file is on the disk.
fn sync(path: &Path) -> io::Result<()> {
    // Windows syncs only files that are open for writing.
    OpenOptions::new().append(true).open(path)?.sync_all()
}

/// Escapes control characters in text that is printed on a terminal, which they could otherwise control.
struct TerminalWriter<W> {
    terminal: W,
    /// True after a [`LEAD`], which is not written yet.
    is_lead_pending: bool,
}

/// The first of two bytes of the control characters U+0080 to U+009F in UTF-8.
const LEAD: u8 = 0xC2;

impl<W: Write> Write for TerminalWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for &byte in bytes {
            let lead: &[u8] = if std::mem::take(&mut self.is_lead_pending) { &[LEAD] } else { &[] };
            match byte {
                LEAD => {
                    self.terminal.write_all(lead)?;
                    self.is_lead_pending = true;
                }
                0x80..0xA0 if !lead.is_empty() => write!(self.terminal, "\\u00{byte:02x}")?,
                0..0x20 | 0x7F if !matches!(byte, b'\n' | b'\t') => write!(self.terminal, "\\u00{byte:02x}")?,
                _ => self.terminal.write_all(&[lead, &[byte]].concat())?,
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.terminal.flush()
    }
}
