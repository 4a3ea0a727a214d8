use super::case::{Case, Oracle, RunSpec, SceneRunner};
use super::expectation::Expectation;
use super::oracle::Fixed256;
use crate::physics::{BodyId, Collision, Observer, StepError, Vector, World, invariants};
use crate::run::RunError;
use crate::scene::Scene;

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

/// Worlds with more bodies are tested for overlaps only at every tenth compared step.
const OVERLAP_TEST_BODIES: usize = 2000;

impl Errors {
    /// Runs a case and compares it with its expectation.
    ///
    /// # Errors
    /// Returns an error if an input of the scene is invalid.
    pub fn measure(case: &Case, scene: &Scene, spec: RunSpec, expectation: &Expectation) -> Result<Errors, RunError> {
        let mut runner = SceneRunner::new(scene);
        runner.apply_inputs()?;
        let mut totals = CollisionTotals::new(runner.world());
        let mut errors = Errors::default();
        let mut balance = None;
        let mut start = Vec::new();
        for (number, step) in case.sample_steps().enumerate() {
            if let Err(error) = runner.advance_to(step * spec.factor, &mut totals)? {
                errors.end = Some(error);
                break;
            }
            let world = runner.world();
            if number == 0 {
                start = positions(world).collect();
            }
            if step * spec.factor >= last_input(scene) {
                balance.get_or_insert_with(|| Balance::new(world, scene, &totals)).update(world, &totals);
            }
            let moved = match (&case.oracle, &expectation.positions) {
                (Oracle::Rest, _) => {
                    Some(distance(positions(world), start.iter().map(|position| position.map(Fixed256::from))))
                }
                (_, Some(expected)) => Some(distance(positions(world), expected[number].iter().cloned())),
                (_, None) => None,
            };
            errors.position = larger(errors.position, moved);
            if world.bodies.len() < OVERLAP_TEST_BODIES || number % 10 == 0 {
                errors.overlap =
                    larger(Some(errors.overlap), Some(invariants::worst_overlap(world))).unwrap_or_default();
            }
        }
        let balance = balance.unwrap_or_default();
        Ok(Errors { energy: balance.energy, momentum: balance.momentum, collisions: totals.collisions, ..errors })
    }
}

/// The step of the last input of the scene.
fn last_input(scene: &Scene) -> u64 {
    scene.inputs.last().map_or(0, |input| input.step)
}

fn positions(world: &World) -> impl Iterator<Item = [f64; 2]> {
    world.bodies.iter().filter(|body| !body.is_infinite()).map(|body| [body.rect.origin.x, body.rect.origin.y])
}

/// Returns the greatest distance between found and expected positions along an axis, m.
fn distance(found: impl Iterator<Item = [f64; 2]>, expected: impl Iterator<Item = [Fixed256; 2]>) -> f64 {
    let pairs = found.zip(expected).flat_map(|(found, expected)| found.into_iter().zip(expected));
    let greatest = pairs.map(|(found, expected)| (&Fixed256::from(found) - &expected).abs()).max();
    greatest.map_or(0.0, |distance| distance.to_f64())
}

fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b > a { b } else { a }),
        (a, b) => a.or(b),
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
#[derive(Default)]
struct Balance {
    has_potential: bool,
    elastic: bool,
    /// The energy and the momentum to which errors are relative; `None` if it is not conserved.
    scales: [Option<f64>; 2],
    /// Total energy at the start, J.
    first: f64,
    /// Least total energy so far, J.
    lowest: f64,
    /// Momentum at the start minus the impulses given by infinite masses, kg·m/s.
    momentum_first: Vector,
    energy: Option<f64>,
    momentum: Option<f64>,
}

impl Balance {
    fn new(world: &World, scene: &Scene, totals: &CollisionTotals) -> Balance {
        let finite = || world.bodies.iter().filter(|body| !body.is_infinite());
        let gravity = world.gravity.unwrap_or(Vector::ZERO);
        let weight = |body: &crate::physics::Body| gravity.mult(body.mass).add(body.constant_force).norm();
        let pull: f64 = finite().map(weight).sum();
        let has_moving_wall = world.bodies.iter().any(|body| body.is_infinite() && body.can_move());
        let energy = invariants::kinetic_energy(world) + pull * scene.size[1];
        let momentum: f64 = finite().map(|body| body.mass * body.velocity.norm()).sum();
        let mut balance = Balance {
            has_potential: pull > 0.0,
            elastic: is_elastic(world),
            scales: [Some(energy).filter(|_| !has_moving_wall), Some(momentum).filter(|_| pull == 0.0)],
            ..Balance::default()
        };
        balance.first = balance.total(world);
        balance.lowest = balance.first;
        balance.momentum_first = invariants::momentum(world).sub(totals.impulse);
        balance
    }

    fn total(&self, world: &World) -> f64 {
        let potential = if self.has_potential { invariants::potential_energy(world) } else { 0.0 };
        invariants::kinetic_energy(world) + potential
    }

    fn update(&mut self, world: &World, totals: &CollisionTotals) {
        let total = self.total(world);
        let change = if self.elastic { (total - self.first).abs() } else { total - self.lowest };
        if total < self.lowest {
            self.lowest = total;
        }
        let drift = invariants::momentum(world).sub(totals.impulse).sub(self.momentum_first).norm();
        let relative = |change: f64, scale: Option<f64>| scale.filter(|&scale| scale > 0.0).map(|scale| change / scale);
        let [energy, momentum] = self.scales;
        // Only a gain counts; rounding may also lower the energy.
        let gained = relative(if change > 0.0 { change } else { 0.0 }, energy);
        self.energy = larger(self.energy, gained);
        self.momentum = larger(self.momentum, relative(drift, momentum));
    }
}

/// Returns true if e = 1 for all pairs of materials in the world.
fn is_elastic(world: &World) -> bool {
    let mut materials = Vec::new();
    for body in &world.bodies {
        if !materials.contains(&body.material) {
            materials.push(body.material);
        }
    }
    let pairs = materials.iter().flat_map(|a| materials.iter().map(move |b| (*a, *b)));
    pairs.into_iter().all(|(a, b)| world.restitution.between(a, b) == 1.0)
}
