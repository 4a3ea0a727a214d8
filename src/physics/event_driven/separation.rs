//! Removes the overlaps that spawned bodies cause, by moving bodies to the nearest free position.

use super::EventDriven;
use super::axis_trajectory::StateDd;
use super::body_state::Slot;
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::{Sample, tolerance};
use crate::physics::{Axis, larger, smaller};

/// An axis-aligned bounding box: upper-left corner and size, m.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Aabb {
    low: [f64; 2],
    size: [f64; 2],
}

impl Aabb {
    /// The box of the same size at another corner.
    fn at(self, low: [f64; 2]) -> Aabb {
        Aabb { low, ..self }
    }

    /// The lower-right corner.
    fn high(&self) -> [f64; 2] {
        Axis::BOTH.map(|axis| self.low[axis] + self.size[axis])
    }

    /// True if the two share more than a border, beyond rounding.
    fn overlaps(&self, other: &Aabb) -> bool {
        Axis::BOTH.into_iter().all(|axis| self.overlaps_along(other, axis))
    }

    /// True if the intervals that the two cover along an axis share more than a border, beyond rounding.
    fn overlaps_along(&self, other: &Aabb, axis: Axis) -> bool {
        // The rounding of a gap is that of the numbers from which its two faces are computed.
        let positions = self.low[axis].abs() + other.low[axis].abs();
        let high_gap = other.low[axis] - (self.low[axis] + self.size[axis]);
        let low_gap = self.low[axis] - (other.low[axis] + other.size[axis]);
        high_gap < -tolerance(positions + self.size[axis]) && low_gap < -tolerance(positions + other.size[axis])
    }
}

impl EventDriven {
    /// Removes the overlaps of spawned bodies. Velocities do not change, so no kinetic energy is added.
    ///
    /// In creation order, each spawned body of finite mass moves to the nearest position at which it
    /// overlaps no body that is already placed. A spawned body of infinite mass stays, and the older
    /// bodies of finite mass that it overlaps move instead. The nearest position is found exactly,
    /// among all positions that touch faces of obstacles.
    ///
    /// Returns the spawned bodies of finite mass that may touch others then, in creation order, and the older bodies
    /// that it moved or that were in contact with these.
    pub(super) fn separate_overlaps(&mut self, spawned: &[Slot]) -> (Vec<Slot>, Vec<Slot>) {
        let (mut queue, mut concerned) = self.displaced_by_infinite(spawned);
        concerned.extend(&queue);
        queue.extend(spawned.iter().copied().filter(|slot| !self.bodies[*slot].infinite));
        let mut touching = Vec::new();
        let mut neighbours = NeighbourBuffer::default();
        for index in 0..queue.len() {
            let slot = queue[index];
            let is_examined = !self.touches_none_but(slot, None, &mut neighbours);
            #[cfg(test)]
            let is_examined = is_examined || self.examines_all_spawned;
            if !is_examined {
                continue;
            }
            touching.push(slot);
            let aabb = self.aabb_of(slot);
            if let Some(low) = self.nearest_free_position(slot, aabb, &queue[index + 1..]) {
                self.cell_lists.remove(slot);
                for axis in Axis::BOTH {
                    let state = self.state_dd(slot, axis);
                    self.set_trajectory(
                        slot,
                        axis,
                        StateDd { position: low[axis].into(), ..state },
                        self.timeline.now(),
                    );
                }
                self.cell_lists.insert(self.timeline.clock(), slot, &self.bodies[slot], self.timeline.now());
                // At its new position it may touch bodies that touched none before.
                let sample = Sample::new(&self.bodies[slot], self.timeline.now());
                self.find_touching(slot, &sample, &mut neighbours);
                touching.extend(neighbours.slots());
            }
        }
        touching.sort_unstable();
        touching.dedup();
        touching.retain(|slot| !self.bodies[*slot].infinite && spawned.binary_search(slot).is_ok());
        (touching, concerned)
    }

    /// The older bodies of finite mass that spawned bodies of infinite mass overlap, and those that were in contact
    /// with them; ends their contacts.
    fn displaced_by_infinite(&mut self, spawned: &[Slot]) -> (Vec<Slot>, Vec<Slot>) {
        let mut displaced = Vec::new();
        for slot in spawned.iter().filter(|slot| self.bodies[**slot].infinite) {
            let aabb = self.aabb_of(*slot);
            self.cell_lists.visit_region(aabb.low, aabb.high(), |other| {
                let is_older = !self.bodies[other].infinite && spawned.binary_search(&other).is_err();
                if is_older && aabb.overlaps(&self.aabb_of(other)) {
                    displaced.push(other);
                }
            });
        }
        displaced.sort_unstable();
        displaced.dedup();
        let mut woken = Vec::new();
        displaced.iter().for_each(|slot| woken.extend(self.contacts.remove_all(*slot)));
        (displaced, woken)
    }

