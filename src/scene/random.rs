/// A pseudorandom number generator, `SplitMix64`, with the same output on every machine.
///
/// The state advances by the odd constant 0x9e3779b97f4a7c15; each output is the state mixed by
/// two shift-multiply rounds. From G. L. Steele, D. Lea and C. H. Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014, in S. Vigna's public-domain version.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// A generator with the initial state `seed`.
    pub fn new(seed: u64) -> Random {
        Random { state: seed }
    }

    /// Returns the next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns the next u with 0 ≤ u < 1: the upper 53 of the next 64 bits divided by 2⁵³, which is exact.
    pub fn fraction(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns the next number of a range, from + (to − from)·u, clamped to `to` because rounding may exceed it.
    ///
    /// A range of one number, which may be infinite, returns that number and also consumes one u.
    pub fn between(&mut self, [from, to]: [f64; 2]) -> f64 {
        let u = self.fraction();
        if from == to {
            return from;
        }
        let number = from + (to - from) * u;
        if number > to { to } else { number }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_output_is_the_published_test_vector() {
        let mut random = Random::new(1_234_567);
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!([random.bits(), random.bits(), random.bits()], expected);
    }

    #[test]
    fn fractions_are_below_one_and_ranges_are_kept() {
        let mut random = Random::new(7);
        for _ in 0..10_000 {
            let u = random.fraction();
            assert!((0.0..1.0).contains(&u));
            assert!((0.1..=0.3).contains(&random.between([0.1, 0.3])));
        }
        assert_eq!(random.between([f64::INFINITY; 2]), f64::INFINITY);
    }
}
