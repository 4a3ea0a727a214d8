use super::{Body, BodyId, Event, Observer, Restitution, Spawn, Vector, World, event_driven::EventDriven, handout};
use std::num::NonZero;

/// The solver that moves the world.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolverKind {
    /// The algorithm of the handout, as printed.
    Handout,
    /// The event-driven solver: event-driven molecular dynamics.
    EventDriven,
}

impl SolverKind {
    /// The solver with the given name in scenes and recordings; `None` if the name is unknown.
    pub fn from_name(name: &str) -> Option<SolverKind> {
        [SolverKind::Handout, SolverKind::EventDriven].into_iter().find(|kind| kind.name() == name)
    }

    /// Returns true if the solver defines states between two steps.
    pub const fn is_continuous(self) -> bool {
        match self {
            SolverKind::Handout => false,
            SolverKind::EventDriven => true,
        }
    }

    /// The name in scenes and recordings.
    pub const fn name(self) -> &'static str {
        match self {
            SolverKind::Handout => "handout",
            SolverKind::EventDriven => "event-driven",
        }
    }
}

/// The configuration of an engine, constant for its lifetime.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub struct EngineConfig {
    /// The solver.
    pub solver: SolverKind,
    /// Steps per second, Hz; finite and positive.
    pub rate: f64,
    /// Gravitational acceleration, m/s². `None` skips the computation instead of adding zeros.
    pub gravity: Option<Vector>,
    /// The coefficient of restitution e of each pair of materials.
    pub restitution: Restitution,
    /// The number of events allowed in a step; beyond it the step fails.
    pub events_per_step: u64,
}

impl EngineConfig {
    /// A configuration without gravity, with e = 1 for all pairs and the default limit of events.
    pub fn new(solver: SolverKind, rate: f64) -> EngineConfig {
        let restitution = Restitution::new(1.0, &[]);
        EngineConfig { solver, rate, gravity: None, restitution, events_per_step: DEFAULT_EVENTS_PER_STEP }
    }

    /// Sets the gravitational acceleration, m/s².
    pub fn with_gravity(self, gravity: Option<Vector>) -> EngineConfig {
        EngineConfig { gravity, ..self }
    }

    /// Sets the coefficients of restitution.
    pub fn with_restitution(self, restitution: Restitution) -> EngineConfig {
        EngineConfig { restitution, ..self }
    }

    /// Sets the number of events allowed in a step.
    pub fn with_events_per_step(self, events_per_step: u64) -> EngineConfig {
        EngineConfig { events_per_step, ..self }
    }
}

/// The default of [`EngineConfig::events_per_step`], far above the needs of ordinary scenes. (Galperin's
/// billiard for 8 digits of π has bursts of 10⁸ and sets its own limit.)
pub const DEFAULT_EVENTS_PER_STEP: u64 = 1_000_000;

/// A world and the solver that moves it in fixed steps.
///
/// The engine is deterministic: the same configuration and events give the same states bit for bit on
/// every machine. It reads no clock and no file. Only [`Engine::step`], [`Engine::world_after`] and
/// [`Engine::restore`] can fail; an error of a step ends the run: all further steps return it again.
#[doc(alias("simulation", "event-driven molecular dynamics", "cell list", "isotonic regression"))]
#[derive(Clone, Debug)]
pub struct Engine {
    world: World,
    step: u64,
    next_id: BodyId,
    rate: f64,
    solver: Solver,
    /// The error that ended the run.
    failure: Option<StepError>,
}

/// The worlds between the current step of an engine and the next.
///
/// [`Engine::world_after`] gives the same worlds, bit for bit, but processes the events since the current step each
/// time.
#[derive(Debug)]
pub struct WithinStep<'a> {
    engine: &'a Engine,
    /// The last offset, s, and the solver there.
    reached: Option<(f64, EventDriven)>,
}

