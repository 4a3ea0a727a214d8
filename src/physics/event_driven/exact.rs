//! Predictions in double-double arithmetic, where doubles cannot decide.

use super::EventDriven;
use super::axis_trajectory::{SMALLEST_SQUARE, closing_time};
use super::bodies::Bodies;
use super::body_state::Slot;
use super::double_double::DoubleDouble;
use super::event_queue::ScheduledEvent;
use super::instant::Instant;
use super::pair_event::{ImpactKind, PairEvent};
use super::random_rounding::{RandomRounding, is_exact_path};
use super::reference::Reference;
use crate::physics::{Axis, Side, larger};
use std::ops::Range;

/// The rounding of a coordinate in double-double arithmetic, as a fraction of the numbers it was computed from: 2¹⁶
/// times that of an operation, since the errors of earlier events add up.
pub const POSITION_ROUNDING: f64 = 1.0 / (1_u128 << 88) as f64;

/// The resolution of positions along an axis: boxes whose gap is smaller touch, a bounce that rises less is plastic.
///
/// It follows from the sizes of the boxes, so that a scene gives the same result wherever it is. Only farther than 2²⁴
/// times the sizes from the origin, the rounding of the coordinates is coarser.
#[derive(Clone, Copy, Debug)]
pub struct Resolution {
    /// As a fraction of the sizes of both boxes.
    fraction: f64,
}

impl Default for Resolution {
    fn default() -> Resolution {
        Resolution { fraction: 1.0 / (1_u128 << 64) as f64 }
    }
}

impl Resolution {
    /// A resolution that is finer or coarser by a factor.
    pub fn times(self, factor: f64) -> Resolution {
        Resolution { fraction: self.fraction * factor }
    }

    /// The resolution of the gap between two boxes, m, given their sizes and the sum of the magnitudes of the numbers
    /// from which their coordinates were computed.
    #[inline]
    pub fn of_gap(self, sizes: [f64; 2], magnitude: f64) -> f64 {
        larger((sizes[0] + sizes[1]) * self.fraction, magnitude * POSITION_ROUNDING)
    }

    /// True if a bounce at a speed (m/s) against an acceleration (m/s²) rises by less than the resolution of two boxes,
    /// given the magnitudes of their coordinates and their sizes along the axis, m.
    pub fn hides_bounce(self, speed: f64, acceleration: f64, coordinates: [f64; 2], sizes: [f64; 2]) -> bool {
        speed * (speed / acceleration) <= 2.0 * self.of_gap(sizes, coordinates[0].abs() + coordinates[1].abs())
    }
}

/// The rounding of a velocity in double-double arithmetic, as a fraction of the numbers it was computed from: 2¹² times
/// that of an operation, since the errors of earlier impacts add up.
pub const VELOCITY_ROUNDING: f64 = 1.0 / (1_u128 << 92) as f64;

/// The rounding of an acceleration in double-double arithmetic, as a fraction of the numbers it was computed from: 2¹²
/// times that of an operation, since it is a mean over all bodies of a component.
pub const ACCELERATION_ROUNDING: f64 = 1.0 / (1_u128 << 92) as f64;

/// An overlap up to this fraction of the coordinates is an accumulated rounding error. Approaches below the rounding of
/// doubles, 2⁻⁵², are not predicted, so two boxes can come to overlap by as much, and an impact can move one of them
/// onto a third.
pub const DEEPEST_ROUNDING: f64 = 1.0 / (1_u64 << 44) as f64;

/// A discriminant above this fraction of the square of the speed is certainly not 0, although it is computed in
/// doubles.
const CLEARLY_TURNS: f64 = 1e-12;

/// A gap above this fraction of the numbers that it was computed from in doubles has certainly the sign of the exact
/// one.
const CLEAR_GAP: f64 = 1.0 / (1_u64 << 40) as f64;

/// Times (s) and lengths (m) of which no product with a speed or an acceleration underflows or overflows.
const MODERATE: Range<f64> = 1e-100..1e100;

