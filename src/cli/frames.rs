//! Recorded states made into frames to draw.

use super::error::CommandError;
use super::export::{Reached, tell_damage};
use super::replay;
use crate::physics::{BodyId, Collision, Observer, Spawn};
use crate::recording::{self, FrameBody, Playback};
use crate::render::{Appearance, Color, Frame, Sampling, Sprite, Trails};
use crate::scene::Overlay;
use std::{
    collections::BTreeMap,
    fs::File,
    io::BufReader,
    path::{Path, PathBuf},
    sync::Arc,
};

/// The frames of a recording that a sampling shows, in order.
pub struct Frames {
    path: PathBuf,
    playback: Playback<BufReader<File>>,
    sampling: Sampling,
    trails: Option<Trails>,
    collisions: BTreeMap<u64, Vec<Collision>>,
    appearances: BTreeMap<BodyId, Arc<Appearance>>,
    reached: Reached,
}

impl Frames {
    /// Frames with what `show` needs and no more.
    pub fn new(path: &Path, sampling: Sampling, show: &[Overlay]) -> Result<Frames, CommandError> {
        let trails = show.contains(&Overlay::Trail).then(|| Trails::new(trail_steps(sampling.rate)));
        let contacts = show.contains(&Overlay::Normal) || show.contains(&Overlay::Penetration);
        let collisions = if contacts { collisions(path, &sampling)? } else { BTreeMap::new() };
        let mut playback = Playback::new(open(path)?);
        // A trail that is whole at the first frame began before it.
        let before = if trails.is_some() { trail_steps(sampling.rate) } else { 0 };
        let first = sampling.steps.start().saturating_sub(before);
        playback.seek(first).map_err(|error| CommandError::recording(path, error))?;
        let (path, appearances) = (path.into(), BTreeMap::new());
        Ok(Frames { path, playback, sampling, trails, collisions, appearances, reached: Reached::End })
    }

    /// How the recording was found to be, once all frames were taken.
    pub fn tell_damage(&self) -> super::Exit {
        tell_damage(&self.path, &self.playback.health(), self.reached)
    }

    fn frame(&mut self, state: recording::Frame) -> Option<Frame> {
        let shown = self.sampling.shows(state.step);
        if !shown && self.trails.is_none() {
            return None;
        }
        let mut sprites: Vec<Sprite> = state.bodies.iter().map(|body| self.sprite(body)).collect();
        if let Some(trails) = &mut self.trails {
            trails.follow(state.step, &mut sprites);
        }
        let collisions = self.collisions.remove(&state.step).unwrap_or_default();
        shown.then_some(Frame { step: state.step, time: state.time, sprites, collisions })
    }

    fn sprite(&mut self, body: &FrameBody) -> Sprite {
        let known = &body.known;
        let appearance = self
            .appearances
            .entry(known.id)
            .or_insert_with(|| Arc::new(appearance(known.id, &known.spawn, known.color.as_deref())));
        let mut rect = known.spawn.rect;
        rect.origin = body.position;
        Sprite { appearance: appearance.clone(), rect, velocity: body.velocity, trail: Vec::new() }
    }
}

impl Iterator for Frames {
    type Item = Result<Frame, CommandError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.playback.next()? {
                Err(error) => return Some(Err(CommandError::recording(&self.path, error))),
                Ok(state) if state.step > *self.sampling.steps.end() => {
                    self.reached = Reached::LastStep;
                    return None;
                }
                Ok(state) => {
                    if let Some(frame) = self.frame(state) {
                        return Some(Ok(frame));
                    }
                }
            }
        }
    }
}

/// Opens a recording to read.
pub fn open(path: &Path) -> Result<recording::Recording<BufReader<File>>, CommandError> {
    recording::open(path).map_err(|error| CommandError::recording(path, error))
}

/// A trail shows the last second.
fn trail_steps(rate: f64) -> u64 {
    rate.ceil() as u64
}

/// How a body that was spawned so looks.
pub fn appearance(id: BodyId, spawn: &Spawn, color: Option<&str>) -> Appearance {
    let is_wall = spawn.mass == f64::INFINITY && spawn.name.starts_with("wall-");
    Appearance {
        id,
        name: spawn.name.clone(),
        material: spawn.material.clone(),
        color: color.and_then(Color::parse),
        mass: spawn.mass,
        is_wall,
    }
}

/// The collisions of a replay, each under the step of the frame that shows it: those since the
/// frame before.
fn collisions(path: &Path, sampling: &Sampling) -> Result<BTreeMap<u64, Vec<Collision>>, CommandError> {
    let mut kept = Kept { sampling, frames: BTreeMap::new() };
    replay::judge(path, 0..=*sampling.steps.end(), &mut kept)?;
    Ok(kept.frames)
}

struct Kept<'a> {
    sampling: &'a Sampling,
    frames: BTreeMap<u64, Vec<Collision>>,
}

impl Observer for Kept<'_> {
    fn collision(&mut self, collision: &Collision) {
        let every = self.sampling.every;
        let shown_at = (collision.step + 1).div_ceil(every) * every;
        if self.sampling.shows(shown_at) {
            self.frames.entry(shown_at).or_default().push(collision.clone());
        }
    }
}
