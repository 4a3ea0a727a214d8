use super::axis_trajectory::StateDd;
use super::double_double::DoubleDouble;
use super::instant::Instant;
use super::random_rounding::RandomRounding;

/// The fraction of the path since step 0 that counts as one of the numbers a state was computed from: an instant is
/// rounded to 2⁻¹⁰⁶ of the time since step 0, which is less than this fraction of the rounding of velocities.
const TIME_SHARE: f64 = 1.0 / (1_u64 << 12) as f64;

/// A body along an axis at its reference instant, from which all its later states follow.
///
/// The functions that compute states, and those that use them for an impact, are inlined: passing this many numbers
/// costs as much as the arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// The state at the instant.
    pub state: StateDd,
    /// The instant.
    pub since: Instant,
    /// The size, m.
    pub size: DoubleDouble,
    /// Magnitude of the acceleration without contacts, m/s².
    pub free_acceleration: f64,
}

/// The magnitudes of the numbers from which a state along an axis was computed; its rounding errors are proportional to
/// them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Magnitudes {
    /// Of the position, m.
    pub position: f64,
    /// Of the velocity, m/s.
    pub velocity: f64,
    /// Of the acceleration, m/s².
    pub acceleration: f64,
}

/// The state of a body along an axis with the magnitudes of the numbers it was computed from.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScaledState {
    /// The state.
    pub state: StateDd,
    /// The magnitudes.
    pub magnitudes: Magnitudes,
}

impl Reference {
    /// The state at an instant.
    #[inline(always)]
    pub fn state_at(&self, at: Instant, rounding: RandomRounding) -> StateDd {
        if self.state.is_at_rest() || self.since == at {
            return self.state;
        }
        let t = self.since.exact_seconds_until(at);
        rounding.state(self.state, t, self.state.after(t))
    }

    /// The state at an instant with its magnitudes.
    #[inline(always)]
    pub fn scaled_state_at(&self, at: Instant, rounding: RandomRounding) -> ScaledState {
        self.scaled(at, self.state_at(at, rounding))
    }

    /// The states of two bodies at an instant with their magnitudes.
    #[inline(always)]
    pub fn scaled_states_at(references: &[Reference; 2], at: Instant, rounding: RandomRounding) -> [ScaledState; 2] {
        let [first, second] = Reference::states_at(references, at, rounding);
        [references[0].scaled(at, first), references[1].scaled(at, second)]
    }

    /// The position at an instant of a body without acceleration, without random rounding: the same number as that of
    /// [`state_at`](Self::state_at).
    #[inline(always)]
    pub fn drifted_position_at(&self, at: Instant) -> DoubleDouble {
        let StateDd { position, velocity, .. } = self.state;
        if velocity.high == 0.0 || self.since == at {
            return position;
        }
        position + velocity * self.since.exact_seconds_until(at)
    }

    /// The states of two bodies at an instant.
    #[inline(always)]
    fn states_at([first, second]: &[Reference; 2], at: Instant, rounding: RandomRounding) -> [StateDd; 2] {
        let is_kept = |reference: &Reference| reference.state.is_at_rest() | (reference.since == at);
        if is_kept(first) | is_kept(second) {
            return [first.state_at(at, rounding), second.state_at(at, rounding)];
        }
        let t = (DoubleDouble::pair([at.as_number(); 2])
            - DoubleDouble::pair([first.since.as_number(), second.since.as_number()]))
        .lanes();
        let after = StateDd::both_after([first.state, second.state], t);
        [rounding.state(first.state, t[0], after[0]), rounding.state(second.state, t[1], after[1])]
    }

    /// The state at an instant with its magnitudes, given the state.
    #[inline(always)]
    fn scaled(&self, at: Instant, state: StateDd) -> ScaledState {
        let t = self.since.seconds_until(at);
        let acceleration = self.state.acceleration.high.abs();
        let velocity = self.state.velocity.high.abs() + acceleration * (t + at.high * TIME_SHARE);
        let position = self.state.position.high.abs() + self.size.high + (t + at.high * TIME_SHARE) * velocity;
        let acceleration = acceleration + self.free_acceleration;
        ScaledState { state, magnitudes: Magnitudes { position, velocity, acceleration } }
    }
}