/// The second body of a pair relative to the first along an axis, at an instant.
pub struct ExactAxis {
    /// From the position of the first to that of the second.
    offset: DoubleDouble,
    sizes: [DoubleDouble; 2],
    velocity: DoubleDouble,
    acceleration: DoubleDouble,
    /// Gaps, speeds and accelerations up to these are 0.
    gap_rounding: f64,
    speed_rounding: f64,
    acceleration_rounding: f64,
    /// An overlap up to this is an accumulated rounding error.
    deepest_rounding: f64,
}

impl ExactAxis {
    /// The second of two bodies relative to the first at an instant.
    #[inline(always)]
    fn between(bodies: &Bodies, references: &[Reference; 2], at: Instant) -> ExactAxis {
        let [first, second] = Reference::scaled_states_at(references, at, bodies.rounding());
        let sizes = [references[0].size, references[1].size];
        let resolution = bodies.resolution();
        let [a, b] = [first.magnitudes, second.magnitudes];
        ExactAxis {
            offset: second.state.position - first.state.position,
            sizes,
            velocity: second.state.velocity - first.state.velocity,
            acceleration: second.state.acceleration_relative_to(&first.state),
            gap_rounding: resolution.of_gap([sizes[0].high, sizes[1].high], a.position + b.position),
            speed_rounding: (a.velocity + b.velocity) * VELOCITY_ROUNDING,
            acceleration_rounding: (a.acceleration + b.acceleration) * ACCELERATION_ROUNDING,
            deepest_rounding: (a.position + b.position) * DEEPEST_ROUNDING,
        }
    }

    /// The instant at which the gap on a side closes, given that of this state; `None` if it does not.
    #[inline(always)]
    fn contact(&self, side: Side, from: Instant, rounding: RandomRounding) -> Option<Instant> {
        let time = self.time_to_contact(side)?;
        Some(rounding.instant(from, time, || self.has_exact_root(side, time)))
    }

    /// The gap on a side of the first body.
    #[inline]
    fn gap(&self, side: Side) -> DoubleDouble {
        match side {
            Side::Low => -self.offset - self.sizes[1],
            Side::High => self.offset - self.sizes[0],
        }
    }

    /// Gap on a side, approach speed and approach acceleration.
    #[inline]
    fn closing(&self, side: Side) -> [DoubleDouble; 3] {
        let signed = |number: DoubleDouble| if side == Side::High { -number } else { number };
        [self.gap(side), signed(self.velocity), signed(self.acceleration)]
    }

    /// The side of the first body on which the second lies: that of the greater gap.
    fn nearest_side(&self) -> Side {
        if self.gap(Side::Low).is_less(self.gap(Side::High)) { Side::High } else { Side::Low }
    }

    /// The greater gap.
    fn nearest(&self) -> DoubleDouble {
        self.gap(self.nearest_side())
    }

    /// True if the bodies approach.
    fn is_approaching(&self) -> bool {
        self.closing(self.nearest_side())[1].high > self.speed_rounding
    }

    /// The side of the first body on which the second lies, unless the bodies overlap or are about to.
    fn side_of_ended_overlap(&self) -> Option<Side> {
        let side = self.nearest_side();
        let [gap, speed, acceleration] = self.closing(side);
        let begins = speed.high > self.speed_rounding
            || (speed.high >= -self.speed_rounding && acceleration.high > self.acceleration_rounding);
        let overlaps = gap.high < -self.gap_rounding || (gap.high <= self.gap_rounding && begins);
        (!overlaps).then_some(side)
    }

    /// True if the bodies accelerate towards each other from rest.
    fn is_pressed(&self) -> bool {
        let [_, speed, acceleration] = self.closing(self.nearest_side());
        speed.high.abs() <= self.speed_rounding && acceleration.high > self.acceleration_rounding
    }

    /// Gap, approach speed and approach acceleration after t seconds on the nearest side; numbers below rounding are 0.
    fn after(&self, t: DoubleDouble) -> [DoubleDouble; 3] {
        let displacement = t * (self.velocity + t * self.acceleration.scaled(0.5));
        let gaps = [self.gap(Side::Low) - displacement, self.gap(Side::High) + displacement];
        let velocity = self.velocity + self.acceleration * t;
        let side = if gaps[0].is_less(gaps[1]) { Side::High } else { Side::Low };
        let signed = |number: DoubleDouble| if side == Side::High { -number } else { number };
        let path = t.high * (self.velocity.high.abs() + t.high * self.acceleration.high.abs());
        [
            gaps[side].or_zero(2.0 * self.gap_rounding + path * POSITION_ROUNDING),
            signed(velocity).or_zero(self.speed_rounding + VELOCITY_ROUNDING * t.high * self.acceleration.high.abs()),
            signed(self.acceleration).or_zero(self.acceleration_rounding),
        ]
    }

