use super::{Action, Place};

/// One thing a scene does to the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// The state it changes, before that state is recorded.
    pub step: u64,
    /// What it does.
    pub action: Action,
    /// Where it stands, for errors that show only when the run gets there.
    pub place: Place,
}
