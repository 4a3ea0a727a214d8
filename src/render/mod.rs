//! The view: states made into pictures. It reads plain values, never the engine, never a file.
//!
//! A [`Frame`] seen through a [`View`] becomes a [`DisplayList`] of shapes in page units
//! ([`compose`]), which [`svg`] and [`pdf`] write as it is and a [`Painter`] draws to a [`Picture`]
//! of pixels, which [`png`], [`apng`] and [`gif`] write. Each arrow is a pure function, so that pictures drawn on any number of
//! threads, or in several parts, are the same to the bit.

mod aim;
pub mod apng;
pub(crate) mod area;
mod arrow;
mod camera;
mod canvas;
mod clip;
mod color;
mod color_table;
pub mod compare;
mod display_list;
mod error;
mod frame;
pub mod gif;
mod in_order;
mod indexed;
pub(crate) mod labels;
pub(crate) mod layers;
mod line_coverage;
mod look;
mod lzw;
mod metadata;
pub(crate) mod number;
mod painter;
pub(crate) mod palette;
mod patch;
pub mod pdf;
mod picture;
pub mod png;
mod projector;
mod sampling;
mod stencil;
mod style;
pub mod svg;
pub mod text;
mod timeline;
mod trails;
mod view;

pub use aim::Aim;
pub use arrow::Arrow;
pub use camera::Camera;
pub use clip::{draw_each, write_apng, write_gif, write_png, write_png_sequence};
pub use color::Color;
pub use display_list::{DisplayList, Ink, Shape};
pub use error::RenderError;
pub use frame::{Appearance, Frame, Sprite};
pub(crate) use in_order::in_order;
pub use layers::compose;
pub use look::Look;
pub use metadata::Metadata;
pub use painter::Painter;
pub use palette::Palette;
pub use picture::Picture;
pub use projector::{Exposure, Projector};
pub use sampling::{FASTEST_GIF, Sampling, Thinning};
pub use style::Style;
pub use timeline::{Moment, Pace, SHORTEST_HOLD, Timeline};
pub use trails::Trails;
pub use view::View;
