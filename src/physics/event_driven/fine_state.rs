//! Motions to 32 digits: what collisions are computed with.
//!
//! Rounding errors of each collision grow with the next ones: under gravity sixteen digits
//! are used up after some hundred collisions. So what a motion *is* has thirty-two;
//! prediction, which asks far more often than anything happens, reads the upper sixteen.

use super::EventDriven;
use super::double_double::{Double, DoubleDouble};
use super::instant::Instant;
use super::motion::Motion;
use super::mover::Slot;
use super::side_by_side::SideBySide;

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

/// Those of a body along both axes: one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Residues(pub [Residue; 2]);

/// Where a body is along an axis at an instant, and how it moves on.
#[derive(Clone, Copy, Debug)]
pub struct FineState<T = f64> {
    /// m.
    pub position: DoubleDouble<T>,
    /// m/s.
    pub velocity: DoubleDouble<T>,
    /// m/s².
    pub acceleration: DoubleDouble<T>,
}

impl<T: Double> FineState<T> {
    /// The same motion t seconds later, if nothing accelerates.
    #[inline]
    fn drifted(self, t: DoubleDouble<T>) -> FineState<T> {
        FineState { position: self.position + self.velocity * t, ..self }
    }

    /// The same motion t seconds later, if it accelerates.
    #[inline]
    fn fallen(self, t: DoubleDouble<T>) -> FineState<T> {
        let FineState { position, velocity, acceleration } = self;
        let gain = acceleration * t;
        FineState { position: position + (velocity + gain.half()) * t, velocity: velocity + gain, acceleration }
    }
}

impl FineState {
    /// Whether it neither moves nor begins to.
    #[inline]
    fn is_still(&self) -> bool {
        (self.velocity.high == 0.0) & (self.acceleration.high == 0.0)
    }

    /// The same motion t seconds later.
    #[inline]
    pub fn after(&self, t: DoubleDouble) -> FineState {
        if self.acceleration.high == 0.0 { self.drifted(t) } else { self.fallen(t) }
    }
}

impl FineState<SideBySide> {
    /// Those of two bodies.
    #[inline]
    fn of(states: [FineState; 2]) -> FineState<SideBySide> {
        let [first, second] = states;
        FineState {
            position: DoubleDouble::of([first.position, second.position]),
            velocity: DoubleDouble::of([first.velocity, second.velocity]),
            acceleration: DoubleDouble::of([first.acceleration, second.acceleration]),
        }
    }

    /// That of each of the two.
    #[inline]
    fn apart(self) -> [FineState; 2] {
        let [position, velocity, acceleration] =
            [self.position.apart(), self.velocity.apart(), self.acceleration.apart()];
        [0, 1].map(|place| FineState {
            position: position[place],
            velocity: velocity[place],
            acceleration: acceleration[place],
        })
    }
}

/// The motions of two bodies, each so many seconds later.
#[inline]
pub fn both_after(states: [FineState; 2], t: DoubleDouble<SideBySide>) -> [FineState; 2] {
    let accelerate = [states[0].acceleration.high != 0.0, states[1].acceleration.high != 0.0];
    if accelerate == [false; 2] {
        FineState::of(states).drifted(t).apart()
    } else if accelerate == [true; 2] {
        FineState::of(states).fallen(t).apart()
    } else {
        let [first, second] = t.apart();
        [states[0].after(first), states[1].after(second)]
    }
}

impl EventDriven {
    /// The state of a body along an axis at the present instant.
    #[inline]
    pub(super) fn fine(&self, slot: Slot, axis: usize) -> FineState {
        let reference = self.reference(slot, axis);
        if reference.is_still() || self.is_fresh(slot, axis) {
            return reference;
        }
        reference.after(self.age(slot, axis))
    }

