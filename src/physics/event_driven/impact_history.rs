//! Detects cycles in the impacts of an instant, from which the limit of an infinite sequence follows.

use super::double_double::DoubleDouble;
use crate::physics::{larger, smaller};

/// The longest period that is looked for every [`SEARCH_INTERVAL`] impacts.
const SHORT_PERIOD: usize = 200;

/// The impacts between two searches for a short period.
const SEARCH_INTERVAL: u64 = 16;

/// The impacts after which a long period is looked for first.
const FIRST_LONG_SEARCH: usize = 4 * SHORT_PERIOD;

/// The impacts that are remembered at most, which bounds the memory. A period is found while two of it are remembered,
/// so that none is longer than half of this.
const MAX_HITS: usize = 1 << 20;

/// Directions that agree to this fraction, or to the rounding of velocities, are the same: to so many bits they do not
/// agree by accident.
const SAME_DIRECTION: f64 = 1.0 / (1_u64 << 60) as f64;

/// A cycle is proven only from speeds above this multiple of the rounding of velocities, which gives their direction to
/// 30 bits.
const LEAST_PRECISION: f64 = (1_u64 << 30) as f64;

/// A cycle is proven only from speeds above this fraction of the greatest of the burst. So the same cycles are proven
/// in every frame of reference that moves less than 2¹⁸ times as fast as that. Some long cycles shrink to 2⁻⁴⁰ of it in
/// three periods.
const SLOWEST: f64 = 1.0 / (1_u64 << 44) as f64;

/// Approach speeds that agree to this fraction of the greatest are the same: 64 times the rounding of velocities.
const SAME_LENGTH: f64 = 1.0 / (1_u128 << 86) as f64;

/// The continuation that a repeated period of impacts proves.
#[derive(Clone, Debug, PartialEq)]
pub enum Cycle {
    /// The relative velocities tend to 0.
    Decays(Decay),
    /// All further periods are the same: the impacts never end.
    Persists,
}

/// A decaying cycle: each further period is a copy of the one before, scaled by a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Decay {
    /// Less than 1.
    factor: DoubleDouble,
    /// The touches hit in a period, in the order of the impacts.
    pub sequence: Vec<u32>,
    /// The least approach speed of the impacts of the last period, m/s.
    pub least_speed: f64,
}

impl Decay {
    /// The factor of the greatest number of periods whose factor is above `least`.
    pub fn factor_above(&self, least: f64) -> DoubleDouble {
        let stays_above = |factor: DoubleDouble| factor.high > least;
        // The factors of 1, 2, 4, … periods.
        let mut powers = Vec::new();
        let mut power = self.factor;
        while stays_above(power) {
            powers.push(power);
            power = power * power;
        }
        powers.into_iter().rev().fold(1.0.into(), |factor, power| {
            let longer = factor * power;
            if stays_above(longer) { longer } else { factor }
        })
    }
}

/// The impacts of an instant along one axis within one component.
#[derive(Clone, Debug)]
pub struct ImpactHistory {
    /// The recent impacts, the latest last.
    hits: Vec<Hit>,
    count: u64,
    probe: Option<Probe>,
    /// The number of recent impacts at which a period of any length is looked for.
    long_search: usize,
    /// Buffer for that search.
    repeated: Vec<u32>,
}

impl Default for ImpactHistory {
    fn default() -> ImpactHistory {
        let (hits, repeated) = (Vec::new(), Vec::new());
        ImpactHistory { hits, count: 0, probe: None, long_search: FIRST_LONG_SEARCH, repeated }
    }
}

/// An impact.
#[derive(Clone, Copy, Debug)]
struct Hit {
    touch: u32,
    /// The approach speed before, m/s.
    speed: f64,
}

/// The observation of a suspected cycle.
#[derive(Clone, Debug)]
struct Probe {
    period: usize,
    /// The touches hit in a period, sorted.
    touches: Vec<u32>,
    /// Impacts until the next record.
    remaining: usize,
    /// The approach speeds at the ends of the periods.
    records: Vec<Vec<DoubleDouble>>,
}

impl ImpactHistory {
    /// Removes all impacts, for the next instant.
    pub fn clear(&mut self) {
        if self.count > 0 {
            self.restart();
            self.count = 0;
        }
    }

    /// Begins a new sequence, after the limit of a cycle was taken.
    pub fn restart(&mut self) {
        self.hits.clear();
        self.probe = None;
        self.long_search = FIRST_LONG_SEARCH;
    }

