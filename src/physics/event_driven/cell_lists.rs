//! The broad phase: hierarchical cell lists, one grid of square cells per size class.
//!
//! The cell lists only select candidates for predictions. The grid of a box and the times of its cell
//! crossings influence no result.

use super::axis_trajectory::closing_time;
use super::body_state::{BodyState, NONE, Slot};
use super::instant::{Clock, Instant};
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::Sample;
use super::spatial_hash::SpatialHash;
use super::swept_aabb::SweptAabb;
use crate::physics::{Axis, larger, smaller};

/// Maximum size of a box as a fraction of the side of its cell. With [`BORDER_SLACK`] on either side it
/// never extends beyond the adjacent cells.
const MAX_FILL: f64 = 0.87;

/// A box leaves its cell when its centre is outside it by this fraction of the side. So a slow box can be
/// moved to the next cell before the step in which it would leave, and rounding cannot make it cross the
/// same border repeatedly.
const BORDER_SLACK: f64 = 1.0 / 16.0;

/// Ratio of the cell sides of consecutive grids: a larger one gives fewer grids, a smaller one cells that fit their
/// boxes better.
const SIDE_RATIO: f64 = 4.0;

/// Approximate maximum number of cells that a box crosses in a step; a faster one is put in a coarser grid.
const MAX_CELLS_PER_STEP: f64 = 4.0;

/// Maximum cell index: beyond it, adjacent cell borders are no longer distinct doubles.
const MAX_CELL_INDEX: f64 = (1u64 << 40) as f64;

/// The number of buckets of a new grid, which gets more as bodies enter it.
const MIN_BUCKETS: usize = 64;

/// Up to this number of bodies, all are candidates of each other.
const ALL_PAIRS_LIMIT: usize = 12;

/// The grids and the static bodies.
///
/// Invariants: a static body is listed in all grids, any other body in one grid, in the cell that contains its centre
/// up to [`BORDER_SLACK`], whose side is greater than the body. So two bodies that touch are neighbours.
#[derive(Clone, Debug)]
pub struct CellLists {
    /// Cell side that suits most boxes, m. The cell side of each grid is this times a power of [`SIDE_RATIO`].
    base_side: f64,
    grids: Vec<SpatialHash>,
    /// By slot.
    nodes: Vec<CellNode>,
    /// The cell of each body in its grid, by slot.
    cells: Vec<[i64; 2]>,
    /// The static boxes with their lower and upper corners, m.
    static_bodies: Vec<(Slot, [[f64; 2]; 2])>,
    /// All bodies, while they are [few](Self::uses_all_pairs).
    few: Vec<Slot>,
}

/// A body in the doubly linked list of its bucket: all that a scan of the cells reads, half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct CellNode {
    swept_aabb: SweptAabb,
    /// Index of the grid, or [`NONE`] if the body is in no grid.
    grid: u32,
    /// Index among the members of the grid.
    member: u32,
    previous: Slot,
    next: Slot,
}

const UNLINKED_NODE: CellNode =
    CellNode { swept_aabb: SweptAabb::EVERYWHERE, grid: NONE, member: NONE, previous: NONE, next: NONE };

impl CellLists {
    /// Creates empty cell lists for boxes whose typical longer side is `size`, m.
    pub fn new(size: f64) -> CellLists {
        CellLists {
            base_side: smaller(size / MAX_FILL, f64::MAX),
            grids: Vec::new(),
            nodes: Vec::new(),
            cells: Vec::new(),
            static_bodies: Vec::new(),
            few: Vec::new(),
        }
    }

    /// Inserts a body as it is at `now`.
    pub fn insert(&mut self, clock: &Clock, slot: Slot, body: &BodyState, now: Instant) {
        if self.nodes.len() <= slot as usize {
            self.nodes.resize(slot as usize + 1, UNLINKED_NODE);
            self.cells.resize(slot as usize + 1, [0; 2]);
        }
        if self.uses_all_pairs() {
            self.few.push(slot);
        }
        if body.is_static() {
            let low = body.trajectory.position;
            let corners = [low, [low[0] + body.size[0], low[1] + body.size[1]]];
            self.static_bodies.push((slot, corners));
            for grid in &mut self.grids {
                grid.insert_static(slot, corners);
            }
        } else {
            let [position, _] = body.trajectory.at(now);
            let centre = Axis::BOTH.map(|axis| position[axis] + body.size[axis] / 2.0);
            let grid = self.grid_for(clock, body, now, centre);
            self.insert_into_grid(slot, grid, centre);
        }
    }

