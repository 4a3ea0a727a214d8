//! Lecture figures: what a run shows in one picture, for a slide or a page.
//!
//! Each figure is a pure function of states or collisions to a display list, which
//! [`crate::render`] draws as PNG or writes as SVG or PDF. Like the view it never sees the
//! engine: what happened comes as data.

mod axes;
mod close_up;
mod collision;
mod energy;
mod filmstrip;
mod labels;
mod minkowski;
mod number;
mod pair;
mod panels;
mod spacetime;
mod strobe;

pub use collision::collision;
pub use energy::{EnergySample, energy};
pub use filmstrip::filmstrip;
pub use minkowski::minkowski;
pub use spacetime::{Axis, spacetime};
pub use strobe::strobe;

use crate::physics::Vector;
use crate::render::Style;

/// What every figure is told.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureOptions {
    /// Width and height of the picture, px.
    pub size: [u32; 2],
    /// Width and height of the world, m.
    pub world: Vector,
    /// How it looks.
    pub style: Style,
    /// What is written below it.
    pub caption: Option<String>,
}
