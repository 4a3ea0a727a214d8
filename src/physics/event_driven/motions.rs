use super::instant::{Clock, Instant};
use super::motion::Motion;
use super::mover::AXES;

/// How a body moves along both axes.
///
/// The same numbers of the two axes lie side by side, so that the processor computes both at once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Motions {
    /// m.
    pub position: [f64; 2],
    /// m/s.
    pub velocity: [f64; 2],
    /// The steps of the reference instants.
    step: [f64; 2],
    /// Their offsets, s.
    offset: [f64; 2],
    /// m/s².
    pub acceleration: [f64; 2],
}

impl Motions {
    /// Of the motions along x and y.
    pub fn new(along: [Motion; 2]) -> Motions {
        Motions {
            position: along.map(|motion| motion.position),
            velocity: along.map(|motion| motion.velocity),
            step: along.map(|motion| motion.since.step),
            offset: along.map(|motion| motion.since.offset),
            acceleration: along.map(|motion| motion.acceleration),
        }
    }

    /// The motion along an axis.
    #[inline]
    pub fn along(&self, axis: usize) -> Motion {
        let [position, velocity, acceleration] = [self.position, self.velocity, self.acceleration].map(|of| of[axis]);
        Motion { position, velocity, acceleration, since: self.since(axis) }
    }

    /// The reference instant of an axis.
    #[inline]
    pub fn since(&self, axis: usize) -> Instant {
        Instant { step: self.step[axis], offset: self.offset[axis] }
    }

    /// Replaces the motion along an axis.
    #[inline]
    pub fn set(&mut self, axis: usize, motion: Motion) {
        self.position[axis] = motion.position;
        self.velocity[axis] = motion.velocity;
        self.acceleration[axis] = motion.acceleration;
        self.step[axis] = motion.since.step;
        self.offset[axis] = motion.since.offset;
    }

    /// Positions, m, and velocities, m/s, at an instant.
    #[inline]
    pub fn at(&self, clock: &Clock, instant: Instant) -> [[f64; 2]; 2] {
        let t = AXES.map(|axis| clock.seconds(self.since(axis), instant));
        let half = AXES.map(|axis| 0.5 * self.acceleration[axis] * t[axis]);
        let position = AXES.map(|axis| self.position[axis] + t[axis] * (self.velocity[axis] + half[axis]));
        [position, AXES.map(|axis| self.velocity[axis] + self.acceleration[axis] * t[axis])]
    }

    /// The same where nothing accelerates.
    #[inline]
    pub fn drifted(&self, clock: &Clock, instant: Instant) -> [[f64; 2]; 2] {
        let t = AXES.map(|axis| clock.seconds(self.since(axis), instant));
        [AXES.map(|axis| self.position[axis] + t[axis] * self.velocity[axis]), self.velocity]
    }

    /// The later of the two reference instants.
    #[inline]
    pub fn latest(&self) -> Instant {
        self.since(0).or_later(self.since(1))
    }

    /// Whether it neither moves nor begins to.
    pub fn is_still(&self) -> bool {
        (self.velocity == [0.0; 2]) & (self.acceleration == [0.0; 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_starts_at_its_reference() {
        let since = Instant::start_of(2);
        let thrown = Motion { position: 1.0, velocity: 3.0, acceleration: -2.0, since };
        let drifting = Motion { acceleration: 0.0, ..thrown };
        let clock = Clock::new(2.0);
        let motions = Motions::new([thrown, drifting]);
        assert_eq!(motions.at(&clock, since), [[1.0; 2], [3.0; 2]]);
        assert_eq!(motions.at(&clock, Instant::start_of(4)), [[3.0, 4.0], [1.0, 3.0]]);
        assert_eq!(motions.drifted(&clock, Instant::start_of(4))[0][1], 4.0);
        assert_eq!(motions.along(0), thrown);
    }
}
