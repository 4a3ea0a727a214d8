//! A deterministic 2-D physics engine of axis-aligned boxes, which records runs, replays them bit for bit and draws
//! them.
//!
//! The items below are in the order of the pipeline. A scene comes from a file ([`load_scene`]), from text
//! ([`parse_scene`]), or from code:
//!
//! ```
//! use rebond::{BlueprintTable, SceneBuilder, SpawnTable, WorldTable};
//!
//! // One box of 2 kg at 4 m/s between four walls; lengths are in metres, y points down.
//! let scene = SceneBuilder::new()
//!     .world(WorldTable::new().size([16.0, 9.0]).walls(true))
//!     .spawn(SpawnTable::new([2.0, 3.0], BlueprintTable::new().mass(2.0).velocity([4.0, 0.0])))
//!     .build("one-box.toml")?;
//! # Ok::<(), rebond::SceneError>(())
//! ```
//!
//! A [`Run`] steps a scene and gives access to the world in between:
//!
//! ```
//! # let blueprint = rebond::BlueprintTable::new().velocity([4.0, 0.0]);
//! # let spawn = rebond::SpawnTable::new([2.0, 3.0], blueprint);
//! # let scene = rebond::SceneBuilder::new().spawn(spawn).build("one-box.toml")?;
//! use rebond::{Collision, Run};
//!
//! let mut run = Run::new(&scene);
//! let mut collisions: Vec<Collision> = Vec::new();
//! run.go_to(60, &mut collisions)?;
//! let body = run.engine().world().bodies.last().expect("the box");
//! assert_eq!(body.rect.origin.x, 6.0); // m, after 1 s
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`record`] writes a recording, which can be replayed. [`testing`] does so in tests:
//!
//! ```
//! # let scene = rebond::SceneBuilder::new().build("one-box.toml")?;
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("one-box.mcap");
//! use rebond::{NO_LIVE_EVENTS, RecordOptions, record};
//!
//! let file = std::fs::File::create(&path)?;
//! let recorded = record(&scene, RecordOptions::complete(&scene), NO_LIVE_EVENTS, file, |_| ())?;
//! assert_eq!(recorded.trailer.steps, 600);
//!
//! rebond::testing::assert_replays(&path); // in a test: panics with the step, body and field
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A recording is drawn as a picture, an animation or a figure:
//!
#![cfg_attr(feature = "draw", doc = "```")]
#![cfg_attr(not(feature = "draw"), doc = "```ignore")]
//! # let scene = rebond::SceneBuilder::new().build("one-box.toml")?;
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("one-box.mcap");
//! # let file = std::fs::File::create(&path)?;
//! # rebond::record(&scene, rebond::RecordOptions::complete(&scene), rebond::NO_LIVE_EVENTS, file, |_| ())?;
//! use rebond::{PictureOptions, Source, StillFormat, SubjectOptions, draw_to_vec};
//!
//! let subject = SubjectOptions::State { step: 60.into(), format: StillFormat::Svg };
//! let mut options = PictureOptions::default();
//! options.size = Some([640, 360]);
//! let svg = draw_to_vec(&subject, &options, &[Source::open(&path)?])?;
//! assert!(svg.starts_with(b"<svg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//!
//! Without default features, the library parses and runs scenes and writes, reads and replays recordings. `draw` adds
//! pictures of states, animations, and checks of recordings and pictures. `figures` adds lecture figures and implies
//! `draw`. `report` adds measurements of error and cost on hard scenes. `cli`, the default, adds the command `rebond`
//! and implies all of them.

mod body_selector;
#[cfg(feature = "draw")]
mod check;
#[cfg(feature = "cli")]
mod cli;
mod color;
pub mod guide;
#[cfg(feature = "cli")]
mod junit;
mod paint;
mod physics;
#[cfg(feature = "draw")]
mod picture;
mod picture_choices;
mod picture_options;
mod recording;
mod replay;
#[cfg(feature = "report")]
mod report;
mod scene;
#[cfg(feature = "draw")]
mod table;
#[cfg(feature = "draw")]
mod temporary;
pub mod testing;
mod text;

// Scenes.
pub use scene::builder::{
    BlueprintTable, ClickTable, DeleteTable, RunTable, ScatterTable, SceneBuilder, SpawnTable, WorldTable,
};
pub use scene::{
    Diagnostic, DiagnosticKind, Diagnostics, Excerpt, Scene, SceneError, load as load_scene, parse as parse_scene,
};

// Running and recording scenes.
pub use replay::{LiveEvents, NO_LIVE_EVENTS, OnBadEvent, RecordOptions, Recorded, Run, RunError, record};

// The engine and its world.
pub use physics::{
    Axis, Body, BodyId, Collision, CollisionCount, Engine, EngineConfig, Event, Material, Observer, Rect, Restitution,
    RestitutionPair, Snapshot, SnapshotError, SolverKind, Spawn, StepError, Vector, WithinStep, World,
};

/// Reading recordings.
///
/// [`open`](recordings::open) gives a [`Recording`](recordings::Recording), whose metadata, events and states are read
/// strictly; [`Playback`](recordings::Playback) iterates over full states. [`recover`](recordings::recover) copies all
/// that is intact from a damaged file to a new one.
pub mod recordings {
    pub use crate::recording::{
        BodyInfo, BodyTable, Bounds, Change, Color, Damage, Error, Gap, Header, Health, Identity, Item, Keyframe,
        KeyframeBody, Missing, MissingEnd, Paint, Playback, RecordedError, RecordedEvent, RecordedState, Recording,
        Recovery, SampledBody, SampledState, SceneImage, SceneText, StateBounds, StateDigest, Summary, Trailer,
        Versions, open, recover,
    };
}

// Replaying recordings.
pub use replay::{ALL_STEPS, Difference, Divergence, Replayer, Verdict};

// Pictures.
pub use body_selector::BodySelector;
#[cfg(feature = "draw")]
pub use picture::{
    AnimationFormat, CollisionFigure, Error as PictureError, FigureOptions, Provenance, Source, StatesFigure,
    StillFormat, SubjectOptions, draw_to_vec, redraw,
};
pub use picture_options::{
    ColorBy, Language, Overlay, Overlays, PictureOptions, Quantity, ReferenceFrame, StepOrTime, Theme, Window,
};

/// Modules of this crate for its own command, tests and benchmarks. They are not part of the API and may change in
/// any version.
#[doc(hidden)]
pub mod internals {
    #[cfg(feature = "draw")]
    pub mod check {
        pub use crate::check::*;
    }
    #[cfg(feature = "cli")]
    pub mod cli {
        pub use crate::cli::*;
    }
    pub mod physics {
        pub use crate::physics::*;
    }
    #[cfg(feature = "draw")]
    pub mod picture {
        pub use crate::picture::*;
    }
    pub mod recording {
        pub use crate::recording::*;
    }
    pub mod replay {
        pub use crate::replay::*;
    }
    #[cfg(feature = "report")]
    pub mod report {
        pub use crate::report::*;
    }
    pub mod scene {
        pub use crate::scene::*;
    }
    #[cfg(feature = "draw")]
    pub mod table {
        pub use crate::table::*;
    }
}

/// Runs the examples of the README as documentation tests.
#[cfg(all(doctest, feature = "draw"))]
#[doc = include_str!("../README.md")]
struct Readme;
