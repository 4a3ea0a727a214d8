//! Correct results of scenes, computed by code that shares nothing with the solvers.
//!
//! `closed_form` holds formulas; [`PreciseSimulator`] is for scenes without one: it predicts the impacts
//! of every pair of boxes with 77 decimals ([`Fixed256`]). It is slow, but so simple that
//! its code can be verified by reading.

pub mod closed_form;
mod fixed256;
mod precise_simulator;

pub use fixed256::Fixed256;
pub use precise_simulator::{PreciseSimulator, Unsuitable};

use super::case::{Case, RunSpec, SceneRunner};
use crate::physics::SolverKind;
use std::fmt;

/// The source of the correct positions of a case.
pub enum Oracle {
    /// A formula.
    ClosedForm(Formula),
    /// All bodies stay where they are in the first measured state.
    Rest,
    /// A simulation with 77 decimals.
    Simulation,
    /// The run must end in an error, because a body is crushed.
    Error,
    /// The positions are unknown, for the reason given.
    Unknown(String),
}

/// Returns the positions (m) of the finite masses, in creation order, at a time (s).
pub type Formula = Box<dyn Fn(&Fixed256) -> Vec<Position>>;

/// Position of an upper-left corner along both axes, m.
pub type Position = [Fixed256; 2];

impl fmt::Debug for Oracle {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(match self {
            Oracle::ClosedForm(_) => "ClosedForm",
            Oracle::Rest => "Rest",
            Oracle::Simulation => "Simulation",
            Oracle::Error => "Error",
            Oracle::Unknown(_) => "Unknown",
        })
    }
}

/// The correct result of a case at each compared step.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// For each compared step the positions of the finite masses in creation order, m.
    pub positions: Option<Vec<Vec<Position>>>,
    /// Correct number of collisions up to the last compared step.
    pub collisions: Option<u64>,
    /// Source of these values, or the reason why they are unknown.
    pub source: String,
}

impl Expectation {
    /// Computes the expectation of a case. Slow if there is no formula for it.
    pub fn compute(case: &Case) -> Expectation {
        let (positions, source) = match &case.oracle {
            Oracle::ClosedForm(formula) => {
                (Some(instants(case).map(|time| formula(&time)).collect()), "closed form".into())
            }
            Oracle::Rest => (None, "nothing moves".into()),
            Oracle::Error => (None, "must end in an error".into()),
            Oracle::Unknown(reason) => (None, reason.clone()),
            Oracle::Simulation => match Expectation::simulate(case) {
                Ok(expectation) => return expectation,
                Err(reason) => (None, reason),
            },
        };
        Expectation { positions, collisions: case.collisions, source }
    }

    fn simulate(case: &Case) -> Result<Expectation, String> {
        let spec = RunSpec { solver: SolverKind::EventDriven, factor: 1 };
        let scene = case.scene(spec).map_err(|error| error.to_string())?;
        if scene.inputs.iter().any(|input| input.step > 0) {
            return Err("the 77-decimal simulator supports no later spawns or deletes".into());
        }
        let start = SceneRunner::start(&scene).map_err(|error| error.to_string())?;
        let end = case.steps as f64 / case.rate;
        let mut simulator = PreciseSimulator::new(start.world(), end).map_err(|error| error.to_string())?;
        let mut positions = Vec::new();
        for time in instants(case) {
            simulator.advance(&time).map_err(|error| error.to_string())?;
            positions.push(simulator.positions(&time));
        }
        let collisions = Some(case.collisions.unwrap_or(simulator.collisions));
        Ok(Expectation { positions: Some(positions), collisions, source: "simulation with 77 decimals".into() })
    }
}

/// The times of the compared steps, s.
fn instants(case: &Case) -> impl Iterator<Item = Fixed256> {
    let rate = Fixed256::from(case.rate);
    case.sample_steps().map(move |step| &Fixed256::from(step as f64) / &rate)
}
