//! rebond: a physics engine of axis-aligned boxes made into an instrument. It runs a scene in fixed
//! steps, records what went in and what came out, replays that bit for bit, and draws it.
//!
//! The pipeline, in a few lines. A scene comes from a file, from text, or from code:
//!
//! ```
//! use rebond::scene::builder::{SceneBuilder, Spawn, World};
//!
//! // One box of 2 kg at 4 m/s between four walls; lengths are in metres, y points down.
//! let scene = SceneBuilder {
//!     world: World { size: [16.0, 9.0], walls: true, ..World::default() },
//!     spawn: vec![Spawn { at: [2.0, 3.0], mass: 2.0, velocity: [4.0, 0.0], ..Spawn::default() }],
//!     ..SceneBuilder::default()
//! }
//! .build("one-box.toml")?;
//! # Ok::<(), rebond::scene::SceneError>(())
//! ```
//!
//! Step it, and look at the world in between:
//!
//! ```
//! # let scene = rebond::scene::builder::SceneBuilder { spawn: vec![rebond::scene::builder::Spawn { at: [2.0, 3.0], velocity: [4.0, 0.0], ..Default::default() }], ..Default::default() }.build("one-box.toml")?;
//! use rebond::{physics::Collision, run::Run};
//!
//! let mut run = Run::new(&scene);
//! let mut collisions: Vec<Collision> = Vec::new();
//! run.go_to(60, &mut collisions)?;
//! let body = run.engine().world().bodies.last().expect("the box");
//! assert_eq!(body.rect.origin.x, 6.0); // m, after 1 s
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Record it, and hold the recording to what it was:
//!
//! ```
//! # let scene = rebond::scene::builder::SceneBuilder { spawn: vec![rebond::scene::builder::Spawn { velocity: [4.0, 0.0], ..Default::default() }], ..Default::default() }.build("one-box.toml")?;
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("one-box.mcap");
//! use rebond::run::{self, NO_LIVE_EVENTS, RecordOptions};
//!
//! let file = std::fs::File::create(&path)?;
//! let recorded = run::record(&scene, RecordOptions::whole(&scene), NO_LIVE_EVENTS, file, |_| ())?;
//! assert_eq!(recorded.end.steps, 600);
//!
//! rebond::testing::assert_replays(&path); // in a test: panics with the step, body and field
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Draw it, as a picture, an animation or a figure:
//!
//! ```
//! # let scene = rebond::scene::builder::SceneBuilder { spawn: vec![rebond::scene::builder::Spawn { velocity: [4.0, 0.0], ..Default::default() }], ..Default::default() }.build("one-box.toml")?;
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("one-box.mcap");
//! # rebond::run::record(&scene, rebond::run::RecordOptions::whole(&scene), rebond::run::NO_LIVE_EVENTS, std::fs::File::create(&path)?, |_| ())?;
//! use rebond::picture::{Format, PictureOptions, Source, SubjectOptions, draw_to_vec};
//!
//! let options = PictureOptions { size: Some([640, 360]), ..PictureOptions::new(SubjectOptions::Still { step: 60 }) };
//! let svg = draw_to_vec(&options, &[Source::open(&path)?], Format::Svg)?;
//! assert!(svg.starts_with(b"<svg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where things are
//!
//! In reading order:
//!
//! 1. [`scene`] reads what a run is asked to be. It knows nothing of what comes of it.
//! 2. [`physics`] moves boxes. It never names a file, a clock, a format or a pixel.
//! 3. [`run`] feeds a scene's events to the engine, step by step. It decides what clicks hit,
//!    never how boxes move.
//! 4. [`recording`] writes what went in and what came out to MCAP and reads it back strictly.
//! 5. [`replay`] runs a recording again and says whether every bit came out the same.
//! 6. [`render`] makes states into pictures. It never sees the engine.
//! 7. [`figure`] makes states and collisions into lecture figures, in the view's shapes.
//! 8. [`picture`] draws recordings in these ways and stores the provenance in each file.
//! 9. [`check`] holds recordings and pictures to what they were, and [`testing`] does so in tests.
//! 10. [`report`] runs hard scenes and sets errors beside costs; its truths share nothing with
//!     the solvers.
//! 11. [`cli`] puts these together for the command line; nothing else reports errors to people.

pub mod check;
pub mod cli;
mod counted;
pub mod figure;
pub mod guide;
pub mod physics;
pub mod picture;
pub mod recording;
pub mod render;
pub mod replay;
pub mod report;
pub mod run;
pub mod scene;
pub mod testing;

/// The README's examples are tests, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
