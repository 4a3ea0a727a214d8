//! Output for GitHub Actions: annotations of files, and the summary of a step.

use crate::check::{CheckResult, Decision};
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::Path;

/// Returns the workflow command that annotates a file with a result.
pub fn annotation(result: &CheckResult) -> String {
    let (path, line) = match &result.line {
        Some(line) if !result.path.is_file() => (&*line.manifest, format!(",line={}", line.number)),
        Some(line) if *line.manifest == *result.path => (&*line.manifest, format!(",line={}", line.number)),
        _ => (result.path.as_path(), String::new()),
    };
    let workspace = std::env::var_os("GITHUB_WORKSPACE");
    let path = workspace.and_then(|workspace| path.strip_prefix(workspace).ok()).unwrap_or(path);
    let title = format!("{}: {}", result.path.display(), result.outcome.word());
    let (path, title) = (property(&path.display().to_string()), property(&title));
    format!("::error file={path}{line},title={title}::{}\n", data(&result.outcome.to_string()))
}

/// Escapes the message of a workflow command.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// Escapes the value of a property of a workflow command.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

/// The summary of a step: a table of all differences in Markdown.
#[derive(Debug, Default)]
pub struct StepSummary {
    rows: Vec<String>,
    omitted: u64,
}

impl StepSummary {
    /// Adds a row.
    pub fn add(&mut self, result: &CheckResult, decision: &Decision) {
        // GitHub refuses summaries of more than 1 MiB.
        const MAX_ROWS: usize = 500;
        if self.rows.len() == MAX_ROWS {
            self.omitted += 1;
            return;
        }
        let accept = match decision {
            Decision::Acceptable(command) => format!("`{}`", command.replace('`', "'")),
            Decision::Accepted => "accepted".into(),
            Decision::Refused(reason) => cell(reason),
            Decision::NothingToAccept => String::new(),
        };
        let accept = accept.replace('|', "\\|");
        let path = cell(&result.path.display().to_string());
        self.rows.push(format!("| {path} | {} | {accept} |\n", cell(&result.outcome.to_string())));
    }

    /// Appends the summary to the file that `GITHUB_STEP_SUMMARY` names, if it is set.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, verdict: &str) -> io::Result<()> {
        let Some(path) = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|path| !path.is_empty()) else { return Ok(()) };
        let mut file = OpenOptions::new().create(true).append(true).open(Path::new(&path))?;
        file.write_all(self.markdown(verdict).as_bytes())
    }

    fn markdown(&self, verdict: &str) -> String {
        let mut text = format!("## rebond check\n\n{}\n\n", cell(verdict));
        if !self.rows.is_empty() {
            text += "| file | result | accept |\n|---|---|---|\n";
            text += &self.rows.concat();
            text += "\n";
        }
        if self.omitted > 0 {
            text += &format!("… and {} more.\n\n", self.omitted);
        }
        text
    }
}

/// The start of a text, in one line, with the characters escaped that mean something in Markdown and HTML.
fn cell(text: &str) -> String {
    const MAX: usize = 600;
    let mut escaped = String::new();
    for character in text.chars().take(MAX) {
        match character {
            '\n' | '\r' | '\t' => escaped.push(' '),
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '#' | '&' | '~' => {
                escaped.push('\\');
                escaped.push(character);
            }
            character => escaped.push(character),
        }
    }
    if text.chars().nth(MAX).is_some() { escaped + "…" } else { escaped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::Outcome;

    fn failed(path: &str, reason: &str) -> CheckResult {
        CheckResult::new(path.into(), Outcome::Failed(reason.into()))
    }

    #[test]
    fn annotations_escape_characters_that_end_a_property_or_a_command() {
        let found = annotation(&failed("a,b:c.png", "100 %\nnext: line"));
        assert_eq!(found, "::error file=a%2Cb%3Ac.png,title=a%2Cb%3Ac.png%3A failed::failed: 100 %25%0Anext: line\n");
    }

    #[test]
    fn the_table_has_one_row_per_difference_for_any_texts() {
        let mut summary = StepSummary::default();
        summary.add(&failed("a|b.png", "<b>\n|x|"), &Decision::Acceptable("rebond check 'a|b.png' --update".into()));
        let text = summary.markdown("not the same: 1 of 2");
        let rows: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).collect();
        assert_eq!(rows[2], "| a\\|b.png | failed: \\<b\\> \\|x\\| | `rebond check 'a\\|b.png' --update` |");
        (0..700).for_each(|_| summary.add(&failed("a", "b"), &Decision::NothingToAccept));
        let text = summary.markdown("many");
        assert!(text.contains("… and 201 more.") && text.len() < 1 << 20);
    }
}