    /// Removes a body.
    pub fn remove(&mut self, slot: Slot) {
        self.few.retain(|other| *other != slot);
        let before = self.static_bodies.len();
        self.static_bodies.retain(|(other, _)| *other != slot);
        if self.static_bodies.len() < before {
            for grid in 0..self.grids.len() {
                self.rebuild(grid, self.grids[grid].buckets.len());
            }
        } else {
            self.remove_from_grid(slot);
        }
    }

    fn insert_into_grid(&mut self, slot: Slot, grid: usize, centre: [f64; 2]) {
        let members = self.grids[grid].members.len();
        self.grids[grid].members.push(slot);
        let cell = self.grids[grid].cell(centre);
        let swept_aabb = self.nodes[slot as usize].swept_aabb;
        self.nodes[slot as usize] = CellNode { swept_aabb, grid: grid as u32, member: members as u32, ..UNLINKED_NODE };
        if (members + 1) * 2 > self.grids[grid].buckets.len() {
            self.cells[slot as usize] = cell;
            self.rebuild(grid, (members + 1).next_power_of_two() * 4);
        } else {
            self.link(slot, cell);
        }
    }

    fn remove_from_grid(&mut self, slot: Slot) {
        self.unlink(slot);
        let node = self.nodes[slot as usize];
        let members = &mut self.grids[node.grid as usize].members;
        members.swap_remove(node.member as usize);
        if let Some(moved) = members.get(node.member as usize) {
            self.nodes[*moved as usize].member = node.member;
        }
        self.nodes[slot as usize] = CellNode { swept_aabb: node.swept_aabb, ..UNLINKED_NODE };
    }

    fn link(&mut self, slot: Slot, cell: [i64; 2]) {
        let grid = &mut self.grids[self.nodes[slot as usize].grid as usize];
        let bucket = grid.bucket(cell);
        let next = grid.buckets[bucket];
        grid.buckets[bucket] = slot;
        if next != NONE {
            self.nodes[next as usize].previous = slot;
        }
        self.cells[slot as usize] = cell;
        let node = &mut self.nodes[slot as usize];
        node.previous = NONE;
        node.next = next;
    }

    fn unlink(&mut self, slot: Slot) {
        let node = self.nodes[slot as usize];
        if node.previous == NONE {
            let grid = &mut self.grids[node.grid as usize];
            let bucket = grid.bucket(self.cells[slot as usize]);
            grid.buckets[bucket] = node.next;
        } else {
            self.nodes[node.previous as usize].next = node.next;
        }
        if node.next != NONE {
            self.nodes[node.next as usize].previous = node.previous;
        }
    }

    /// Sets the number of buckets of a grid and lists all its bodies again.
    fn rebuild(&mut self, grid: usize, buckets: usize) {
        self.grids[grid].resize(buckets);
        for member in 0..self.grids[grid].members.len() {
            let slot = self.grids[grid].members[member];
            self.link(slot, self.cells[slot as usize]);
        }
        for (slot, corners) in &self.static_bodies {
            self.grids[grid].insert_static(*slot, *corners);
        }
    }

