use crate::physics::{SolverKind, smaller};
use crate::picture::encode::apng::Delay;
use crate::text::counted;
use std::ops::RangeInclusive;

/// The highest frame rate of a GIF, frames per second: browsers slow down delays shorter than 2/100 s.
pub const MAX_GIF_FPS: f64 = 50.0;

/// The selection of the steps that become frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thinning {
    /// Every step.
    All,
    /// Every n-th step; 0 is treated as 1.
    Every(u64),
    /// The interval in whole steps that comes nearest to this frame rate, frames per simulated second;
    /// finite and positive.
    FramesPerSecond(f64),
}

/// The steps of a run that become frames.
///
/// They are the multiples of [`StepGrid::every`] in [`StepGrid::steps`], counted from step 0, so a part
/// of an animation has the same frames as the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct StepGrid {
    /// Steps from one frame to the next, at least 1.
    pub every: u64,
    /// The first and the last step that may be shown.
    pub steps: RangeInclusive<u64>,
    /// Steps per second, Hz.
    pub rate: f64,
}

impl StepGrid {
    /// The grid over `steps` of a run at `rate` Hz.
    pub fn new(steps: RangeInclusive<u64>, rate: f64, thinning: Thinning) -> StepGrid {
        let every = match thinning {
            Thinning::All => 1,
            Thinning::Every(every) => every,
            Thinning::FramesPerSecond(fps) => (rate / fps).round() as u64,
        };
        StepGrid { every: every.max(1), steps, rate }
    }

    /// Thins the grid further, if necessary, to at most `fps` frames per simulated second.
    pub fn limit_fps(self, fps: f64) -> StepGrid {
        let min_every = (self.rate / fps).ceil() as u64;
        StepGrid { every: self.every.max(min_every), ..self }
    }

    /// Thins the grid further, if necessary, to multiples of `recorded`, for recordings that store only
    /// every `recorded`-th state. 0 is treated as 1.
    pub fn restrict_to_every(self, recorded: u64) -> StepGrid {
        let recorded = recorded.max(1);
        // The least common multiple, by Euclid's algorithm.
        let (mut divisor, mut rest) = (self.every, recorded);
        while rest != 0 {
            (divisor, rest) = (rest, divisor % rest);
        }
        StepGrid { every: self.every.saturating_mul(recorded / divisor), ..self }
    }

    /// Returns true if `step` becomes a frame.
    pub fn contains(&self, step: u64) -> bool {
        self.steps.contains(&step) && step.is_multiple_of(self.every)
    }

    /// The number of frames.
    pub fn count(&self) -> u64 {
        if self.steps.is_empty() {
            return 0;
        }
        let first = self.steps.start().div_ceil(self.every);
        let last = self.steps.end() / self.every;
        last.saturating_add(1).saturating_sub(first)
    }
}

/// An instant of a run: a step and a time after it.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Moment {
    /// The step.
    pub step: u64,
    /// Time after the step, s; at least 0 and less than the duration of a step.
    pub offset: f64,
}

impl Moment {
    /// The same moment of a run at `from` Hz in a run at `to` Hz. A time that is a step up to rounding is that step.
    pub fn at_rate(self, from: f64, to: f64) -> Moment {
        if from == to {
            return self;
        }
        let steps = (self.step as f64 / from + self.offset) * to;
        let nearest = steps.round();
        if (steps - nearest).abs() <= 1e-9 + 1e-15 * steps {
            return Moment { step: nearest as u64, offset: 0.0 };
        }
        Moment { step: steps.floor() as u64, offset: (steps - steps.floor()) / to }
    }
}

/// The relation between playback time and simulated time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Playback speed: simulated seconds per second of playback, so 0.1 is slow motion.
    pub slow: f64,
    /// Frames per step; more than 1 only if the solver defines states between two steps.
    pub frames_per_step: u64,
    /// Additional display time of each freeze frame, s.
    pub hold: f64,
}

impl Timing {
    /// One second of playback shows one simulated second.
    pub const REAL_TIME: Timing = Timing { slow: 1.0, frames_per_step: 1, hold: 0.0 };
}

/// The shortest freeze, s. A viewer would not notice a shorter one.
pub const MIN_HOLD: f64 = 0.05;

/// The longest freeze, s. A longer one would look like the end of the animation.
pub const MAX_HOLD: f64 = 60.0;

