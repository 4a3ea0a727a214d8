//! rebond: a physics engine of axis-aligned boxes made into an instrument.
//!
//! The pipeline, in reading order:
//!
//! 1. [`scene`] reads what a run is asked to be. It knows nothing of what comes of it.
//! 2. [`physics`] moves boxes. It never names a file, a clock, a format or a pixel.
//! 3. [`run`] feeds a scene's events to the engine, step by step. It decides what clicks hit,
//!    never how boxes move.
//! 4. [`recording`] writes what went in and what came out to MCAP and reads it back strictly.
//! 5. [`replay`] runs a recording again and says whether every bit came out the same.
//! 6. [`render`] makes states into pictures. It never sees the engine.
//! 7. [`figure`] makes states and collisions into lecture figures, in the view's shapes.
//! 8. [`illustration`] draws recordings in that way, and binds what it draws to their evidence.
//! 9. [`check`] holds recordings and pictures to what they were.
//! 10. [`cli`] puts these together for the command line; nothing else reports errors to people.

pub mod check;
pub mod cli;
pub mod figure;
pub mod illustration;
pub mod physics;
pub mod recording;
pub mod render;
pub mod replay;
pub mod run;
pub mod scene;

/// The README's examples are tests, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
