//! Which boxes may be near which: grids of square cells, one for each class of sizes.
//!
//! Nothing here decides what happens, only who is asked: which grid a box sits in and when
//! it changes cells has no influence on any result.

use super::grid::{Grid, NONE};
use super::instant::{Clock, Instant};
use super::meeting::State;
use super::motion::closing_time;
use super::mover::{AXES, Mover, Slot};
use super::near::Near;
use super::reach::Reach;

/// A box is at most this fraction of its cell's side, so that with [`SLACK`] on either side
/// it never reaches beyond the neighbouring cells.
const FILL: f64 = 0.87;

/// A box has left its cell when its centre is this fraction of the side outside it. So a box
/// that is not too fast may be moved on before the step in which it would leave; and no
/// rounding makes it cross the same border for ever.
const SLACK: f64 = 1.0 / 16.0;

/// The sides of the cells of consecutive grids stand in this ratio.
const RATIO: f64 = 4.0;

/// A box crosses at most about this many cells in a step; a faster one sits in a coarser grid.
const CELLS_PER_STEP: f64 = 4.0;

/// No cell is so many cells away from the origin that its borders could not be told apart.
const FURTHEST_CELL: f64 = (1u64 << 40) as f64;

/// So few bodies are all asked.
const FEW: usize = 12;

/// The grids.
#[derive(Clone, Debug)]
pub struct Neighbours {
    /// The side of the cells that suit most boxes, m.
    base: f64,
    grids: Vec<Grid>,
    /// Where each body sits, by slot.
    seats: Vec<Seat>,
    /// In which cell, by slot.
    cells: Vec<[i64; 2]>,
    /// The boxes that never move: lower and upper corner.
    anchored: Vec<(Slot, [[f64; 2]; 2])>,
}

/// All that is read of a body on the way past it: half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Seat {
    reach: Reach,
    grid: u32,
    member: u32,
    previous: Slot,
    next: Slot,
}

const NOWHERE: Seat = Seat { reach: Reach::ANYWHERE, grid: NONE, member: NONE, previous: NONE, next: NONE };

impl Neighbours {
    /// Grids for boxes whose usual longer side is `size`, m.
    pub fn new(size: f64) -> Neighbours {
        Neighbours { base: size / FILL, grids: Vec::new(), seats: Vec::new(), cells: Vec::new(), anchored: Vec::new() }
    }

    /// Enters a body.
    pub fn insert(&mut self, clock: &Clock, slot: Slot, mover: &Mover, now: Instant) {
        if self.seats.len() <= slot as usize {
            self.seats.resize(slot as usize + 1, NOWHERE);
            self.cells.resize(slot as usize + 1, [0; 2]);
        }
        if mover.is_anchored() {
            let low = mover.motion.position;
            let corners = [low, [low[0] + mover.size[0], low[1] + mover.size[1]]];
            self.anchored.push((slot, corners));
            for grid in &mut self.grids {
                grid.anchor(slot, corners);
            }
        } else {
            let [position, _] = mover.motion.at(clock, now);
            let centre = AXES.map(|axis| position[axis] + mover.size[axis] / 2.0);
            let grid = self.grid_for(clock, mover, now, centre);
            self.sit(slot, grid, centre);
        }
    }

    /// Takes a body out.
    pub fn remove(&mut self, slot: Slot) {
        let before = self.anchored.len();
        self.anchored.retain(|(anchored, _)| *anchored != slot);
        if self.anchored.len() < before {
            for grid in 0..self.grids.len() {
                self.rebuild(grid, self.grids[grid].buckets.len());
            }
        } else {
            self.rise(slot);
        }
    }

    fn sit(&mut self, slot: Slot, grid: usize, centre: [f64; 2]) {
        let members = self.grids[grid].members.len();
        self.grids[grid].members.push(slot);
        let cell = self.grids[grid].cell(centre);
        let reach = self.seats[slot as usize].reach;
        self.seats[slot as usize] = Seat { reach, grid: grid as u32, member: members as u32, ..NOWHERE };
        if (members + 1) * 2 > self.grids[grid].buckets.len() {
            self.cells[slot as usize] = cell;
            self.rebuild(grid, (members + 1).next_power_of_two() * 4);
        } else {
            self.link(slot, cell);
        }
    }

