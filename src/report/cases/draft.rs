use crate::report::{Case, Truth, truth::Number};

/// A case being written: its scene as text, and the rest with defaults.
pub struct Draft {
    /// Cases of one family share a diagram.
    pub family: &'static str,
    /// What the table calls it.
    pub name: String,
    /// m.
    pub world: [f64; 2],
    /// Whether there are the handout's four walls.
    pub walls: bool,
    /// m/s², downwards; 0 for none.
    pub gravity: f64,
    /// For all pairs of bodies.
    pub restitution: f64,
    /// The lowest rate, Hz.
    pub rate: f64,
    /// Steps at that rate.
    pub steps: u64,
    /// Rates, as whole numbers of times the lowest.
    pub factors: &'static [u64],
    /// The first step that is measured.
    pub from: u64,
    /// `[[spawn]]`, `[[scatter]]` and `[[delete]]` tables.
    pub bodies: String,
    /// Where bodies are to be.
    pub truth: Truth,
    /// How many collisions there are.
    pub collisions: Option<u64>,
}

/// 30, 60, 240 and 960 Hz.
pub const RATES: &[u64] = &[1, 2, 8, 32];

/// What most falls in these scenes fall with, m/s².
pub const GRAVITY: f64 = 9.81;

impl Draft {
    /// A case of ten seconds at 30, 60, 240 and 960 Hz, e = 1, without gravity or walls.
    pub fn new(family: &'static str, name: &str, bodies: String) -> Draft {
        Draft {
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
            truth: Truth::Reference,
            collisions: None,
        }
    }

    /// The case.
    pub fn case(self) -> Case {
        let Draft { family, name, world, walls, gravity, restitution, rate, steps, .. } = self;
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
            truth: self.truth,
            collisions: self.collisions,
        }
    }
}

/// A formula for the positions of the finite masses.
pub fn closed_form(places: impl Fn(&Number) -> Vec<[Number; 2]> + 'static) -> Truth {
    Truth::ClosedForm(Box::new(places))
}

/// A box: upper-left corner and size, m, mass, kg, and velocity, m/s.
pub fn spawn(at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2]) -> String {
    format!("[[spawn]]\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\nvelocity = {velocity:?}\n")
}

/// A box that nothing pushes.
pub fn block(at: [f64; 2], size: [f64; 2]) -> String {
    spawn(at, size, f64::INFINITY, [0.0; 2])
}

/// Names the last of some bodies.
pub fn named(name: &str, spawn: &str) -> String {
    format!("{spawn}name = \"{name}\"\n")
}