    /// Records an impact and its approach speed; returns a cycle and its touches, sorted, if that completes the proof
    /// of one.
    ///
    /// `approach_speed` gives the present approach speed of a touch, `rounding` the rounding error of that speed, and
    /// `greatest` is the greatest approach speed of the burst, m/s.
    pub fn push(
        &mut self,
        touch: u32,
        speed: f64,
        greatest: f64,
        approach_speed: impl Fn(u32) -> DoubleDouble,
        rounding: impl Fn(u32) -> f64,
    ) -> Option<(Cycle, Vec<u32>)> {
        if self.hits.len() == MAX_HITS {
            self.hits.drain(..MAX_HITS / 2);
            self.long_search = MAX_HITS / 8 * 5;
        }
        self.hits.push(Hit { touch, speed });
        self.count += 1;
        self.continue_probe(&approach_speed);
        let observed = self.probe.as_ref().map_or(0, |probe| probe.period);
        let period = if self.hits.len() >= self.long_search && observed <= SHORT_PERIOD {
            // Searches after intervals that grow with the number of impacts take a constant time per impact.
            self.long_search = self.hits.len() / 4 * 5;
            self.find_long_period()
        } else if self.probe.is_none() && self.count.is_multiple_of(SEARCH_INTERVAL) {
            self.find_short_period()
        } else {
            None
        };
        if let Some(period) = period {
            self.start_probe(period, &approach_speed);
        }
        let probe = self.probe.take_if(|probe| probe.records.len() == 3)?;
        let rounding = probe.touches.iter().map(|touch| rounding(*touch)).fold(0.0, larger);
        let slowest = larger(greatest * SLOWEST, rounding * LEAST_PRECISION);
        let cycle = probe.verdict(slowest, rounding, &self.hits[self.hits.len() - probe.period..])?;
        Some((cycle, probe.touches))
    }

    fn continue_probe(&mut self, approach_speed: &impl Fn(u32) -> DoubleDouble) {
        let Some(probe) = &mut self.probe else { return };
        let last = self.hits.len() - 1;
        if last < probe.period || self.hits[last].touch != self.hits[last - probe.period].touch {
            self.probe = None;
            return;
        }
        probe.remaining -= 1;
        if probe.remaining == 0 {
            probe.remaining = probe.period;
            probe.records.push(probe.touches.iter().map(|touch| approach_speed(*touch)).collect());
        }
    }

    /// The shortest of the short periods whose last three repetitions hit the same touches.
    fn find_short_period(&self) -> Option<usize> {
        let length = self.hits.len();
        let longest = if length / 3 < SHORT_PERIOD { length / 3 } else { SHORT_PERIOD };
        let repeats = |period: usize| {
            (1..=2 * period).all(|back| self.hits[length - back].touch == self.hits[length - back - period].touch)
        };
        (2..=longest).find(|period| repeats(*period))
    }

    /// The period that most of the last impacts repeat, at least twice, if it is long.
    ///
    /// A long period can contain short sequences that are repeated for some time, but fewer impacts than the period
    /// itself.
    fn find_long_period(&mut self) -> Option<usize> {
        let length = self.hits.len();
        let touch = |back: usize| self.hits[length - 1 - back].touch;
        // For each period, the number of the last impacts that repeat those before them: the Z function of the reversed
        // sequence (Gusfield, "Algorithms on Strings, Trees and Sequences", 1997, section 1.4).
        self.repeated.clear();
        self.repeated.push(length as u32);
        let [mut start, mut end] = [0; 2];
        let [mut longest, mut best] = [0; 2];
        for period in 1..=length / 2 {
            let mut count = if period < end { (self.repeated[period - start] as usize).min(end - period) } else { 0 };
            while period + count < length && touch(count) == touch(period + count) {
                count += 1;
            }
            if period + count > end {
                [start, end] = [period, period + count];
            }
            if count >= period && count > longest {
                [longest, best] = [count, period];
            }
            self.repeated.push(count as u32);
        }
        (best > SHORT_PERIOD).then_some(best)
    }

    fn start_probe(&mut self, period: usize, approach_speed: &impl Fn(u32) -> DoubleDouble) {
        let mut touches: Vec<u32> = self.hits[self.hits.len() - period..].iter().map(|hit| hit.touch).collect();
        touches.sort_unstable();
        touches.dedup();
        let records = vec![touches.iter().map(|touch| approach_speed(*touch)).collect()];
        self.probe = Some(Probe { period, touches, remaining: period, records });
    }
}

