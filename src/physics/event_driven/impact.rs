//! What a blow does to velocities: the formulas, and nothing of the world.

use super::double_double::DoubleDouble;
use super::side_by_side::SideBySide;

/// Velocities along the normal, in order along the axis, and what the impact law needs of the two.
#[derive(Clone, Copy, Debug)]
pub struct Blow {
    /// m/s; the first is faster.
    pub velocity: [DoubleDouble; 2],
    /// kg; infinite for what cannot give way.
    pub mass: [f64; 2],
    /// Coefficient of restitution; 0 for a plastic impact.
    pub restitution: f64,
}

impl Blow {
    /// The velocities after the impact, m/s: momentum kept, relative velocity times −e.
    ///
    /// v₁′ = v₁ − (1+e)·m₂/(m₁+m₂)·(v₁−v₂) and v₂′ = v₂ + (1+e)·m₁/(m₁+m₂)·(v₁−v₂)
    /// (Newton's law of impact). Two equal masses at e = 1 exchange their velocities without
    /// any rounding, and after e = 0 both are the same number.
    pub fn velocities_after(&self) -> [DoubleDouble; 2] {
        let [first, second] = self.velocity;
        let e = DoubleDouble::from(self.restitution);
        if self.mass[0] == f64::INFINITY {
            return [first, first + e * (first - second)];
        }
        if self.mass[1] == f64::INFINITY {
            return [second - e * (first - second), second];
        }
        if self.restitution == 1.0 && self.mass[0] == self.mass[1] {
            return [second, first];
        }
        let [share_first, share_second] = self.shares();
        if self.restitution == 0.0 {
            let common = first - share_first * (first - second);
            return [common; 2];
        }
        let approach = DoubleDouble::sum(1.0, self.restitution) * (first - second);
        let after = [first - share_first * approach, second + share_second * approach];
        if (after[0] - after[1]).high > 0.0 { [after[0]; 2] } else { after }
    }

    /// The impulse the first gives the second, N·s.
    pub fn impulse(&self) -> f64 {
        let approach = (1.0 + self.restitution) * (self.velocity[0] - self.velocity[1]).high;
        approach / (1.0 / self.mass[0] + 1.0 / self.mass[1])
    }

    /// Which part of the approach each of the two makes up for: the other's part of the mass.
    fn shares(&self) -> [DoubleDouble; 2] {
        if self.mass[0] == self.mass[1] {
            return [DoubleDouble::from(0.5); 2];
        }
        let sum = DoubleDouble::sum(self.mass[0], self.mass[1]);
        let others = DoubleDouble::from(SideBySide([self.mass[1], self.mass[0]]));
        (others / DoubleDouble::of([sum; 2])).apart()
    }
}

/// Ways and heights of this many units in the last place of the coordinates are rounding.
const C: f64 = 128.0 * f64::EPSILON;

/// An impact slower than this is plastic where e < 1, m/s.
///
/// Bouncing up at this speed a body would rise by no more than C units in the last place of
/// its coordinates, v = √(2·a·C·ulp), and the bounces after that would be rounding, not
/// motion. So ends a Zeno sequence of bounces; what is cut off takes less than
/// 2·v/(a·(1 − e)). Where nothing accelerates, the limit is a motion by C units in the last
/// place of the coordinates in a second, or of the velocities, if that is more.
pub fn capture_speed(acceleration: f64, coordinates: f64, velocities: f64) -> f64 {
    let limits = [(2.0 * acceleration * coordinates * C).sqrt(), coordinates * C, velocities * C];
    limits.into_iter().fold(0.0, |greatest, limit| if limit > greatest { limit } else { greatest })
}

/// After this many impacts in a row without a way between them, e < 1 becomes 0.
///
/// A light box under a heavy falling one bounces faster and faster in a gap that shrinks to
/// nothing in finite time, and only after infinitely many impacts, all below any
/// resolution, are both at rest. That limit is the plastic impact of all of them.
pub const LONGEST_HURRY: u8 = 100;

/// Whether a way, m, is nothing among coordinates of that size, m.
pub fn is_no_way(way: f64, coordinates: f64) -> bool {
    way <= coordinates * C
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(velocity: [f64; 2], mass: [f64; 2], restitution: f64) -> [f64; 2] {
        let velocity = velocity.map(DoubleDouble::from);
        Blow { velocity, mass, restitution }.velocities_after().map(|velocity| velocity.high)
    }

    #[test]
    fn equal_masses_exchange_their_velocities_exactly() {
        assert_eq!(after([0.1, 0.7 - 1.0], [3.0; 2], 1.0), [0.7 - 1.0, 0.1]);
    }

    #[test]
    fn an_infinite_mass_keeps_its_velocity() {
        assert_eq!(after([3.0, 1.0], [2.0, f64::INFINITY], 1.0), [-1.0, 1.0]);
        assert_eq!(after([3.0, 1.0], [f64::INFINITY, 2.0], 0.5), [3.0, 4.0]);
    }

    #[test]
    fn plastic_partners_leave_with_the_same_number() {
        assert_eq!(after([1.0, -1.0], [3.0, 1.0], 0.0), [0.5, 0.5]);
    }

    #[test]
    fn momentum_is_kept_and_the_approach_reversed() {
        let after = after([4.0, -2.0], [1.0, 3.0], 0.5);
        assert_eq!(after, [-2.75, 0.25]);
        assert_eq!(after[0] + 3.0 * after[1], 4.0 - 6.0);
        assert_eq!(after[1] - after[0], 0.5 * 6.0);
    }
}
