//! Event-driven molecular dynamics of an elastic gas, after Smallenburg, "Efficient event-driven simulations of hard
//! spheres", Eur. Phys. J. E 45, 22 (2022), for boxes between walls.
//!
//! As in the paper, the state of a particle is that of its own last event; each particle has a single pending event,
//! which a counter of its partner invalidates; near events are in a heap and later ones in the buckets of a calendar
//! (Paul, J. Comput. Phys. 221, 2007); and a neighbour list is valid until the particle leaves its shell. Positions and
//! times are doubles, and nothing else than collisions can happen.

use crate::{drive::PeerWorld, job::Job};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// The neighbours that a list should hold on average, which determines the shells.
const NEIGHBOURS: f64 = 6.0;

/// Events per bucket of the calendar, on average.
const EVENTS_PER_BUCKET: f64 = 16.0;

/// A collision this long before the present is due now, as a fraction of the time since the start: rounding.
const ROUNDING: f64 = 1e-12;

struct Particle {
    /// Upper-left corner at `since`, m.
    position: [f64; 2],
    /// m/s.
    velocity: [f64; 2],
    /// The time of its last event, s.
    since: f64,
    /// The number of its collisions.
    counter: u32,
    /// The number of changes of its pending event.
    stamp: u32,
    event: Event,
    /// m.
    size: [f64; 2],
    /// kg.
    mass: f64,
    /// The position at the time of its list; it stays within half a skin of it.
    home: [f64; 2],
    cell: usize,
    neighbours: Vec<u32>,
}

impl Particle {
    fn position_at(&self, time: f64) -> [f64; 2] {
        [0, 1].map(|axis| self.position[axis] + self.velocity[axis] * (time - self.since))
    }
}

#[derive(Clone, Copy)]
struct Event {
    time: f64,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    Particle { other: u32, counter: u32, axis: usize },
    Wall { axis: usize },
    NewList,
}

/// An event in the heap: its time, its particle and the stamp of the particle.
#[derive(Clone, Copy, PartialEq)]
struct Near(f64, u32, u32);

impl Eq for Near {}

impl PartialOrd for Near {
    fn partial_cmp(&self, other: &Near) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Near {
    fn cmp(&self, other: &Near) -> Ordering {
        self.0.total_cmp(&other.0).then((self.1, self.2).cmp(&(other.1, other.2)))
    }
}

/// The pending events by time; outdated entries are skipped when they are due.
struct Calendar {
    heap: BinaryHeap<Reverse<Near>>,
    buckets: Vec<Vec<Near>>,
    width: f64,
    /// The bucket whose events are in the heap, counted from the start.
    current: u64,
}

impl Calendar {
    fn push(&mut self, event: Near) {
        let bucket = (event.0 / self.width) as u64;
        if bucket <= self.current {
            self.heap.push(Reverse(event));
        } else {
            let last = self.current + self.buckets.len() as u64 - 1;
            let index = bucket.min(last) % self.buckets.len() as u64;
            self.buckets[index as usize].push(event);
        }
    }

