//! The model: boxes that move and collide. It names no file, clock, format or pixel.
//!
//! Axes: x to the right, y **down**; a position is a box's upper-left corner. SI units
//! throughout: m, s, kg, N, J.
//!
//! Everything enters as an [`Event`] through [`Engine::apply`]; [`Engine::step`] moves the
//! world on by 1/rate; [`Engine::world`] is what can be seen of it. Who wants to know of
//! collisions passes an [`Observer`].

mod axis;
mod body;
mod collision;
mod engine;
mod event;
pub mod event_driven;
pub mod handout;
pub mod invariants;
mod rect;
mod restitution;
mod snapshot;
mod step_error;
mod vector;
mod world;

pub use axis::{Axis, Side};
pub use body::{Body, BodyId};
pub use collision::{Collision, CollisionCount, Observer};
pub use engine::{DEFAULT_EVENTS_PER_STEP, Engine, EngineConfig, SolverKind};
pub use event::{Event, Spawn};
pub use rect::Rect;
pub use restitution::{Material, Restitution, RestitutionPair};
pub use snapshot::{SolverSnapshot, Snapshot, SnapshotError};
pub use step_error::StepError;
pub use vector::Vector;
pub use world::World;
