//! Random scenes by kind, on a lattice of whole units so that faces are flush and events coincide.

use super::scene::{Scene, SceneBody};
use crate::world_builder::{INFINITE, spec};

/// A linear congruential generator (Knuth's MMIX constants).
pub struct Random(u64);

impl Random {
    /// Generators of different seeds differ from the first number on.
    pub fn new(seed: u64) -> Random {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678);
        (0..8).for_each(|_| _ = random.below(2));
        random
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % bound
    }

    /// A whole number, both ends included.
    pub fn whole(&mut self, first: i64, last: i64) -> i64 {
        first + self.below((last - first + 1) as u64) as i64
    }

    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }

    /// True in `percent` of 100 cases.
    pub fn chance(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }

    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * (self.below(1 << 30) as f64 / f64::from(1 << 30))
    }

    fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last as u64 + 1) as usize);
        }
    }
}

pub const COEFFICIENTS: [f64; 8] = [0.0, 0.2, 0.5, 0.9, 0.95, 0.99, 0.999, 1.0];

/// Fills a lattice with the boxes of a kind.
type Fill = fn(&mut Lattice);

/// The kinds of scenes, by name.
const KINDS: [(&str, Fill); 14] = [
    ("grid", grid),
    ("tower", tower),
    ("row", row),
    ("column", column),
    ("blocks", blocks),
    ("seams", seams),
    ("platform", platform),
    ("heap", heap),
    ("corner", corner),
    ("pressed", pressed),
    ("squeeze", squeeze),
    ("churn", churn),
    ("graze", graze),
    ("gas", gas),
];

/// The random scene of a seed; consecutive seeds go through all kinds.
pub fn random_scene(seed: u64) -> Scene {
    let (kind, fill) = KINDS[(seed % KINDS.len() as u64) as usize];
    let mut lattice = Lattice::new(kind, seed);
    fill(&mut lattice);
    lattice.finish()
}

/// A random scene of the kind `gas`: boxes in general position at e = 1, of which nothing coincides.
pub fn random_gas(seed: u64) -> Scene {
    let mut lattice = Lattice::new("gas", seed);
    gas(&mut lattice);
    lattice.finish()
}

/// A random scene of the kinds whose bodies touch at the start.
pub fn random_touching_scene(seed: u64) -> Scene {
    let (kind, fill) = KINDS[[9, 1, 9, 0, 3, 9, 8][(seed % 7) as usize]];
    let mut lattice = Lattice::new(kind, seed);
    fill(&mut lattice);
    lattice.finish()
}

/// A box in whole units, with its velocity in whole units of speed.
struct Cell {
    at: [i64; 2],
    size: [i64; 2],
    mass: f64,
    velocity: [i64; 2],
    force: [f64; 2],
    step: u64,
    /// The step at which it is deleted.
    delete: Option<u64>,
    /// Added to the position along x, m.
    nanometres: f64,
    material: &'static str,
    /// Replaces the position, size and velocity, for boxes in general position.
    exact: Option<[[f64; 2]; 3]>,
}

/// Collects boxes in whole units and refuses those that overlap at step 0.
struct Lattice {
    random: Random,
    scene: Scene,
    cells: Vec<Cell>,
    /// Length and speed of a unit as fractions, m and m/s.
    unit: [i64; 2],
    speed: [i64; 2],
    masses: &'static [f64],
    materials: &'static [&'static str],
}

/// Velocity, mass, force and step of a box to be added.
#[derive(Clone, Copy, Default)]
struct Motion {
    velocity: [i64; 2],
    force: [f64; 2],
    /// `None` for a random one.
    mass: Option<f64>,
    step: u64,
}

fn still() -> Motion {
    Motion::default()
}

fn moving(x: i64, y: i64) -> Motion {
    Motion { velocity: [x, y], ..Motion::default() }
}

impl Motion {
    fn heavy(self, mass: f64) -> Motion {
        Motion { mass: Some(mass), ..self }
    }

    fn infinite(self) -> Motion {
        self.heavy(INFINITE)
    }

    fn pushed(self, force: [f64; 2]) -> Motion {
        Motion { force, ..self }
    }
}

