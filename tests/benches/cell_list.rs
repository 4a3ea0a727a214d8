//! A baseline for benchmarks: a textbook event-driven simulation of an elastic gas.
//!
//! Boxes of one size and mass between four walls, without forces or contacts. The position of each box is stored
//! at the time of its last collision; time is one f64. Cells as large as a box contain linked lists; each box has
//! one pending event, and a tournament tree finds the earliest (Rapaport, "The Art of Molecular Dynamics
//! Simulation", 2nd ed., chapter 14; Marín, Risso and Cordero, J. Comput. Phys. 109, 1993). The additional
//! features of rebond should not make it slower than this.

const NONE: u32 = u32::MAX;

/// A box of the gas.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Position at `since`, m.
    pub position: [f64; 2],
    /// Velocity, m/s.
    pub velocity: [f64; 2],
    /// Time of the last collision, s.
    pub since: f64,
    /// Number of collisions.
    generation: u32,
    cell: [u32; 2],
}

/// The predicted first events of a box: a collision and the exit from its cell, with their times, s.
#[derive(Clone, Copy, Debug)]
struct Prediction {
    collision: f64,
    partner: Partner,
    cell_exit: f64,
    exit_axis: usize,
}

#[derive(Clone, Copy, Debug)]
enum Partner {
    None,
    Wall { axis: usize },
    Body { other: u32, generation: u32, axis: usize },
}

/// The gas.
#[derive(Clone, Debug)]
pub struct CellList {
    /// The boxes.
    pub bodies: Vec<Body>,
    /// The number of collisions, including those with walls.
    pub collisions: u64,
    size: f64,
    extent: [f64; 2],
    side: [f64; 2],
    cells: [u32; 2],
    first: Vec<u32>,
    next: Vec<u32>,
    predictions: Vec<Prediction>,
    tournament: Tournament,
}

impl CellList {
    /// Creates a gas of boxes of one size in a rectangle, from positions and velocities.
    pub fn new(size: f64, extent: [f64; 2], states: &[([f64; 2], [f64; 2])]) -> CellList {
        let cells = extent.map(|length| (length / size) as u32);
        let side = [0, 1].map(|axis| extent[axis] / f64::from(cells[axis]));
        let body = |(position, velocity): &([f64; 2], [f64; 2])| {
            let cell = [0, 1].map(|axis| {
                let cell = ((position[axis] + size / 2.0) / side[axis]) as u32;
                if cell < cells[axis] { cell } else { cells[axis] - 1 }
            });
            Body { position: *position, velocity: *velocity, since: 0.0, generation: 0, cell }
        };
        let none =
            Prediction { collision: f64::INFINITY, partner: Partner::None, cell_exit: f64::INFINITY, exit_axis: 0 };
        let mut gas = CellList {
            bodies: states.iter().map(body).collect(),
            collisions: 0,
            size,
            extent,
            side,
            cells,
            first: vec![NONE; (cells[0] * cells[1]) as usize],
            next: vec![NONE; states.len()],
            predictions: vec![none; states.len()],
            tournament: Tournament::new(states.len()),
        };
        (0..states.len() as u32).for_each(|slot| gas.link(slot));
        (0..states.len() as u32).for_each(|slot| gas.predict(slot, 0.0));
        gas
    }

    /// Processes all events up to `end`, s.
    pub fn run_until(&mut self, end: f64) {
        loop {
            let (slot, now) = self.tournament.first();
            if now > end {
                return;
            }
            let prediction = self.predictions[slot as usize];
            if prediction.cell_exit < prediction.collision {
                self.move_to_next_cell(slot, prediction.exit_axis, now);
                continue;
            }
            match prediction.partner {
                Partner::None => {}
                Partner::Wall { axis } => {
                    self.advance(slot, now);
                    self.bodies[slot as usize].velocity[axis] *= -1.0;
                    self.collisions += 1;
                }
                Partner::Body { other, generation, axis } if self.bodies[other as usize].generation == generation => {
                    self.advance(slot, now);
                    self.advance(other, now);
                    let [a, b] = [slot, other].map(|slot| self.bodies[slot as usize].velocity[axis]);
                    self.bodies[slot as usize].velocity[axis] = b;
                    self.bodies[other as usize].velocity[axis] = a;
                    self.collisions += 1;
                    self.predict(other, now);
                }
                Partner::Body { .. } => {}
            }
            self.predict(slot, now);
        }
    }

