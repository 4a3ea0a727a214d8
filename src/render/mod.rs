//! Rendering: draws states as pictures. It works on plain values; it neither uses the engine nor opens files.
//!
//! [`compose`] lays out a [`Frame`] for a [`View`] as a [`DisplayList`] of shapes in page units. [`svg`] and [`pdf`]
//! write display lists directly; a [`Painter`] rasterises them to a [`Picture`], which [`png`], [`apng`] and [`gif`]
//! encode. Every stage is a pure function, so pictures are bit-identical on any number of threads, and when an
//! animation is drawn in several parts.

mod animation_decoder;
pub mod apng;
pub(crate) mod area;
mod arrow;
mod camera;
mod camera_target;
mod canvas;
mod color;
mod color_table;
pub mod compare;
mod coverage_mask;
mod display_list;
mod error;
mod frame;
mod frame_delta;
pub mod gif;
pub(crate) mod label_placer;
pub(crate) mod layers;
mod lzw;
mod metadata;
mod metrics;
pub(crate) mod number_format;
mod ordered_parallel_map;
mod painter;
pub(crate) mod palette;
pub mod pdf;
mod picture;
pub mod png;
mod quantize;
mod schedule;
mod step_grid;
mod stroke;
mod style;
pub mod svg;
pub mod text;
mod trails;
mod view;
mod writers;

pub use animation_decoder::{AnimationDecoder, DecodedFrame};
pub use arrow::Arrow;
pub use camera::Camera;
pub use camera_target::CameraTarget;
pub use color::Color;
pub use display_list::{DisplayList, Ink, Shape};
pub use error::RenderError;
pub use frame::{Appearance, Frame, Sprite};
pub use layers::compose;
pub use metadata::Metadata;
pub use metrics::Metrics;
pub(crate) use ordered_parallel_map::ordered_parallel_map;
pub use painter::Painter;
pub use palette::Palette;
pub use picture::Picture;
pub use schedule::{AnimationSchedule, MIN_HOLD, Moment, Timing};
pub use step_grid::{MAX_GIF_FPS, StepGrid, Thinning};
pub use style::Style;
pub use trails::Trails;
pub use view::View;
pub use writers::{draw_frames, write_apng, write_gif, write_png, write_png_sequence};