    /// The first event that is not outdated, if it is not after `until`.
    fn pop(&mut self, particles: &[Particle], until: f64) -> Option<u32> {
        loop {
            while let Some(Reverse(first)) = self.heap.peek().copied() {
                let is_valid = particles[first.1 as usize].stamp == first.2;
                if is_valid && first.0 > until {
                    return None;
                }
                self.heap.pop();
                if is_valid {
                    return Some(first.1);
                }
            }
            if self.current as f64 * self.width > until {
                return None;
            }
            self.current += 1;
            let index = (self.current % self.buckets.len() as u64) as usize;
            for event in std::mem::take(&mut self.buckets[index]) {
                if particles[event.1 as usize].stamp == event.2 {
                    self.push(event);
                }
            }
        }
    }
}

/// A world of moving boxes between four walls.
pub struct Edmd {
    particles: Vec<Particle>,
    /// For each body of the job, its particle, or its fixed state.
    bodies: Vec<Result<usize, [f64; 4]>>,
    walls: [[f64; 2]; 2],
    /// Particles by the cells of their homes.
    cells: Vec<Vec<u32>>,
    columns: [usize; 2],
    cell_size: [f64; 2],
    skin: f64,
    calendar: Calendar,
    now: f64,
    steps: u64,
    rate: f64,
    collisions: u64,
}

/// Creates the world of a job, if it is an elastic gas between walls.
pub fn build(job: &Job) -> Result<Box<dyn PeerWorld>, String> {
    let is_free = job.gravity == [0.0; 2] && job.bodies.iter().all(|body| body.fx == 0.0 && body.fy == 0.0);
    let fixed = job.bodies.iter().filter(|body| body.mass.is_none()).count();
    if !is_free || job.restitution != 1.0 || fixed != 4 {
        return Err("not run: it simulates elastic gases between walls only".to_owned());
    }
    Ok(Box::new(Edmd::new(job)))
}

impl Edmd {
    fn new(job: &Job) -> Edmd {
        let (mut particles, mut bodies, mut walls) = (Vec::new(), Vec::new(), [[f64::NEG_INFINITY, f64::INFINITY]; 2]);
        let moving = || job.bodies.iter().filter(|body| body.mass.is_some());
        let center =
            [0, 1].map(|axis| moving().map(|body| [body.x, body.y][axis]).sum::<f64>() / moving().count() as f64);
        for body in &job.bodies {
            let (position, size) = ([body.x, body.y], [body.width, body.height]);
            let Some(mass) = body.mass else {
                bodies.push(Err([body.x, body.y, body.vx, body.vy]));
                // A wall bounds the axis on which it does not contain the centre of the gas.
                for axis in [0, 1] {
                    let high = position[axis] + size[axis];
                    if high <= center[axis] {
                        walls[axis][0] = walls[axis][0].max(high);
                    } else if position[axis] >= center[axis] {
                        walls[axis][1] = walls[axis][1].min(position[axis]);
                    }
                }
                continue;
            };
            bodies.push(Ok(particles.len()));
            let event = Event { time: f64::INFINITY, kind: Kind::NewList };
            let (velocity, neighbours) = ([body.vx, body.vy], Vec::new());
            let (since, counter, stamp, home, cell) = (0.0, 0, 0, position, 0);
            particles.push(Particle {
                position,
                velocity,
                since,
                counter,
                stamp,
                event,
                size,
                mass,
                home,
                cell,
                neighbours,
            });
        }
        let largest = particles.iter().flat_map(|particle| particle.size).fold(0.0, f64::max);
        let extent = walls.map(|[low, high]| high - low);
        let area_of_list = NEIGHBOURS * extent[0] * extent[1] / particles.len() as f64;
        let skin = (0.5 * area_of_list.sqrt() - largest).clamp(0.1 * largest, 4.0 * largest);
        let columns = extent.map(|side| ((side / (largest + skin)) as usize).max(1));
        let cell_size = [0, 1].map(|axis| extent[axis] / columns[axis] as f64);
        let speed = particles.iter().map(|particle| particle.velocity[0].hypot(particle.velocity[1])).sum::<f64>();
        let interval = 0.5 * skin / (speed / particles.len() as f64).max(f64::MIN_POSITIVE);
        let width = interval * EVENTS_PER_BUCKET / particles.len() as f64;
        let buckets = vec![Vec::new(); (4.0 * interval / width) as usize + 2];
        let mut gas = Edmd {
            bodies,
            walls,
            cells: vec![Vec::new(); columns[0] * columns[1]],
            columns,
            cell_size,
            skin,
            calendar: Calendar { heap: BinaryHeap::new(), buckets, width, current: 0 },
            now: 0.0,
            steps: 0,
            rate: job.rate,
            collisions: 0,
            particles,
        };
        for index in 0..gas.particles.len() {
            let cell = gas.cell_of(gas.particles[index].home);
            gas.particles[index].cell = cell;
            gas.cells[cell].push(index as u32);
        }
        (0..gas.particles.len()).for_each(|index| gas.list_neighbours(index));
        (0..gas.particles.len()).for_each(|index| gas.predict(index));
        gas
    }