impl Lattice {
    fn new(kind: &'static str, seed: u64) -> Lattice {
        let mut r = Random::new(seed);
        let is_decimal = r.chance(25);
        let unit = if is_decimal { [r.pick(&[1, 2, 8, 3, 6]), 10] } else { [1, r.pick(&[1, 1, 2, 4, 8])] };
        let speed = if is_decimal { [r.pick(&[1, 5, 3, 10]), 10] } else { [1, r.pick(&[1, 2, 4])] };
        let rate = if is_decimal { r.pick(&[20.0, 25.0, 16.0]) } else { r.pick(&[8.0, 16.0, 32.0]) };
        let steps = rate as u64 * r.pick(&[1, 2, 2, 3]);
        let restitution = r.pick(&COEFFICIENTS);
        let (materials, pairs): (&[&str], _) = if r.chance(30) {
            (&["a", "b"], vec![(["a", "a"], r.pick(&COEFFICIENTS)), (["a", "b"], r.pick(&COEFFICIENTS))])
        } else {
            (&[""], Vec::new())
        };
        let masses: &[f64] = match r.below(7) {
            0 | 1 => &[1.0],
            2 => &[1.0, 2.0],
            3 => &[0.5, 1.0, 2.0, 3.0],
            4 => &[1.0, 10.0],
            5 => &[1.0, 1000.0],
            _ => &[0.125, 1.0, 8.0],
        };
        let scene = Scene {
            kind,
            seed,
            rate,
            steps,
            gravity: [0.0; 2],
            restitution,
            pairs,
            bodies: Vec::new(),
            deletes: Vec::new(),
            is_dyadic: !is_decimal,
        };
        Lattice { random: r, scene, cells: Vec::new(), unit, speed, masses, materials }
    }

    /// Adds a box given in units. Returns false if its place is taken.
    fn add(&mut self, at: [i64; 2], size: [i64; 2], motion: Motion) -> bool {
        let overlaps = |other: &Cell| {
            other.step == 0 && (0..2).all(|k| at[k] < other.at[k] + other.size[k] && other.at[k] < at[k] + size[k])
        };
        if motion.step == 0 && self.cells.iter().any(overlaps) {
            return false;
        }
        let mass = motion.mass.unwrap_or_else(|| self.random.pick(self.masses));
        let material = self.random.pick(self.materials);
        let force = if mass == INFINITE { [0.0; 2] } else { motion.force };
        let Motion { velocity, step, .. } = motion;
        self.cells.push(Cell {
            at,
            size,
            mass,
            velocity,
            force,
            step,
            delete: None,
            nanometres: 0.0,
            material,
            exact: None,
        });
        true
    }

    fn gravity(&mut self, percent: u64, percent_sideways: u64) {
        if self.random.chance(percent) {
            let down = self.random.pick(&[8.0, 10.0, 9.8125, 9.81, 2.0]);
            let sideways = self.random.chance(percent_sideways);
            let x = if sideways { self.random.pick(&[-1.0, 1.0, 3.0]) } else { 0.0 };
            self.scene.gravity = [x, down];
        }
    }

    /// A random force, in some cases along one axis only.
    fn some_force(&mut self, percent: u64) -> [f64; 2] {
        if !self.random.chance(percent) {
            return [0.0; 2];
        }
        let mut force = [0, 1].map(|_| self.random.whole(-16, 16) as f64);
        if self.random.chance(50) {
            force[self.random.below(2) as usize] = 0.0;
        }
        force
    }

    /// A step between the first and the last quarter of the run.
    fn some_step(&mut self) -> u64 {
        1 + self.random.below(self.scene.steps * 3 / 4)
    }

