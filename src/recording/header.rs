use crate::physics::Settings;

use super::Gap;

/// The version of the file format this program writes: topics, schemas, metadata.
///
/// A reader refuses a newer one and reads every older one. Version 2 tells the extremes at the
/// end, and has the solver's numbers in keyframes by columns.
pub const FORMAT_VERSION: u32 = 2;

/// The version of what the engine computes: it changes when the same events may give
/// other bits than before.
pub const SEMANTICS_VERSION: u32 = 1;

/// What stands at the start of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Of the program that recorded.
    pub versions: Versions,
    /// What the engine was told.
    pub settings: Settings,
    /// The steps the run was to take; a run may end before, in an error or at the end of
    /// its live events.
    pub steps: u64,
    /// The states of every `every`-th step are recorded in full, those between as digests.
    pub every: u64,
    /// The scene as it was written by hand.
    pub scene: SceneText,
    /// What is missing from a recovered recording; empty for any other.
    pub gaps: Vec<Gap>,
}

/// Which format and which engine a recording was made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Versions {
    /// See [`FORMAT_VERSION`].
    pub format: u32,
    /// See [`SEMANTICS_VERSION`].
    pub semantics: u32,
}

impl Versions {
    /// Those of this program.
    pub const CURRENT: Versions = Versions { format: FORMAT_VERSION, semantics: SEMANTICS_VERSION };
}

/// A scene file as it was when recorded; empty if that part of the recording is lost.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneText {
    /// Its name without folders; never a path.
    pub file_name: String,
    /// The whole TOML text.
    pub text: String,
}