    /// Returns the grid for a body, creating it if necessary. Its cells are larger than the body, than
    /// its displacement in a fraction of a step, and than the resolution of its coordinates.
    fn grid_for(&mut self, clock: &Clock, body: &BodyState, now: Instant, centre: [f64; 2]) -> usize {
        let mut min_side = 0.0;
        let [_, velocity] = body.trajectory.at(now);
        for axis in Axis::BOTH {
            let gain = body.trajectory.acceleration[axis].abs() * clock.period;
            let displacement = (velocity[axis].abs() + gain) * clock.period / MAX_CELLS_PER_STEP;
            let size = body.size[axis] / MAX_FILL * (1.0 - f64::EPSILON);
            for limit in [size, displacement, centre[axis].abs() / MAX_CELL_INDEX] {
                if limit > min_side {
                    min_side = limit;
                }
            }
        }
        let mut side = self.base_side;
        while side < min_side && side < f64::MAX / SIDE_RATIO {
            side *= SIDE_RATIO;
        }
        while side / SIDE_RATIO >= min_side && side > f64::MIN_POSITIVE * SIDE_RATIO {
            side /= SIDE_RATIO;
        }
        match self.grids.iter().position(|grid| grid.side == side) {
            Some(grid) => grid,
            None => {
                self.grids.push(SpatialHash::new(side, MIN_BUCKETS));
                self.rebuild(self.grids.len() - 1, MIN_BUCKETS);
                self.grids.len() - 1
            }
        }
    }

    /// Returns true if the grid, which was suitable before, certainly still is; cheaper than `grid_for`. The size of a
    /// body never changes, so its grid is never too fine for it.
    ///
    /// `distance` (m) is the sum of the magnitudes of both coordinates of the position, `speed` (m/s) that of the
    /// velocity.
    fn is_suitable(&self, clock: &Clock, grid: usize, body: &BodyState, distance: f64, speed: f64) -> bool {
        let side = self.grids[grid].side;
        let size = body.size[0] + body.size[1];
        distance < side * MAX_CELL_INDEX && speed * clock.period < side && size * 2.0 > side
    }

    /// The rectangle in which a body stays until its next prediction.
    #[inline]
    pub fn swept_aabb(&self, slot: Slot) -> &SweptAabb {
        &self.nodes[slot as usize].swept_aabb
    }

    /// Sets the rectangle in which a body stays until its next prediction.
    #[inline]
    pub fn set_swept_aabb(&mut self, slot: Slot, swept_aabb: SweptAabb) {
        self.nodes[slot as usize].swept_aabb = swept_aabb;
    }

    /// The seconds from the sample until the body leaves its cell; infinity if it never does.
    #[inline]
    pub fn cell_exit_time(&self, slot: Slot, sample: &Sample) -> f64 {
        let (node, cell) = (&self.nodes[slot as usize], self.cells[slot as usize]);
        let side = self.grids[node.grid as usize].side;
        let acceleration = sample.body.trajectory.acceleration;
        let centre = Axis::BOTH.map(|axis| sample.position[axis] + sample.body.size[axis] / 2.0);
        let low = cell.map(|index| index as f64 * side);
        let behind = Axis::BOTH.map(|axis| centre[axis] - (low[axis] - side * BORDER_SLACK));
        let ahead = Axis::BOTH.map(|axis| (low[axis] + side * (1.0 + BORDER_SLACK)) - centre[axis]);
        let times = if acceleration == [0.0; 2] {
            let distance = Axis::BOTH.map(|axis| if sample.velocity[axis] > 0.0 { ahead[axis] } else { behind[axis] });
            Axis::BOTH.map(|axis| distance[axis] / sample.velocity[axis].abs())
        } else {
            Axis::BOTH.map(|axis| {
                let (velocity, acceleration) = (sample.velocity[axis], acceleration[axis]);
                let [behind, ahead] = [(behind, -1.0), (ahead, 1.0)]
                    .map(|(distance, sign)| closing_time(distance[axis], sign * velocity, sign * acceleration));
                smaller(ahead, behind)
            })
        };
        let first = smaller(times[0], times[1]);
        larger(first, 0.0)
    }

