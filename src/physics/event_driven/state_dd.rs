//! The state of a body along one axis in double-double arithmetic, in which collisions are computed.
//!
//! A rounding error in one collision grows with each following one: under gravity the 16 digits of a
//! double are used up after a few hundred collisions. So trajectories are stored with 32 digits.
//! Predictions, far more frequent than events, use only the high parts.

use super::double_double::DoubleDouble;

/// The low parts of the numbers of an [`AxisTrajectory`](super::axis_trajectory::AxisTrajectory), which contains the high parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisLowParts {
    /// Low part of the position, m.
    pub position: f64,
    /// Low part of the velocity, m/s.
    pub velocity: f64,
    /// Low part of the acceleration, m/s².
    pub acceleration: f64,
    /// Low part of the size, m: what makes faces coincide that decimal coordinates leave an ulp apart.
    pub size: f64,
}

/// The low parts of a body's trajectory along x and y: one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct LowParts(pub [AxisLowParts; 2]);

/// The state of a body along one axis in double-double precision.
#[derive(Clone, Copy, Debug)]
pub struct StateDd {
    /// Position, m.
    pub position: DoubleDouble,
    /// Velocity, m/s.
    pub velocity: DoubleDouble,
    /// Constant acceleration, m/s².
    pub acceleration: DoubleDouble,
}

impl StateDd {
    /// The state t seconds later, for zero acceleration.
    #[inline]
    fn after_uniform(self, t: DoubleDouble) -> StateDd {
        StateDd { position: self.position + self.velocity * t, ..self }
    }

    /// The state t seconds later, for any acceleration.
    #[inline]
    fn after_accelerated(self, t: DoubleDouble) -> StateDd {
        let StateDd { position, velocity, acceleration } = self;
        let gain = acceleration * t;
        StateDd { position: position + (velocity + gain.half()) * t, velocity: velocity + gain, acceleration }
    }
}

impl StateDd {
    /// Returns true if velocity and acceleration are zero.
    #[inline]
    pub fn is_at_rest(&self) -> bool {
        (self.velocity.high == 0.0) & (self.acceleration.high == 0.0)
    }

    /// The state t seconds later.
    #[inline]
    pub fn after(&self, t: DoubleDouble) -> StateDd {
        if self.acceleration.high == 0.0 { self.after_uniform(t) } else { self.after_accelerated(t) }
    }
}
