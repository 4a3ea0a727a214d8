use crate::figure::Axis;
use crate::render::Aim;
use crate::scene::{ColorBy, Overlay, Theme};
use std::ops::RangeInclusive;

/// All that shapes an illustration, with nothing left open.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What is drawn.
    pub subject: Subject,
    /// Width and height, px.
    pub size: [u32; 2],
    /// Light or dark.
    pub theme: Theme,
    /// What is drawn beside the boxes, sorted, each once.
    pub show: Vec<Overlay>,
    /// What the colour of a box tells.
    pub color_by: ColorBy,
    /// What of the world is seen.
    pub aim: Aim,
    /// What is written below; nothing if empty.
    pub caption: String,
    /// What is written above each of several recordings.
    pub titles: Vec<String>,
}

/// What an illustration is of.
#[derive(Clone, Debug, PartialEq)]
pub enum Subject {
    /// One state. Collisions shown are those of so many steps before it.
    Still {
        /// The step.
        step: u64,
        /// Steps since the picture before it.
        every: u64,
    },
    /// An animation.
    Clip {
        /// The first and the last step that may be shown.
        steps: RangeInclusive<u64>,
        /// Steps from one frame to the next.
        every: u64,
        /// Instants shown for each step.
        parts: u64,
        /// Simulated seconds for each second on the screen.
        slow: f64,
        /// Seconds for which it stops at collisions; 0 for none.
        hold: f64,
    },
    /// A lecture figure of states.
    Figure {
        /// Which.
        figure: Figure,
        /// The first and the last step that may be shown.
        steps: RangeInclusive<u64>,
        /// Steps from one state to the next.
        every: u64,
    },
    /// The handout's figure 1, one collision of each recording.
    Collision(Vec<Encounter>),
    /// The handout's figure 2, one collision of each recording.
    Minkowski(Vec<Encounter>),
}

/// A lecture figure of states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Many instants in one picture.
    Strobe,
    /// Places against time.
    Spacetime(Axis),
    /// Energy and momentum against time.
    Energy,
    /// Panels of chosen steps.
    Filmstrip,
}

/// The first collision of two bodies from a step on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Encounter {
    /// The step.
    pub step: u64,
    /// The names of the two, in the order of the collision.
    pub pair: [String; 2],
}
