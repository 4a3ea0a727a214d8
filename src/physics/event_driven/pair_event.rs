//! Predicts the next event of a pair in doubles, with a bound of the error.

use super::axis_trajectory::closing_time;
use super::body_state::BodyState;
use super::instant::Instant;
use crate::physics::{Axis, Side};

/// An event of two boxes along an axis. The side is that of the first body, earlier in creation order, on
/// which the second lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairEvent {
    /// Faces collide along the axis; on the other axis the boxes overlap by more than rounding.
    FaceImpact(Axis, Side),
    /// Faces or corners touch along the axis; doubles cannot distinguish them.
    CornerImpact(Axis, Side),
    /// Boxes in contact along the other axis cease to overlap along this one.
    ContactEnd(Axis, Side),
}

impl PairEvent {
    /// The axis of the event, and the side of the first body on which the second lies.
    pub fn axis_and_side(self) -> (Axis, Side) {
        match self {
            PairEvent::FaceImpact(axis, side)
            | PairEvent::CornerImpact(axis, side)
            | PairEvent::ContactEnd(axis, side) => (axis, side),
        }
    }
}

/// The impact of two boxes whose gap along an axis closes, by their overlap along the other axis at that time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImpactKind {
    /// They overlap by more than rounding.
    Face,
    /// Their overlap is 0 to rounding.
    Corner,
}

impl ImpactKind {
    /// The impact as an event along the axis of the gap, on a side of the first box.
    #[inline]
    pub fn along(self, axis: Axis, side: Side) -> PairEvent {
        match self {
            ImpactKind::Face => PairEvent::FaceImpact(axis, side),
            ImpactKind::Corner => PairEvent::CornerImpact(axis, side),
        }
    }
}

/// The state of a body at an instant.
#[derive(Clone, Copy)]
pub struct Sample<'a> {
    /// The body.
    pub body: &'a BodyState,
    /// The instant.
    pub at: Instant,
    /// Position of the upper-left corner, m.
    pub position: [f64; 2],
    /// Velocity, m/s.
    pub velocity: [f64; 2],
    /// The [magnitude](super::trajectory::Trajectory::magnitude_at) of the numbers in the position, m.
    pub magnitude: [f64; 2],
}

impl<'a> Sample<'a> {
    /// Evaluates the trajectory of a body at an instant.
    #[inline]
    pub fn new(body: &'a BodyState, at: Instant) -> Sample<'a> {
        let [position, velocity] = body.trajectory.at(at);
        Sample { body, at, position, velocity, magnitude: body.trajectory.magnitude_at(at) }
    }

    /// Returns the sample at another instant, or a copy of this one if the instant is the same.
    #[inline]
    pub fn at_time(&self, at: Instant) -> Sample<'a> {
        if at == self.at { *self } else { Sample::new(self.body, at) }
    }

    /// False if the body certainly does not touch another at the instant.
    #[inline]
    pub fn may_touch(&self, other: &BodyState) -> bool {
        let [position, _] = other.trajectory.at(self.at);
        let magnitude = other.trajectory.magnitude_at(self.at);
        Axis::BOTH.into_iter().all(|axis| {
            let offset = position[axis] - self.position[axis];
            let sizes = [self.body.size[axis], other.size[axis]];
            let [ahead, behind] = [offset - sizes[0], -offset - sizes[1]];
            let gap = if ahead > behind { ahead } else { behind };
            let scale = self.magnitude[axis] + magnitude[axis] + (sizes[0] + sizes[1]);
            gap <= scale * CLEAR
        })
    }

    /// Returns true if the mass of the body is infinite.
    pub fn is_infinite(&self) -> bool {
        self.body.infinite
    }
}

/// The next event of a pair, as far as doubles decide it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prediction {
    /// There is none within the horizon.
    None,
    /// Rounding decides whether one is due now.
    Unclear,
    /// The event happens not before the instant, and not later than `upper` seconds after it.
    Event { not_before: Instant, upper: f64, event: PairEvent },
}

