//! A yardstick: the plain event-driven engine that a textbook would write for an elastic gas.
//!
//! Boxes of one size and mass between four walls, no forces, no contacts; positions are
//! those of each box's last collision, time is one f64. Cells as large as a box, linked
//! lists in them, one pending event a box, the earliest found by a tournament (Rapaport,
//! "The Art of Molecular Dynamics Simulation", 2nd ed., chapter 14; Marín, Risso and
//! Cordero, J. Comput. Phys. 109, 1993). What rebond can do besides must not cost more.

const NOBODY: u32 = u32::MAX;

/// A box of the gas.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Where it was at `since`, m.
    pub position: [f64; 2],
    /// m/s.
    pub velocity: [f64; 2],
    /// s.
    pub since: f64,
    /// Counts its collisions.
    generation: u32,
    cell: [u32; 2],
}

/// What a box expects first: a collision or the border of its cell.
#[derive(Clone, Copy, Debug)]
struct Expected {
    meeting: f64,
    partner: Partner,
    leaving: f64,
    leaving_axis: usize,
}

#[derive(Clone, Copy, Debug)]
enum Partner {
    Nobody,
    Wall { axis: usize },
    Body { other: u32, generation: u32, axis: usize },
}

/// The gas and its time.
#[derive(Clone, Debug)]
pub struct CellList {
    /// The boxes.
    pub bodies: Vec<Body>,
    /// Collisions, those with walls included.
    pub collisions: u64,
    size: f64,
    room: [f64; 2],
    side: [f64; 2],
    cells: [u32; 2],
    first: Vec<u32>,
    next: Vec<u32>,
    expected: Vec<Expected>,
    tournament: Tournament,
}

impl CellList {
    /// Boxes of that size in a room, by position and velocity.
    pub fn new(size: f64, room: [f64; 2], states: &[([f64; 2], [f64; 2])]) -> CellList {
        let cells = room.map(|length| (length / size) as u32);
        let side = [0, 1].map(|axis| room[axis] / f64::from(cells[axis]));
        let body = |(position, velocity): &([f64; 2], [f64; 2])| {
            let cell = [0, 1].map(|axis| {
                let cell = ((position[axis] + size / 2.0) / side[axis]) as u32;
                if cell < cells[axis] { cell } else { cells[axis] - 1 }
            });
            Body { position: *position, velocity: *velocity, since: 0.0, generation: 0, cell }
        };
        let nothing =
            Expected { meeting: f64::INFINITY, partner: Partner::Nobody, leaving: f64::INFINITY, leaving_axis: 0 };
        let mut gas = CellList {
            bodies: states.iter().map(body).collect(),
            collisions: 0,
            size,
            room,
            side,
            cells,
            first: vec![NOBODY; (cells[0] * cells[1]) as usize],
            next: vec![NOBODY; states.len()],
            expected: vec![nothing; states.len()],
            tournament: Tournament::new(states.len()),
        };
        (0..states.len() as u32).for_each(|slot| gas.enter(slot));
        (0..states.len() as u32).for_each(|slot| gas.predict(slot, 0.0));
        gas
    }

