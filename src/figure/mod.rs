//! Figures for lectures: one picture of a whole run or of a collision, for a slide or a page.
//!
//! Each figure is a pure function from states or collisions to a display list, which [`crate::render`] draws as PNG or
//! writes as SVG or PDF. Figures do not use the engine. A figure of several runs shows them side by side on the same
//! scales, with one legend.

mod axes;
mod close_up;
mod collision;
mod diagram;
mod energy;
mod filmstrip;
mod log10;
mod log_axes;
mod minkowski;
mod pair;
mod panels;
mod run;
mod spacetime;
mod strobe;

pub use crate::physics::Axis;
pub use collision::collision;
pub use diagram::{Curve, Diagram, DiagramOptions, Point, diagrams};
pub use energy::{EnergyRun, EnergySample, energy};
pub use filmstrip::filmstrip;
pub use minkowski::minkowski;
pub use run::{CollisionSubject, FigureRun};
pub use spacetime::spacetime;
pub use strobe::strobe;

use crate::render::{CameraTarget, Style};

/// The options of every figure.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureOptions {
    /// Width and height of the picture, px.
    pub size: [u32; 2],
    /// The part of the world shown, in figures that show the world.
    pub camera_target: CameraTarget,
    /// Theme, colours and caption.
    pub style: Style,
}
