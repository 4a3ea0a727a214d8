use super::instant::{Clock, Instant, LONGEST_ROUNDING};
use super::motion::closing_time;
use super::mover::{AXES, Mover};

/// What happens between two boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Their faces meet along the axis.
    Touch(u8),
    /// Their corners meet.
    Corner,
    /// Two in contact along the axis slide past each other's edge.
    Part(u8),
    /// Their corners, which touch, are pressed together.
    Press,
}

/// Where a body is at an instant, and how fast.
#[derive(Clone, Copy)]
pub struct State<'a> {
    /// The body.
    pub mover: &'a Mover,
    /// The instant.
    pub at: Instant,
    /// m.
    pub position: [f64; 2],
    /// m/s.
    pub velocity: [f64; 2],
}

impl<'a> State<'a> {
    /// The state at an instant.
    #[inline]
    pub fn new(clock: &Clock, mover: &'a Mover, at: Instant) -> State<'a> {
        let [position, velocity] = mover.motion.at(clock, at);
        State { mover, at, position, velocity }
    }

    /// The state at another instant, if it is another.
    #[inline]
    pub fn until(&self, clock: &Clock, at: Instant) -> State<'a> {
        if at == self.at { *self } else { State::new(clock, self.mover, at) }
    }

    /// Whether the body's mass is infinite.
    pub fn is_infinite(&self) -> bool {
        self.mover.infinite
    }
}

/// How one box stands to another at the instant from which both are known, along each axis.
struct Relative {
    /// The gap if the second is ahead of the first, m; negative where they overlap on the axis.
    ahead: [f64; 2],
    /// The gap if the second is behind the first, m.
    behind: [f64; 2],
    /// Of the second as the first sees it, m/s.
    velocity: [f64; 2],
    /// Likewise, m/s².
    acceleration: [f64; 2],
    /// What counts as touching: rounding of the coordinates, m.
    tolerance: [f64; 2],
}

/// Coordinates this many units in the last place apart touch, if nothing moves them apart.
///
/// Each face is computed with at most three roundings; stacks written down in decimals
/// are about as far off.
const TOUCHING_ULPS: f64 = 8.0;

/// The rounding allowed to coordinates whose sizes add up to `scale`, m.
pub fn tolerance(scale: f64) -> f64 {
    scale * (TOUCHING_ULPS * f64::EPSILON)
}

impl Relative {
    #[inline]
    fn new(clock: &Clock, first: &State, second: &Mover) -> Relative {
        let a = first.position;
        let [b, velocity] = second.motion.at(clock, first.at);
        let sizes = [first.mover.size, second.size];
        Relative {
            ahead: AXES.map(|axis| (b[axis] - a[axis]) - sizes[0][axis]),
            behind: AXES.map(|axis| (a[axis] - b[axis]) - sizes[1][axis]),
            velocity: AXES.map(|axis| velocity[axis] - first.velocity[axis]),
            acceleration: AXES.map(|axis| second.motion.acceleration[axis] - first.mover.motion.acceleration[axis]),
            tolerance: AXES.map(|axis| tolerance(a[axis].abs() + b[axis].abs() + (sizes[0][axis] + sizes[1][axis]))),
        }
    }

    /// Of the two gaps on an axis the wider one: how far the boxes are apart, m.
    #[inline]
    fn gap(&self, axis: usize) -> f64 {
        if self.ahead[axis] > self.behind[axis] { self.ahead[axis] } else { self.behind[axis] }
    }

    /// Whether on an axis the boxes are apart and stay so for so many seconds at least: of many
    /// boxes around one, all but the nearest.
    #[inline]
    fn stay_apart(&self, seconds: f64) -> bool {
        let positive = |number: f64| if number > 0.0 { number } else { 0.0 };
        let apart = AXES.map(|axis| {
            let side = if self.ahead[axis] > self.behind[axis] { -1.0 } else { 1.0 };
            let (speed, acceleration) = (side * self.velocity[axis], side * self.acceleration[axis]);
            let gap = self.gap(axis);
            let recede = (gap > 0.0) & (speed <= 0.0) & (acceleration <= 0.0);
            let way = seconds * (positive(speed) + 0.5 * positive(acceleration) * seconds);
            recede | (gap - way > self.tolerance[axis])
        });
        apart[0] | apart[1]
    }

