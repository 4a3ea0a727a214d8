//! The parts of a trace in one step.

use super::Appearance;
use super::impacts::Impacts;
use super::moving_world::{MovingWorld, StepCollisions};
use super::trace::{TracePoint, Traced};
use crate::physics::{BodyId, Collision, Engine, Observer, StepError, World, smaller};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Passes on the parts of a trace in one step. As an observer, it passes on the bodies of collisions.
pub struct TracedStep<'a> {
    step: u64,
    /// The time of the step, s.
    start: f64,
    /// The time of the next step, s.
    end: f64,
    /// The seconds between two steps.
    duration: f64,
    /// The rounding error of times in the step, s.
    margin: f64,
    /// The collisions at the last instant, which may not be all.
    impacts: Impacts,
    /// The bodies whose collisions are passed on.
    appearances: &'a BTreeMap<BodyId, Arc<Appearance>>,
    visit: &'a mut dyn FnMut(Traced),
}

impl<'a> TracedStep<'a> {
    /// The step `step` of a run with `rate` steps per second.
    pub fn new(
        step: u64,
        rate: f64,
        appearances: &'a BTreeMap<BodyId, Arc<Appearance>>,
        visit: &'a mut dyn FnMut(Traced),
    ) -> TracedStep<'a> {
        let [start, end] = [step, step + 1].map(|step| step as f64 / rate);
        let (duration, margin) = (1.0 / rate, 4.0 * f64::EPSILON * end);
        TracedStep { step, start, end, duration, margin, impacts: Impacts::default(), appearances, visit }
    }

    /// Passes on the worlds at the collisions and at `curve_instants`, from the collisions alone, so each vertex costs
    /// no more than the positions of the bodies.
    pub fn visit_moving_world(
        &mut self,
        mut moving: MovingWorld,
        collisions: &StepCollisions,
        curve_instants: impl Iterator<Item = f64>,
    ) {
        let margin = self.margin;
        let mut curve_instants = curve_instants.peekable();
        let mut changes = collisions.changes.iter().flatten().peekable();
        for &collision in &collisions.offsets {
            while let Some(offset) = curve_instants.next_if(|&offset| offset < collision) {
                while let Some(change) = changes.next_if(|change| change.time <= offset) {
                    moving.apply(change);
                    self.collision(change);
                }
                self.visit_world(offset, moving.at(offset));
            }
            while let Some(change) = changes.next_if(|change| change.time < collision - margin) {
                moving.apply(change);
                self.collision(change);
            }
            self.visit_world(collision, moving.at(collision));
            while let Some(change) = changes.next_if(|change| change.time <= collision + margin) {
                moving.apply(change);
            }
            if collision + margin < self.duration {
                self.visit_world(collision, moving.at(collision));
            }
        }
        for offset in curve_instants {
            while let Some(change) = changes.next_if(|change| change.time <= offset) {
                moving.apply(change);
                self.collision(change);
            }
            self.visit_world(offset, moving.at(offset));
        }
        changes.for_each(|change| self.collision(change));
        self.visit_impacts();
    }

    /// Passes on the worlds at the collisions and at `curve_instants`, computed by the engine once more.
    ///
    /// # Errors
    /// Returns the errors of [`Engine::step`].
    pub fn visit_engine_worlds(
        &mut self,
        engine: &Engine,
        collisions: &StepCollisions,
        curve_instants: impl Iterator<Item = f64>,
    ) -> Result<(), StepError> {
        let mut curve_instants = curve_instants.peekable();
        let mut within = engine.within_step();
        for &collision in &collisions.offsets {
            while let Some(offset) = curve_instants.next_if(|&offset| offset < collision) {
                let world = within.world_after(offset, self)?;
                self.visit_world(offset, &world);
            }
            // Before and after the collision, whose instant is rounded like a time since step 0.
            let (before, after) = (collision - self.margin, collision + self.margin);
            if before > 0.0 {
                let world = within.world_after(before, self)?;
                self.visit_world(collision, &world);
            }
            if after < self.duration {
                let world = within.world_after(after, &mut Vec::new())?;
                self.visit_world(collision, &world);
            }
        }
        for offset in curve_instants {
            let world = within.world_after(offset, self)?;
            self.visit_world(offset, &world);
        }
        let has_others = collisions.changes.as_ref().is_none_or(|changes| changes.len() > collisions.offsets.len());
        if has_others && !self.appearances.is_empty() {
            within.world_after(self.duration, self)?;
        }
        self.visit_impacts();
        Ok(())
    }

    /// Passes on the world at an instant, s after the start of the step.
    pub fn visit_world(&mut self, offset: f64, world: &World) {
        self.visit_impacts();
        let time = self.time(offset);
        (self.visit)(Traced::World(TracePoint { time, world, is_after_gap: false, is_after_change: false }));
    }

    /// Passes on the collisions of the last instant.
    pub fn visit_impacts(&mut self) {
        let impacts = std::mem::take(&mut self.impacts);
        if !impacts.bodies.is_empty() {
            (self.visit)(Traced::Impacts(&impacts));
        }
    }

    /// The time `offset` seconds after the start of the step, which is not after its end by rounding.
    fn time(&self, offset: f64) -> f64 {
        smaller(self.start + offset, self.end)
    }
}

impl Observer for TracedStep<'_> {
    fn collision(&mut self, collision: &Collision) {
        if collision.step != self.step || collision.impulse == 0.0 || self.appearances.is_empty() {
            return;
        }
        let time = self.time(collision.time);
        if time > self.impacts.time + self.margin {
            self.visit_impacts();
        }
        if self.impacts.bodies.is_empty() {
            self.impacts.time = time;
        }
        self.impacts.add(collision, self.appearances);
    }
}
