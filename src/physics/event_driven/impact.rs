//! The impact law as a formula.

use super::double_double::DoubleDouble;
use crate::physics::Side;

/// Two clusters that collide along an axis; the one on the low side first.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    /// Velocities along the axis, m/s; the first is the greater one, except where a bounce below the resolution of
    /// positions is captured.
    pub velocity: [DoubleDouble; 2],
    /// Masses in any unit; infinite for a cluster that cannot move.
    pub mass: [DoubleDouble; 2],
    /// Coefficient of restitution; 0 for a plastic impact.
    pub restitution: DoubleDouble,
}

impl Impact {
    /// True if one of the two has a finite mass.
    pub fn moves_a_body(&self) -> bool {
        self.mass.iter().any(|mass| mass.high < f64::INFINITY)
    }

    /// The velocities after the impact, m/s: momentum is conserved, the relative velocity is multiplied by −e.
    ///
    /// v₁′ = v₁ − (1+e)·m₂/(m₁+m₂)·(v₁−v₂) and v₂′ = v₂ + (1+e)·m₁/(m₁+m₂)·(v₁−v₂)
    /// (Newton's impact law). Two equal masses with e = 1 exchange their velocities without
    /// rounding, and with e = 0 both velocities are the same number.
    pub fn velocities_after(&self) -> [DoubleDouble; 2] {
        self.velocities_with(self.approach_speed(), || self.shares())
    }

    /// The speed at which the two approach before the impact, m/s.
    #[inline(always)]
    pub fn approach_speed(&self) -> DoubleDouble {
        self.velocity[0] - self.velocity[1]
    }

    /// The velocities after the impact, m/s, with known [approach speed](Self::approach_speed) and
    /// [shares](Self::shares).
    #[inline(always)]
    pub fn velocities_with(
        &self,
        approach_speed: DoubleDouble,
        shares: impl FnOnce() -> [DoubleDouble; 2],
    ) -> [DoubleDouble; 2] {
        let [first, second] = self.velocity;
        let e = self.restitution;
        if self.mass[0].high == f64::INFINITY {
            return [first, first + e * approach_speed];
        }
        if self.mass[1].high == f64::INFINITY {
            return [second - e * approach_speed, second];
        }
        if e.high == 1.0 && self.mass[0] == self.mass[1] {
            return [second, first];
        }
        let [share_first, share_second] = shares();
        if e.high == 0.0 {
            let common = first - share_first * approach_speed;
            return [common; 2];
        }
        let change = (e + 1.0.into()) * approach_speed;
        let [change_first, change_second] =
            (DoubleDouble::pair([share_first, share_second]) * DoubleDouble::pair([change; 2])).lanes();
        let changes = DoubleDouble::pair([-change_first, change_second]);
        let after = (DoubleDouble::pair([first, second]) + changes).lanes();
        if (after[0] - after[1]).high > 0.0 { [after[0]; 2] } else { after }
    }

    /// The impulse from the first on the second, in units of mass × m/s.
    pub fn impulse(&self) -> f64 {
        self.impulse_with(self.approach_speed())
    }

    /// The same impulse, with known [approach speed](Self::approach_speed).
    #[inline(always)]
    pub fn impulse_with(&self, approach_speed: DoubleDouble) -> f64 {
        let change = (1.0 + self.restitution.high) * approach_speed.high;
        if self.mass[0].high == f64::INFINITY {
            change * self.mass[1].high
        } else if self.mass[1].high == f64::INFINITY {
            change * self.mass[0].high
        } else {
            let sum = self.mass[0].high + self.mass[1].high;
            change * (self.mass[0].high * (self.mass[1].high / sum))
        }
    }

    /// True if the [shares](Self::shares) need no rounding.
    pub fn has_exact_shares(&self) -> bool {
        if self.mass[0] == self.mass[1] || self.mass.map(|mass| mass.high).contains(&f64::INFINITY) {
            return true;
        }
        let sum = self.mass[0] + self.mass[1];
        let shares = self.shares();
        Side::BOTH.into_iter().all(|side| shares[side].low == 0.0 && shares[side] * sum == self.mass[side.opposite()])
    }

    /// The share of each of the two in the change of relative velocity: the mass fraction of the other.
    pub fn shares(&self) -> [DoubleDouble; 2] {
        if self.mass[0] == self.mass[1] {
            return [DoubleDouble::from(0.5); 2];
        }
        let sum = self.mass[0] + self.mass[1];
        [self.mass[1] / sum, self.mass[0] / sum]
    }
}

/// The shares of the latest impact, so that two bodies that collide again and again need no division.
#[derive(Clone, Copy, Debug, Default)]
pub struct LatestShares {
    mass: [DoubleDouble; 2],
    shares: [DoubleDouble; 2],
}

impl LatestShares {
    /// The [shares](Impact::shares) of an impact.
    #[inline]
    pub fn of(&mut self, impact: &Impact) -> [DoubleDouble; 2] {
        if self.mass != impact.mass {
            *self = LatestShares { mass: impact.mass, shares: impact.shares() };
        }
        self.shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_shares_are_those_of_the_impact() {
        let mut latest = LatestShares::default();
        for mass in [[1.0, 3.0], [1.0, 3.0], [3.0, 1.0], [2.0, 2.0], [1.0, 3.0]] {
            let impact =
                Impact { velocity: [1.0.into(), 0.0.into()], mass: mass.map(Into::into), restitution: 0.5.into() };
            assert_eq!(latest.of(&impact), impact.shares());
        }
    }

    fn after(velocity: [f64; 2], mass: [f64; 2], restitution: f64) -> [f64; 2] {
        let (velocity, mass) = (velocity.map(DoubleDouble::from), mass.map(DoubleDouble::from));
        Impact { velocity, mass, restitution: restitution.into() }.velocities_after().map(|velocity| velocity.high)
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