/// The slowest and the fastest playback, simulated seconds per second of playback.
pub const SPEEDS: RangeInclusive<f64> = 1e-6..=1e6;

/// The largest number of frames of an animation, so that no file grows without bound.
pub const MAX_FRAMES: u64 = 10_000_000;

/// The largest number of frames per step.
pub const MAX_FRAMES_PER_STEP: u64 = 1 << 20;

/// Whole numbers below this are exact as f64.
const MAX_EXACT: f64 = 9_007_199_254_740_992.0;

/// The shortest delay of a GIF frame that browsers respect, 1/100 s.
const MIN_GIF_DELAY: u64 = 2;

/// The moment that each frame of an animation shows, and the time at which it is shown.
///
/// Every frame, including the last one, is shown for the simulated time until the next frame, divided
/// by the playback speed. A freeze frame is shown longer; it is an additional frame if its moment is
/// not on the grid. Rounding errors do not accumulate: each frame starts at its exact time, rounded
/// once, so the duration of the animation is exact.
#[derive(Clone, Debug, PartialEq)]
pub struct AnimationSchedule {
    /// The steps that become frames.
    pub grid: StepGrid,
    /// Playback speed, frames per step and duration of freeze frames.
    pub timing: Timing,
    freezes: Vec<Freeze>,
    /// The recording that is shown, if its steps are not those of the grid.
    sampling: Option<Sampling>,
}

/// A recording that is shown at the times of a grid of another rate, or at instants between its steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sampling {
    /// Steps per second, Hz.
    rate: f64,
    /// True if the recording has states between its steps; else the state of the last step is shown.
    is_continuous: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Freeze {
    moment: Moment,
    /// The number of the frame, counted from 0.
    frame: u64,
    /// The number of frames up to and including this one that are not on the grid.
    extra: u64,
}

impl From<StepGrid> for AnimationSchedule {
    /// Real time, without freeze frames.
    fn from(grid: StepGrid) -> AnimationSchedule {
        AnimationSchedule { grid, timing: Timing::REAL_TIME, freezes: Vec::new(), sampling: None }
    }
}

impl AnimationSchedule {
    /// A schedule that freezes at `moments`, which must be sorted. Of several moments between two frames
    /// only the first one is used.
    pub fn new(grid: StepGrid, timing: Timing, moments: &[Moment]) -> AnimationSchedule {
        // Several frames per step require every step.
        let every = if timing.frames_per_step > 1 { 1 } else { grid.every };
        let grid = StepGrid { every, ..grid };
        let mut schedule = AnimationSchedule { grid, timing, freezes: Vec::new(), sampling: None };
        let mut extra = 0;
        let mut last = None;
        for &moment in moments {
            let Some(index) = schedule.grid_index(moment).filter(|index| last != Some(*index)) else { continue };
            last = Some(index);
            let is_extra = schedule.grid_moment(index) != moment;
            extra += u64::from(is_extra);
            schedule.freezes.push(Freeze { moment, frame: index + extra, extra });
        }
        schedule
    }

    /// The schedule of one of several recordings that are shown at the times of this schedule, with `rate` Hz. At an
    /// instant between two of its steps a recording shows its state at that instant if its solver defines one, else the
    /// state before.
    pub fn of_recording(&self, rate: f64, solver: SolverKind) -> AnimationSchedule {
        let is_continuous = solver.is_continuous();
        if rate == self.grid.rate && (is_continuous || self.is_on_grid()) {
            return self.clone();
        }
        let ratio = rate / self.grid.rate;
        let (every, first) = (self.grid.every as f64 * ratio, self.first_step() as f64 * ratio);
        let is_whole = |steps: f64| steps >= 0.0 && steps.fract() == 0.0 && steps < MAX_EXACT;
        if self.timing.frames_per_step == 1
            && self.freezes.is_empty()
            && every >= 1.0
            && is_whole(every)
            && is_whole(first)
        {
            let last = first as u64 + self.grid.count().saturating_sub(1) * every as u64;
            let grid = StepGrid { every: every as u64, steps: first as u64..=last, rate };
            return AnimationSchedule { grid, ..self.clone() };
        }
        AnimationSchedule { sampling: Some(Sampling { rate, is_continuous }), ..self.clone() }
    }

    /// The moment of its recording that a frame shows, in steps of the recording.
    pub fn recorded_moment(&self, frame: u64) -> Moment {
        let moment = self.moment(frame);
        match self.sampling {
            None => moment,
            Some(Sampling { rate, is_continuous }) => {
                let moment = moment.at_rate(self.grid.rate, rate);
                if is_continuous { moment } else { Moment { offset: 0.0, ..moment } }
            }
        }
    }

