//! rebond: a physics engine of axis-aligned boxes made into an instrument.
//!
//! The pipeline, in reading order:
//!
//! 1. [`scene`] reads what a run is asked to be. It knows nothing of what comes of it.
//! 2. [`physics`] moves boxes. It never names a file, a clock, a format or a pixel.
//! 3. [`recording`] writes what went in and what came out to MCAP and reads it back strictly.
//! 4. [`replay`] runs a recording again and says whether every bit came out the same.

pub mod physics;
pub mod recording;
pub mod replay;
pub mod scene;