    /// Whether the second box, ahead or behind, ever moves towards the first.
    fn can_close(&self, axis: usize, ahead: bool) -> bool {
        if ahead {
            self.velocity[axis] < 0.0 || self.acceleration[axis] < 0.0
        } else {
            self.velocity[axis] > 0.0 || self.acceleration[axis] > 0.0
        }
    }

    /// Seconds until the faces meet, the second box being ahead of the first or behind it.
    ///
    /// `touching`: take the gap as exactly 0.
    fn closing(&self, axis: usize, ahead: bool, touching: bool) -> f64 {
        let side = if ahead { -1.0 } else { 1.0 };
        let (speed, acceleration) = (side * self.velocity[axis], side * self.acceleration[axis]);
        let gap = if ahead { self.ahead[axis] } else { self.behind[axis] };
        let tolerance = self.tolerance[axis];
        let rests = speed == 0.0 && acceleration > 0.0 && gap.abs() <= tolerance;
        let gap = if touching || rests || (gap < 0.0 && gap >= -tolerance) { 0.0 } else { gap };
        closing_time(gap, speed, acceleration)
    }

    /// Seconds until the boxes no longer overlap on an axis.
    fn parting(&self, axis: usize) -> f64 {
        let [ahead, behind] = [self.ahead[axis], self.behind[axis]].map(|gap| if gap > 0.0 { 0.0 } else { -gap });
        let past_ahead = closing_time(ahead, self.velocity[axis], self.acceleration[axis]);
        let past_behind = closing_time(behind, -self.velocity[axis], -self.acceleration[axis]);
        if past_ahead < past_behind { past_ahead } else { past_behind }
    }

    /// How the boxes overlap on an axis after t seconds.
    #[inline]
    fn overlap(&self, axis: usize, t: f64) -> Overlap {
        let way = t * (self.velocity[axis] + 0.5 * self.acceleration[axis] * t);
        let [ahead, behind] = [self.ahead[axis] + way, self.behind[axis] - way];
        let gap = if ahead > behind { ahead } else { behind };
        if gap < -self.tolerance[axis] {
            return Overlap::Face;
        }
        let velocity = self.velocity[axis] + self.acceleration[axis] * t;
        let side = if ahead > behind { -1.0 } else { 1.0 };
        if gap > self.tolerance[axis] || side * velocity < 0.0 {
            Overlap::None
        } else if side * velocity > 0.0 {
            Overlap::Corner
        } else if side * self.acceleration[axis] > 0.0 {
            Overlap::Pressed
        } else {
            Overlap::None
        }
    }
}

enum Overlap {
    /// Of positive length.
    Face,
    /// About to begin at this very instant.
    Corner,
    /// About to begin at this very instant, from rest.
    Pressed,
    None,
}

/// When and how two boxes that are not in contact meet next.
///
/// A pure function of the two motions, the same in either order: it does not matter who
/// asks, or when. Faces meet when a gap on one axis closes while the boxes overlap on the
/// other by a positive length. If they begin to overlap there at the same instant, it is a
/// corner; if they just cease to, or slide along each other's line, they do not meet: so a
/// box passes the seam between two tiles. What comes more than `latest` seconds after
/// both are known need not be told.
#[inline]
pub fn meeting(clock: &Clock, first: &State, second: &Mover, latest: f64) -> Option<(Instant, Kind)> {
    if first.at.is_before(second.since) {
        meeting_from(clock, &State::new(clock, first.mover, second.since), second, latest)
    } else {
        meeting_from(clock, first, second, latest)
    }
}

#[inline]
fn meeting_from(clock: &Clock, first: &State, second: &Mover, latest: f64) -> Option<(Instant, Kind)> {
    let relative = Relative::new(clock, first, second);
    if relative.stay_apart(latest) {
        return None;
    }
    let (seconds, kind) = match straight_meeting(&relative) {
        Some(met) => met?,
        None => first_meeting(&relative)?,
    };
    let at = clock.after(first.at, seconds);
    if at.offset < LONGEST_ROUNDING && first.at.step < at.step && touch_at_sample(&relative, kind, at.offset, seconds) {
        return Some((clock.end_of(at.step - 1.0), kind));
    }
    (at != Instant::NEVER).then_some((at, kind))
}