    /// Moves a body to the cell that contains it halfway through the rest of the step, or, if it is fast,
    /// at the time of the sample.
    ///
    /// `remaining`: the rest of the step, s.
    pub fn move_to_next_cell(&mut self, clock: &Clock, slot: Slot, sample: &Sample, remaining: f64) {
        let node = self.nodes[slot as usize];
        let body = sample.body;
        let mut grid = node.grid as usize;
        let mut centre = Axis::BOTH.map(|axis| sample.position[axis] + body.size[axis] / 2.0);
        let speed = sample.velocity[0].abs() + sample.velocity[1].abs();
        if !self.is_suitable(clock, grid, body, centre[0].abs() + centre[1].abs(), speed) {
            grid = self.grid_for(clock, body, sample.at, centre);
        }
        let acceleration = body.trajectory.acceleration[0].abs() + body.trajectory.acceleration[1].abs();
        if (speed + acceleration * remaining) * remaining <= BORDER_SLACK * self.grids[grid].side {
            centre = Axis::BOTH.map(|axis| centre[axis] + sample.velocity[axis] * (remaining / 2.0));
        }
        if grid == node.grid as usize {
            self.unlink(slot);
            self.link(slot, self.grids[grid].cell(centre));
        } else {
            self.remove_from_grid(slot);
            self.insert_into_grid(slot, grid, centre);
        }
    }

    /// Returns true if all bodies are candidates of each other because there are few.
    pub fn uses_all_pairs(&self) -> bool {
        self.nodes.len() <= ALL_PAIRS_LIMIT
    }

    /// Fills `buffer` with the bodies, possibly with duplicates, that may touch this one before the next
    /// prediction of either. `swept` is the swept AABB of this one.
    pub fn find_neighbours(&self, slot: Slot, body: &BodyState, swept: &SweptAabb, buffer: &mut NeighbourBuffer) {
        buffer.clear();
        let is_near = |other: Slot| (other != slot) & !swept.is_disjoint_from(self.swept_aabb(other));
        let mut visit = |other: Slot| buffer.push_if(other, is_near(other));
        if self.uses_all_pairs() {
            return self.few.iter().for_each(|other| visit(*other));
        }
        let (node, cell) = (&self.nodes[slot as usize], self.cells[slot as usize]);
        let grid = &self.grids[node.grid as usize];
        self.visit_statics(grid, cell, &mut visit);
        self.visit_other_grids(node.grid as usize, cell, body, &mut visit);
        self.scan_cells(slot, swept, buffer);
    }

    /// All bodies, if they are few enough to be candidates of each other.
    #[inline]
    pub fn few(&self) -> &[Slot] {
        debug_assert!(self.uses_all_pairs());
        &self.few
    }

    /// Fills `buffer` with all bodies but one, if they are few.
    pub fn find_others(&self, slot: Slot, buffer: &mut NeighbourBuffer) {
        buffer.clear();
        self.few().iter().for_each(|other| buffer.push_if(*other, *other != slot));
    }

