use super::Sampling;
use super::apng::Delay;

/// An instant of a run: a step, and the seconds since that step.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Moment {
    /// The step.
    pub step: u64,
    /// s, 0 or more and less than a step lasts.
    pub offset: f64,
}

/// How an animation goes through a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Simulated seconds for each second on the screen: 0.1 is slow motion.
    pub slow: f64,
    /// Instants shown for each step; more than 1 only where there is something between two steps.
    pub parts: u64,
    /// Seconds for which each of the moments held stays longer.
    pub hold: f64,
}

impl Pace {
    /// As fast as it happened.
    pub const TRUE: Pace = Pace { slow: 1.0, parts: 1, hold: 0.0 };
}

/// The shortest an animation stops, s: what is shorter is not seen.
pub const SHORTEST_HOLD: f64 = 0.05;

/// The shortest time browsers show a GIF's frame for, 1/100 s.
const SHORTEST_DELAY: u64 = 2;

/// When each frame of an animation is on the screen, and what it shows.
///
/// Each frame is shown as long as the time it stands for, the last one too, at the clip's pace;
/// the moments held are frames of their own if no other frame shows them, and stay longer. No
/// rounding is ever carried on: a frame appears at its true time, rounded, so that the whole
/// lasts exactly as long as it should.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    /// The steps between which it goes, and how many of them it shows.
    pub sampling: Sampling,
    /// How.
    pub pace: Pace,
    holds: Vec<Hold>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Hold {
    moment: Moment,
    /// Which frame it is, counted from 0.
    frame: u64,
    /// How many frames up to this one are not on the grid.
    extra: u64,
}

impl From<Sampling> for Timeline {
    /// At its true pace.
    fn from(sampling: Sampling) -> Timeline {
        Timeline { sampling, pace: Pace::TRUE, holds: Vec::new() }
    }
}

impl Timeline {
    /// The timeline that stops at `moments`, which are in order; between two frames only at the
    /// first of them.
    pub fn new(sampling: Sampling, pace: Pace, moments: &[Moment]) -> Timeline {
        // Between two steps there is something to show for each of them.
        let every = if pace.parts > 1 { 1 } else { sampling.every };
        let mut timeline = Timeline { sampling: Sampling { every, ..sampling }, pace, holds: Vec::new() };
        let mut extra = 0;
        let mut last = None;
        for &moment in moments {
            let Some(place) = timeline.place(moment).filter(|place| last != Some(*place)) else { continue };
            last = Some(place);
            let is_extra = timeline.on_grid(place) != moment;
            extra += u64::from(is_extra);
            timeline.holds.push(Hold { moment, frame: place + extra, extra });
        }
        timeline
    }

    /// The last frame on the grid that is not after a moment; none outside of the clip.
    fn place(&self, moment: Moment) -> Option<u64> {
        let first = self.first_step();
        let since = moment.step.checked_sub(first)?;
        let place = match self.pace.parts {
            1 => since / self.sampling.every,
            parts => {
                let in_step = (0..parts).rev().find(|&part| self.offset(part) <= moment.offset).unwrap_or(0);
                since * parts + in_step
            }
        };
        (place + 1 < self.grid_count() || self.on_grid(place) == moment && place < self.grid_count()).then_some(place)
    }

    /// The moment of a frame on the grid.
    fn on_grid(&self, place: u64) -> Moment {
        let (steps, part) = (place / self.pace.parts, place % self.pace.parts);
        Moment { step: self.first_step() + steps * self.sampling.every, offset: self.offset(part) }
    }

    fn offset(&self, part: u64) -> f64 {
        part as f64 / (self.pace.parts as f64 * self.sampling.rate)
    }

    fn first_step(&self) -> u64 {
        self.sampling.steps.start().div_ceil(self.sampling.every) * self.sampling.every
    }

    fn grid_count(&self) -> u64 {
        match self.sampling.count() {
            0 => 0,
            count => (count - 1) * self.pace.parts + 1,
        }
    }

    /// The number of frames.
    pub fn count(&self) -> u64 {
        self.grid_count() + self.holds.last().map_or(0, |hold| hold.extra)
    }

    /// The number of moments at which it stops.
    pub fn stops(&self) -> u64 {
        self.holds.len() as u64
    }

    /// Whether all it shows are states of steps on the grid of its sampling.
    pub fn is_plain(&self) -> bool {
        self.pace.parts == 1 && self.holds.iter().all(|hold| hold.extra == 0)
    }

    /// What the frame of that number, counted from 0, shows.
    pub fn moment(&self, frame: u64) -> Moment {
        match self.holds.partition_point(|hold| hold.frame <= frame).checked_sub(1).map(|at| self.holds[at]) {
            Some(hold) if hold.frame == frame => hold.moment,
            Some(hold) => self.on_grid(frame - hold.extra),
            None => self.on_grid(frame),
        }
    }

