use super::{Error, Language, Progress, ReadExtent, ReadStatus, Source, StepGrid, recorded_world};
use crate::physics::{Body, BodyId, Collision, CollisionCount, Engine, Observer, Vector, World, larger};
use crate::recording::{Change, Error as RecordingError, Health, Item, Playback};
use crate::replay::Replayer;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

/// The world at one instant of a [`trace`].
pub struct TracePoint<'a> {
    /// Seconds since step 0.
    pub time: f64,
    /// The bodies. If the world is read from the recording, they have no names and materials.
    pub world: &'a World,
    /// True if states are missing between the last point and this one.
    pub is_after_gap: bool,
    /// True if bodies were spawned or deleted since the last state.
    pub is_after_change: bool,
}

/// Properties of the traced part of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// How completely the recording was read.
    pub status: ReadStatus,
    /// The times of spawns and deletes after the first state, s, in ascending order. Of several in one column only the
    /// last is listed.
    pub changes: Vec<f64>,
    /// The states that the recording lacks.
    pub gaps: Vec<TraceGap>,
}

/// A part of a run that is missing in its recording.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceGap {
    /// The missing steps.
    pub steps: RangeInclusive<u64>,
    /// The time of the last state before and of the first state after the gap, s.
    pub times: [f64; 2],
    /// The reason.
    pub reason: GapReason,
}

/// The reason why states are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GapReason {
    /// They were lost before the recording was recovered.
    Lost,
    /// They cannot be read.
    Unreadable,
}

impl GapReason {
    /// The reason in words that follow the steps.
    pub fn text(self, language: Language) -> &'static str {
        match self {
            GapReason::Lost => language.of("lost in a damaged recording", "perdus dans un enregistrement endommagé"),
            GapReason::Unreadable => language.of("unreadable", "illisibles"),
        }
    }
}

/// Passes the world in each state of `grid` to `visit`, in the order of time, and between two states the world before and
/// after each collision at its exact instant, and before spawns and deletes.
///
/// The handout's solver resolves all collisions of a step at its beginning: there, the velocities change at once. Positions
/// change from state to state, including the displacements that separate boxes.
///
/// The exact instants require a replay. They are omitted if steps are shorter than a column, `column` seconds, because
/// then no picture can show them; of several collisions in one column only the first is an instant. So both time and
/// memory are bounded by the number of columns, beyond reading the recording. A recording of another version of the
/// engine, which cannot be replayed, is traced by its states alone.
///
/// # Errors
/// If the recording cannot be read, diverges or has none of the states.
pub fn trace(
    source: &Source,
    grid: &StepGrid,
    column: f64,
    progress: Progress,
    mut visit: impl FnMut(TracePoint),
) -> Result<Trace, Error> {
    let changes = ChangeSteps::read(source, grid, column)?;
    let is_wide = grid.every == 1 && 1.0 / grid.rate >= column;
    let mut tracer =
        Tracer { source, grid, column, changes: &changes.0, last: None, gaps: Vec::new(), visit: &mut visit };
    let steps = source.steps_to_read(*grid.steps.start(), *grid.steps.end());
    let replayer = match is_wide {
        true => match Replayer::new(source.recording()?, steps) {
            Ok(replayer) => Some(replayer),
            Err(RecordingError::OtherSemantics { .. }) => None,
            Err(error) => return Err(source.read_error(error)),
        },
        false => None,
    };
    let (health, extent) = match replayer {
        Some(replayer) => tracer.replay(replayer, progress)?,
        None => tracer.play_back(progress)?,
    };
    if tracer.last.is_none() {
        return Err(source.missing_states(&grid.steps, health));
    }
    tracer.end();
    let gaps = tracer.gaps;
    let changes = changes.0.iter().map(|&step| step as f64 / grid.rate).collect();
    Ok(Trace { status: ReadStatus { path: source.path.clone(), health, extent }, changes, gaps })
}

/// The steps of a grid, without the first, at which bodies were spawned or deleted.
struct ChangeSteps(BTreeSet<u64>);

