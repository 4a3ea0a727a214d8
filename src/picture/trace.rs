use super::impacts::Impacts;
use super::moving_world::{MovingWorld, StepCollisions, after_impulses};
use super::traced_step::TracedStep;
use super::{Appearance, Error, Language, Progress, ReadExtent, ReadStatus, Source, StepGrid, recorded_world};
use crate::physics::{BodyId, Engine, World};
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
    let change_steps = change_steps(source, grid, column)?;
    let appearances = if has_impacts { source.appearances()? } else { BTreeMap::new() };
    let mut tracer = Tracer {
        source,
        grid,
        column,
        change_steps: &change_steps,
        appearances: &appearances,
        last: None,
        gaps: Vec::new(),
        visit: &mut visit,
    };
    let (health, extent) = match replayer {
        Some(mut replayer) => {
            if has_worlds {
                tracer.trace_worlds(&mut replayer, progress)?;
            } else {
                tracer.trace_impacts(&mut replayer, progress)?;
            }
            (Error::unless_diverged(replayer.verdict(), &source.path)?, ReadExtent::End)
        }
        None => tracer.trace_recorded_states(progress)?,
    };
    if tracer.last.is_none() {
        return Err(source.missing_states(&grid.steps, health));
    }
    tracer.add_gap_at_end();
    let gaps = tracer.gaps;
    let changes = change_steps.iter().map(|&step| step as f64 / grid.rate).collect();
    Ok(Trace { status: ReadStatus { path: source.path.clone(), health, extent }, changes, gaps })
}

/// The steps of a grid, without the first, at which bodies were spawned or deleted. Of several in one column only the
/// last is kept.
fn change_steps(source: &Source, grid: &StepGrid, column: f64) -> Result<BTreeSet<u64>, Error> {
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
    Ok(steps)
}

struct Tracer<'a> {
    source: &'a Source,
    grid: &'a StepGrid,
    column: f64,
    /// The steps at which bodies were spawned or deleted.
    change_steps: &'a BTreeSet<u64>,
    /// The bodies whose collisions are passed on.
    appearances: &'a BTreeMap<BodyId, Arc<Appearance>>,
    /// The step of the last state.
    last: Option<u64>,
    gaps: Vec<TraceGap>,
    visit: &'a mut dyn FnMut(Traced),
}