    /// Returns position and velocity of a box at a time, s, not before its last collision.
    pub fn state(&self, slot: usize, time: f64) -> ([f64; 2], [f64; 2]) {
        let body = &self.bodies[slot];
        let t = time - body.since;
        ([0, 1].map(|axis| body.position[axis] + body.velocity[axis] * t), body.velocity)
    }

    fn advance(&mut self, slot: u32, now: f64) {
        let (position, _) = self.state(slot as usize, now);
        let body = &mut self.bodies[slot as usize];
        body.position = position;
        body.since = now;
        body.generation += 1;
    }

    /// Predicts the next event of a box among the boxes in its cell and the eight adjacent ones.
    fn predict(&mut self, slot: u32, now: f64) {
        let [x, y] = self.bodies[slot as usize].cell;
        let mut first = self.first_wall(slot);
        for y in y.saturating_sub(1)..(y + 2).min(self.cells[1]) {
            for x in x.saturating_sub(1)..(x + 2).min(self.cells[0]) {
                self.predict_in_cell(slot, [x, y], &mut first);
            }
        }
        self.predictions[slot as usize].collision = first.0;
        self.predictions[slot as usize].partner = first.1;
        self.predict_cell_exit(slot, now);
    }

    /// Moves a box to the next cell and predicts its next event among the boxes in the three new adjacent cells.
    fn move_to_next_cell(&mut self, slot: u32, axis: usize, now: f64) {
        self.unlink(slot);
        let body = &mut self.bodies[slot as usize];
        let ahead = body.velocity[axis] > 0.0;
        let cell = if ahead { body.cell[axis] + 1 } else { body.cell[axis] - 1 };
        body.cell[axis] = cell;
        self.link(slot);
        let prediction = self.predictions[slot as usize];
        let mut first = (prediction.collision, prediction.partner);
        let new = if ahead { cell + 1 } else { cell.wrapping_sub(1) };
        if new < self.cells[axis] {
            let across = self.bodies[slot as usize].cell[1 - axis];
            for other in across.saturating_sub(1)..(across + 2).min(self.cells[1 - axis]) {
                self.predict_in_cell(slot, if axis == 0 { [new, other] } else { [other, new] }, &mut first);
            }
        }
        self.predictions[slot as usize].collision = first.0;
        self.predictions[slot as usize].partner = first.1;
        self.predict_cell_exit(slot, now);
    }

    fn predict_in_cell(&self, slot: u32, [x, y]: [u32; 2], first: &mut (f64, Partner)) {
        let mut other = self.first[(y * self.cells[0] + x) as usize];
        while other != NONE {
            if other != slot {
                let (time, axis) = self.time_of_impact(slot, other);
                if time < first.0 {
                    let generation = self.bodies[other as usize].generation;
                    *first = (time, Partner::Body { other, generation, axis });
                }
            }
            other = self.next[other as usize];
        }
    }

