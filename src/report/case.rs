use super::oracle::Fixed256;
use crate::physics::{Observer, SolverKind, StepError, World};
use crate::run::{Run, RunError};
use crate::scene::{self, Input, Scene, SceneError};
use std::fmt;

/// A hard scene, the rates at which it is run, and the source of its correct result.
#[derive(Debug)]
pub struct Case {
    /// Cases of one family share a diagram.
    pub family: String,
    /// The name in the table.
    pub name: String,
    /// The scene as TOML, at the lowest rate.
    pub text: String,
    /// The lowest rate, Hz.
    pub rate: f64,
    /// Number of steps at the lowest rate.
    pub steps: u64,
    /// The rates of the runs, as integer multiples of the lowest rate.
    pub factors: Vec<u64>,
    /// The first measured step, at the lowest rate. Earlier steps are run but not measured.
    pub from: u64,
    /// The source of the correct positions.
    pub oracle: Oracle,
    /// The correct number of collisions, if it is known in advance.
    pub collisions: Option<u64>,
}

/// Returns the positions (m) of the finite masses, in creation order, at a time (s).
pub type Formula = Box<dyn Fn(&Fixed256) -> Vec<Position>>;

/// Position of an upper-left corner along both axes, m.
pub type Position = [Fixed256; 2];

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

/// One run of a case: the solver and the rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunSpec {
    /// The solver.
    pub solver: SolverKind,
    /// The rate, as a multiple of the lowest rate of the case.
    pub factor: u64,
}

/// The solvers in the order of the report.
pub const SOLVERS: [SolverKind; 2] = [SolverKind::EventDriven, SolverKind::Handout];

impl Case {
    /// A case for a scene of the user, at its own rate and at 4 and 16 times that rate.
    pub fn of_scene(name: &str, scene: &Scene) -> Case {
        Case {
            family: "own scenes".into(),
            name: name.into(),
            text: scene.source.text.clone(),
            rate: scene.run.rate,
            steps: scene.run.steps,
            factors: vec![1, 4, 16],
            from: 0,
            oracle: Oracle::Simulation,
            collisions: None,
        }
    }

    /// The runs of the case, in the order of the report.
    pub fn run_specs(&self) -> Vec<RunSpec> {
        let rates = |solver| self.factors.iter().map(move |&factor| RunSpec { solver, factor });
        SOLVERS.into_iter().flat_map(rates).collect()
    }

    /// Returns the scene of a run: the same simulated time, in more steps at a higher rate.
    ///
    /// # Errors
    /// Returns an error if the scene text is invalid.
    pub fn scene(&self, spec: RunSpec) -> Result<Scene, SceneError> {
        let mut scene = scene::parse(&self.name, &self.text)?;
        scene.run.solver = spec.solver;
        scene.run.rate *= spec.factor as f64;
        scene.run.steps *= spec.factor;
        scene.inputs.iter_mut().for_each(|input| input.step *= spec.factor);
        Ok(scene)
    }

    /// The steps at which states are compared, at the lowest rate: about 120, including the first
    /// measured step and the last one.
    pub fn sample_steps(&self) -> impl Iterator<Item = u64> + use<> {
        const SAMPLES: u64 = 120;
        let (from, steps) = (self.from, self.steps);
        let stride = (steps - from).div_ceil(SAMPLES).max(1);
        (from..steps).step_by(stride as usize).chain([steps])
    }
}

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

impl RunSpec {
    /// The number of pair tests that the handout solver makes in this run of `scene`.
    pub fn pair_tests(self, scene: &Scene) -> u64 {
        let bodies = scene.inputs.len() as u64;
        bodies * bodies * scene.run.steps
    }
}

/// Runs a scene with little overhead beside the engine: inputs are only processed in steps that
/// have some.
#[derive(Clone)]
pub struct SceneRunner {
    run: Run,
    /// Steps that still have inputs, the next one last.
    input_steps: Vec<u64>,
}

impl SceneRunner {
    /// Creates a runner at step 0, before the inputs of that step are applied.
    pub fn new(scene: &Scene) -> SceneRunner {
        let mut input_steps: Vec<u64> = scene.inputs.iter().map(|Input { step, .. }| *step).collect();
        input_steps.dedup();
        input_steps.reverse();
        SceneRunner { run: Run::new(scene), input_steps }
    }

    /// Applies the inputs that the scene has for the present step.
    ///
    /// # Errors
    /// Returns an error if a name is already in use or not alive.
    pub fn apply_inputs(&mut self) -> Result<(), RunError> {
        if self.input_steps.last() == Some(&self.run.engine().current_step()) {
            self.input_steps.pop();
            self.run.apply_inputs(Vec::new(), |error| Err(error.into()))?;
        }
        Ok(())
    }

    /// Advances the world to `step`, applying the inputs on the way.
    ///
    /// # Errors
    /// The outer error is that of an input whose name is already in use or not alive; the inner one
    /// is that of [`crate::physics::Engine::step`].
    pub fn advance_to<O: Observer>(&mut self, step: u64, observer: &mut O) -> Result<Result<(), StepError>, RunError> {
        while self.run.engine().current_step() < step {
            if let Err(error) = self.run.step(observer) {
                return Ok(Err(error));
            }
            self.apply_inputs()?;
        }
        Ok(Ok(()))
    }

    /// The number of steps taken.
    pub fn current_step(&self) -> u64 {
        self.run.engine().current_step()
    }

    /// The present world.
    pub fn world(&self) -> &World {
        self.run.engine().world()
    }
}

/// Returns the world of a scene at step 0, after the inputs of that step.
///
/// # Errors
/// Returns an error if a name is already in use or not alive.
pub fn initial_world(scene: &Scene) -> Result<World, RunError> {
    let mut runner = SceneRunner::new(scene);
    runner.apply_inputs()?;
    Ok(runner.world().clone())
}
