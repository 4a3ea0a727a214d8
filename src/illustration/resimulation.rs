use super::frames::{Condition, Reached};
use super::meeting::appearances;
use super::needs::{Needs, trail_steps};
use super::{Error, Source, source};
use crate::physics::{BodyId, Collision, Engine, Observer, SolverKind, StepError, World};
use crate::recording::Health;
use crate::render::{Appearance, Frame, Moment, Sprite, Timeline, Trails};
use crate::replay::{Verdict, Witness, watch};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Frames that wait to be taken, at most: what keeps memory from growing with the clip.
const WAITING: usize = 8;

/// Frames of a run that is run again beside, for what no recording holds: collisions, and what
/// lies between two states. Whatever is shown came out as recorded.
pub struct Resimulation {
    path: PathBuf,
    frames: Receiver<Result<Frame, Error>>,
    /// Runs the engine; gone once its end is known.
    runner: Option<JoinHandle<Result<Verdict, Error>>>,
    health: Health,
}

impl Resimulation {
    /// Begins to run the recording again, from a little before the first frame.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn start(source: &Source, timeline: Timeline, needs: Needs) -> Result<Resimulation, Error> {
        let (sender, frames) = sync_channel(WAITING);
        let recording = source::open(&source.path)?;
        let rate = timeline.sampling.rate;
        let trail = if needs.trails { trail_steps(rate) } else { 0 };
        let first = timeline.moment(0).step.saturating_sub(trail.max(timeline.sampling.every));
        let steps = first..=*timeline.sampling.steps.end();
        let mut stage = Stage {
            sender,
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
        let path = source.path.clone();
        let of = path.clone();
        let runner = std::thread::spawn(move || {
            let verdict = watch(recording, steps, &mut stage, &mut |_| ());
            if let Some(source) = stage.failure {
                return Err(Error::Step { path: of, source });
            }
            let verdict = verdict.map_err(|source| Error::Recording { path: of.clone(), source })?;
            match verdict {
                Verdict::Diverged(_) => Err(Error::Diverged { path: of, verdict: Box::new(verdict) }),
                Verdict::Same { .. } | Verdict::Truncated { .. } | Verdict::Corrupt { .. } => Ok(verdict),
            }
        });
        Ok(Resimulation { path, frames, runner: Some(runner), health: Health::Whole })
    }

    /// How the recording was found to be, once all frames were taken.
    pub fn condition(&self) -> Condition {
        Condition { path: self.path.clone(), health: self.health.clone(), reached: Reached::End }
    }

    fn end(&mut self) -> Option<Result<Frame, Error>> {
        let verdict = self.runner.take()?.join().expect("a replay never panics, whatever the recording");
        match verdict {
            Ok(Verdict::Truncated { after, .. }) => self.health = Health::Truncated { after },
            Ok(Verdict::Corrupt { damage, .. }) => self.health = Health::Corrupt(damage),
            Ok(Verdict::Same { .. } | Verdict::Diverged(_)) => {}
            Err(error) => return Some(Err(error)),
        }
        None
    }
}

impl Iterator for Resimulation {
    type Item = Result<Frame, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.frames.recv() {
            Ok(frame) => Some(frame),
            Err(_) => self.end(),
        }
    }
}

/// Takes the pictures while the engine goes by.
struct Stage {
    sender: SyncSender<Result<Frame, Error>>,
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
                    Ok(frame) => drop(self.sender.send(Ok(frame))),
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
