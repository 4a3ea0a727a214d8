use crate::report::{Case, Oracle, oracle::Fixed256};

/// The specification of a case: the bodies as TOML, everything else with defaults.
pub struct CaseSpec {
    /// Cases of one family share a diagram.
    pub family: &'static str,
    /// The name in the table.
    pub name: String,
    /// Size of the world, m.
    pub world: [f64; 2],
    /// True for the handout's four walls.
    pub walls: bool,
    /// Downward acceleration, m/s²; 0 for none.
    pub gravity: f64,
    /// Restitution coefficient of all pairs of bodies.
    pub restitution: f64,
    /// The lowest rate, Hz.
    pub rate: f64,
    /// Number of steps at the lowest rate.
    pub steps: u64,
    /// The rates of the runs, as integer multiples of the lowest rate.
    pub factors: &'static [u64],
    /// The first measured step.
    pub from: u64,
    /// `[[spawn]]`, `[[scatter]]` and `[[delete]]` tables.
    pub bodies: String,
    /// The source of the correct positions.
    pub oracle: Oracle,
    /// The correct number of collisions, if it is known.
    pub collisions: Option<u64>,
}

/// 30, 60, 240 and 960 Hz.
pub const RATES: &[u64] = &[1, 2, 8, 32];

/// The gravity of most scenes, m/s².
pub const GRAVITY: f64 = 9.81;

impl CaseSpec {
    /// A case of ten seconds at 30, 60, 240 and 960 Hz, e = 1, without gravity or walls.
    pub fn new(family: &'static str, name: &str, bodies: String) -> CaseSpec {
        CaseSpec {
            family,
            name: name.into(),
            world: [16.0, 9.0],
            walls: false,
            gravity: 0.0,
            restitution: 1.0,
            rate: 30.0,
            steps: 300,
            factors: RATES,
            from: 0,
            bodies,
            oracle: Oracle::Simulation,
            collisions: None,
        }
    }

    /// Builds the case.
    pub fn build(self) -> Case {
        let CaseSpec { family, name, world, walls, gravity, restitution, rate, steps, .. } = self;
        let gravity = if gravity == 0.0 { String::new() } else { format!("gravity = [0.0, {gravity:?}]\n") };
        let text = format!(
            "title = \"{name}\"\n[world]\nsize = {world:?}\nwalls = {walls}\n{gravity}[run]\nrate = {rate:?}\nsteps = {steps}\n\
             solver = \"event-driven\"\nevents_per_step = 1000000000000\n[restitution]\ndefault = {restitution:?}\n{}",
            self.bodies
        );
        Case {
            family: family.into(),
            name,
            text,
            rate,
            steps,
            factors: self.factors.to_vec(),
            from: self.from,
            oracle: self.oracle,
            collisions: self.collisions,
        }
    }
}

/// An oracle with a formula for the positions of the finite masses.
pub fn closed_form(positions: impl Fn(&Fixed256) -> Vec<[Fixed256; 2]> + 'static) -> Oracle {
    Oracle::ClosedForm(Box::new(positions))
}

/// A `[[spawn]]` table: upper-left corner and size (m), mass (kg) and velocity (m/s).
pub fn spawn(at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2]) -> String {
    format!("[[spawn]]\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\nvelocity = {velocity:?}\n")
}

/// A `[[spawn]]` table of a static box.
pub fn static_block(at: [f64; 2], size: [f64; 2]) -> String {
    spawn(at, size, f64::INFINITY, [0.0; 2])
}

/// Adds a name to the last `[[spawn]]` table of `spawn`.
pub fn named(name: &str, spawn: &str) -> String {
    format!("{spawn}name = \"{name}\"\n")
}
