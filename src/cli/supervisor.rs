//! Checks in a child process, so that a case that ends it (without memory, or by a bug that overflows the stack) is one
//! line of the result. The child notes in a journal which cases it is at; after its end another child goes on, without
//! the case that was to blame.

use super::Exit;
use crate::check::{Case, CheckResult, ManifestLine, Outcome};
use crate::temporary::{self, TemporaryFolder};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};

/// The standard input of a child.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// A pipe that is open as long as this process needs the child.
    Lifeline,
    /// That of this process, from which a review reads its answers. The child asks again when another one was ended.
    Answers,
}

/// Runs this command in children until one of them ends by itself, and returns its exit code. `None` if no child can be
/// started. `folders` are those of output files, where a child that is ended may leave temporary files.
pub fn supervise(folders: &[PathBuf], input: Input) -> io::Result<Option<Exit>> {
    let temporary = TemporaryFolder::create_in_system()?;
    let path = temporary.path().join("journal");
    Journal::open(&path)?.note("parent", &temporary::process_number().to_string());
    loop {
        let stdin = if input == Input::Lifeline { Stdio::piped() } else { Stdio::inherit() };
        let child = command(&path).and_then(|mut command| command.stdin(stdin).spawn());
        let Ok(mut child) = child else { return Ok(None) };
        // The child ends when this pipe is closed, whatever ends this process.
        let _pipe = child.stdin.take();
        let status = child.wait()?;
        if let Some(exit) = status.code().and_then(Exit::of_code) {
            return Ok(Some(exit));
        }
        for folder in folders.iter().map(PathBuf::as_path).chain([temporary::system_folder().as_path()]) {
            temporary::remove_those_of(child.id(), folder);
        }
        end_like(status);
        let journal = Journal::open(&path)?;
        let unfinished: Vec<String> = journal.unfinished.iter().cloned().collect();
        match &unfinished[..] {
            [] => return Err(io::Error::other(format!("the process that checks {}", end_of(status)))),
            [key] => {
                journal.note("fatal", &format!("{key}\t{}", end_of(status)));
                journal.note("end", key);
            }
            // The next child checks one case after the other.
            [..] => {
                journal.note("alone", "");
                unfinished.iter().for_each(|key| journal.note("end", key));
            }
        }
    }
}

/// Ends this process, a child with this input, as soon as `parent` has ended in any way.
pub fn end_with_parent(parent: u32, input: Input) {
    match input {
        Input::Lifeline => temporary::end_with_parent(parent, || drop(io::copy(&mut io::stdin(), &mut io::sink()))),
        #[cfg(unix)]
        Input::Answers => temporary::end_with_parent(parent, move || {
            // The standard input is the terminal, so its end does not show that of the parent.
            while std::os::unix::process::parent_id() == parent {
                std::thread::sleep(std::time::Duration::from_millis(100));
            }
        }),
        #[cfg(not(unix))]
        Input::Answers => {}
    }
}

/// This command with `--journal`.
fn command(journal: &Path) -> io::Result<Command> {
    let mut arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let name = arguments.iter().position(|argument| argument == "check").map_or(0, |index| index + 1);
    arguments.splice(name..name, ["--journal".into(), journal.into()]);
    let mut command = Command::new(std::env::current_exe()?);
    command.args(arguments);
    Ok(command)
}

/// Ends this process by the signal that interrupted the child.
#[cfg(unix)]
fn end_like(status: ExitStatus) {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    use std::os::unix::process::ExitStatusExt;
    if let Some(signal) = status.signal().filter(|signal| [SIGINT, SIGTERM, SIGHUP, SIGQUIT].contains(signal)) {
        temporary::remove_all();
        let _ = signal_hook::low_level::emulate_default_handler(signal);
    }
}

#[cfg(not(unix))]
fn end_like(status: ExitStatus) {
    // 0xC000013A is the exit code of a process that Ctrl-C has ended.
    if let Some(code) = status.code().filter(|code| *code == 0xC000_013A_u32 as i32) {
        temporary::remove_all();
        std::process::exit(code);
    }
}

