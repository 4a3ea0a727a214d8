//! Recordings of runs: the inputs and states of a run in one MCAP file, readable by any MCAP reader.
//!
//! A recording holds the engine settings, the scene's text, every applied event, every state (or
//! its digest), and about once per simulated second a keyframe from which the run can be continued
//! bit for bit. [`Writer`] streams a recording out. [`Recording`] reads it strictly: every item that
//! it returns has passed all checksums and limits, and damage is reported with its location.
//! [`Playback`] iterates over the full states, for drawing and export.
//!
//! | topic or record       | contents                                           | type                   |
//! |-----------------------|----------------------------------------------------|------------------------|
//! | `/events`             | every spawn and delete: the inputs of a replay     | [`RecordedEvent`]      |
//! | `/states`             | one message per step: digest, movable bodies       | [`RecordedState`]      |
//! | `/bodies`             | keyframes, about one per simulated second          | [`Keyframe`]           |
//! | `/scene`              | boxes for MCAP viewers (optional)                  | `foxglove.SceneUpdate` |
//! | metadata `rebond`     | settings and versions                              | [`Header`]             |
//! | metadata `rebond_end` | how the run ended, identity                        | [`Trailer`]            |
//! | attachment            | the scene's TOML                                   | [`SceneText`]          |

mod batch_writer;
mod body_table;
mod cdr;
mod chunk_reader;
mod decoder;
mod digest;
mod error;
mod header_section;
mod health;
mod index;
mod item_reader;
pub mod limits;
mod mcap_writer;
mod merge;
mod messages;
mod metadata;
mod model;
mod playback;
mod plot_table;
mod reader;
mod record_reader;
mod recover;
mod restorer;
mod resync;
mod scene_update;
mod sequence_validator;
mod shared_output;
mod state;
mod tally;
mod topic;
mod writer;
mod writer_thread;

pub use crate::{color::Color, paint::Paint};
pub use body_table::{BodyInfo, BodyTable};
pub use digest::{Identity, StateDigest};
pub use error::{Error, steps_in_words};
pub use health::{Damage, Gap, Health, Missing, MissingEnd};
pub use index::Summary;
pub use model::{
    Change, FORMAT_VERSION, Header, Keyframe, KeyframeBody, RecordedError, RecordedEvent, SEMANTICS_VERSION,
    SceneImage, SceneText, Trailer, Versions, error_text,
};
pub use playback::{Playback, SampledBody, SampledState};
pub use plot_table::{BODY_STATE, is_plot_table};
pub use reader::{Item, Recording, open, open_file};
pub use recover::{Recovery, recover};
pub use scene_update::ColorFn;
pub use sequence_validator::IDENTITY_MISMATCH;
pub use state::{Bounds, RecordedState, StateBounds, body_state};
pub use writer::{Finished, RunEnd, Writer};

#[cfg(test)]
mod hostile_tests;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