impl ChangeSteps {
    fn read(source: &Source, grid: &StepGrid, column: f64) -> Result<ChangeSteps, Error> {
        let mut steps: BTreeSet<u64> = BTreeSet::new();
        let first = grid.steps.start().div_ceil(grid.every) * grid.every;
        source
            .recording()?
            .for_each_event(|item| {
                let Item::Event(event) = item else { return };
                if event.step <= first || event.step > *grid.steps.end() {
                    return;
                }
                let (Change::Spawn { .. } | Change::Delete { .. }) = event.change;
                // Events are in ascending order of their steps.
                let last = steps.last().copied().filter(|last| {
                    let steps = event.step.checked_sub(*last);
                    steps.is_some_and(|steps| (steps as f64) < column * grid.rate)
                });
                if let Some(last) = last {
                    steps.remove(&last);
                }
                steps.insert(event.step);
            })
            .map_err(|error| source.read_error(error))?;
        Ok(ChangeSteps(steps))
    }
}

struct Tracer<'a> {
    source: &'a Source,
    grid: &'a StepGrid,
    column: f64,
    changes: &'a BTreeSet<u64>,
    /// The last state.
    last: Option<u64>,
    gaps: Vec<TraceGap>,
    visit: &'a mut dyn FnMut(TracePoint),
}

