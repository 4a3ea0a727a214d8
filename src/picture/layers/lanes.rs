use super::arrows::{Arrow, LabeledArrow, lane_width};
use crate::physics::{BodyId, Vector, larger, smaller};
use crate::picture::Overlay;
use std::collections::BTreeMap;

/// The quantity of a body that an arrow shows.
pub type ArrowKey = (Overlay, BodyId);

/// The lanes of the arrows of bodies, side by side at a distance of [`lane_width`]. Arrows that lie along one another
/// at some time have different lanes. An arrow is in the middle of its body and moves to its lane only as far as
/// another arrow comes close, so in a clip, whose frames have the same lanes, no arrow jumps while its body moves
/// uniformly.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lanes(BTreeMap<ArrowKey, i32>);

/// With more arrows than this, none is moved: they are short, and their number hides each one.
const MAX_SEPARATED: usize = 200;

/// The highest number of a lane on either side of the middle one.
const LAST_LANE: i32 = 4;

/// All lanes: the middle one, then outwards on both sides.
fn all_lanes() -> impl Iterator<Item = i32> {
    std::iter::once(0).chain((1..=LAST_LANE).flat_map(|lane| [lane, -lane]))
}

/// Moves arrows sideways that lie along an earlier one, such as those of boxes in a row, so that each is visible:
/// arrows of bodies to their lanes, others to the first free one. Without `lanes`, they are those of these arrows
/// alone.
pub fn separate(arrows: &mut [LabeledArrow], lanes: &Lanes) {
    if arrows.len() > MAX_SEPARATED {
        return;
    }
    let own_lanes;
    let lanes = if lanes.0.is_empty() {
        let mut conflicts = LaneConflicts::default();
        conflicts.add(arrows);
        own_lanes = conflicts.lanes();
        &own_lanes
    } else {
        lanes
    };
    // Of a pair, both arrows come the same part of the way to their lanes.
    let unmoved: Vec<(Option<ArrowKey>, Arrow)> = arrows.iter().map(|arrow| (arrow.key, arrow.arrow)).collect();
    let nearness = |at: usize| {
        let others = unmoved.iter().enumerate().filter(|(other, (key, _))| *other != at && key.is_some());
        let own = &unmoved[at].1;
        let nearness =
            others.map(|(other, (_, arrow))| if other < at { arrow.nearness(own) } else { own.nearness(arrow) });
        nearness.fold(0.0, larger)
    };
    for at in 0..arrows.len() {
        let (earlier, rest) = arrows.split_at_mut(at);
        let Some(LabeledArrow { arrow, key, .. }) = rest.first_mut() else { return };
        match key.and_then(|key| lanes.0.get(&key)) {
            Some(0) => {}
            Some(&lane) => *arrow = arrow.moved_aside(nearness(at) * f64::from(lane)),
            None => {
                let mut moved = all_lanes().map(|lane| arrow.moved_aside(f64::from(lane)));
                let free = moved.find(|moved| !earlier.iter().any(|other| other.arrow.covers(moved)));
                *arrow = free.unwrap_or(*arrow);
            }
        }
    }
}

/// The number of differences between two lanes.
const DIFFERENCES: usize = 4 * LAST_LANE as usize + 1;

/// The largest number of arrows in a clip that keep a lane, which bounds memory. Further ones have a lane in each
/// frame.
pub const MAX_KEPT: usize = 400;

/// The arrows of a clip that lie along one another, from which [`Lanes`] follow.
#[derive(Debug, Default)]
pub struct LaneConflicts {
    /// For each arrow and each earlier one that it conflicts with, the number of frames in which they would lie along
    /// one another if their lanes differed by −8, −7, …, 8.
    frames: BTreeMap<ArrowKey, BTreeMap<ArrowKey, [u32; DIFFERENCES]>>,
}

impl LaneConflicts {
    /// Adds the arrows of one frame, in drawing order.
    pub fn add(&mut self, arrows: &[LabeledArrow]) {
        if arrows.len() > MAX_SEPARATED {
            return;
        }
        let keyed: Vec<(ArrowKey, &Arrow)> =
            arrows.iter().filter_map(|arrow| Some((arrow.key?, &arrow.arrow))).collect();
        for (at, (key, arrow)) in keyed.iter().enumerate() {
            if self.frames.len() >= MAX_KEPT && !self.frames.contains_key(key) {
                continue;
            }
            let conflicts = self.frames.entry(*key).or_default();
            for (earlier_key, earlier) in keyed[..at].iter().filter(|(_, earlier)| earlier.is_parallel(arrow)) {
                let is_near = |difference: i32| {
                    let moved = arrow.moved_aside(f64::from(difference));
                    earlier.covers(&moved) || difference == 0 && earlier.nearness(&moved) > 0.0
                };
                let near: Vec<i32> = (-2 * LAST_LANE..=2 * LAST_LANE).filter(|&lanes| is_near(lanes)).collect();
                for difference in near {
                    let counts = conflicts.entry(*earlier_key).or_insert([0; DIFFERENCES]);
                    counts[(difference + 2 * LAST_LANE) as usize] += 1;
                }
            }
        }
    }