    /// Returns the time of impact of two boxes, s, and its axis; infinity if they do not collide.
    ///
    /// They collide when the later of the two gaps closes, if the other has not opened by then.
    fn time_of_impact(&self, slot: u32, other: u32) -> (f64, usize) {
        let [a, b] = [&self.bodies[slot as usize], &self.bodies[other as usize]];
        let now = if a.since > b.since { a.since } else { b.since };
        let (mut enter, mut leave, mut last) = (f64::NEG_INFINITY, f64::INFINITY, 0);
        for axis in 0..2 {
            let [pa, pb] = [a, b].map(|body| body.position[axis] + body.velocity[axis] * (now - body.since));
            let (distance, velocity) = (pb - pa, b.velocity[axis] - a.velocity[axis]);
            if distance * velocity >= 0.0 && distance.abs() >= self.size {
                return (f64::INFINITY, 0);
            }
            let [ahead, behind] = [(self.size - distance) / velocity, (-self.size - distance) / velocity];
            let (from, to) = if ahead < behind { (ahead, behind) } else { (behind, ahead) };
            if from > enter {
                (enter, last) = (from, axis);
            }
            leave = if to < leave { to } else { leave };
        }
        if enter < leave && leave > 0.0 && enter > -1e-9 { (now + enter, last) } else { (f64::INFINITY, 0) }
    }

    fn first_wall(&self, slot: u32) -> (f64, Partner) {
        let body = &self.bodies[slot as usize];
        let mut first = (f64::INFINITY, Partner::None);
        for axis in 0..2 {
            let velocity = body.velocity[axis];
            let border = if velocity > 0.0 { self.extent[axis] - self.size } else { 0.0 };
            let time = body.since + (border - body.position[axis]) / velocity;
            if time < first.0 {
                first = (time, Partner::Wall { axis });
            }
        }
        first
    }

    fn predict_cell_exit(&mut self, slot: u32, now: f64) {
        let body = &self.bodies[slot as usize];
        let (mut cell_exit, mut exit_axis) = (f64::INFINITY, 0);
        for axis in 0..2 {
            let velocity = body.velocity[axis];
            let border = f64::from(body.cell[axis] + u32::from(velocity > 0.0)) * self.side[axis];
            let centre = body.position[axis] + self.size / 2.0;
            let time = body.since + (border - centre) / velocity;
            if time < cell_exit {
                (cell_exit, exit_axis) = (time, axis);
            }
        }
        let prediction = &mut self.predictions[slot as usize];
        (prediction.cell_exit, prediction.exit_axis) = (if cell_exit > now { cell_exit } else { now }, exit_axis);
        let Prediction { collision, cell_exit, .. } = *prediction;
        self.tournament.set(slot, if cell_exit < collision { cell_exit } else { collision });
    }

    fn bucket(&self, slot: u32) -> usize {
        let [x, y] = self.bodies[slot as usize].cell;
        (y * self.cells[0] + x) as usize
    }

    fn link(&mut self, slot: u32) {
        let bucket = self.bucket(slot);
        self.next[slot as usize] = self.first[bucket];
        self.first[bucket] = slot;
    }

    fn unlink(&mut self, slot: u32) {
        let bucket = self.bucket(slot);
        let mut here = self.first[bucket];
        if here == slot {
            self.first[bucket] = self.next[slot as usize];
            return;
        }
        while self.next[here as usize] != slot {
            here = self.next[here as usize];
        }
        self.next[here as usize] = self.next[slot as usize];
    }
}

/// A complete binary tree in which each node holds the earlier of its two children.
#[derive(Clone, Debug)]
struct Tournament {
    leaves: usize,
    nodes: Vec<(f64, u32)>,
}

impl Tournament {
    fn new(count: usize) -> Tournament {
        let leaves = count.next_power_of_two();
        Tournament { leaves, nodes: vec![(f64::INFINITY, NONE); 2 * leaves] }
    }

    fn first(&self) -> (u32, f64) {
        (self.nodes[1].1, self.nodes[1].0)
    }

    /// Sets the time of a leaf and updates the nodes on its path to the root.
    fn set(&mut self, slot: u32, time: f64) {
        let mut node = self.leaves + slot as usize;
        self.nodes[node] = (time, slot);
        while node > 1 {
            let [left, right] = [self.nodes[node & !1], self.nodes[node | 1]];
            node /= 2;
            self.nodes[node] = if left.0 <= right.0 { left } else { right };
        }
    }
}
