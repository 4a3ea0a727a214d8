use super::{Diagnostic, DiagnosticKind, Diagnostics, InputLocation, SceneSource};
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::{io, path::PathBuf};

/// The error of a scene or of a line of live events that is refused.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
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
    #[diagnostic(help("use [[scatter]] to create many bodies instead of listing them"))]
    TooLong {
        /// The path as given.
        path: PathBuf,
        /// The limit, bytes.
        limit: u64,
    },
    /// The file is not UTF-8 text.
    #[error("the scene {} is not UTF-8 text: byte {byte} is invalid", path.display())]
    #[diagnostic(help("a scene is a TOML file; the name of a recording ends in .mcap"))]
    NotText {
        /// The path as given.
        path: PathBuf,
        /// The number of valid bytes before the invalid one.
        byte: usize,
    },
    /// The scene has no place for an override.
    #[error("cannot apply --set to the scene {}: {diagnostics}", path.display())]
    #[diagnostic(forward(diagnostics))]
    Override {
        /// The path as given.
        path: PathBuf,
        /// The errors; their text has one `--set` option per line.
        diagnostics: Box<Diagnostics>,
    },
    /// The scene violates the format.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(Box<Diagnostics>),
    /// A line of events violates the format, or its event is impossible at its step.
    #[error("line {line} of the events: {diagnostics}")]
    #[diagnostic(forward(diagnostics))]
    Event {
        /// The number of the line, from 1.
        line: u64,
        /// The errors.
        diagnostics: Box<Diagnostics>,
    },
}

/// A text as error messages show it, with its name and its position in its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// The name of the text.
    pub name: String,
    /// The number of its first line in its file, from 1.
    pub line: u64,
    /// The text.
    pub text: String,
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

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let found = self.text.read_span(span, before, after)?;
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            found.data(),
            *found.span(),
            self.line.saturating_sub(1) as usize + found.line(),
            found.column(),
            found.line_count(),
        )))
    }
}
