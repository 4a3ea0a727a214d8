use super::axis_trajectory::AxisLowParts;
use super::double_double::DoubleDouble;
use super::instant::Instant;
use super::trajectory::Trajectory;
use crate::physics::{BodyId, Material};

/// The index of a body within the solver, in creation order.
pub type Slot = u32;

/// The factor from kilograms to the unit of summed masses, 2²⁴ kg, in which no sum overflows. Forces have the same
/// factor.
pub const MASS_SCALE: f64 = 1.0 / (1_u64 << 24) as f64;

/// Stands for no body, or for no index of a list.
pub const NONE: u32 = u32::MAX;

/// The data of a body that predictions read: two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct BodyState {
    /// The trajectory along x and y.
    pub trajectory: Trajectory,
    /// Width and height, m.
    pub size: [f64; 2],
    /// The later of the two reference instants of the trajectory, from which on both axes are valid.
    pub since: Instant,
    /// The number of changes of its trajectory and contacts, by which invalidated predictions are detected.
    pub generation: u32,
    /// Its index in [`World::bodies`](crate::physics::World::bodies) when the indices were last
    /// [updated](super::bodies::Bodies::update_world_indices).
    pub world_index: u32,
    /// True if its mass is infinite.
    pub infinite: bool,
    /// For each axis, the forces on the bodies connected with it by contacts.
    pub load: [Load; 2],
}

impl BodyState {
    /// Reads both cache lines of the record; returns a number that depends on them, so that the reading is not
    /// optimised away.
    #[inline]
    pub fn read_ahead(&self) -> f64 {
        self.trajectory.position[0] + self.size[0]
    }

    /// True if it never moves: an infinite mass at rest.
    pub fn is_static(&self) -> bool {
        self.infinite && self.trajectory.is_at_rest()
    }
}

/// The forces on bodies connected by contacts along an axis, besides the contact forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// Gravity alone.
    GravityOnly,
    /// A body of the component carries a constant force.
    OwnForces,
}

/// The data of a body that predictions do not read: two adjacent cache lines, which processors fetch together.
#[derive(Clone, Debug)]
#[repr(C, align(128))]
pub struct BodyDetails {
    /// The low parts of its trajectory along x and y.
    pub low_parts: [AxisLowParts; 2],
    /// The data that no impact changes.
    pub params: BodyParams,
}

/// The data of a body that no impact changes.
#[derive(Clone, Debug)]
pub struct BodyParams {
    /// Its id in the world.
    pub id: BodyId,
    /// Mass, kg, times [`MASS_SCALE`].
    pub mass: DoubleDouble,
    /// Material, for the restitution table.
    pub material: Material,
    /// Acceleration without contacts, m/s².
    pub free_acceleration: [DoubleDouble; 2],
    /// For each axis, true if a constant force acts on it along that axis.
    pub has_force: [bool; 2],
    /// False once the body is deleted; its slot stays.
    pub alive: bool,
}
