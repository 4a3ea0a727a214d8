use super::layers::contacts::contact_center;
use super::source::{ReadExtent, ReadStatus, RecordingFile};
use super::{Error, Source};
use crate::physics::{
    Axis, Body, BodyId, Collision, Engine, Observer, SolverKind, Spawn, StepError, Vector, WithinStep, World, larger,
    smaller,
};
use crate::picture::{AnimationSchedule, Appearance, Frame, Moment, Sprite, Trails};
use crate::recording::{BodyInfo, Health};
use crate::replay::{ALL_STEPS, Replayer};
use std::collections::{BTreeMap, VecDeque, btree_map::Entry};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Arc;

/// Frames computed by replaying a recording, for data that recordings do not contain: collisions, and
/// instants between two states. Every replayed state is compared with the recorded one.
pub struct Resimulation {
    path: PathBuf,
    replayer: Replayer<RecordingFile>,
    recorder: FrameRecorder,
    health: Health,
    is_finished: bool,
}

impl Resimulation {
    /// Prepares a replay that starts early enough for the trails and collisions of the first frame.
    ///
    /// # Errors
    /// If the recording cannot be read.
    pub fn start(source: &Source, schedule: AnimationSchedule, trails: Option<Trails>) -> Result<Resimulation, Error> {
        let trail = trails.as_ref().map_or(0, Trails::steps);
        let first = schedule.recorded_moment(0).step.saturating_sub(trail.max(schedule.recorded_interval()));
        let steps = source.steps_to_read(first, *schedule.recorded_steps().end());
        Resimulation::of_steps(steps, source, schedule, trails)
    }

    /// Prepares a replay of the whole run, which also finds the largest impulse; see [`Resimulation::finish_run`].
    ///
    /// # Errors
    /// If the recording cannot be read.
    pub fn of_whole_run(
        source: &Source,
        schedule: AnimationSchedule,
        trails: Option<Trails>,
    ) -> Result<Resimulation, Error> {
        Resimulation::of_steps(ALL_STEPS, source, schedule, trails)
    }

    fn of_steps(
        steps: RangeInclusive<u64>,
        source: &Source,
        schedule: AnimationSchedule,
        trails: Option<Trails>,
    ) -> Result<Resimulation, Error> {
        let rate = schedule.recorded_rate();
        let replayer = Replayer::new(source.recording()?, steps).map_err(|error| source.read_error(error))?;
        let recorder = FrameRecorder {
            ready: VecDeque::new(),
            solver: source.header.config.solver,
            rate,
            trails,
            appearances: source.appearances()?,
            last_step: None,
            next_frame: 0,
            schedule,
            pending_collisions: PendingCollisions::new(source.world()),
            reached: 0.0,
            received_count: 0,
            shown_count: 0,
            max_impulse: 0.0,
        };
        Ok(Resimulation { path: source.path.clone(), replayer, recorder, health: Health::Whole, is_finished: false })
    }

    /// Replays the rest of the steps and returns the largest impulse of all of them, N·s.
    ///
    /// # Errors
    /// If the recording cannot be read or diverges.
    pub fn finish_run(&mut self) -> Result<f64, Error> {
        while self.next().transpose()?.is_some() {}
        Ok(self.recorder.max_impulse)
    }

    /// The health of the recording as far as it was read; final after the last frame.
    pub fn read_status(&self) -> ReadStatus {
        ReadStatus { path: self.path.clone(), health: self.health.clone(), extent: ReadExtent::End }
    }

    /// Replays until a frame is ready or the replay has ended.
    fn advance(&mut self) -> Result<(), Error> {
        while self.recorder.ready.is_empty() && !self.is_finished {
            let next = self.replayer.next_state(&mut self.recorder);
            let step = next.map_err(|source| Error::Recording { path: self.path.clone(), source })?;
            if step.is_none() {
                self.is_finished = true;
                self.health = Error::unless_diverged(self.replayer.verdict(), &self.path)?;
            } else if let Some(engine) = self.replayer.engine() {
                let recorded = self.recorder.record_state(engine);
                recorded.map_err(|source| Error::Step { path: self.path.clone(), source })?;
            }
        }
        Ok(())
    }
}

impl Iterator for Resimulation {
    type Item = Result<Frame, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.advance() {
            Ok(()) => self.recorder.ready.pop_front().map(Ok),
            Err(error) => {
                self.is_finished = true;
                Some(Err(error))
            }
        }
    }
}

/// The collisions to be shown in the next frame, so few that memory is bounded whatever their number. Of those of one
/// pair that are indistinguishable on any page, only the one with the largest impulse is kept. If there are still too
/// many, which would cover a page several times, only the one with the largest impulse of all that are near each other
/// is kept.
struct PendingCollisions {
    collisions: Vec<Collision>,
    /// The index of the collision at each place.
    index: BTreeMap<Place, usize>,
    /// Width of a cell, m.
    cell: f64,
    /// Width of the cells of a frame without too many collisions, m.
    finest: f64,
}