/// The state of the second box of a pair relative to the first, along each axis.
struct Relative {
    /// Gap between the high face of the first and the low face of the second, m. On an axis on which
    /// the boxes overlap both gaps are negative.
    ahead: [f64; 2],
    /// Gap between the low face of the first and the high face of the second, m.
    behind: [f64; 2],
    /// Relative velocity, m/s.
    velocity: [f64; 2],
    /// Relative acceleration, m/s².
    acceleration: [f64; 2],
    /// Gap up to which faces may touch, m: the rounding of the coordinates.
    tolerance: [f64; 2],
    /// The sum of the speeds of the two, m/s.
    speed_sum: [f64; 2],
    /// Relative speed up to which the boxes may be at rest relative to each other, m/s: the rounding of the velocities.
    speed_tolerance: [f64; 2],
    /// The sum of the magnitudes of the accelerations of the two, m/s².
    acceleration_sum: [f64; 2],
}

/// The rounding of a gap or a speed computed in doubles, in units in the last place of the numbers it is computed from:
/// each of about ten operations rounds by at most half a unit.
const ROUNDING_ULPS: f64 = 8.0;

/// The rounding of a time or a path computed in doubles, as a fraction of it: each of a few operations rounds by at
/// most half of [`f64::EPSILON`].
const PATH_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A gap or a difference of speeds computed in doubles has certainly the sign of the exact one above this fraction of
/// the magnitudes of the numbers it is computed from: eight times their rounding.
pub const CLEAR: f64 = 8.0 * ROUNDING_ULPS * f64::EPSILON;

/// The rounding of a gap if the magnitudes of the coordinates add up to `scale`, both in m.
pub fn tolerance(scale: f64) -> f64 {
    scale * (ROUNDING_ULPS * f64::EPSILON)
}

/// A time of an event in seconds and the bound of its error.
#[derive(Clone, Copy)]
struct BoundedTime {
    seconds: f64,
    error: f64,
}

/// The time at which a gap closes.
enum ContactTime {
    Never,
    At(BoundedTime),
    /// Rounding decides whether it closes now.
    Unclear,
}

impl Relative {
    #[inline]
    fn new(first: &Sample, second: &BodyState) -> Relative {
        let a = first.position;
        let [b, velocity] = second.trajectory.at(first.at);
        let magnitude = second.trajectory.magnitude_at(first.at);
        let sizes = [first.body.size, second.size];
        let [first_trajectory, second_trajectory] = [first.body, second].map(|body| &body.trajectory);
        let accelerations = [first_trajectory.acceleration, second_trajectory.acceleration];
        let speed_sum = Axis::BOTH.map(|axis| velocity[axis].abs() + first.velocity[axis].abs());
        // A velocity is that at the reference instant plus a gain, which is no greater than the sum of the two speeds.
        let greatest_sum = Axis::BOTH.map(|axis| {
            speed_sum[axis] + (first_trajectory.velocity[axis].abs() + second_trajectory.velocity[axis].abs())
        });
        Relative {
            ahead: Axis::BOTH.map(|axis| (b[axis] - a[axis]) - sizes[0][axis]),
            behind: Axis::BOTH.map(|axis| (a[axis] - b[axis]) - sizes[1][axis]),
            velocity: Axis::BOTH.map(|axis| velocity[axis] - first.velocity[axis]),
            acceleration: Axis::BOTH.map(|axis| accelerations[1][axis] - accelerations[0][axis]),
            tolerance: Axis::BOTH
                .map(|axis| tolerance(first.magnitude[axis] + magnitude[axis] + (sizes[0][axis] + sizes[1][axis]))),
            speed_sum,
            speed_tolerance: greatest_sum.map(tolerance),
            acceleration_sum: Axis::BOTH.map(|axis| accelerations[0][axis].abs() + accelerations[1][axis].abs()),
        }
    }

    /// The distance of the boxes along an axis, m: the larger of the two gaps.
    #[inline]
    fn gap(&self, axis: Axis) -> f64 {
        if self.ahead[axis] > self.behind[axis] { self.ahead[axis] } else { self.behind[axis] }
    }

