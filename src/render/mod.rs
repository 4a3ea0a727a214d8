//! The view: states made into pictures. It reads plain values, never the engine, never a file.
//!
//! A [`Frame`] seen through a [`View`] becomes a [`DisplayList`] of shapes in page units
//! ([`compose`]), which becomes a [`Picture`] of pixels ([`draw`]), which [`png`] and [`gif`]
//! write. Each arrow is a pure function, so that pictures drawn on any number of threads, or
//! in several parts, are the same to the bit.

mod camera;
mod clip;
mod color;
mod display_list;
mod error;
mod frame;
pub mod gif;
mod metadata;
mod picture;
pub mod png;
mod sampling;
mod style;
mod trails;

pub use camera::Camera;
pub use clip::{View, compose, draw, write_gif, write_png_sequence};
pub use color::Color;
pub use display_list::{DisplayList, Shape};
pub use error::RenderError;
pub use frame::{Appearance, Frame, Sprite};
pub use metadata::Metadata;
pub use picture::Picture;
pub use sampling::{Sampling, Thinning};
pub use style::Style;
pub use trails::Trails;
