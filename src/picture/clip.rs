//! The input of an encoder of animations.

use super::layers::lanes::{LaneConflicts, MAX_KEPT};
use super::layers::{LayoutContext, arrows};
use super::number::TimeFormat;
use super::side_by_side::{SideBySide, Stage};
use super::{
    Animation, AnimationFormat, AnimationSchedule, Error, Frame, Frames, Look, Moment, Overlay, PictureOptions,
    Progress, Provenance, ReadStatus, ResolvedPicture, Source, Style, Subject, View,
};
use crate::physics::larger;
use crate::picture::draw::{BodyNames, label_warning, text_warnings};
use crate::picture::page::run_names;

/// The input of an encoder of animations: the instants, how they are drawn, and when they are shown.
pub struct Clip {
    /// Camera and style, of one recording or of several side by side.
    pub stage: Stage,
    /// The time at which each frame is shown.
    pub schedule: AnimationSchedule,
    /// The instants, with the data that the overlays need.
    pub instants: Instants,
    /// Sentences about contents that cannot be drawn as they are.
    pub warnings: Vec<String>,
}

impl Clip {
    /// The frames of a video, whose frame rate is unlimited, and its provenance: that of an animated PNG of the same
    /// frames.
    ///
    /// # Errors
    /// As for [`PictureOptions::resolve`] and [`Clip::new`].
    pub fn video(
        options: &PictureOptions,
        sources: &[Source],
        progress: Progress,
    ) -> Result<(Clip, Provenance), Error> {
        let (animation, look, titles) = options.resolve_video(sources)?;
        let clip = Clip::new(&animation, &look, &titles, sources, progress)?.with_common_lanes(sources)?;
        let subject = Subject::Animation { animation, format: AnimationFormat::Apng };
        let picture = ResolvedPicture { subject, look, titles };
        Ok((clip, Provenance::new(&picture, sources)))
    }

    /// The frames of an animation of recordings. `titles` are those above several recordings, or their own if empty.
    ///
    /// # Errors
    /// If a recording cannot be read, if the picture is too small for its content, or if the scale of impulse arrows
    /// or freeze frames require a replay and that fails.
    pub fn new(
        animation: &Animation,
        look: &Look,
        titles: &[String],
        sources: &[Source],
        progress: Progress,
    ) -> Result<Clip, Error> {
        let schedule = animation.schedule_with_freeze_frames(sources, progress)?;
        let grid = &schedule.grid;
        let interval = 1.0 / (grid.rate * animation.timing.frames_per_step as f64);
        let time_format =
            TimeFormat::new(interval, sources.iter().map(Source::duration).fold(0.0, larger), look.language);
        let style = Style { time_format, ..Style::new(look, sources, progress)? };
        let instants = Instants::new(sources, &schedule, look)?;
        let gaps =
            instants.tracks.iter().zip(sources).map(|(track, source)| source.gaps_in(&track.schedule.recorded_steps()));
        let mut styles: Vec<Style> = gaps.map(|gaps| Style { gaps, ..style.clone() }).collect();
        let stage = match sources {
            [source] => Stage::One(View::new(source.world(), styles.pop().unwrap_or(style))?),
            _ => {
                let panels: Vec<_> = sources.iter().map(Source::world).zip(styles).collect();
                Stage::Several(SideBySide::new(&panels, &run_names(titles, sources))?)
            }
        };
        let shown_titles = if sources.len() > 1 { run_names(titles, sources) } else { Vec::new() };
        let mut warnings = text_warnings(look, &shown_titles, sources, BodyNames::IfOverlay);
        warnings.extend(label_warning(look, sources));
        Ok(Clip { stage, schedule, instants, warnings })
    }

    /// The same clip with lanes for the arrows of bodies that are common to all frames, so that no arrow jumps. They
    /// follow from the frames, which are read once more for this.
    ///
    /// # Errors
    /// If a recording cannot be read.
    pub(super) fn with_common_lanes(mut self, sources: &[Source]) -> Result<Clip, Error> {
        for ((view, metrics), (source, track)) in
            self.stage.views_mut().into_iter().zip(sources.iter().zip(&self.instants.tracks))
        {
            let look = &view.style.look;
            let has_arrows = [Overlay::Velocity, Overlay::Momentum, Overlay::Force]
                .into_iter()
                .any(|overlay| look.show.contains(overlay));
            if has_arrows && view.style.body_count as usize <= MAX_KEPT {
                let mut conflicts = LaneConflicts::default();
                for frame in Frames::new(source, &track.schedule, &look.show)? {
                    let frame = frame?;
                    let context = LayoutContext { view: &*view, camera: view.camera_for(&frame), metrics };
                    conflicts.add(&arrows::of_bodies(&frame, &context));
                }
                view.style.lanes = conflicts.lanes();
            }
        }
        Ok(self)
    }
}