impl Tracer<'_> {
    /// Traces the recorded states.
    fn play_back(&mut self, progress: Progress) -> Result<(Health, ReadExtent), Error> {
        let mut playback = Playback::new(self.source.recording()?);
        playback.seek(*self.grid.steps.start()).map_err(|error| self.source.read_error(error))?;
        for state in playback.by_ref() {
            let state = state.map_err(|error| self.source.read_error(error))?;
            if state.step > *self.grid.steps.end() {
                return Ok((playback.health(), ReadExtent::LastStep));
            }
            if self.grid.contains(state.step) {
                self.state(state.step, &recorded_world(&state, &self.source.header.config));
                progress(state.step, *self.grid.steps.end());
            }
        }
        Ok((playback.health(), ReadExtent::End))
    }

    /// Traces a replay, with the exact instants between its states.
    fn replay<R: std::io::Read + std::io::Seek>(
        &mut self,
        mut replayer: Replayer<R>,
        progress: Progress,
    ) -> Result<(Health, ReadExtent), Error> {
        let mut instants =
            StepCollisions { step: 0, column: self.column, offsets: Vec::new(), changes: Some(Vec::new()) };
        let mut before: Option<Engine> = None;
        loop {
            let next = replayer.next_state(&mut instants).map_err(|error| self.source.read_error(error))?;
            let Some(step) = next else { break };
            if let Some(engine) = replayer.engine() {
                if let Some(before) = before.take().filter(|before| before.current_step() + 1 == step) {
                    self.between_states(before, engine.world(), &instants)?;
                }
                self.state(step, engine.world());
                before = Some(engine.clone());
            }
            instants = StepCollisions { step, offsets: Vec::new(), changes: Some(Vec::new()), ..instants };
            progress(step, *self.grid.steps.end());
        }
        let verdict = replayer.verdict();
        match verdict.health() {
            Some(health) => Ok((health, ReadExtent::End)),
            None => Err(Error::Diverged { path: self.source.path.clone(), verdict: Box::new(verdict) }),
        }
    }

    /// A state, and the gap before it if states are missing.
    fn state(&mut self, step: u64, world: &World) {
        let rate = self.grid.rate;
        let expected = self.expected();
        let is_after_gap = step > expected;
        if is_after_gap {
            self.add_gap(expected..=step - 1, step);
        }
        let is_after_change = self.last.is_some_and(|last| self.changes.range(last + 1..=step).next().is_some());
        (self.visit)(TracePoint { time: step as f64 / rate, world, is_after_gap, is_after_change });
        self.last = Some(step);
    }

    /// The step of the next state, if none is missing.
    fn expected(&self) -> u64 {
        let every = self.grid.every;
        self.last.map_or(self.grid.steps.start().div_ceil(every) * every, |last| last + every)
    }

    /// The gap after the last state, if states of the grid are missing there.
    fn end(&mut self) {
        let (expected, end) = (self.expected(), *self.grid.steps.end());
        if expected <= end {
            self.add_gap(expected..=end, end);
        }
    }

    /// The states of `steps` are missing, up to the time of step `until`.
    fn add_gap(&mut self, steps: RangeInclusive<u64>, until: u64) {
        let mut recovered = self.source.header.gaps.iter();
        let is_recovered = recovered.any(|gap| gap.first_missing() <= *steps.end() && gap.before >= *steps.start());
        let reason = if is_recovered { GapReason::Lost } else { GapReason::Unreadable };
        let from = self.last.unwrap_or(*steps.start());
        self.gaps.push(TraceGap { steps, times: [from, until].map(|step| step as f64 / self.grid.rate), reason });
    }

    /// The instants between a state and the next one, from the collisions alone, so each vertex costs no more than the
    /// positions of the bodies.
    fn within_moving_step(&mut self, mut moving: MovingWorld, collisions: &StepCollisions) {
        let (start, duration) = (collisions.step as f64 / self.grid.rate, 1.0 / self.grid.rate);
        let mut between = self.between(duration);
        let mut changes = collisions.changes.iter().flatten().peekable();
        let mut visit = |offset: f64, world: &World| {
            (self.visit)(TracePoint { time: start + offset, world, is_after_gap: false, is_after_change: false });
        };
        let margin = 4.0 * f64::EPSILON * (start + duration);
        for &collision in &collisions.offsets {
            while let Some(offset) = between.next_if(|&offset| offset < collision) {
                while let Some(change) = changes.next_if(|change| change.time <= offset) {
                    moving.apply(change);
                }
                visit(offset, moving.at(offset));
            }
            while let Some(change) = changes.next_if(|change| change.time < collision - margin) {
                moving.apply(change);
            }
            visit(collision, moving.at(collision));
            while let Some(change) = changes.next_if(|change| change.time <= collision + margin) {
                moving.apply(change);
            }
            if collision + margin < duration {
                visit(collision, moving.at(collision));
            }
        }
        for offset in between {
            while let Some(change) = changes.next_if(|change| change.time <= offset) {
                moving.apply(change);
            }
            visit(offset, moving.at(offset));
        }
    }

    /// The instants within a step of `duration` seconds at which curves are drawn because a force bends them.
    fn between(&self, duration: f64) -> std::iter::Peekable<impl Iterator<Item = f64> + use<>> {
        // Under a force the curves between two instants are not straight.
        let parts = match self.source.statistics.top_force > 0.0 {
            true => (duration / (SMOOTH_COLUMNS * self.column)).ceil().clamp(1.0, 1e4) as u32,
            false => 1,
        };
        (1..parts).map(move |part| f64::from(part) * duration / f64::from(parts)).peekable()
    }

    /// The instants between the state of `engine` and the next one, `next`.
    fn between_states(&mut self, engine: Engine, next: &World, collisions: &StepCollisions) -> Result<(), Error> {
        let (step, duration) = (engine.current_step(), 1.0 / self.grid.rate);
        let is_changed = self.changes.contains(&(step + 1));
        let is_continuous = self.source.header.config.solver.is_continuous();
        let moving = match is_continuous && !is_changed {
            true => MovingWorld::through(&engine, collisions, next, duration),
            false => None,
        };
        if let Some(moving) = moving {
            self.within_moving_step(moving, collisions);
            return Ok(());
        }
        if is_continuous {
            self.within_step(&engine, &collisions.offsets)?;
        }
        let mut end = None;
        if is_changed {
            let mut engine = engine.clone();
            let stepped = engine.step(&mut CollisionCount::default());
            stepped.map_err(|source| Error::Step { path: self.source.path.clone(), source })?;
            end = Some(engine);
        }
        let end = end.as_ref().map(Engine::world);
        let mut visit = |step: u64, world: &World| {
            let time = step as f64 / self.grid.rate;
            (self.visit)(TracePoint { time, world, is_after_gap: false, is_after_change: false });
        };
        if !is_continuous && !collisions.offsets.is_empty() {
            visit(step, &after_impulses(engine.world(), end.unwrap_or(next), duration));
        }
        end.into_iter().for_each(|end| visit(step + 1, end));
        Ok(())
    }

    /// The instants between the state of `engine` and the next one, computed by the engine once more.
    fn within_step(&mut self, engine: &Engine, collisions: &[f64]) -> Result<(), Error> {
        let (step, duration) = (engine.current_step(), 1.0 / self.grid.rate);
        let (start, mut ignored) = (step as f64 / self.grid.rate, CollisionCount::default());
        let mut between = self.between(duration);
        let mut within = engine.within_step();
        let mut world_after = |offset: f64| {
            let world = within.world_after(offset, &mut ignored);
            world.map_err(|source| Error::Step { path: self.source.path.clone(), source })
        };
        let mut visit = |offset: f64, world: &World| {
            (self.visit)(TracePoint { time: start + offset, world, is_after_gap: false, is_after_change: false });
        };
        for &collision in collisions {
            while let Some(offset) = between.next_if(|&offset| offset < collision) {
                visit(offset, &world_after(offset)?);
            }
            // Before and after the collision, whose instant is rounded like a time since step 0.
            let margin = 4.0 * f64::EPSILON * (start + duration);
            for offset in [collision - margin, collision + margin] {
                if offset > 0.0 && offset < duration {
                    visit(collision, &world_after(offset)?);
                }
            }
        }
        for offset in between {
            visit(offset, &world_after(offset)?);
        }
        Ok(())
    }
}