    /// The bounding box of a body at the present instant.
    fn aabb_of(&self, slot: Slot) -> Aabb {
        let body = &self.bodies[slot];
        Aabb { low: body.trajectory.at(self.timeline.now())[0], size: body.size }
    }

    /// The nearest free position of a body that overlaps another; none if it overlaps none, or if
    /// no free position is found.
    ///
    /// Bodies in `unplaced`, which is in creation order, are no obstacles.
    fn nearest_free_position(&self, slot: Slot, aabb: Aabb, unplaced: &[Slot]) -> Option<[f64; 2]> {
        let mut radius = larger(aabb.size[0], aabb.size[1]);
        let mut is_free = true;
        self.cell_lists.visit_region(aabb.low, aabb.high(), |other| {
            is_free &= other == slot || !aabb.overlaps(&self.aabb_of(other)) || unplaced.binary_search(&other).is_ok();
        });
        if is_free {
            return None;
        }
        // At 2⁶⁴ times its size, coordinates do not resolve the body any more.
        for _ in 0..64 {
            let obstacles = self.obstacles(slot, &aabb, radius, unplaced);
            if let Some(position) = nearest_free_corner(&aabb, &obstacles, radius) {
                return Some(position);
            }
            radius *= 2.0;
        }
        None
    }

    /// The boxes of all placed bodies within `radius` (m) of `aabb`, and possibly some farther away.
    fn obstacles(&self, slot: Slot, aabb: &Aabb, radius: f64, unplaced: &[Slot]) -> Vec<Aabb> {
        let mut found = Vec::new();
        let low = aabb.low.map(|x| x - radius);
        let high = aabb.high().map(|x| x + radius);
        self.cell_lists.visit_region(low, high, |other| found.push(other));
        found.sort_unstable();
        found.dedup();
        found.retain(|other| *other != slot && unplaced.binary_search(other).is_err());
        found.into_iter().map(|other| self.aabb_of(other)).collect()
    }
}

/// The free position nearest to the present one, if there is one within `radius`, m.
///
/// Of several nearest positions, it is that with the smallest displacement along x, then with the lowest x and y: top,
/// bottom, left, right.
fn nearest_free_corner(aabb: &Aabb, obstacles: &[Aabb], radius: f64) -> Option<[f64; 2]> {
    let [xs, ys] = Axis::BOTH.map(|axis| candidate_coordinates(aabb, obstacles, axis));
    let (mut best, mut least) = (None, radius * radius);
    let (mut in_column, mut blocked) = (Vec::new(), BlockedIntervals::default());
    for [dx, x] in &xs {
        if dx * dx > least {
            break;
        }
        let column = aabb.at([*x, aabb.low[1]]);
        in_column.clear();
        in_column.extend(obstacles.iter().filter(|obstacle| column.overlaps_along(obstacle, Axis::X)));
        blocked.set(&column, &in_column);
        let depth = blocked.depth(aabb.low[1]);
        let first = ys.partition_point(|[dy, _]| *dy < depth);
        for [dy, y] in &ys[first..] {
            let square = dx * dx + dy * dy;
            if square > least || (square == least && best.is_some()) {
                break;
            }
            let candidate = aabb.at([*x, *y]);
            if blocked.depth(*y) == 0.0 && !in_column.iter().any(|other| candidate.overlaps_along(other, Axis::Y)) {
                least = square;
                best = Some([*x, *y]);
                break;
            }
        }
    }
    best
}

/// Positions along y at which a box certainly overlaps an obstacle, as open intervals that share no point, ascending.
#[derive(Default)]
struct BlockedIntervals(Vec<[f64; 2]>);