    /// Turns, mirrors and shuffles the scene, and moves the boxes of some by an ulp.
    fn finish(mut self) -> Scene {
        let (is_turned, is_shuffled) = (self.random.chance(30), self.random.chance(50));
        let mirrored = [0, 1].map(|_| self.random.chance(25));
        if is_shuffled {
            self.random.shuffle(&mut self.cells);
        }
        self.cells.sort_by_key(|cell| cell.step);
        let by_ulps = self.scene.is_dyadic && self.random.chance(8);
        self.scene.is_dyadic &= !by_ulps && self.cells.iter().all(|cell| cell.exact.is_none());
        let metres = |n: i64, [numerator, denominator]: [i64; 2]| (n * numerator) as f64 / denominator as f64;
        for (label, cell) in self.cells.iter().enumerate() {
            let size = cell.size.map(|n| metres(n, self.unit));
            let corner = |k: usize| if mirrored[k] { -cell.at[k] - cell.size[k] } else { cell.at[k] };
            let sign = mirrored.map(|yes| if yes { -1.0 } else { 1.0 });
            let mut at = [0, 1].map(|k| metres(corner(k), self.unit));
            at[0] += sign[0] * cell.nanometres * 1e-9;
            let mut body = spec(at, size, cell.mass);
            body.velocity = [0, 1].map(|k| sign[k] * metres(cell.velocity[k], self.speed));
            body.force = [0, 1].map(|k| sign[k] * cell.force[k]);
            if let Some([at, size, velocity]) = cell.exact {
                (body.at, body.size, body.velocity, body.force) = (at, size, velocity, cell.force);
            }
            if by_ulps && cell.step == 0 {
                // Ulps of coordinates near 0 are no rounding of a face.
                body.at = [0, 1].map(|k| match (self.random.below(3), body.at[k]) {
                    (0, x) if x.abs() >= size[k] => x.next_up(),
                    (1, x) if x.abs() >= size[k] => x.next_down(),
                    (_, x) => x,
                });
            }
            self.scene.deletes.extend(cell.delete.filter(|step| *step > cell.step).map(|step| (step, label)));
            self.scene.bodies.push(SceneBody { label, spec: body, material: cell.material, step: cell.step });
        }
        if self.cells.iter().all(|cell| cell.exact.is_none()) {
            let sign = mirrored.map(|yes| if yes { -1.0 } else { 1.0 });
            self.scene.gravity = [0, 1].map(|k| sign[k] * self.scene.gravity[k]);
        }
        if is_turned { self.scene.with_axes_exchanged() } else { self.scene }
    }
}

/// Boxes at random places of a small lattice, some touching, some moving, some with forces.
fn grid(b: &mut Lattice) {
    b.gravity(50, 15);
    if b.random.chance(60) {
        b.add([-2, 8], [14, 1], still().infinite());
    }
    if b.random.chance(30) {
        b.add([-3, -2], [1, 10], still().infinite());
    }
    let forces = b.random.pick(&[0, 0, 30, 60]);
    let percent_moving = b.random.pick(&[20, 50, 100]);
    let infinite = b.random.pick(&[0, 0, 15]);
    for _ in 0..b.random.whole(3, 10) {
        let r = &mut b.random;
        let velocity = if r.chance(percent_moving) { [r.whole(-3, 3), r.whole(-3, 3)] } else { [0, 0] };
        let at = [r.whole(0, 8), r.whole(0, 6)];
        let size = [r.whole(1, 3), r.whole(1, 2)];
        let force = b.some_force(forces);
        let motion = if b.random.chance(infinite) { still().infinite() } else { moving(velocity[0], velocity[1]) };
        b.add(at, size, motion.pushed(force));
    }
}

