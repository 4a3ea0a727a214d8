//! The impact law and the criteria of inelastic collapse, as formulas.

use super::double_double::DoubleDouble;
use super::f64x2::F64x2;

/// Two clusters that collide along an axis; the one on the low side first.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    /// Velocities along the axis, m/s; the first is the greater one.
    pub velocity: [DoubleDouble; 2],
    /// Masses, kg; infinite for a cluster that cannot move.
    pub mass: [f64; 2],
    /// Coefficient of restitution; 0 for a plastic impact.
    pub restitution: f64,
}

impl Impact {
    /// The velocities after the impact, m/s: momentum is conserved, the relative velocity is multiplied by −e.
    ///
    /// v₁′ = v₁ − (1+e)·m₂/(m₁+m₂)·(v₁−v₂) and v₂′ = v₂ + (1+e)·m₁/(m₁+m₂)·(v₁−v₂)
    /// (Newton's impact law). Two equal masses with e = 1 exchange their velocities without
    /// rounding, and with e = 0 both velocities are the same number.
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
        let approach = DoubleDouble::two_sum(1.0, self.restitution) * (first - second);
        let after = [first - share_first * approach, second + share_second * approach];
        if (after[0] - after[1]).high > 0.0 { [after[0]; 2] } else { after }
    }

    /// The impulse from the first on the second, N·s.
    pub fn impulse(&self) -> f64 {
        let approach = (1.0 + self.restitution) * (self.velocity[0] - self.velocity[1]).high;
        approach / (1.0 / self.mass[0] + 1.0 / self.mass[1])
    }

    /// The share of each of the two in the change of relative velocity: the mass fraction of the other.
    fn shares(&self) -> [DoubleDouble; 2] {
        if self.mass[0] == self.mass[1] {
            return [DoubleDouble::from(0.5); 2];
        }
        let sum = DoubleDouble::two_sum(self.mass[0], self.mass[1]);
        let others = DoubleDouble::from(F64x2([self.mass[1], self.mass[0]]));
        (others / DoubleDouble::pack([sum; 2])).unpack()
    }
}

/// Displacements below this fraction of the coordinates are rounding.
const NEGLIGIBLE: f64 = 128.0 * f64::EPSILON;

/// The speed below which an impact with e < 1 is plastic, m/s.
///
/// A body that rebounds at this speed would rise by at most h = [`NEGLIGIBLE`] × `coordinate_scale`,
/// v = √(2·a·h), so all further bounces would be rounding, not motion. This ends an infinite
/// sequence of bounces; the part cut off lasts less than 2·v/(a·(1 − e)). Without acceleration,
/// the limit is h per second, or [`NEGLIGIBLE`] × `speed_sum` if that is greater.
///
/// `acceleration` is the greater of the two free accelerations, m/s²; `coordinate_scale` the sum of
/// the coordinates and sizes of the two, m; `speed_sum` the sum of their speeds, m/s.
pub fn collapse_speed(acceleration: f64, coordinate_scale: f64, speed_sum: f64) -> f64 {
    let limits = [
        (2.0 * acceleration * coordinate_scale * NEGLIGIBLE).sqrt(),
        coordinate_scale * NEGLIGIBLE,
        speed_sum * NEGLIGIBLE,
    ];
    limits.into_iter().fold(0.0, |greatest, limit| if limit > greatest { limit } else { greatest })
}

/// After more consecutive impacts than this without displacement between them, e < 1 is replaced by 0.
///
/// A light box under a heavy falling one bounces faster and faster in a gap that shrinks to
/// zero in finite time (inelastic collapse). Both come to rest only after infinitely many impacts, too small to
/// resolve; their limit is one plastic impact.
pub const COLLAPSE_LIMIT: u8 = 100;

/// True if a displacement (m) is within the rounding of coordinates that add up to `coordinate_scale` (m).
pub fn is_negligible(displacement: f64, coordinate_scale: f64) -> bool {
    displacement <= coordinate_scale * NEGLIGIBLE
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(velocity: [f64; 2], mass: [f64; 2], restitution: f64) -> [f64; 2] {
        let velocity = velocity.map(DoubleDouble::from);
        Impact { velocity, mass, restitution }.velocities_after().map(|velocity| velocity.high)
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
    fn after_a_plastic_impact_both_velocities_are_the_same_number() {
        assert_eq!(after([1.0, -1.0], [3.0, 1.0], 0.0), [0.5, 0.5]);
    }

    #[test]
    fn momentum_is_conserved_and_the_relative_velocity_reversed() {
        let after = after([4.0, -2.0], [1.0, 3.0], 0.5);
        assert_eq!(after, [-2.75, 0.25]);
        assert_eq!(after[0] + 3.0 * after[1], 4.0 - 6.0);
        assert_eq!(after[1] - after[0], 0.5 * 6.0);
    }
}
