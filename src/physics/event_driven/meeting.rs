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
pub struct State<'a> {
    mover: &'a Mover,
    at: Instant,
    position: [f64; 2],
    velocity: [f64; 2],
}

impl<'a> State<'a> {
    /// The state at an instant.
    #[inline]
    pub fn new(clock: &Clock, mover: &'a Mover, at: Instant) -> State<'a> {
        let [(x, vx), (y, vy)] = [mover.motion[0].at(clock, at), mover.motion[1].at(clock, at)];
        State { mover, at, position: [x, y], velocity: [vx, vy] }
    }

    /// Whether the body's mass is infinite.
    pub fn is_infinite(&self) -> bool {
        self.mover.infinite
    }
}

/// How one box stands to another along one axis at the instant from which both are known.
struct Relative {
    /// The gap if the second is ahead of the first, and if it is behind, m; both negative
    /// where the boxes overlap on this axis.
    gaps: [f64; 2],
    /// Of the second as the first sees it, m/s and m/s².
    velocity: f64,
    acceleration: f64,
    /// What counts as touching: rounding of the coordinates, m.
    tolerance: f64,
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
    fn new(clock: &Clock, axis: usize, first: &State, second: &Mover) -> Relative {
        let a = first.position[axis];
        let (b, velocity) = second.motion[axis].at(clock, first.at);
        let [a_size, b_size] = [first.mover.size[axis], second.size[axis]];
        Relative {
            gaps: [(b - a) - a_size, (a - b) - b_size],
            velocity: velocity - first.velocity[axis],
            acceleration: second.motion[axis].acceleration - first.mover.motion[axis].acceleration,
            tolerance: tolerance(a.abs() + b.abs() + (a_size + b_size)),
        }
    }

    /// Of the two gaps the wider one: how far the boxes are apart, m.
    fn gap(&self) -> f64 {
        let [ahead, behind] = self.gaps;
        if ahead > behind { ahead } else { behind }
    }

    /// Whether the boxes are apart on this axis and will ever be: the commonest case, seen at once.
    #[inline]
    fn separates(&self) -> bool {
        let [ahead, behind] = self.gaps;
        self.acceleration == 0.0 && ((ahead > 0.0 && self.velocity >= 0.0) || (behind > 0.0 && self.velocity <= 0.0))
    }

    /// Whether the second box, ahead or behind, ever moves towards the first.
    fn can_close(&self, ahead: bool) -> bool {
        if ahead {
            self.velocity < 0.0 || self.acceleration < 0.0
        } else {
            self.velocity > 0.0 || self.acceleration > 0.0
        }
    }

    /// Seconds until the faces meet, the second box being ahead of the first or behind it.
    ///
    /// `touching`: take the gap as exactly 0.
    fn closing(&self, ahead: bool, touching: bool) -> f64 {
        let side = if ahead { -1.0 } else { 1.0 };
        let (speed, acceleration) = (side * self.velocity, side * self.acceleration);
        let gap = self.gaps[usize::from(!ahead)];
        let rests = speed == 0.0 && acceleration > 0.0 && gap.abs() <= self.tolerance;
        let gap = if touching || rests || (gap < 0.0 && gap >= -self.tolerance) { 0.0 } else { gap };
        closing_time(gap, speed, acceleration)
    }

    /// Seconds until the boxes no longer overlap on this axis.
    fn parting(&self) -> f64 {
        let [ahead, behind] = self.gaps.map(|gap| if gap > 0.0 { 0.0 } else { -gap });
        let past_ahead = closing_time(ahead, self.velocity, self.acceleration);
        let past_behind = closing_time(behind, -self.velocity, -self.acceleration);
        if past_ahead < past_behind { past_ahead } else { past_behind }
    }

