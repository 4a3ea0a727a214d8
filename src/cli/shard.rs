use std::ops::Range;

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
        let border = |number: u64| (count as u128 * u128::from(number) / u128::from(self.of)) as usize;
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
    fn shards_are_counted_from_one() {
        assert_eq!("2/4".parse(), Ok(Shard { number: 2, of: 4 }));
        for wrong in ["0/4", "5/4", "1/0", "1", "a/b", "-1/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
