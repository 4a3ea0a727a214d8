use super::{
    Body, BodyId, Event, Memory, Observer, Restitution, Snapshot, SnapshotError, Spawn, StepError, Vector, World,
    event_driven::EventDriven, handout,
};

/// Which of the two solvers moves the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolverKind {
    /// The handout's algorithm as printed.
    Handout,
    /// The exact one, from event to event.
    EventDriven,
}

impl SolverKind {
    /// The solver of that name in scenes and recordings.
    pub fn named(name: &str) -> Option<SolverKind> {
        [SolverKind::Handout, SolverKind::EventDriven].into_iter().find(|kind| kind.name() == name)
    }

    /// Whether it knows where bodies are between two steps.
    pub const fn is_continuous(self) -> bool {
        match self {
            SolverKind::Handout => false,
            SolverKind::EventDriven => true,
        }
    }

    /// Its name in scenes and recordings.
    pub const fn name(self) -> &'static str {
        match self {
            SolverKind::Handout => "handout",
            SolverKind::EventDriven => "event-driven",
        }
    }
}

/// What an engine is told once and never again.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Which solver.
    pub solver: SolverKind,
    /// Steps per second, Hz; finite and positive.
    pub rate: f64,
    /// m/s²; absent means that nothing is computed for it.
    pub gravity: Option<Vector>,
    /// e for each pair of materials.
    pub restitution: Restitution,
    /// How much may happen within one step before the run is given up.
    pub events_per_step: u64,
}

/// A limit no sensible scene comes near: Galperin's billiard of 8 digits has bursts of 10⁸,
/// and says so in its scene.
pub const DEFAULT_EVENTS_PER_STEP: u64 = 1_000_000;

/// A world and the solver that moves it in fixed steps.
///
/// Deterministic to the bit: the same settings and events give the same states on every
/// machine. It reads no clock and no file, and never fails but in [`Engine::step`], whose
/// error ends the run.
#[derive(Clone, Debug)]
pub struct Engine {
    world: World,
    step: u64,
    next_id: BodyId,
    rate: f64,
    solver: Solver,
}

#[derive(Clone, Debug)]
enum Solver {
    Handout,
    EventDriven(Box<EventDriven>),
}

impl Engine {
    /// An empty world at step 0.
    pub fn new(settings: Settings) -> Engine {
        let solver = match settings.solver {
            SolverKind::Handout => Solver::Handout,
            SolverKind::EventDriven => Solver::EventDriven(Box::new(EventDriven::new(&settings))),
        };
        let world = World { bodies: Vec::new(), gravity: settings.gravity, restitution: settings.restitution };
        Engine { world, step: 0, next_id: 0, rate: settings.rate, solver }
    }

    /// The world as sampled at the present step.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The number of steps taken.
    pub fn present_step(&self) -> u64 {
        self.step
    }

    /// The id the next spawned body will get.
    pub fn next_id(&self) -> BodyId {
        self.next_id
    }

    /// Lets one event happen now, between two steps.
    ///
    /// A delete of a body that is not alive changes nothing; who takes names looks them
    /// up first.
    pub fn apply(&mut self, event: &Event) {
        match event {
            Event::Spawn(spawn) => self.spawn(spawn),
            Event::Delete(id) => self.delete(*id),
        }
    }

    fn spawn(&mut self, spawn: &Spawn) {
        let body = Body {
            id: self.next_id,
            name: spawn.name.clone(),
            rect: spawn.rect,
            mass: spawn.mass,
            inverse_mass: 1.0 / spawn.mass,
            velocity: spawn.velocity,
            force: Vector::ZERO,
            constant_force: spawn.force,
            material: self.world.restitution.material(&spawn.material),
        };
        self.next_id += 1;
        self.world.bodies.push(body);
        match &mut self.solver {
            Solver::Handout => {}
            Solver::EventDriven(solver) => solver.spawned(&self.world, self.step),
        }
    }

    fn delete(&mut self, id: BodyId) {
        let Some(place) = self.world.place(id) else { return };
        match &mut self.solver {
            Solver::Handout => {}
            Solver::EventDriven(solver) => solver.deleting(&self.world, place, self.step),
        }
        self.world.bodies.remove(place);
    }

    /// Moves the world on by one step of 1/rate seconds.
    ///
    /// # Errors
    /// When the step cannot be completed; the engine is then not to be stepped again.
    pub fn step<O: Observer>(&mut self, observer: &mut O) -> Result<(), StepError> {
        match &mut self.solver {
            Solver::Handout => handout::step(&mut self.world, self.step, 1.0 / self.rate, observer)?,
            Solver::EventDriven(solver) => solver.step(&mut self.world, self.step, observer)?,
        }
        self.step += 1;
        Ok(())
    }

    /// The world `offset` seconds (0 to 1/rate) after the present step, without going there:
    /// what the exact solver passes through. The handout's has nothing between two steps, and
    /// gives the present state. The observer sees the collisions up to there.
    ///
    /// # Errors
    /// As for [`Engine::step`].
    pub fn between<O: Observer>(&self, offset: f64, observer: &mut O) -> Result<World, StepError> {
        match &self.solver {
            Solver::EventDriven(solver) if offset > 0.0 => solver.between(&self.world, self.step, offset, observer),
            Solver::EventDriven(_) | Solver::Handout => Ok(self.world.clone()),
        }
    }

    /// All that [`Engine::restore`] needs to go on to the bit from here.
    pub fn snapshot(&self) -> Snapshot {
        let memory = match &self.solver {
            Solver::Handout => Memory::default(),
            Solver::EventDriven(solver) => solver.memory(),
        };
        Snapshot { step: self.step, next_id: self.next_id, bodies: self.world.bodies.clone(), memory }
    }

    /// The engine that took `snapshot`, given the settings it had.
    ///
    /// # Errors
    /// When the snapshot's memory does not fit the solver: it comes from a file, after all.
    pub fn restore(settings: Settings, snapshot: Snapshot) -> Result<Engine, SnapshotError> {
        let mut engine = Engine::new(settings);
        engine.step = snapshot.step;
        engine.next_id = snapshot.next_id;
        engine.world.bodies = snapshot.bodies;
        match &mut engine.solver {
            Solver::Handout => {}
            Solver::EventDriven(solver) => solver.restore(&engine.world, snapshot.step, &snapshot.memory)?,
        }
        Ok(engine)
    }
}
