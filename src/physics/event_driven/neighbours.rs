//! Which boxes may be near which: grids of square cells, one for each class of sizes.
//!
//! Nothing here decides what happens, only who is asked: which grid a box sits in and when
//! it changes cells has no influence on any result.

use super::instant::{Clock, Instant};
use super::motion::closing_time;
use super::mover::{AXES, Mover, Slot};

const NONE: u32 = u32::MAX;

/// A box is at most this fraction of its cell's side, so that with [`SLACK`] on either side
/// it never reaches beyond the neighbouring cells.
const FILL: f64 = 0.93;

/// A box has left its cell when its centre is this fraction of the side outside it. Without
/// it a rounding could make a box cross the same border for ever.
const SLACK: f64 = 1.0 / 32.0;

/// The sides of the cells of consecutive grids stand in this ratio.
const RATIO: f64 = 4.0;

/// A box crosses at most about this many cells in a step; a faster one sits in a coarser grid.
const CELLS_PER_STEP: f64 = 4.0;

/// No cell is so many cells away from the origin that its borders could not be told apart.
const FURTHEST_CELL: f64 = (1u64 << 40) as f64;

/// An anchored box is entered in its cells one by one only while they are at most so many
/// for each bucket of the grid.
const ANCHOR_CELLS_PER_BUCKET: f64 = 4.0;

/// The grids.
#[derive(Clone, Debug)]
pub struct Neighbours {
    /// The side of the cells that suit most boxes, m.
    base: f64,
    grids: Vec<Grid>,
    /// Where each body sits, by slot.
    seats: Vec<Seat>,
    /// The boxes that never move: lower and upper corner.
    anchored: Vec<(Slot, [[f64; 2]; 2])>,
}

/// One grid: a torus of buckets onto which the unbounded plane of cells is wound.
///
/// Two cells that fall on the same bucket cost a few needless questions, nothing else.
#[derive(Clone, Debug)]
struct Grid {
    side: f64,
    /// Along which multiple of rows the plane is wound.
    row: u64,
    buckets: Vec<Bucket>,
    members: Vec<Slot>,
    /// The anchored boxes near each bucket that has any.
    anchors: Vec<Vec<Slot>>,
    /// The anchored boxes too large to be entered cell by cell.
    everywhere: Vec<Slot>,
}

#[derive(Clone, Copy, Debug)]
struct Bucket {
    first: Slot,
    anchors: u32,
}

#[derive(Clone, Copy, Debug)]
struct Seat {
    grid: u32,
    member: u32,
    cell: [i64; 2],
    previous: Slot,
    next: Slot,
}

const NOWHERE: Seat = Seat { grid: NONE, member: NONE, cell: [0; 2], previous: NONE, next: NONE };

impl Grid {
    fn new(side: f64, buckets: usize) -> Grid {
        let mut grid = Grid {
            side,
            row: 0,
            buckets: Vec::new(),
            members: Vec::new(),
            anchors: Vec::new(),
            everywhere: Vec::new(),
        };
        grid.resize(buckets);
        grid
    }

    fn resize(&mut self, buckets: usize) {
        self.buckets.clear();
        self.buckets.resize(buckets, Bucket { first: NONE, anchors: NONE });
        // Rows a golden section apart lie as evenly on the ring of buckets as can be,
        // whatever the shape of the inhabited region (Knuth, TAOCP 3, 6.4).
        self.row = (buckets as f64 * 0.618_033_988_749_894_9) as u64 | 1;
        self.anchors.clear();
        self.everywhere.clear();
    }

    fn bucket(&self, [x, y]: [i64; 2]) -> usize {
        let wound = (x as u64).wrapping_add((y as u64).wrapping_mul(self.row));
        (wound & (self.buckets.len() as u64 - 1)) as usize
    }

    fn cell(&self, point: [f64; 2]) -> [i64; 2] {
        point.map(|coordinate| floor(coordinate / self.side))
    }

