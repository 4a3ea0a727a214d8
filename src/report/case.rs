use super::truth::Number;
use crate::physics::{Observer, SolverKind, StepError, World};
use crate::run::{Run, RunError};
use crate::scene::{self, Input, Scene, SceneError};
use std::fmt;

/// A scene that is hard for somebody, and what it is to come to.
#[derive(Debug)]
pub struct Case {
    /// Cases of one family share a diagram.
    pub family: String,
    /// What the table calls it.
    pub name: String,
    /// Its scene as TOML, at its lowest rate.
    pub text: String,
    /// That rate, Hz.
    pub rate: f64,
    /// Steps at that rate.
    pub steps: u64,
    /// Whole numbers of times that rate.
    pub factors: Vec<u64>,
    /// The first step at the lowest rate that is measured; what was before is only run.
    pub from: u64,
    /// Where its bodies are to be.
    pub truth: Truth,
    /// How many collisions there are, where it is known beforehand.
    pub collisions: Option<u64>,
}

/// Positions, m, of the finite masses in creation order at a time, s.
pub type Formula = Box<dyn Fn(&Number) -> Vec<Place>>;

/// A position along both axes, m.
pub type Place = [Number; 2];

/// How it is known where bodies should be.
pub enum Truth {
    /// A formula gives it.
    ClosedForm(Formula),
    /// All of them stay where the first measured state has them.
    Rest,
    /// Arithmetic to 77 decimals.
    Reference,
    /// It is an error: there is no room for the bodies.
    Crush,
    /// It is not known, and why.
    Unknown(String),
}

/// One run of a case: by which solver, and at how many times its lowest rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trial {
    /// Which solver.
    pub solver: SolverKind,
    /// How many times the lowest rate.
    pub factor: u64,
}

/// Solvers in the order of the report.
pub const SOLVERS: [SolverKind; 2] = [SolverKind::EventDriven, SolverKind::Handout];

impl Case {
    /// A scene of the user's own, at its rate and higher ones.
    pub fn of_scene(name: &str, scene: &Scene) -> Case {
        Case {
            family: "own scenes".into(),
            name: name.into(),
            text: scene.source.text.clone(),
            rate: scene.run.rate,
            steps: scene.run.steps,
            factors: vec![1, 4, 16],
            from: 0,
            truth: Truth::Reference,
            collisions: None,
        }
    }

    /// Its runs, in the order of the report.
    pub fn trials(&self) -> Vec<Trial> {
        let rates = |solver| self.factors.iter().map(move |&factor| Trial { solver, factor });
        SOLVERS.into_iter().flat_map(rates).collect()
    }

    /// The scene of a run: the same simulated time in more steps.
    ///
    /// # Errors
    /// When the text is refused.
    pub fn scene(&self, trial: Trial) -> Result<Scene, SceneError> {
        let mut scene = scene::parse(&self.name, &self.text)?;
        scene.run.solver = trial.solver;
        scene.run.rate *= trial.factor as f64;
        scene.run.steps *= trial.factor;
        scene.inputs.iter_mut().for_each(|input| input.step *= trial.factor);
        Ok(scene)
    }

    /// The steps at the lowest rate that are looked at: about a hundred, the first measured and
    /// the last one among them.
    pub fn looks(&self) -> impl Iterator<Item = u64> + use<> {
        const LOOKS: u64 = 120;
        let (from, steps) = (self.from, self.steps);
        let stride = (steps - from).div_ceil(LOOKS).max(1);
        (from..steps).step_by(stride as usize).chain([steps])
    }
}

impl fmt::Debug for Truth {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(match self {
            Truth::ClosedForm(_) => "ClosedForm",
            Truth::Rest => "Rest",
            Truth::Reference => "Reference",
            Truth::Crush => "Crush",
            Truth::Unknown(_) => "Unknown",
        })
    }
}

impl Trial {
    /// How many pairs of boxes the handout's solver looks at in a run of the scene.
    pub fn pairs(self, scene: &Scene) -> u64 {
        let bodies = scene.inputs.len() as u64;
        bodies * bodies * scene.run.steps
    }
}

/// A scene being run with as little beside the engine as can be: inputs are looked at only in
/// the steps that have some.
#[derive(Clone)]
pub struct Course {
    run: Run,
    busy: Vec<u64>,
}

impl Course {
    /// A scene before anything has happened.
    pub fn new(scene: &Scene) -> Course {
        let mut busy: Vec<u64> = scene.inputs.iter().map(|Input { step, .. }| *step).collect();
        busy.dedup();
        busy.reverse();
        Course { run: Run::new(scene), busy }
    }

    /// Lets happen what the scene has for the present step.
    ///
    /// # Errors
    /// When a name is taken or not alive.
    pub fn happen(&mut self) -> Result<(), RunError> {
        if self.busy.last() == Some(&self.run.engine().present_step()) {
            self.busy.pop();
            self.run.happen(Vec::new(), |error| Err(error.into()))?;
        }
        Ok(())
    }

    /// Moves the world on to a later step and lets happen what the scene has for it.
    ///
    /// # Errors
    /// When a name is taken or not alive; within that, as for [`crate::physics::Engine::step`].
    pub fn advance_to<O: Observer>(&mut self, step: u64, observer: &mut O) -> Result<Result<(), StepError>, RunError> {
        while self.run.engine().present_step() < step {
            if let Err(error) = self.run.step(observer) {
                return Ok(Err(error));
            }
            self.happen()?;
        }
        Ok(Ok(()))
    }

    /// How many steps have been taken.
    pub fn present_step(&self) -> u64 {
        self.run.engine().present_step()
    }

    /// The world as it is.
    pub fn world(&self) -> &World {
        self.run.engine().world()
    }
}

/// The world of a scene at step 0, before anything moves.
///
/// # Errors
/// When a name is taken or not alive.
pub fn first_world(scene: &Scene) -> Result<World, RunError> {
    let mut course = Course::new(scene);
    course.happen()?;
    Ok(course.world().clone())
}
