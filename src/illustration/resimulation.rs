use super::frames::{Condition, Reached};
use super::meeting::appearances;
use super::needs::{Needs, trail_steps};
use super::{Error, Source, source};
use crate::physics::{BodyId, Collision, Engine, Observer, SolverKind, StepError, World};
use crate::recording::Health;
use crate::render::{Appearance, Frame, Moment, Sprite, Timeline, Trails};
use crate::replay::{Replaying, Verdict, Witness};
use std::collections::{BTreeMap, VecDeque};
use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;
use std::sync::Arc;

/// Frames of a run that is run again beside, for what no recording holds: collisions, and what
/// lies between two states. Whatever is shown came out as recorded.
pub struct Resimulation {
    path: PathBuf,
    replaying: Replaying<BufReader<File>>,
    stage: Stage,
    health: Health,
    is_over: bool,
}

impl Resimulation {
    /// Ready to run the recording again, from a little before the first frame.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn start(source: &Source, timeline: Timeline, needs: Needs) -> Result<Resimulation, Error> {
        let rate = timeline.sampling.rate;
        let trail = if needs.trails { trail_steps(rate) } else { 0 };
        let first = timeline.moment(0).step.saturating_sub(trail.max(timeline.sampling.every));
        let steps = first..=*timeline.sampling.steps.end();
        let replaying = Replaying::new(source::open(&source.path)?, steps).map_err(|error| source.unreadable(error))?;
        let stage = Stage {
            ready: VecDeque::new(),
            solver: source.header.settings.solver,
            rate,
            trails: needs.trails.then(|| Trails::new(trail_steps(rate))),
            looks: appearances(source)?,
            next: 0,
            timeline,
            recent: Vec::new(),
            seen_until: 0.0,
            failure: None,
        };
        Ok(Resimulation { path: source.path.clone(), replaying, stage, health: Health::Whole, is_over: false })
    }

    /// How the recording was found to be, once all frames were taken.
    pub fn condition(&self) -> Condition {
        Condition { path: self.path.clone(), health: self.health.clone(), reached: Reached::End }
    }

    /// Goes on until a frame is ready or nothing more comes.
    fn advance(&mut self) -> Result<(), Error> {
        while self.stage.ready.is_empty() && !self.is_over {
            let verdict = self.replaying.advance(&mut self.stage, &mut |_| ());
            if let Some(source) = self.stage.failure.take() {
                return Err(Error::Step { path: self.path.clone(), source });
            }
            if let Some(verdict) = verdict.map_err(|source| Error::Recording { path: self.path.clone(), source })? {
                self.end(verdict)?;
            }
        }
        Ok(())
    }

    fn end(&mut self, verdict: Verdict) -> Result<(), Error> {
        self.is_over = true;
        match verdict {
            Verdict::Same { .. } => {}
            Verdict::Truncated { after, .. } => self.health = Health::Truncated { after },
            Verdict::Corrupt { damage, .. } => self.health = Health::Corrupt(damage),
            Verdict::Diverged(_) => {
                return Err(Error::Diverged { path: self.path.clone(), verdict: Box::new(verdict) });
            }
        }
        Ok(())
    }
}

impl Iterator for Resimulation {
    type Item = Result<Frame, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.advance() {
            Ok(()) => self.stage.ready.pop_front().map(Ok),
            Err(error) => {
                self.is_over = true;
                Some(Err(error))
            }
        }
    }
}

/// Takes the pictures while the engine goes by.
struct Stage {
    /// Taken, but not asked for yet: those of one step at most.
    ready: VecDeque<Frame>,
    solver: SolverKind,
    rate: f64,
    trails: Option<Trails>,
    looks: BTreeMap<BodyId, Arc<Appearance>>,
    /// The frame to be taken next.
    next: u64,
    timeline: Timeline,
    /// Collisions since the last frame.
    recent: Vec<Collision>,
    /// How far into the present step collisions were shown already, s.
    seen_until: f64,
    failure: Option<StepError>,
}

impl Observer for Stage {
    fn collision(&mut self, collision: &Collision) {
        if collision.time > self.seen_until || self.seen_until == 0.0 {
            self.recent.push(collision.clone());
        }
    }
}

impl Witness for Stage {
    fn state(&mut self, engine: &Engine) {
        self.seen_until = 0.0;
        let step = engine.present_step();
        let mut here = self.sprites(engine.world());
        if let Some(trails) = &mut self.trails {
            trails.follow(step, &mut here);
        }
        while self.next < self.timeline.count() && self.failure.is_none() {
            let moment = self.timeline.moment(self.next);
            if moment.step > step {
                break;
            }
            if moment.step == step {
                match self.take(engine, moment, &here) {
                    Ok(frame) => self.ready.push_back(frame),
                    Err(error) => self.failure = Some(error),
                }
            }
            self.next += 1;
        }
        // What happened before the first frame is shown in it as far back as in any other.
        if self.next == 0 && step + self.timeline.sampling.every <= self.timeline.moment(0).step {
            self.recent.clear();
        }
    }
}

impl Stage {
    /// The picture of a moment of the present step.
    fn take(&mut self, engine: &Engine, moment: Moment, here: &[Sprite]) -> Result<Frame, StepError> {
        let mut collisions = std::mem::take(&mut self.recent);
        let sprites = if moment.offset > 0.0 {
            let mut ahead = Vec::new();
            let world = engine.between(moment.offset, &mut ahead)?;
            collisions.extend(
                ahead.into_iter().filter(|collision| collision.time > self.seen_until || self.seen_until == 0.0),
            );
            self.seen_until = moment.offset;
            let mut sprites = self.sprites(&world);
            if let Some(trails) = &self.trails {
                trails.clone().follow(moment.step, &mut sprites);
            }
            sprites
        } else {
            self.add_present(engine, &mut collisions)?;
            here.to_vec()
        };
        let time = moment.step as f64 / self.rate + moment.offset;
        Ok(Frame { step: moment.step, time, sprites, collisions })
    }

    /// The handout's solver finds collisions in the state it is in: where a clip stops at them,
    /// they are shown there.
    fn add_present(&self, engine: &Engine, collisions: &mut Vec<Collision>) -> Result<(), StepError> {
        if self.timeline.stops_at(self.next) && self.solver == SolverKind::Handout {
            engine.clone().step(collisions)?;
        }
        Ok(())
    }

    fn sprites(&self, world: &World) -> Vec<Sprite> {
        let sprite = |body: &crate::physics::Body| {
            let appearance = self.looks.get(&body.id)?.clone();
            Some(Sprite { appearance, rect: body.rect, velocity: body.velocity, trail: Vec::new() })
        };
        world.bodies.iter().filter_map(sprite).collect()
    }
}
