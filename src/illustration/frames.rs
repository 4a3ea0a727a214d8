use super::needs::{Needs, trail_steps};
use super::resimulation::Resimulation;
use super::style::appearance;
use super::{Error, Source, source};
use crate::physics::{BodyId, Vector};
use crate::recording::{self, FrameBody, Health, Playback};
use crate::render::{Appearance, Frame, Sampling, Sprite, Timeline, Trails};
use crate::scene::Overlay;
use std::{collections::BTreeMap, fs::File, io::BufReader, path::PathBuf, sync::Arc};

/// How much of a recording was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reached {
    /// All of it.
    End,
    /// The last step that was asked for: what comes after it was not looked at.
    LastStep,
}

/// How a recording was found to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Which.
    pub path: PathBuf,
    /// What of it is sound.
    pub health: Health,
    /// How much of it was looked at.
    pub reached: Reached,
}

/// The frames of a recording that a timeline shows, in order. Memory does not grow with them.
pub enum Frames {
    /// Read.
    Recorded(Box<RecordedFrames>),
    /// Computed again.
    Resimulated(Box<Resimulation>),
}

impl Frames {
    /// Frames with what `show` needs and no more.
    ///
    /// # Errors
    /// When the recording cannot be read.
    pub fn new(source: &Source, timeline: &Timeline, show: &[Overlay]) -> Result<Frames, Error> {
        let needs = Needs::of(show, timeline);
        match needs.replay {
            true => Ok(Frames::Resimulated(Box::new(Resimulation::start(source, timeline.clone(), needs)?))),
            false => Ok(Frames::Recorded(Box::new(RecordedFrames::new(source, &timeline.sampling, needs)?))),
        }
    }

    /// How the recording was found to be, once all frames were taken.
    pub fn condition(&self) -> Condition {
        match self {
            Frames::Recorded(frames) => frames.condition(),
            Frames::Resimulated(frames) => frames.condition(),
        }
    }
}

impl Iterator for Frames {
    type Item = Result<Frame, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match self {
            Frames::Recorded(frames) => frames.next(),
            Frames::Resimulated(frames) => frames.next(),
        }
    }
}

/// States as they were recorded.
pub struct RecordedFrames {
    path: PathBuf,
    playback: Playback<BufReader<File>>,
    gravity: Option<Vector>,
    sampling: Sampling,
    trails: Option<Trails>,
    appearances: BTreeMap<BodyId, Arc<Appearance>>,
    reached: Reached,
}

impl RecordedFrames {
    fn new(source: &Source, sampling: &Sampling, needs: Needs) -> Result<RecordedFrames, Error> {
        let trails = needs.trails.then(|| Trails::new(trail_steps(sampling.rate)));
        let mut playback = Playback::new(source::open(&source.path)?);
        // A trail that is whole at the first frame began before it.
        let before = if needs.trails { trail_steps(sampling.rate) } else { 0 };
        let first = sampling.steps.start().saturating_sub(before);
        playback.seek(first).map_err(|error| source.unreadable(error))?;
        Ok(RecordedFrames {
            path: source.path.clone(),
            playback,
            gravity: source.header.settings.gravity,
            sampling: sampling.clone(),
            trails,
            appearances: BTreeMap::new(),
            reached: Reached::End,
        })
    }

    fn condition(&self) -> Condition {
        Condition { path: self.path.clone(), health: self.playback.health(), reached: self.reached }
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
        shown.then_some(Frame { step: state.step, time: state.time, sprites, collisions: Vec::new() })
    }

    fn sprite(&mut self, body: &FrameBody) -> Sprite {
        let known = &body.known;
        let looks = || Arc::new(appearance(known.id, &known.spawn, known.color.as_deref(), self.gravity));
        let appearance = self.appearances.entry(known.id).or_insert_with(looks).clone();
        let mut rect = known.spawn.rect;
        rect.origin = body.position;
        Sprite { appearance, rect, velocity: body.velocity, trail: Vec::new() }
    }

    fn next(&mut self) -> Option<Result<Frame, Error>> {
        loop {
            match self.playback.next()? {
                Err(source) => return Some(Err(Error::Recording { path: self.path.clone(), source })),
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