    /// Returns the bodies of [`CellLists::find_neighbours`] sorted by slot, without duplicates.
    #[cfg(test)]
    pub fn neighbours_of(&self, slot: Slot, body: &BodyState, swept: &SweptAabb) -> Vec<Slot> {
        let mut buffer = NeighbourBuffer::default();
        self.find_neighbours(slot, body, swept, &mut buffer);
        let mut all = buffer.slots().to_vec();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Finds the neighbours in the cell of a body and in the eight adjacent ones.
    ///
    /// The number of bodies in a cell is unpredictable, so the nine lists are traversed in parallel to
    /// avoid a branch per cell: `pending` is a ring buffer with at most one unvisited body of each list.
    #[inline]
    fn scan_cells(&self, slot: Slot, swept: &SweptAabb, buffer: &mut NeighbourBuffer) {
        let node = &self.nodes[slot as usize];
        let grid = &self.grids[node.grid as usize];
        let (middle, mask) = (grid.bucket(self.cells[slot as usize]) as u64, grid.buckets.len() as u64 - 1);
        let (mut pending, mut found, mut visited) = ([NONE; 16], 0, 0);
        for row in [middle.wrapping_sub(grid.row_stride), middle, middle.wrapping_add(grid.row_stride)] {
            for bucket in [row.wrapping_sub(1), row, row.wrapping_add(1)] {
                let first = grid.buckets[(bucket & mask) as usize];
                pending[found % 16] = first;
                found += usize::from(first != NONE);
            }
        }
        while visited < found {
            let other = pending[visited % 16];
            visited += 1;
            let CellNode { next, swept_aabb, .. } = &self.nodes[other as usize];
            buffer.push_if(other, (other != slot) & !swept.is_disjoint_from(swept_aabb));
            let next = *next;
            pending[found % 16] = next;
            found += usize::from(next != NONE);
        }
    }

    fn visit_list(&self, first: Slot, visit: &mut impl FnMut(Slot)) {
        let mut slot = first;
        while slot != NONE {
            visit(slot);
            slot = self.nodes[slot as usize].next;
        }
    }

    fn visit_statics(&self, grid: &SpatialHash, cell: [i64; 2], visit: &mut impl FnMut(Slot)) {
        let list = grid.static_list_indices[grid.bucket(cell)];
        if list != NONE {
            grid.static_lists[list as usize].iter().for_each(|slot| visit(*slot));
        }
        grid.oversized_statics.iter().for_each(|slot| visit(*slot));
    }

    /// Visits the bodies of other grids that may touch one in this cell of its own grid.
    fn visit_other_grids(&self, own: usize, cell: [i64; 2], body: &BodyState, visit: &mut impl FnMut(Slot)) {
        if self.grids.len() == 1 {
            return;
        }
        let side = self.grids[own].side;
        let low = cell.map(|index| index as f64 * side);
        let margin = Axis::BOTH.map(|axis| body.size[axis] / 2.0 + 2.0 * BORDER_SLACK * side);
        for (index, grid) in self.grids.iter().enumerate() {
            if index == own || grid.members.is_empty() {
                continue;
            }
            let from = grid.cell(Axis::BOTH.map(|axis| low[axis] - margin[axis] - grid.side / 2.0));
            let to = grid.cell(Axis::BOTH.map(|axis| low[axis] + side + margin[axis] + grid.side / 2.0));
            self.visit_cells(index, from, to, visit);
        }
    }

    /// Visits the bodies in a rectangle of cells, or all bodies of the grid if these are fewer than the cells.
    fn visit_cells(&self, grid: usize, from: [i64; 2], to: [i64; 2], visit: &mut impl FnMut(Slot)) {
        let cells = (to[0] as f64 - from[0] as f64 + 1.0) * (to[1] as f64 - from[1] as f64 + 1.0);
        if cells > self.grids[grid].members.len() as f64 {
            self.grids[grid].members.iter().for_each(|slot| visit(*slot));
            return;
        }
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                let grid = &self.grids[grid];
                self.visit_list(grid.buckets[grid.bucket([x, y])], visit);
            }
        }
    }

    /// Visits each body, possibly more than once, that may touch a region now, given by its corners in m.
    pub fn visit_region(&self, low: [f64; 2], high: [f64; 2], mut visit: impl FnMut(Slot)) {
        for (index, grid) in self.grids.iter().enumerate() {
            let from = grid.cell(low.map(|x| x - grid.side));
            let to = grid.cell(high.map(|x| x + grid.side));
            self.visit_cells(index, from, to, &mut visit);
        }
        self.static_bodies.iter().for_each(|(slot, _)| visit(*slot));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::axis_trajectory::AxisTrajectory;
    use crate::physics::event_driven::body_state::Load;
    use crate::physics::event_driven::pseudo_random::PseudoRandom;
    use crate::physics::event_driven::trajectory::Trajectory;
    use crate::physics::larger;

    const NOW: Instant = Instant::START;

    impl PseudoRandom {
        /// A box of 1 cm to 10 m in a room of 40 m; one in four is static.
        fn body(&mut self) -> BodyState {
            let side = [0.01, 0.3, 1.0, 1.0, 10.0][(self.next() * 5.0) as usize];
            let infinite = self.next() < 0.25;
            let axes = Axis::BOTH.map(|_| {
                let velocity = if infinite { 0.0 } else { self.next() - 0.5 };
                AxisTrajectory { position: self.next() * 40.0 - 20.0, velocity, acceleration: 0.0, since: NOW }
            });
            BodyState {
                trajectory: Trajectory::new(axes),
                size: [side, side * (0.5 + 0.5 * self.next())],
                since: NOW,
                generation: 0,
                world_index: 0,
                infinite,
                load: [Load::GravityOnly; 2],
            }
        }
    }

    /// The rectangle that a body covers now.
    fn covered(body: &BodyState) -> SweptAabb {
        SweptAabb::new(&Sample::new(body, NOW), 0.0)
    }

    fn lists(bodies: &[BodyState]) -> CellLists {
        let mut lists = CellLists::new(1.0);
        for (slot, body) in (0..).zip(bodies) {
            lists.insert(&Clock::new(60.0), slot, body, NOW);
            lists.set_swept_aabb(slot, covered(body));
        }
        lists
    }

    /// Asserts that each body that moves finds exactly the others of `present` that it may touch.
    fn assert_neighbours(lists: &CellLists, bodies: &[BodyState], present: &[Slot]) {
        for slot in present.iter().copied().filter(|slot| !bodies[*slot as usize].is_static()) {
            let body = &bodies[slot as usize];
            let swept = covered(body);
            let touches = |other: &Slot| *other != slot && !swept.is_disjoint_from(&covered(&bodies[*other as usize]));
            let expected: Vec<Slot> = present.iter().copied().filter(touches).collect();
            assert_eq!(lists.neighbours_of(slot, body, &swept), expected);
        }
    }

    #[test]
    fn bodies_that_touch_are_neighbours_whatever_their_sizes_and_number() {
        for count in [ALL_PAIRS_LIMIT, 300] {
            let mut random = PseudoRandom(count as u32);
            let bodies: Vec<BodyState> = (0..count).map(|_| random.body()).collect();
            let all: Vec<Slot> = (0..count as Slot).collect();
            assert_neighbours(&lists(&bodies), &bodies, &all);
        }
    }

    #[test]
    fn bodies_that_were_moved_or_removed_are_found_where_they_are() {
        let mut random = PseudoRandom(7);
        let mut bodies: Vec<BodyState> = (0..200).map(|_| random.body()).collect();
        let mut lists = lists(&bodies);
        let clock = Clock::new(60.0);
        let mut present: Vec<Slot> = (0..200).collect();
        for round in 0..10 {
            for slot in &present {
                let body = &mut bodies[*slot as usize];
                if body.is_static() {
                    continue;
                }
                for axis in Axis::BOTH {
                    let along = body.trajectory.along(axis);
                    let position = along.position + 4.0 * random.next() - 2.0;
                    body.trajectory.set(axis, AxisTrajectory { position, ..along });
                }
                lists.move_to_next_cell(&clock, *slot, &Sample::new(body, NOW), 0.0);
                lists.set_swept_aabb(*slot, covered(body));
            }
            for _ in 0..5 {
                let removed = present.swap_remove((random.next() * present.len() as f64) as usize);
                lists.remove(removed);
            }
            present.sort_unstable();
            assert_neighbours(&lists, &bodies, &present);
            assert_eq!(present.len(), 195 - 5 * round);
        }
    }

    #[test]
    fn a_body_leaves_its_cell_after_the_exit_time_and_not_before() {
        let mut random = PseudoRandom(3);
        let bodies: Vec<BodyState> = (0..100).map(|_| random.body()).collect();
        let lists = lists(&bodies);
        for (slot, body) in (0..).zip(&bodies).filter(|(_, body)| !body.is_static()) {
            let seconds = lists.cell_exit_time(slot, &Sample::new(body, NOW));
            let side = lists.grids[lists.nodes[slot as usize].grid as usize].side;
            let depth = |seconds: f64| {
                let [position, _] = body.trajectory.at(NOW.after(seconds));
                let outside = Axis::BOTH.map(|axis| {
                    let low = lists.cells[slot as usize][axis] as f64 * side;
                    let centre = position[axis] + body.size[axis] / 2.0;
                    larger(low - centre, centre - (low + side)) / side
                });
                larger(outside[0], outside[1])
            };
            assert!((depth(seconds) - BORDER_SLACK).abs() < 1e-9 && depth(0.99 * seconds) < BORDER_SLACK);
        }
    }
}