impl BlockedIntervals {
    /// Sets the intervals of a box among obstacles, of which the box overlaps each along x.
    fn set(&mut self, aabb: &Aabb, obstacles: &[&Aabb]) {
        let BlockedIntervals(intervals) = self;
        intervals.clear();
        for obstacle in obstacles {
            let (low, high) = (obstacle.low[1] - aabb.size[1], obstacle.low[1] + obstacle.size[1]);
            // More than the tolerance of an overlap and the rounding of the borders.
            let margin = 4.0 * tolerance(low.abs() + high.abs() + aabb.size[1]);
            if low + margin < high - margin {
                intervals.push([low + margin, high - margin]);
            }
        }
        sort_pairs(intervals);
        intervals.dedup_by(|next, last| {
            let is_joined = next[0] < last[1];
            last[1] = if is_joined { larger(last[1], next[1]) } else { last[1] };
            is_joined
        });
    }

    /// The distance of a blocked position from the border of its interval; 0 for any other position.
    fn depth(&self, position: f64) -> f64 {
        let BlockedIntervals(intervals) = self;
        let next = intervals.partition_point(|[low, _]| *low < position);
        let interval = next.checked_sub(1).map(|index| intervals[index]);
        interval.map_or(0.0, |[low, high]| larger(smaller(position - low, high - position), 0.0))
    }
}

/// The coordinates along an axis at which the box stays or touches an obstacle, each after its distance from the
/// present one; nearest first.
fn candidate_coordinates(aabb: &Aabb, obstacles: &[Aabb], axis: Axis) -> Vec<[f64; 2]> {
    let here = aabb.low[axis];
    let mut candidates = vec![[0.0, here]];
    for obstacle in obstacles {
        let before = largest_position_before(obstacle.low[axis], aabb.size[axis]);
        for coordinate in [before, obstacle.low[axis] + obstacle.size[axis]] {
            candidates.push([(coordinate - here).abs(), coordinate]);
        }
    }
    sort_pairs(&mut candidates);
    candidates.dedup();
    candidates
}

fn sort_pairs(pairs: &mut [[f64; 2]]) {
    pairs.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
}

/// The largest position at which a box of size `size` does not extend beyond `face`, m.
fn largest_position_before(face: f64, size: f64) -> f64 {
    let mut position = face - size;
    if position + size > face {
        position = position.next_down();
    }
    position
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::pseudo_random::PseudoRandom;

    /// The same as [`nearest_free_corner`], by trying all candidates with all obstacles.
    fn nearest_by_trial(aabb: &Aabb, obstacles: &[Aabb], radius: f64) -> Option<[f64; 2]> {
        let [xs, ys] = Axis::BOTH.map(|axis| candidate_coordinates(aabb, obstacles, axis));
        let (mut best, mut least) = (None, radius * radius);
        for [dx, x] in &xs {
            for [dy, y] in &ys {
                let square = dx * dx + dy * dy;
                let candidate = aabb.at([*x, *y]);
                let is_nearer = square < least || square == least && best.is_none();
                if is_nearer && !obstacles.iter().any(|obstacle| candidate.overlaps(obstacle)) {
                    (best, least) = (Some([*x, *y]), square);
                }
            }
        }
        best
    }

    #[test]
    fn the_nearest_free_corner_is_that_of_all_candidates() {
        let mut random = PseudoRandom(1);
        for scene in 0..2000 {
            let unit = random.pick(&[0.0, 0.1, 0.5]);
            let scale = random.pick(&[1.0, 1e-3, 1e6]);
            let offset = random.pick(&[0.0, 0.0, 1e4]);
            // On a grid, or anywhere.
            let mut number = |from: f64, to: f64| {
                let number = random.between(from, to);
                if unit > 0.0 { larger((number / unit).round(), 1.0) * unit } else { number }
            };
            let room = number(1.0, 6.0);
            let mut boxes = (0..24).map(|_| Aabb {
                low: [0, 1].map(|_| scale * (offset + number(0.0, room))),
                size: [0, 1].map(|_| scale * number(0.05, 1.5)),
            });
            let aabb = boxes.next().unwrap();
            let obstacles: Vec<Aabb> = boxes.collect();
            for radius in [0.5, 2.0, 8.0].map(|radius| radius * scale) {
                let (found, expected) =
                    (nearest_free_corner(&aabb, &obstacles, radius), nearest_by_trial(&aabb, &obstacles, radius));
                assert_eq!(found, expected, "scene {scene}: {aabb:?} within {radius}");
            }
        }
    }

    #[test]
    fn a_box_placed_before_a_face_does_not_extend_beyond_it() {
        for (face, size) in [(10.0, 0.1), (0.3, 0.1), (1e6, 1e-3), (-0.7, 0.3), (5.0, 1e9)] {
            let position = largest_position_before(face, size);
            assert!(position + size <= face);
            assert!(position.next_up() + size >= face);
        }
    }
}