    /// Those of two bodies, and the seconds since their references.
    #[inline]
    pub(super) fn both_fine(&self, slots: [Slot; 2], axis: usize) -> ([FineState; 2], [f64; 2]) {
        let references = [self.reference(slots[0], axis), self.reference(slots[1], axis)];
        let ages = self.ages(slots, axis);
        let later = both_after(references, ages);
        let stands = |place: usize| references[place].is_still() | self.is_fresh(slots[place], axis);
        let state = |place: usize| if stands(place) { references[place] } else { later[place] };
        ([state(0), state(1)], ages.high.0)
    }

    /// Its velocity alone, m/s.
    #[inline]
    pub(super) fn fine_velocity(&self, slot: Slot, axis: usize) -> DoubleDouble {
        let reference = self.reference(slot, axis);
        if reference.acceleration.high == 0.0 || self.is_fresh(slot, axis) {
            return reference.velocity;
        }
        reference.velocity + reference.acceleration * self.age(slot, axis)
    }

    /// The state at the reference instant.
    #[inline]
    fn reference(&self, slot: Slot, axis: usize) -> FineState {
        let motion = &self.movers[slot as usize].motion;
        let residue = &self.residues[slot as usize].0[axis];
        FineState {
            position: DoubleDouble { high: motion.position[axis], low: residue.position },
            velocity: DoubleDouble { high: motion.velocity[axis], low: residue.velocity },
            acceleration: self.acceleration(slot, axis),
        }
    }

    /// The acceleration of a body along an axis, m/s².
    #[inline]
    pub(super) fn acceleration(&self, slot: Slot, axis: usize) -> DoubleDouble {
        let high = self.movers[slot as usize].motion.acceleration[axis];
        DoubleDouble { high, low: self.residues[slot as usize].0[axis].acceleration }
    }

    /// Whether the present instant is the reference.
    #[inline]
    fn is_fresh(&self, slot: Slot, axis: usize) -> bool {
        self.movers[slot as usize].motion.since(axis) == self.now
            && self.residues[slot as usize].0[axis].offset == self.now_residue
    }

    /// Seconds from the reference instant to the present one.
    #[inline]
    pub(super) fn age(&self, slot: Slot, axis: usize) -> DoubleDouble {
        let since = self.movers[slot as usize].motion.since(axis);
        let from = DoubleDouble { high: since.offset, low: self.residues[slot as usize].0[axis].offset };
        let offset = DoubleDouble { high: self.now.offset, low: self.now_residue } - from;
        if self.now.step == since.step {
            return offset;
        }
        self.clock.exact_period * DoubleDouble::from(self.now.step - since.step) + offset
    }

    /// Seconds from the reference instants of two bodies to the present one.
    #[inline]
    fn ages(&self, slots: [Slot; 2], axis: usize) -> DoubleDouble<SideBySide> {
        let since = [0, 1].map(|place| self.movers[slots[place] as usize].motion.since(axis));
        let residues = [0, 1].map(|place| self.residues[slots[place] as usize].0[axis].offset);
        let from = DoubleDouble { high: SideBySide(since.map(|since| since.offset)), low: SideBySide(residues) };
        let offset =
            DoubleDouble { high: SideBySide::all(self.now.offset), low: SideBySide::all(self.now_residue) } - from;
        let steps = since.map(|since| self.now.step - since.step);
        if steps == [0.0; 2] {
            return offset;
        }
        let period = self.clock.exact_period;
        let period = DoubleDouble { high: SideBySide::all(period.high), low: SideBySide::all(period.low) };
        period * DoubleDouble::from(SideBySide(steps)) + offset
    }

    /// Gives a body a new motion along one axis from now on.
    pub(super) fn redirect(&mut self, slot: Slot, axis: usize, state: FineState) {
        let FineState { position, velocity, acceleration } = state;
        let mover = &mut self.movers[slot as usize];
        let [position_now, velocity_now, acceleration_now] =
            [position, velocity, acceleration].map(|number| number.high);
        let since = self.now;
        let motion = Motion { position: position_now, velocity: velocity_now, acceleration: acceleration_now, since };
        mover.motion.set(axis, motion);
        mover.since = mover.motion.latest();
        self.residues[slot as usize].0[axis] = Residue {
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