impl Tracer<'_> {
    /// Traces the recorded states.
    fn trace_recorded_states(&mut self, progress: Progress) -> Result<(Health, ReadExtent), Error> {
        let mut playback = Playback::new(self.source.recording()?);
        playback.seek(*self.grid.steps.start()).map_err(|error| self.source.read_error(error))?;
        for state in playback.by_ref() {
            let state = state.map_err(|error| self.source.read_error(error))?;
            if state.step > *self.grid.steps.end() {
                return Ok((playback.health(), ReadExtent::LastStep));
            }
            if self.grid.contains(state.step) {
                self.visit_state(state.step, &recorded_world(&state, &self.source.header.config));
                progress(state.step, *self.grid.steps.end());
            }
        }
        Ok((playback.health(), ReadExtent::End))
    }

    /// Traces a replay, with the worlds at the exact instants between its states.
    fn trace_worlds<R: std::io::Read + std::io::Seek>(
        &mut self,
        replayer: &mut Replayer<R>,
        progress: Progress,
    ) -> Result<(), Error> {
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
                    self.visit_between_states(before, engine.world(), &instants)?;
                }
                self.visit_state(step, engine.world());
                before = Some(engine.clone());
            }
            instants = StepCollisions { step, offsets: Vec::new(), changes: Some(Vec::new()), ..instants };
            progress(step, end);
        }
        Ok(())
    }

    /// Traces a replay, with the colliding bodies between its states.
    fn trace_impacts<R: std::io::Read + std::io::Seek>(
        &mut self,
        replayer: &mut Replayer<R>,
        progress: Progress,
    ) -> Result<(), Error> {
        let end = *self.grid.steps.end();
        // The step of the last state of the replay, after which its collisions are passed on.
        let mut reached: Option<u64> = None;
        loop {
            let source = self.source;
            let mut observer = match reached {
                Some(step) if step < end => Some(self.traced_step(step)),
                Some(_) | None => None,
            };
            let next = replayer.next_state(&mut observer).map_err(|error| source.read_error(error))?;
            observer.into_iter().for_each(|mut step| step.visit_impacts());
            let Some(step) = next else { break };
            reached = None;
            if let Some(engine) = replayer.engine() {
                if self.grid.contains(step) {
                    self.visit_state(step, engine.world());
                }
                reached = self.last.is_some().then_some(step);
            }
            progress(step, end);
        }
        Ok(())
    }

    /// The parts of the trace in a step.
    fn traced_step(&mut self, step: u64) -> TracedStep<'_> {
        TracedStep::new(step, self.grid.rate, self.appearances, &mut *self.visit)
    }

    /// Passes on a state, and adds the gap before it if states are missing.
    fn visit_state(&mut self, step: u64, world: &World) {
        let rate = self.grid.rate;
        let expected = self.next_step();
        let is_after_gap = step > expected;
        if is_after_gap {
            self.add_gap(expected..=step - 1, step);
        }
        let is_after_change = self.last.is_some_and(|last| self.change_steps.range(last + 1..=step).next().is_some());
        (self.visit)(Traced::World(TracePoint { time: step as f64 / rate, world, is_after_gap, is_after_change }));
        self.last = Some(step);
    }

    /// The step of the next state, if none is missing.
    fn next_step(&self) -> u64 {
        let every = self.grid.every;
        self.last.map_or(self.grid.steps.start().div_ceil(every) * every, |last| last + every)
    }

    /// Adds the gap after the last state if states of the grid are missing there.
    fn add_gap_at_end(&mut self) {
        let (expected, end) = (self.next_step(), *self.grid.steps.end());
        if expected <= end {
            self.add_gap(expected..=end, end);
        }
    }

    /// Adds a gap: the states of `steps` are missing, up to the time of step `until`.
    fn add_gap(&mut self, steps: RangeInclusive<u64>, until: u64) {
        let mut recovered = self.source.header.gaps.iter();
        let is_recovered = recovered.any(|gap| gap.first_missing() <= *steps.end() && gap.before >= *steps.start());
        let reason = if is_recovered { GapReason::Lost } else { GapReason::Unreadable };
        let from = self.last.unwrap_or(*steps.start());
        self.gaps.push(TraceGap { steps, times: [from, until].map(|step| step as f64 / self.grid.rate), reason });
    }

    /// Passes on the worlds between the state of `engine` and the next one, `next`.
    fn visit_between_states(&mut self, engine: Engine, next: &World, collisions: &StepCollisions) -> Result<(), Error> {
        let (step, duration) = (engine.current_step(), 1.0 / self.grid.rate);
        let source = self.source;
        let failed = |error| Error::Step { path: source.path.clone(), source: error };
        let is_changed = self.change_steps.contains(&(step + 1));
        let is_continuous = self.source.header.config.solver.is_continuous();
        let curve_instants = self.curve_instants(duration);
        let moving =
            if is_continuous && !is_changed { MovingWorld::through(&engine, collisions, next, duration) } else { None };
        if let Some(moving) = moving {
            self.traced_step(step).visit_moving_world(moving, collisions, curve_instants);
            return Ok(());
        }
        if is_continuous {
            let visited = self.traced_step(step).visit_engine_worlds(&engine, collisions, curve_instants);
            visited.map_err(failed)?;
        }
        let mut end = None;
        if is_changed {
            let mut engine = engine.clone();
            engine.step(&mut Vec::new()).map_err(failed)?;
            end = Some(engine);
        }
        let end = end.as_ref().map(Engine::world);
        if !is_continuous && !collisions.offsets.is_empty() {
            let world = after_impulses(engine.world(), end.unwrap_or(next), duration);
            self.traced_step(step).visit_world(0.0, &world);
        }
        end.into_iter().for_each(|end| self.traced_step(step + 1).visit_world(0.0, end));
        Ok(())
    }

    /// The instants within a step of `duration` seconds, s after its start, at which a force bends the curves: between
    /// two of them a curve is drawn straight.
    fn curve_instants(&self, duration: f64) -> impl Iterator<Item = f64> + use<> {
        let parts = if self.source.statistics.top_force > 0.0 {
            (duration / (SMOOTH_COLUMNS * self.column)).ceil().clamp(1.0, 1e4) as u32
        } else {
            1
        };
        (1..parts).map(move |part| f64::from(part) * duration / f64::from(parts))
    }
}

/// The distance of points on curves that are not straight, in columns.
const SMOOTH_COLUMNS: f64 = 8.0;
