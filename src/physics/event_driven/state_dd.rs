//! The state of a body along one axis in double-double arithmetic, in which collisions are computed.
//!
//! A rounding error in one collision grows with each following one: under gravity the 16 digits of a
//! double are used up after some hundred collisions. So trajectories are stored with 32 digits.
//! Predictions, far more frequent than events, use only the high parts.

use super::EventDriven;
use super::axis_trajectory::AxisTrajectory;
use super::body_state::Slot;
use super::double_double::DoubleDouble;
use super::instant::Instant;
use crate::physics::Axis;

/// The low parts of the numbers of an [`AxisTrajectory`], which contains the high parts.
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
    fn is_at_rest(&self) -> bool {
        (self.velocity.high == 0.0) & (self.acceleration.high == 0.0)
    }

    /// The state t seconds later.
    #[inline]
    pub fn after(&self, t: DoubleDouble) -> StateDd {
        if self.acceleration.high == 0.0 { self.after_uniform(t) } else { self.after_accelerated(t) }
    }
}

impl EventDriven {
    /// The state of a body along an axis at the present instant.
    #[inline]
    pub(super) fn state_dd(&self, slot: Slot, axis: Axis) -> StateDd {
        self.state_at(slot, axis, self.now)
    }

    /// The state of a body along an axis at an instant.
    #[inline]
    pub(super) fn state_at(&self, slot: Slot, axis: Axis, at: Instant) -> StateDd {
        let reference = self.reference_state(slot, axis);
        let since = self.states[slot as usize].trajectory.since(axis);
        if reference.is_at_rest() || since == at {
            return reference;
        }
        reference.after(since.exact_seconds_until(at))
    }

    /// The state of a body along an axis at its reference instant.
    #[inline]
    fn reference_state(&self, slot: Slot, axis: Axis) -> StateDd {
        let trajectory = &self.states[slot as usize].trajectory;
        let low = &self.low_parts[slot as usize].0[axis];
        StateDd {
            position: DoubleDouble { high: trajectory.position[axis], low: low.position },
            velocity: DoubleDouble { high: trajectory.velocity[axis], low: low.velocity },
            acceleration: self.acceleration(slot, axis),
        }
    }

    /// The acceleration of a body along an axis, m/s².
    #[inline]
    pub(super) fn acceleration(&self, slot: Slot, axis: Axis) -> DoubleDouble {
        let high = self.states[slot as usize].trajectory.acceleration[axis];
        DoubleDouble { high, low: self.low_parts[slot as usize].0[axis].acceleration }
    }

    /// The size of a body along an axis, m.
    #[inline]
    pub(super) fn size(&self, slot: Slot, axis: Axis) -> DoubleDouble {
        DoubleDouble { high: self.states[slot as usize].size[axis], low: self.low_parts[slot as usize].0[axis].size }
    }

    /// Sets the trajectory of a body along one axis from the present instant on, which becomes its
    /// reference, and invalidates the body's predictions.
    pub(super) fn set_trajectory(&mut self, slot: Slot, axis: Axis, state: StateDd) {
        let StateDd { position, velocity, acceleration } = state;
        let body = &mut self.states[slot as usize];
        let [position_now, velocity_now, acceleration_now] =
            [position, velocity, acceleration].map(|number| number.high);
        let since = self.now;
        let trajectory =
            AxisTrajectory { position: position_now, velocity: velocity_now, acceleration: acceleration_now, since };
        body.trajectory.set(axis, trajectory);
        body.since = body.trajectory.latest();
        let low = &mut self.low_parts[slot as usize].0[axis];
        *low = AxisLowParts {
            position: position.low,
            velocity: velocity.low,
            acceleration: acceleration.low,
            size: low.size,
        };
        self.invalidate(slot);
    }

    /// Sets the present instant, unless the given one is in the past.
    pub(super) fn advance_clock(&mut self, instant: Instant) {
        self.now = self.now.max(instant);
    }
}
