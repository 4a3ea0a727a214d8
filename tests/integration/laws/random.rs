//! Random numbers of the scenes of the laws.

/// A linear congruential generator (Knuth's MMIX constants).
pub struct Random(u64);

impl Random {
    /// Generators of different seeds differ from the first number on.
    pub fn new(seed: u64) -> Random {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678);
        (0..8).for_each(|_| _ = random.below(2));
        random
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % bound
    }

    /// A whole number, both ends included.
    pub fn whole(&mut self, first: i64, last: i64) -> i64 {
        first + self.below((last - first + 1) as u64) as i64
    }

    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }

    /// True in `percent` of 100 cases.
    pub fn chance(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }

    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * (self.below(1 << 30) as f64 / f64::from(1 << 30))
    }

    /// A number from `least` on that is doubled up to `doublings` times, and less than once more.
    pub fn magnitude(&mut self, least: f64, doublings: u64) -> f64 {
        (0..self.below(doublings + 1)).fold(least, |value, _| 2.0 * value) * self.between(1.0, 2.0)
    }

    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last as u64 + 1) as usize);
        }
    }
}

pub const COEFFICIENTS: [f64; 8] = [0.0, 0.2, 0.5, 0.9, 0.95, 0.99, 0.999, 1.0];