    /// How the boxes overlap on this axis after t seconds.
    fn overlap(&self, t: f64) -> Overlap {
        let way = t * (self.velocity + 0.5 * self.acceleration * t);
        let [ahead, behind] = [self.gaps[0] + way, self.gaps[1] - way];
        let gap = if ahead > behind { ahead } else { behind };
        if gap < -self.tolerance {
            return Overlap::Face;
        }
        let velocity = self.velocity + self.acceleration * t;
        let side = if ahead > behind { -1.0 } else { 1.0 };
        if gap > self.tolerance || side * velocity < 0.0 {
            Overlap::None
        } else if side * velocity > 0.0 {
            Overlap::Corner
        } else if side * self.acceleration > 0.0 {
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
/// box passes the seam between two tiles.
#[inline]
pub fn meeting(clock: &Clock, first: &State, second: &Mover) -> Option<(Instant, Kind)> {
    if first.at.is_before(second.since) {
        meeting_from(clock, &State::new(clock, first.mover, second.since), second)
    } else {
        meeting_from(clock, first, second)
    }
}

#[inline]
fn meeting_from(clock: &Clock, first: &State, second: &Mover) -> Option<(Instant, Kind)> {
    let x = Relative::new(clock, 0, first, second);
    if x.separates() {
        return None;
    }
    let y = Relative::new(clock, 1, first, second);
    if y.separates() {
        return None;
    }
    let axes = [&x, &y];
    let (seconds, kind) = match straight_meeting(&axes) {
        Some(met) => met?,
        None => first_meeting(&axes)?,
    };
    let at = clock.after(first.at, seconds);
    if at.offset < LONGEST_ROUNDING && first.at.step < at.step && touch_at_sample(&axes, kind, at.offset, seconds) {
        return Some((clock.end_of(at.step - 1.0), kind));
    }
    (at != Instant::NEVER).then_some((at, kind))
}

/// Whether faces that meet so many seconds after a sample touch at the sample already, but for
/// rounding: then the sample is to show the velocities after.
#[cold]
fn touch_at_sample(axes: &[&Relative; 2], kind: Kind, late: f64, seconds: f64) -> bool {
    let touches = |axis: &Relative| late * (axis.velocity + axis.acceleration * seconds).abs() <= axis.tolerance;
    match kind {
        Kind::Touch(axis) => touches(axes[usize::from(axis)]),
        Kind::Corner => touches(axes[0]) && touches(axes[1]),
        Kind::Part(_) | Kind::Press => false,
    }
}

/// The meeting of two boxes that are apart and do not accelerate: the axis on which they are
/// beside each other last is the one along which they meet, if they still are on the other.
///
/// The outer option is none where this simple way does not apply.
fn straight_meeting(axes: &[&Relative; 2]) -> Option<Option<(f64, Kind)>> {
    if axes[0].acceleration != 0.0 || axes[1].acceleration != 0.0 {
        return None;
    }
    let [x, y] = [axes[0].gap(), axes[1].gap()];
    let axis = if x > 0.0 && y > 0.0 {
        usize::from(x * axes[1].velocity.abs() < y * axes[0].velocity.abs())
    } else if x > 0.0 && y < -axes[1].tolerance {
        0
    } else if y > 0.0 && x < -axes[0].tolerance {
        1
    } else {
        return None;
    };
    let seconds = (if axis == 0 { x } else { y }) / axes[axis].velocity.abs();
    Some(match axes[1 - axis].overlap(seconds) {
        Overlap::Face => Some((seconds, Kind::Touch(axis as u8))),
        Overlap::Corner | Overlap::Pressed => Some((seconds, Kind::Corner)),
        Overlap::None => None,
    })
}

fn first_meeting(axes: &[&Relative; 2]) -> Option<(f64, Kind)> {
    let mut best = None;
    let mut least = f64::INFINITY;
    let deep = deepest_within(axes);
    for axis in AXES {
        for ahead in [true, false] {
            if !axes[axis].can_close(ahead) {
                continue;
            }
            let seconds = axes[axis].closing(ahead, deep == Some((axis, ahead)));
            if seconds < least {
                let kind = match axes[1 - axis].overlap(seconds) {
                    Overlap::Face => Kind::Touch(axis as u8),
                    Overlap::Pressed if seconds == 0.0 && axes[axis].velocity == 0.0 => Kind::Press,
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
fn deepest_within(axes: &[&Relative; 2]) -> Option<(usize, bool)> {
    let [x, y] = [axes[0].gap(), axes[1].gap()];
    if !(x < 0.0 && y < 0.0) {
        return None;
    }
    let axis = usize::from(y > x);
    let [ahead, behind] = axes[axis].gaps;
    Some((axis, ahead > behind))
}

/// When two boxes in contact along `axis` slide past each other's edge, if nothing intervenes.
pub fn parting(clock: &Clock, axis: usize, first: &Mover, second: &Mover) -> Option<Instant> {
    let from = first.since.or_later(second.since);
    let seconds = Relative::new(clock, 1 - axis, &State::new(clock, first, from), second).parting();
    let at = clock.after(from, seconds);
    (at != Instant::NEVER).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::motion::Motion;

    /// A unit box: position, velocity, acceleration.
    fn mover(x: [f64; 3], y: [f64; 3]) -> Mover {
        let since = Instant::start_of(0);
        let motion =
            [x, y].map(|[position, velocity, acceleration]| Motion { position, velocity, acceleration, since });
        let held = [[false; 2]; 2];
        Mover { motion, size: [1.0; 2], since, generation: 0, place: 0, infinite: false, held, hurry: [0; 2] }
    }

    fn seconds(first: &Mover, second: &Mover) -> Option<(f64, Kind)> {
        let met = |first: &Mover, second: &Mover| {
            let (at, kind) = meeting(&Clock::new(1.0), &State::new(&Clock::new(1.0), first, first.since), second)?;
            Some((Clock::new(1.0).seconds(Instant::start_of(0), at), kind))
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
