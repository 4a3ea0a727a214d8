use crate::figure::Axis;
use crate::render::CameraTarget;
use crate::scene::{ColorBy, Overlay, Theme};
use std::ops::RangeInclusive;

/// A picture in which every setting has a value; with its recordings, it determines the file.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedPicture {
    /// The subject of the picture.
    pub subject: Subject,
    /// Width and height, px.
    pub size: [u32; 2],
    /// The colour theme.
    pub theme: Theme,
    /// The overlays drawn in addition to the boxes, sorted and without repetition.
    pub show: Vec<Overlay>,
    /// The property shown by the colour of a box.
    pub color_by: ColorBy,
    /// The part of the world that the camera shows.
    pub camera_target: CameraTarget,
    /// The caption below the picture; none if empty.
    pub caption: String,
    /// The titles above the recordings; their own titles if empty.
    pub titles: Vec<String>,
}

/// The subject of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Subject {
    /// One state, with the collisions since the previous picture.
    Still {
        /// The step of the state.
        step: u64,
        /// Steps since the previous picture of a sequence; collisions of these steps are shown.
        every: u64,
    },
    /// An animation, or a sequence of pictures.
    Animation {
        /// The first and the last step that may be shown.
        steps: RangeInclusive<u64>,
        /// Steps from one frame to the next; frames lie on its multiples.
        every: u64,
        /// Frames per step; more than 1 only if every step is shown.
        frames_per_step: u64,
        /// Playback speed: simulated seconds per second of playback.
        slow: f64,
        /// How long the animation freezes at each new collision, s; 0 for no freeze frames.
        hold: f64,
    },
    /// A lecture figure of many states.
    Figure {
        /// The kind of figure.
        figure: Figure,
        /// The first and the last step that may be shown.
        steps: RangeInclusive<u64>,
        /// Steps from one state to the next.
        every: u64,
    },
    /// Figure 1 of the handout, for one collision of each recording.
    Collision(Vec<CollisionSelector>),
    /// Figure 2 of the handout, for one collision of each recording.
    Minkowski(Vec<CollisionSelector>),
}

/// A kind of lecture figure of many states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Many instants in one picture.
    Strobe,
    /// Position along one axis against time.
    Spacetime(Axis),
    /// Energy and momentum against time.
    Energy,
    /// One panel per chosen step.
    Filmstrip,
}

/// Selects the first collision of two bodies in or after a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CollisionSelector {
    /// The step.
    pub step: u64,
    /// The names of the two bodies, in the order of the collision.
    pub pair: [String; 2],
}
