use super::impacts::Impacts;
use super::moving_world::{MovingWorld, StepCollisions, after_impulses};
use super::{Appearance, Error, Language, Progress, ReadExtent, ReadStatus, Source, StepGrid, recorded_world};
use crate::physics::{BodyId, Collision, Engine, Observer, World, smaller};
use crate::recording::{Change, Error as RecordingError, Health, Item, Playback};
use crate::replay::Replayer;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// A part of a [`trace`].
pub enum Traced<'a> {
    /// The world at one instant.
    World(TracePoint<'a>),
    /// The colliding bodies at one instant.
    Impacts(&'a Impacts),
}

/// The parts of a [`trace`] between the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// None.
    Nothing,
    /// The world before and after collisions, spawns and deletes.
    Worlds,
    /// The same, and the colliding bodies at all other collisions.
    Collisions,
}

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

/// Passes the world in each state of `grid` to `visit`, in the order of time, and what `between` demands: between two
/// states the world before and after collisions at their exact instants, and before spawns and deletes. With anything
/// between the states, these are all states of the run in the steps of `grid`, also those that the recording does not
/// store.
///
/// The handout's solver resolves all collisions of a step at its beginning: there, the velocities change at once.
/// Positions change from state to state, including the displacements that separate boxes.
///
/// The exact instants require a replay. Of several collisions in one column of `column` seconds only the first is shown
/// with the whole world, and none if steps are shorter than a column. Of the others of the event-driven solver, the
/// bodies that collide are passed on, so that no motion is lost, however fast. So memory is bounded by the number of
/// columns, and time by a replay. A recording of another version of the engine, which cannot be replayed, is traced by
/// its states in `grid` alone.
///
/// # Errors
/// If the recording cannot be read, diverges or has none of the states.
pub fn trace(
    source: &Source,
    grid: &StepGrid,
    column: f64,
    between: Between,
    progress: Progress,
    mut visit: impl FnMut(Traced),
) -> Result<Trace, Error> {
    let has_worlds = between != Between::Nothing && 1.0 / grid.rate >= column;
    let has_impacts = between == Between::Collisions && source.header.config.solver.is_continuous();
    let has_more_states = between == Between::Collisions && (grid.every > 1 || source.header.every > 1);
    let steps = source.steps_to_read(*grid.steps.start(), *grid.steps.end());
    let replayer = if has_worlds || has_impacts || has_more_states {
        match Replayer::new(source.recording()?, steps) {
            Ok(replayer) => Some(replayer),
            Err(RecordingError::OtherSemantics { .. }) => None,
            Err(error) => return Err(source.read_error(error)),
        }
    } else {
        None
    };
    let every = if replayer.is_some() { 1 } else { grid.every };
    let grid = &StepGrid { every, ..grid.clone() };
    let changes = ChangeSteps::read(source, grid, column)?;
    let appearances = if has_impacts { source.appearances()? } else { BTreeMap::new() };
    let mut tracer = Tracer {
        source,
        grid,
        column,
        changes: &changes.0,
        appearances: &appearances,
        last: None,
        gaps: Vec::new(),
        visit: &mut visit,
    };
    let (health, extent) = match replayer {
        Some(replayer) if has_worlds => tracer.replay(replayer, progress)?,
        Some(replayer) => tracer.replay_collisions(replayer, progress)?,
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
                let (Change::Spawn(_) | Change::Delete { .. }) = event.change;
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
    /// The bodies whose collisions are passed on.
    appearances: &'a BTreeMap<BodyId, Arc<Appearance>>,
    /// The last state.
    last: Option<u64>,
    gaps: Vec<TraceGap>,
    visit: &'a mut dyn FnMut(Traced),
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
        let end = *self.grid.steps.end();
        loop {
            let next = replayer.next_state(&mut instants).map_err(|error| self.source.read_error(error))?;
            let Some(step) = next else { break };
            // The rest of the file is read for its health alone.
            if step > end {
                continue;
            }
            if let Some(engine) = replayer.engine() {
                if let Some(before) = before.take().filter(|before| before.current_step() + 1 == step) {
                    self.between_states(before, engine.world(), &instants)?;
                }
                self.state(step, engine.world());
                before = Some(engine.clone());
            }
            instants = StepCollisions { step, offsets: Vec::new(), changes: Some(Vec::new()), ..instants };
            progress(step, end);
        }
        self.read_to_end(&replayer)
    }

    /// Traces a replay, with the colliding bodies between its states.
    fn replay_collisions<R: std::io::Read + std::io::Seek>(
        &mut self,
        mut replayer: Replayer<R>,
        progress: Progress,
    ) -> Result<(Health, ReadExtent), Error> {
        let end = *self.grid.steps.end();
        // The step of the last state of the replay, after which its collisions are passed on.
        let mut reached: Option<u64> = None;
        loop {
            let source = self.source;
            let mut observer = match reached {
                Some(step) if step < end => Some(self.step(step)),
                Some(_) | None => None,
            };
            let next = replayer.next_state(&mut observer).map_err(|error| source.read_error(error))?;
            observer.into_iter().for_each(|mut step| step.end_instant());
            let Some(step) = next else { break };
            reached = None;
            if let Some(engine) = replayer.engine() {
                if self.grid.contains(step) {
                    self.state(step, engine.world());
                }
                reached = self.last.is_some().then_some(step);
            }
            progress(step, end);
        }
        self.read_to_end(&replayer)
    }

    /// The health of a recording after its replay.
    fn read_to_end<R: std::io::Read + std::io::Seek>(
        &self,
        replayer: &Replayer<R>,
    ) -> Result<(Health, ReadExtent), Error> {
        let verdict = replayer.verdict();
        match verdict.health() {
            Some(health) => Ok((health, ReadExtent::End)),
            None => Err(Error::Diverged { path: self.source.path.clone(), verdict: Box::new(verdict) }),
        }
    }

    /// The parts of the trace in a step.
    fn step(&mut self, step: u64) -> TracedStep<'_> {
        let [start, end] = [step, step + 1].map(|step| step as f64 / self.grid.rate);
        let margin = 4.0 * f64::EPSILON * end;
        let impacts = Impacts::default();
        TracedStep { step, start, end, margin, impacts, appearances: self.appearances, visit: &mut *self.visit }
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
        (self.visit)(Traced::World(TracePoint { time: step as f64 / rate, world, is_after_gap, is_after_change }));
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
        let duration = 1.0 / self.grid.rate;
        let mut between = self.between(duration);
        let mut changes = collisions.changes.iter().flatten().peekable();
        let mut step = self.step(collisions.step);
        let margin = step.margin;
        for &collision in &collisions.offsets {
            while let Some(offset) = between.next_if(|&offset| offset < collision) {
                while let Some(change) = changes.next_if(|change| change.time <= offset) {
                    moving.apply(change);
                    step.collision(change);
                }
                step.world(offset, moving.at(offset));
            }
            while let Some(change) = changes.next_if(|change| change.time < collision - margin) {
                moving.apply(change);
                step.collision(change);
            }
            step.world(collision, moving.at(collision));
            while let Some(change) = changes.next_if(|change| change.time <= collision + margin) {
                moving.apply(change);
            }
            if collision + margin < duration {
                step.world(collision, moving.at(collision));
            }
        }
        for offset in between {
            while let Some(change) = changes.next_if(|change| change.time <= offset) {
                moving.apply(change);
                step.collision(change);
            }
            step.world(offset, moving.at(offset));
        }
        changes.for_each(|change| step.collision(change));
        step.end_instant();
    }

    /// The instants within a step of `duration` seconds at which curves are drawn because a force bends them.
    fn between(&self, duration: f64) -> std::iter::Peekable<impl Iterator<Item = f64> + use<>> {
        // Under a force the curves between two instants are not straight.
        let parts = if self.source.statistics.top_force > 0.0 {
            (duration / (SMOOTH_COLUMNS * self.column)).ceil().clamp(1.0, 1e4) as u32
        } else {
            1
        };
        (1..parts).map(move |part| f64::from(part) * duration / f64::from(parts)).peekable()
    }

    /// The instants between the state of `engine` and the next one, `next`.
    fn between_states(&mut self, engine: Engine, next: &World, collisions: &StepCollisions) -> Result<(), Error> {
        let (step, duration) = (engine.current_step(), 1.0 / self.grid.rate);
        let is_changed = self.changes.contains(&(step + 1));
        let is_continuous = self.source.header.config.solver.is_continuous();
        let moving =
            if is_continuous && !is_changed { MovingWorld::through(&engine, collisions, next, duration) } else { None };
        if let Some(moving) = moving {
            self.within_moving_step(moving, collisions);
            return Ok(());
        }
        if is_continuous {
            self.within_step(&engine, collisions)?;
        }
        let mut end = None;
        if is_changed {
            let mut engine = engine.clone();
            let stepped = engine.step(&mut Vec::new());
            stepped.map_err(|source| Error::Step { path: self.source.path.clone(), source })?;
            end = Some(engine);
        }
        let end = end.as_ref().map(Engine::world);
        let mut visits = self.step(step);
        if !is_continuous && !collisions.offsets.is_empty() {
            visits.world(0.0, &after_impulses(engine.world(), end.unwrap_or(next), duration));
        }
        end.into_iter().for_each(|end| self.step(step + 1).world(0.0, end));
        Ok(())
    }

    /// The instants between the state of `engine` and the next one, computed by the engine once more.
    fn within_step(&mut self, engine: &Engine, collisions: &StepCollisions) -> Result<(), Error> {
        let (source, duration) = (self.source, 1.0 / self.grid.rate);
        let mut between = self.between(duration);
        let mut within = engine.within_step();
        let failed = |error| Error::Step { path: source.path.clone(), source: error };
        let mut step = self.step(engine.current_step());
        for &collision in &collisions.offsets {
            while let Some(offset) = between.next_if(|&offset| offset < collision) {
                let world = within.world_after(offset, &mut step).map_err(failed)?;
                step.world(offset, &world);
            }
            // Before and after the collision, whose instant is rounded like a time since step 0.
            let (before, after) = (collision - step.margin, collision + step.margin);
            if before > 0.0 {
                let world = within.world_after(before, &mut step).map_err(failed)?;
                step.world(collision, &world);
            }
            if after < duration {
                let world = within.world_after(after, &mut Vec::new()).map_err(failed)?;
                step.world(collision, &world);
            }
        }
        for offset in between {
            let world = within.world_after(offset, &mut step).map_err(failed)?;
            step.world(offset, &world);
        }
        let has_others = collisions.changes.as_ref().is_none_or(|changes| changes.len() > collisions.offsets.len());
        if has_others && !step.appearances.is_empty() {
            within.world_after(duration, &mut step).map_err(failed)?;
        }
        step.end_instant();
        Ok(())
    }
}

