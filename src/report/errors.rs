use super::case::{Case, RunSpec, SceneRunner};
use super::oracle::{Expectation, Fixed256, Oracle};
use crate::physics::{Accuracy, AccuracyProbe, Body, BodyId, Collision, Observer, StepError, Vector, World};
use crate::replay::{Run, RunError};
use crate::scene::Scene;
use crate::text::counted;

/// The errors of one run. Deterministic: they do not depend on a clock.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Errors {
    /// Greatest distance along an axis of any body from its correct position, over all compared
    /// steps, m. `None` if the correct positions are unknown.
    pub position: Option<f64>,
    /// Energy gained (at e = 1 also lost), relative to the initial kinetic energy plus the weight of
    /// the bodies times the height of the world.
    pub energy: Option<f64>,
    /// Change of momentum that no collision with an infinite mass explains, relative to the sum of all
    /// m·|v|.
    pub momentum: Option<f64>,
    /// Deepest overlap over all compared steps, m.
    pub overlap: f64,
    /// Number of collisions with an impulse.
    pub collisions: u64,
    /// The error in which the run ended.
    pub end: Option<StepError>,
}

/// The growth of rounding errors in a run of the event-driven solver, estimated by random rounding. Any scene has one,
/// with resting contacts and later inputs, too.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// The part of the run that is accurate to 1e-10.
    pub accuracy: Accuracy,
    /// Pairs of an error, as a fraction of the largest side of a finite body, and the first step at which it is
    /// exceeded.
    pub steps: Vec<(f64, u64)>,
}

impl Growth {
    /// Runs a scene up to its end or its error; `None` with the handout solver.
    ///
    /// # Errors
    /// Returns an error if an input of the scene is invalid.
    pub fn estimate(scene: &Scene) -> Result<Option<Growth>, RunError> {
        let mut run = Run::new(scene);
        let Some(mut probe) = AccuracyProbe::new(run.engine()) else { return Ok(None) };
        loop {
            for event in run.apply_inputs(Vec::new(), |error| Err(error.into()))? {
                probe.apply(&event.change.event());
            }
            if run.engine().current_step() == scene.run.steps {
                break;
            }
            let stepped = run.step(&mut probe);
            probe.follow(run.engine());
            if stepped.is_err() {
                break;
            }
        }
        Ok(Some(Growth { accuracy: probe.accuracy(), steps: probe.growth().collect() }))
    }
}

/// Worlds with more bodies are tested for overlaps only at every tenth compared step.
const OVERLAP_TEST_BODIES: usize = 2000;

/// Errors below this fraction of the smallest side, or of the energy, are not mentioned in the remark.
const NEGLIGIBLE: f64 = 0.01;

impl Errors {
    /// Runs a case and compares it with its expectation.
    ///
    /// # Errors
    /// Returns an error if an input of the scene is invalid.
    pub fn measure(case: &Case, scene: &Scene, spec: RunSpec, expectation: &Expectation) -> Result<Errors, RunError> {
        let mut runner = SceneRunner::start(scene)?;
        let mut totals = CollisionTotals::new(runner.world());
        let mut errors = Errors::default();
        let mut balance: Option<Balance> = None;
        let mut start = Vec::new();
        let last_input = scene.inputs.last().map_or(0, |input| input.step);
        for (number, step) in case.sample_steps().enumerate() {
            if let Err(error) = runner.advance_to(step * spec.factor, &mut totals)? {
                errors.end = Some(error);
                break;
            }
            let world = runner.world();
            if number == 0 {
                start = positions(world).map(|position| position.map(Fixed256::from)).collect();
            }
            let expected = match &case.oracle {
                Oracle::Rest => Some(&start),
                _ => expectation.positions.as_ref().map(|expected| &expected[number]),
            };
            errors.position = larger(errors.position, expected.map(|expected| greatest_distance(world, expected)));
            if world.bodies.len() < OVERLAP_TEST_BODIES || number % 10 == 0 {
                errors.overlap = larger(errors.overlap, world.deepest_overlap());
            }
            // Energy and momentum are conserved from the last input on.
            if step * spec.factor >= last_input {
                balance.get_or_insert_with(|| Balance::new(world, scene, &totals)).update(world, &totals);
            }
        }
        let (energy, momentum) = balance.map_or((None, None), |balance| (balance.energy_error, balance.momentum_error));
        Ok(Errors { energy, momentum, collisions: totals.collisions, ..errors })
    }

    /// Describes the visible errors of a run, or returns `None` if there are none. `collisions` is the correct number
    /// of collisions, `side` the smallest side of all boxes, m.
    pub fn remark(&self, oracle: &Oracle, collisions: Option<u64>, side: f64) -> Option<String> {
        let mut remarks = Vec::new();
        match (&self.end, oracle) {
            (Some(error), Oracle::Error) => return Some(format!("ends in an error, as it must: {error}")),
            (Some(error), _) => return Some(format!("ends in an error: {error}")),
            (None, Oracle::Error) => remarks.push("does not detect that the body is crushed".to_owned()),
            (None, _) => {}
        }
        if let Some(expected) = collisions.filter(|&expected| expected > 0 && self.collisions == 0) {
            remarks.push(format!("passes through: found none of {}", counted(expected, "collision")));
        }
        if self.overlap > NEGLIGIBLE * side {
            remarks.push(format!("boxes overlap by up to {} m", rounded(self.overlap)));
        }
        if let Some(position) = self.position.filter(|&position| position > NEGLIGIBLE * side) {
            remarks.push(format!("positions are wrong by up to {} m", rounded(position)));
        }
        if let Some(energy) = self.energy.filter(|&energy| energy > NEGLIGIBLE) {
            remarks.push(format!("energy is wrong by {} %", rounded(100.0 * energy)));
        }
        (!remarks.is_empty()).then(|| remarks.join(", "))
    }
}

