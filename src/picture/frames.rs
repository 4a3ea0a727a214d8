use super::resimulation::Resimulation;
use super::source::{ReadExtent, ReadStatus, RecordingFile};
use super::{AnimationSchedule, Appearance, Error, Frame, Overlay, Overlays, Source, Sprite, StepGrid, Trails};
use crate::physics::BodyId;
use crate::recording::{self, Playback, SampledBody};
use std::{collections::BTreeMap, path::PathBuf, sync::Arc};

/// An iterator over the frames of an animation schedule, in order. Its memory use does not depend on
/// their number.
pub enum Frames {
    /// Frames read from the recorded states.
    Recorded(Box<RecordedFrames>),
    /// Frames computed by replaying the recording.
    Resimulated(Box<Resimulation>),
}

impl Frames {
    /// The frames of `schedule` with the data that the overlays in `show` need. The recording is
    /// replayed only if necessary.
    ///
    /// # Errors
    /// If the recording cannot be read.
    pub fn new(source: &Source, schedule: &AnimationSchedule, show: &Overlays) -> Result<Frames, Error> {
        let trails = show.contains(Overlay::Trail).then(|| Trails::of_one_second(schedule.recorded_rate()));
        if show.show_collisions() || !schedule.is_on_grid() {
            let frames = Resimulation::start(source, schedule.clone(), trails)?;
            return Ok(Frames::Resimulated(Box::new(frames)));
        }
        Ok(Frames::Recorded(Box::new(RecordedFrames::new(source, &schedule.grid, trails)?)))
    }

    /// The health of the recording as far as it was read; final after the last frame.
    pub fn read_status(&self) -> ReadStatus {
        match self {
            Frames::Recorded(frames) => frames.read_status(),
            Frames::Resimulated(frames) => frames.read_status(),
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

/// Frames made from recorded states.
pub struct RecordedFrames {
    path: PathBuf,
    playback: Playback<RecordingFile>,
    source: Source,
    grid: StepGrid,
    trails: Option<Trails>,
    appearances: BTreeMap<BodyId, Arc<Appearance>>,
    /// The step of the next state, if none is missing.
    expected: Option<u64>,
    extent: ReadExtent,
}

impl RecordedFrames {
    fn new(source: &Source, grid: &StepGrid, trails: Option<Trails>) -> Result<RecordedFrames, Error> {
        let mut playback = Playback::new(source.recording()?);
        // The trail of the first frame begins before that frame.
        let first = grid.steps.start().saturating_sub(trails.as_ref().map_or(0, Trails::steps));
        playback.seek(first).map_err(|error| source.read_error(error))?;
        Ok(RecordedFrames {
            path: source.path.clone(),
            playback,
            source: source.clone(),
            grid: grid.clone(),
            trails,
            appearances: BTreeMap::new(),
            expected: None,
            extent: ReadExtent::End,
        })
    }

    fn read_status(&self) -> ReadStatus {
        ReadStatus { path: self.path.clone(), health: self.playback.health(), extent: self.extent }
    }

    fn frame(&mut self, state: recording::SampledState) -> Option<Frame> {
        let is_shown = self.grid.contains(state.step);
        if !is_shown && self.trails.is_none() {
            return None;
        }
        let mut sprites: Vec<Sprite> = state.bodies.iter().map(|body| self.sprite(body)).collect();
        let is_after_gap = self.expected.is_some_and(|expected| state.step > expected);
        self.expected = Some(state.step + self.playback.header().every);
        if let Some(trails) = &mut self.trails {
            if is_after_gap {
                trails.interrupt();
            }
            trails.update(state.step, &mut sprites);
        }
        is_shown.then_some(Frame { step: state.step, time: state.time, sprites, collisions: Vec::new() })
    }

    fn sprite(&mut self, body: &SampledBody) -> Sprite {
        let info = &body.info;
        let source = &self.source;
        let appearance = self.appearances.entry(info.id).or_insert_with(|| Arc::new(source.appearance(info))).clone();
        let mut rect = info.spawn.rect;
        rect.origin = body.position;
        Sprite { appearance, rect, velocity: body.velocity, trail: Vec::new() }
    }

    fn next(&mut self) -> Option<Result<Frame, Error>> {
        loop {
            match self.playback.next()? {
                Err(source) => return Some(Err(Error::Recording { path: self.path.clone(), source })),
                Ok(state) if state.step > *self.grid.steps.end() => {
                    self.extent = ReadExtent::LastStep;
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