/// The pair of a collision, unless there are too many to distinguish pairs, its axis, and its place in cells.
type Place = (Option<[BodyId; 2]>, Axis, [i64; 2]);

/// The number of cells along the longer side of the world: the largest size of a page, px.
const CELLS: f64 = 16_384.0;

/// The largest number of collisions that a frame shows.
const MAX_SHOWN: usize = 20_000;

impl PendingCollisions {
    fn new(world: Vector) -> PendingCollisions {
        let finest = larger(world.x, world.y) / CELLS;
        PendingCollisions { collisions: Vec::new(), index: BTreeMap::new(), cell: finest, finest }
    }

    fn take(&mut self) -> Vec<Collision> {
        self.index.clear();
        self.cell = self.finest;
        std::mem::take(&mut self.collisions)
    }

    /// Keeps a collision unless one at the same place has a larger impulse.
    fn keep(&mut self, collision: &Collision) {
        let at = contact_center(&collision.rects);
        let place = [at.x, at.y].map(|at| (at / self.cell).floor() as i64);
        let pair = (self.cell == self.finest).then_some(collision.bodies);
        match self.index.entry((pair, collision.axis, place)) {
            Entry::Occupied(kept) => {
                let kept = &mut self.collisions[*kept.get()];
                if collision.impulse.abs() > kept.impulse.abs() {
                    *kept = collision.clone();
                }
            }
            Entry::Vacant(free) => {
                free.insert(self.collisions.len());
                self.collisions.push(collision.clone());
            }
        }
    }
}

impl Observer for PendingCollisions {
    fn collision(&mut self, collision: &Collision) {
        self.keep(collision);
        while self.collisions.len() > MAX_SHOWN && self.cell.is_finite() {
            self.cell *= 2.0;
            self.index.clear();
            let collisions = std::mem::take(&mut self.collisions);
            collisions.iter().for_each(|collision| self.keep(collision));
        }
    }
}

/// Receives the collisions and states of the replay and records the frames of a schedule.
struct FrameRecorder {
    /// Frames recorded but not yet returned; at most those of one step.
    ready: VecDeque<Frame>,
    solver: SolverKind,
    rate: f64,
    trails: Option<Trails>,
    appearances: BTreeMap<BodyId, Arc<Appearance>>,
    /// The step of the last state.
    last_step: Option<u64>,
    /// The number of the next frame to record.
    next_frame: u64,
    schedule: AnimationSchedule,
    /// Collisions since the last frame.
    pending_collisions: PendingCollisions,
    /// The latest instant of the current step for which the world was computed, s after its start.
    reached: f64,
    /// The number of collisions of the current step that the replay has passed on.
    received_count: usize,
    /// The number of collisions of the current step that frames have shown; they are its first ones.
    shown_count: usize,
    /// The largest impulse so far, N·s.
    max_impulse: f64,
}

impl Observer for FrameRecorder {
    fn collision(&mut self, collision: &Collision) {
        self.max_impulse = larger(collision.impulse.abs(), self.max_impulse);
        self.received_count += 1;
        if self.next_frame < self.schedule.count() && self.received_count > self.shown_count {
            self.pending_collisions.collision(collision);
        }
    }
}

/// Keeps and counts the collisions that a frame within a step shows, in the order in which the step will repeat them.
struct Shown<'a> {
    pending: &'a mut PendingCollisions,
    count: &'a mut usize,
}

impl Observer for Shown<'_> {
    fn collision(&mut self, collision: &Collision) {
        *self.count += 1;
        self.pending.collision(collision);
    }
}

impl FrameRecorder {
    /// Records the frames between a replayed state and the next step.
    fn record_state(&mut self, engine: &Engine) -> Result<(), StepError> {
        (self.reached, self.received_count, self.shown_count) = (0.0, 0, 0);
        let step = engine.current_step();
        let mut sprites_at_step = self.sprites(engine.world());
        let is_after_gap = self.last_step.is_some_and(|last| step > last + 1);
        self.last_step = Some(step);
        if let Some(trails) = &mut self.trails {
            if is_after_gap {
                trails.interrupt();
            }
            trails.update(step, &mut sprites_at_step);
        }
        let mut within = engine.within_step();
        while self.next_frame < self.schedule.count() {
            let moment = self.schedule.recorded_moment(self.next_frame);
            if moment.step > step {
                break;
            }
            if moment.step == step {
                let frame = self.record_frame(engine, &mut within, moment, &sprites_at_step)?;
                self.ready.push_back(frame);
            }
            self.next_frame += 1;
        }
        // The first frame shows the collisions of one frame interval, as every other frame does.
        if self.next_frame == 0 && step + self.schedule.recorded_interval() <= self.schedule.recorded_moment(0).step {
            self.pending_collisions.take();
        }
        Ok(())
    }