fn positions(world: &World) -> impl Iterator<Item = [f64; 2]> {
    world.bodies.iter().filter(|body| !body.is_infinite()).map(|body| [body.rect.origin.x, body.rect.origin.y])
}

/// Returns the greatest distance of the bodies from their expected positions along an axis, m.
fn greatest_distance(world: &World, expected: &[[Fixed256; 2]]) -> f64 {
    let pairs = positions(world).zip(expected).flat_map(|(found, expected)| found.into_iter().zip(expected));
    let greatest = pairs.map(|(found, expected)| (&Fixed256::from(found) - expected).abs()).max();
    greatest.map_or(0.0, |distance| distance.to_f64())
}

/// The larger of two values; any value is larger than `None`.
fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

fn rounded(value: f64) -> String {
    match value {
        0.001..0.1 => format!("{value:.4}"),
        0.1..10.0 => format!("{value:.2}"),
        10.0..10_000.0 => format!("{value:.0}"),
        _ => format!("{value:.1e}"),
    }
}

/// Counts collisions and sums the impulses that infinite masses give to finite ones.
struct CollisionTotals {
    collisions: u64,
    /// Sum of the impulses given by infinite masses, N·s.
    impulse: Vector,
    infinite: Vec<BodyId>,
}

impl CollisionTotals {
    fn new(world: &World) -> CollisionTotals {
        let infinite = world.bodies.iter().filter(|body| body.is_infinite()).map(|body| body.id);
        CollisionTotals { collisions: 0, impulse: Vector::ZERO, infinite: infinite.collect() }
    }
}

impl Observer for CollisionTotals {
    fn collision(&mut self, collision: &Collision) {
        self.collisions += u64::from(collision.impulse != 0.0);
        let impulse = collision.normal.mult(collision.impulse);
        let [c, b] = collision.bodies.map(|id| self.infinite.binary_search(&id).is_ok());
        match (c, b) {
            (false, true) => self.impulse = self.impulse.add(impulse),
            (true, false) => self.impulse = self.impulse.sub(impulse),
            (true, true) | (false, false) => {}
        }
    }
}

/// Energy and momentum balance of a world without further spawns or deletes.
struct Balance {
    /// Total energy, J. Potential energy counts only where there is a force.
    total_energy: fn(&World) -> f64,
    is_elastic: bool,
    /// Total energy at the start, J.
    first_energy: f64,
    /// Least total energy so far, J.
    lowest_energy: f64,
    /// Momentum at the start minus the impulses given by infinite masses, kg·m/s.
    first_momentum: Vector,
    /// The energy to which errors are relative, J; `None` if energy is not conserved.
    energy_scale: Option<f64>,
    /// The momentum to which errors are relative, kg·m/s; `None` if momentum is not conserved.
    momentum_scale: Option<f64>,
    /// The greatest relative errors so far.
    energy_error: Option<f64>,
    momentum_error: Option<f64>,
}

impl Balance {
    fn new(world: &World, scene: &Scene, totals: &CollisionTotals) -> Balance {
        let finite = || world.bodies.iter().filter(|body| !body.is_infinite());
        let gravity = world.gravity.unwrap_or(Vector::ZERO);
        let weight = |body: &Body| gravity.mult(body.mass).add(body.constant_force).norm();
        let pull: f64 = finite().map(weight).sum();
        let has_moving_wall = world.bodies.iter().any(|body| body.is_infinite() && body.can_move());
        let energy = world.kinetic_energy() + pull * scene.size[1];
        let momentum: f64 = finite().map(|body| body.mass * body.velocity.norm()).sum();
        let total_energy = if pull > 0.0 { mechanical_energy } else { World::kinetic_energy };
        let first_energy = total_energy(world);
        Balance {
            total_energy,
            is_elastic: is_elastic(world),
            first_energy,
            lowest_energy: first_energy,
            first_momentum: world.momentum().sub(totals.impulse),
            energy_scale: Some(energy).filter(|&energy| !has_moving_wall && energy > 0.0),
            momentum_scale: Some(momentum).filter(|&momentum| pull == 0.0 && momentum > 0.0),
            energy_error: None,
            momentum_error: None,
        }
    }

    fn update(&mut self, world: &World, totals: &CollisionTotals) {
        let energy = (self.total_energy)(world);
        let change = if self.is_elastic { (energy - self.first_energy).abs() } else { energy - self.lowest_energy };
        if energy < self.lowest_energy {
            self.lowest_energy = energy;
        }
        // Only a gain counts; rounding may also lower the energy.
        let gain = if change > 0.0 { change } else { 0.0 };
        let drift = world.momentum().sub(totals.impulse).sub(self.first_momentum).norm();
        self.energy_error = larger(self.energy_error, self.energy_scale.map(|scale| gain / scale));
        self.momentum_error = larger(self.momentum_error, self.momentum_scale.map(|scale| drift / scale));
    }
}

fn mechanical_energy(world: &World) -> f64 {
    world.kinetic_energy() + world.potential_energy()
}

/// Returns true if e = 1 for all pairs of materials in the world.
fn is_elastic(world: &World) -> bool {
    let mut materials = Vec::new();
    for body in &world.bodies {
        if !materials.contains(&body.material) {
            materials.push(body.material);
        }
    }
    materials.iter().all(|a| materials.iter().all(|b| world.restitution.between(*a, *b) == 1.0))
}
