//! What went in and what came out, as one MCAP file that any reader of MCAP understands.
//!
//! A recording holds the settings, the scene's text, every event that was applied, every
//! state (or its digest) and about once a second a keyframe from which a run goes on to
//! the bit. [`Writer`] streams it out, [`Recording`] reads it back strictly: what it hands
//! over has passed every checksum and every limit, and what cannot is located, never
//! guessed. [`Playback`] shows a recording step by step to those who draw or tabulate.
//!
//! | topic or record   | holds                                            | type                |
//! |-------------------|--------------------------------------------------|---------------------|
//! | `/events`         | every spawn and delete: what replay feeds in     | [`RecordedEvent`]   |
//! | `/states`         | one message a step: digest, movable bodies       | [`RecordedState`]   |
//! | `/bodies`         | about once a second: everything, to start from   | [`Keyframe`]        |
//! | `/scene`          | boxes for viewers, only if asked for             | `foxglove.SceneUpdate` |
//! | metadata `rebond` | settings and versions                            | [`Header`]          |
//! | metadata `rebond_end` | how the run ended, its identity              | [`End`]             |
//! | attachment        | the scene's TOML                                 | [`SceneText`]       |

mod background;
mod batch;
mod body_table;
mod cdr;
mod chunk;
mod clock;
mod columns;
mod container;
mod course;
mod digest;
mod end;
mod error;
mod event;
mod extremes;
mod fields;
mod file;
mod gap;
mod head;
mod header;
mod health;
mod identity;
mod inbox;
mod index;
mod keyframe;
pub mod limits;
mod messages;
mod metadata;
mod outline;
mod playback;
mod reader;
mod recorder;
mod records;
mod recover;
mod resync;
mod state;
mod topic;
mod view;
mod writer;

pub use batch::numbers;
pub use body_table::{BodyTable, KnownBody};
pub use digest::StateDigest;
pub use end::End;
pub use error::Error;
pub use event::{Change, RecordedEvent};
pub use extremes::{Extremes, Reach};
pub use file::{Overwrite, RecordingFile, Sync, create};
pub use gap::Gap;
pub use header::{FORMAT_VERSION, Header, SEMANTICS_VERSION, SceneText, Versions};
pub use health::{Damage, Health};
pub use identity::Identity;
pub use keyframe::{Keyframe, KeyframeBody};
pub use outline::Outline;
pub use playback::{Frame, FrameBody, Playback};
pub use reader::{Item, Recording, open};
pub use recover::{Recovery, recover};
pub use state::RecordedState;
pub use view::Paint;
pub use writer::{Finished, Outcome, Writer};

#[cfg(test)]
mod hostile_tests;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
