//! The review of changes one by one on a terminal.

use super::error::CommandError;
use super::output;
use super::supervisor::{self, Journal};
use crate::check::{self, Files, Outcome, carries_provenance, pending_path};
use std::collections::BTreeSet;
use std::fs;
#[cfg(any(unix, windows))]
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The answer about one change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The new content replaces the file.
    Accept,
    /// The file is kept, and new content beside it is removed.
    Reject,
    /// Everything is kept as it is.
    Skip,
}

/// A review in progress.
#[derive(Debug)]
pub struct Review<'a> {
    journal: &'a Journal,
    /// The keys of the files about which the user has answered.
    answered: BTreeSet<String>,
    /// True if the rest is skipped.
    is_ended: bool,
}

impl Review<'_> {
    /// Begins a review, or goes on with that of an earlier process.
    pub fn new(journal: &Journal) -> Review<'_> {
        Review { journal, answered: journal.answered.clone(), is_ended: journal.is_review_ended }
    }

    /// Asks about the new contents that failed assertions have left beside files. A file is replaced only if rebond has
    /// made it.
    pub fn ask_about_pending(&mut self, files: &Files) -> Result<(), CommandError> {
        for path in files.pending() {
            let pending = pending_path(path);
            if path.exists() && !carries_provenance(path) {
                let advice = "remove it if it may be replaced";
                output::print(&format!("{}: kept: it carries no rebond provenance; {advice}\n", path.display()))?;
                continue;
            }
            match self.prompt(path, &format!("{}: new content in {}", path.display(), pending.display()))? {
                Answer::Accept => {
                    fs::rename(&pending, path).map_err(CommandError::unwritable(path))?;
                    output::print(&format!("{}: accepted\n", path.display()))?;
                }
                Answer::Reject => {
                    remove_pending(path)?;
                    output::print(&format!("{}: rejected\n", path.display()))?;
                }
                Answer::Skip => {}
            }
        }
        Ok(())
    }

    /// Asks about the change of a file. At the end of standard input, the rest is skipped.
    pub fn ask(&mut self, path: &Path, outcome: &Outcome, shown: Option<PathBuf>) -> Result<Answer, CommandError> {
        let see = shown.map(|file| format!(" (see {})", file.display())).unwrap_or_default();
        let answer = self.prompt(path, &format!("{}: {outcome}{see}", path.display()))?;
        if answer == Answer::Reject {
            remove_pending(path)?;
        }
        Ok(answer)
    }

    /// Asks until the answer is understood. A file about which the user has answered is skipped.
    fn prompt(&mut self, path: &Path, question: &str) -> Result<Answer, CommandError> {
        let key = supervisor::key(&check::normalize(path), None);
        if self.is_ended || self.answered.contains(&key) {
            return Ok(Answer::Skip);
        }
        let answer = loop {
            output::print_to_stderr(&format!("{question}\n  (a)ccept, (r)eject, (s)kip or (q)uit? "));
            let line = read_line().map_err(CommandError::unreadable(Path::new("standard input")))?;
            match line.trim() {
                "a" | "accept" => break Answer::Accept,
                "r" | "reject" => break Answer::Reject,
                "s" | "skip" => break Answer::Skip,
                "q" | "quit" => self.is_ended = true,
                "" if line.is_empty() => {
                    output::print_to_stderr("\n");
                    self.is_ended = true;
                }
                _ => {}
            }
            if self.is_ended {
                self.journal.end_review();
                return Ok(Answer::Skip);
            }
        };
        self.journal.answer(&key);
        self.answered.insert(key);
        Ok(answer)
    }
}

/// Reads a line and nothing after it: if a case ends this process, the following lines are for the next one.
#[expect(clippy::unbuffered_bytes, reason = "a buffer would read ahead")]
fn read_line() -> io::Result<String> {
    let mut line = Vec::new();
    for byte in standard_input()?.bytes() {
        line.push(byte?);
        if line.ends_with(b"\n") {
            break;
        }
    }
    Ok(String::from_utf8_lossy(&line).into_owned())
}

#[cfg(unix)]
fn standard_input() -> io::Result<File> {
    use std::os::fd::AsFd;
    io::stdin().as_fd().try_clone_to_owned().map(File::from)
}

#[cfg(windows)]
fn standard_input() -> io::Result<File> {
    use std::os::windows::io::AsHandle;
    io::stdin().as_handle().try_clone_to_owned().map(File::from)
}

/// Other systems start no process after this one.
#[cfg(not(any(unix, windows)))]
fn standard_input() -> io::Result<io::StdinLock<'static>> {
    Ok(io::stdin().lock())
}

/// Removes new content beside a file, if there is any.
pub fn remove_pending(path: &Path) -> Result<(), CommandError> {
    let pending = pending_path(path);
    match fs::remove_file(&pending) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(CommandError::unwritable(&pending)(error)),
        Ok(()) | Err(_) => Ok(()),
    }
}
