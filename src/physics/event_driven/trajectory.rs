use super::axis_trajectory::AxisTrajectory;
use super::instant::Instant;
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
    /// The reference instants, s.
    since_high: [f64; 2],
    /// The low parts of the reference instants, s.
    since_low: [f64; 2],
    /// Constant accelerations, m/s².
    pub acceleration: [f64; 2],
}

impl Trajectory {
    /// Combines the trajectories along x and y.
    pub fn new(axes: [AxisTrajectory; 2]) -> Trajectory {
        Trajectory {
            position: axes.map(|trajectory| trajectory.position),
            velocity: axes.map(|trajectory| trajectory.velocity),
            since_high: axes.map(|trajectory| trajectory.since.high),
            since_low: axes.map(|trajectory| trajectory.since.low),
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
        Instant { high: self.since_high[axis], low: self.since_low[axis] }
    }

    /// Replaces the trajectory along an axis.
    #[inline]
    pub fn set(&mut self, axis: Axis, trajectory: AxisTrajectory) {
        self.position[axis] = trajectory.position;
        self.velocity[axis] = trajectory.velocity;
        self.acceleration[axis] = trajectory.acceleration;
        self.since_high[axis] = trajectory.since.high;
        self.since_low[axis] = trajectory.since.low;
    }

    /// Positions (m) and velocities (m/s) at an instant.
    #[inline]
    pub fn at(&self, instant: Instant) -> [[f64; 2]; 2] {
        let t = Axis::BOTH.map(|axis| self.since(axis).seconds_until(instant));
        let half = Axis::BOTH.map(|axis| 0.5 * self.acceleration[axis] * t[axis]);
        let position = Axis::BOTH.map(|axis| self.position[axis] + t[axis] * (self.velocity[axis] + half[axis]));
        [position, Axis::BOTH.map(|axis| self.velocity[axis] + self.acceleration[axis] * t[axis])]
    }

    /// The magnitudes of the numbers from which [`at`](Self::at) computes the positions, m: their rounding errors are a
    /// few units in the last place of these. They exceed the positions of a body that comes to the origin from afar.
    #[inline]
    pub fn magnitude_at(&self, instant: Instant) -> [f64; 2] {
        let t = Axis::BOTH.map(|axis| self.since(axis).seconds_until(instant).abs());
        let speed = Axis::BOTH.map(|axis| self.velocity[axis].abs() + self.acceleration[axis].abs() * t[axis]);
        Axis::BOTH.map(|axis| self.position[axis].abs() + speed[axis] * t[axis])
    }

    /// Positions (m) and velocities (m/s) at an instant, for accelerations of zero.
    #[inline]
    pub fn drifted(&self, instant: Instant) -> [[f64; 2]; 2] {
        let t = Axis::BOTH.map(|axis| self.since(axis).seconds_until(instant));
        [Axis::BOTH.map(|axis| self.position[axis] + t[axis] * self.velocity[axis]), self.velocity]
    }

    /// The later of the two reference instants.
    #[inline]
    pub fn later_since(&self) -> Instant {
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
        let since = Instant { high: 1.0, low: 0.0 };
        let thrown = AxisTrajectory { position: 1.0, velocity: 3.0, acceleration: -2.0, since };
        let drifting = AxisTrajectory { acceleration: 0.0, ..thrown };
        let trajectory = Trajectory::new([thrown, drifting]);
        assert_eq!(trajectory.at(since), [[1.0; 2], [3.0; 2]]);
        assert_eq!(trajectory.at(Instant { high: 2.0, low: 0.0 }), [[3.0, 4.0], [1.0, 3.0]]);
        assert_eq!(trajectory.drifted(Instant { high: 2.0, low: 0.0 })[0][1], 4.0);
        assert_eq!(trajectory.along(Axis::X), thrown);
    }
}
