use std::ops::RangeInclusive;

/// The most frames per second a GIF is given: browsers slow down delays under 2/100 s.
pub const FASTEST_GIF: f64 = 50.0;

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
}