/// The end of a child, as the rest of a sentence.
fn end_of(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        let name = signal_hook::low_level::signal_name(signal).map_or(String::new(), |name| format!(" ({name})"));
        return format!("was ended by signal {signal}{name}");
    }
    status.code().map_or("was ended".into(), |code| format!("was ended with the code {:#X}", code as u32))
}

/// The notes of a child about the cases that it checks. Each is a word and the key of a case, in one line. The default
/// is one for a process without a supervisor, which writes nothing.
#[derive(Debug, Default)]
pub struct Journal {
    file: Option<Mutex<File>>,
    /// The process that supervises this one.
    pub parent: Option<u32>,
    /// True if cases are to be checked one after the other.
    pub is_alone: bool,
    /// The cases that were begun and not ended.
    unfinished: BTreeSet<String>,
    /// The cases that have ended a child, and how.
    fatal: BTreeMap<String, String>,
    printed: BTreeSet<String>,
    accepted: BTreeSet<String>,
    /// The files about which the user of a review has answered.
    pub answered: BTreeSet<String>,
    /// True if the user of a review has ended it.
    pub is_review_ended: bool,
}

impl Journal {
    /// Opens the journal at `path`, or begins it.
    pub fn open(path: &Path) -> io::Result<Journal> {
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        let mut journal = Journal { file: Some(Mutex::new(file)), ..Journal::default() };
        for line in String::from_utf8_lossy(&fs::read(path)?).lines() {
            let (word, key) = line.split_once(' ').unwrap_or((line, ""));
            match word {
                "parent" => journal.parent = key.parse().ok(),
                "begin" => drop(journal.unfinished.insert(key.into())),
                "end" => drop(journal.unfinished.remove(key)),
                "printed" => drop(journal.printed.insert(key.into())),
                "accepted" => drop(journal.accepted.insert(key.into())),
                "answered" => drop(journal.answered.insert(key.into())),
                "quit" => journal.is_review_ended = true,
                "alone" => journal.is_alone = true,
                "fatal" => drop(key.split_once('\t').map(|(key, end)| journal.fatal.insert(key.into(), end.into()))),
                _ => {}
            }
        }
        Ok(journal)
    }

    /// Writes a note. An error is ignored: it would only make the end of a child inexplicable.
    fn note(&self, word: &str, key: &str) {
        if let Some(file) = &self.file {
            let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
            let _ = file.write_all(format!("{word} {key}\n").as_bytes());
        }
    }

    /// Returns the result of `work` about a file, or an error if that has ended a child.
    pub fn watch<T>(&self, key: &str, work: impl FnOnce() -> T) -> Result<T, String> {
        if let Some(end) = self.fatal.get(key) {
            return Err(format!(
                "rebond {end} at this file; if there was enough memory, please report it with this file"
            ));
        }
        self.note("begin", key);
        let result = work();
        self.note("end", key);
        Ok(result)
    }

    /// Checks a case with `check`, unless it has ended a child.
    pub fn check(&self, case: &Case, check: impl FnOnce() -> CheckResult) -> CheckResult {
        let failed = |reason| CheckResult {
            line: case.line().cloned(),
            ..CheckResult::new(case.path().into(), Outcome::Failed(reason))
        };
        self.watch(&key(case.path(), case.line()), check).unwrap_or_else(failed)
    }

    /// Returns true if the line about a case was not printed yet, and notes that it is.
    pub fn is_first(&self, key: &str) -> bool {
        let is_first = !self.printed.contains(key);
        if is_first {
            self.note("printed", key);
        }
        is_first
    }

    /// Notes that the user of a review has answered about a file.
    pub fn answer(&self, key: &str) {
        self.note("answered", key);
    }

    /// Notes that the user of a review has ended it.
    pub fn end_review(&self) {
        self.note("quit", "");
    }

    /// Notes that the change of a case was accepted.
    pub fn accept(&self, key: &str) {
        self.note("accepted", key);
    }

    /// Returns true if an earlier child has accepted the change of a case.
    pub fn was_accepted(&self, key: &str) -> bool {
        self.accepted.contains(key)
    }
}

/// The key of a case in the journal, in one line.
pub fn key(path: &Path, line: Option<&ManifestLine>) -> String {
    let line = line.map_or(String::new(), |line| format!("{}:{}", line.manifest.display(), line.number));
    format!("{:?}", format!("{} {line}", path.display()))
}
