use super::apng::Delay;
use std::ops::RangeInclusive;

/// The most frames per second a GIF is given: browsers slow down delays under 2/100 s.
pub const FASTEST_GIF: f64 = 50.0;

/// The shortest time browsers show a GIF's frame for, 1/100 s.
const SHORTEST_DELAY: u64 = 2;

/// How many of the steps a clip shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thinning {
    /// Every step.
    All,
    /// Every that many steps; 0 counts as 1.
    Every(u64),
    /// As near as whole numbers of steps come to that many frames per second; finite, positive.
    FramesPerSecond(f64),
}

/// Which steps of a run become frames, and when each is on screen.
///
/// Frames lie on a grid anchored at step 0: the multiples of [`Sampling::every`] that are in
/// [`Sampling::steps`]. So a part of a clip has the very frames that the whole has.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampling {
    /// Steps from one frame to the next, at least 1.
    pub every: u64,
    /// The first and the last step that may be shown.
    pub steps: RangeInclusive<u64>,
    /// Steps per second, Hz.
    pub rate: f64,
}

impl Sampling {
    /// The sampling of `steps` at `rate` Hz, both ends included.
    pub fn new(steps: RangeInclusive<u64>, rate: f64, thinning: Thinning) -> Sampling {
        let every = match thinning {
            Thinning::All => 1,
            Thinning::Every(every) => every,
            Thinning::FramesPerSecond(fps) => (rate / fps).round() as u64,
        };
        Sampling { every: every.max(1), steps, rate }
    }

    /// The same, thinned further if need be to at most `fps` frames per second.
    pub fn no_faster_than(self, fps: f64) -> Sampling {
        let least = (self.rate / fps).ceil() as u64;
        Sampling { every: self.every.max(least), ..self }
    }

    /// The same, thinned further if need be to a grid on which every `recorded`-th step lies: for
    /// recordings that hold no other states. 0 counts as 1.
    pub fn among_every(self, recorded: u64) -> Sampling {
        let recorded = recorded.max(1);
        let common = (1..=recorded).find(|times| (self.every.saturating_mul(*times)).is_multiple_of(recorded));
        Sampling { every: self.every.saturating_mul(common.unwrap_or(recorded)), ..self }
    }

    /// Whether that step becomes a frame.
    pub fn shows(&self, step: u64) -> bool {
        self.steps.contains(&step) && step.is_multiple_of(self.every)
    }

    /// The number of frames.
    pub fn count(&self) -> u64 {
        if self.steps.is_empty() {
            return 0;
        }
        let first = self.steps.start().div_ceil(self.every);
        let last = self.steps.end() / self.every;
        (last + 1).saturating_sub(first)
    }

    /// How long the frame of that number, counted from 0, is on screen, 1/100 s.
    ///
    /// Frame i appears at its true time, rounded to 1/100 s, and stays until the next appears:
    /// no rounding is ever carried on. The delays add up to the true time from the first step
    /// to the last; since the last frame has to be seen before that, it and perhaps the one
    /// before it appear up to 2/100 s early. Only a clip at 50 frames/s has no room for that
    /// and is longer by one frame.
    pub fn delay(&self, frame: u64) -> u64 {
        self.appears(frame + 1) - self.appears(frame)
    }

    /// How long an animated PNG shows the frame of that number, counted from 0.
    ///
    /// Each frame is shown exactly as long as the steps it stands for, the last one too, since
    /// the format counts in parts of a second of one's choice; rates that are no whole number
    /// of Hz are told in 1/10000 s, with no rounding carried on.
    pub fn exact_delay(&self, frame: u64) -> Delay {
        if let (Some(parts), Some(per_second)) = (whole(self.every as f64), whole(self.rate)) {
            return Delay { parts, per_second };
        }
        const FINE: u16 = 10_000;
        let begins = |frame: u64| (f64::from(FINE) * (frame as f64 * self.every as f64) / self.rate).round() as u64;
        let parts = u16::try_from(begins(frame + 1) - begins(frame)).unwrap_or(u16::MAX);
        Delay { parts, per_second: FINE }
    }

    /// When a frame appears after the first one, 1/100 s; the one after the last at the end.
    fn appears(&self, frame: u64) -> u64 {
        let count = self.count();
        let (first, last) = (*self.steps.start(), *self.steps.end());
        let least = SHORTEST_DELAY * count;
        let total = self.hundredths(last - first).max(least);
        if frame == 0 {
            return 0;
        }
        let step = (first.div_ceil(self.every) + frame) * self.every;
        let latest = total - SHORTEST_DELAY * count.saturating_sub(frame);
        if frame < count { self.hundredths(step - first).min(latest) } else { total }
    }

    fn hundredths(&self, steps: u64) -> u64 {
        (100.0 * steps as f64 / self.rate).round() as u64
    }
}

fn whole(number: f64) -> Option<u16> {
    let rounded = number as u16;
    (f64::from(rounded) == number && rounded > 0).then_some(rounded)
}

impl std::fmt::Display for Sampling {
    /// What was sampled, for people: `every 2nd step, 30 frames/s`.
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self.every {
            1 => write!(out, "every step")?,
            every => write!(out, "every {every}{} step", ordinal_ending(every))?,
        }
        let frames = (self.rate / self.every as f64 * 100.0).round() / 100.0;
        write!(out, ", {frames} frames/s")
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