/// Whether faces that meet so many seconds after a sample touch at the sample already, but for
/// rounding: then the sample is to show the velocities after.
#[cold]
fn touch_at_sample(relative: &Relative, kind: Kind, late: f64, seconds: f64) -> bool {
    let touches = |axis: usize| {
        let velocity = relative.velocity[axis] + relative.acceleration[axis] * seconds;
        late * velocity.abs() <= relative.tolerance[axis]
    };
    match kind {
        Kind::Touch(axis) => touches(usize::from(axis)),
        Kind::Corner => touches(0) && touches(1),
        Kind::Part(_) | Kind::Press => false,
    }
}

/// The meeting of two boxes that are apart and do not accelerate: the axis on which they are
/// beside each other last is the one along which they meet, if they still are on the other.
///
/// The outer option is none where this simple way does not apply.
#[inline]
fn straight_meeting(relative: &Relative) -> Option<Option<(f64, Kind)>> {
    let [x, y] = AXES.map(|axis| relative.gap(axis));
    let beside = [x < -relative.tolerance[0], y < -relative.tolerance[1]];
    let apart = ((x > 0.0) & ((y > 0.0) | beside[1])) | ((y > 0.0) & beside[0]);
    if relative.acceleration != [0.0; 2] || !apart {
        return None;
    }
    // Where they are beside each other already the gap is negative: that axis came first.
    let speeds = relative.velocity.map(f64::abs);
    let axis = usize::from(x * speeds[1] < y * speeds[0]);
    let seconds = [x, y][axis] / speeds[axis];
    Some(match relative.overlap(1 - axis, seconds) {
        Overlap::Face => Some((seconds, Kind::Touch(axis as u8))),
        Overlap::Corner | Overlap::Pressed => Some((seconds, Kind::Corner)),
        Overlap::None => None,
    })
}

fn first_meeting(relative: &Relative) -> Option<(f64, Kind)> {
    let mut best = None;
    let mut least = f64::INFINITY;
    let deep = deepest_within(relative);
    for axis in AXES {
        for ahead in [true, false] {
            if !relative.can_close(axis, ahead) {
                continue;
            }
            let seconds = relative.closing(axis, ahead, deep == Some((axis, ahead)));
            if seconds < least {
                let kind = match relative.overlap(1 - axis, seconds) {
                    Overlap::Face => Kind::Touch(axis as u8),
                    Overlap::Pressed if seconds == 0.0 && relative.velocity[axis] == 0.0 => Kind::Press,
                    Overlap::Corner | Overlap::Pressed => Kind::Corner,
                    Overlap::None => continue,
                };
                least = seconds;
                best = Some((seconds, kind));
            }
        }
    }
    best
}

/// If the boxes overlap, which can only be rounding, the axis and side of the shallower overlap.
fn deepest_within(relative: &Relative) -> Option<(usize, bool)> {
    let [x, y] = AXES.map(|axis| relative.gap(axis));
    if !(x < 0.0 && y < 0.0) {
        return None;
    }
    let axis = usize::from(y > x);
    Some((axis, relative.ahead[axis] > relative.behind[axis]))
}