/// The world at the beginning of a step of the handout's solver, from `start` to `end`, after its impulses: the velocities
/// are those at the end, without the change that forces have caused since.
fn after_impulses(start: &World, end: &World, duration: f64) -> World {
    let mut world = MovingWorld::new(start);
    for (at, body) in world.world.bodies.iter_mut().enumerate() {
        if let Ok(after) = end.bodies.binary_search_by_key(&body.id, |body| body.id) {
            body.velocity = end.bodies[after].velocity.sub(world.accelerations[at].mult(duration));
        }
    }
    world.world
}

/// The distance of points on curves that are not straight, in columns.
const SMOOTH_COLUMNS: f64 = 8.0;

/// The collisions of a step.
struct StepCollisions {
    step: u64,
    column: f64,
    /// The first instant of a collision in each column, s after the start of the step.
    offsets: Vec<f64>,
    /// The velocities after each collision, in order; `None` if there are more than [`MAX_CHANGES`].
    changes: Option<Vec<VelocityChange>>,
}

/// The largest number of collisions of a step that are kept, 8 MB.
const MAX_CHANGES: usize = 100_000;

/// The velocities of two bodies after a collision.
struct VelocityChange {
    /// Seconds after the start of the step.
    time: f64,
    bodies: [BodyId; 2],
    after: [Vector; 2],
}

impl Observer for StepCollisions {
    fn collision(&mut self, collision: &Collision) {
        if collision.step != self.step || collision.impulse == 0.0 {
            return;
        }
        let &Collision { time, bodies, after, .. } = collision;
        if self.offsets.last().is_none_or(|last| time - last >= self.column) {
            self.offsets.push(time);
        }
        match &mut self.changes {
            Some(changes) if changes.len() < MAX_CHANGES => changes.push(VelocityChange { time, bodies, after }),
            _ => self.changes = None,
        }
    }
}

/// The world within a step, moved on from its start by the collisions of two bodies each. Bodies move uniformly
/// accelerated in between.
struct MovingWorld {
    world: World,
    /// The instant of the position and velocity of each body, s after the start of the step.
    since: Vec<f64>,
    accelerations: Vec<Vector>,
}

impl MovingWorld {
    /// The world at the start of a step, if its collisions explain the state at the end: no body rests on another or is
    /// pushed together with one, and all collisions are known.
    fn through(engine: &Engine, collisions: &StepCollisions, end: &World, duration: f64) -> Option<MovingWorld> {
        let start = engine.world();
        let changes = collisions.changes.as_ref()?;
        let new = || MovingWorld::new(start);
        let mut moved = new();
        changes.iter().for_each(|change| moved.apply(change));
        let moved = moved.at(duration);
        let size = |value: Vector| larger(value.x.abs(), value.y.abs());
        let reach = end.bodies.iter().map(|body| size(body.rect.far_corner())).fold(0.0, larger);
        let speed = end.bodies.iter().map(|body| size(body.velocity)).fold(0.0, larger);
        let is_near = |a: Vector, b: Vector, scale: f64| size(a.sub(b)) <= 1e-9 * scale;
        let is_explained = moved.bodies.len() == end.bodies.len()
            && moved.bodies.iter().zip(&end.bodies).all(|(a, b)| {
                a.id == b.id
                    && is_near(a.rect.origin, b.rect.origin, reach + speed * duration)
                    && is_near(a.velocity, b.velocity, speed)
            });
        is_explained.then(new)
    }

