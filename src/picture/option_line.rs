use crate::text::json_string;
use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// Options as one line of text: `key=value key=value`, where a value is a word or a comma-separated list of JSON
/// strings. Keys and values are in the order in which they are written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OptionLine(Vec<(String, String)>);

impl OptionLine {
    /// Adds a value that contains no blank.
    pub fn push(&mut self, key: &str, value: impl Display) {
        self.0.push((key.to_owned(), value.to_string()));
    }

    /// Adds keys with their values, which contain no blank outside quotes.
    pub fn extend(&mut self, options: Vec<(&str, String)>) {
        self.0.extend(options.into_iter().map(|(key, value)| (key.to_owned(), value)));
    }

    /// Adds a list of strings.
    pub fn push_strings<'a>(&mut self, key: &str, strings: impl IntoIterator<Item = &'a String>) {
        let quoted: Vec<String> = strings.into_iter().map(|text| json_string(text)).collect();
        self.push(key, quoted.join(","));
    }

    /// Returns the value of a key.
    pub fn get(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    /// Returns the parsed value of a key, or `default` if the key is absent. `None` if the value cannot be parsed.
    pub fn parsed_or<T: FromStr>(&self, key: &str, default: T) -> Option<T> {
        self.get(key).map_or(Some(default), |value| value.parse().ok())
    }

    /// Returns the strings of a key, an empty list if the key is absent, or `None` if the value is not
    /// a list of strings.
    pub fn get_strings(&self, key: &str) -> Option<Vec<String>> {
        match self.get(key) {
            None => Some(Vec::new()),
            Some(value) => serde_json::from_str(&format!("[{value}]")).ok(),
        }
    }

    /// Returns the keys and values.
    pub fn into_pairs(self) -> Vec<(String, String)> {
        self.0
    }

    /// Parses a line in the form written by `Display`. Returns `None` if a key has no value.
    pub fn parse(line: &str) -> Option<OptionLine> {
        let mut options = OptionLine::default();
        let mut rest = line;
        while !rest.is_empty() {
            let (key, tail) = rest.split_once('=')?;
            let end = word_end(tail);
            options.push(key, &tail[..end]);
            rest = tail[end..].strip_prefix(' ').unwrap_or("");
        }
        Some(options)
    }
}

/// The offset of the first blank outside quotes, or the length of the text.
fn word_end(text: &str) -> usize {
    let (mut quoted, mut escaped) = (false, false);
    for (at, character) in text.char_indices() {
        match character {
            ' ' if !quoted => return at,
            '"' if !escaped => quoted = !quoted,
            _ => {}
        }
        escaped = character == '\\' && !escaped;
    }
    text.len()
}

impl Display for OptionLine {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        for (index, (key, value)) in self.0.iter().enumerate() {
            let blank = if index == 0 { "" } else { " " };
            write!(out, "{blank}{key}={value}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_line_is_parsed_back() {
        let mut options = OptionLine::default();
        options.push("size", "1280x720");
        let names = ["c".to_owned(), "a \"b\" \\ = ß\n".to_owned(), String::new()];
        options.push_strings("pair", &names);
        options.push("axis", "x");
        let line = options.to_string();
        assert_eq!(line, r#"size=1280x720 pair="c","a \"b\" \\ = ß\n","" axis=x"#);
        let read = OptionLine::parse(&line).unwrap();
        assert_eq!(read, options);
        assert_eq!(read.get_strings("pair").unwrap(), names);
        assert_eq!(read.get_strings("none").unwrap(), Vec::<String>::new());
    }

    #[test]
    fn malformed_options_are_rejected() {
        assert_eq!(OptionLine::parse("size"), None);
        assert_eq!(OptionLine::parse("pair=\"a").unwrap().get_strings("pair"), None);
    }
}
