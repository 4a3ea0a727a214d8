use super::axis_trajectory::AxisTrajectory;
use super::instant::{Clock, Instant};
use crate::physics::Axis;

/// The ballistic trajectory of a body along both axes.
///
/// Stored by quantity, not by axis, so that both axes are computed in one SIMD register.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Trajectory {
    /// Positions at the reference instants, m.
    pub position: [f64; 2],
    /// Velocities at the reference instants, m/s.
    pub velocity: [f64; 2],
    /// The steps of the reference instants.
    step: [f64; 2],
    /// The offsets of the reference instants within their steps, s.
    offset: [f64; 2],
    /// Constant accelerations, m/s².
    pub acceleration: [f64; 2],
}

impl Trajectory {
    /// Combines the trajectories along x and y.
    pub fn new(axes: [AxisTrajectory; 2]) -> Trajectory {
        Trajectory {
            position: axes.map(|trajectory| trajectory.position),
            velocity: axes.map(|trajectory| trajectory.velocity),
            step: axes.map(|trajectory| trajectory.since.step),
            offset: axes.map(|trajectory| trajectory.since.offset),
            acceleration: axes.map(|trajectory| trajectory.acceleration),
        }
    }

    /// The trajectory along an axis.
    #[inline]
    pub fn along(&self, axis: Axis) -> AxisTrajectory {
        let [position, velocity, acceleration] =
            [self.position, self.velocity, self.acceleration].map(|pair| pair[axis]);
        AxisTrajectory { position, velocity, acceleration, since: self.since(axis) }
    }

    /// The reference instant of an axis.
    #[inline]
    pub fn since(&self, axis: Axis) -> Instant {
        Instant { step: self.step[axis], offset: self.offset[axis] }
    }

    /// Replaces the trajectory along an axis.
    #[inline]
    pub fn set(&mut self, axis: Axis, trajectory: AxisTrajectory) {
        self.position[axis] = trajectory.position;
        self.velocity[axis] = trajectory.velocity;
        self.acceleration[axis] = trajectory.acceleration;
        self.step[axis] = trajectory.since.step;
        self.offset[axis] = trajectory.since.offset;
    }

    /// Positions (m) and velocities (m/s) at an instant.
    #[inline]
    pub fn at(&self, clock: &Clock, instant: Instant) -> [[f64; 2]; 2] {
        let t = Axis::BOTH.map(|axis| clock.seconds_between(self.since(axis), instant));
        let half = Axis::BOTH.map(|axis| 0.5 * self.acceleration[axis] * t[axis]);
        let position = Axis::BOTH.map(|axis| self.position[axis] + t[axis] * (self.velocity[axis] + half[axis]));
        [position, Axis::BOTH.map(|axis| self.velocity[axis] + self.acceleration[axis] * t[axis])]
    }

    /// Positions (m) and velocities (m/s) at an instant, for accelerations of zero.
    #[inline]
    pub fn drifted(&self, clock: &Clock, instant: Instant) -> [[f64; 2]; 2] {
        let t = Axis::BOTH.map(|axis| clock.seconds_between(self.since(axis), instant));
        [Axis::BOTH.map(|axis| self.position[axis] + t[axis] * self.velocity[axis]), self.velocity]
    }

    /// The later of the two reference instants.
    #[inline]
    pub fn latest(&self) -> Instant {
        self.since(Axis::X).max(self.since(Axis::Y))
    }

    /// True if velocity and acceleration are zero.
    pub fn is_at_rest(&self) -> bool {
        (self.velocity == [0.0; 2]) & (self.acceleration == [0.0; 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trajectory_is_a_parabola_from_its_reference_instant() {
        let since = Instant::start_of(2);
        let thrown = AxisTrajectory { position: 1.0, velocity: 3.0, acceleration: -2.0, since };
        let drifting = AxisTrajectory { acceleration: 0.0, ..thrown };
        let clock = Clock::new(2.0);
        let trajectory = Trajectory::new([thrown, drifting]);
        assert_eq!(trajectory.at(&clock, since), [[1.0; 2], [3.0; 2]]);
        assert_eq!(trajectory.at(&clock, Instant::start_of(4)), [[3.0, 4.0], [1.0, 3.0]]);
        assert_eq!(trajectory.drifted(&clock, Instant::start_of(4))[0][1], 4.0);
        assert_eq!(trajectory.along(Axis::X), thrown);
    }
}
