use super::{AnimationFormat, Format, Look, Quantity, ReferenceFrame, StillFormat, Timing};
use crate::physics::Axis;
use std::ops::RangeInclusive;

/// A picture in which every option has a value; with its recordings, it determines the file.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedPicture {
    /// The content and the format of the file.
    pub subject: Subject,
    /// The appearance.
    pub look: Look,
    /// The titles above the recordings; their own titles if empty.
    pub titles: Vec<String>,
}

impl ResolvedPicture {
    /// The format of the file.
    pub const fn format(&self) -> Format {
        match self.subject {
            Subject::Page { format, .. } => Format::Still(format),
            Subject::Animation { format, .. } => Format::Animation(format),
        }
    }
}

/// The content of a picture and the format of its file.
#[derive(Clone, Debug, PartialEq)]
pub enum Subject {
    /// One page.
    Page {
        /// The content of the page.
        page: Page,
        /// The format.
        format: StillFormat,
    },
    /// An animation.
    Animation {
        /// The steps and times shown.
        animation: Animation,
        /// The format.
        format: AnimationFormat,
    },
}

/// The content of a page.
#[derive(Clone, Debug, PartialEq)]
pub enum Page {
    /// One state, with the collisions since the previous picture.
    State {
        /// The step of the state.
        step: u64,
        /// Steps since the previous picture of a sequence; collisions of these steps are shown. `None` for a single
        /// picture, which shows those of one step.
        every: Option<u64>,
    },
    /// A figure of one collision of each recording.
    Collision {
        /// The kind of figure.
        figure: CollisionFigure,
        /// The collision of each recording.
        collisions: Vec<CollisionSelector>,
    },
    /// A figure of many states.
    States {
        /// The kind of figure.
        figure: StatesFigure,
        /// The steps of each recording, or of all of them if there is one range only.
        steps: Vec<StepRange>,
    },
    /// Energy and momentum against time.
    Energy {
        /// The steps of each recording, or of all of them if there is one range only.
        steps: Vec<StepRange>,
    },
    /// The distribution of speeds.
    Speeds {
        /// The steps of each recording, or of all of them if there is one range only.
        steps: Vec<StepRange>,
    },
    /// The pressure on walls and pistons against time, and against the volume if that changes.
    Pressure {
        /// The steps of each recording, or of all of them if there is one range only.
        steps: Vec<StepRange>,
    },
    /// Velocities in their own space: those of two bodies along an axis during the run, or those of other numbers of
    /// bodies in the last state.
    VelocitySpace {
        /// The axis, if there are two bodies.
        axis: Axis,
        /// The steps of each recording, or of all of them if there is one range only.
        steps: Vec<StepRange>,
    },
    /// A quantity against time, of all recordings in one diagram.
    Lines {
        /// The quantity.
        quantity: Quantity,
        /// The steps of each recording, or of all of them if there is one range only.
        steps: Vec<StepRange>,
    },
}

/// The steps of a recording that a figure shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepRange {
    /// The first and the last step that may be shown.
    pub steps: RangeInclusive<u64>,
    /// Steps from one state to the next; only steps that are a multiple of it are shown.
    pub every: u64,
}

/// The steps and times that an animation, a video or a sequence of pictures shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// The first and the last step that may be shown.
    pub steps: RangeInclusive<u64>,
    /// Steps from one frame to the next; only steps that are a multiple of it are shown.
    pub every: u64,
    /// Playback speed, frames per step and freeze frames.
    pub timing: Timing,
}

/// A kind of figure of a collision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CollisionFigure {
    /// Figure 1 of the handout: before, the overlap and its normal, after; and the momenta.
    Stages(ReferenceFrame),
    /// Figure 2 of the handout: the Minkowski difference.
    Minkowski,
}

impl CollisionFigure {
    /// Its name in provenance.
    pub const fn name(self) -> &'static str {
        match self {
            CollisionFigure::Stages(_) => "collision",
            CollisionFigure::Minkowski => "minkowski",
        }
    }
}

/// A kind of figure of many states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatesFigure {
    /// Many instants in one picture.
    Strobe,
    /// Position along one axis against time.
    Spacetime(Axis),
    /// One panel per chosen step.
    Filmstrip,
}

impl StatesFigure {
    /// Its name in provenance.
    pub const fn name(self) -> &'static str {
        match self {
            StatesFigure::Strobe => "strobe",
            StatesFigure::Spacetime(_) => "spacetime",
            StatesFigure::Filmstrip => "filmstrip",
        }
    }
}

/// Selects the first collision of two bodies in or after a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CollisionSelector {
    /// The step.
    pub step: u64,
    /// The names of the two bodies, in the order of the collision.
    pub pair: [String; 2],
}