    fn rise(&mut self, slot: Slot) {
        self.unlink(slot);
        let seat = self.seats[slot as usize];
        let members = &mut self.grids[seat.grid as usize].members;
        members.swap_remove(seat.member as usize);
        if let Some(moved) = members.get(seat.member as usize) {
            self.seats[*moved as usize].member = seat.member;
        }
        self.seats[slot as usize] = Seat { reach: seat.reach, ..NOWHERE };
    }

    fn link(&mut self, slot: Slot, cell: [i64; 2]) {
        let grid = &mut self.grids[self.seats[slot as usize].grid as usize];
        let bucket = grid.bucket(cell);
        let next = grid.buckets[bucket];
        grid.buckets[bucket] = slot;
        if next != NONE {
            self.seats[next as usize].previous = slot;
        }
        self.cells[slot as usize] = cell;
        let seat = &mut self.seats[slot as usize];
        seat.previous = NONE;
        seat.next = next;
    }

    fn unlink(&mut self, slot: Slot) {
        let seat = self.seats[slot as usize];
        if seat.previous == NONE {
            let grid = &mut self.grids[seat.grid as usize];
            let bucket = grid.bucket(self.cells[slot as usize]);
            grid.buckets[bucket] = seat.next;
        } else {
            self.seats[seat.previous as usize].next = seat.next;
        }
        if seat.next != NONE {
            self.seats[seat.next as usize].previous = seat.previous;
        }
    }

    /// Gives a grid so many buckets and enters everything again.
    fn rebuild(&mut self, grid: usize, buckets: usize) {
        self.grids[grid].resize(buckets);
        for member in 0..self.grids[grid].members.len() {
            let slot = self.grids[grid].members[member];
            self.link(slot, self.cells[slot as usize]);
        }
        for (slot, corners) in &self.anchored {
            self.grids[grid].anchor(*slot, *corners);
        }
    }

    /// The grid a body belongs in: cells larger than it, than what it covers in a fraction of
    /// a step, and than what its coordinates can resolve.
    fn grid_for(&mut self, clock: &Clock, mover: &Mover, now: Instant, centre: [f64; 2]) -> usize {
        let mut needed = 0.0;
        let [_, velocity] = mover.motion.at(clock, now);
        for axis in AXES {
            let fall = mover.motion.acceleration[axis].abs() * clock.period;
            let covered = (velocity[axis].abs() + fall) * clock.period / CELLS_PER_STEP;
            for need in [mover.size[axis] / FILL * (1.0 - f64::EPSILON), covered, centre[axis].abs() / FURTHEST_CELL] {
                if need > needed {
                    needed = need;
                }
            }
        }
        let mut side = self.base;
        while side < needed && side < f64::MAX / RATIO {
            side *= RATIO;
        }
        while side / RATIO >= needed && side > f64::MIN_POSITIVE * RATIO {
            side /= RATIO;
        }
        match self.grids.iter().position(|grid| grid.side == side) {
            Some(grid) => grid,
            None => {
                self.grids.push(Grid::new(side, 64));
                self.rebuild(self.grids.len() - 1, 64);
                self.grids.len() - 1
            }
        }
    }

    /// Whether a body is surely in the right grid: a quick look that spares a long one.
    fn suits(&self, clock: &Clock, grid: usize, mover: &Mover, distance: f64, speed: f64) -> bool {
        let side = self.grids[grid].side;
        let larger = mover.size[0] + mover.size[1];
        distance < side * FURTHEST_CELL && speed * clock.period < side && larger * 2.0 > side
    }

    /// Where a body can be until it looks ahead again.
    #[inline]
    pub fn reach(&self, slot: Slot) -> &Reach {
        &self.seats[slot as usize].reach
    }