    fn cell_of(&self, home: [f64; 2]) -> usize {
        let [x, y] = [0, 1].map(|axis| {
            let column = ((home[axis] - self.walls[axis][0]) / self.cell_size[axis]).max(0.0) as usize;
            column.min(self.columns[axis] - 1)
        });
        y * self.columns[0] + x
    }

    /// Replaces the list of a particle by the particles whose shells overlap its own, and adds it to their lists.
    fn list_neighbours(&mut self, index: usize) {
        let old = std::mem::take(&mut self.particles[index].neighbours);
        for other in &old {
            let list = &mut self.particles[*other as usize].neighbours;
            if let Some(place) = list.iter().position(|listed| *listed as usize == index) {
                list.swap_remove(place);
            }
        }
        let mut list = old;
        list.clear();
        let [column, row] =
            [self.particles[index].cell % self.columns[0], self.particles[index].cell / self.columns[0]];
        for y in row.saturating_sub(1)..(row + 2).min(self.columns[1]) {
            for x in column.saturating_sub(1)..(column + 2).min(self.columns[0]) {
                for other in &self.cells[y * self.columns[0] + x] {
                    let (a, b) = (&self.particles[index], &self.particles[*other as usize]);
                    let is_near = (0..2).all(|axis| {
                        let offset = b.home[axis] - a.home[axis];
                        offset < a.size[axis] + self.skin && -offset < b.size[axis] + self.skin
                    });
                    if is_near && *other as usize != index {
                        list.push(*other);
                    }
                }
            }
        }
        for other in &list {
            let others = &mut self.particles[*other as usize].neighbours;
            if !others.contains(&(index as u32)) {
                others.push(index as u32);
            }
        }
        self.particles[index].neighbours = list;
    }

    /// Finds the first event of a particle whose state is the present one.
    fn predict(&mut self, index: usize) {
        let particle = &self.particles[index];
        let mut first = Event { time: f64::INFINITY, kind: Kind::NewList };
        for axis in [0, 1] {
            let speed = particle.velocity[axis];
            let [low, high] = self.walls[axis];
            let (border, side) = if speed > 0.0 { (high - particle.size[axis], 0.5) } else { (low, -0.5) };
            let to_wall = (border - particle.position[axis]) / speed;
            let to_border = (particle.home[axis] + side * self.skin - particle.position[axis]) / speed;
            for (seconds, kind) in [(to_wall, Kind::Wall { axis }), (to_border, Kind::NewList)] {
                if speed != 0.0 && self.now + seconds.max(0.0) < first.time {
                    first = Event { time: self.now + seconds.max(0.0), kind };
                }
            }
        }
        for other in &particle.neighbours {
            let partner = &self.particles[*other as usize];
            if let Some((seconds, axis)) = self.time_to_collision(particle, partner)
                && self.now + seconds < first.time
            {
                let kind = Kind::Particle { other: *other, counter: partner.counter, axis };
                first = Event { time: self.now + seconds, kind };
            }
        }
        let particle = &mut self.particles[index];
        particle.event = first;
        particle.stamp = particle.stamp.wrapping_add(1);
        self.calendar.push(Near(first.time, index as u32, particle.stamp));
    }

