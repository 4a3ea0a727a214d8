use std::ops::{Range, RangeInclusive};

/// One of several parts of some work, which joined in order are all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which, from 1.
    pub number: u64,
    /// Of how many.
    pub of: u64,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Shard = Shard { number: 1, of: 1 };

    /// Which of `count` things are its own: neighbours, so that parts join by being put in a row.
    pub fn range(self, count: usize) -> Range<usize> {
        let Range { start, end } = self.part(count as u64);
        start as usize..end as usize
    }

    /// Its own of the steps from one to another, both included; none if there are too few for all.
    pub fn steps(self, from: u64, to: u64) -> Option<RangeInclusive<u64>> {
        let Range { start, end } = self.part((to + 1).saturating_sub(from));
        (start < end).then(|| from + start..=from + end - 1)
    }

    fn part(self, count: u64) -> Range<u64> {
        let border = |number: u64| (u128::from(count) * u128::from(number) / u128::from(self.of)) as u64;
        border(self.number - 1)..border(self.number)
    }
}

/// Reads `2/4`.
impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let parts = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Shard { number, of }),
            Some(_) | None => Err("expected I/N with I from 1 to N, such as 2/4".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_in_a_row_are_the_whole() {
        for count in [0, 1, 5, 12] {
            for of in 1..=7 {
                let all: Vec<usize> = (1..=of).flat_map(|number| Shard { number, of }.range(count)).collect();
                assert_eq!(all, (0..count).collect::<Vec<usize>>(), "{count} in {of}");
            }
        }
    }

    #[test]
    fn steps_in_a_row_are_all_steps() {
        let all: Vec<u64> = (1..=4).filter_map(|number| Shard { number, of: 4 }.steps(3, 12)).flatten().collect();
        assert_eq!(all, (3..=12).collect::<Vec<u64>>());
        assert_eq!(Shard { number: 1, of: 4 }.steps(3, 3), None, "the last has the only step");
    }

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!("2/4".parse(), Ok(Shard { number: 2, of: 4 }));
        for wrong in ["0/4", "5/4", "1/0", "1", "a/b", "-1/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
