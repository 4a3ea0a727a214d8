use crate::scene::{Diagnostic, Excerpt, SceneError};
use crate::text::counted;
use miette::{LabeledSpan, MietteDiagnostic, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::fmt::Display;

/// A scene error for the terminal, with the offending texts underlined and with help.
#[derive(Debug, thiserror::Error)]
#[error("{error}")]
pub struct SceneReport {
    error: SceneError,
    text: Option<ReportedText>,
    help: Option<String>,
    labels: Vec<LabeledSpan>,
    /// The other errors of the same text.
    related: Vec<MietteDiagnostic>,
}

#[derive(Debug)]
struct ReportedText(Excerpt);

impl From<SceneError> for SceneReport {
    fn from(error: SceneError) -> SceneReport {
        let Some(diagnostics) = error.diagnostics() else {
            let help = help_without_text(&error).map(String::from);
            return SceneReport { error, text: None, help, labels: Vec::new(), related: Vec::new() };
        };
        let mut listed = diagnostics.listed();
        let first = listed.next();
        let mut related: Vec<MietteDiagnostic> = listed.map(related_report).collect();
        if diagnostics.omitted() > 0 {
            related.push(MietteDiagnostic::new(format!("and {}", counted(diagnostics.omitted(), "more error"))));
        }
        SceneReport {
            text: diagnostics.excerpt().cloned().map(ReportedText),
            help: first.map(|first| first.kind.help()),
            labels: first.map_or(Vec::new(), labels),
            related,
            error,
        }
    }
}

/// The help of an error that refers to no part of a text.
fn help_without_text(error: &SceneError) -> Option<&'static str> {
    match error {
        SceneError::TooLong { .. } => Some("use [[scatter]] to create many bodies instead of listing them"),
        SceneError::NotText { .. } => Some("a scene is a TOML file; the name of a recording ends in .mcap"),
        SceneError::Unreadable { .. }
        | SceneError::Override { .. }
        | SceneError::Scene(_)
        | SceneError::Event { .. } => None,
    }
}

fn related_report(diagnostic: &Diagnostic) -> MietteDiagnostic {
    MietteDiagnostic::new(diagnostic.to_string()).with_help(diagnostic.kind.help()).with_labels(labels(diagnostic))
}

fn labels(diagnostic: &Diagnostic) -> Vec<LabeledSpan> {
    let primary = LabeledSpan::new_primary_with_span(Some(diagnostic.kind.label().into()), diagnostic.span.clone());
    let earlier = diagnostic.earlier.clone();
    let earlier = earlier.map(|span| LabeledSpan::new_with_span(Some("first here".into()), span));
    std::iter::once(primary).chain(earlier).collect()
}

impl miette::Diagnostic for SceneReport {
    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.text.as_ref().map(|text| text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        match self.labels[..] {
            [] => None,
            [..] => Some(Box::new(self.labels.iter().cloned())),
        }
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn miette::Diagnostic> + 'a>> {
        Some(Box::new(self.related.iter().map(|diagnostic| diagnostic as &dyn miette::Diagnostic)))
    }
}

/// Numbers the lines as in the file of the text.
impl SourceCode for ReportedText {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let ReportedText(excerpt) = self;
        let found = excerpt.text.read_span(span, before, after)?;
        Ok(Box::new(MietteSpanContents::new_named(
            excerpt.name.clone(),
            found.data(),
            *found.span(),
            excerpt.line.saturating_sub(1) as usize + found.line(),
            found.column(),
            found.line_count(),
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    #[test]
    fn a_report_lists_20_errors_and_counts_the_others() {
        let text = format!("[run]\nsteps = 10\n{}", "[[delete]]\nname = \"nobody\"\n".repeat(50));
        let error = scene::parse("scene.toml", &text).unwrap_err();
        let report = format!("{:?}", miette::Report::new(SceneReport::from(error)));
        assert_eq!(report.matches("is alive at step 0").count(), 20);
        assert!(report.contains("and 30 more errors"), "{report}");
    }
}
