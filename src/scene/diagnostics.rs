use super::{Diagnostic, Excerpt};
use crate::counted::counted;
use miette::{LabeledSpan, SourceCode};
use std::{
    cell::RefCell,
    fmt::{self, Display, Formatter},
};

/// The independent errors of one text, in the order of the text: at least one.
///
/// As a [`miette::Diagnostic`] it is its first error, with the others as related ones.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostics {
    excerpt: Option<Excerpt>,
    first: Diagnostic,
    others: Vec<Diagnostic>,
    omitted: Option<Omitted>,
}

/// The number of errors beyond [`MAX_LISTED`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[error("and {}", counted(*.0, "more error"))]
struct Omitted(u64);

/// The largest number of errors that are listed; further ones are counted.
const MAX_LISTED: usize = 20;

impl Diagnostics {
    /// A single error.
    pub(super) fn single(diagnostic: Diagnostic, excerpt: Option<Excerpt>) -> Diagnostics {
        Diagnostics { excerpt, first: diagnostic, others: Vec::new(), omitted: None }
    }

    /// The first errors, at most 20.
    pub fn listed(&self) -> impl Iterator<Item = &Diagnostic> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// The number of errors that are not listed.
    pub fn omitted(&self) -> u64 {
        self.omitted.as_ref().map_or(0, |omitted| omitted.0)
    }

    /// The text that the spans refer to, unless it is no longer available.
    pub fn excerpt(&self) -> Option<&Excerpt> {
        self.excerpt.as_ref()
    }
}

/// The message of the first error and the number of the others.
impl Display for Diagnostics {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let others = self.others.len() as u64 + self.omitted();
        match others {
            0 => write!(out, "{}", self.first),
            _ => write!(out, "{} (and {})", self.first, counted(others, "more error")),
        }
    }
}

impl std::error::Error for Diagnostics {}

impl miette::Diagnostic for Diagnostics {
    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        miette::Diagnostic::help(&self.first)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| excerpt as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        miette::Diagnostic::labels(&self.first)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn miette::Diagnostic> + 'a>> {
        let others = self.others.iter().map(|diagnostic| diagnostic as &dyn miette::Diagnostic);
        let omitted = self.omitted.iter().map(|omitted| omitted as &dyn miette::Diagnostic);
        Some(Box::new(others.chain(omitted)))
    }
}

/// Collects the independent errors of one text while it is read.
///
/// A reader reports an error and continues with the next key. The value that it could not read is
/// then a [`Reported`], so that nothing that depends on it is checked or reported.
#[derive(Debug, Default)]
pub struct Reporter(RefCell<Collected>);

/// Proof that an error was reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reported(());

#[derive(Debug, Default)]
struct Collected {
    /// The first [`MAX_LISTED`] errors in the order of the text.
    listed: Vec<Diagnostic>,
    omitted: u64,
}

impl Reporter {
    /// Adds an error.
    pub fn report(&self, diagnostic: Diagnostic) -> Reported {
        let Collected { listed, omitted } = &mut *self.0.borrow_mut();
        let index = listed.partition_point(|other| other.span.start <= diagnostic.span.start);
        listed.insert(index, diagnostic);
        if listed.len() > MAX_LISTED {
            listed.pop();
            *omitted += 1;
        }
        Reported(())
    }

    /// Returns `value`, or all errors if any was reported.
    pub fn finish<T>(self, value: Result<T, Reported>, excerpt: impl FnOnce() -> Excerpt) -> Result<T, Diagnostics> {
        let Collected { listed, omitted } = self.0.into_inner();
        let mut listed = listed.into_iter();
        match (listed.next(), value) {
            (None, Ok(value)) => Ok(value),
            (None, Err(Reported(()))) => unreachable!("a Reported comes from a report"),
            (Some(first), Ok(_) | Err(Reported(()))) => Err(Diagnostics {
                excerpt: Some(excerpt()),
                first,
                others: listed.collect(),
                omitted: (omitted > 0).then_some(Omitted(omitted)),
            }),
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
        reporter.finish(Err::<(), _>(last.unwrap()), excerpt).unwrap_err()
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
        let report = format!("{:?}", miette::Report::new(diagnostics));
        assert!(report.contains("and 13 more errors"), "{report}");
    }
}
