//! Temporary folders, which are removed when they are dropped and when the process is interrupted.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::{fs, io, process};

/// The folders of this process, each with its open files. While it is locked, no folder is created and no file is moved
/// out of one.
static FOLDERS: Mutex<BTreeMap<PathBuf, Vec<OpenFile>>> = Mutex::new(BTreeMap::new());

/// A file until it is closed.
type OpenFile = Arc<Mutex<Option<File>>>;

fn folders() -> MutexGuard<'static, BTreeMap<PathBuf, Vec<OpenFile>>> {
    locked(&FOLDERS)
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic leaves the folders and files as they were.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// True on systems with numbered processes and a folder for temporary files; WASI has neither, and asking for them
/// panics.
const HAS_PROCESSES: bool = cfg!(any(unix, windows));

/// The number of this process; 0 on systems without numbers.
pub fn process_number() -> u32 {
    if HAS_PROCESSES { process::id() } else { 0 }
}

/// The system's folder for temporary files, or the present folder if there is none.
pub fn system_folder() -> PathBuf {
    if HAS_PROCESSES { std::env::temp_dir() } else { PathBuf::from(".") }
}

/// A hidden folder for files that are not complete yet, or are needed only for a while.
#[derive(Debug)]
pub struct TemporaryFolder(PathBuf);

impl TemporaryFolder {
    /// Creates a folder in `parent`.
    ///
    /// # Errors
    /// Returns an error if `parent` does not exist or is not writable.
    pub fn create(parent: &Path) -> io::Result<TemporaryFolder> {
        let mut folders = folders();
        let mut number = 0_u64;
        loop {
            let path = parent.join(format!(".rebond-{}-{number}", process_number()));
            match fs::create_dir(&path) {
                Ok(()) => {
                    folders.insert(path.clone(), Vec::new());
                    return Ok(TemporaryFolder(path));
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(error),
            }
        }
    }

    /// Creates a folder in the system's folder for temporary files.
    ///
    /// # Errors
    /// If that folder is not writable, returns an error that names it and the variable that selects it.
    pub fn create_in_system() -> io::Result<TemporaryFolder> {
        let folder = system_folder();
        TemporaryFolder::create(&folder).map_err(|error| {
            let (variable, place) = (if cfg!(windows) { "TMP" } else { "TMPDIR" }, folder.display());
            let message =
                format!("cannot write temporary files to {place}: {error}; set {variable} to a writable folder");
            io::Error::new(error.kind(), message)
        })
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Adds a file of this folder that is open. On Windows, which removes no folder with an open file, an
    /// interruption closes it.
    #[cfg(feature = "cli")]
    pub fn add_open(&self, file: File) -> TemporaryFile {
        let file = Arc::new(Mutex::new(Some(file)));
        folders().entry(self.0.clone()).or_default().push(Arc::clone(&file));
        TemporaryFile(file)
    }
}

/// A recording in a temporary folder, which is removed when this is dropped.
#[derive(Debug)]
pub struct TemporaryRecording(TemporaryFolder);

impl TemporaryRecording {
    /// Creates the folder in the system's folder for temporary files, without the recording.
    ///
    /// # Errors
    /// Returns the errors of [`TemporaryFolder::create_in_system`].
    pub fn create() -> io::Result<TemporaryRecording> {
        TemporaryFolder::create_in_system().map(TemporaryRecording)
    }

    /// The path of the recording.
    pub fn path(&self) -> PathBuf {
        self.0.path().join("scene.mcap")
    }
}

/// An open file in a [`TemporaryFolder`], one that was moved out of it, or any other file.
#[cfg(feature = "cli")]
#[derive(Debug)]
pub struct TemporaryFile(OpenFile);

#[cfg(feature = "cli")]
impl TemporaryFile {
    /// Returns the result of `work` with the file.
    ///
    /// # Errors
    /// Those of `work`, and an error if an interruption has closed the file.
    pub fn with<T>(&self, work: impl FnOnce(&mut File) -> io::Result<T>) -> io::Result<T> {
        match locked(&self.0).as_mut() {
            Some(file) => work(file),
            None => Err(io::Error::other("the command was interrupted")),
        }
    }

    /// Closes the file.
    pub fn close(self) {
        locked(&self.0).take();
    }
}

#[cfg(feature = "cli")]
impl From<File> for TemporaryFile {
    fn from(file: File) -> TemporaryFile {
        TemporaryFile(Arc::new(Mutex::new(Some(file))))
    }
}

#[cfg(feature = "cli")]
impl io::Write for TemporaryFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.with(|file| file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(()) // A file has no buffer.
    }
}

impl Drop for TemporaryFolder {
    /// Removes the folder and its files. An error is ignored, because nothing depends on the removal.
    fn drop(&mut self) {
        let mut folders = folders();
        // Closes its files, except one that was moved to its place and still grows.
        folders.remove(&self.0);
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Calls `place`, which moves finished files to their place. An interruption waits for it, so that either all files are
/// at their place or none. `place` must not create or drop a [`TemporaryFolder`].
#[cfg(feature = "cli")]
pub fn uninterrupted<T>(place: impl FnOnce() -> T) -> T {
    let _folders = folders();
    place()
}

/// Removes all temporary folders, and lets no other thread create one: the process is about to end.
#[cfg(feature = "cli")]
pub fn remove_all() {
    let folders = folders();
    for (folder, files) in folders.iter() {
        if cfg!(windows) {
            files.iter().for_each(|file| drop(locked(file).take()));
        }
        remove_in_use(folder);
    }
    std::mem::forget(folders);
}

/// Ends the process as soon as `parent`, which has started it, has ended in any way. `wait` returns then. The temporary
/// files of both are removed.
#[cfg(feature = "cli")]
pub fn end_with_parent(parent: u32, wait: impl FnOnce() + Send + 'static) {
    std::thread::spawn(move || {
        wait();
        remove_those_of(parent, &system_folder());
        remove_all();
        process::exit(1);
    });
}

/// Removes the temporary folders in `parent` that a process which has ended left behind.
#[cfg(feature = "cli")]
pub fn remove_those_of(process: u32, parent: &Path) {
    let prefix = format!(".rebond-{process}-");
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// Removes a folder to which other threads and a running ffmpeg still add files.
#[cfg(feature = "cli")]
fn remove_in_use(folder: &Path) {
    // Under its new name no file can be added any more, except one that is being created at this instant. Windows
    // renames no folder that contains an open file, such as that of ffmpeg; the attempts are for these two cases.
    let mut renamed = folder.as_os_str().to_owned();
    renamed.push("-removed");
    let folder = if fs::rename(folder, &renamed).is_ok() { Path::new(&renamed) } else { folder };
    const ATTEMPTS: usize = 100;
    for _ in 0..ATTEMPTS {
        match fs::remove_dir_all(folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => std::thread::yield_now(),
            _ => return,
        }
    }
}

/// Removes temporary files on SIGINT, SIGTERM, SIGHUP and SIGQUIT, and then ends the process by the same signal, so
/// that shells and parent processes see the interruption. Signals that the parent process ignores stay ignored, as
/// under `nohup`.
#[cfg(all(feature = "cli", unix))]
pub fn remove_all_on_interruption() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    use signal_hook::{iterator::Signals, low_level};

    let ignored = ignored_signals();
    let handled = [SIGINT, SIGTERM, SIGHUP, SIGQUIT].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    let Ok(mut signals) = Signals::new(handled) else { return };
    std::thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            remove_all();
            let _ = low_level::emulate_default_handler(signal);
        }
    });
}

