//! What a run is asked to be: a TOML file made into plain, checked values.

mod figure_options;

pub use figure_options::{ColorBy, FigureOptions, Overlay, Theme};
