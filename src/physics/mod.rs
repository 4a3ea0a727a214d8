//! The model: boxes that move and collide. It depends on no file, wall clock, format or display.
//!
//! Axes: x to the right, y **down**; the position of a box is its upper-left corner. All quantities are
//! in SI units: m, s, kg, N, J.
//!
//! All input is an [`Event`], applied by [`Engine::apply`]. [`Engine::step`] advances the world by
//! 1/rate seconds, and [`Engine::world`] returns it. An [`Observer`] receives the collisions.

// Geometry.
mod axis;
mod rect;
mod vector;

// The model: bodies, inputs and collisions.
mod collision;
mod event;
mod restitution;
mod world;

// The engine and its two solvers.
mod accuracy;
mod engine;
pub mod event_driven;
pub mod handout;

pub use accuracy::{Accuracy, AccuracyProbe};
pub use axis::{Axis, Side};
pub use collision::{Collision, CollisionCount, Observer};
pub use engine::{
    DEFAULT_EVENTS_PER_STEP, Engine, EngineConfig, Snapshot, SnapshotError, SolverKind, SolverSnapshot, StepError,
    WithinStep,
};
pub use event::{Event, Spawn};
pub use rect::Rect;
pub use restitution::{Material, Restitution, RestitutionPair};
pub use vector::Vector;
pub(crate) use vector::{larger, smaller};
pub use world::{Body, BodyId, World};
