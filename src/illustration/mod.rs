//! Illustrations: pictures, animations and figures of recordings, bound to their evidence.
//!
//! A [`Wish`] is what somebody asks for; with the recordings before it, it becomes a [`Request`],
//! which leaves nothing open. [`draw`] makes the file, which carries its [`Evidence`]: the
//! identity of each recording and the request in canonical form, and never a path, a date or how
//! the work was split. [`Evidence::read`] finds that in a file, and [`again`] draws the file once
//! more from it, byte for byte.

mod again;
mod draw;
mod energies;
mod error;
mod evidence;
mod format;
mod frames;
mod meeting;
mod needs;
mod options;
mod request;
mod resimulation;
mod source;
mod stops;
mod style;
mod survey;
mod wish;

pub use again::again;
pub use draw::{draw, draw_sequence, drawn, frames, timeline, view};
pub use error::Error;
pub use evidence::{Evidence, SOFTWARE};
pub use format::Format;
pub use frames::{Condition, Frames, Reached};
pub use request::{Encounter, Figure, Request, Subject};
pub use source::Source;
pub use style::paint;
pub use survey::Survey;
pub use wish::{Wish, WishedFigure, WishedSubject, WishedWindow};

/// Hears how much is done, and of how much.
pub type Progress<'a> = &'a mut dyn FnMut(u64, u64);
