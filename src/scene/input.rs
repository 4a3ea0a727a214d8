use super::{Blueprint, Place, SpawnRequest};
use crate::physics::Vector;

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

/// What can be done to the world.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// One of the four walls comes into being; the numbering of bodies passes over it.
    Wall(SpawnRequest),
    /// A body comes into being: the next in the numbering, named or not.
    Spawn(SpawnRequest),
    /// The body of that name goes; it has to be alive then.
    Delete {
        /// Its name, or `#K` for the K-th body spawned in the run.
        name: String,
    },
    /// The handout's mouse: the body of finite mass created last that covers the point goes;
    /// only if there is none, one is spawned.
    Click {
        /// The point, m.
        at: Vector,
        /// What to spawn, centred on the point; nothing if absent.
        spawn: Option<Blueprint>,
    },
}