    /// The impact of the bodies after t seconds, when their gap along the other axis closes, by their overlap along
    /// this one; `None` if they neither overlap nor enter the corner.
    fn impact_after(&self, t: DoubleDouble) -> Option<ImpactKind> {
        match self.clear_gap_after(t.high) {
            Some(gap) => {
                let impact = (gap < 0.0).then_some(ImpactKind::Face);
                debug_assert_eq!(impact, self.exact_impact_after(t), "doubles suffice");
                impact
            }
            None => self.exact_impact_after(t),
        }
    }

    /// The greater gap after t seconds in doubles, m; `None` if they do not decide its sign. They mostly do, so that a
    /// heap of 10³ boxes needs 0.5 % fewer instructions.
    #[inline]
    fn clear_gap_after(&self, t: f64) -> Option<f64> {
        let [offset, velocity, acceleration] =
            [self.offset, self.velocity, self.acceleration].map(|number| number.high);
        // The low part of a size can exceed the rounding of the high part.
        let sizes = self.sizes.map(|size| size.high + size.low);
        let displacement = t * (velocity + 0.5 * acceleration * t);
        let path = t * (velocity.abs() + 0.5 * acceleration.abs() * t);
        let gap = larger(-offset - sizes[1] - displacement, offset - sizes[0] + displacement);
        let scale = offset.abs() + sizes[0] + sizes[1] + path;
        let is_clear = gap.abs() > scale * CLEAR_GAP + 2.0 * self.gap_rounding;
        (is_clear && MODERATE.contains(&t) && MODERATE.contains(&scale)).then_some(gap)
    }

    /// The same as [`impact_after`](Self::impact_after) in double-double arithmetic.
    fn exact_impact_after(&self, t: DoubleDouble) -> Option<ImpactKind> {
        let [gap, speed, acceleration] = self.after(t);
        if gap.high < 0.0 {
            return Some(ImpactKind::Face);
        }
        let is_entering = speed.high > 0.0 || (speed.high == 0.0 && acceleration.high > 0.0);
        (gap.high == 0.0 && is_entering).then_some(ImpactKind::Corner)
    }

    /// The seconds until a gap closes.
    #[inline(always)]
    fn time_to_contact(&self, side: Side) -> Option<DoubleDouble> {
        let [gap, speed, acceleration] = self.closing(side);
        self.root(gap, speed, acceleration)
    }

    /// The seconds until the overlap on a side ends.
    fn time_to_separation(&self, side: Side) -> Option<DoubleDouble> {
        let [gap, speed, acceleration] = self.closing(side);
        self.root(-gap, -speed, -acceleration)
    }

    /// True if `time`, at which a gap closes or opens, needed no rounding.
    fn has_exact_root(&self, side: Side, time: DoubleDouble) -> bool {
        let [gap, speed, acceleration] = self.closing(side);
        let path = time * (speed + time * acceleration.half());
        path == gap && is_exact_path(speed, acceleration, time)
    }

    /// True if the gap becomes 0 to rounding just where it turns.
    fn turns_at_contact(&self, gap: DoubleDouble, speed: DoubleDouble, acceleration: DoubleDouble) -> bool {
        let square = speed.high * speed.high + 2.0 * acceleration.high * gap.high;
        if square.abs() > speed.high * speed.high * CLEARLY_TURNS {
            return false;
        }
        let square = speed * speed + (acceleration * gap).scaled(2.0);
        let rounding = 2.0 * (self.speed_rounding * speed.high.abs() + acceleration.high.abs() * self.gap_rounding);
        acceleration.high != 0.0 && speed.high != 0.0 && square.high.abs() <= rounding
    }

