//! The errors of scenes and of live events, and their collection while a text is read.

use super::{Diagnostic, DiagnosticKind, InputLocation, SceneSource};
use crate::text::counted;
use std::{
    cell::RefCell,
    fmt::{self, Display, Formatter},
    io,
    path::PathBuf,
};

/// The error of a scene or of a line of live events that is refused.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("cannot read the scene {}: {error}", path.display())]
    Unreadable {
        /// The path as given.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
    },
    /// The file is larger than a recording can carry.
    #[error("the scene {} is longer than {limit} bytes, the most that a recording can carry", path.display())]
    TooLong {
        /// The path as given.
        path: PathBuf,
        /// The limit, bytes.
        limit: u64,
    },
    /// The file is not UTF-8 text.
    #[error("the scene {} is not UTF-8 text: byte {byte} is invalid", path.display())]
    NotText {
        /// The path as given.
        path: PathBuf,
        /// The number of valid bytes before the invalid one.
        byte: usize,
    },
    /// An override cannot be applied to the scene.
    #[error("cannot apply --set to the scene {}: {diagnostics}", path.display())]
    Override {
        /// The path as given.
        path: PathBuf,
        /// The errors; their text has one `--set` option per line.
        diagnostics: Box<Diagnostics>,
    },
    /// The scene violates the format.
    #[error(transparent)]
    Scene(Box<Diagnostics>),
    /// A line of events violates the format, or its event is impossible at its step.
    #[error("line {line} of the events: {diagnostics}")]
    Event {
        /// The number of the line, from 1.
        line: u64,
        /// The errors.
        diagnostics: Box<Diagnostics>,
    },
}

impl SceneError {
    /// The error of an input that turned out to be impossible during the run.
    pub fn at(source: &SceneSource, location: &InputLocation, kind: DiagnosticKind) -> SceneError {
        match location {
            InputLocation::Scene(span) => {
                let excerpt = Excerpt { name: source.path.clone(), line: 1, text: source.text.clone() };
                let diagnostic = Diagnostic::new(kind, span.clone());
                SceneError::Scene(Box::new(Diagnostics::single(diagnostic, Some(excerpt))))
            }
            InputLocation::EventLine(line) => {
                let diagnostics = Diagnostics::single(Diagnostic::new(kind, 0..0), None);
                SceneError::Event { line: *line, diagnostics: Box::new(diagnostics) }
            }
        }
    }

    /// The errors in the text, or `None` if the text could not be read.
    pub fn diagnostics(&self) -> Option<&Diagnostics> {
        match self {
            SceneError::Scene(diagnostics)
            | SceneError::Event { diagnostics, .. }
            | SceneError::Override { diagnostics, .. } => Some(diagnostics),
            SceneError::Unreadable { .. } | SceneError::TooLong { .. } | SceneError::NotText { .. } => None,
        }
    }
}

/// The independent errors of one text, in the order of the text: at least one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostics {
    excerpt: Option<Excerpt>,
    first: Diagnostic,
    others: Vec<Diagnostic>,
    /// The number of errors beyond [`MAX_LISTED`].
    omitted: u64,
}

/// The largest number of errors that are listed; further ones are counted.
const MAX_LISTED: usize = 20;

impl Diagnostics {
    /// A single error.
    pub(super) fn single(diagnostic: Diagnostic, excerpt: Option<Excerpt>) -> Diagnostics {
        Diagnostics { excerpt, first: diagnostic, others: Vec::new(), omitted: 0 }
    }

    /// The first errors, at most 20.
    pub fn listed(&self) -> impl Iterator<Item = &Diagnostic> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// The number of errors that are not listed.
    pub fn omitted(&self) -> u64 {
        self.omitted
    }

    /// The text that the spans refer to, unless it is no longer available.
    pub fn excerpt(&self) -> Option<&Excerpt> {
        self.excerpt.as_ref()
    }
}

/// The message of the first error and the number of the others.
impl Display for Diagnostics {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let others = self.others.len() as u64 + self.omitted;
        match others {
            0 => write!(out, "{}", self.first),
            _ => write!(out, "{} (and {})", self.first, counted(others, "more error")),
        }
    }
}

impl std::error::Error for Diagnostics {}

/// The text that an error message shows, with its name and its position in its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// The name of the text.
    pub name: String,
    /// The number of its first line in its file, from 1.
    pub line: u64,
    /// The text.
    pub text: String,
}

/// Collects the independent errors of one text while it is read.
///
/// A reader reports an error and continues with the next key. The value that it could not read is
/// then a [`ErrorReported`], so that nothing that depends on it is checked or reported.
#[derive(Debug, Default)]
pub struct Reporter(RefCell<Collected>);

/// Proof that an error was reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ErrorReported(());

#[derive(Debug, Default)]
struct Collected {
    /// The first [`MAX_LISTED`] errors in the order of the text.
    listed: Vec<Diagnostic>,
    omitted: u64,
}

impl Reporter {
    /// Adds an error.
    pub fn report(&self, diagnostic: Diagnostic) -> ErrorReported {
        let Collected { listed, omitted } = &mut *self.0.borrow_mut();
        let index = listed.partition_point(|other| other.span.start <= diagnostic.span.start);
        listed.insert(index, diagnostic);
        if listed.len() > MAX_LISTED {
            listed.pop();
            *omitted += 1;
        }
        ErrorReported(())
    }

    /// Returns `value`, or all errors if any was reported.
    pub fn finish<T>(
        self,
        value: Result<T, ErrorReported>,
        excerpt: impl FnOnce() -> Excerpt,
    ) -> Result<T, Box<Diagnostics>> {
        let Collected { listed, omitted } = self.0.into_inner();
        let mut listed = listed.into_iter();
        match (listed.next(), value) {
            (None, Ok(value)) => Ok(value),
            (None, Err(ErrorReported(()))) => unreachable!("a ErrorReported comes from a report"),
            (Some(first), Ok(_) | Err(ErrorReported(()))) => {
                let others = listed.collect();
                Err(Box::new(Diagnostics { excerpt: Some(excerpt()), first, others, omitted }))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::DiagnosticKind;

    fn diagnostics(starts: impl Iterator<Item = usize>) -> Diagnostics {
        let reporter = Reporter::default();
        let mut last = None;
        for start in starts {
            let kind = DiagnosticKind::DuplicateKey { key: format!("k{start}") };
            last = Some(reporter.report(Diagnostic::new(kind, start..start + 1)));
        }
        let excerpt = || Excerpt { name: "text".into(), line: 1, text: " ".repeat(100) };
        *reporter.finish(Err::<(), _>(last.unwrap()), excerpt).unwrap_err()
    }

    #[test]
    fn errors_are_listed_in_the_order_of_the_text() {
        let diagnostics = diagnostics([7, 3, 5].into_iter());
        let starts: Vec<usize> = diagnostics.listed().map(|diagnostic| diagnostic.span.start).collect();
        assert_eq!(starts, [3, 5, 7]);
        assert_eq!(diagnostics.to_string(), "`k3` is given twice (and 2 more errors)");
    }

    #[test]
    fn at_most_20_errors_are_listed_and_the_others_are_counted() {
        let diagnostics = diagnostics((0..33).rev());
        let starts: Vec<usize> = diagnostics.listed().map(|diagnostic| diagnostic.span.start).collect();
        assert_eq!(starts, (0..20).collect::<Vec<_>>());
        assert_eq!(diagnostics.omitted(), 13);
    }
}