    fn new(start: &World) -> MovingWorld {
        let world = World {
            // Names are not needed, and would have to be copied.
            bodies: start.bodies.iter().map(|body| Body { name: String::new(), ..body.clone() }).collect(),
            gravity: start.gravity,
            restitution: start.restitution.clone(),
        };
        let gravity = start.gravity.unwrap_or(Vector::ZERO);
        let acceleration = |body: &Body| match body.mass.is_finite() {
            true => gravity.add(body.constant_force.mult(1.0 / body.mass)),
            false => Vector::ZERO,
        };
        MovingWorld {
            since: vec![0.0; world.bodies.len()],
            accelerations: world.bodies.iter().map(acceleration).collect(),
            world,
        }
    }

    /// Moves a body to an instant of the step.
    fn advance(&mut self, at: usize, time: f64) {
        let (body, elapsed) = (&mut self.world.bodies[at], time - self.since[at]);
        let change = self.accelerations[at].mult(elapsed);
        let mean = body.velocity.add(change.mult(0.5));
        body.rect.origin = body.rect.origin.add(mean.mult(elapsed));
        body.velocity = body.velocity.add(change);
        self.since[at] = time;
    }

    fn apply(&mut self, change: &VelocityChange) {
        for (id, velocity) in change.bodies.iter().zip(change.after) {
            if let Ok(at) = self.world.bodies.binary_search_by_key(id, |body| body.id) {
                self.advance(at, change.time);
                self.world.bodies[at].velocity = velocity;
            }
        }
    }