    /// The root of gap − speed·t − ½·acceleration·t² = 0 at which the gap shrinks, if there is one.
    #[inline(always)]
    fn root(&self, gap: DoubleDouble, speed: DoubleDouble, acceleration: DoubleDouble) -> Option<DoubleDouble> {
        let speed = speed.or_zero(self.speed_rounding);
        let acceleration = acceleration.or_zero(self.acceleration_rounding);
        let gap = gap.or_zero(self.gap_rounding);
        if gap.high == 0.0 {
            // The rounding of a gap grows with the speeds, so an impact can make gaps 0 that were not before it.
            let (closes_now, returns) = (speed.high > 0.0, speed.high < 0.0 && acceleration.high > 0.0);
            return match (closes_now, returns) {
                (true, _) => Some(DoubleDouble::ZERO),
                (_, true) => Some(-(speed + speed) / acceleration),
                _ => None,
            };
        }
        if acceleration.high == 0.0 {
            let closes = (gap.high > 0.0) & (speed.high > 0.0);
            return closes.then(|| gap / speed);
        }
        self.accelerated_root(gap, speed, acceleration)
    }

    /// The same root, for a gap and an acceleration that are not 0.
    fn accelerated_root(
        &self,
        gap: DoubleDouble,
        speed: DoubleDouble,
        acceleration: DoubleDouble,
    ) -> Option<DoubleDouble> {
        if self.turns_at_contact(gap, speed, acceleration) {
            let turning = -speed / acceleration;
            return (turning.high > 0.0).then_some(turning);
        }
        let seconds = closing_time(gap.high, speed.high, acceleration.high);
        if seconds == f64::INFINITY || seconds.is_nan() {
            return None;
        }
        let mut t = DoubleDouble::from(seconds);
        for _ in 0..4 {
            let rest = gap - t * (speed + t * acceleration.scaled(0.5));
            let slope = speed + acceleration * t;
            if rest.high == 0.0 {
                break;
            }
            // The stable form of the quadratic formula; where squares underflow, Newton's step suffices.
            let square = slope.high * slope.high + 2.0 * acceleration.high * rest.high;
            let is_regular = square > SMALLEST_SQUARE;
            let divisor = if is_regular { 0.5 * (slope.high + square.sqrt()) } else { slope.high };
            if divisor.is_nan() || divisor <= 0.0 {
                break;
            }
            t = t + (rest.high / divisor).into();
        }
        (t.high > 0.0 && t.high.is_finite()).then_some(t)
    }
}

impl Bodies {
    /// The second body of a pair relative to the first along an axis, at an instant.
    fn exact_axis(&self, pair: [Slot; 2], axis: Axis, at: Instant) -> ExactAxis {
        ExactAxis::between(self, &pair.map(|slot| self.reference(slot, axis)), at)
    }

    /// The instant from which the trajectories of both bodies hold.
    pub fn common_reference(&self, pair: [Slot; 2]) -> Instant {
        self[pair[0]].since.max(self[pair[1]].since)
    }
}

impl EventDriven {
    /// The exact instant at which the faces of two bodies collide, known to be their next event; `None` if it is
    /// not after the present one.
    pub(super) fn exact_face_impact(&self, pair: [Slot; 2], axis: Axis, side: Side) -> Option<Instant> {
        let from = self.bodies.common_reference(pair);
        let references = [self.bodies.reference(pair[0], axis), self.bodies.reference(pair[1], axis)];
        let relative = ExactAxis::between(&self.bodies, &references, from);
        let at = relative.contact(side, from, self.bodies.rounding())?;
        self.timeline.now().max(from).is_before(at).then_some(at)
    }

    /// True if the gap or the overlap of an event is 0 already at an instant: then it happens at that instant.
    pub(super) fn coincides(&self, event: &ScheduledEvent, at: Instant) -> bool {
        let Some((axis, side)) = event.pair_event.map(PairEvent::axis_and_side) else { return false };
        let along = self.bodies.exact_axis(event.pair, axis, at);
        along.gap(side).high.abs() <= along.gap_rounding
    }