impl Probe {
    /// The continuation that the records at the ends of three periods prove, if any, given the impacts of the last
    /// period. Speeds below `slowest` decide nothing, and differences of directions below `rounding` are 0.
    fn verdict(&self, slowest: f64, rounding: f64, period: &[Hit]) -> Option<Cycle> {
        let [first, second, third] = self.records.as_slice() else { return None };
        let mut greatest = 0;
        for index in 0..first.len() {
            if first[index].high.abs() > first[greatest].high.abs() {
                greatest = index;
            }
        }
        let scale = [first, second, third].map(|record| record[greatest].high.abs());
        if scale[2] <= slowest || scale[1] <= slowest {
            return None;
        }
        let is_same = |a: &[DoubleDouble], b: &[DoubleDouble]| {
            a.iter().zip(b).all(|(a, b)| (*a - *b).high.abs() <= scale[0] * SAME_LENGTH)
        };
        if is_same(first, second) && is_same(second, third) {
            return Some(Cycle::Persists);
        }
        let is_parallel = |a: &[DoubleDouble], b: &[DoubleDouble]| {
            let ratio = b[greatest] / a[greatest];
            let bound = larger(b[greatest].high.abs() * SAME_DIRECTION, rounding);
            ratio.high > 0.0 && a.iter().zip(b).all(|(a, b)| (*a * ratio - *b).high.abs() <= bound)
        };
        let shrinks = scale[0] > scale[1] && scale[1] > scale[2];
        let decays = shrinks && is_parallel(first, second) && is_parallel(second, third);
        decays.then(|| {
            Cycle::Decays(Decay {
                factor: third[greatest] / second[greatest],
                sequence: period.iter().map(|hit| hit.touch).collect(),
                least_speed: period.iter().map(|hit| hit.speed).fold(f64::INFINITY, smaller),
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pushes impacts that alternate between two touches, whose approach speeds, the second half the first, shrink by a
    /// factor per period and are known to a rounding.
    fn verdict(factor: f64, rounding: f64) -> Option<Cycle> {
        let mut history = ImpactHistory::default();
        let mut speed = 1.0;
        for impact in 0..100_u32 {
            if impact % 2 == 0 {
                speed *= factor;
            }
            let error = if impact % 3 == 0 { 0.25 * rounding } else { 0.0 };
            let approach_speed = |touch: u32| DoubleDouble::from(if touch == 0 { speed } else { error - 0.5 * speed });
            if let Some((cycle, touches)) =
                history.push(impact % 2, speed / f64::from(impact % 2 + 1), 1.0, approach_speed, |_| rounding)
            {
                assert_eq!(touches, [0, 1]);
                return Some(cycle);
            }
        }
        None
    }

    #[test]
    fn a_cycle_is_proven_after_three_equal_periods() {
        let Some(Cycle::Decays(decay)) = verdict(0.75, 0.0) else { panic!("no cycle") };
        assert_eq!((decay.factor, decay.sequence), (0.75.into(), vec![0, 1]));
        assert_eq!(verdict(1.0, 0.0), Some(Cycle::Persists));
        assert_eq!(verdict(1.5, 0.0), None);
    }

    #[test]
    fn a_cycle_of_any_length_is_proven_though_its_parts_repeat() {
        // Two touches in turn, and at the end of each period a third one.
        for period in [300_u32, 2000, 20_000] {
            let mut history = ImpactHistory::default();
            let (mut scale, mut count) = (1.0, 0);
            let cycle = loop {
                let place = count % period;
                let touch = if place + 1 == period { 2 } else { place % 2 };
                scale *= if place == 0 { 0.75 } else { 1.0 };
                // In another direction after each impact.
                let speed = |touch: u32| scale * f64::from(1 + place * (place + touch) % 7);
                let approach_speed = |touch: u32| DoubleDouble::from(speed(touch));
                if let Some(proven) = history.push(touch, speed(touch), 1.0, approach_speed, |_| 0.0) {
                    break proven;
                }
                count += 1;
                assert!(count < 8 * period, "no cycle of {period}");
            };
            let (Cycle::Decays(decay), touches) = cycle else { panic!("{cycle:?}") };
            assert_eq!((decay.sequence.len(), decay.factor, touches), (period as usize, 0.75.into(), vec![0, 1, 2]));
        }
    }

    #[test]
    fn directions_are_compared_to_the_rounding_of_velocities() {
        assert!(matches!(verdict(0.75, 1e-16), Some(Cycle::Decays(_))));
        assert_eq!(verdict(0.75, 1e-3), None);
    }

    #[test]
    fn periods_are_counted_up_to_the_last_above_the_least_factor() {
        for factor in [0.3, 0.75, 0.999, 1.0 - 1.0 / (1_u64 << 40) as f64] {
            let decay = Decay { factor: factor.into(), sequence: Vec::new(), least_speed: 1.0 };
            for least in [1e-24, 1e-3, 0.5, 0.999_999_999, 1.0, 3.0] {
                let found = decay.factor_above(least).high;
                assert!(found == 1.0 || found > least, "factor {factor}, at least {least:e}");
                assert!(found * factor <= least * (1.0 + 1e-12), "factor {factor}, at least {least:e}");
            }
        }
    }
}