    /// For each arrow, in the order of quantities and bodies, the lane in which it lies along earlier ones least often.
    pub fn lanes(&self) -> Lanes {
        let mut lanes: BTreeMap<ArrowKey, i32> = BTreeMap::new();
        for (&key, conflicts) in &self.frames {
            let conflict_frames = |lane: i32| -> u64 {
                let frames = |(earlier, counts): (&ArrowKey, &[u32; DIFFERENCES])| {
                    let other = lanes.get(earlier).copied().unwrap_or(0);
                    u64::from(counts[(lane - other + 2 * LAST_LANE) as usize])
                };
                conflicts.iter().map(frames).sum()
            };
            let lane = all_lanes().min_by_key(|&lane| conflict_frames(lane)).unwrap_or(0);
            lanes.insert(key, lane);
        }
        Lanes(lanes)
    }
}

/// The sine of the angle up to which two arrows count as parallel, and from which on they do not influence each other.
const PARALLEL: [f64; 2] = [0.1, 0.15];

/// The distance at which two parallel arrows are beside each other, and at which they do not influence each other, in
/// lanes.
const BESIDE: [f64; 2] = [0.9, 1.2];

/// The gap between two arrows on one line from which on they do not influence each other, in lanes.
const AHEAD: f64 = 2.0;

impl Arrow {
    /// The arrow moved sideways by a number of lanes: to the same side for opposite arrows.
    fn moved_aside(&self, lanes: f64) -> Arrow {
        let direction = self.to.sub(self.from);
        let length = direction.norm();
        if !(length > 0.0 && length.is_finite()) {
            return *self;
        }
        // The sign changes at a direction that is along no axis, as most motions are.
        let sign = if 2.0 * direction.x + direction.y > 0.0 { 1.0 } else { -1.0 };
        let offset = Vector::new(-direction.y, direction.x).mult(sign * lanes * lane_width(self.width) / length);
        Arrow { from: self.from.add(offset), to: self.to.add(offset), ..*self }
    }

    /// Returns true if another arrow lies along this one, so that the two could not be distinguished.
    pub fn covers(&self, other: &Arrow) -> bool {
        self.relation(other).is_some_and(|Relation { sine, beside, overlap, .. }| {
            sine <= PARALLEL[0] && beside < BESIDE[0] && overlap > self.width
        })
    }

    /// Returns true if the directions are so similar or opposite that one arrow can come close to lying along the
    /// other.
    fn is_parallel(&self, other: &Arrow) -> bool {
        self.sine(other).is_some_and(|sine| sine < PARALLEL[1])
    }

    /// The sine of the angle to another arrow; `None` if one has no direction.
    fn sine(&self, other: &Arrow) -> Option<f64> {
        let [along, direction] = [self, other].map(|arrow| arrow.to.sub(arrow.from));
        let lengths = along.norm() * direction.norm();
        (lengths > 0.0 && lengths.is_finite()).then(|| cross(along, direction).abs() / lengths)
    }

    /// The position of another arrow relative to this one, if they are nearly parallel.
    fn relation(&self, other: &Arrow) -> Option<Relation> {
        let sine = self.sine(other).filter(|&sine| sine < PARALLEL[1])?;
        let along = self.to.sub(self.from);
        let length = along.norm();
        let unit = along.mult(1.0 / length);
        let ends = [other.from, other.to].map(|end| end.sub(self.from));
        let [tail, tip] = ends.map(|end| end.dot(unit));
        let [a, b] = ends.map(|end| cross(unit, end).abs() / lane_width(self.width));
        let overlap = smaller(larger(tail, tip), length) - larger(smaller(tail, tip), 0.0);
        Some(Relation { sine, beside: smaller(a, b), overlap, is_back_to_back: tip < 0.0 && tip < tail })
    }

    /// The degree to which another arrow lies along this one: 1 if they are indistinguishable, 0 if they are apart,
    /// and in between if they come close, so that it is continuous.
    fn nearness(&self, other: &Arrow) -> f64 {
        let Some(relation) = self.relation(other) else { return 0.0 };
        let ahead = AHEAD * lane_width(self.width);
        // Arrows that begin at one point and point away from each other, such as those of one body, stay there.
        let gaps = if relation.is_back_to_back { [-ahead, 0.0] } else { [-self.width, ahead] };
        fade(relation.sine, PARALLEL) * fade(relation.beside, BESIDE) * fade(-relation.overlap, gaps)
    }
}