    /// Returns true if the boxes certainly stay separated along an axis for `seconds`. This excludes all
    /// but the nearest of many boxes around one.
    #[inline]
    fn stay_separated(&self, seconds: f64) -> bool {
        let positive = |number: f64| if number > 0.0 { number } else { 0.0 };
        let overlaps = Axis::BOTH.map(|axis| self.gap(axis) < -self.tolerance[axis]);
        let separated = Axis::BOTH.map(|axis| {
            let sign = if self.ahead[axis] > self.behind[axis] { -1.0 } else { 1.0 };
            let (speed, acceleration) = (sign * self.velocity[axis], sign * self.acceleration[axis]);
            let gap = self.gap(axis);
            let is_apart = (gap > self.tolerance[axis]) & (speed <= 0.0);
            // For instance, two boxes that have just collided.
            let touches_and_recedes =
                (gap > -self.tolerance[axis]) & (speed < -self.speed_tolerance[axis]) & overlaps[axis.other()];
            let is_receding = (is_apart | touches_and_recedes) & (acceleration <= 0.0);
            let displacement = seconds * (positive(speed) + 0.5 * positive(acceleration) * seconds);
            is_receding | (gap - displacement > self.tolerance[axis])
        });
        separated[0] | separated[1]
    }

    /// Returns true if the boxes certainly overlap along an axis for `seconds`.
    #[inline]
    fn stay_overlapping(&self, axis: Axis, seconds: f64) -> bool {
        let displacement = seconds * (self.velocity[axis].abs() + 0.5 * self.acceleration[axis].abs() * seconds);
        self.gap(axis) + displacement < -self.tolerance[axis]
    }

    /// The gap on a side of the first box, and the speed (m/s) and acceleration (m/s²) at which it closes.
    #[inline]
    fn closing(&self, axis: Axis, side: Side) -> [f64; 3] {
        let (gap, towards) = match side {
            Side::High => (self.ahead[axis], -1.0),
            Side::Low => (self.behind[axis], 1.0),
        };
        [gap, towards * self.velocity[axis], towards * self.acceleration[axis]]
    }

    /// The rounding of a gap after t seconds, m.
    #[inline]
    fn rounding_after(&self, axis: Axis, t: f64) -> f64 {
        let path = t * (self.speed_sum[axis] + 0.5 * self.acceleration_sum[axis] * t);
        self.tolerance[axis] + PATH_ROUNDING * path
    }

    /// The bound of the error of a closing time of `seconds`, at which the gap closes at speed `final_speed`.
    #[inline]
    fn bounded(&self, axis: Axis, seconds: f64, final_speed: f64) -> BoundedTime {
        let rounding = self.rounding_after(axis, seconds);
        let by_speed = 2.0 * rounding / final_speed.abs();
        let acceleration = self.acceleration[axis].abs();
        let error = if rounding * acceleration < by_speed * by_speed * (acceleration * acceleration) / 16.0 {
            4.0 * (rounding / acceleration).sqrt()
        } else {
            by_speed
        };
        BoundedTime { seconds, error: error + PATH_ROUNDING * seconds }
    }

    /// The time at which the gap on a side of the first box closes.
    fn contact_time(&self, axis: Axis, side: Side) -> ContactTime {
        let [gap, speed, acceleration] = self.closing(axis, side);
        if speed <= 0.0 && acceleration <= 0.0 {
            return ContactTime::Never;
        }
        let tolerance = self.tolerance[axis];
        if gap.abs() <= tolerance {
            if speed < 0.0 && acceleration > 0.0 && speed * speed > 16.0 * acceleration * tolerance {
                return ContactTime::At(self.bounded(axis, -2.0 * speed / acceleration, speed));
            }
            return ContactTime::Unclear;
        }
        let seconds = closing_time(gap, speed, acceleration);
        if seconds < f64::INFINITY {
            return ContactTime::At(self.bounded(axis, seconds, speed + acceleration * seconds));
        }
        if speed > 0.0 && acceleration < 0.0 && gap > 0.0 {
            let turning = -speed / acceleration;
            let distance = gap - 0.5 * speed * turning;
            if distance <= 4.0 * self.rounding_after(axis, turning) {
                return ContactTime::At(self.bounded(axis, turning, 0.0));
            }
        }
        ContactTime::Never
    }

