use std::{io, path::PathBuf};

use miette::{Diagnostic, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

use super::{Fault, Place, SceneSource, refusal::Refusal};

/// Why a scene or a line of events is refused.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("cannot read the scene {}: {error}", path.display())]
    Unreadable {
        /// As the user named it.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// The file is larger than a recording can carry.
    #[error("the scene {} is longer than {limit} bytes, the most a recording can carry", path.display())]
    #[diagnostic(help("let [[scatter]] make the bodies instead of listing them"))]
    TooLong {
        /// As the user named it.
        path: PathBuf,
        /// The most that is read, bytes.
        limit: u64,
    },
    /// The file is no text.
    #[error("the scene {} is not UTF-8 text: byte {byte} cannot stand there", path.display())]
    #[diagnostic(help("a scene is a TOML file; a recording ends in .mcap"))]
    NotText {
        /// As the user named it.
        path: PathBuf,
        /// How many bytes before it are fine.
        byte: usize,
    },
    /// A value is to be set for which the scene has no place.
    #[error("cannot set {setting} in the scene {}: {reason}", path.display())]
    #[diagnostic(help("keys are those of the file, such as run.rate, spawn.NAME.mass or scatter.1.seed"))]
    Setting {
        /// As the user named it.
        path: PathBuf,
        /// As it was typed.
        setting: String,
        /// Why not.
        reason: String,
    },
    /// Something in a scene is not as the format has it.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(Box<Flaw>),
    /// Something in a line of events is not as the format has it, or cannot be done when the run gets there.
    #[error("line {line} of the events: {flaw}")]
    #[diagnostic(forward(flaw))]
    Event {
        /// Which line, from 1.
        line: u64,
        /// What is wrong with it.
        flaw: Box<Flaw>,
    },
}

/// A fault and the text it stands in.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{fault}")]
pub struct Flaw {
    /// What is wrong.
    pub fault: Fault,
    /// The text, while it is at hand.
    #[source_code]
    pub excerpt: Option<Excerpt>,
    /// The offending part.
    #[label(primary, "{label}")]
    pub span: SourceSpan,
    /// What stands beside the offending part.
    pub label: &'static str,
    /// What it clashes with, if it does.
    #[label("first here")]
    pub earlier: Option<SourceSpan>,
    /// What would be accepted.
    #[help]
    pub help: String,
}

/// A text as errors show it: with its name, and lines counted as its file does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// What it is called.
    pub name: String,
    /// Which line of the file its first is, from 1.
    pub line: u64,
    /// The text.
    pub text: String,
}

impl SceneError {
    /// The error of a fault that shows only when the run gets to what stands at `place`.
    pub fn at(source: &SceneSource, place: &Place, fault: Fault) -> SceneError {
        match place {
            Place::Scene(span) => SceneError::in_scene(source, Refusal::new(fault, span.clone())),
            Place::Line(line) => {
                let flaw = Flaw::new(Refusal::new(fault, 0..0), None);
                SceneError::Event { line: *line, flaw: Box::new(flaw) }
            }
        }
    }

    /// What is wrong with what the scene or the line says, if that is the trouble.
    pub fn fault(&self) -> Option<&Fault> {
        match self {
            SceneError::Scene(flaw) | SceneError::Event { flaw, .. } => Some(&flaw.fault),
            SceneError::Unreadable { .. }
            | SceneError::TooLong { .. }
            | SceneError::NotText { .. }
            | SceneError::Setting { .. } => None,
        }
    }

    pub(super) fn in_scene(source: &SceneSource, refusal: Refusal) -> SceneError {
        let excerpt = Excerpt { name: source.path.clone(), line: 1, text: source.text.clone() };
        SceneError::Scene(Box::new(Flaw::new(refusal, Some(excerpt))))
    }

    pub(super) fn in_event(line: u64, text: &str, refusal: Refusal) -> SceneError {
        // What came through a pipe must not steer the terminal it is shown on.
        let text = text.replace(|letter: char| letter.is_ascii_control() && letter != '\t', "?");
        let excerpt = Excerpt { name: "events".into(), line, text };
        SceneError::Event { line, flaw: Box::new(Flaw::new(refusal, Some(excerpt))) }
    }
}

impl Flaw {
    fn new(refusal: Refusal, excerpt: Option<Excerpt>) -> Flaw {
        let Refusal { fault, span, earlier } = refusal;
        Flaw {
            span: span.into(),
            label: fault.label(),
            earlier: earlier.map(SourceSpan::from),
            help: fault.help(),
            fault: *fault,
            excerpt,
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
