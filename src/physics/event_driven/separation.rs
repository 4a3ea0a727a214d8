//! Bodies spawned overlapping others are put where there is room.

use super::EventDriven;
use super::fine_state::FineState;
use super::meeting::tolerance;
use super::mover::{AXES, Slot};

/// A box at rest in its place: lower and upper corner, m.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    low: [f64; 2],
    size: [f64; 2],
}

impl Block {
    fn at(self, low: [f64; 2]) -> Block {
        Block { low, ..self }
    }

    /// Whether the two share more than a border, beyond rounding.
    fn overlaps(&self, other: &Block) -> bool {
        AXES.into_iter().all(|axis| {
            let scale = self.low[axis].abs() + other.low[axis].abs() + (self.size[axis] + other.size[axis]);
            let ahead = other.low[axis] - (self.low[axis] + self.size[axis]);
            let behind = self.low[axis] - (other.low[axis] + other.size[axis]);
            ahead < -tolerance(scale) && behind < -tolerance(scale)
        })
    }
}

impl EventDriven {
    /// Puts apart what newcomers overlap: velocities stay, so no kinetic energy is gained.
    ///
    /// In creation order each newcomer of finite mass goes to the nearest place where it
    /// overlaps nothing that is there already; a newcomer of infinite mass stays and makes
    /// the older ones it overlaps do so. The place is exact: of all positions that touch
    /// faces of obstacles, the nearest free one.
    pub(super) fn separate(&mut self, fresh: &[Slot]) {
        let mut waiting = self.displaced(fresh);
        waiting.extend(fresh.iter().copied().filter(|slot| !self.movers[*slot as usize].infinite));
        for place in 0..waiting.len() {
            let slot = waiting[place];
            let block = self.block_of(slot);
            if let Some(low) = self.free_place(slot, block, &waiting[place + 1..]) {
                self.neighbours.remove(slot);
                for axis in AXES {
                    let state = self.fine(slot, axis);
                    self.redirect(slot, axis, FineState { position: low[axis].into(), ..state });
                }
                self.neighbours.insert(&self.clock, slot, &self.movers[slot as usize], self.now);
            }
        }
    }

    /// Older bodies of finite mass that newcomers of infinite mass overlap; they leave their contacts.
    fn displaced(&mut self, fresh: &[Slot]) -> Vec<Slot> {
        let mut displaced = Vec::new();
        for slot in fresh.iter().filter(|slot| self.movers[**slot as usize].infinite) {
            let block = self.block_of(*slot);
            self.neighbours.within(block.low, [0, 1].map(|axis| block.low[axis] + block.size[axis]), |other| {
                displaced.push(other);
            });
            displaced.retain(|other| {
                !self.movers[*other as usize].infinite
                    && fresh.binary_search(other).is_err()
                    && block.overlaps(&self.block_of(*other))
            });
        }
        displaced.sort_unstable();
        displaced.dedup();
        for slot in &displaced {
            for contact in self.contacts.of(*slot).to_vec() {
                self.part([*slot, contact.other]);
            }
        }
        displaced
    }

    fn block_of(&self, slot: Slot) -> Block {
        let mover = &self.movers[slot as usize];
        Block { low: mover.motion.at(&self.clock, self.now)[0], size: mover.size }
    }

    /// The nearest free place for a body that overlaps something; none if it overlaps nothing.
    ///
    /// Those `absent`, in creation order, are not there yet.
    fn free_place(&self, slot: Slot, block: Block, absent: &[Slot]) -> Option<[f64; 2]> {
        let mut reach = if block.size[0] > block.size[1] { block.size[0] } else { block.size[1] };
        let mut obstacles = self.obstacles(slot, &block, 0.0, absent);
        if !obstacles.iter().any(|obstacle| block.overlaps(obstacle)) {
            return None;
        }
        for _ in 0..64 {
            obstacles = self.obstacles(slot, &block, reach, absent);
            if let Some(place) = nearest_free(&block, &obstacles, reach) {
                return Some(place);
            }
            reach *= 2.0;
        }
        None
    }

    fn obstacles(&self, slot: Slot, block: &Block, reach: f64, absent: &[Slot]) -> Vec<Block> {
        let mut near = Vec::new();
        let low = block.low.map(|x| x - reach);
        let high = AXES.map(|axis| block.low[axis] + block.size[axis] + reach);
        self.neighbours.within(low, high, |other| near.push(other));
        near.sort_unstable();
        near.dedup();
        near.retain(|other| *other != slot && absent.binary_search(other).is_err());
        near.into_iter().map(|other| self.block_of(other)).collect()
    }
}

/// The free place nearest to where the block is, if one lies within reach.
///
/// Of places equally near the first in the order left, right, top, bottom.
fn nearest_free(block: &Block, obstacles: &[Block], reach: f64) -> Option<[f64; 2]> {
    let [xs, ys] = AXES.map(|axis| places(block, obstacles, axis));
    let mut best = None;
    let mut least = reach * reach;
    for (dx, x) in &xs {
        if dx * dx > least {
            break;
        }
        for (dy, y) in &ys {
            let square = dx * dx + dy * dy;
            if square > least || (square == least && best.is_some()) {
                break;
            }
            let there = block.at([*x, *y]);
            if !obstacles.iter().any(|obstacle| there.overlaps(obstacle)) {
                least = square;
                best = Some([*x, *y]);
                break;
            }
        }
    }
    best
}

/// The coordinates along an axis at which the block stays or touches an obstacle, nearest first.
fn places(block: &Block, obstacles: &[Block], axis: usize) -> Vec<(f64, f64)> {
    let here = block.low[axis];
    let mut places = vec![(0.0, here)];
    for obstacle in obstacles {
        let before = super::collide::just_before(obstacle.low[axis], block.size[axis]);
        for place in [before, obstacle.low[axis] + obstacle.size[axis]] {
            places.push(((place - here).abs(), place));
        }
    }
    places.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    places.dedup();
    places
}