    /// The world at an instant of the step that is not before the last collision.
    fn at(&mut self, time: f64) -> &World {
        (0..self.world.bodies.len()).for_each(|at| self.advance(at, time));
        &self.world
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Thinning;
    use crate::picture::figures::EnergySample;
    use crate::replay::{self, ALL_STEPS, RecordOptions};
    use crate::scene;
    use std::fs::File;

    /// Two boxes between walls, and a third that comes and goes, at `rate` Hz for four seconds.
    fn source(folder: &std::path::Path, rate: u64, e: f64) -> Source {
        source_of(folder, rate, e, "event-driven")
    }

    fn source_of(folder: &std::path::Path, rate: u64, e: f64, solver: &str) -> Source {
        let body = |name: &str, x: f64, y: f64, velocity: f64| {
            format!(
                "[[spawn]]\nname = \"{name}\"\nat = [{x:?}, {y:?}]\nsize = [1.0, 1.0]\nmass = 1.0\nvelocity = [{velocity:?}, 0.0]\n"
            )
        };
        let text = format!(
            "[world]\nsize = [16.0, 9.0]\nwalls = true\n[run]\nrate = {rate}\nsteps = {}\nsolver = \"{solver}\"\n[restitution]\ndefault = {e:?}\n{}{}{}\
             step = {rate}\n[[delete]]\nstep = {}\nname = \"late\"\n",
            4 * rate,
            body("a", 3.0, 1.0, 7.0),
            body("b", 8.0, 1.0, -5.0),
            body("late", 8.0, 5.0, 3.0),
            rate + rate / 2,
        );
        let path = folder.join(format!("{rate}.mcap"));
        let scene = scene::parse("scene.toml", &text).unwrap();
        replay::record(
            &scene,
            RecordOptions::complete(&scene),
            replay::NO_LIVE_EVENTS,
            File::create(&path).unwrap(),
            |_| (),
        )
        .unwrap();
        Source::open(&path).unwrap()
    }

    /// Time, kinetic energy, and the flags of each point.
    fn points(source: &Source, column: f64) -> (Vec<(f64, f64, bool)>, Trace) {
        let grid = StepGrid::new(0..=source.header.steps, source.header.config.rate, Thinning::All);
        let mut points = Vec::new();
        let visit = |point: TracePoint| {
            points.push((point.time, point.world.kinetic_energy(), point.is_after_change));
        };
        let trace = trace(source, &grid, column, &mut |_, _| (), visit).unwrap();
        (points, trace)
    }

    #[test]
    fn collisions_are_vertical_steps_at_their_instants_at_every_rate() {
        let folder = tempfile::tempdir().unwrap();
        for rate in [4, 20, 64] {
            let source = source(folder.path(), rate, 0.9);
            let (points, _) = points(&source, 1e-6);
            let mut collisions: Vec<Collision> = Vec::new();
            let recording = source.recording().unwrap();
            Replayer::new(recording, ALL_STEPS).unwrap().run(&mut collisions, |_| ()).unwrap();
            collisions.retain(|collision| collision.impulse != 0.0);
            assert!(collisions.len() > 3, "{} collisions at {rate} Hz", collisions.len());
            let mut lost = 0.0;
            for collision in &collisions {
                let at = |&(time, ..): &(f64, f64, bool)| (time - collision.instant).abs() < 1e-12;
                let energies: Vec<f64> = points.iter().filter(|point| at(point)).map(|point| point.1).collect();
                let [before, .., after] = energies[..] else {
                    panic!("{} at {rate} Hz: {energies:?}", collision.instant)
                };
                assert!(after < before, "{} at {rate} Hz: {energies:?}", collision.instant);
                lost += before - after;
            }
            // Between collisions, spawns and deletes nothing changes: there are no ramps.
            let jumps = points.windows(2).filter(|pair| pair[0].0 == pair[1].0);
            let (all, vertical) =
                (points.windows(2).map(|pair| pair[1].1 - pair[0].1), jumps.map(|pair| pair[1].1 - pair[0].1));
            assert!((all.sum::<f64>() - vertical.sum::<f64>()).abs() < 1e-9 && lost > 1.0, "at {rate} Hz");
        }
    }

    #[test]
    fn impulses_of_the_handout_solver_are_vertical_steps_at_the_beginning_of_their_step() {
        let folder = tempfile::tempdir().unwrap();
        for rate in [20, 64] {
            let source = source_of(folder.path(), rate, 0.9, "handout");
            let (points, _) = points(&source, 1e-6);
            let mut collisions: Vec<Collision> = Vec::new();
            Replayer::new(source.recording().unwrap(), ALL_STEPS).unwrap().run(&mut collisions, |_| ()).unwrap();
            collisions.retain(|collision| collision.impulse != 0.0);
            assert!(collisions.len() > 3, "{} collisions at {rate} Hz", collisions.len());
            for collision in &collisions {
                let at = |&(time, ..): &(f64, f64, bool)| (time - collision.instant).abs() < 1e-12;
                let energies: Vec<f64> = points.iter().filter(|point| at(point)).map(|point| point.1).collect();
                assert!(energies.last() < energies.first(), "{} at {rate} Hz: {energies:?}", collision.instant);
            }
            let ramps = points.windows(2).filter(|pair| pair[0].0 != pair[1].0 && pair[0].1 != pair[1].1);
            assert_eq!(ramps.count(), 0, "at {rate} Hz");
        }
    }

    /// With weight and a constant force: between the vertical steps, the velocity changes as these forces demand.
    #[test]
    fn forces_act_after_the_impulses_of_a_step_of_the_handout_solver() {
        let folder = tempfile::tempdir().unwrap();
        let text = "[world]\nsize = [16.0, 9.0]\nwalls = true\ngravity = [0.0, 8.0]\n[run]\nrate = 32\nsteps = 96\n\
            solver = \"handout\"\n[restitution]\ndefault = 0.5\n[[spawn]]\nat = [3.0, 6.0]\nsize = [1.0, 1.0]\nmass = 2.0\n\
            velocity = [1.0, 0.0]\nforce = [4.0, 0.0]\n";
        let path = folder.path().join("fall.mcap");
        let scene = scene::parse("scene.toml", text).unwrap();
        let options = RecordOptions::complete(&scene);
        replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
        let source = Source::open(&path).unwrap();
        let grid = StepGrid::new(0..=96, 32.0, Thinning::All);
        let mut points = Vec::new();
        let visit = |point: TracePoint| points.push((point.time, point.world.bodies.last().unwrap().velocity));
        trace(&source, &grid, 1e-6, &mut |_, _| (), visit).unwrap();
        let steps = points.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        assert!(steps.clone().count() > 10 && steps.clone().all(|pair| pair[1].1.y <= 0.0), "{points:?}");
        for pair in points.windows(2).filter(|pair| pair[0].0 < pair[1].0) {
            assert_eq!(pair[1].1.sub(pair[0].1), Vector::new(2.0 / 32.0, 8.0 / 32.0), "{pair:?}");
        }
    }

    #[test]
    fn spawns_and_deletes_are_vertical_steps_and_are_listed() {
        let folder = tempfile::tempdir().unwrap();
        let (points, trace) = points(&source(folder.path(), 20, 1.0), 1e-6);
        assert_eq!((trace.changes, trace.gaps.len()), (vec![1.0, 1.5], 0));
        for time in [1.0, 1.5] {
            let energies: Vec<f64> = points.iter().filter(|point| point.0 == time).map(|point| point.1).collect();
            assert_eq!(energies, if time == 1.0 { [37.0, 41.5] } else { [41.5, 37.0] });
        }
        assert_eq!(points.iter().filter(|point| point.2).map(|point| point.0).collect::<Vec<f64>>(), [1.0, 1.5]);
    }

    /// A scene of some bodies that come and go, with or without walls, weight, constant forces and losses.
    fn random_scene(seed: u32) -> String {
        let mut state = seed.wrapping_mul(2_654_435_769) | 1;
        let mut random = |from: f64, to: f64| {
            // Marsaglia's xorshift.
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            from + (to - from) * f64::from(state >> 8) / f64::from(1 << 24)
        };
        let solver = ["handout", "event-driven"][seed as usize % 2];
        let gravity = if (seed / 2).is_multiple_of(2) { "" } else { "gravity = [0.5, 9.81]\n" };
        let rate = random(10.0, 70.0).round();
        let mut text = format!(
            "[world]\nsize = [16.0, 9.0]\nwalls = {}\n{gravity}[run]\nrate = {rate}\nsteps = 60\nsolver = \"{solver}\"\n\
             [restitution]\ndefault = {:?}\n",
            !seed.is_multiple_of(3),
            random(0.2, 1.0),
        );
        for body in 0..6 {
            let at = [1.0 + 2.3 * f64::from(body), random(1.0, 7.0)];
            let (size, velocity) = ([random(0.2, 1.0), random(0.2, 1.0)], [random(-6.0, 6.0), random(-6.0, 6.0)]);
            let (step, mass) = (if body < 3 { 0.0 } else { random(1.0, 30.0).round() }, random(0.1, 9.0));
            text += &format!(
                "[[spawn]]\nname = \"b{body}\"\nstep = {step}\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\n\
                 velocity = {velocity:?}\n"
            );
            if seed.is_multiple_of(5) && body % 2 == 0 {
                text += &format!("force = [{:?}, {:?}]\n", random(-3.0, 3.0), random(-3.0, 3.0));
            }
            if body % 2 == 1 {
                text += &format!("[[delete]]\nstep = {}\nname = \"b{body}\"\n", random(31.0, 58.0).round());
            }
        }
        text
    }

    /// The energies of a figure are those of the table, which are computed from the recorded states.
    #[test]
    fn the_energy_of_each_state_is_that_of_the_exported_table_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let (mut with_potential, mut compared) = (0, 0);
        for seed in 0..60 {
            let path = folder.path().join(format!("{seed}.mcap"));
            let scene = scene::parse("scene.toml", &random_scene(seed)).unwrap();
            let options = RecordOptions::complete(&scene);
            replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
            let source = Source::open(&path).unwrap();
            let bits = |sample: EnergySample| {
                let EnergySample { kinetic, potential, momentum, .. } = sample;
                [kinetic, potential, sample.total(), momentum.x, momentum.y].map(f64::to_bits)
            };
            let table: Vec<(f64, [u64; 5])> = Playback::new(source.recording().unwrap())
                .map(|state| state.unwrap())
                .map(|state| (state.time, EnergySample::of(&recorded_world(&state, &source.header.config), state.time)))
                .map(|(time, sample)| (time, bits(sample)))
                .collect();
            let grid = StepGrid::new(0..=source.header.steps, source.header.config.rate, Thinning::All);
            for column in [1e-6, 1.0] {
                let mut drawn = Vec::new();
                let visit =
                    |point: TracePoint| drawn.push((point.time, bits(EnergySample::of(point.world, point.time))));
                trace(&source, &grid, column, &mut |_, _| (), visit).unwrap();
                for row in &table {
                    assert!(drawn.contains(row), "seed {seed}, t = {}: {row:?} is not drawn", row.0);
                    compared += 1;
                }
            }
            with_potential += u32::from(table.iter().any(|row| f64::from_bits(row.1[1]) != 0.0));
        }
        assert!(with_potential > 20 && with_potential < 50 && compared > 5000, "{with_potential}, {compared}");
    }

    #[test]
    fn wide_columns_need_no_replay_and_show_the_states_alone() {
        let folder = tempfile::tempdir().unwrap();
        let (points, trace) = points(&source(folder.path(), 64, 0.5), 0.1);
        assert_eq!((points.len(), trace.changes.len()), (257, 2));
    }
}