impl WithinStep<'_> {
    /// Returns the world `offset` seconds (0 to 1/rate) after the current step. The observer receives the collisions
    /// since the last offset; an offset that is smaller than the last one starts again at the current step.
    ///
    /// # Errors
    /// Returns the errors of [`Engine::step`].
    pub fn world_after<O: Observer>(&mut self, offset: f64, observer: &mut O) -> Result<World, StepError> {
        let Engine { world, step, solver, failure, .. } = self.engine;
        if let Some(failure) = failure.clone().or_else(|| self.engine.thin_spawn()) {
            return Err(failure);
        }
        match solver {
            Solver::EventDriven(solver) if offset > 0.0 => {
                let mut reached = match self.reached.take() {
                    Some((last, reached)) if last <= offset => reached,
                    _ => solver.begun(world, *step, observer)?,
                };
                let found = reached.world_after(world, offset, observer)?;
                self.reached = Some((offset, reached));
                Ok(found)
            }
            Solver::EventDriven(_) | Solver::Handout => Ok(world.clone()),
        }
    }
}

#[derive(Clone, Debug)]
enum Solver {
    Handout,
    EventDriven(Box<EventDriven>),
}

impl Engine {
    /// Creates an engine with an empty world at step 0.
    ///
    /// # Panics
    /// Panics if the rate is not a positive number.
    pub fn new(config: EngineConfig) -> Engine {
        assert!(config.rate > 0.0 && config.rate.is_finite(), "a rate of {} Hz", config.rate);
        let solver = match config.solver {
            SolverKind::Handout => Solver::Handout,
            SolverKind::EventDriven => Solver::EventDriven(Box::new(EventDriven::new(&config))),
        };
        let world = World { bodies: Vec::new(), gravity: config.gravity, restitution: config.restitution };
        Engine { world, step: 0, next_id: 0, rate: config.rate, solver, failure: None }
    }

    /// Sets the number of threads that share the work of the event-driven solver whose order does not matter, with 2¹⁵
    /// bodies or more; `None`, the default, stands for as many as the system can run at the same time. No result
    /// depends on it.
    pub fn set_threads(&mut self, count: Option<NonZero<u32>>) {
        if let Solver::EventDriven(solver) = &mut self.solver {
            solver.set_threads(count);
        }
    }

    /// The world as sampled at the current step.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The current step: the number of steps taken.
    pub fn current_step(&self) -> u64 {
        self.step
    }

    /// The id of the next body to be spawned.
    pub fn next_id(&self) -> BodyId {
        self.next_id
    }

