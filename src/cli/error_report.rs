use crate::{
    scene::{self, Excerpt, SceneError},
    text::{Printable, counted, is_unprintable},
};
use miette::{Diagnostic, LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::{fmt::Display, sync::Arc};

/// An error for the terminal: its message, the offending texts underlined, and help.
///
/// Its length is bounded, and control characters are escaped, whatever the error contains.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct ErrorReport {
    message: String,
    help: Option<String>,
    text: Option<ReportedText>,
    labels: Vec<LabeledSpan>,
}

/// The largest length of a message and of a help text, characters.
const MAX_MESSAGE: usize = 800;

/// The largest length of all reports of an error, bytes, as far as they depend on the error.
const MAX_REPORTS: usize = 8 << 10;

impl ErrorReport {
    /// The report of an error that refers to no part of a text.
    pub fn new(message: &impl Display, help: Option<&dyn Display>) -> ErrorReport {
        let help = help.map(|help| printable(&help.to_string()));
        ErrorReport { message: printable(&message.to_string()), help, text: None, labels: Vec::new() }
    }

    /// Adds a text to the message.
    pub fn append(&mut self, text: &str) {
        self.message += &printable(text);
    }

    /// The reports of a scene error, one for each error of the text. If they would be too long, the last one counts
    /// those that are left out.
    pub fn of_scene(error: &SceneError) -> Vec<ErrorReport> {
        let Some(diagnostics) = error.diagnostics() else {
            return vec![ErrorReport::new(error, help_without_text(error).as_ref().map(|help| help as &dyn Display))];
        };
        let text = diagnostics.excerpt().map(ReportedText::new);
        let mut reports = Vec::new();
        let (mut length, mut omitted) = (0, diagnostics.omitted());
        for (index, diagnostic) in diagnostics.listed().enumerate() {
            // The first message also says where the text is and how many errors it has.
            let message = if index == 0 { error.to_string() } else { diagnostic.to_string() };
            let report = ErrorReport::of_diagnostic(&message, diagnostic, text.as_ref());
            length += report.length();
            if length <= MAX_REPORTS || index == 0 { reports.push(report) } else { omitted += 1 }
        }
        if omitted > 0 {
            reports.push(ErrorReport::new(&format_args!("and {}", counted(omitted, "more error")), None));
        }
        reports
    }

    fn of_diagnostic(message: &str, diagnostic: &scene::Diagnostic, text: Option<&ReportedText>) -> ErrorReport {
        let shown = |span| text.map_or(0..0, |text| text.shown(span));
        let primary =
            LabeledSpan::new_primary_with_span(Some(diagnostic.kind.label().into()), shown(diagnostic.span.clone()));
        let earlier = diagnostic.earlier.clone();
        let earlier = earlier.map(|span| LabeledSpan::new_with_span(Some("first here".into()), shown(span)));
        ErrorReport {
            message: printable(message),
            help: Some(printable(&diagnostic.kind.help())),
            text: text.cloned(),
            labels: std::iter::once(primary).chain(earlier).collect(),
        }
    }

