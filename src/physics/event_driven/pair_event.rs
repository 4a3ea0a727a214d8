use super::axis_trajectory::closing_time;
use super::body_state::BodyState;
use super::instant::{Clock, Instant, MAX_TIME_ROUNDING};
use crate::physics::{Axis, Side};

/// An event of two boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairEvent {
    /// Faces collide along the axis.
    FaceImpact(Axis),
    /// Corners collide.
    CornerImpact,
    /// Boxes in contact along the axis separate because one slides past the other's edge.
    ContactEnd(Axis),
    /// Corners that touch at rest are pressed together.
    CornerPress,
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
}

impl<'a> Sample<'a> {
    /// Evaluates the trajectory of a body at an instant.
    #[inline]
    pub fn new(clock: &Clock, body: &'a BodyState, at: Instant) -> Sample<'a> {
        let [position, velocity] = body.trajectory.at(clock, at);
        Sample { body, at, position, velocity }
    }

    /// Returns the sample at another instant; a copy if it is the same.
    #[inline]
    pub fn at_time(&self, clock: &Clock, at: Instant) -> Sample<'a> {
        if at == self.at { *self } else { Sample::new(clock, self.body, at) }
    }

    /// Returns true if the mass of the body is infinite.
    pub fn is_infinite(&self) -> bool {
        self.body.infinite
    }
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
    /// Gap up to which faces touch, m: the rounding of the coordinates.
    tolerance: [f64; 2],
}

/// Faces at most this many units in the last place apart touch unless they move apart.
///
/// Each face is computed with at most three roundings; stacks specified in decimals are about as
/// inaccurate.
const TOUCHING_ULPS: f64 = 8.0;

/// The gap up to which faces touch if the magnitudes of their coordinates add up to `scale`, both in m.
pub fn tolerance(scale: f64) -> f64 {
    scale * (TOUCHING_ULPS * f64::EPSILON)
}

