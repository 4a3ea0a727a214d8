use super::case::{Case, Course, Trial, Truth};
use super::expectation::Expectation;
use super::truth::Number;
use crate::physics::{BodyId, Collision, Observer, StepError, Vector, World, invariants};
use crate::run::RunError;
use crate::scene::Scene;

/// What one run got wrong. Deterministic: no clock has a part in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Errors {
    /// The greatest distance along an axis of any body from where it should be, at any look, m.
    pub position: Option<f64>,
    /// What energy was gained or, at e = 1, lost, as a part of kinetic energy at the start and
    /// weight times height of the world.
    pub energy: Option<f64>,
    /// Momentum that no collision with an infinite mass gave, as a part of the sum of all m·|v|.
    pub momentum: Option<f64>,
    /// The deepest overlap at any look, m.
    pub overlap: f64,
    /// Collisions that gave an impulse.
    pub collisions: u64,
    /// The error the run ended in.
    pub end: Option<StepError>,
}

/// Worlds larger than this are looked at for overlaps only at every tenth look.
const MANY: usize = 2000;

impl Errors {
    /// Runs a case and compares it with what it is to come to.
    ///
    /// # Errors
    /// When an input of the scene is refused.
    pub fn of(case: &Case, scene: &Scene, trial: Trial, expectation: &Expectation) -> Result<Errors, RunError> {
        let mut course = Course::new(scene);
        course.happen()?;
        let mut tally = Tally::of(course.world());
        let mut errors = Errors::default();
        let mut ledger = None;
        let mut start = Vec::new();
        for (number, look) in case.looks().enumerate() {
            if let Err(error) = course.advance_to(look * trial.factor, &mut tally)? {
                errors.end = Some(error);
                break;
            }
            let world = course.world();
            if number == 0 {
                start = places(world).collect();
            }
            if look * trial.factor >= last_input(scene) {
                ledger.get_or_insert_with(|| Ledger::of(world, scene, &tally)).enter(world, &tally);
            }
            let moved = match (&case.truth, &expectation.places) {
                (Truth::Rest, _) => Some(distance(places(world), start.iter().map(|place| place.map(Number::from)))),
                (_, Some(expected)) => Some(distance(places(world), expected[number].iter().cloned())),
                (_, None) => None,
            };
            errors.position = larger(errors.position, moved);
            if world.bodies.len() < MANY || number % 10 == 0 {
                errors.overlap =
                    larger(Some(errors.overlap), Some(invariants::worst_overlap(world))).unwrap_or_default();
            }
        }
        let ledger = ledger.unwrap_or_default();
        Ok(Errors { energy: ledger.energy, momentum: ledger.momentum, collisions: tally.collisions, ..errors })
    }
}

/// The step of the last change of the scene from outside.
fn last_input(scene: &Scene) -> u64 {
    scene.inputs.last().map_or(0, |input| input.step)
}

fn places(world: &World) -> impl Iterator<Item = [f64; 2]> {
    world.bodies.iter().filter(|body| !body.is_infinite()).map(|body| [body.rect.origin.x, body.rect.origin.y])
}

/// How far bodies are from where they should be, m.
fn distance(found: impl Iterator<Item = [f64; 2]>, expected: impl Iterator<Item = [Number; 2]>) -> f64 {
    let pairs = found.zip(expected).flat_map(|(found, expected)| found.into_iter().zip(expected));
    let greatest = pairs.map(|(found, expected)| (&Number::from(found) - &expected).abs()).max();
    greatest.map_or(0.0, |distance| distance.to_f64())
}

fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b > a { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Counts collisions, and adds up what infinite masses give.
struct Tally {
    collisions: u64,
    /// N·s.
    given: Vector,
    infinite: Vec<BodyId>,
}

impl Tally {
    fn of(world: &World) -> Tally {
        let infinite = world.bodies.iter().filter(|body| body.is_infinite()).map(|body| body.id);
        Tally { collisions: 0, given: Vector::ZERO, infinite: infinite.collect() }
    }
}

impl Observer for Tally {
    fn collision(&mut self, collision: &Collision) {
        self.collisions += u64::from(collision.impulse != 0.0);
        let given = collision.normal.mult(collision.impulse);
        let [c, b] = collision.bodies.map(|id| self.infinite.binary_search(&id).is_ok());
        match (c, b) {
            (false, true) => self.given = self.given.add(given),
            (true, false) => self.given = self.given.sub(given),
            (true, true) | (false, false) => {}
        }
    }
}

/// Energy and momentum of a world whose bodies neither come nor go.
#[derive(Default)]
struct Ledger {
    has_potential: bool,
    elastic: bool,
    /// What a part of energy or momentum is a part of; none where it is not kept.
    scales: [Option<f64>; 2],
    /// J. The first, and the lowest there was.
    first: f64,
    lowest: f64,
    /// kg·m/s, less what infinite masses gave.
    momentum_first: Vector,
    energy: Option<f64>,
    momentum: Option<f64>,
}

impl Ledger {
    fn of(world: &World, scene: &Scene, tally: &Tally) -> Ledger {
        let finite = || world.bodies.iter().filter(|body| !body.is_infinite());
        let gravity = world.gravity.unwrap_or(Vector::ZERO);
        let weight = |body: &crate::physics::Body| gravity.mult(body.mass).add(body.constant_force).norm();
        let pull: f64 = finite().map(weight).sum();
        let worked = world.bodies.iter().any(|body| body.is_infinite() && body.can_move());
        let energy = invariants::kinetic_energy(world) + pull * scene.size[1];
        let momentum: f64 = finite().map(|body| body.mass * body.velocity.norm()).sum();
        let mut ledger = Ledger {
            has_potential: pull > 0.0,
            elastic: is_elastic(world),
            scales: [Some(energy).filter(|_| !worked), Some(momentum).filter(|_| pull == 0.0)],
            ..Ledger::default()
        };
        ledger.first = ledger.total(world);
        ledger.lowest = ledger.first;
        ledger.momentum_first = invariants::momentum(world).sub(tally.given);
        ledger
    }

    fn total(&self, world: &World) -> f64 {
        let potential = if self.has_potential { invariants::potential_energy(world) } else { 0.0 };
        invariants::kinetic_energy(world) + potential
    }

    fn enter(&mut self, world: &World, tally: &Tally) {
        let total = self.total(world);
        let change = if self.elastic { (total - self.first).abs() } else { total - self.lowest };
        if total < self.lowest {
            self.lowest = total;
        }
        let drift = invariants::momentum(world).sub(tally.given).sub(self.momentum_first).norm();
        let part = |change: f64, scale: Option<f64>| scale.filter(|&scale| scale > 0.0).map(|scale| change / scale);
        let [energy, momentum] = self.scales;
        // Rounding may lower as well as raise: what is below zero is no gain.
        let gained = part(if change > 0.0 { change } else { 0.0 }, energy);
        self.energy = larger(self.energy, gained);
        self.momentum = larger(self.momentum, part(drift, momentum));
    }
}

/// Whether no impact takes energy.
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