/// When two boxes in contact along `axis` slide past each other's edge, if nothing intervenes.
pub fn parting(clock: &Clock, axis: usize, first: &Mover, second: &Mover) -> Option<Instant> {
    let from = first.since.or_later(second.since);
    let seconds = Relative::new(clock, &State::new(clock, first, from), second).parting(1 - axis);
    let at = clock.after(from, seconds);
    (at != Instant::NEVER).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::motion::Motion;
    use crate::physics::event_driven::motions::Motions;

    /// A unit box: position, velocity, acceleration.
    fn mover(x: [f64; 3], y: [f64; 3]) -> Mover {
        let since = Instant::start_of(0);
        let motion = Motions::new([x, y].map(|[position, velocity, acceleration]| Motion {
            position,
            velocity,
            acceleration,
            since,
        }));
        let held = [[false; 2]; 2];
        Mover { motion, size: [1.0; 2], since, generation: 0, place: 0, infinite: false, held, hurry: [0; 2] }
    }

    fn seconds(first: &Mover, second: &Mover) -> Option<(f64, Kind)> {
        let met = |first: &Mover, second: &Mover| {
            let clock = Clock::new(1.0);
            let (at, kind) = meeting(&clock, &State::new(&clock, first, first.since), second, f64::INFINITY)?;
            Some((clock.seconds(Instant::start_of(0), at), kind))
        };
        assert_eq!(met(first, second), met(second, first), "it does not matter who asks");
        met(first, second)
    }

    #[test]
    fn faces_meet_where_the_boxes_are_beside_each_other() {
        let standing = mover([0.0; 3], [0.0; 3]);
        assert_eq!(seconds(&standing, &mover([3.0, -1.0, 0.0], [0.5, 0.0, 0.0])), Some((2.0, Kind::Touch(0))));
        assert_eq!(seconds(&standing, &mover([3.0, -1.0, 0.0], [0.5, 0.5, 0.0])), None, "it has passed by then");
        assert_eq!(seconds(&standing, &mover([3.0, -1.0, 0.0], [-4.0, 1.0, 0.0])), Some((3.0, Kind::Touch(1))));
        assert_eq!(seconds(&standing, &mover([0.5, 0.0, 0.0], [-3.0, 0.0, 4.0])), Some((1.0, Kind::Touch(1))));
    }

    #[test]
    fn a_thrown_box_comes_down_on_what_it_flew_over() {
        let standing = mover([4.0, 0.0, 0.0], [0.0; 3]);
        let thrown = mover([0.0, 1.0, 0.0], [-0.5, -2.5, 1.0]);
        assert_eq!(seconds(&standing, &thrown).map(|(_, kind)| kind), Some(Kind::Touch(1)));
    }

    #[test]
    fn corners_and_edges() {
        let standing = mover([0.0; 3], [0.0; 3]);
        assert_eq!(seconds(&standing, &mover([3.0, -1.0, 0.0], [3.0, -1.0, 0.0])), Some((2.0, Kind::Corner)));
        assert_eq!(seconds(&standing, &mover([3.0, -1.0, 0.0], [1.0, 0.0, 0.0])), None, "edge along edge");
        assert_eq!(seconds(&standing, &mover([3.0, -1.0, 0.0], [1.0 - 1e-16, 0.0, 0.0])), None, "but for a rounding");
        assert_eq!(seconds(&standing, &mover([3.0, -1.0, 0.0], [0.0, 0.5, 0.0])), None, "parting as they arrive");
    }

    #[test]
    fn touching_boxes_meet_at_once_if_they_approach_or_are_pressed() {
        let standing = mover([0.0; 3], [0.0; 3]);
        assert_eq!(seconds(&standing, &mover([0.0; 3], [-1.0, 1.0, 0.0])), Some((0.0, Kind::Touch(1))));
        assert_eq!(seconds(&standing, &mover([0.0; 3], [-1.0, 0.0, 9.81])), Some((0.0, Kind::Touch(1))));
        assert_eq!(seconds(&standing, &mover([0.0; 3], [-1.0 + 3e-16, 0.0, 9.81])), Some((0.0, Kind::Touch(1))));
        assert_eq!(seconds(&standing, &mover([0.0; 3], [-1.0, 0.0, -9.81])), None);
        assert_eq!(seconds(&standing, &mover([0.0; 3], [-1.0, 0.0, 0.0])), None);
    }

    #[test]
    fn a_box_in_contact_parts_when_it_has_slid_past_the_edge() {
        let table = mover([0.0; 3], [0.0; 3]);
        let sliding = mover([0.25, 0.5, 0.0], [-1.0, 0.0, 0.0]);
        assert_eq!(
            parting(&Clock::new(1.0), 1, &table, &sliding),
            Some(Clock::new(1.0).after(Instant::start_of(0), 1.5))
        );
        assert_eq!(parting(&Clock::new(1.0), 1, &table, &mover([0.25, 0.0, 0.0], [-1.0, 0.0, 0.0])), None);
    }
}
