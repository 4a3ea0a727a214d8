use super::oracle::Oracle;
use crate::physics::{Observer, SolverKind, StepError, World};
use crate::replay::{Run, RunError};
use crate::scene::{self, Scene, SceneError};

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
    /// True if the growth of rounding errors is estimated.
    pub estimates_accuracy: bool,
}

/// One run of a case: the solver and the rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunSpec {
    /// The solver.
    pub solver: SolverKind,
    /// The rate, as a multiple of the lowest rate of the case.
    pub factor: u64,
}

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
            estimates_accuracy: true,
        }
    }

    /// The runs of the case, in the order of the report.
    pub fn run_specs(&self) -> Vec<RunSpec> {
        let solvers = [SolverKind::EventDriven, SolverKind::Handout];
        let rates = |solver| self.factors.iter().map(move |&factor| RunSpec { solver, factor });
        solvers.into_iter().flat_map(rates).collect()
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
        for input in &mut scene.inputs {
            input.step *= spec.factor;
        }
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
            estimates_accuracy: false,
        }
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
    /// Creates a runner at step 0, and applies the inputs of that step.
    ///
    /// # Errors
    /// Returns an error if a name is already in use or not alive.
    pub fn start(scene: &Scene) -> Result<SceneRunner, RunError> {
        let mut input_steps: Vec<u64> = scene.inputs.iter().map(|input| input.step).collect();
        input_steps.dedup();
        input_steps.reverse();
        let mut runner = SceneRunner { run: Run::new(scene), input_steps };
        runner.apply_inputs()?;
        Ok(runner)
    }

    /// Advances the world to `step`, applying the inputs on the way.
    ///
    /// # Errors
    /// The outer error is that of an input whose name is already in use or not alive; the inner one
    /// is that of [`crate::physics::Engine::step`].
    pub fn advance_to<O: Observer>(&mut self, step: u64, observer: &mut O) -> Result<Result<(), StepError>, RunError> {
        while self.current_step() < step {
            if let Err(error) = self.run.step(observer) {
                return Ok(Err(error));
            }
            self.apply_inputs()?;
        }
        Ok(Ok(()))
    }

    /// Applies the inputs that the scene has for the present step.
    fn apply_inputs(&mut self) -> Result<(), RunError> {
        if self.input_steps.last() == Some(&self.current_step()) {
            self.input_steps.pop();
            self.run.apply_inputs(Vec::new(), |error| Err(error.into()))?;
        }
        Ok(())
    }

    /// The next step with inputs, if there is one.
    pub fn next_input_step(&self) -> Option<u64> {
        self.input_steps.last().copied()
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