    fn steps(sampling: &Sampling) -> Vec<u64> {
        (0..=sampling.steps.end() + 5).filter(|&step| sampling.shows(step)).collect()
    }

    #[test]
    fn frames_lie_on_a_grid_from_step_0_with_both_ends_included() {
        let whole = Sampling::new(0..=12, 60.0, Thinning::Every(4));
        assert_eq!(steps(&whole), [0, 4, 8, 12]);
        let part = Sampling::new(4..=11, 60.0, Thinning::Every(4));
        assert_eq!(steps(&part), [4, 8]);
        let between = Sampling::new(5..=7, 60.0, Thinning::Every(4));
        assert_eq!(steps(&between), [0; 0]);
        for sampling in [whole, part, between] {
            assert_eq!(sampling.count(), steps(&sampling).len() as u64);
        }
    }

    #[test]
    #[expect(clippy::reversed_empty_ranges)]
    fn nothing_lies_between_a_last_step_and_a_first_after_it() {
        assert_eq!(Sampling::new(7..=3, 60.0, Thinning::All).count(), 0);
    }

    #[test]
    fn frames_per_second_become_the_nearest_whole_number_of_steps() {
        let every = |rate, fps| Sampling::new(0..=10, rate, Thinning::FramesPerSecond(fps)).every;
        assert_eq!([every(60.0, 30.0), every(60.0, 25.0), every(60.0, 24.0), every(60.0, 50.0)], [2, 2, 3, 1]);
        assert_eq!([every(60.0, 120.0), every(1000.0, 30.0), every(0.5, 30.0)], [1, 33, 1]);
    }

    #[test]
    fn a_gif_shows_at_most_50_frames_per_second() {
        let every = |rate| Sampling::new(0..=10, rate, Thinning::All).no_faster_than(FASTEST_GIF).every;
        assert_eq!([every(50.0), every(60.0), every(100.0), every(120.0), every(24.0)], [1, 2, 2, 3, 1]);
    }

    #[test]
    fn only_recorded_steps_become_frames() {
        let every = |every, recorded| Sampling::new(0..=90, 60.0, Thinning::Every(every)).among_every(recorded).every;
        assert_eq!(
            [every(2, 1), every(2, 10), every(4, 10), every(7, 3), every(10, 2), every(3, 0)],
            [2, 10, 20, 21, 10, 3]
        );
    }

    #[test]
    fn delays_add_up_to_the_duration_and_put_each_frame_at_its_instant() {
        for (rate, every) in [(60.0, 2), (30.0, 1), (120.0, 3), (1000.0, 33), (59.94, 2), (7.0, 1)] {
            for (from, to) in [(0, 600), (0, 601), (17, 480)] {
                let sampling = Sampling::new(from..=to, rate, Thinning::Every(every));
                let mut shown = 0;
                for (frame, step) in (0..).zip(steps(&sampling)) {
                    let exact = 100.0 * (step - from) as f64 / rate;
                    let early = if frame == 0 { exact } else { 2.0 };
                    assert!(shown as f64 - exact <= 0.5 && exact - shown as f64 <= early + 0.5, "step {step}");
                    assert!(sampling.delay(frame) >= SHORTEST_DELAY);
                    shown += sampling.delay(frame);
                }
                assert_eq!(shown, (100.0 * (to - from) as f64 / rate).round() as u64, "at {rate} Hz");
            }
        }
    }

    #[test]
    fn sixty_hertz_by_twos_alternates_between_3_and_4_hundredths() {
        let delays = |last| {
            let sampling = Sampling::new(0..=last, 60.0, Thinning::Every(2));
            (0..sampling.count()).map(|frame| sampling.delay(frame)).collect::<Vec<u64>>()
        };
        assert_eq!(delays(12), [3, 4, 3, 3, 3, 2, 2]);
        assert_eq!(delays(0), [2]);
        let fastest = Sampling::new(0..=3, 50.0, Thinning::All);
        assert_eq!((0..4).map(|frame| fastest.delay(frame)).collect::<Vec<u64>>(), [2, 2, 2, 2]);
    }

    #[test]
    fn an_animated_png_counts_in_steps() {
        let delay = |rate, every, frame| {
            let delay = Sampling::new(0..=600, rate, Thinning::Every(every)).exact_delay(frame);
            (delay.parts, delay.per_second)
        };
        assert_eq!([delay(60.0, 1, 0), delay(60.0, 2, 7), delay(1000.0, 33, 0)], [(1, 60), (2, 60), (33, 1000)]);
        assert_eq!([delay(59.94, 1, 0), delay(59.94, 1, 1)], [(167, 10_000), (167, 10_000)]);
        assert_eq!((0..5994).map(|frame| u64::from(delay(59.94, 1, frame).0)).sum::<u64>(), 1_000_000);
        assert_eq!(delay(0.01, 1, 0), (u16::MAX, 10_000));
    }

    #[test]
    fn says_what_was_sampled() {
        let say = |rate, every| Sampling::new(0..=1, rate, Thinning::Every(every)).to_string();
        assert_eq!(say(60.0, 1), "every step, 60 frames/s");
        assert_eq!(say(60.0, 2), "every 2nd step, 30 frames/s");
        assert_eq!(say(1000.0, 33), "every 33rd step, 30.3 frames/s");
        assert_eq!(say(100.0, 11), "every 11th step, 9.09 frames/s");
    }
}