    /// Applies an event at the current step.
    ///
    /// The deletion of a body that is not alive has no effect. If the numbers of a spawn are not
    /// [valid](Spawn::is_valid), the states are unspecified and a step may return an error.
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
            Solver::EventDriven(solver) => solver.add_spawned(&self.world, self.step),
        }
    }

    fn delete(&mut self, id: BodyId) {
        let Some(index) = self.world.index_of(id) else { return };
        match &mut self.solver {
            Solver::Handout => {}
            Solver::EventDriven(solver) => solver.remove(&self.world, index, self.step),
        }
        self.world.bodies.remove(index);
    }

    /// The error of a body spawned since the last step whose faces coincide in the precision of its position.
    fn thin_spawn(&self) -> Option<StepError> {
        let Solver::EventDriven(solver) = &self.solver else { return None };
        let mut spawned = solver.pending_spawns().filter_map(|id| self.world.body(id));
        let thin = spawned.find(|body| !body.rect.is_resolved());
        thin.map(|body| StepError::TooThin { step: self.step, body: body.name.clone() })
    }

    /// Advances the world by one step of 1/rate seconds. The observer receives the collisions.
    ///
    /// # Errors
    /// Returns an error if the step cannot be completed. From then on every step returns the same error.
    pub fn step<O: Observer>(&mut self, observer: &mut O) -> Result<(), StepError> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        if let Solver::EventDriven(solver) = &mut self.solver
            && solver.skip_idle_step()
        {
            self.step += 1;
            return Ok(());
        }
        if let Some(failure) = self.thin_spawn() {
            self.failure = Some(failure.clone());
            return Err(failure);
        }
        let result = match &mut self.solver {
            Solver::Handout => handout::step(&mut self.world, self.step, 1.0 / self.rate, observer),
            Solver::EventDriven(solver) => solver.step(&mut self.world, self.step, observer),
        };
        match &result {
            Ok(()) => self.step += 1,
            Err(error) => self.failure = Some(error.clone()),
        }
        result
    }

    /// Returns the world `offset` seconds (0 to 1/rate) after the current step, without advancing the
    /// engine. The observer receives the collisions up to that instant.
    ///
    /// The handout solver defines no states between two steps: with it, the current state is returned.
    ///
    /// # Errors
    /// Returns the errors of [`Engine::step`].
    pub fn world_after<O: Observer>(&self, offset: f64, observer: &mut O) -> Result<World, StepError> {
        self.within_step().world_after(offset, observer)
    }

    /// Returns the worlds between the current step and the next, in the order of their times.
    pub fn within_step(&self) -> WithinStep<'_> {
        WithinStep { engine: self, reached: None }
    }

    /// Asserts the invariants of the event-driven solver after each instant from now on, in debug builds and with few
    /// bodies: for tests of its laws. They do not hold for snapshots that were altered, nor where numbers underflow.
    #[doc(hidden)]
    pub fn assert_invariants(&mut self) {
        if let Solver::EventDriven(solver) = &mut self.solver {
            solver.assert_invariants();
        }
    }

    /// The event-driven solver.
    ///
    /// # Panics
    /// With the handout solver.
    #[cfg(test)]
    pub(super) fn event_driven_mut(&mut self) -> &mut EventDriven {
        match &mut self.solver {
            Solver::EventDriven(solver) => solver,
            Solver::Handout => panic!("the handout solver"),
        }
    }

    /// The seconds between two steps.
    pub(super) fn period(&self) -> f64 {
        1.0 / self.rate
    }

    /// Returns a copy of the engine that from now on rounds at random, with numbers that follow from `seed`, and
    /// computes with a resolution of positions that is finer or coarser by a factor; `None` with the handout solver.
    pub(super) fn perturbed(&self, seed: u64, factor: f64) -> Option<Engine> {
        let mut copy = self.clone();
        match &mut copy.solver {
            Solver::Handout => return None,
            Solver::EventDriven(solver) => solver.perturb(seed, factor),
        }
        Some(copy)
    }

    /// The greatest difference between the positions of the bodies along an axis in this engine and in `other`, m;
    /// infinite if bodies, step or solver differ.
    pub(super) fn distance_to(&self, other: &Engine) -> f64 {
        match (&self.solver, &other.solver) {
            (Solver::EventDriven(one), Solver::EventDriven(two)) if self.step == other.step => {
                one.distance_to(two, self.step)
            }
            _ => f64::INFINITY,
        }
    }

    /// Returns a snapshot from which [`Engine::restore`] continues bit for bit.
    pub fn snapshot(&self) -> Snapshot {
        let solver = match &self.solver {
            Solver::Handout => SolverSnapshot::default(),
            Solver::EventDriven(solver) => solver.snapshot(self.step),
        };
        Snapshot { step: self.step, next_id: self.next_id, bodies: self.world.bodies.clone(), solver }
    }

    /// Restores an engine from a snapshot. `config` must be the configuration of the engine that took it.
    ///
    /// # Errors
    /// Returns an error if the snapshot is damaged or was taken with the other solver.
    pub fn restore(config: EngineConfig, snapshot: Snapshot) -> Result<Engine, SnapshotError> {
        let ascend = snapshot.bodies.is_sorted_by(|a, b| a.id < b.id);
        if !ascend || snapshot.bodies.last().is_some_and(|body| body.id >= snapshot.next_id) {
            let reason = "its ids do not ascend up to the next one".to_owned();
            return Err(SnapshotError { step: snapshot.step, reason });
        }
        let mut engine = Engine::new(config);
        engine.step = snapshot.step;
        engine.next_id = snapshot.next_id;
        engine.world.bodies = snapshot.bodies;
        match &mut engine.solver {
            Solver::Handout if snapshot.solver == SolverSnapshot::default() => {}
            Solver::Handout => {
                let reason = "it was taken with the event-driven solver".to_owned();
                return Err(SnapshotError { step: snapshot.step, reason });
            }
            Solver::EventDriven(solver) => solver.restore(&engine.world, snapshot.step, &snapshot.solver)?,
        }
        Ok(engine)
    }
}