    /// The impact of the boxes at the time at which their gap along one axis closes, by their overlap along `axis`, the
    /// other one; `None` if they do not overlap.
    #[inline]
    fn impact_at(&self, axis: Axis, time: BoundedTime) -> Option<ImpactKind> {
        let t = time.seconds;
        let displacement = t * (self.velocity[axis] + 0.5 * self.acceleration[axis] * t);
        let [ahead, behind] = [self.ahead[axis] + displacement, self.behind[axis] - displacement];
        let gap = if ahead > behind { ahead } else { behind };
        let speed =
            (self.velocity[axis] + self.acceleration[axis] * t).abs() + self.acceleration[axis].abs() * time.error;
        let rounding = self.rounding_after(axis, t) + time.error * speed;
        if gap > rounding {
            None
        } else if gap < -rounding {
            Some(ImpactKind::Face)
        } else {
            Some(ImpactKind::Corner)
        }
    }
}

/// Predicts the next event of two boxes that are not in contact, after `now`.
///
/// `order` is [`Side::Low`] if the first is the earlier one in creation order. The result depends only on the
/// two trajectories, not on their order or, for later events, on the time of the call. An event more than
/// `horizon` seconds after the reference times of both may be omitted.
#[inline]
pub fn predict_pair_event(first: &Sample, second: &BodyState, order: Side, horizon: f64, now: Instant) -> Prediction {
    let later;
    let first = if first.at.is_before(second.since) {
        later = Sample::new(first.body, second.since);
        &later
    } else {
        first
    };
    let relative = Relative::new(first, second);
    if relative.stay_separated(horizon) {
        return Prediction::None;
    }
    let elapsed = seconds_since(first.at, now);
    match predict_uniform(&relative, elapsed) {
        Some(Prediction::None) => Prediction::None,
        Some(prediction) => from_reference(prediction, first.at, order),
        None => from_reference(predict_general(&relative, elapsed), first.at, order),
    }
}

/// The seconds from the reference of a pair to the present instant. By rounding, a reference can be later than the
/// clock; then it is the present instant of the pair.
#[inline]
fn seconds_since(reference: Instant, now: Instant) -> f64 {
    let seconds = reference.seconds_until(now);
    if seconds > 0.0 { seconds } else { 0.0 }
}

/// Counts the times of a prediction from its reference instant, and the side from the earlier body.
#[inline]
fn from_reference(prediction: Prediction, from: Instant, order: Side) -> Prediction {
    let Prediction::Event { not_before, upper, event } = prediction else { return prediction };
    let side = |side: Side| if order == Side::Low { side } else { side.opposite() };
    let event = match event {
        PairEvent::FaceImpact(axis, on) => PairEvent::FaceImpact(axis, side(on)),
        PairEvent::CornerImpact(axis, on) => PairEvent::CornerImpact(axis, side(on)),
        PairEvent::ContactEnd(axis, on) => PairEvent::ContactEnd(axis, side(on)),
    };
    let not_before = from.after(not_before.high);
    if not_before == Instant::NEVER { Prediction::None } else { Prediction::Event { not_before, upper, event } }
}

/// The prediction of an event at a time; none if that time is certainly past.
#[inline]
fn at_time(time: BoundedTime, elapsed: f64, event: PairEvent) -> Prediction {
    if time.seconds - time.error > elapsed {
        let not_before = Instant { high: time.seconds - time.error, low: 0.0 };
        Prediction::Event { not_before, upper: 2.0 * time.error, event }
    } else if time.seconds + time.error < elapsed {
        Prediction::None
    } else {
        Prediction::Unclear
    }
}