    /// The rounding error of the instant of a freeze frame in the recording, s. Instants of another rate are rounded to
    /// steps; see [`Moment::at_rate`].
    pub fn recorded_rounding(&self, moment: Moment) -> f64 {
        let rate = self.recorded_rate();
        let rounding = 4.0 * f64::EPSILON * ((moment.step + 1) as f64 / rate);
        if rate == self.grid.rate { rounding } else { 3.0 * rounding + 2e-9 / smaller(rate, self.grid.rate) }
    }

    /// The steps per second of the recording, Hz.
    pub fn recorded_rate(&self) -> f64 {
        self.sampling.map_or(self.grid.rate, |sampling| sampling.rate)
    }

    /// The steps of the recording from one frame to the next, at least 1.
    pub fn recorded_interval(&self) -> u64 {
        let steps = self.grid.every as f64 * self.recorded_rate() / self.grid.rate;
        if self.sampling.is_some() { (steps.ceil() as u64).max(1) } else { self.grid.every }
    }

    /// The first and the last step of the recording that may be shown or that a shown instant follows.
    pub fn recorded_steps(&self) -> RangeInclusive<u64> {
        match self.sampling {
            None => self.grid.steps.clone(),
            Some(_) => {
                let last = self.count().saturating_sub(1);
                self.recorded_moment(0).step..=self.recorded_moment(last).step
            }
        }
    }

    /// The index of the last grid moment that is not after `moment`; `None` outside of the animation.
    pub(super) fn grid_index(&self, moment: Moment) -> Option<u64> {
        let first = self.first_step();
        let since = moment.step.checked_sub(first)?;
        let index = match self.timing.frames_per_step {
            1 => since / self.grid.every,
            count => {
                let in_step = (0..count).rev().find(|&at| self.offset(at) <= moment.offset).unwrap_or(0);
                since * count + in_step
            }
        };
        let count = self.grid_count();
        (index + 1 < count || self.grid_moment(index) == moment && index < count).then_some(index)
    }

    /// The moment with an index on the grid, freeze frames not counted.
    fn grid_moment(&self, index: u64) -> Moment {
        let count = self.timing.frames_per_step;
        Moment { step: self.first_step() + index / count * self.grid.every, offset: self.offset(index % count) }
    }

    /// The time after its step of the frame `at` of the frames of a step, s.
    fn offset(&self, at: u64) -> f64 {
        at as f64 / (self.timing.frames_per_step as f64 * self.grid.rate)
    }

    fn first_step(&self) -> u64 {
        self.grid.steps.start().div_ceil(self.grid.every) * self.grid.every
    }

    fn grid_count(&self) -> u64 {
        match self.grid.count() {
            0 => 0,
            count => (count - 1) * self.timing.frames_per_step + 1,
        }
    }

    /// The number of frames.
    pub fn count(&self) -> u64 {
        self.grid_count() + self.freezes.last().map_or(0, |freeze| freeze.extra)
    }

    /// The number of freeze frames.
    pub fn freeze_count(&self) -> u64 {
        self.freezes.len() as u64
    }

    /// Returns true if every frame shows the state of a step on the grid, so recorded states suffice.
    pub fn is_on_grid(&self) -> bool {
        self.sampling.is_none()
            && self.timing.frames_per_step == 1
            && self.freezes.iter().all(|freeze| freeze.extra == 0)
    }

    /// The moment shown by a frame; frames are counted from 0.
    pub fn moment(&self, frame: u64) -> Moment {
        match self.freezes.partition_point(|freeze| freeze.frame <= frame).checked_sub(1).map(|at| self.freezes[at]) {
            Some(freeze) if freeze.frame == frame => freeze.moment,
            Some(freeze) => self.grid_moment(frame - freeze.extra),
            None => self.grid_moment(frame),
        }
    }

    /// Returns true if this frame is a freeze frame.
    pub fn is_frozen_at(&self, frame: u64) -> bool {
        self.freezes.binary_search_by_key(&frame, |freeze| freeze.frame).is_ok()
    }

