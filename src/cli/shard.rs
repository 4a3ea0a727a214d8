use std::ops::{Range, RangeInclusive};

/// One of several parts of some work. The parts are consecutive slices, so their outputs can be concatenated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// The number of this part, from 1.
    pub number: u64,
    /// The number of parts.
    pub count: u64,
}

impl Shard {
    /// The only part of one.
    pub const WHOLE: Shard = Shard { number: 1, count: 1 };

    /// The indices of this part among `length` items.
    pub fn range(self, length: usize) -> Range<usize> {
        let Range { start, end } = self.slice(length as u64);
        start as usize..end as usize
    }

    /// The steps of this part among the steps `from..=to`. `None` if this part is empty.
    pub fn steps(self, from: u64, to: u64) -> Option<RangeInclusive<u64>> {
        let Range { start, end } = self.slice((to + 1).saturating_sub(from));
        (start < end).then(|| from + start..=from + end - 1)
    }

    fn slice(self, length: u64) -> Range<u64> {
        let border = |number: u64| (u128::from(length) * u128::from(number) / u128::from(self.count)) as u64;
        border(self.number - 1)..border(self.number)
    }
}

/// Parses `2/4`.
impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let parts = text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((number, count)) if (1..=count).contains(&number) => Ok(Shard { number, count }),
            Some(_) | None => Err("expected I/N with I from 1 to N, for example 2/4".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ranges_of_all_shards_concatenate_to_the_whole() {
        for length in [0, 1, 5, 12] {
            for count in 1..=7 {
                let all: Vec<usize> = (1..=count).flat_map(|number| Shard { number, count }.range(length)).collect();
                assert_eq!(all, (0..length).collect::<Vec<usize>>(), "{length} in {count}");
            }
        }
    }

    #[test]
    fn the_steps_of_all_shards_concatenate_to_all_steps() {
        let all: Vec<u64> = (1..=4).filter_map(|number| Shard { number, count: 4 }.steps(3, 12)).flatten().collect();
        assert_eq!(all, (3..=12).collect::<Vec<u64>>());
        assert_eq!(Shard { number: 1, count: 4 }.steps(3, 3), None, "the last shard has the only step");
    }

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!("2/4".parse(), Ok(Shard { number: 2, count: 4 }));
        for wrong in ["0/4", "5/4", "1/0", "1", "a/b", "-1/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
