//! The review of changes one by one on a terminal.

use super::error::CommandError;
use super::output;
use crate::check::{Files, Outcome, carries_provenance, pending_path};
use std::fs;
use std::io::{self, BufRead};
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Review {
    /// Each change is asked about.
    Asking,
    /// The rest is skipped.
    Ended,
}

impl Review {
    /// Asks about the change of a file. At the end of standard input, the rest is skipped.
    pub fn ask(&mut self, path: &Path, outcome: &Outcome, shown: Option<PathBuf>) -> Result<Answer, CommandError> {
        let see = shown.map(|file| format!(" (see {})", file.display())).unwrap_or_default();
        let answer = self.prompt(&format!("{}: {outcome}{see}", path.display()))?;
        if answer == Answer::Reject {
            remove_pending(path)?;
        }
        Ok(answer)
    }

    fn prompt(&mut self, question: &str) -> Result<Answer, CommandError> {
        if *self == Review::Ended {
            return Ok(Answer::Skip);
        }
        loop {
            output::warn(&format!("{question}\n  (a)ccept, (r)eject, (s)kip or (q)uit? "));
            let mut line = String::new();
            let read = io::stdin().lock().read_line(&mut line);
            if read.map_err(CommandError::unreadable(Path::new("standard input")))? == 0 {
                output::warn("\n");
                *self = Review::Ended;
                return Ok(Answer::Skip);
            }
            match line.trim() {
                "a" | "accept" => return Ok(Answer::Accept),
                "r" | "reject" => return Ok(Answer::Reject),
                "s" | "skip" => return Ok(Answer::Skip),
                "q" | "quit" => {
                    *self = Review::Ended;
                    return Ok(Answer::Skip);
                }
                _ => {}
            }
        }
    }
}

/// Asks about the new contents that failed assertions have left beside files. A file is replaced only if rebond has made
/// it.
pub fn pending(files: &Files) -> Result<(), CommandError> {
    let mut review = Review::Asking;
    for path in files.pending() {
        let pending = pending_path(path);
        if path.exists() && !carries_provenance(path) {
            let advice = "remove it if it may be replaced";
            output::print(&format!("{}: kept: it carries no rebond provenance; {advice}\n", path.display()))?;
            continue;
        }
        match review.prompt(&format!("{}: new content in {}", path.display(), pending.display()))? {
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

/// Removes new content beside a file, if there is any.
pub fn remove_pending(path: &Path) -> Result<(), CommandError> {
    let pending = pending_path(path);
    match fs::remove_file(&pending) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(CommandError::unwritable(&pending)(error)),
        Ok(()) | Err(_) => Ok(()),
    }
}