/// A tower on several supports, with blocks thrown at it or dropped on it.
fn tower(b: &mut Lattice) {
    b.gravity(100, 10);
    b.add([-8, 12], [32, 1], still().infinite());
    let forces = b.random.pick(&[0, 0, 20]);
    let (mut level, mut left, mut right) = (12, 0, b.random.whole(3, 8));
    for _ in 0..b.random.whole(1, 3) {
        let height = b.random.whole(1, 2);
        if b.random.chance(60) && right - left >= 3 {
            for _ in 0..b.random.whole(2, 3) {
                let (place, force) = (b.random.whole(left, right - 1), b.some_force(forces));
                b.add([place, level - height], [1, height], still().pushed(force));
            }
            level -= height + 1;
            let (over, under, force) = (b.random.whole(0, 1), b.random.whole(0, 1), b.some_force(forces));
            b.add([left - over, level], [right - left + over + under, 1], still().pushed(force));
        } else {
            let wide = b.random.whole(1, right - left);
            let (at, force) = (b.random.whole(left, right - wide), b.some_force(forces));
            level -= height;
            b.add([at, level], [wide, height], still().pushed(force));
            (left, right) = (at, at + wide);
        }
    }
    for _ in 0..b.random.whole(0, 2) {
        let r = &mut b.random;
        if r.chance(50) {
            let (at, size) = ([r.whole(-7, -3), r.whole(level - 1, 10)], [r.whole(1, 2), r.whole(1, 2)]);
            let speed = r.whole(1, 12);
            b.add(at, size, moving(speed, 0));
        } else {
            let (at, size) = ([r.whole(-1, 7), r.whole(level - 6, level - 2)], [r.whole(1, 3), 1]);
            let speed = r.whole(0, 4);
            b.add(at, size, moving(0, speed));
        }
    }
}

/// A row of boxes and a wall, touching, with gaps of the lattice or of nanometres; in some scenes with a heavy box, a
/// second wall or gravity.
fn row(b: &mut Lattice) {
    let r = &mut b.random;
    let (count, gaps) = (r.whole(2, 9), r.below(5));
    let (nanometre_gaps, lattice_gaps) = (if gaps >= 3 && b.scene.is_dyadic { gaps } else { 0 }, gaps == 2);
    let speed = -r.whole(1, 4);
    match r.below(100) {
        0..70 => {
            let drift = r.pick(&[0, 0, 0, 1, -1]);
            b.add([-3, -2], [2, 5], moving(drift, 0).infinite());
        }
        70..85 => {
            let mass = r.pick(&[1000.0, 100.0, 1e6]);
            b.add([-3, -1], [2, 3], still().heavy(mass));
        }
        _ => {}
    }
    if b.random.chance(30) {
        b.add([-4, 2], [40, 1], still().infinite());
        b.gravity(100, 0);
    }
    let (mut x, mut nanometres) = (b.random.pick(&[-1, 0, 1, 2]), 0.0);
    for index in 0..count {
        let r = &mut b.random;
        let width = if r.chance(80) { 1 } else { 2 };
        let (y, height) = if r.chance(70) { (0, 2) } else { (1, 1) };
        let is_heavy = index == count - 1 && r.chance(40);
        let velocity = if is_heavy || r.chance(85) { speed } else { r.whole(-3, 2) };
        let heavy = r.pick(&[100.0, 1e4, 7.0]);
        let motion = moving(velocity, 0);
        if b.add([x, y], [width, height], if is_heavy { motion.heavy(heavy) } else { motion }) {
            b.cells.last_mut().expect("the box just added").nanometres = nanometres;
        }
        x += width + if lattice_gaps { b.random.pick(&[0, 0, 1]) } else { 0 };
        if nanometre_gaps == 3 || nanometre_gaps == 4 && b.random.chance(50) {
            nanometres += 1.0;
        }
    }
    if b.random.chance(25) {
        let gap = b.random.whole(2, 4);
        b.add([x + gap, -2], [2, 5], still().infinite());
    }
    b.scene.is_dyadic &= nanometres == 0.0;
}

/// A column of boxes that falls on a floor, touching or with gaps; some rest at the start.
fn column(b: &mut Lattice) {
    b.gravity(85, 0);
    let falls = b.scene.gravity[1] != 0.0;
    let drift = b.random.pick(&[0, 0, 0, 0, -1, 1]);
    b.add([-3, 10], [10, 1], moving(0, drift).infinite());
    let r = &mut b.random;
    let mut y = if r.chance(30) { 10 } else { 10 - r.whole(1, 3) };
    let speed = if falls { r.whole(0, 3) } else { r.whole(1, 3) };
    for _ in 0..r.whole(2, 8) {
        let r = &mut b.random;
        let (x, width, height) = (r.pick(&[0, 0, 1]), r.pick(&[2, 2, 3]), r.whole(1, 2));
        let velocity = [r.pick(&[0, 0, 0, 1]), if r.chance(80) { speed } else { 0 }];
        let gap = r.pick(&[0, 0, 0, 1]);
        b.add([x, y - height], [width, height], moving(velocity[0], velocity[1]));
        y -= height + gap;
    }
    if b.random.chance(30) {
        let r = &mut b.random;
        let (x, speed, mass) = (r.pick(&[-1, 0, 1]), r.whole(0, 4), r.pick(&[1.0, 100.0, 1e4]));
        b.add([x, y - 6], [2, 1], moving(0, speed).heavy(mass));
    }
}