/// The parts of a trace in one step. As an observer, it passes on the bodies of collisions.
struct TracedStep<'a> {
    step: u64,
    /// The time of the step, s.
    start: f64,
    /// The time of the next step, s.
    end: f64,
    /// The rounding error of times in the step, s.
    margin: f64,
    /// The collisions at the last instant, which may not be all.
    impacts: Impacts,
    appearances: &'a BTreeMap<BodyId, Arc<Appearance>>,
    visit: &'a mut dyn FnMut(Traced),
}

impl TracedStep<'_> {
    /// The time `offset` seconds after the start of the step, which is not after its end by rounding.
    fn time(&self, offset: f64) -> f64 {
        smaller(self.start + offset, self.end)
    }

    /// Passes on the world at an instant, s after the start of the step.
    fn world(&mut self, offset: f64, world: &World) {
        self.end_instant();
        let time = self.time(offset);
        (self.visit)(Traced::World(TracePoint { time, world, is_after_gap: false, is_after_change: false }));
    }

    /// Passes on the collisions of the last instant.
    fn end_instant(&mut self) {
        let impacts = std::mem::take(&mut self.impacts);
        if !impacts.bodies.is_empty() {
            (self.visit)(Traced::Impacts(&impacts));
        }
    }
}

impl Observer for TracedStep<'_> {
    fn collision(&mut self, collision: &Collision) {
        if collision.step != self.step || collision.impulse == 0.0 || self.appearances.is_empty() {
            return;
        }
        let time = self.time(collision.time);
        if time > self.impacts.time + self.margin {
            self.end_instant();
        }
        if self.impacts.bodies.is_empty() {
            self.impacts.time = time;
        }
        self.impacts.add(collision, self.appearances);
    }
}