/// The complete state of an engine, from which it continues bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The step of the state.
    pub step: u64,
    /// The id of the next body to be spawned.
    pub next_id: BodyId,
    /// The bodies alive, in creation order, as sampled at this step.
    pub bodies: Vec<Body>,
    /// The state of the solver.
    pub solver: SolverSnapshot,
}

/// The state of a solver as two flat lists, whose layout the solver defines.
///
/// It consists of numbers only, so that it can be stored without knowledge of the solver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolverSnapshot {
    /// Counts, steps, ids.
    pub integers: Vec<u64>,
    /// Seconds, metres, metres per second.
    pub numbers: Vec<f64>,
}

/// The reason why a snapshot cannot be restored: another solver created it, or it is damaged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the snapshot of step {step} does not fit the solver: {reason}")]
pub struct SnapshotError {
    /// The step of the snapshot.
    pub step: u64,
    /// The mismatch.
    pub reason: String,
}

/// The reason why a step could not be completed. The states before it remain valid.
///
/// Recordings store variant and fields under the names used here.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum StepError {
    /// A number overflowed, as in scenes with extreme values.
    #[error(
        "step {step}: the position or velocity of body {body:?} exceeds the range of numbers; start it smaller, slower or nearer to the origin"
    )]
    NotFinite {
        /// The step that failed: from state `step` to state `step + 1`.
        step: u64,
        /// Name of the body.
        body: String,
    },
    /// Infinite masses press on a body from both sides.
    #[error("step {step}: body {body:?} is crushed between {:?} and {:?}, which have infinite mass", between[0], between[1])]
    Crushed {
        /// The step that failed.
        step: u64,
        /// Name of the body.
        body: String,
        /// Names of the two infinite masses.
        between: [String; 2],
    },
    /// A spawned body is thinner than a few units in the last place of its position, so its faces coincide.
    #[error(
        "step {step}: body {body:?} is too thin for the precision of its position; place it nearer to the origin or enlarge it"
    )]
    TooThin {
        /// The step in which it was spawned.
        step: u64,
        /// Name of the body.
        body: String,
    },
    /// Impacts at one instant repeat without loss and without end: a body at e = 1 has no room to move.
    #[error("step {step}: bodies {:?} and {:?} collide endlessly at one instant: their restitution is 1, and there is no gap between them and their neighbours; leave a gap or choose a restitution below 1", bodies[0], bodies[1])]
    Endless {
        /// The step that failed.
        step: u64,
        /// Names of the two bodies.
        bodies: [String; 2],
    },
    /// A step had more events than [`EngineConfig::events_per_step`] allows.
    #[error("step {step}: more than {limit} events, the last between {}", bodies.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(" and "))]
    TooManyEvents {
        /// The step that failed.
        step: u64,
        /// The limit, [`EngineConfig::events_per_step`].
        limit: u64,
        /// Names of the bodies of the last event.
        bodies: Vec<String>,
    },
}

impl StepError {
    /// Returns the step that failed: its state is the last one of the run.
    pub fn step(&self) -> u64 {
        match self {
            StepError::NotFinite { step, .. }
            | StepError::Crushed { step, .. }
            | StepError::TooThin { step, .. }
            | StepError::Endless { step, .. }
            | StepError::TooManyEvents { step, .. } => *step,
        }
    }
}