    /// Predicts the next event of two bodies that changes anything; exact to the rounding of the state.
    ///
    /// An event that is not after the present instant has been handled, unless the bodies still approach, or are in
    /// contact though they have just ceased to overlap: then it is due now.
    #[cold]
    pub(super) fn predict_exactly(&self, pair: [Slot; 2]) -> Option<(Instant, PairEvent)> {
        let from = self.bodies.common_reference(pair);
        let now = self.timeline.now().max(from);
        let axes = Axis::BOTH.map(|axis| self.bodies.exact_axis(pair, axis, from));
        let contacts = self.contacts.axes_between(pair);
        let mut first: Option<(Instant, PairEvent)> = None;
        let mut is_overdue = false;
        let mut keep = |time: DoubleDouble, event: PairEvent| {
            let at = self.bodies.rounding().instant(from, time, || {
                let (axis, side) = event.axis_and_side();
                axes[axis].has_exact_root(side, time)
            });
            if !now.is_before(at) {
                is_overdue = true;
            } else if at.is_before(first.map_or(Instant::NEVER, |(earliest, _)| earliest)) {
                first = Some((at, event));
            }
        };
        for axis in Axis::BOTH {
            for side in [Side::High, Side::Low] {
                if contacts[axis.other()] {
                    if let Some(time) = axes[axis].time_to_separation(side) {
                        keep(time, PairEvent::ContactEnd(axis, side));
                    }
                } else if contacts == [false; 2]
                    && let Some(time) = axes[axis].time_to_contact(side)
                    && let Some(kind) = axes[axis.other()].impact_after(time)
                {
                    keep(time, kind.along(axis, side));
                }
            }
        }
        let overlaps = axes.iter().all(|axis| axis.nearest().high < -axis.gap_rounding);
        let touches = axes.iter().all(|axis| axis.nearest().high <= axis.gap_rounding);
        let is_pressed = touches && axes.iter().any(ExactAxis::is_pressed);
        if (is_overdue || overlaps || is_pressed)
            && contacts == [false; 2]
            && let Some(event) = self.approach_now(pair)
        {
            return Some((now, event));
        }
        if now == from
            && let Some(event) = contact_end_by_alignment(&axes, contacts)
        {
            return Some((now, event));
        }
        first
    }

    /// Gap, approach speed and approach acceleration of two bodies along an axis now; 0 if below rounding.
    #[cfg(debug_assertions)]
    pub(super) fn motion_now(&self, pair: [Slot; 2], axis: Axis) -> [f64; 3] {
        let along = self.bodies.exact_axis(pair, axis, self.now_of(pair));
        let [gap, speed, acceleration] = along.closing(along.nearest_side());
        let roundings = [along.gap_rounding, along.speed_rounding, along.acceleration_rounding];
        [gap.or_zero(roundings[0]).high, speed.or_zero(roundings[1]).high, acceleration.or_zero(roundings[2]).high]
    }

    /// The impact of two bodies that touch now, or overlap by rounding errors, and approach or accelerate towards each
    /// other from rest. The alignment of faces at the end of an instant can bring bodies into touch that were not
    /// before.
    pub(super) fn approach_now(&self, pair: [Slot; 2]) -> Option<PairEvent> {
        let now = self.now_of(pair);
        let axes = Axis::BOTH.map(|axis| self.bodies.exact_axis(pair, axis, now));
        let gaps = Axis::BOTH.map(|axis| axes[axis].nearest().or_zero(axes[axis].gap_rounding).high);
        if gaps[0] > 0.0 || gaps[1] > 0.0 {
            return None;
        }
        let approaches = Axis::BOTH.map(|axis| axes[axis].is_approaching() || axes[axis].is_pressed());
        if gaps == [0.0; 2] {
            return (approaches == [true; 2]).then(|| PairEvent::CornerImpact(Axis::X, axes[0].nearest_side()));
        }
        let face = if gaps[0] >= gaps[1] { Axis::X } else { Axis::Y };
        let touches = gaps[face] >= -axes[face].deepest_rounding;
        (touches && approaches[face]).then(|| PairEvent::FaceImpact(face, axes[face].nearest_side()))
    }
}

/// The end of a contact of two bodies, along the axes `contacts`, that do not overlap any more because faces were
/// aligned at the end of the instant. A corner that blocks along both axes does not overlap, but stays in contact.
fn contact_end_by_alignment(axes: &[ExactAxis; 2], contacts: [bool; 2]) -> Option<PairEvent> {
    let across = Axis::BOTH.into_iter().find(|axis| contacts[axis.other()] && !contacts[*axis])?;
    Some(PairEvent::ContactEnd(across, axes[across].side_of_ended_overlap()?))
}
