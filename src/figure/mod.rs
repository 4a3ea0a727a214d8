//! Lecture figures: what a run shows in one picture, for a slide or a page.
//!
//! Each figure is a pure function of states or collisions to a display list, which
//! [`crate::render`] draws as PNG or writes as SVG or PDF. Like the view it never sees the
//! engine: what happened comes as data. Of several runs each figure shows the same, side by side
//! on the same scales, with one legend.

mod axes;
mod close_up;
mod collision;
mod diagram;
mod energy;
mod filmstrip;
mod log_axes;
mod logarithm;
mod minkowski;
mod pair;
mod panels;
mod run;
mod spacetime;
mod strobe;

pub use collision::collision;
pub use diagram::{Curve, Diagram, DiagramOptions, Point, diagrams};
pub use energy::{EnergyRun, EnergySample, energy};
pub use filmstrip::filmstrip;
pub use minkowski::minkowski;
pub use run::{Meeting, Run};
pub use spacetime::{Axis, spacetime};
pub use strobe::strobe;

use crate::render::{Aim, Style};

/// What every figure is told.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureOptions {
    /// Width and height of the picture, px.
    pub size: [u32; 2],
    /// What of each world is seen where a world is.
    pub aim: Aim,
    /// How it looks; its caption is written below.
    pub style: Style,
}