/// The signals that are ignored from the start, bit n − 1 for signal n. Known only on Linux, 0 elsewhere.
#[cfg(all(feature = "cli", unix))]
fn ignored_signals() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// Removes temporary files on Ctrl-C, on Ctrl-Break and when the window is closed, and then ends the process.
#[cfg(all(feature = "cli", windows))]
pub fn remove_all_on_interruption() {
    /// STATUS_CONTROL_C_EXIT, the exit code of a process that does not handle Ctrl-C.
    const INTERRUPTED: i32 = 0xC000_013A_u32 as i32;
    // Without a handler the process ends as well, and leaves its temporary files behind.
    let _ = ctrlc::set_handler(|| {
        remove_all();
        process::exit(INTERRUPTED);
    });
}

/// Other systems have no signals that could be handled.
#[cfg(all(feature = "cli", not(any(unix, windows))))]
pub fn remove_all_on_interruption() {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_temporary_folder_disappears_with_its_files() {
        let parent = tempfile::tempdir().unwrap();
        let folders = [0, 1, 2].map(|_| TemporaryFolder::create(parent.path()).unwrap());
        for folder in &folders {
            fs::write(folder.path().join("part"), "half").unwrap();
        }
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 3);
        drop(folders);
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0);
    }

    #[cfg(all(feature = "cli", unix))]
    #[test]
    fn a_folder_disappears_while_other_threads_add_files() {
        let parent = tempfile::tempdir().unwrap();
        for round in 0..20 {
            let folder = parent.path().join("folder");
            fs::create_dir(&folder).unwrap();
            std::thread::scope(|scope| {
                for writer in 0..3 {
                    let folder = &folder;
                    scope.spawn(move || {
                        (0..).take_while(|n| fs::write(folder.join(format!("{writer}-{n}")), "frame").is_ok()).count()
                    });
                }
                while fs::read_dir(&folder).unwrap().count() < 100 {}
                remove_in_use(&folder);
            });
            assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0, "round {round}");
        }
    }
}