    /// The playback time at which a frame starts, s. For the frame after the last one this is the duration.
    pub fn start_time(&self, frame: u64) -> f64 {
        let frozen = self.timing.hold * self.freezes.partition_point(|freeze| freeze.frame < frame) as f64;
        let rate = self.grid.rate;
        let since = |moment: Moment| (moment.step - self.first_step()) as f64 / rate + moment.offset;
        let simulated = if frame < self.count() {
            since(self.moment(frame))
        } else {
            let last = self.grid_count().saturating_sub(1);
            since(self.grid_moment(last)) + self.grid.every as f64 / (self.timing.frames_per_step as f64 * rate)
        };
        simulated / self.timing.slow + frozen
    }

    /// The display time of a frame in ticks of a clock with `ticks_per_second`.
    pub fn ticks_shown(&self, frame: u64, ticks_per_second: f64) -> u64 {
        let start = |frame| (self.start_time(frame) * ticks_per_second).round() as u64;
        start(frame + 1) - start(frame)
    }

    /// The display time of a frame in a GIF, 1/100 s. At least 2 if the grid has no more than 50 frames
    /// per second and freezes last [`MIN_HOLD`] or longer.
    pub fn gif_delay(&self, frame: u64) -> u64 {
        self.gif_start(frame + 1) - self.gif_start(frame)
    }

    /// The time at which a frame starts in a GIF, 1/100 s. A freeze frame directly after another frame is
    /// delayed so that the other frame keeps the shortest delay.
    fn gif_start(&self, frame: u64) -> u64 {
        let own = |frame: u64| (self.start_time(frame) * 100.0).round() as u64;
        let is_extra = frame > 0 && self.is_frozen_at(frame);
        if is_extra { own(frame).max(own(frame - 1) + MIN_GIF_DELAY) } else { own(frame) }
    }

    /// The display time of a frame in an animated PNG.
    ///
    /// The format stores a fraction of a second. At an integral rate in real time it is exactly the
    /// duration of the steps; otherwise its unit is as small as the longest display time allows.
    pub fn apng_delay(&self, frame: u64) -> Delay {
        if let (Some(ticks), Some(ticks_per_second)) =
            (to_positive_u16(self.grid.every as f64), to_positive_u16(self.grid.rate))
            && self.timing == Timing::REAL_TIME
        {
            return Delay { ticks, ticks_per_second };
        }
        let longest = self.timing.hold + self.grid.every as f64 / (self.grid.rate * self.timing.slow);
        let finest = [10_000_u16, 1000, 100].into_iter().find(|&ticks| longest * f64::from(ticks) < 65_000.0);
        let ticks_per_second = finest.unwrap_or(10);
        let ticks = self.ticks_shown(frame, f64::from(ticks_per_second));
        Delay { ticks: u16::try_from(ticks).unwrap_or(u16::MAX), ticks_per_second }
    }

    /// The frame rate without freeze frames, frames per second of playback.
    pub fn frames_per_second(&self) -> f64 {
        self.grid.rate * self.timing.frames_per_step as f64 * self.timing.slow / self.grid.every as f64
    }
}

/// Converts a positive integral number that fits.
fn to_positive_u16(number: f64) -> Option<u16> {
    let rounded = number as u16;
    (f64::from(rounded) == number && rounded > 0).then_some(rounded)
}

impl std::fmt::Display for AnimationSchedule {
    /// Steps and frame rate for messages: `every 2nd step, 30 frames/s`.
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        match (self.grid.every, self.timing.frames_per_step) {
            (1, 1) => write!(out, "every step")?,
            (1, count) => write!(out, "{count} frames per step")?,
            (every, _) => write!(out, "every {every}{} step", ordinal_ending(every))?,
        }
        let frames = self.frames_per_second();
        // Two decimals, or more if that would leave less than two digits.
        let mut parts = 100.0;
        while frames > 0.0 && frames * parts < 10.0 {
            parts *= 10.0;
        }
        let frames = (frames * parts).round() / parts;
        write!(out, ", {frames} {}/s", if frames == 1.0 { "frame" } else { "frames" })?;
        if self.timing.slow != 1.0 {
            write!(out, ", {} × real time", self.timing.slow)?;
        }
        if self.timing.hold > 0.0 {
            write!(out, ", {} of {} s", counted(self.freeze_count(), "freeze frame"), self.timing.hold)?;
        }
        Ok(())
    }
}