/// Predicts the collision of two separated boxes without relative acceleration: it is along the axis
/// whose gap closes last, provided that the boxes then overlap on the other.
///
/// `None` if the boxes are not separated or have a relative acceleration.
#[inline]
fn predict_uniform(relative: &Relative, elapsed: f64) -> Option<Prediction> {
    let [x, y] = Axis::BOTH.map(|axis| relative.gap(axis));
    let overlaps = [x < -relative.tolerance[0], y < -relative.tolerance[1]];
    let apart = [x > relative.tolerance[0], y > relative.tolerance[1]];
    let separated = (apart[0] & (apart[1] | overlaps[1])) | (apart[1] & overlaps[0]);
    if relative.acceleration != [0.0; 2] || !separated {
        return None;
    }
    // On an axis on which they overlap already the gap is negative, so the other axis is chosen.
    let speeds = relative.velocity.map(f64::abs);
    let axis = if x * speeds[1] < y * speeds[0] { Axis::Y } else { Axis::X };
    let seconds = [x, y][axis] / speeds[axis];
    if seconds == f64::INFINITY {
        return Some(Prediction::None);
    }
    let error = (2.0 * relative.rounding_after(axis, seconds)) / speeds[axis] + PATH_ROUNDING * seconds;
    let time = BoundedTime { seconds, error };
    let side = if relative.ahead[axis] > relative.behind[axis] { Side::High } else { Side::Low };
    Some(match relative.impact_at(axis.other(), time) {
        Some(kind) => at_time(time, elapsed, kind.along(axis, side)),
        None => Prediction::None,
    })
}

/// Predicts the next event of two boxes from the earliest closing gap at which they overlap on the other axis.
fn predict_general(relative: &Relative, elapsed: f64) -> Prediction {
    let mut first = Prediction::None;
    let mut least = f64::INFINITY;
    for axis in Axis::BOTH {
        for side in [Side::High, Side::Low] {
            let time = match relative.contact_time(axis, side) {
                ContactTime::Never => continue,
                ContactTime::At(time) => time,
                ContactTime::Unclear => return Prediction::Unclear,
            };
            if time.seconds - time.error >= least {
                continue;
            }
            let Some(kind) = relative.impact_at(axis.other(), time) else { continue };
            match at_time(time, elapsed, kind.along(axis, side)) {
                Prediction::None => {}
                Prediction::Unclear => return Prediction::Unclear,
                prediction => {
                    least = time.seconds - time.error;
                    first = prediction;
                }
            }
        }
    }
    first
}

/// Predicts when two boxes in contact along `axis` cease to overlap along the other axis.
///
/// An end more than `horizon` seconds after the reference times of both may be omitted.
pub fn predict_contact_end(
    axis: Axis,
    first: &BodyState,
    second: &BodyState,
    horizon: f64,
    now: Instant,
) -> Prediction {
    let from = first.since.max(second.since);
    let relative = Relative::new(&Sample::new(first, from), second);
    let across = axis.other();
    if relative.stay_overlapping(across, horizon) {
        return Prediction::None;
    }
    let elapsed = seconds_since(from, now);
    let mut end = Prediction::None;
    let mut least = f64::INFINITY;
    for side in [Side::High, Side::Low] {
        let [gap, speed, acceleration] = relative.closing(across, side);
        if speed >= 0.0 && acceleration >= 0.0 && gap < -relative.tolerance[across] {
            continue;
        }
        if gap >= -relative.tolerance[across] {
            return Prediction::Unclear;
        }
        let seconds = closing_time(-gap, -speed, -acceleration);
        if seconds == f64::INFINITY {
            let turning = speed / acceleration;
            let distance = -gap + 0.5 * speed * turning;
            if turning > 0.0 && distance <= 4.0 * relative.rounding_after(across, turning) {
                return Prediction::Unclear;
            }
            continue;
        }
        let time = relative.bounded(across, seconds, speed + acceleration * seconds);
        if time.seconds - time.error <= elapsed {
            return Prediction::Unclear;
        }
        if time.seconds - time.error < least {
            least = time.seconds - time.error;
            end = at_time(time, elapsed, PairEvent::ContactEnd(across, side));
        }
    }
    from_reference(end, from, Side::Low)
}