    /// An upper limit of the length of the parts that depend on the error, bytes.
    fn length(&self) -> usize {
        let context = |label: &LabeledSpan| {
            let contents = self.text.as_ref()?.read_span(label.inner(), 1, 1).ok()?;
            Some(contents.data().len())
        };
        let contexts: usize = self.labels.iter().filter_map(context).sum();
        self.message.len() + self.help.as_ref().map_or(0, String::len) + contexts
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

/// A text without control characters, whose middle is left out if it is long.
pub fn printable(text: &str) -> String {
    let length = text.chars().count();
    if length <= MAX_MESSAGE {
        return Printable(text).to_string();
    }
    let start: String = text.chars().take(MAX_MESSAGE * 3 / 4).collect();
    let end: String = text.chars().skip(length - MAX_MESSAGE / 4).collect();
    format!("{} … {}", Printable(&start), Printable(&end))
}

impl Diagnostic for ErrorReport {
    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.text.as_ref().map(|text| text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        match (&self.text, &self.labels[..]) {
            (None, _) | (_, []) => None,
            (Some(_), labels) => Some(Box::new(labels.iter().cloned())),
        }
    }
}

/// A text. Reports show the lines around an error, or parts of them if they are long.
#[derive(Clone, Debug)]
struct ReportedText {
    name: String,
    /// The number of the first line in the file, from 1.
    first_line: usize,
    /// The text with other characters of the same lengths in place of unprintable ones.
    text: Arc<str>,
}

/// The largest length of a text that is underlined, bytes.
const MAX_UNDERLINED: usize = 300;

/// The largest length of the text that is shown before and after it, bytes.
const MAX_CONTEXT: usize = 300;

impl ReportedText {
    fn new(excerpt: &Excerpt) -> ReportedText {
        let mut text = String::with_capacity(excerpt.text.len());
        for (index, character) in excerpt.text.char_indices() {
            let ends_line = || excerpt.text[index..].starts_with("\r\n");
            match character.len_utf8() {
                _ if !is_unprintable(character) || character == '\r' && ends_line() => text.push(character),
                length @ 1..=2 => text.extend(std::iter::repeat_n('?', length)),
                _ => text.push(char::REPLACEMENT_CHARACTER),
            }
        }
        let first_line = excerpt.line.max(1) as usize;
        ReportedText { name: printable(&excerpt.name), first_line, text: text.into() }
    }

    /// The part of a span that is underlined: all of it or, if it is long, its start.
    fn shown(&self, span: std::ops::Range<usize>) -> std::ops::Range<usize> {
        let start = self.text.floor_char_boundary(span.start);
        if span.len() <= MAX_UNDERLINED {
            return start..self.text.floor_char_boundary(span.end).max(start);
        }
        let end = self.text.floor_char_boundary(start + MAX_UNDERLINED / 4);
        let line = &self.text[start..end];
        start..start + line.find('\n').unwrap_or(line.len())
    }

    /// The range of the text around a span that may be shown. It begins and ends with whole lines if possible.
    fn around(&self, span: &SourceSpan) -> std::ops::Range<usize> {
        let (start, end) = (span.offset(), span.offset() + span.len());
        let from = self.text.ceil_char_boundary(start.saturating_sub(MAX_CONTEXT));
        let to = self.text.floor_char_boundary(end + MAX_CONTEXT);
        let is_line = from == 0 || self.text.as_bytes()[from - 1] == b'\n';
        let from = match self.text[from..start].find('\n') {
            Some(index) if !is_line => from + index + 1,
            Some(_) | None => from,
        };
        let to = match self.text[end..to].rfind('\n') {
            Some(index) if to < self.text.len() => end + index + 1,
            Some(_) | None => to,
        };
        from..to
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
        if span.len() > MAX_UNDERLINED || span.offset() + span.len() > self.text.len() {
            return Err(MietteError::OutOfBounds);
        }
        let range = self.around(span);
        let above = &self.text[..range.start];
        let line = above.bytes().filter(|&byte| byte == b'\n').count();
        let cut = range.start - above.rfind('\n').map_or(0, |index| index + 1);
        let found =
            self.text[range.clone()].read_span(&(span.offset() - range.start, span.len()).into(), before, after)?;
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            &self.text.as_bytes()[range.start + found.span().offset()..][..found.data().len()],
            (range.start + found.span().offset(), found.data().len()).into(),
            self.first_line - 1 + line + found.line(),
            found.column() + if found.line() == 0 { cut } else { 0 },
            line + found.line_count(),
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;
    use proptest::prelude::*;

    fn rendered(text: &str) -> String {
        let error = scene::parse("scene.toml", text).expect_err("an error");
        let reports = ErrorReport::of_scene(&error).into_iter();
        reports.map(|report| format!("{:?}", miette::Report::new(report))).collect()
    }

    #[test]
    fn a_report_lists_20_errors_and_counts_the_others() {
        let text = format!("[run]\nsteps = 10\n{}", "[[delete]]\nname = \"nobody\"\n".repeat(50));
        let report = rendered(&text);
        assert_eq!(report.matches("is alive at step 0").count(), 20);
        assert!(report.contains("and 30 more errors"), "{report}");
        assert!(!report.contains("Error:"), "{report}");
    }

    #[test]
    fn a_report_shows_the_part_of_a_long_line_around_the_error_and_its_place() {
        let text = format!("[run]\nsteps = 10\n[world]\nsize = [16.0, {}9.0, 1.0] # wide\n", " ".repeat(1 << 20));
        let report = rendered(&text);
        assert!(report.len() < 4000, "{} bytes", report.len());
        assert!(report.contains("scene.toml:4:8"), "{report}");
        let text = format!("[run]\nsteps = 10\n[world]\nsize = [16.0,{}{}]\n", " ".repeat(1 << 20), "x");
        let report = rendered(&text);
        assert!(report.contains(&format!("scene.toml:4:{}", 14 + (1 << 20))) && report.contains("x]"), "{report}");
    }

    #[test]
    fn control_characters_of_a_scene_are_not_printed() {
        for text in ["[run]\nsteps = 1 \u{1b}[31m\n", "[run]\nsteps = 1\n\"\\u001b[2J\u{202e}\" = 3\n"] {
            let report = rendered(text);
            assert!(!report.contains(['\u{202e}', '\u{9b}']), "{report:?}");
            assert!(!report.contains("\u{1b}[31m\n") && !report.contains("\u{1b}[2J"), "{report:?}");
        }
    }

    proptest! {
        /// Long texts, keys, values and lists of errors.
        #[test]
        fn reports_are_short_whatever_the_scene(
            parts in proptest::collection::vec(("[a-z\"=\\[\\]{}#. \n\u{e9}\u{1b}]{0,6}", 1_usize..4000), 1..40),
        ) {
            let text: String = parts.iter().map(|(part, count)| part.repeat(*count)).collect();
            if let Err(error) = scene::parse("scene.toml", &text) {
                let reports = ErrorReport::of_scene(&error).into_iter();
                let lengths = reports.map(|report| format!("{:?}", miette::Report::new(report)).len());
                prop_assert!(lengths.sum::<usize>() < 3 * MAX_REPORTS);
            }
        }
    }
}
