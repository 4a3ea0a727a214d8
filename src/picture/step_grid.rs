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

#[cfg(test)]
mod tests {
    use super::*;

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