/// The distance of points on curves that are not straight, in columns.
const SMOOTH_COLUMNS: f64 = 8.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Vector;
    use crate::picture::Thinning;
    use crate::picture::figures::{EnergySample, SystemSums, TimeCurve};
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
        let visit = |traced: Traced| {
            if let Traced::World(point) = traced {
                points.push((point.time, point.world.kinetic_energy(), point.is_after_change));
            }
        };
        let trace = trace(source, &grid, column, Between::Collisions, &mut |_, _| (), visit).unwrap();
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
        let visit = |traced: Traced| match traced {
            Traced::World(point) => points.push((point.time, point.world.bodies.last().unwrap().velocity)),
            Traced::Impacts(impacts) => panic!("{impacts:?}"),
        };
        trace(&source, &grid, 1e-6, Between::Collisions, &mut |_, _| (), visit).unwrap();
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
        let seeds = if cfg!(debug_assertions) { 20 } else { 60 };
        for seed in 0..seeds {
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
                let visit = |traced: Traced| {
                    if let Traced::World(point) = traced {
                        drawn.push((point.time, bits(EnergySample::of(point.world, point.time))));
                    }
                };
                trace(&source, &grid, column, Between::Collisions, &mut |_, _| (), visit).unwrap();
                for row in &table {
                    assert!(drawn.contains(row), "seed {seed}, t = {}: {row:?} is not drawn", row.0);
                    compared += 1;
                }
            }
            with_potential += u32::from(table.iter().any(|row| f64::from_bits(row.1[1]) != 0.0));
        }
        let of_seeds = |fraction: f64| f64::from(with_potential) > fraction * seeds as f64;
        assert!(of_seeds(0.3) && !of_seeds(0.85) && compared > 80 * seeds, "{with_potential}, {compared}");
    }

    /// Thinned figures, and those of a recording that stores few states in full, show the same motion, in every range of
    /// steps: where a body moves while others collide, sums over all bodies have its present values, and what happens
    /// after the range is no part of it.
    #[test]
    fn thinned_runs_are_traced_like_complete_ones() {
        let folder = tempfile::tempdir().unwrap();
        let sums = |source: &Source, every: u64, column: f64, steps: &RangeInclusive<u64>| {
            let grid = StepGrid::new(steps.clone(), source.header.config.rate, Thinning::Every(every));
            let (mut sums, mut samples) = (SystemSums::default(), Vec::new());
            let visit = |part: Traced| match part {
                Traced::World(point) => {
                    let sample = EnergySample::of(point.world, point.time);
                    sums.set(point.world, sample);
                    samples.push(sample);
                }
                Traced::Impacts(impacts) => samples.extend(sums.collide(impacts).into_iter().flatten()),
            };
            let trace = trace(source, &grid, column, Between::Collisions, &mut |_, _| (), visit).unwrap();
            (samples, trace.changes, trace.gaps)
        };
        for seed in 0..12 {
            let scene = scene::parse("scene.toml", &random_scene(seed)).unwrap();
            let sources = [1, 7, 10].map(|every| {
                let path = folder.path().join(format!("{seed}-{every}.mcap"));
                let options = RecordOptions::complete(&scene).every(every);
                replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
                Source::open(&path).unwrap()
            });
            for column in [1e-6, 0.02, 1.0] {
                for steps in [0..=60, 0..=56, 0..=57, 30..=59, 58..=60, 60..=60] {
                    let complete = sums(&sources[0], 1, column, &steps);
                    for (source, every) in [(0, 30), (1, 1), (2, 10)] {
                        let is_at_multiple = steps.start().is_multiple_of(every);
                        let is_same = !is_at_multiple || sums(&sources[source], every, column, &steps) == complete;
                        assert!(is_same, "seed {seed}, column {column}, steps {steps:?}, recording {source}");
                    }
                }
            }
        }
    }

    /// A ball that crosses a slot 100 times per second, with or without weight.
    fn slot(folder: &std::path::Path, rate: u32, gravity: &str) -> Source {
        let text = format!(
            "world = {{ size = [1.6, 0.9]{gravity} }}\nrun = {{ duration = 4.0, rate = {rate} }}\n\
             [[spawn]]\nname = \"left\"\nat = [0.0, 0.0]\nsize = [0.5, 0.9]\nmass = inf\n\
             [[spawn]]\nname = \"right\"\nat = [1.1, 0.0]\nsize = [0.5, 0.9]\nmass = inf\n\
             [[spawn]]\nname = \"ball\"\nat = [0.5, 0.4]\nsize = [0.1, 0.1]\nmass = 2.0\nvelocity = [50.0, 0.0]\n"
        );
        let scene = scene::parse("scene.toml", &text).unwrap();
        let path = folder.join(format!("{rate}{}.mcap", gravity.len()));
        let options = RecordOptions::complete(&scene);
        replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
        Source::open(&path).unwrap()
    }

    /// Every crossing is in the trace, if several collisions are in a column and if several steps are.
    #[test]
    fn the_colliding_bodies_are_traced_at_every_collision() {
        let folder = tempfile::tempdir().unwrap();
        for (rate, column) in [(10, 0.05), (1000, 0.05), (10, 1e-6)] {
            let source = slot(folder.path(), rate, "");
            let mut collisions: Vec<Collision> = Vec::new();
            Replayer::new(source.recording().unwrap(), ALL_STEPS).unwrap().run(&mut collisions, |_| ()).unwrap();
            let grid = StepGrid::new(0..=source.header.steps, f64::from(rate), Thinning::All);
            let (mut traced, mut last) = (Vec::new(), 0.0);
            let visit = |part: Traced| {
                let (time, at) = match part {
                    Traced::World(point) => (point.time, point.world.bodies[2].rect.origin.x),
                    Traced::Impacts(impacts) => {
                        assert!(impacts.are_complete(), "{impacts:?}");
                        (impacts.time, impacts.bodies[&2].rect.origin.x)
                    }
                };
                assert!(time >= last, "{time} after {last}");
                last = time;
                traced.push((time, at));
            };
            trace(&source, &grid, column, Between::Collisions, &mut |_, _| (), visit).unwrap();
            assert!(collisions.len() > 390, "{}", collisions.len());
            for Collision { instant, rects, .. } in &collisions {
                let expected = rects.iter().find(|rect| rect.width() == 0.1).unwrap().origin.x;
                let is_shown = |(time, at): &(f64, f64)| (time - instant).abs() < 1e-9 && (at - expected).abs() < 1e-9;
                assert!(traced.iter().any(is_shown), "{instant} at {rate} Hz, column {column}");
            }
        }
    }

    #[test]
    fn figures_show_fast_motion_as_a_band() {
        let folder = tempfile::tempdir().unwrap();
        for (rate, gravity) in
            [(10, ""), (1000, ""), (10, ", gravity = [30.0, 0.0]"), (1000, ", gravity = [30.0, 0.0]")]
        {
            let source = slot(folder.path(), rate, gravity);
            let grid = StepGrid::new(0..=source.header.steps, f64::from(rate), Thinning::All);
            let mut sums = SystemSums::default();
            let (mut momenta, mut energies) = (TimeCurve::new(0.05), TimeCurve::new(0.05));
            let visit = |part: Traced| {
                let samples = match part {
                    Traced::World(point) => {
                        let sample = EnergySample::of(point.world, point.time);
                        sums.set(point.world, sample);
                        vec![sample]
                    }
                    Traced::Impacts(impacts) => sums.collide(impacts).unwrap().into(),
                };
                for sample in samples {
                    momenta.push(sample.time, sample.momentum.x);
                    energies.push(sample.time, sample.total());
                }
            };
            trace(&source, &grid, 0.05, Between::Collisions, &mut |_, _| (), visit).unwrap();
            let energies: Vec<f64> = energies.values().collect();
            assert!(
                energies.iter().all(|energy| (energy - energies[0]).abs() < 1e-9 * energies[0].abs()),
                "{energies:?}"
            );
            let parts = momenta.parts();
            for column in 0..79 {
                let within = parts[0].iter().filter(|point| (point[0] / 0.05).floor() == f64::from(column));
                let values: Vec<f64> = within.map(|point| point[1]).collect();
                assert!(values.iter().any(|p| *p > 99.0) && values.iter().any(|p| *p < -99.0), "{column}: {values:?}");
            }
        }
    }

    #[test]
    fn wide_columns_show_the_states_and_the_colliding_bodies() {
        let folder = tempfile::tempdir().unwrap();
        let (points, trace) = points(&source(folder.path(), 64, 0.5), 0.1);
        assert_eq!((points.len(), trace.changes.len()), (257, 2));
    }
}
