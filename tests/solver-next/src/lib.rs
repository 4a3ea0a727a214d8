#![forbid(unsafe_code)]
pub mod physics;
pub mod scene;