/// Blocks of touching boxes thrown at walls and at each other.
fn blocks(b: &mut Lattice) {
    b.gravity(30, 15);
    b.add([-6, -6], [1, 16], still().infinite());
    b.add([-5, 9], [22, 1], still().infinite());
    if b.random.chance(50) {
        b.add([16, -6], [1, 15], still().infinite());
    }
    let mut left = 8;
    for _ in 0..b.random.whole(1, 3) {
        let r = &mut b.random;
        let corner = [r.whole(-5, 12), r.whole(-4, 6)];
        let [x, y] = r.pick(&[[-2, 0], [2, 0], [0, 2], [-2, 2], [2, 1], [-1, 1], [0, 0], [-3, -3]]);
        for i in 0..r.whole(1, 3) {
            for j in 0..b.random.whole(1, 2) {
                let is_there = left > 0 && b.random.chance(90);
                left -= i64::from(is_there && b.add([corner[0] + i, corner[1] + j], [1, 1], moving(x, y)));
            }
        }
    }
}

/// Boxes that slide over flush tiles of many widths, with starts and ends of contact at seams.
fn seams(b: &mut Lattice) {
    let is_pulled = b.random.chance(75);
    b.gravity(if is_pulled { 100 } else { 0 }, 10);
    let widths: &[i64] = match b.random.below(6) {
        0 => &[1],
        1 => &[2],
        2 => &[1, 2],
        3 => &[1, 2, 3],
        4 => &[3, 4],
        _ => &[1, 5],
    };
    let (mut end, mut edges, mut tiles) = (0, vec![0], Vec::new());
    for _ in 0..b.random.whole(2, 6) {
        let width = b.random.pick(widths);
        tiles.push((end, width));
        end += width;
        edges.push(end);
    }
    let is_floating = b.random.chance(10);
    let ceiling = b.random.chance(15).then(|| b.random.pick(&[4, 5]));
    for (x, width) in tiles {
        let height = b.random.pick(&[1, 1, 2]);
        b.add([x, 8], [width, height], still().heavy(if is_floating { 1e6 } else { INFINITE }));
        if let Some(y) = ceiling {
            b.add([x, y], [width, 1], still().infinite());
        }
    }
    if is_floating {
        b.add([-2, 10], [end + 4, 1], still().infinite());
    }
    if b.random.chance(30) {
        let at = [b.random.pick(&[-1, end]), b.random.pick(&[6, 7])];
        b.add(at, [1, 2], still().infinite());
    }
    for _ in 0..b.random.whole(1, 3) {
        let r = &mut b.random;
        let edge = r.pick(&edges[1..]);
        let width = [1, 2, 3, edge, r.pick(widths)][r.below(5) as usize];
        let (height, above) = (r.whole(1, 2), r.pick(&[0, 0, 0, 1, 2]));
        let force = [r.pick(&[0.0, 0.0, 0.0, 1.0, -1.0, 2.0]), if is_pulled { 0.0 } else { 8.0 }];
        let x = if r.chance(80) { r.pick(&edges) } else { r.whole(-1, end) };
        let speed = r.pick(&[1, 2, -1, -2, 4, 0, 3]);
        b.add([x, 8 - height - above], [if width > 6 { 6 } else { width }, height], moving(speed, 0).pushed(force));
    }
    if b.random.chance(30) {
        let r = &mut b.random;
        let (at, size, speed) = ([r.whole(0, end), r.whole(2, 5)], [r.whole(1, 2), 1], r.whole(-2, 2));
        b.add(at, size, moving(speed, 0));
    }
}