    /// Says where a body can be until it looks ahead again.
    #[inline]
    pub fn extend(&mut self, slot: Slot, reach: Reach) {
        self.seats[slot as usize].reach = reach;
    }

    /// When a body leaves its cell, in seconds from now; infinite if never.
    #[inline]
    pub fn leaving(&self, slot: Slot, state: &State) -> f64 {
        let (seat, cell) = (&self.seats[slot as usize], self.cells[slot as usize]);
        let side = self.grids[seat.grid as usize].side;
        let acceleration = state.mover.motion.acceleration;
        let centre = AXES.map(|axis| state.position[axis] + state.mover.size[axis] / 2.0);
        let low = cell.map(|index| index as f64 * side);
        let behind = AXES.map(|axis| centre[axis] - (low[axis] - side * SLACK));
        let ahead = AXES.map(|axis| (low[axis] + side * (1.0 + SLACK)) - centre[axis]);
        let leaving = if acceleration == [0.0; 2] {
            let way = AXES.map(|axis| if state.velocity[axis] > 0.0 { ahead[axis] } else { behind[axis] });
            AXES.map(|axis| way[axis] / state.velocity[axis].abs())
        } else {
            AXES.map(|axis| {
                let (speed, acceleration) = (state.velocity[axis], acceleration[axis]);
                let [behind, ahead] = [(behind, -1.0), (ahead, 1.0)]
                    .map(|(way, side)| closing_time(way[axis], side * speed, side * acceleration));
                if ahead < behind { ahead } else { behind }
            })
        };
        let first = if leaving[0] < leaving[1] { leaving[0] } else { leaving[1] };
        if first > 0.0 { first } else { 0.0 }
    }

    /// Moves a body to the cell where it is halfway through the rest of the step, or to the
    /// one where it is now if it is fast.
    pub fn cross(&mut self, clock: &Clock, slot: Slot, state: &State) {
        let seat = self.seats[slot as usize];
        let mover = state.mover;
        let mut grid = seat.grid as usize;
        let mut centre = AXES.map(|axis| state.position[axis] + mover.size[axis] / 2.0);
        let speed = state.velocity[0].abs() + state.velocity[1].abs();
        if !self.suits(clock, grid, mover, centre[0].abs() + centre[1].abs(), speed) {
            grid = self.grid_for(clock, mover, state.at, centre);
        }
        let left = clock.period - state.at.offset;
        let falls = mover.motion.acceleration[0].abs() + mover.motion.acceleration[1].abs();
        if (speed + falls * left) * left <= SLACK * self.grids[grid].side {
            centre = AXES.map(|axis| centre[axis] + state.velocity[axis] * (left / 2.0));
        }
        if grid == seat.grid as usize {
            self.unlink(slot);
            self.link(slot, self.grids[grid].cell(centre));
        } else {
            self.rise(slot);
            self.sit(slot, grid, centre);
        }
    }

    /// Whether there are so few bodies that all are near each other, whatever their cells.
    pub fn are_few(&self) -> bool {
        self.seats.len() <= FEW
    }

    /// Finds the bodies, some perhaps twice, that may touch this one, whose reach is given,
    /// before either of the two looks ahead again.
    pub fn near(&self, slot: Slot, mover: &Mover, reach: &Reach, near: &mut Near) {
        near.clear();
        let mut show = |other: Slot| near.enter(other, (other != slot) & !reach.is_apart_from(self.reach(other)));
        if self.are_few() {
            self.grids.iter().flat_map(|grid| &grid.members).for_each(|slot| show(*slot));
            self.anchored.iter().for_each(|(slot, _)| show(*slot));
            return;
        }
        let (seat, cell) = (&self.seats[slot as usize], self.cells[slot as usize]);
        let grid = &self.grids[seat.grid as usize];
        self.show_anchors(grid, cell, &mut show);
        self.show_other_grids(seat.grid as usize, cell, mover, &mut show);
        self.around(slot, reach, near);
    }

