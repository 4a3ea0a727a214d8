//! The live page's side of the engine, compiled to WebAssembly.
//!
//! A [`Session`] is a scene and lines of events; all states follow from them. The page holds the text of both, and
//! calls the functions in [`exports`], the only part with unsafe code.
#![deny(unsafe_code)]

mod columns;
mod event_line;
mod event_lines;
#[allow(unsafe_code)]
pub mod exports;
mod film;
mod history;
mod pictures;
mod save;
mod scene_text;
mod session;
mod spawned_bodies;
mod undo;

pub use columns::{BODY_COLUMNS, COLLISION_COLUMNS, ColorKey};
pub use event_line::EventLine;
pub use film::{Film, LiveVerdict};
pub use history::{EnergyStrip, History};
pub use pictures::{FigureKind, collision_figure, draw, table};
pub use save::Save;
pub use scene_text::{BUNDLED, SceneText};
pub use session::{MAX_BODIES, Session, When};

#[cfg(test)]
mod recording_tests;
#[cfg(test)]
mod session_tests;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod undo_tests;