/// Boxes on, above and below infinite masses that move.
fn platform(b: &mut Lattice) {
    b.gravity(80, 0);
    for _ in 0..b.random.whole(1, 3) {
        let r = &mut b.random;
        let drift = r.pick(&[[0, -1], [0, 1], [1, 0], [-1, 0], [0, -3], [2, -1], [0, 0], [1, 1]]);
        let (x, y) = (r.whole(-2, 6), if r.chance(60) { 8 } else { r.whole(4, 9) });
        let width = r.whole(3, 8);
        if !b.add([x, y], [width, 1], moving(drift[0], drift[1]).infinite()) {
            continue;
        }
        for _ in 0..b.random.whole(1, 3) {
            let r = &mut b.random;
            let (width, height) = (r.whole(1, 3), r.whole(1, 2));
            let (above, beside) = (r.pick(&[0, 0, 0, 1, 2]), r.whole(-1, 6));
            let falls = if r.chance(50) { r.whole(-2, 2) } else { drift[1] };
            let velocity = if r.chance(50) { drift } else { [r.whole(-2, 2), falls] };
            let force = b.some_force(15);
            let at = [x + beside, y - height - above];
            b.add(at, [width, height], moving(velocity[0], velocity[1]).pushed(force));
        }
    }
    for _ in 0..b.random.whole(0, 2) {
        let r = &mut b.random;
        let (at, size) = ([r.whole(-3, 8), r.whole(0, 3)], [r.whole(1, 2), 1]);
        let velocity = [r.whole(-2, 2), r.whole(0, 2)];
        b.add(at, size, moving(velocity[0], velocity[1]));
    }
}

/// Boxes that fall into a pit.
fn heap(b: &mut Lattice) {
    b.gravity(100, 20);
    let width = b.random.whole(4, 9);
    b.add([-1, 10], [width + 2, 1], still().infinite());
    b.add([-1, -8], [1, 18], still().infinite());
    b.add([width, -8], [1, 18], still().infinite());
    for _ in 0..b.random.whole(3, 8) {
        let r = &mut b.random;
        let size = [r.whole(1, 3), if r.chance(90) { r.whole(1, 2) } else { 3 }];
        let at = [r.whole(0, width - size[0]), r.whole(-4, 9)];
        let velocity = if r.chance(60) { [r.whole(-2, 2), r.whole(-1, 2)] } else { [0, 0] };
        let force = b.some_force(8);
        b.add(at, size, moving(velocity[0], velocity[1]).pushed(force));
    }
}

/// Boxes whose corners meet exactly, with equal and unequal approaches, and neighbours that touch.
fn corner(b: &mut Lattice) {
    b.gravity(20, 15);
    for _ in 0..b.random.whole(1, 3) {
        let r = &mut b.random;
        let (x, y, width, height) = (r.whole(-6, 12), r.whole(-6, 8), r.whole(1, 2), r.whole(1, 2));
        let velocity = r.pick(&[[1, 1], [1, 2], [2, 1], [3, 1], [2, 2], [1, 3]]);
        let (time, sign, other) = (r.whole(0, 2), [r.pick(&[-1, 1]), r.pick(&[-1, 1])], [r.whole(1, 2), r.whole(1, 2)]);
        let is_infinite = r.chance(30);
        if !b.add([x, y], [width, height], if is_infinite { still().infinite() } else { still() }) {
            continue;
        }
        let far = [x + width, y + height];
        let at = [0, 1]
            .map(|k| if sign[k] > 0 { far[k] + velocity[k] * time } else { [x, y][k] - other[k] - velocity[k] * time });
        let approach = moving(-sign[0] * velocity[0], -sign[1] * velocity[1]);
        let force = b.some_force(10);
        b.add(at, other, approach.pushed(force));
        if b.random.chance(40) {
            let offset = b.random.pick(&[-1, 0, 1]);
            let is_infinite = is_infinite && b.random.chance(50);
            b.add([x + width, y + offset], [1, height], if is_infinite { still().infinite() } else { still() });
        }
        if b.random.chance(40) {
            b.add([at[0], if sign[1] > 0 { at[1] - 1 } else { at[1] + other[1] }], [other[0], 1], approach);
        }
    }
    for _ in 0..b.random.whole(0, 2) {
        let r = &mut b.random;
        let (at, velocity) = ([r.whole(-6, 12), r.whole(-6, 8)], [r.whole(-2, 2), r.whole(-2, 2)]);
        b.add(at, [1, 1], moving(velocity[0], velocity[1]));
    }
}