    /// The frame of a moment in the current step.
    fn record_frame(
        &mut self,
        engine: &Engine,
        within: &mut WithinStep,
        moment: Moment,
        sprites_at_step: &[Sprite],
    ) -> Result<Frame, StepError> {
        let is_impact = self.schedule.is_frozen_at(self.next_frame) && self.solver.is_continuous();
        let sprites = if moment.offset > 0.0 || is_impact {
            let world = self.world_at(within, moment)?;
            let mut sprites = self.sprites(&world);
            if let Some(trails) = &self.trails {
                trails.clone().update(moment.step, &mut sprites);
            }
            sprites
        } else {
            sprites_at_step.to_vec()
        };
        let mut collisions = self.pending_collisions.take();
        if moment.offset == 0.0 {
            self.add_detected(engine, &mut collisions)?;
        }
        let time = moment.step as f64 / self.rate + moment.offset;
        Ok(Frame { step: moment.step, time, sprites, collisions })
    }

    /// The world at a moment of the current step. A freeze frame shows the velocities after the collisions at its
    /// instant, which is rounded and may be before the exact one.
    fn world_at(&mut self, within: &mut WithinStep, moment: Moment) -> Result<World, StepError> {
        let mut shown = Shown { pending: &mut self.pending_collisions, count: &mut self.shown_count };
        self.reached = larger(moment.offset, self.reached);
        let mut world = within.world_after(self.reached, &mut shown)?;
        if self.schedule.is_frozen_at(self.next_frame) {
            let after = self.reached + self.schedule.recorded_rounding(moment);
            self.reached = smaller(after, 1.0 / self.rate);
            let after = within.world_after(self.reached, &mut shown)?;
            for (body, after) in world.bodies.iter_mut().zip(&after.bodies) {
                body.velocity = after.velocity;
            }
        }
        Ok(world)
    }

    /// Adds the collisions that the handout's solver detects in the current state, if the animation
    /// freezes at this frame. That solver detects them at the beginning of its next step.
    fn add_detected(&self, engine: &Engine, collisions: &mut Vec<Collision>) -> Result<(), StepError> {
        if self.schedule.is_frozen_at(self.next_frame) && self.solver == SolverKind::Handout {
            engine.clone().step(collisions)?;
        }
        Ok(())
    }

    fn sprites(&self, world: &World) -> Vec<Sprite> {
        let sprite = |body: &Body| {
            // Every body is in an event or a keyframe.
            let appearance = self.appearances.get(&body.id).cloned().unwrap_or_else(|| Arc::new(unknown(body)));
            Sprite { appearance, rect: body.rect, velocity: body.velocity, trail: Vec::new() }
        };
        world.bodies.iter().map(sprite).collect()
    }
}

/// The appearance of a body as far as the engine knows it.
fn unknown(body: &Body) -> Appearance {
    let spawn = Spawn {
        name: body.name.clone(),
        rect: body.rect,
        mass: body.mass,
        velocity: body.velocity,
        force: body.constant_force,
        material: String::new(),
    };
    Appearance::new(&BodyInfo::new(body.id, spawn), None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Rect;

    fn collision(number: u32) -> Collision {
        let at = Vector::new(f64::from(number % 400) * 0.04, f64::from(number / 400 % 250) * 0.036);
        Collision {
            bodies: [number % 60, 60 + number / 400_000],
            axis: Axis::X,
            rects: [Rect::new(at, 0.01, 0.01); 2],
            impulse: f64::from(number * 79 % 100_003),
            step: 0,
            time: 0.0,
            instant: 0.0,
            normal: Vector::new(1.0, 0.0),
            penetration: Vector::ZERO,
            shares: [0.5; 2],
            restitution: 1.0,
            normal_velocity: [-1.0, 1.0],
            before: [Vector::ZERO; 2],
            after: [Vector::ZERO; 2],
        }
    }

    #[test]
    fn a_frame_shows_all_collisions_or_the_largest_ones_of_very_many() {
        let mut pending = PendingCollisions::new(Vector::new(16.0, 9.0));
        (0..MAX_SHOWN as u32).for_each(|number| pending.collision(&collision(number)));
        assert_eq!(pending.take().len(), MAX_SHOWN);
        let mut top = 0.0;
        for number in 0..300_000 {
            top = larger(top, collision(number).impulse);
            pending.collision(&collision(number));
            assert!(pending.collisions.len() <= MAX_SHOWN);
        }
        let shown = pending.take();
        assert!(shown.len() > MAX_SHOWN / 8, "{}", shown.len());
        assert_eq!(shown.iter().map(|collision| collision.impulse).fold(0.0, larger), top);
    }
}