fn ordinal_ending(number: u64) -> &'static str {
    match (number % 10, number % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Thinning;

    fn schedule(steps: std::ops::RangeInclusive<u64>, rate: f64, every: u64) -> AnimationSchedule {
        AnimationSchedule::from(StepGrid::new(steps, rate, Thinning::Every(every)))
    }

    fn delays(schedule: &AnimationSchedule) -> Vec<u64> {
        (0..schedule.count()).map(|frame| schedule.gif_delay(frame)).collect()
    }

    #[test]
    fn gif_delays_sum_to_the_duration_and_start_each_frame_at_its_time() {
        for (rate, every) in [(60.0, 2), (30.0, 1), (120.0, 3), (1000.0, 33), (59.94, 2), (7.0, 1), (50.0, 1)] {
            for (from, to) in [(0, 600), (0, 601), (17, 480)] {
                let schedule = schedule(from..=to, rate, every);
                let mut shown = 0;
                for frame in 0..schedule.count() {
                    let exact = 100.0 * (frame * every) as f64 / rate;
                    assert!((shown as f64 - exact).abs() <= 0.5, "frame {frame}");
                    assert!(schedule.gif_delay(frame) >= 2);
                    shown += schedule.gif_delay(frame);
                }
                assert_eq!(shown, (100.0 * (schedule.count() * every) as f64 / rate).round() as u64, "at {rate} Hz");
            }
        }
    }

    #[test]
    fn every_2nd_step_at_60_hz_alternates_between_delays_of_3_and_4_hundredths() {
        assert_eq!(delays(&schedule(0..=12, 60.0, 2)), [3, 4, 3, 3, 4, 3, 3]);
        assert_eq!(delays(&schedule(0..=0, 60.0, 2)), [3]);
        assert_eq!(delays(&schedule(0..=3, 50.0, 1)), [2, 2, 2, 2]);
    }

    #[test]
    fn an_animated_png_has_exact_delays_and_the_duration_of_a_gif() {
        let delay = |rate, every, frame| {
            let delay = schedule(0..=600, rate, every).apng_delay(frame);
            (delay.ticks, delay.ticks_per_second)
        };
        assert_eq!([delay(60.0, 1, 0), delay(60.0, 2, 300), delay(1000.0, 33, 5)], [(1, 60), (2, 60), (33, 1000)]);
        assert_eq!([delay(59.94, 1, 0), delay(59.94, 1, 1)], [(167, 10_000), (167, 10_000)]);
        let clip = schedule(0..=600, 59.94, 1);
        let total: u64 = (0..601).map(|frame| u64::from(clip.apng_delay(frame).ticks)).sum();
        assert_eq!(total, (601.0_f64 / 59.94 * 10_000.0).round() as u64);
        assert_eq!(delays(&clip).iter().sum::<u64>(), (601.0_f64 / 59.94 * 100.0).round() as u64);
    }

    #[test]
    fn display_names_the_steps_and_the_frame_rate() {
        let words = |rate, every| schedule(0..=10, rate, every).to_string();
        assert_eq!(words(60.0, 1), "every step, 60 frames/s");
        assert_eq!(words(60.0, 2), "every 2nd step, 30 frames/s");
        assert_eq!(words(1000.0, 33), "every 33rd step, 30.3 frames/s");
        assert_eq!(words(1000.0, 11), "every 11th step, 90.91 frames/s");
        assert_eq!(words(1.0, 1000), "every 1000th step, 0.001 frames/s");
        assert_eq!(words(1.0, 30), "every 30th step, 0.033 frames/s");
    }

    const fn at(step: u64, offset: f64) -> Moment {
        Moment { step, offset }
    }

    #[test]
    fn slow_motion_shows_moments_between_steps() {
        let timing = Timing { slow: 0.25, frames_per_step: 2, hold: 0.0 };
        let clip = AnimationSchedule::new(StepGrid::new(3..=5, 10.0, Thinning::Every(1)), timing, &[]);
        let moments: Vec<Moment> = (0..clip.count()).map(|frame| clip.moment(frame)).collect();
        assert_eq!(moments, [at(3, 0.0), at(3, 0.05), at(4, 0.0), at(4, 0.05), at(5, 0.0)]);
        assert_eq!(delays(&clip), [20; 5]);
        assert_eq!(clip.to_string(), "2 frames per step, 5 frames/s, 0.25 × real time");
    }

    #[test]
    fn freeze_frames_are_shown_longer_and_are_additional_frames_between_steps() {
        let timing = Timing { hold: 0.5, ..Timing::REAL_TIME };
        let moments = [at(1, 0.04), at(1, 0.05), at(3, 0.0), at(9, 0.0)];
        let clip = AnimationSchedule::new(StepGrid::new(0..=4, 10.0, Thinning::Every(1)), timing, &moments);
        let shown: Vec<Moment> = (0..clip.count()).map(|frame| clip.moment(frame)).collect();
        let expected = [at(0, 0.0), at(1, 0.0), at(1, 0.04), at(2, 0.0), at(3, 0.0), at(4, 0.0)];
        assert_eq!(shown, expected, "the second moment between steps 1 and 2 is skipped");
        assert_eq!(delays(&clip), [10, 4, 56, 10, 60, 10]);
        assert_eq!((clip.freeze_count(), clip.is_on_grid()), (2, false));
    }

    #[test]
    fn a_freeze_frame_just_after_another_frame_leaves_it_the_shortest_delay() {
        let timing = Timing { hold: 0.05, ..Timing::REAL_TIME };
        let clip =
            AnimationSchedule::new(StepGrid::new(0..=3, 50.0, Thinning::All), timing, &[at(1, 0.001), at(2, 0.0199)]);
        assert_eq!(delays(&clip), [2, 2, 5, 2, 5, 2]);
        assert_eq!(delays(&clip).iter().sum::<u64>(), 18);
    }

    #[test]
    fn an_empty_range_of_steps_has_no_frames() {
        #[expect(clippy::reversed_empty_ranges)]
        let empty = schedule(7..=3, 60.0, 1);
        assert_eq!((empty.count(), empty.is_on_grid()), (0, true));
    }

    fn steps(grid: &StepGrid) -> Vec<u64> {
        (0..=grid.steps.end() + 5).filter(|&step| grid.contains(step)).collect()
    }

    #[test]
    fn frames_are_multiples_counted_from_step_0_with_both_ends_included() {
        let whole = StepGrid::new(0..=12, 60.0, Thinning::Every(4));
        assert_eq!(steps(&whole), [0, 4, 8, 12]);
        let part = StepGrid::new(4..=11, 60.0, Thinning::Every(4));
        assert_eq!(steps(&part), [4, 8]);
        let between = StepGrid::new(5..=7, 60.0, Thinning::Every(4));
        assert_eq!(steps(&between), [0; 0]);
        for grid in [whole, part, between] {
            assert_eq!(grid.count(), steps(&grid).len() as u64);
        }
    }

    #[test]
    #[expect(clippy::reversed_empty_ranges)]
    fn a_reversed_range_of_steps_is_empty() {
        assert_eq!(StepGrid::new(7..=3, 60.0, Thinning::All).count(), 0);
    }

    #[test]
    fn a_frame_rate_becomes_the_nearest_whole_number_of_steps() {
        let every = |rate, fps| StepGrid::new(0..=10, rate, Thinning::FramesPerSecond(fps)).every;
        assert_eq!([every(60.0, 30.0), every(60.0, 25.0), every(60.0, 24.0), every(60.0, 50.0)], [2, 2, 3, 1]);
        assert_eq!([every(60.0, 120.0), every(1000.0, 30.0), every(0.5, 30.0)], [1, 33, 1]);
    }

    #[test]
    fn a_gif_shows_at_most_50_frames_per_second() {
        let every = |rate| StepGrid::new(0..=10, rate, Thinning::All).limit_fps(MAX_GIF_FPS).every;
        assert_eq!([every(50.0), every(60.0), every(100.0), every(120.0), every(24.0)], [1, 2, 2, 3, 1]);
    }

    #[test]
    fn large_intervals_cost_nothing() {
        let every =
            |every, recorded| StepGrid::new(0..=90, 60.0, Thinning::Every(every)).restrict_to_every(recorded).every;
        assert_eq!(every(2, 100_000_000_003), 200_000_000_006);
        assert_eq!(every(100_000_000_004, 6), 300_000_000_012);
        assert_eq!(every(u64::MAX, u64::MAX - 1), u64::MAX);
    }

    #[test]
    fn only_recorded_steps_become_frames() {
        let every =
            |every, recorded| StepGrid::new(0..=90, 60.0, Thinning::Every(every)).restrict_to_every(recorded).every;
        assert_eq!(
            [every(2, 1), every(2, 10), every(4, 10), every(7, 3), every(10, 2), every(3, 0)],
            [2, 10, 20, 21, 10, 3]
        );
    }
}
