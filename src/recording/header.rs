use crate::physics::EngineConfig;

use super::Gap;

/// The version of the file format that this program writes: topics, schemas, metadata.
///
/// The reader accepts every older version and rejects newer ones. Version 2 added the state bounds
/// to the end record, and stores the solver's numbers in keyframes by columns.
pub const FORMAT_VERSION: u32 = 2;

/// The version of the engine semantics: it is raised whenever the same events may give different
/// bits.
pub const SEMANTICS_VERSION: u32 = 1;

/// The header of a recording: settings and versions.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The versions of the program that recorded.
    pub versions: Versions,
    /// The configuration of the engine.
    pub config: EngineConfig,
    /// The planned number of steps. A run may end earlier, with an error or at the end of its live
    /// events.
    pub steps: u64,
    /// States of every `every`-th step are recorded in full, those between as digests only.
    pub every: u64,
    /// The scene's source text.
    pub scene: SceneText,
    /// The gaps of a recovered recording; empty for any other.
    pub gaps: Vec<Gap>,
}

/// The versions that a recording was made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Versions {
    /// The format version; see [`FORMAT_VERSION`].
    pub format: u32,
    /// The engine-semantics version; see [`SEMANTICS_VERSION`].
    pub semantics: u32,
}

impl Versions {
    /// The versions of this program.
    pub const CURRENT: Versions = Versions { format: FORMAT_VERSION, semantics: SEMANTICS_VERSION };
}

/// The scene file at the time of recording; empty if that part of the recording is lost.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneText {
    /// The file name without directories.
    pub file_name: String,
    /// The TOML text.
    pub text: String,
}
