//! rebond: a physics engine of axis-aligned boxes made into an instrument.
//!
//! The pipeline, in reading order:
//!
//! 1. [`scene`] reads what a run is asked to be. It knows nothing of what comes of it.
//! 2. [`physics`] moves boxes. It never names a file, a clock, a format or a pixel.
//! 3. [`render`] makes states into pictures. It never sees the engine.

pub mod physics;
pub mod render;
pub mod scene;