    fn anchor(&mut self, slot: Slot, [low, high]: [[f64; 2]; 2]) {
        let reach = self.side / 2.0;
        let [from, to] = [self.cell(low.map(|x| x - reach)), self.cell(high.map(|x| x + reach))];
        let cells = (to[0] as f64 - from[0] as f64 + 1.0) * (to[1] as f64 - from[1] as f64 + 1.0);
        if cells > ANCHOR_CELLS_PER_BUCKET * self.buckets.len() as f64 {
            self.everywhere.push(slot);
            return;
        }
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                let bucket = self.bucket([x, y]);
                let bucket = &mut self.buckets[bucket];
                if bucket.anchors == NONE {
                    bucket.anchors = self.anchors.len() as u32;
                    self.anchors.push(Vec::new());
                }
                let anchors = &mut self.anchors[bucket.anchors as usize];
                if anchors.last() != Some(&slot) {
                    anchors.push(slot);
                }
            }
        }
    }
}

impl Neighbours {
    /// Grids for boxes whose usual longer side is `size`, m.
    pub fn new(size: f64) -> Neighbours {
        Neighbours { base: size / FILL, grids: Vec::new(), seats: Vec::new(), anchored: Vec::new() }
    }

    /// Enters a body.
    pub fn insert(&mut self, clock: &Clock, slot: Slot, mover: &Mover, now: Instant) {
        if self.seats.len() <= slot as usize {
            self.seats.resize(slot as usize + 1, NOWHERE);
        }
        if mover.is_anchored() {
            let low = [mover.motion[0].position, mover.motion[1].position];
            let corners = [low, [low[0] + mover.size[0], low[1] + mover.size[1]]];
            self.anchored.push((slot, corners));
            for grid in &mut self.grids {
                grid.anchor(slot, corners);
            }
        } else {
            let centre = centre(clock, mover, now);
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
        self.seats[slot as usize] = Seat { grid: grid as u32, member: members as u32, ..NOWHERE };
        if (members + 1) * 2 > self.grids[grid].buckets.len() {
            self.seats[slot as usize].cell = cell;
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
        self.seats[slot as usize] = NOWHERE;
    }

    fn link(&mut self, slot: Slot, cell: [i64; 2]) {
        let grid = &mut self.grids[self.seats[slot as usize].grid as usize];
        let bucket = grid.bucket(cell);
        let next = grid.buckets[bucket].first;
        grid.buckets[bucket].first = slot;
        if next != NONE {
            self.seats[next as usize].previous = slot;
        }
        let seat = &mut self.seats[slot as usize];
        seat.cell = cell;
        seat.previous = NONE;
        seat.next = next;
    }

    fn unlink(&mut self, slot: Slot) {
        let seat = self.seats[slot as usize];
        if seat.previous == NONE {
            let grid = &mut self.grids[seat.grid as usize];
            let bucket = grid.bucket(seat.cell);
            grid.buckets[bucket].first = seat.next;
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
            self.link(slot, self.seats[slot as usize].cell);
        }
        for (slot, corners) in &self.anchored {
            self.grids[grid].anchor(*slot, *corners);
        }
    }

    /// The grid a body belongs in: cells larger than it, than what it covers in a fraction of
    /// a step, and than what its coordinates can resolve.
    fn grid_for(&mut self, clock: &Clock, mover: &Mover, now: Instant, centre: [f64; 2]) -> usize {
        let mut needed = 0.0;
        for axis in AXES {
            let (_, velocity) = mover.motion[axis].at(clock, now);
            let fall = mover.motion[axis].acceleration.abs() * clock.period;
            let covered = (velocity.abs() + fall) * clock.period / CELLS_PER_STEP;
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

    /// When after `now` a body leaves its cell; never for an anchored one.
    pub fn leaving(&self, clock: &Clock, slot: Slot, mover: &Mover, now: Instant) -> Instant {
        let seat = &self.seats[slot as usize];
        let side = self.grids[seat.grid as usize].side;
        let mut first = f64::INFINITY;
        for axis in AXES {
            let motion = &mover.motion[axis];
            if motion.is_still() {
                continue;
            }
            let low = seat.cell[axis] as f64 * side;
            let (position, velocity) = motion.at(clock, now);
            let centre = position + mover.size[axis] / 2.0;
            if motion.acceleration == 0.0 {
                let border = if velocity > 0.0 { low + side * (1.0 + SLACK) } else { low - side * SLACK };
                let leaves = (border - centre) / velocity;
                first = if leaves < first { leaves } else { first };
                continue;
            }
            let ahead = closing_time((low + side * (1.0 + SLACK)) - centre, velocity, motion.acceleration);
            let behind = closing_time(centre - (low - side * SLACK), -velocity, -motion.acceleration);
            let leaves = if ahead < behind { ahead } else { behind };
            first = if leaves < first { leaves } else { first };
        }
        clock.after(now, if first > 0.0 { first } else { 0.0 })
    }

    /// Moves a body to the cell it is in now and shows each that may have come near.
    pub fn cross(&mut self, clock: &Clock, slot: Slot, mover: &Mover, now: Instant, mut show: impl FnMut(Slot)) {
        let seat = self.seats[slot as usize];
        let states = [mover.motion[0].at(clock, now), mover.motion[1].at(clock, now)];
        let centre = [states[0].0 + mover.size[0] / 2.0, states[1].0 + mover.size[1] / 2.0];
        let mut grid = seat.grid as usize;
        let speed = states[0].1.abs() + states[1].1.abs();
        if !self.suits(clock, grid, mover, centre[0].abs() + centre[1].abs(), speed) {
            grid = self.grid_for(clock, mover, now, centre);
        }
        if grid != seat.grid as usize {
            self.rise(slot);
            self.sit(slot, grid, centre);
            self.near(slot, mover, show);
            return;
        }
        let cell = self.grids[grid].cell(centre);
        self.unlink(slot);
        self.link(slot, cell);
        for y in cell[1].saturating_sub(1)..=cell[1].saturating_add(1) {
            for x in cell[0].saturating_sub(1)..=cell[0].saturating_add(1) {
                if x.abs_diff(seat.cell[0]) > 1 || y.abs_diff(seat.cell[1]) > 1 {
                    self.show_bucket(grid, [x, y], &mut show);
                }
            }
        }
        self.show_anchors(grid, cell, &mut show);
        self.show_other_grids(grid, cell, mover, &mut show);
    }

    /// Shows each body, itself included and some perhaps twice, that may touch this one before
    /// either of the two leaves its cell.
    pub fn near(&self, slot: Slot, mover: &Mover, mut show: impl FnMut(Slot)) {
        let seat = &self.seats[slot as usize];
        let grid = seat.grid as usize;
        let (cells, mask) = (&self.grids[grid], self.grids[grid].buckets.len() as u64 - 1);
        let middle = cells.bucket(seat.cell) as u64;
        for row in [middle.wrapping_sub(cells.row), middle, middle.wrapping_add(cells.row)] {
            for bucket in [row.wrapping_sub(1), row, row.wrapping_add(1)] {
                let mut slot = cells.buckets[(bucket & mask) as usize].first;
                while slot != NONE {
                    show(slot);
                    slot = self.seats[slot as usize].next;
                }
            }
        }
        self.show_anchors(grid, seat.cell, &mut show);
        self.show_other_grids(grid, seat.cell, mover, &mut show);
    }

    fn show_bucket(&self, grid: usize, cell: [i64; 2], show: &mut impl FnMut(Slot)) {
        let grid = &self.grids[grid];
        let mut slot = grid.buckets[grid.bucket(cell)].first;
        while slot != NONE {
            show(slot);
            slot = self.seats[slot as usize].next;
        }
    }

    fn show_anchors(&self, grid: usize, cell: [i64; 2], show: &mut impl FnMut(Slot)) {
        let grid = &self.grids[grid];
        let anchors = grid.buckets[grid.bucket(cell)].anchors;
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
                self.show_bucket(grid, [x, y], show);
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

/// The greatest whole number not above this one, as far as there are such numbers.
fn floor(number: f64) -> i64 {
    let whole = number as i64;
    if whole as f64 > number { whole.saturating_sub(1) } else { whole }
}

fn centre(clock: &Clock, mover: &Mover, now: Instant) -> [f64; 2] {
    [0, 1].map(|axis| mover.motion[axis].at(clock, now).0 + mover.size[axis] / 2.0)
}
