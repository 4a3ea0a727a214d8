//! The state of a body along one axis in double-double arithmetic, in which collisions are computed.
//!
//! A rounding error in one collision grows with each following one: under gravity the 16 digits of a
//! double are used up after a few hundred collisions. So trajectories are stored with 32 digits.
//! Predictions, far more frequent than events, use only the high parts.

use super::EventDriven;
use super::axis_trajectory::AxisTrajectory;
use super::body_state::Slot;
use super::double_double::{DoubleDouble, Lanes};
use super::f64x2::F64x2;
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
    /// Low part of the offset of the reference instant, s.
    pub offset: f64,
}

/// The low parts of a body's trajectory along x and y: one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct LowParts(pub [AxisLowParts; 2]);

/// The state of a body along one axis in double-double precision, or of two bodies with `T` = [`F64x2`].
#[derive(Clone, Copy, Debug)]
pub struct StateDd<T = f64> {
    /// Position, m.
    pub position: DoubleDouble<T>,
    /// Velocity, m/s.
    pub velocity: DoubleDouble<T>,
    /// Constant acceleration, m/s².
    pub acceleration: DoubleDouble<T>,
}

impl<T: Lanes> StateDd<T> {
    /// The state t seconds later, for zero acceleration.
    #[inline]
    fn after_uniform(self, t: DoubleDouble<T>) -> StateDd<T> {
        StateDd { position: self.position + self.velocity * t, ..self }
    }

    /// The state t seconds later, for any acceleration.
    #[inline]
    fn after_accelerated(self, t: DoubleDouble<T>) -> StateDd<T> {
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

impl StateDd<F64x2> {
    /// Combines the states of two bodies.
    #[inline]
    fn pack(states: [StateDd; 2]) -> StateDd<F64x2> {
        let [first, second] = states;
        StateDd {
            position: DoubleDouble::pack([first.position, second.position]),
            velocity: DoubleDouble::pack([first.velocity, second.velocity]),
            acceleration: DoubleDouble::pack([first.acceleration, second.acceleration]),
        }
    }

    /// Returns the states of the two bodies.
    #[inline]
    fn unpack(self) -> [StateDd; 2] {
        let [position, velocity, acceleration] =
            [self.position.unpack(), self.velocity.unpack(), self.acceleration.unpack()];
        [0, 1].map(|lane| StateDd {
            position: position[lane],
            velocity: velocity[lane],
            acceleration: acceleration[lane],
        })
    }
}

/// The states of two bodies, each t seconds later.
#[inline]
pub fn advance_both(states: [StateDd; 2], t: DoubleDouble<F64x2>) -> [StateDd; 2] {
    let are_accelerated = [states[0].acceleration.high != 0.0, states[1].acceleration.high != 0.0];
    if are_accelerated == [false; 2] {
        StateDd::pack(states).after_uniform(t).unpack()
    } else if are_accelerated == [true; 2] {
        StateDd::pack(states).after_accelerated(t).unpack()
    } else {
        let [first, second] = t.unpack();
        [states[0].after(first), states[1].after(second)]
    }
}

impl EventDriven {
    /// The state of a body along an axis at the present instant.
    #[inline]
    pub(super) fn state_dd(&self, slot: Slot, axis: Axis) -> StateDd {
        let reference = self.reference_state(slot, axis);
        if reference.is_at_rest() || self.is_at_reference_time(slot, axis) {
            return reference;
        }
        reference.after(self.time_since_reference(slot, axis))
    }

    /// The states of two bodies at the present instant and the seconds since their reference instants.
    #[inline]
    pub(super) fn both_states_dd(&self, slots: [Slot; 2], axis: Axis) -> ([StateDd; 2], [f64; 2]) {
        let references = [self.reference_state(slots[0], axis), self.reference_state(slots[1], axis)];
        let times = self.times_since_reference(slots, axis);
        let later = advance_both(references, times);
        let is_unchanged = |body: usize| references[body].is_at_rest() | self.is_at_reference_time(slots[body], axis);
        let state = |body: usize| if is_unchanged(body) { references[body] } else { later[body] };
        ([state(0), state(1)], times.high.0)
    }

    /// The velocity of a body along an axis at the present instant, m/s.
    #[inline]
    pub(super) fn velocity_dd(&self, slot: Slot, axis: Axis) -> DoubleDouble {
        let reference = self.reference_state(slot, axis);
        if reference.acceleration.high == 0.0 || self.is_at_reference_time(slot, axis) {
            return reference.velocity;
        }
        reference.velocity + reference.acceleration * self.time_since_reference(slot, axis)
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

    /// Returns true if the present instant is the reference instant.
    #[inline]
    fn is_at_reference_time(&self, slot: Slot, axis: Axis) -> bool {
        self.states[slot as usize].trajectory.since(axis) == self.now
            && self.low_parts[slot as usize].0[axis].offset == self.now_low
    }

    /// The seconds from the reference instant to the present one.
    #[inline]
    pub(super) fn time_since_reference(&self, slot: Slot, axis: Axis) -> DoubleDouble {
        let since = self.states[slot as usize].trajectory.since(axis);
        let from = DoubleDouble { high: since.offset, low: self.low_parts[slot as usize].0[axis].offset };
        let offset = DoubleDouble { high: self.now.offset, low: self.now_low } - from;
        if self.now.step == since.step {
            return offset;
        }
        self.clock.period_dd * DoubleDouble::from(self.now.step - since.step) + offset
    }

    /// The seconds from the reference instants of two bodies to the present one.
    #[inline]
    fn times_since_reference(&self, slots: [Slot; 2], axis: Axis) -> DoubleDouble<F64x2> {
        let since = slots.map(|slot| self.states[slot as usize].trajectory.since(axis));
        let low_parts = slots.map(|slot| self.low_parts[slot as usize].0[axis].offset);
        let from = DoubleDouble { high: F64x2(since.map(|since| since.offset)), low: F64x2(low_parts) };
        let offset = DoubleDouble { high: F64x2::splat(self.now.offset), low: F64x2::splat(self.now_low) } - from;
        let steps = since.map(|since| self.now.step - since.step);
        if steps == [0.0; 2] {
            return offset;
        }
        let period = self.clock.period_dd;
        let period = DoubleDouble { high: F64x2::splat(period.high), low: F64x2::splat(period.low) };
        period * DoubleDouble::from(F64x2(steps)) + offset
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
        self.low_parts[slot as usize].0[axis] = AxisLowParts {
            position: position.low,
            velocity: velocity.low,
            acceleration: acceleration.low,
            offset: self.now_low,
        };
        self.invalidate(slot);
    }

    /// Sets the present instant, unless the given one is in the past.
    pub(super) fn advance_clock(&mut self, instant: Instant) {
        if self.now.is_before(instant) {
            self.now = instant;
            self.now_low = 0.0;
        }
    }

    /// Shifts the present instant by the rounding error of a prediction, s. The result may lie just
    /// outside its step.
    pub(super) fn shift_now(&mut self, seconds: f64) {
        let offset = DoubleDouble { high: self.now.offset, low: self.now_low } + seconds.into();
        self.now.offset = offset.high;
        self.now_low = offset.low;
    }
}