/// The recording whose steps are the clock of a picture of several: of those whose solver defines no states between its
/// steps, or else of all, the first one with the highest rate.
///
/// # Errors
/// If there is no recording.
pub fn clock<'a>(sources: &'a [Source]) -> Result<&'a Source, Error> {
    let is_discrete = |source: &Source| !source.header.config.solver.is_continuous();
    let has_discrete = sources.iter().any(is_discrete);
    let candidates = sources.iter().filter(|source| !has_discrete || is_discrete(source));
    let faster = |fastest: &'a Source, source: &'a Source| {
        if source.header.config.rate > fastest.header.config.rate { source } else { fastest }
    };
    candidates.reduce(faster).ok_or_else(|| Error::NothingToShow { reason: "no recording is given".into() })
}

/// One instant of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Instant {
    /// The step of the clock.
    pub step: u64,
    /// Simulated time, s.
    pub time: f64,
    /// The frame of each recording.
    pub shots: Vec<Shot>,
}

/// The frame of a recording at an instant.
#[derive(Clone, Debug, PartialEq)]
pub enum Shot {
    /// The recorded or replayed frame.
    Frame(Frame),
    /// The recording lacks the state of this step.
    Missing {
        /// The step.
        step: u64,
    },
}

impl From<Frame> for Instant {
    fn from(frame: Frame) -> Instant {
        Instant { step: frame.step, time: frame.time, shots: vec![Shot::Frame(frame)] }
    }
}

impl Instant {
    /// Returns true if no recording has a frame of this instant.
    pub fn is_missing(&self) -> bool {
        !self.frames().any(|_| true)
    }

    /// The frames of the recordings that have one.
    pub fn frames(&self) -> impl Iterator<Item = &Frame> {
        self.shots.iter().filter_map(|shot| match shot {
            Shot::Frame(frame) => Some(frame),
            Shot::Missing { .. } => None,
        })
    }
}

/// An iterator over the instants of an animation schedule, in order. Its memory use does not depend on their number.
pub struct Instants {
    tracks: Vec<Track>,
    schedule: AnimationSchedule,
    next: u64,
    /// True if one of the instants so far had a frame of a recording.
    has_frames: bool,
}

/// The frames of one recording.
struct Track {
    source: Source,
    schedule: AnimationSchedule,
    frames: Frames,
    /// The first frame that was not shown yet; states before it are missing.
    pending: Option<Frame>,
}

impl Instants {
    /// The instants of `schedule`, whose rate is that of the [`clock`].
    ///
    /// # Errors
    /// If a recording cannot be read.
    fn new(sources: &[Source], schedule: &AnimationSchedule, look: &Look) -> Result<Instants, Error> {
        let track = |source: &Source| {
            let config = &source.header.config;
            let schedule = schedule.of_recording(config.rate, config.solver);
            let frames = Frames::new(source, &schedule, &look.show)?;
            Ok(Track { source: source.clone(), schedule, frames, pending: None })
        };
        let tracks = sources.iter().map(track).collect::<Result<Vec<Track>, Error>>()?;
        Ok(Instants { tracks, schedule: schedule.clone(), next: 0, has_frames: false })
    }

    /// The health of each recording as far as it was read; final after the last instant.
    pub fn read_statuses(&self) -> Vec<ReadStatus> {
        self.tracks.iter().map(|track| track.frames.read_status()).collect()
    }

    fn instant(&mut self, number: u64) -> Result<Instant, Error> {
        let moment = self.schedule.moment(number);
        let shots = self.tracks.iter_mut().map(|track| track.shot(number)).collect::<Result<Vec<Shot>, Error>>()?;
        let time = moment.step as f64 / self.schedule.grid.rate + moment.offset;
        let instant = Instant { step: moment.step, time, shots };
        self.has_frames |= !instant.is_missing();
        Ok(instant)
    }

    /// Reads on after the last instant, because damage directly after it is found only so.
    ///
    /// # Errors
    /// If a recording cannot be read, or if no instant has a frame.
    fn finish(&mut self) -> Result<(), Error> {
        self.tracks.iter_mut().try_for_each(|track| track.frames.next().transpose().map(|_| ()))?;
        match self.tracks.first() {
            Some(Track { source, schedule, frames, .. }) if !self.has_frames => {
                Err(source.missing_states(&schedule.recorded_steps(), frames.read_status().health))
            }
            Some(_) | None => Ok(()),
        }
    }
}

impl Track {
    /// The frame of that number.
    fn shot(&mut self, number: u64) -> Result<Shot, Error> {
        let Moment { step, offset } = self.schedule.recorded_moment(number);
        let time = step as f64 / self.schedule.recorded_rate() + offset;
        if self.pending.is_none() {
            self.pending = self.frames.next().transpose()?;
        }
        let is_shown = |frame: &mut Frame| frame.step == step && (offset == 0.0 || frame.time == time);
        Ok(self.pending.take_if(is_shown).map_or(Shot::Missing { step }, Shot::Frame))
    }
}

impl Iterator for Instants {
    type Item = Result<Instant, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.schedule.count() {
            count if self.next < count => {
                self.next += 1;
                Some(self.instant(self.next - 1))
            }
            count if self.next == count => {
                self.next += 1;
                self.finish().err().map(Err)
            }
            _ => None,
        }
    }
}
