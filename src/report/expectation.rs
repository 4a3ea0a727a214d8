use super::case::{Case, Oracle, RunSpec, initial_world};
use super::oracle::{Fixed256, PreciseSimulator};
use crate::physics::SolverKind;

/// The correct result of a case at each compared step.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// For each compared step the positions of the finite masses in creation order, m.
    pub positions: Option<Vec<Vec<[Fixed256; 2]>>>,
    /// Correct number of collisions up to the last compared step.
    pub collisions: Option<u64>,
    /// Source of these values, or the reason why they are unknown.
    pub source: String,
}

impl Expectation {
    /// Computes the expectation of a case. Slow if there is no formula for it.
    pub fn compute(case: &Case) -> Expectation {
        let expectation = |positions: Option<_>, source: &str| Expectation {
            positions,
            collisions: case.collisions,
            source: source.into(),
        };
        match &case.oracle {
            Oracle::ClosedForm(positions) => {
                expectation(Some(instants(case).map(|time| positions(&time)).collect()), "closed form")
            }
            Oracle::Rest => expectation(None, "nothing moves"),
            Oracle::Error => expectation(None, "must end in an error"),
            Oracle::Unknown(reason) => expectation(None, reason),
            Oracle::Simulation => simulate(case).unwrap_or_else(|reason| expectation(None, &reason)),
        }
    }
}

/// The times of the compared steps, s.
fn instants(case: &Case) -> impl Iterator<Item = Fixed256> {
    let rate = Fixed256::from(case.rate);
    case.sample_steps().map(move |step| &Fixed256::from(step as f64) / &rate)
}

fn simulate(case: &Case) -> Result<Expectation, String> {
    let spec = RunSpec { solver: SolverKind::EventDriven, factor: 1 };
    let scene = case.scene(spec).map_err(|error| error.to_string())?;
    if scene.inputs.iter().any(|input| input.step > 0) {
        return Err("the 77-decimal simulator supports no later spawns or deletes".into());
    }
    let world = initial_world(&scene).map_err(|error| error.to_string())?;
    let mut simulator =
        PreciseSimulator::new(&world, case.steps as f64 / case.rate).map_err(|error| error.to_string())?;
    let mut positions = Vec::new();
    for time in instants(case) {
        simulator.advance(&time).map_err(|error| error.to_string())?;
        positions.push(simulator.positions(&time));
    }
    let collisions = Some(case.collisions.unwrap_or(simulator.collisions));
    Ok(Expectation { positions: Some(positions), collisions, source: "simulation with 77 decimals".into() })
}