/// The position of an arrow relative to a nearly parallel one.
struct Relation {
    /// The sine of the angle between them.
    sine: f64,
    /// The distance sideways, in lanes.
    beside: f64,
    /// The length along which they overlap, px; negative for a gap.
    overlap: f64,
    /// True if they point away from each other.
    is_back_to_back: bool,
}

fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Falls from 1 to 0 between two values.
fn fade(value: f64, [one, zero]: [f64; 2]) -> f64 {
    ((zero - value) / (zero - one)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Color;

    fn arrow(number: u32, from: [f64; 2], to: [f64; 2]) -> LabeledArrow {
        let [from, to] = [from, to].map(|[x, y]| Vector::new(x, y));
        let arrow = Arrow::new(from, to, 2.0, Color::hex(0));
        LabeledArrow { key: Some((Overlay::Velocity, number)), ..arrow.into() }
    }

    fn without_keys(arrows: &mut [LabeledArrow]) {
        arrows.iter_mut().for_each(|arrow| arrow.key = None);
    }

    #[test]
    fn arrows_along_one_line_are_moved_apart_and_others_stay() {
        for has_keys in [true, false] {
            let along = |at: u32| 30.0 * f64::from(at);
            let mut row: Vec<LabeledArrow> =
                (0..5).map(|at| arrow(at, [along(at), 50.0], [along(at) + 100.0, 50.0])).collect();
            row.push(arrow(5, [50.0, 0.0], [50.0, 99.0]));
            row.push(arrow(6, [120.0, 50.0], [20.0, 50.0]));
            let mut head_on = vec![arrow(0, [0.0, 0.0], [40.0, 0.0]), arrow(1, [120.0, 0.0], [80.0, 0.0])];
            if !has_keys {
                without_keys(&mut row);
                without_keys(&mut head_on);
            }
            separate(&mut row, &Lanes::default());
            for (at, a) in row.iter().enumerate() {
                assert!(row[..at].iter().all(|b| !b.arrow.covers(&a.arrow)), "{at}");
            }
            assert_eq!((row[0].arrow.from.y, row[5].arrow.from.x), (50.0, 50.0));
            separate(&mut head_on, &Lanes::default());
            assert_eq!([head_on[0].arrow.from.y, head_on[1].arrow.from.y], [0.0, 0.0]);
            // A velocity and a force of one body, in opposite directions.
            let mut opposite = vec![arrow(0, [0.0, 0.0], [0.0, -40.0]), arrow(1, [0.0, 0.0], [0.0, 40.0])];
            separate(&mut opposite, &Lanes::default());
            assert_eq!([opposite[0].arrow.from.x, opposite[1].arrow.from.x], [0.0, 0.0]);
        }
    }

    /// A number from -1 to 1.
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Frames of arrows on three parallel lines that move uniformly along these, by up to 1 px a frame.
    fn clip(seed: u64, count: u32) -> Vec<Vec<LabeledArrow>> {
        let mut state = seed;
        let bodies: Vec<[f64; 3]> = (0..count)
            .map(|number| [300.0 * random(&mut state), 100.0 * f64::from(number % 3), random(&mut state)])
            .collect();
        let frame = |step: u32| {
            let arrow = |(number, [x, y, velocity]): (usize, &[f64; 3])| {
                let x = x + f64::from(step) * velocity;
                arrow(number as u32, [x, *y], [x + 70.0 * velocity.signum(), *y])
            };
            bodies.iter().enumerate().map(arrow).collect()
        };
        (0..400).map(frame).collect()
    }

    #[test]
    fn no_arrow_of_a_clip_jumps_and_no_two_lie_along_one_another() {
        for seed in 1..=20 {
            let frames = clip(seed, 9);
            let mut conflicts = LaneConflicts::default();
            frames.iter().for_each(|arrows| conflicts.add(arrows));
            let lanes = conflicts.lanes();
            let mut last: Option<Vec<f64>> = None;
            for mut arrows in frames {
                let own: Vec<f64> = arrows.iter().map(|arrow| arrow.arrow.from.y).collect();
                separate(&mut arrows, &lanes);
                let offsets: Vec<f64> = arrows.iter().zip(own).map(|(arrow, own)| arrow.arrow.from.y - own).collect();
                let jump = last.iter().flatten().zip(&offsets).map(|(a, b)| (a - b).abs()).fold(0.0, larger);
                // Bodies that approach each other at 2 px a frame.
                assert!(jump < 0.5 * f64::from(LAST_LANE) * lane_width(2.0), "seed {seed}: {jump} px");
                last = Some(offsets);
                for (at, a) in arrows.iter().enumerate() {
                    assert!(arrows[..at].iter().all(|b| b.arrow.nearness(&a.arrow) < 1.0), "seed {seed}");
                }
            }
        }
    }
}
