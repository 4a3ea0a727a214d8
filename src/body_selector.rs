//! A choice of bodies by name.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A choice of bodies by their names; the default is all bodies.
///
/// Its text form is a list of names and of ranges of numbered names, such as `a,b,#1..#9`. A name with a comma is in
/// double quotes: `"e, 4 kg",b`.
///
/// ```
/// use rebond::BodySelector;
///
/// let selector: BodySelector = "a,#2..#4".parse()?;
/// assert!(selector.contains("a") && selector.contains("#3"));
/// assert!(!selector.contains("#5"));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct BodySelector(Vec<Item>);

/// The largest number of names and ranges in a list: each body is compared with all of them.
const MAX_ITEMS: usize = 1000;

/// One body, or several with numbered names.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Item {
    Name(String),
    /// The prefix of the names, and the first and the last number.
    Numbered(String, u64, u64),
}

impl BodySelector {
    /// Returns true if it selects all bodies.
    pub fn is_all(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns true if it selects a body of this name.
    pub fn contains(&self, name: &str) -> bool {
        self.is_all() || self.0.iter().any(|item| item.contains(name))
    }

    /// The first part of the list that selects none of these names.
    pub fn first_unmatched(&self, names: &[String]) -> Option<String> {
        self.0.iter().find(|item| !names.iter().any(|name| item.contains(name))).map(Item::to_string)
    }
}

impl Item {
    fn contains(&self, name: &str) -> bool {
        match self {
            Item::Name(own) => own == name,
            Item::Numbered(prefix, from, to) => {
                let number = name.strip_prefix(prefix.as_str()).and_then(number);
                number.is_some_and(|number| (*from..=*to).contains(&number))
            }
        }
    }
}

/// A number as names have it: digits without leading zeros.
fn number(text: &str) -> Option<u64> {
    text.parse().ok().filter(|number: &u64| number.to_string() == text)
}

impl fmt::Display for Item {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Item::Name(name) if name.contains([',', '"']) || name.parse() != Ok(self.clone()) => {
                write!(out, "\"{}\"", name.replace('"', "\"\""))
            }
            Item::Name(name) => out.write_str(name),
            Item::Numbered(prefix, from, to) => write!(out, "{prefix}{from}..{prefix}{to}"),
        }
    }
}

impl FromStr for Item {
    type Err = String;

    fn from_str(text: &str) -> Result<Item, String> {
        if let Some(quoted) = text.strip_prefix('"') {
            let name = quoted.strip_suffix('"').map(|name| name.replace("\"\"", "\""));
            return name.map(Item::Name).ok_or_else(|| format!("the quotation mark of {text} is not closed"));
        }
        if text.is_empty() {
            return Err("expected names of bodies and ranges, for example a,b,#1..#9".into());
        }
        let range = text.split_once("..").and_then(|(first, last)| {
            let prefix = first.trim_end_matches(|character: char| character.is_ascii_digit());
            let from = number(&first[prefix.len()..])?;
            Some((prefix, from, number(last.strip_prefix(prefix).unwrap_or(last))?))
        });
        match range {
            Some((_, from, to)) if to < from => {
                Err(format!("the range {text} is empty: its numbers must not decrease"))
            }
            Some((prefix, from, to)) => Ok(Item::Numbered(prefix.to_owned(), from, to)),
            None => Ok(Item::Name(text.to_owned())),
        }
    }
}

impl fmt::Display for BodySelector {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        for (at, item) in self.0.iter().enumerate() {
            write!(out, "{}{item}", if at > 0 { "," } else { "" })?;
        }
        Ok(())
    }
}

impl FromStr for BodySelector {
    type Err = String;

    fn from_str(text: &str) -> Result<BodySelector, String> {
        let mut is_quoted = false;
        let parts = text.split(|character| {
            is_quoted ^= character == '"';
            character == ',' && !is_quoted
        });
        let items: Vec<Item> = parts.map(str::parse).collect::<Result<_, String>>()?;
        if items.len() <= MAX_ITEMS {
            Ok(BodySelector(items))
        } else {
            Err(format!("{} names and ranges are too many; at most {MAX_ITEMS} are allowed", items.len()))
        }
    }
}

impl From<BodySelector> for String {
    fn from(selector: BodySelector) -> String {
        selector.to_string()
    }
}

impl TryFrom<String> for BodySelector {
    type Error = String;

    fn try_from(text: String) -> Result<BodySelector, String> {
        if text.is_empty() { Ok(BodySelector::default()) } else { text.parse() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_selector_contains_its_names_and_the_numbers_of_its_ranges() {
        let selector: BodySelector = "a,ball 2..ball 11,#3..4".parse().unwrap();
        for name in ["a", "ball 2", "ball 9", "ball 11", "#3", "#4"] {
            assert!(selector.contains(name), "{name}");
        }
        for name in ["b", "ball 1", "ball 12", "ball 02", "ball ", "#2", "#5", "", "a,"] {
            assert!(!selector.contains(name), "{name}");
        }
        assert!(BodySelector::default().contains("anything"));
    }

    #[test]
    fn a_selector_is_read_back_from_its_text() {
        let commas: BodySelector = "\"e, 4 kg\",b,\"1..2\",\"5\"\" box\"".parse().unwrap();
        assert!(["e, 4 kg", "b", "1..2", "5\" box"].iter().all(|name| commas.contains(name)));
        assert!(!commas.contains("1") && !commas.contains("e"));
        assert_eq!(commas.to_string().parse(), Ok(commas));
        for text in ["a", "a,b", "#1..#9", "a..b", "box 1..box 3,c", "1..12"] {
            assert_eq!(text.parse::<BodySelector>().unwrap().to_string(), text);
        }
        for wrong in ["", "a,", ",", "#9..#1", "\"a", "\"a,b"] {
            assert!(wrong.parse::<BodySelector>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_first_part_without_a_body_is_named() {
        let names = ["a", "#1"].map(String::from);
        let unmatched = |text: &str| text.parse::<BodySelector>().unwrap().first_unmatched(&names);
        assert_eq!(unmatched("a,#1..#5"), None);
        assert_eq!(unmatched("a,#2..#5,b"), Some("#2..#5".into()));
    }
}