    /// The seconds from now until two particles collide, and the axis; the first is at its present state.
    fn time_to_collision(&self, first: &Particle, second: &Particle) -> Option<(f64, usize)> {
        let at = second.position_at(self.now);
        let (mut entry, mut exit, mut along) = (f64::NEG_INFINITY, f64::INFINITY, 0);
        for axis in [0, 1] {
            let offset = at[axis] - first.position[axis];
            let speed = second.velocity[axis] - first.velocity[axis];
            let [ahead, behind] = [offset - first.size[axis], offset + second.size[axis]];
            if speed == 0.0 {
                if ahead >= 0.0 || behind <= 0.0 {
                    return None;
                }
                continue;
            }
            let times = [-ahead / speed, -behind / speed];
            let [enters, leaves] = if speed < 0.0 { times } else { [times[1], times[0]] };
            if enters > entry {
                (entry, along) = (enters, axis);
            }
            exit = exit.min(leaves);
        }
        (entry < exit && entry >= -ROUNDING * (1.0 + self.now)).then_some((entry.max(0.0), along))
    }

    fn advance(&mut self, index: usize) {
        let particle = &mut self.particles[index];
        particle.position = particle.position_at(self.now);
        particle.since = self.now;
    }

    /// Carries out the pending event of a particle.
    fn process(&mut self, index: usize) {
        let Event { time, kind } = self.particles[index].event;
        self.now = time;
        self.advance(index);
        match kind {
            Kind::Wall { axis } => {
                self.collisions += 1;
                self.particles[index].velocity[axis] = -self.particles[index].velocity[axis];
                self.particles[index].counter += 1;
            }
            Kind::Particle { other, counter, axis } if self.particles[other as usize].counter == counter => {
                self.collisions += 1;
                self.advance(other as usize);
                let pair = [index, other as usize];
                let [(a, v), (b, w)] =
                    pair.map(|index| (self.particles[index].mass, self.particles[index].velocity[axis]));
                let change = 2.0 * (w - v) / (a + b);
                self.particles[pair[0]].velocity[axis] = v + b * change;
                self.particles[pair[1]].velocity[axis] = w - a * change;
                pair.into_iter().for_each(|index| self.particles[index].counter += 1);
                self.predict(pair[1]);
            }
            Kind::Particle { .. } => {}
            Kind::NewList => {
                let home = self.particles[index].position;
                let (before, cell) = (self.particles[index].cell, self.cell_of(home));
                self.particles[index].home = home;
                if before != cell {
                    self.cells[before].retain(|listed| *listed as usize != index);
                    self.cells[cell].push(index as u32);
                    self.particles[index].cell = cell;
                }
                self.list_neighbours(index);
            }
        }
        self.predict(index);
    }
}

impl PeerWorld for Edmd {
    fn step(&mut self) -> Result<(), String> {
        self.steps += 1;
        let end = self.steps as f64 / self.rate;
        while let Some(index) = self.calendar.pop(&self.particles, end) {
            self.process(index as usize);
        }
        self.now = end;
        Ok(())
    }

    fn state(&self, body: usize) -> [f64; 4] {
        match self.bodies[body] {
            Err(state) => state,
            Ok(index) => {
                let particle = &self.particles[index];
                let [x, y] = particle.position_at(self.now);
                [x, y, particle.velocity[0], particle.velocity[1]]
            }
        }
    }

    fn collisions(&self) -> Option<u64> {
        Some(self.collisions)
    }
}

#[cfg(test)]
mod tests {
    use crate::{edmd, ours, scenes};

    #[test]
    fn a_gas_moves_as_in_rebond_until_rounding_errors_have_grown() {
        let scene = scenes::all(true).into_iter().find(|scene| scene.name == "gas of 10²").expect("a gas");
        let job = crate::job(&scene, std::path::PathBuf::new());
        let mut worlds = [edmd::build(&job), ours::event_driven(&job)].map(|world| world.expect("a gas"));
        for _ in 0..60 {
            worlds.iter_mut().for_each(|world| world.step().expect("no error"));
            for body in 0..job.bodies.len() {
                let [a, b] = [0, 1].map(|world: usize| worlds[world].state(body));
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "body {body}: {a:?} instead of {b:?}");
            }
        }
        let [ours, edmd] = [1, 0].map(|world: usize| worlds[world].collisions());
        assert_eq!(edmd, ours);
        assert!(edmd > Some(50));
    }
}
