//! Pictures, animations and figures of recordings, with their provenance.
//!
//! [`PictureOptions`] describe a picture and may leave settings open. [`PictureOptions::resolve`]
//! turns them, for given recordings, into a [`ResolvedPicture`] in which every setting has a value.
//! [`draw`] writes the file, which carries its [`Provenance`]: the identity of each recording and
//! the resolved picture in canonical form, but no path, no date and nothing about threads or shards.
//! [`Provenance::read`] reads it from a file, and [`redraw`] draws the same file again from it, byte
//! for byte.

mod draw;
mod energies;
mod error;
mod find_collision;
mod format;
mod frames;
mod freeze_frames;
mod option_line;
mod options;
mod provenance;
mod redraw;
mod requirements;
mod resimulation;
mod resolved;
mod run_summary;
mod source;
mod style;

pub use draw::{draw, draw_sequence, draw_to_vec, frames, schedule, view};
pub use error::Error;
pub use format::Format;
pub use frames::{Frames, ReadExtent, ReadStatus};
pub use options::{FigureChoice, PictureOptions, SubjectOptions, WindowOptions};
pub use provenance::{Provenance, SOFTWARE};
pub use redraw::redraw;
pub use resolved::{CollisionSelector, Figure, ResolvedPicture, Subject};
pub use run_summary::RunSummary;
pub use source::Source;
pub use style::body_color;

/// A callback that receives the number of completed work items and their total.
pub type Progress<'a> = &'a mut dyn FnMut(u64, u64);
