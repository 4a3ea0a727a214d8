//! Parsers for the values of flags other than plain numbers and paths.

use crate::picture::MIN_HOLD;

/// The longest pause, s. A longer one would look like the end of the animation.
const MAX_HOLD: f64 = 60.0;

/// A word of `0.5 at collisions`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldWord {
    /// The duration, s.
    Seconds(f64),
    /// The word `at`.
    At,
    /// The word `collisions`.
    Collisions,
}

impl std::str::FromStr for HoldWord {
    type Err = String;

    fn from_str(text: &str) -> Result<HoldWord, String> {
        match text {
            "at" => Ok(HoldWord::At),
            "collisions" => Ok(HoldWord::Collisions),
            text => match text.parse() {
                Ok(seconds) if (MIN_HOLD..=MAX_HOLD).contains(&seconds) => Ok(HoldWord::Seconds(seconds)),
                Ok(_) | Err(_) => Err("expected 0.05 to 60 seconds, for example 0.5 at collisions".into()),
            },
        }
    }
}

/// Parses the names of two bodies: `c,b`.
pub fn pair(text: &str) -> Result<[String; 2], String> {
    let names = text.split_once(',').filter(|(a, b)| !a.is_empty() && !b.is_empty() && !b.contains(','));
    names.map(|(a, b)| [a.to_owned(), b.to_owned()]).ok_or_else(|| "expected two names, for example c,b".into())
}

/// Parses a number greater than 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a positive number".into())
}
