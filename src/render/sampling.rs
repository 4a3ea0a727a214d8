use std::ops::RangeInclusive;

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
        Sampling { every: if every == 0 { 1 } else { every }, steps, rate }
    }

    /// The same, thinned further if need be so that no frame is shorter than `seconds`.
    pub fn no_faster_than(self, fps: f64) -> Sampling {
        let least = (self.rate / fps).ceil() as u64;
        Sampling { every: if self.every < least { least } else { self.every }, ..self }
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
