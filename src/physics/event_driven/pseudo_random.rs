/// Numbers for tests that look random and follow from a seed.
pub struct PseudoRandom(pub u32);

impl PseudoRandom {
    /// The next number in 0..1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0 >> 8) / f64::from(1_u32 << 24)
    }

    /// The next number between two.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// One of some values.
    pub fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[(self.next() * values.len() as f64) as usize]
    }
}