    /// Whether it stops at the frame of that number.
    pub fn stops_at(&self, frame: u64) -> bool {
        self.holds.binary_search_by_key(&frame, |hold| hold.frame).is_ok()
    }

    /// When a frame appears after the first one, s; the one after the last at the end.
    pub fn appears(&self, frame: u64) -> f64 {
        let held = self.pace.hold * self.holds.partition_point(|hold| hold.frame < frame) as f64;
        let rate = self.sampling.rate;
        let since = |moment: Moment| (moment.step - self.first_step()) as f64 / rate + moment.offset;
        let simulated = if frame < self.count() {
            since(self.moment(frame))
        } else {
            let last = self.grid_count().saturating_sub(1);
            since(self.on_grid(last)) + self.sampling.every as f64 / (self.pace.parts as f64 * rate)
        };
        simulated / self.pace.slow + held
    }

    /// How many parts of a second, `per_second` of them in one, the frame of that number is shown.
    pub fn parts_shown(&self, frame: u64, per_second: f64) -> u64 {
        let appears = |frame| (self.appears(frame) * per_second).round() as u64;
        appears(frame + 1) - appears(frame)
    }

    /// How long a GIF shows the frame of that number, 1/100 s: at least two of them if no more
    /// than 50 frames a second are on the grid and stops last [`SHORTEST_HOLD`] or longer.
    pub fn delay(&self, frame: u64) -> u64 {
        self.hundredth(frame + 1) - self.hundredth(frame)
    }

    /// When a GIF shows a frame, 1/100 s. A stop just behind a frame waits until that was seen.
    fn hundredth(&self, frame: u64) -> u64 {
        let own = |frame: u64| (self.appears(frame) * 100.0).round() as u64;
        let is_extra = frame > 0 && self.stops_at(frame);
        if is_extra { own(frame).max(own(frame - 1) + SHORTEST_DELAY) } else { own(frame) }
    }

    /// How long an animated PNG shows the frame of that number.
    ///
    /// Exactly as long as the steps it stands for, since the format counts in parts of a second
    /// of one's choice; rates that are no whole number of Hz, slow motion and stops are told in
    /// parts as fine as the longest stop allows.
    pub fn exact_delay(&self, frame: u64) -> Delay {
        if let (Some(parts), Some(per_second)) = (whole(self.sampling.every as f64), whole(self.sampling.rate))
            && self.pace == Pace::TRUE
        {
            return Delay { parts, per_second };
        }
        let longest = self.pace.hold + self.sampling.every as f64 / (self.sampling.rate * self.pace.slow);
        let finest = [10_000_u16, 1000, 100].into_iter().find(|&fine| longest * f64::from(fine) < 65_000.0);
        let per_second = finest.unwrap_or(10);
        let parts = self.parts_shown(frame, f64::from(per_second));
        Delay { parts: u16::try_from(parts).unwrap_or(u16::MAX), per_second }
    }

    /// Frames on the grid for each second on the screen.
    pub fn frames_per_second(&self) -> f64 {
        self.sampling.rate * self.pace.parts as f64 * self.pace.slow / self.sampling.every as f64
    }
}

fn whole(number: f64) -> Option<u16> {
    let rounded = number as u16;
    (f64::from(rounded) == number && rounded > 0).then_some(rounded)
}

