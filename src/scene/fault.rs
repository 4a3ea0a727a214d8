/// What is wrong at a place of a scene or of a line of events.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// The text is not of its language.
    #[error("this is not {language}: {message}")]
    Syntax {
        /// TOML or JSON.
        language: &'static str,
        /// What its parser says.
        message: String,
    },
    /// The format has no such key.
    #[error("there is no key `{key}`")]
    UnknownKey {
        /// As written, with its table.
        key: String,
        /// What was probably meant.
        nearest: Option<&'static str>,
        /// All that can stand there.
        accepts: Vec<&'static str>,
    },
    /// A key that has to be there is not.
    #[error("`{key}` is missing")]
    MissingKey {
        /// With its table.
        key: String,
        /// Its values, in words.
        accepts: &'static str,
    },
    /// A key is there twice.
    #[error("`{key}` is there twice")]
    DuplicateKey {
        /// With its table.
        key: String,
    },
    /// Two keys say the same thing in two ways.
    #[error("`{}` and `{}` cannot both be there", keys[0], keys[1])]
    EitherOr {
        /// With their tables.
        keys: [&'static str; 2],
    },
    /// A key does not accept its value.
    #[error("`{key}` cannot be {found}")]
    BadValue {
        /// With its table.
        key: String,
        /// The value, in words.
        found: String,
        /// The values it accepts, in words.
        accepts: &'static str,
    },
    /// A line of events that does not say what happens, or says two things.
    #[error("an event is one of spawn, delete and click")]
    NotOneEvent,
    /// A pair of materials is there twice, perhaps the other way round.
    #[error("the pair {pair:?} is there twice")]
    DuplicatePair {
        /// As written.
        pair: String,
    },
    /// More of something than a scene may have.
    #[error("there are more than {limit} {what}")]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many there may be.
        limit: u64,
    },
    /// Something happens after the last state.
    #[error("step {step} is after the last step of the run, {last}")]
    AfterLastStep {
        /// When it happens.
        step: u64,
        /// The last step.
        last: u64,
    },
    /// A body of that name is alive already.
    #[error("the name {name:?} is taken at step {step}")]
    NameTaken {
        /// The name.
        name: String,
        /// When it is asked for.
        step: u64,
    },
    /// No body of that name is alive.
    #[error("no body named {name:?} is alive at step {step}")]
    NotAlive {
        /// The name.
        name: String,
        /// When it is to be deleted.
        step: u64,
        /// Some of the names that could be deleted then.
        alive: Vec<String>,
    },
    /// The boxes of a scatter do not all find room.
    #[error("only {fitted} of {count} boxes found room")]
    NoRoom {
        /// How many did.
        fitted: u64,
        /// How many were to.
        count: u64,
        /// How often the next one was tried.
        tries: u64,
    },
}

impl Fault {
    /// What would be accepted instead.
    pub fn help(&self) -> String {
        match self {
            Fault::Syntax { language: "TOML", message } if message.contains("duplicate key") => {
                "keep one of the two; tables of which there are several have two brackets, such as [[spawn]]".into()
            }
            Fault::Syntax { language: "TOML", .. } => "see https://toml.io for the language".into(),
            Fault::Syntax { .. } => "write one JSON object a line, for example {\"delete\": {\"name\": \"b\"}}".into(),
            Fault::UnknownKey { nearest: Some(nearest), accepts, .. } => {
                format!("did you mean `{nearest}`? These keys can stand here: {}", accepts.join(", "))
            }
            Fault::UnknownKey { nearest: None, accepts, .. } => {
                format!("these keys can stand here: {}", accepts.join(", "))
            }
            Fault::MissingKey { accepts, .. } => format!("add it: {accepts}"),
            Fault::DuplicateKey { .. } => "keep one of the two".into(),
            Fault::EitherOr { keys } => format!("keep either `{}` or `{}`", keys[0], keys[1]),
            Fault::BadValue { accepts, .. } => format!("give {accepts}"),
            Fault::NotOneEvent => "write one a line, for example {\"delete\": {\"name\": \"b\"}}".into(),
            Fault::DuplicatePair { .. } => "keep one of the two: \"a/b\" and \"b/a\" are the same pair".into(),
            Fault::TooMany { what, limit } => format!("a scene may have up to {limit} {what}"),
            Fault::AfterLastStep { last, .. } => format!("use a step from 0 to {last}, or let the run last longer"),
            Fault::NameTaken { .. } => "choose another name, or delete the body that bears it first".into(),
            Fault::NotAlive { alive, .. } if alive.is_empty() => "no body is alive then".into(),
            Fault::NotAlive { alive, .. } => format!("alive then: {}", alive.join(", ")),
            Fault::NoRoom { tries, .. } => format!(
                "the next one met another body at {tries} random places: ask for fewer or smaller boxes, a larger region, or set overlap = true"
            ),
        }
    }

    /// What stands beside the offending text.
    pub fn label(&self) -> &'static str {
        match self {
            Fault::Syntax { .. } => "here",
            Fault::UnknownKey { nearest: Some(_), .. } => "misspelt",
            Fault::UnknownKey { nearest: None, .. } => "unknown",
            Fault::MissingKey { .. } => "missing here",
            Fault::DuplicateKey { .. } | Fault::DuplicatePair { .. } => "again here",
            Fault::EitherOr { .. } => "one too many",
            Fault::BadValue { .. } => "not accepted",
            Fault::NotOneEvent => "not one event",
            Fault::TooMany { .. } => "too many",
            Fault::AfterLastStep { .. } => "too late",
            Fault::NameTaken { .. } => "taken",
            Fault::NotAlive { .. } => "not alive then",
            Fault::NoRoom { .. } => "no room",
        }
    }
}
