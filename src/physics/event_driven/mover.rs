use super::double_double::DoubleDouble;
use super::instant::Instant;
use super::motions::Motions;
use crate::physics::{BodyId, Material};

/// The number of a body within the solver: later created, higher number.
pub type Slot = u32;

/// The two axes, as indices into pairs of numbers.
pub const AXES: [usize; 2] = [0, 1];

/// What prediction reads of a body, and nothing else: two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Mover {
    /// The motion along x and along y.
    pub motion: Motions,
    /// Width and height, m.
    pub size: [f64; 2],
    /// The later of the two reference instants: from there on this is how it moves.
    pub since: Instant,
    /// Counts the changes of its motion and contacts, so that who met it can tell.
    pub generation: u32,
    /// Its place among the bodies of the world.
    pub place: u32,
    /// Whether its mass is infinite.
    pub infinite: bool,
    /// For each axis, whether contacts lead on from it to an infinite mass: behind, ahead.
    pub held: [[bool; 2]; 2],
    /// For each axis, how many impacts in a row have come without any way between them.
    pub hurry: [u8; 2],
}

impl Mover {
    /// Whether it never moves: infinite mass, at rest.
    pub fn is_anchored(&self) -> bool {
        self.infinite && self.motion.is_still()
    }

    /// Whether a push along the axis (`ahead`: towards greater coordinates) cannot move it.
    pub fn is_immovable(&self, axis: usize, ahead: bool) -> bool {
        self.infinite || self.held[axis][usize::from(ahead)]
    }
}

/// What is rarely asked of a body.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Traits {
    /// Its number in the world.
    pub id: BodyId,
    /// kg.
    pub mass: f64,
    /// For the restitution table.
    pub material: Material,
    /// Acceleration when nothing touches it, m/s².
    pub free_fall: [DoubleDouble; 2],
    /// Whether it carries a force of its own along the axis.
    pub forced: [bool; 2],
    /// Whether it has not been deleted.
    pub alive: bool,
}
