use std::ops::Range;

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
    /// A description of what would be accepted instead.
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
            DiagnosticKind::NameTaken { .. } => "in use",
            DiagnosticKind::NotAlive { .. } => "not alive",
            DiagnosticKind::NoRoom { .. } => "no room",
            DiagnosticKind::NoSuchTable { .. } => "does not exist",
            DiagnosticKind::NotAValue { .. } => "a table",
            DiagnosticKind::NotATable { .. } => "a value",
        }
    }
}