/// Boxes that touch at faces and corners, most of them at rest, and are pressed by forces.
fn pressed(b: &mut Lattice) {
    b.gravity(25, 30);
    let pattern = b.random.pick(&["chess", "random", "random", "steps"]);
    let (forces, infinite) = (b.random.pick(&[40, 80, 100]), b.random.pick(&[0, 15, 30]));
    let is_moving = b.random.chance(30);
    let mut places: Vec<[i64; 2]> = (0..16).map(|n| [n / 4, n % 4]).collect();
    places.retain(|[x, y]| match pattern {
        "chess" => (x + y) % 2 == 0 || b.random.chance(15),
        "steps" => x == y || (x - y).abs() == 1 && b.random.chance(20),
        _ => true,
    });
    b.random.shuffle(&mut places);
    places.truncate(b.random.whole(2, 9) as usize);
    for at in places {
        let r = &mut b.random;
        let size = if pattern != "random" || r.chance(60) { [1, 1] } else { [r.whole(1, 2), r.whole(1, 2)] };
        let velocity = if is_moving && r.chance(30) { [r.whole(-1, 1), r.whole(-1, 1)] } else { [0, 0] };
        let force = b.some_force(forces);
        let is_infinite = b.random.chance(infinite);
        let motion = if is_infinite { still().infinite() } else { moving(velocity[0], velocity[1]) };
        b.add(at, size, motion.pushed(force));
    }
}

/// Infinite or heavy masses that approach each other, and light boxes between them.
fn squeeze(b: &mut Lattice) {
    b.gravity(20, 0);
    let (length, is_moving) = (b.random.whole(3, 9), b.random.chance(60));
    let heavy = b.random.pick(&[50.0, 1000.0, 1e4]);
    for (x, sign) in [(-2, 1), (length, -1)] {
        let speed = if is_moving { sign * b.random.whole(0, 2) } else { 0 };
        if b.random.chance(70) {
            b.add([x, 0], [2, 4], moving(speed, 0).infinite());
        } else {
            b.add([x, 0], [2, 4], moving(if speed == 0 { sign } else { speed }, 0).heavy(heavy));
        }
    }
    for _ in 0..b.random.whole(1, 6) {
        let r = &mut b.random;
        let width = r.whole(1, 2);
        let at = [r.whole(0, length - width), r.pick(&[0, 1, 2, 3, -1])];
        let (height, speed) = (r.pick(&[1, 1, 2]), r.pick(&[0, 0, 1, -1]));
        b.add(at, [width, height], moving(speed, 0));
    }
    if b.random.chance(40) {
        b.add([-4, 4], [length + 8, 1], still().infinite());
        b.gravity(50, 0);
    }
}

/// Towers, heaps, grids and seams with spawns and deletes in motion.
fn churn(b: &mut Lattice) {
    b.random.pick::<fn(&mut Lattice)>(&[tower, heap, grid, seams])(b);
    for _ in 0..b.random.whole(1, 3) {
        let (index, step) = (b.random.below(b.cells.len() as u64) as usize, b.some_step());
        b.cells[index].delete = Some(step);
    }
    for _ in 0..b.random.whole(0, 2) {
        let step = b.some_step();
        let r = &mut b.random;
        let y = [-14, -12, r.whole(-10, 9)][r.below(3) as usize];
        let (at, size, velocity) = ([r.whole(-2, 8), y], [r.whole(1, 3), 1], [r.whole(-1, 1), r.whole(-1, 3)]);
        b.add(at, size, Motion { step, ..moving(velocity[0], velocity[1]) });
    }
}

