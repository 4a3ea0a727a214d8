//! A lattice of whole units, on which faces are flush and events coincide.

use super::{
    random::{COEFFICIENTS, Random},
    scene::{Scene, SceneBody},
};
use crate::world_builder::{INFINITE, spec};

/// A box in whole units, with its velocity in whole units of speed.
pub struct Cell {
    pub at: [i64; 2],
    pub size: [i64; 2],
    pub mass: f64,
    pub velocity: [i64; 2],
    pub force: [f64; 2],
    pub step: u64,
    /// The step at which it is deleted.
    pub delete: Option<u64>,
    /// Added to the position along x, m.
    pub nanometres: f64,
    pub material: &'static str,
    /// Replaces the position, size and velocity, for boxes in general position.
    pub exact: Option<[[f64; 2]; 3]>,
}

/// Collects boxes in whole units and refuses those that overlap at step 0.
pub struct Lattice {
    pub random: Random,
    pub scene: Scene,
    pub cells: Vec<Cell>,
    /// Length and speed of a unit as fractions, m and m/s.
    pub unit: [i64; 2],
    pub speed: [i64; 2],
    pub masses: &'static [f64],
    pub materials: &'static [&'static str],
}

/// Velocity, mass, force and step of a box to be added.
#[derive(Clone, Copy, Default)]
pub struct Motion {
    pub velocity: [i64; 2],
    pub force: [f64; 2],
    /// `None` for a random one.
    pub mass: Option<f64>,
    pub step: u64,
}

pub fn still() -> Motion {
    Motion::default()
}

pub fn moving(x: i64, y: i64) -> Motion {
    Motion { velocity: [x, y], ..Motion::default() }
}

impl Motion {
    pub fn heavy(self, mass: f64) -> Motion {
        Motion { mass: Some(mass), ..self }
    }

    pub fn infinite(self) -> Motion {
        self.heavy(INFINITE)
    }

    pub fn pushed(self, force: [f64; 2]) -> Motion {
        Motion { force, ..self }
    }
}

impl Lattice {
    pub fn new(kind: &'static str, seed: u64) -> Lattice {
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
    pub fn add(&mut self, at: [i64; 2], size: [i64; 2], motion: Motion) -> bool {
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

    pub fn gravity(&mut self, percent: u64, percent_sideways: u64) {
        if self.random.chance(percent) {
            let down = self.random.pick(&[8.0, 10.0, 9.8125, 9.81, 2.0]);
            let sideways = self.random.chance(percent_sideways);
            let x = if sideways { self.random.pick(&[-1.0, 1.0, 3.0]) } else { 0.0 };
            self.scene.gravity = [x, down];
        }
    }

    /// A random force, in some cases along one axis only.
    pub fn some_force(&mut self, percent: u64) -> [f64; 2] {
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
    pub fn some_step(&mut self) -> u64 {
        1 + self.random.below(self.scene.steps * 3 / 4)
    }

    /// Turns, mirrors and shuffles the scene, and moves the boxes of some by an ulp.
    pub fn finish(mut self) -> Scene {
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