impl Relative {
    #[inline]
    fn new(clock: &Clock, first: &Sample, second: &BodyState) -> Relative {
        let a = first.position;
        let [b, velocity] = second.trajectory.at(clock, first.at);
        let sizes = [first.body.size, second.size];
        Relative {
            ahead: Axis::BOTH.map(|axis| (b[axis] - a[axis]) - sizes[0][axis]),
            behind: Axis::BOTH.map(|axis| (a[axis] - b[axis]) - sizes[1][axis]),
            velocity: Axis::BOTH.map(|axis| velocity[axis] - first.velocity[axis]),
            acceleration: Axis::BOTH
                .map(|axis| second.trajectory.acceleration[axis] - first.body.trajectory.acceleration[axis]),
            tolerance: Axis::BOTH
                .map(|axis| tolerance(a[axis].abs() + b[axis].abs() + (sizes[0][axis] + sizes[1][axis]))),
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
        let separated = Axis::BOTH.map(|axis| {
            let sign = if self.ahead[axis] > self.behind[axis] { -1.0 } else { 1.0 };
            let (speed, acceleration) = (sign * self.velocity[axis], sign * self.acceleration[axis]);
            let gap = self.gap(axis);
            let is_receding = (gap > 0.0) & (speed <= 0.0) & (acceleration <= 0.0);
            let displacement = seconds * (positive(speed) + 0.5 * positive(acceleration) * seconds);
            is_receding | (gap - displacement > self.tolerance[axis])
        });
        separated[0] | separated[1]
    }

    /// Returns true if the second box, on the given side of the first, ever moves towards it.
    fn can_close(&self, axis: Axis, side: Side) -> bool {
        match side {
            Side::High => self.velocity[axis] < 0.0 || self.acceleration[axis] < 0.0,
            Side::Low => self.velocity[axis] > 0.0 || self.acceleration[axis] > 0.0,
        }
    }

    /// The seconds until the faces touch if the second box is on the given side of the first.
    ///
    /// `is_touching`: the gap is taken as exactly 0.
    fn time_to_contact(&self, axis: Axis, side: Side, is_touching: bool) -> f64 {
        let towards = side.opposite().sign();
        let (speed, acceleration) = (towards * self.velocity[axis], towards * self.acceleration[axis]);
        let gap = match side {
            Side::High => self.ahead[axis],
            Side::Low => self.behind[axis],
        };
        let tolerance = self.tolerance[axis];
        let is_pressed = speed == 0.0 && acceleration > 0.0 && gap.abs() <= tolerance;
        let gap = if is_touching || is_pressed || (gap < 0.0 && gap >= -tolerance) { 0.0 } else { gap };
        closing_time(gap, speed, acceleration)
    }

    /// The seconds until the boxes no longer overlap on an axis.
    fn time_to_separation(&self, axis: Axis) -> f64 {
        let [ahead, behind] = [self.ahead[axis], self.behind[axis]].map(|gap| if gap > 0.0 { 0.0 } else { -gap });
        let past_ahead = closing_time(ahead, self.velocity[axis], self.acceleration[axis]);
        let past_behind = closing_time(behind, -self.velocity[axis], -self.acceleration[axis]);
        if past_ahead < past_behind { past_ahead } else { past_behind }
    }

    /// The overlap of the boxes on an axis after t seconds.
    #[inline]
    fn overlap_after(&self, axis: Axis, t: f64) -> Overlap {
        let displacement = t * (self.velocity[axis] + 0.5 * self.acceleration[axis] * t);
        let [ahead, behind] = [self.ahead[axis] + displacement, self.behind[axis] - displacement];
        let gap = if ahead > behind { ahead } else { behind };
        if gap < -self.tolerance[axis] {
            return Overlap::Face;
        }
        let velocity = self.velocity[axis] + self.acceleration[axis] * t;
        let sign = if ahead > behind { -1.0 } else { 1.0 };
        if gap > self.tolerance[axis] || sign * velocity < 0.0 {
            Overlap::None
        } else if sign * velocity > 0.0 {
            Overlap::Corner
        } else if sign * self.acceleration[axis] > 0.0 {
            Overlap::Pressed
        } else {
            Overlap::None
        }
    }
}

/// The overlap of two boxes on one axis at the instant at which a gap on the other axis closes.
enum Overlap {
    /// The overlap has a positive length.
    Face,
    /// The overlap begins at this instant, with a relative velocity.
    Corner,
    /// The overlap begins at this instant, from rest.
    Pressed,
    /// The boxes do not overlap, or cease to.
    None,
}

/// Predicts the next event of two boxes that are not in contact.
///
/// The result depends only on the two trajectories, not on their order or on the time of the call.
/// Faces collide when a gap on one axis closes while the boxes overlap on the other axis by a positive
/// length. If they begin to overlap there at the same instant, corners collide. If they just cease to
/// overlap, or slide along the same line, they do not collide, so a box passes the seam between two
/// tiles. An event more than `horizon` seconds after the reference times of both may be omitted.
#[inline]
pub fn predict_pair_event(
    clock: &Clock,
    first: &Sample,
    second: &BodyState,
    horizon: f64,
) -> Option<(Instant, PairEvent)> {
    if first.at.is_before(second.since) {
        predict_from_sample(clock, &Sample::new(clock, first.body, second.since), second, horizon)
    } else {
        predict_from_sample(clock, first, second, horizon)
    }
}

#[inline]
fn predict_from_sample(
    clock: &Clock,
    first: &Sample,
    second: &BodyState,
    horizon: f64,
) -> Option<(Instant, PairEvent)> {
    let relative = Relative::new(clock, first, second);
    if relative.stay_separated(horizon) {
        return None;
    }
    let (seconds, event) = match predict_uniform(&relative) {
        Some(prediction) => prediction?,
        None => predict_general(&relative)?,
    };
    let at = clock.after(first.at, seconds);
    if at.offset < MAX_TIME_ROUNDING
        && first.at.step < at.step
        && touches_at_sample(&relative, event, at.offset, seconds)
    {
        return Some((clock.end_of(at.step - 1.0), event));
    }
    (at != Instant::NEVER).then_some((at, event))
}

/// Returns true if faces that collide `delay` seconds after the end of a step touch within rounding
/// already at its end. They then collide in that step, so that its sample contains the velocities after.
#[cold]
fn touches_at_sample(relative: &Relative, event: PairEvent, delay: f64, seconds: f64) -> bool {
    let touches = |axis: Axis| {
        let velocity = relative.velocity[axis] + relative.acceleration[axis] * seconds;
        delay * velocity.abs() <= relative.tolerance[axis]
    };
    match event {
        PairEvent::FaceImpact(axis) => touches(axis),
        PairEvent::CornerImpact => touches(Axis::X) && touches(Axis::Y),
        PairEvent::ContactEnd(_) | PairEvent::CornerPress => false,
    }
}

/// Predicts the collision of two separated boxes without relative acceleration: it is along the axis
/// whose gap closes last, provided that the boxes then overlap on the other.
///
/// The outer option is `None` if the boxes are not separated or have a relative acceleration.
#[inline]
fn predict_uniform(relative: &Relative) -> Option<Option<(f64, PairEvent)>> {
    let [x, y] = Axis::BOTH.map(|axis| relative.gap(axis));
    let overlaps = [x < -relative.tolerance[0], y < -relative.tolerance[1]];
    let separated = ((x > 0.0) & ((y > 0.0) | overlaps[1])) | ((y > 0.0) & overlaps[0]);
    if relative.acceleration != [0.0; 2] || !separated {
        return None;
    }
    // On an axis on which they overlap already the gap is negative, so the other axis is chosen.
    let speeds = relative.velocity.map(f64::abs);
    let axis = if x * speeds[1] < y * speeds[0] { Axis::Y } else { Axis::X };
    let seconds = [x, y][axis] / speeds[axis];
    Some(match relative.overlap_after(axis.other(), seconds) {
        Overlap::Face => Some((seconds, PairEvent::FaceImpact(axis))),
        Overlap::Corner | Overlap::Pressed => Some((seconds, PairEvent::CornerImpact)),
        Overlap::None => None,
    })
}

/// Predicts the next event of two boxes: at the earliest time at which a gap closes while they overlap on the
/// other axis.
fn predict_general(relative: &Relative) -> Option<(f64, PairEvent)> {
    let mut first = None;
    let mut least = f64::INFINITY;
    let touching = shallower_overlap(relative);
    for axis in Axis::BOTH {
        for side in [Side::High, Side::Low] {
            if !relative.can_close(axis, side) {
                continue;
            }
            let seconds = relative.time_to_contact(axis, side, touching == Some((axis, side)));
            if seconds < least {
                let event = match relative.overlap_after(axis.other(), seconds) {
                    Overlap::Face => PairEvent::FaceImpact(axis),
                    Overlap::Pressed if seconds == 0.0 && relative.velocity[axis] == 0.0 => PairEvent::CornerPress,
                    Overlap::Corner | Overlap::Pressed => PairEvent::CornerImpact,
                    Overlap::None => continue,
                };
                least = seconds;
                first = Some((seconds, event));
            }
        }
    }
    first
}

/// The axis and side of the shallower overlap if the boxes overlap, which is possible only by rounding.
fn shallower_overlap(relative: &Relative) -> Option<(Axis, Side)> {
    let [x, y] = Axis::BOTH.map(|axis| relative.gap(axis));
    if !(x < 0.0 && y < 0.0) {
        return None;
    }
    let axis = if y > x { Axis::Y } else { Axis::X };
    Some((axis, if relative.ahead[axis] > relative.behind[axis] { Side::High } else { Side::Low }))
}

/// Predicts when two boxes in contact along `axis` slide past each other's edge; `None` if they never do.
pub fn predict_contact_end(clock: &Clock, axis: Axis, first: &BodyState, second: &BodyState) -> Option<Instant> {
    let from = first.since.max(second.since);
    let seconds = Relative::new(clock, &Sample::new(clock, first, from), second).time_to_separation(axis.other());
    let at = clock.after(from, seconds);
    (at != Instant::NEVER).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::axis_trajectory::AxisTrajectory;
    use crate::physics::event_driven::trajectory::Trajectory;

    /// A unit box: position, velocity, acceleration.
    fn body(x: [f64; 3], y: [f64; 3]) -> BodyState {
        let since = Instant::start_of(0);
        let trajectory = Trajectory::new([x, y].map(|[position, velocity, acceleration]| AxisTrajectory {
            position,
            velocity,
            acceleration,
            since,
        }));
        let supported = [[false; 2]; 2];
        BodyState {
            trajectory,
            size: [1.0; 2],
            since,
            generation: 0,
            world_index: 0,
            infinite: false,
            supported,
            collapse_count: [0; 2],
        }
    }

    /// The event of two boxes and its time, s.
    fn predict(first: &BodyState, second: &BodyState) -> Option<(f64, PairEvent)> {
        let predict = |first: &BodyState, second: &BodyState| {
            let clock = Clock::new(1.0);
            let sample = Sample::new(&clock, first, first.since);
            let (at, event) = predict_pair_event(&clock, &sample, second, f64::INFINITY)?;
            Some((clock.seconds_between(Instant::start_of(0), at), event))
        };
        assert_eq!(predict(first, second), predict(second, first), "the prediction depends on the order");
        predict(first, second)
    }

    #[test]
    fn faces_collide_if_the_boxes_overlap_on_the_other_axis() {
        let standing = body([0.0; 3], [0.0; 3]);
        assert_eq!(
            predict(&standing, &body([3.0, -1.0, 0.0], [0.5, 0.0, 0.0])),
            Some((2.0, PairEvent::FaceImpact(Axis::X)))
        );
        assert_eq!(predict(&standing, &body([3.0, -1.0, 0.0], [0.5, 0.5, 0.0])), None, "it has passed by then");
        assert_eq!(
            predict(&standing, &body([3.0, -1.0, 0.0], [-4.0, 1.0, 0.0])),
            Some((3.0, PairEvent::FaceImpact(Axis::Y)))
        );
        assert_eq!(
            predict(&standing, &body([0.5, 0.0, 0.0], [-3.0, 0.0, 4.0])),
            Some((1.0, PairEvent::FaceImpact(Axis::Y)))
        );
    }

    #[test]
    fn a_thrown_box_lands_on_the_box_below_its_trajectory() {
        let standing = body([4.0, 0.0, 0.0], [0.0; 3]);
        let thrown = body([0.0, 1.0, 0.0], [-0.5, -2.5, 1.0]);
        assert_eq!(predict(&standing, &thrown).map(|(_, event)| event), Some(PairEvent::FaceImpact(Axis::Y)));
    }

    #[test]
    fn corners_that_touch_exactly_collide_and_edges_on_one_line_do_not() {
        let standing = body([0.0; 3], [0.0; 3]);
        assert_eq!(predict(&standing, &body([3.0, -1.0, 0.0], [3.0, -1.0, 0.0])), Some((2.0, PairEvent::CornerImpact)));
        assert_eq!(predict(&standing, &body([3.0, -1.0, 0.0], [1.0, 0.0, 0.0])), None, "edge along edge");
        assert_eq!(
            predict(&standing, &body([3.0, -1.0, 0.0], [1.0 - 1e-16, 0.0, 0.0])),
            None,
            "edge along edge within rounding"
        );
        assert_eq!(
            predict(&standing, &body([3.0, -1.0, 0.0], [0.0, 0.5, 0.0])),
            None,
            "separating on y as the gap on x closes"
        );
    }

    #[test]
    fn touching_boxes_collide_at_once_if_they_approach_or_are_pressed() {
        let standing = body([0.0; 3], [0.0; 3]);
        assert_eq!(predict(&standing, &body([0.0; 3], [-1.0, 1.0, 0.0])), Some((0.0, PairEvent::FaceImpact(Axis::Y))));
        assert_eq!(predict(&standing, &body([0.0; 3], [-1.0, 0.0, 9.81])), Some((0.0, PairEvent::FaceImpact(Axis::Y))));
        assert_eq!(
            predict(&standing, &body([0.0; 3], [-1.0 + 3e-16, 0.0, 9.81])),
            Some((0.0, PairEvent::FaceImpact(Axis::Y)))
        );
        assert_eq!(predict(&standing, &body([0.0; 3], [-1.0, 0.0, -9.81])), None);
        assert_eq!(predict(&standing, &body([0.0; 3], [-1.0, 0.0, 0.0])), None);
    }

    #[test]
    fn a_contact_ends_when_one_box_has_slid_past_the_edge_of_the_other() {
        let table = body([0.0; 3], [0.0; 3]);
        let sliding = body([0.25, 0.5, 0.0], [-1.0, 0.0, 0.0]);
        assert_eq!(
            predict_contact_end(&Clock::new(1.0), Axis::Y, &table, &sliding),
            Some(Clock::new(1.0).after(Instant::start_of(0), 1.5))
        );
        assert_eq!(
            predict_contact_end(&Clock::new(1.0), Axis::Y, &table, &body([0.25, 0.0, 0.0], [-1.0, 0.0, 0.0])),
            None
        );
    }
}