/// Boxes that are pressed or supported, and turn exactly at an edge or reach it with no speed to spare.
fn graze(b: &mut Lattice) {
    b.unit = if b.scene.is_dyadic { [1, 4] } else { [1, 5] };
    b.speed = [1, 2];
    let r = &mut b.random;
    let (speed, distance) = (r.whole(1, 4), r.pick(&[1, 2, 4]));
    // v²/2a is the distance to the turning point.
    let (v, metres) = (speed as f64 / 2.0, (distance * b.unit[0]) as f64 / b.unit[1] as f64);
    let strength = v * v / (2.0 * metres);
    let overlap = r.pick(&[distance, distance, distance, distance + 1]);
    if r.chance(50) {
        b.gravity(100, 0);
        b.add([0, 4], [4, 2], still().infinite());
        if b.random.chance(40) {
            b.add([-4, 4], [4, 2], still().infinite());
        }
        let slides = moving(speed, 0).heavy(1.0).pushed([-strength, 0.0]);
        b.add([4 - overlap, 0], [4, 4], slides);
        if b.random.chance(40) {
            let width = b.random.pick(&[2, 4]);
            b.add([4 - overlap, -2], [width, 2], slides);
        }
    } else {
        b.scene.gravity = [0.0, strength];
        b.add([0, 4], [2, 4], still().infinite());
        let (press, next) = (b.random.pick(&[0.0, 1.0, 1.0, 3.0]), b.random.pick(&[0.0, 1.0]));
        b.add([2, overlap], [2, 4], moving(0, -speed).heavy(1.0).pushed([-press, 0.0]));
        if b.random.chance(30) {
            let height = b.random.pick(&[2, 4]);
            b.add([4, overlap], [2, height], moving(0, -speed).heavy(1.0).pushed([-next, 0.0]));
        }
    }
    for _ in 0..b.random.whole(0, 3) {
        let r = &mut b.random;
        let (at, size) = ([r.whole(-6, 10), r.whole(-6, 10)], [r.whole(1, 3), r.whole(1, 3)]);
        let motion = if r.chance(40) { still().infinite() } else { still() };
        b.add(at, size, motion);
    }
}

/// A few boxes in a room, in general position at e = 1.
fn gas(b: &mut Lattice) {
    (b.unit, b.speed) = ([1, 1], [1, 1]);
    (b.scene.restitution, b.scene.pairs) = (1.0, Vec::new());
    for (at, size) in [([-1, -1], [10, 1]), ([-1, 6], [10, 1]), ([-1, 0], [1, 6]), ([8, 0], [1, 6])] {
        b.add(at, size, still().infinite());
    }
    let walls: Vec<_> = b.cells.iter().map(|cell| (cell.at.map(|n| n as f64), cell.size.map(|n| n as f64))).collect();
    walls.iter().zip(&mut b.cells).for_each(|((at, size), cell)| cell.exact = Some([*at, *size, [0.0; 2]]));
    if b.random.chance(50) {
        b.scene.gravity = [b.random.between(-2.0, 2.0), b.random.between(0.0, 9.0)];
    }
    for _ in 0..b.random.whole(2, 6) {
        let r = &mut b.random;
        let size = [r.between(0.3, 1.5), r.between(0.3, 1.5)];
        let at = [r.between(0.1, 7.9 - size[0]), r.between(0.1, 5.9 - size[1])];
        let exact = Some([at, size, [r.between(-3.0, 3.0), r.between(-3.0, 3.0)]]);
        let force = if r.chance(30) { [r.between(-3.0, 3.0), r.between(-3.0, 3.0)] } else { [0.0; 2] };
        let mass = r.pick(&[1.0, 1.0, 0.3, 5.0]);
        let overlaps = |other: &Cell| {
            let [corner, extent, _] = other.exact.expect("all boxes of a gas are in general position");
            (0..2).all(|k| at[k] < corner[k] + extent[k] && corner[k] < at[k] + size[k])
        };
        if !b.cells.iter().any(overlaps) {
            let cell = [0; 2];
            b.cells.push(Cell {
                at: cell,
                size: cell,
                mass,
                velocity: cell,
                force,
                step: 0,
                delete: None,
                nanometres: 0.0,
                material: "",
                exact,
            });
        }
    }
}
