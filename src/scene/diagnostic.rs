//! Errors of scenes and of live events, and their collection while a text is read.

use super::{InputLocation, SceneSource};
use crate::text::counted;
use std::{
    cell::RefCell,
    fmt::{self, Display, Formatter},
    io,
    ops::Range,
    path::PathBuf,
};

/// One error in the text of a scene, of an event line or of `--set` overrides.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{kind}")]
pub struct Diagnostic {
    /// The rule of the format that is violated.
    pub kind: DiagnosticKind,
    /// The offending text, as a range of bytes.
    pub span: Range<usize>,
    /// The earlier text that it conflicts with, if any.
    pub earlier: Option<Range<usize>>,
}

/// The kind of an error in the text of a scene, of an event line or of `--set` overrides.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DiagnosticKind {
    /// The text is not valid TOML or JSON.
    #[error("invalid {language}: {message}")]
    Syntax {
        /// `"TOML"` or `"JSON"`.
        language: &'static str,
        /// The message of its parser.
        message: String,
    },
    /// The format has no such key.
    #[error("unknown key `{key}`")]
    UnknownKey {
        /// The key as written, after the name of its table.
        key: String,
        /// The key that was probably meant.
        nearest: Option<&'static str>,
        /// All keys of the table.
        accepts: Vec<&'static str>,
    },
    /// A required key is missing.
    #[error("`{key}` is missing")]
    MissingKey {
        /// The key, after the name of its table.
        key: String,
        /// A description of the values it accepts.
        accepts: &'static str,
    },
    /// A key is given twice.
    #[error("`{key}` is given twice")]
    DuplicateKey {
        /// The key, after the name of its table.
        key: String,
    },
    /// Two keys that exclude each other are both given.
    #[error("`{}` and `{}` cannot both be given", keys[0], keys[1])]
    ExclusiveKeys {
        /// The keys, after the names of their tables.
        keys: [&'static str; 2],
    },
    /// The value of a key is not accepted.
    #[error("`{key}` cannot be {found}")]
    InvalidValue {
        /// The key, after the name of its table.
        key: String,
        /// The value, shortened.
        found: String,
        /// A description of the accepted values.
        accepts: &'static str,
    },
    /// An event line contains no event or several events.
    #[error("an event line must contain exactly one of spawn, delete and click")]
    NotOneEvent,
    /// A pair of materials is given twice, possibly in the other order.
    #[error("the pair {pair:?} is given twice")]
    DuplicatePair {
        /// The pair as written.
        pair: String,
    },
    /// A limit of the format is exceeded.
    #[error("the scene has more than {limit} {what}")]
    TooMany {
        /// A plural noun.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
    /// An event is scheduled after the last state.
    #[error("step {step} is after the last step of the run, {last}")]
    AfterLastStep {
        /// The step of the event.
        step: u64,
        /// The last step.
        last: u64,
    },
    /// An image file cannot be used.
    #[error("the image {image:?} cannot be used: {reason}")]
    Image {
        /// The path as written.
        image: String,
        /// The reason.
        reason: String,
    },
    /// A body of that name is already alive.
    #[error("the name {name:?} is already in use at step {step}")]
    NameTaken {
        /// The name.
        name: String,
        /// The step of the spawn.
        step: u64,
    },
    /// No body of that name is alive.
    #[error("no body named {name:?} is alive at step {step}")]
    NotAlive {
        /// The name.
        name: String,
        /// The step of the delete.
        step: u64,
        /// The first few names that are alive at that step.
        alive: Vec<String>,
    },
    /// The bodies of a scatter do not all fit into its region.
    #[error("only {fitted} of {count} bodies fit into the region")]
    NoRoom {
        /// The number of bodies that were placed.
        fitted: u64,
        /// The number of bodies of the scatter.
        count: u64,
        /// The number of random positions tried for the next body.
        tries: u64,
    },
    /// An override names an element of an array of tables that the scene does not have.
    #[error("there is no [[{table}]] {name:?}")]
    NoSuchTable {
        /// The array of tables.
        table: String,
        /// The name or number as typed.
        name: String,
        /// The first few names (numbers for tables without a name) that exist.
        known: Vec<String>,
    },
    /// An override names several elements of an array of tables.
    #[error("{count} [[{table}]] have the name {name:?}")]
    AmbiguousName {
        /// The array of tables.
        table: String,
        /// The name as typed.
        name: String,
        /// The number of elements of that name.
        count: usize,
        /// The keys by number that the override may mean, of the first few elements.
        choices: Vec<String>,
    },
    /// An override gives a value to a table.
    #[error("`{key}` is a table, not a value")]
    NotAValue {
        /// The path as typed.
        key: String,
    },
    /// An override names a key inside a value that is not a table.
    #[error("`{key}` is a value and has no keys")]
    NotATable {
        /// The path up to that value.
        key: String,
    },
}

impl Diagnostic {
    /// An error at `span`.
    pub(super) fn new(kind: DiagnosticKind, span: Range<usize>) -> Diagnostic {
        Diagnostic { kind, span, earlier: None }
    }

    /// Adds the earlier text that this one conflicts with.
    pub(super) fn conflicting_with(self, earlier: Range<usize>) -> Diagnostic {
        Diagnostic { earlier: Some(earlier), ..self }
    }
}

impl DiagnosticKind {
    /// A description of the values that would be accepted instead.
    pub fn help(&self) -> String {
        match self {
            DiagnosticKind::Syntax { language: "TOML", message } if message.contains("duplicate key") => {
                "remove one of the two; a table that can be repeated has two brackets, such as [[spawn]]".into()
            }
            DiagnosticKind::Syntax { language: "TOML", .. } => "see https://toml.io for the syntax".into(),
            DiagnosticKind::Syntax { .. } => {
                "write one JSON object per line, for example {\"delete\": {\"name\": \"b\"}}".into()
            }
            DiagnosticKind::UnknownKey { nearest: Some(nearest), accepts, .. } => {
                format!("did you mean `{nearest}`? Valid keys: {}", accepts.join(", "))
            }
            DiagnosticKind::UnknownKey { nearest: None, accepts, .. } => format!("valid keys: {}", accepts.join(", ")),
            DiagnosticKind::MissingKey { accepts, .. } => format!("add it: {accepts}"),
            DiagnosticKind::DuplicateKey { .. } => "remove one of the two".into(),
            DiagnosticKind::ExclusiveKeys { keys } => format!("keep either `{}` or `{}`", keys[0], keys[1]),
            DiagnosticKind::InvalidValue { accepts, .. } => format!("expected {accepts}"),
            DiagnosticKind::NotOneEvent => {
                "write one event per line, for example {\"delete\": {\"name\": \"b\"}}".into()
            }
            DiagnosticKind::DuplicatePair { .. } => {
                "remove one of the two: \"a/b\" and \"b/a\" are the same pair".into()
            }
            DiagnosticKind::TooMany { what, limit } => format!("a scene may have up to {limit} {what}"),
            DiagnosticKind::AfterLastStep { last, .. } => {
                format!("use a step from 0 to {last}, or increase the number of steps of the run")
            }
            DiagnosticKind::Image { .. } => "use a PNG file of at most 4 MiB and 4096 × 4096 pixels, whose path is relative to the scene; live events may use the images of the scene".into(),
            DiagnosticKind::NameTaken { .. } => "choose another name, or delete the body of that name first".into(),
            DiagnosticKind::NotAlive { alive, .. } if alive.is_empty() => "no body is alive at that step".into(),
            DiagnosticKind::NotAlive { alive, .. } => format!("alive at that step: {}", alive.join(", ")),
            DiagnosticKind::NoRoom { tries, .. } => format!(
                "the next body overlapped another one at {tries} random positions: use fewer or smaller bodies, a larger region, or overlap = true"
            ),
            DiagnosticKind::NoSuchTable { table, known, .. } if known.is_empty() => {
                format!("the scene has no [[{table}]]")
            }
            DiagnosticKind::NoSuchTable { known, .. } => format!("use a name or a number: {}", known.join(", ")),
            DiagnosticKind::AmbiguousName { choices, .. } => {
                format!("choose one by its position: {}", choices.join(", "))
            }
            DiagnosticKind::NotAValue { key } => format!("name one of its keys: {key}.KEY=VALUE"),
            DiagnosticKind::NotATable { key } => format!("set all of it: {key}=VALUE"),
        }
    }

    /// The label of the offending text.
    pub fn label(&self) -> &'static str {
        match self {
            DiagnosticKind::Syntax { .. } => "here",
            DiagnosticKind::UnknownKey { nearest: Some(_), .. } => "misspelled",
            DiagnosticKind::UnknownKey { nearest: None, .. } => "unknown",
            DiagnosticKind::MissingKey { .. } => "missing here",
            DiagnosticKind::DuplicateKey { .. } | DiagnosticKind::DuplicatePair { .. } => "again here",
            DiagnosticKind::ExclusiveKeys { .. } => "conflicting key",
            DiagnosticKind::InvalidValue { .. } => "not accepted",
            DiagnosticKind::NotOneEvent => "not one event",
            DiagnosticKind::TooMany { .. } => "too many",
            DiagnosticKind::AfterLastStep { .. } => "too late",
            DiagnosticKind::Image { .. } => "not usable",
            DiagnosticKind::NameTaken { .. } => "in use",
            DiagnosticKind::NotAlive { .. } => "not alive",
            DiagnosticKind::NoRoom { .. } => "no room",
            DiagnosticKind::NoSuchTable { .. } => "does not exist",
            DiagnosticKind::AmbiguousName { .. } => "ambiguous",
            DiagnosticKind::NotAValue { .. } => "a table",
            DiagnosticKind::NotATable { .. } => "a value",
        }
    }
}

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
/// then an [`ErrorReported`], so that nothing that depends on it is checked or reported.
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
            (None, Err(ErrorReported(()))) => unreachable!("an ErrorReported comes from a report"),
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