    /// All bodies that may touch this one, whose reach is given, by slot.
    pub fn all_near(&self, slot: Slot, mover: &Mover, reach: &Reach) -> Vec<Slot> {
        let mut near = Near::default();
        self.near(slot, mover, reach, &mut near);
        let mut all = near.slots().to_vec();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Finds who sits in the cell of a body or next to it.
    ///
    /// How many sit in a cell cannot be guessed, so the nine lists are walked along side by
    /// side: of each one body at most is still to be shown.
    #[inline]
    fn around(&self, slot: Slot, reach: &Reach, near: &mut Near) {
        let seat = &self.seats[slot as usize];
        let grid = &self.grids[seat.grid as usize];
        let (middle, mask) = (grid.bucket(self.cells[slot as usize]) as u64, grid.buckets.len() as u64 - 1);
        let (mut open, mut found, mut shown) = ([NONE; 16], 0, 0);
        for row in [middle.wrapping_sub(grid.row), middle, middle.wrapping_add(grid.row)] {
            for bucket in [row.wrapping_sub(1), row, row.wrapping_add(1)] {
                let first = grid.buckets[(bucket & mask) as usize];
                open[found % 16] = first;
                found += usize::from(first != NONE);
            }
        }
        while shown < found {
            let other = open[shown % 16];
            shown += 1;
            let Seat { next, reach: others, .. } = &self.seats[other as usize];
            near.enter(other, (other != slot) & !reach.is_apart_from(others));
            let next = *next;
            open[found % 16] = next;
            found += usize::from(next != NONE);
        }
    }

    fn show_list(&self, first: Slot, show: &mut impl FnMut(Slot)) {
        let mut slot = first;
        while slot != NONE {
            show(slot);
            slot = self.seats[slot as usize].next;
        }
    }

    fn show_anchors(&self, grid: &Grid, cell: [i64; 2], show: &mut impl FnMut(Slot)) {
        let anchors = grid.anchors_of[grid.bucket(cell)];
        if anchors != NONE {
            grid.anchors[anchors as usize].iter().for_each(|slot| show(*slot));
        }
        grid.everywhere.iter().for_each(|slot| show(*slot));
    }

    fn show_other_grids(&self, own: usize, cell: [i64; 2], mover: &Mover, show: &mut impl FnMut(Slot)) {
        if self.grids.len() == 1 {
            return;
        }
        let side = self.grids[own].side;
        let low = cell.map(|index| index as f64 * side);
        let reach = [0, 1].map(|axis| mover.size[axis] / 2.0 + 2.0 * SLACK * side);
        for (index, grid) in self.grids.iter().enumerate() {
            if index == own || grid.members.is_empty() {
                continue;
            }
            let from = grid.cell([0, 1].map(|axis| low[axis] - reach[axis] - grid.side / 2.0));
            let to = grid.cell([0, 1].map(|axis| low[axis] + side + reach[axis] + grid.side / 2.0));
            self.show_cells(index, from, to, show);
        }
    }

    /// Shows who sits in a rectangle of cells, or in the whole grid if that is quicker.
    fn show_cells(&self, grid: usize, from: [i64; 2], to: [i64; 2], show: &mut impl FnMut(Slot)) {
        let cells = (to[0] as f64 - from[0] as f64 + 1.0) * (to[1] as f64 - from[1] as f64 + 1.0);
        if cells > self.grids[grid].members.len() as f64 {
            self.grids[grid].members.iter().for_each(|slot| show(*slot));
            return;
        }
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                let grid = &self.grids[grid];
                self.show_list(grid.buckets[grid.bucket([x, y])], show);
            }
        }
    }

    /// Shows each body, some perhaps twice, that may touch the region now.
    pub fn within(&self, low: [f64; 2], high: [f64; 2], mut show: impl FnMut(Slot)) {
        for (index, grid) in self.grids.iter().enumerate() {
            let from = grid.cell(low.map(|x| x - grid.side));
            let to = grid.cell(high.map(|x| x + grid.side));
            self.show_cells(index, from, to, &mut show);
        }
        self.anchored.iter().for_each(|(slot, _)| show(*slot));
    }
}