    /// Lets happen what happens before `end`, s.
    pub fn run_until(&mut self, end: f64) {
        loop {
            let (slot, now) = self.tournament.winner();
            if now > end {
                return;
            }
            let expected = self.expected[slot as usize];
            if expected.leaving < expected.meeting {
                self.cross(slot, expected.leaving_axis, now);
                continue;
            }
            match expected.partner {
                Partner::Nobody => {}
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

    /// Position and velocity of a box at a time, s, not before its last collision.
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

    /// Looks ahead for a box among all in the nine cells around it.
    fn predict(&mut self, slot: u32, now: f64) {
        let [x, y] = self.bodies[slot as usize].cell;
        let mut first = self.first_wall(slot);
        for y in y.saturating_sub(1)..(y + 2).min(self.cells[1]) {
            for x in x.saturating_sub(1)..(x + 2).min(self.cells[0]) {
                self.ask(slot, [x, y], &mut first);
            }
        }
        self.expected[slot as usize].meeting = first.0;
        self.expected[slot as usize].partner = first.1;
        self.expect_leaving(slot, now);
    }

    /// Moves a box to the next cell and looks ahead for it among those in the three new cells.
    fn cross(&mut self, slot: u32, axis: usize, now: f64) {
        self.leave(slot);
        let body = &mut self.bodies[slot as usize];
        let ahead = body.velocity[axis] > 0.0;
        let cell = if ahead { body.cell[axis] + 1 } else { body.cell[axis] - 1 };
        body.cell[axis] = cell;
        self.enter(slot);
        let expected = self.expected[slot as usize];
        let mut first = (expected.meeting, expected.partner);
        let new = if ahead { cell + 1 } else { cell.wrapping_sub(1) };
        if new < self.cells[axis] {
            let across = self.bodies[slot as usize].cell[1 - axis];
            for other in across.saturating_sub(1)..(across + 2).min(self.cells[1 - axis]) {
                self.ask(slot, if axis == 0 { [new, other] } else { [other, new] }, &mut first);
            }
        }
        self.expected[slot as usize].meeting = first.0;
        self.expected[slot as usize].partner = first.1;
        self.expect_leaving(slot, now);
    }

    fn ask(&self, slot: u32, [x, y]: [u32; 2], first: &mut (f64, Partner)) {
        let mut other = self.first[(y * self.cells[0] + x) as usize];
        while other != NOBODY {
            if other != slot {
                let (time, axis) = self.meeting(slot, other);
                if time < first.0 {
                    let generation = self.bodies[other as usize].generation;
                    *first = (time, Partner::Body { other, generation, axis });
                }
            }
            other = self.next[other as usize];
        }
    }

    /// When, s, and on which axis two boxes meet: infinity if they do not.
    ///
    /// They meet when the later of the two gaps closes, if the other has not opened by then.
    fn meeting(&self, slot: u32, other: u32) -> (f64, usize) {
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
        let mut first = (f64::INFINITY, Partner::Nobody);
        for axis in 0..2 {
            let velocity = body.velocity[axis];
            let border = if velocity > 0.0 { self.room[axis] - self.size } else { 0.0 };
            let time = body.since + (border - body.position[axis]) / velocity;
            if time < first.0 {
                first = (time, Partner::Wall { axis });
            }
        }
        first
    }

    fn expect_leaving(&mut self, slot: u32, now: f64) {
        let body = &self.bodies[slot as usize];
        let (mut leaving, mut leaving_axis) = (f64::INFINITY, 0);
        for axis in 0..2 {
            let velocity = body.velocity[axis];
            let border = f64::from(body.cell[axis] + u32::from(velocity > 0.0)) * self.side[axis];
            let centre = body.position[axis] + self.size / 2.0;
            let time = body.since + (border - centre) / velocity;
            if time < leaving {
                (leaving, leaving_axis) = (time, axis);
            }
        }
        let expected = &mut self.expected[slot as usize];
        (expected.leaving, expected.leaving_axis) = (if leaving > now { leaving } else { now }, leaving_axis);
        let Expected { meeting, leaving, .. } = *expected;
        self.tournament.set(slot, if leaving < meeting { leaving } else { meeting });
    }

    fn bucket(&self, slot: u32) -> usize {
        let [x, y] = self.bodies[slot as usize].cell;
        (y * self.cells[0] + x) as usize
    }

    fn enter(&mut self, slot: u32) {
        let bucket = self.bucket(slot);
        self.next[slot as usize] = self.first[bucket];
        self.first[bucket] = slot;
    }

    fn leave(&mut self, slot: u32) {
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
    fn new(players: usize) -> Tournament {
        let leaves = players.next_power_of_two();
        Tournament { leaves, nodes: vec![(f64::INFINITY, NOBODY); 2 * leaves] }
    }

    fn winner(&self) -> (u32, f64) {
        (self.nodes[1].1, self.nodes[1].0)
    }

    /// A player's new time: the matches on its way to the root are played again.
    fn set(&mut self, player: u32, time: f64) {
        let mut node = self.leaves + player as usize;
        self.nodes[node] = (time, player);
        while node > 1 {
            let [one, other] = [self.nodes[node & !1], self.nodes[node | 1]];
            node /= 2;
            self.nodes[node] = if one.0 <= other.0 { one } else { other };
        }
    }
}