impl std::fmt::Display for Timeline {
    /// What was sampled, for people: `every 2nd step, 30 frames/s`.
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        match (self.sampling.every, self.pace.parts) {
            (1, 1) => write!(out, "every step")?,
            (1, parts) => write!(out, "{parts} instants a step")?,
            (every, _) => write!(out, "every {every}{} step", ordinal_ending(every))?,
        }
        let frames = (self.frames_per_second() * 100.0).round() / 100.0;
        write!(out, ", {frames} frames/s")?;
        if self.pace.slow != 1.0 {
            write!(out, ", {} × as fast as it happens", self.pace.slow)?;
        }
        if self.pace.hold > 0.0 {
            let (count, noun) = (self.stops(), if self.stops() == 1 { "stop" } else { "stops" });
            write!(out, ", {count} {noun} of {} s", self.pace.hold)?;
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
    use crate::render::Thinning;

    fn timeline(steps: std::ops::RangeInclusive<u64>, rate: f64, every: u64) -> Timeline {
        Timeline::from(Sampling::new(steps, rate, Thinning::Every(every)))
    }

    fn delays(timeline: &Timeline) -> Vec<u64> {
        (0..timeline.count()).map(|frame| timeline.delay(frame)).collect()
    }

    #[test]
    fn delays_add_up_to_the_duration_and_put_each_frame_at_its_instant() {
        for (rate, every) in [(60.0, 2), (30.0, 1), (120.0, 3), (1000.0, 33), (59.94, 2), (7.0, 1), (50.0, 1)] {
            for (from, to) in [(0, 600), (0, 601), (17, 480)] {
                let timeline = timeline(from..=to, rate, every);
                let mut shown = 0;
                for frame in 0..timeline.count() {
                    let exact = 100.0 * (frame * every) as f64 / rate;
                    assert!((shown as f64 - exact).abs() <= 0.5, "frame {frame}");
                    assert!(timeline.delay(frame) >= 2);
                    shown += timeline.delay(frame);
                }
                assert_eq!(shown, (100.0 * (timeline.count() * every) as f64 / rate).round() as u64, "at {rate} Hz");
            }
        }
    }

    #[test]
    fn sixty_hertz_by_twos_alternates_between_3_and_4_hundredths() {
        assert_eq!(delays(&timeline(0..=12, 60.0, 2)), [3, 4, 3, 3, 4, 3, 3]);
        assert_eq!(delays(&timeline(0..=0, 60.0, 2)), [3]);
        assert_eq!(delays(&timeline(0..=3, 50.0, 1)), [2, 2, 2, 2]);
    }

    #[test]
    fn an_animated_png_counts_in_steps_and_lasts_as_long_as_a_gif() {
        let delay = |rate, every, frame| {
            let delay = timeline(0..=600, rate, every).exact_delay(frame);
            (delay.parts, delay.per_second)
        };
        assert_eq!([delay(60.0, 1, 0), delay(60.0, 2, 300), delay(1000.0, 33, 5)], [(1, 60), (2, 60), (33, 1000)]);
        assert_eq!([delay(59.94, 1, 0), delay(59.94, 1, 1)], [(167, 10_000), (167, 10_000)]);
        let clip = timeline(0..=600, 59.94, 1);
        let total: u64 = (0..601).map(|frame| u64::from(clip.exact_delay(frame).parts)).sum();
        assert_eq!(total, (601.0_f64 / 59.94 * 10_000.0).round() as u64);
        assert_eq!(delays(&clip).iter().sum::<u64>(), (601.0_f64 / 59.94 * 100.0).round() as u64);
    }

    #[test]
    fn it_says_what_was_sampled() {
        let words = |rate, every| timeline(0..=10, rate, every).to_string();
        assert_eq!(words(60.0, 1), "every step, 60 frames/s");
        assert_eq!(words(60.0, 2), "every 2nd step, 30 frames/s");
        assert_eq!(words(1000.0, 33), "every 33rd step, 30.3 frames/s");
        assert_eq!(words(1000.0, 11), "every 11th step, 90.91 frames/s");
    }

    const fn at(step: u64, offset: f64) -> Moment {
        Moment { step, offset }
    }

    #[test]
    fn slow_motion_shows_instants_between_steps() {
        let pace = Pace { slow: 0.25, parts: 2, hold: 0.0 };
        let clip = Timeline::new(Sampling::new(3..=5, 10.0, Thinning::Every(1)), pace, &[]);
        let moments: Vec<Moment> = (0..clip.count()).map(|frame| clip.moment(frame)).collect();
        assert_eq!(moments, [at(3, 0.0), at(3, 0.05), at(4, 0.0), at(4, 0.05), at(5, 0.0)]);
        assert_eq!(delays(&clip), [20; 5]);
        assert_eq!(clip.to_string(), "2 instants a step, 5 frames/s, 0.25 × as fast as it happens");
    }

    #[test]
    fn moments_held_stay_longer_and_are_frames_of_their_own_between_steps() {
        let pace = Pace { hold: 0.5, ..Pace::TRUE };
        let moments = [at(1, 0.04), at(1, 0.05), at(3, 0.0), at(9, 0.0)];
        let clip = Timeline::new(Sampling::new(0..=4, 10.0, Thinning::Every(1)), pace, &moments);
        let shown: Vec<Moment> = (0..clip.count()).map(|frame| clip.moment(frame)).collect();
        let expected = [at(0, 0.0), at(1, 0.0), at(1, 0.04), at(2, 0.0), at(3, 0.0), at(4, 0.0)];
        assert_eq!(shown, expected, "the second moment between steps 1 and 2 is passed by");
        assert_eq!(delays(&clip), [10, 4, 56, 10, 60, 10]);
        assert_eq!((clip.stops(), clip.is_plain()), (2, false));
    }

    #[test]
    fn a_stop_just_behind_a_frame_lets_that_be_seen() {
        let pace = Pace { hold: 0.05, ..Pace::TRUE };
        let clip = Timeline::new(Sampling::new(0..=3, 50.0, Thinning::All), pace, &[at(1, 0.001), at(2, 0.0199)]);
        assert_eq!(delays(&clip), [2, 2, 5, 2, 5, 2]);
        assert_eq!(delays(&clip).iter().sum::<u64>(), 18);
    }

    #[test]
    fn a_clip_of_nothing_has_no_frames() {
        #[expect(clippy::reversed_empty_ranges)]
        let nothing = timeline(7..=3, 60.0, 1);
        assert_eq!((nothing.count(), nothing.is_plain()), (0, true));
    }
}
