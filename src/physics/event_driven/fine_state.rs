//! Motions to 32 digits: what collisions are computed with.
//!
//! Rounding errors of each collision grow with the next ones: under gravity sixteen digits
//! are used up after some hundred collisions. So what a motion *is* has thirty-two;
//! prediction, which asks far more often than anything happens, reads the upper sixteen.

use super::EventDriven;
use super::double_double::DoubleDouble;
use super::instant::Instant;
use super::motion::Motion;
use super::mover::Slot;

/// What the doubles of a [`Motion`] leave unsaid: the lower halves of its numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residue {
    /// m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
    /// m/s².
    pub acceleration: f64,
    /// Of the reference instant's offset, s.
    pub offset: f64,
}

/// Where a body is along an axis at an instant, and how it moves on.
#[derive(Clone, Copy, Debug)]
pub struct FineState {
    /// m.
    pub position: DoubleDouble,
    /// m/s.
    pub velocity: DoubleDouble,
    /// m/s².
    pub acceleration: DoubleDouble,
}

impl FineState {
    /// The same motion t seconds later.
    #[inline]
    pub fn after(&self, t: DoubleDouble) -> FineState {
        let FineState { position, velocity, acceleration } = *self;
        if acceleration.high == 0.0 {
            return FineState { position: position + velocity * t, ..*self };
        }
        let gain = acceleration * t;
        FineState { position: position + (velocity + gain.half()) * t, velocity: velocity + gain, acceleration }
    }
}

impl EventDriven {
    /// The state of a body along an axis at the present instant.
    #[inline]
    pub(super) fn fine(&self, slot: Slot, axis: usize) -> FineState {
        let motion = &self.movers[slot as usize].motion[axis];
        let residue = &self.residues[slot as usize][axis];
        let reference = FineState {
            position: DoubleDouble { high: motion.position, low: residue.position },
            velocity: DoubleDouble { high: motion.velocity, low: residue.velocity },
            acceleration: DoubleDouble { high: motion.acceleration, low: residue.acceleration },
        };
        if motion.is_still() || (motion.since == self.now && residue.offset == self.now_residue) {
            return reference;
        }
        reference.after(self.age(motion.since, residue.offset))
    }

    /// Seconds from a reference instant to the present one.
    #[inline]
    pub(super) fn age(&self, since: Instant, residue: f64) -> DoubleDouble {
        let [from, to] = [(since.offset, residue), (self.now.offset, self.now_residue)];
        let offset = DoubleDouble { high: to.0, low: to.1 } - DoubleDouble { high: from.0, low: from.1 };
        if self.now.step == since.step {
            return offset;
        }
        self.clock.exact_period * DoubleDouble::from(self.now.step - since.step) + offset
    }

    /// Gives a body a new motion along one axis from now on.
    pub(super) fn redirect(&mut self, slot: Slot, axis: usize, state: FineState) {
        let FineState { position, velocity, acceleration } = state;
        let mover = &mut self.movers[slot as usize];
        mover.motion[axis] = Motion {
            position: position.high,
            velocity: velocity.high,
            acceleration: acceleration.high,
            since: self.now,
        };
        mover.since = mover.motion[0].since.or_later(mover.motion[1].since);
        self.residues[slot as usize][axis] = Residue {
            position: position.low,
            velocity: velocity.low,
            acceleration: acceleration.low,
            offset: self.now_residue,
        };
        self.mark(slot);
    }

    /// Sets the present to an instant, if that is not over yet.
    pub(super) fn advance_to(&mut self, instant: Instant) {
        if self.now.is_before(instant) {
            self.now = instant;
            self.now_residue = 0.0;
        }
    }

    /// Moves the present by less than can be told from rounding; so it may lie just outside of
    /// its step.
    pub(super) fn nudge(&mut self, seconds: f64) {
        let offset = DoubleDouble { high: self.now.offset, low: self.now_residue } + seconds.into();
        self.now.offset = offset.high;
        self.now_residue = offset.low;
    }
}
