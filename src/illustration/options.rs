//! Options as one line of text: `key=value key=value`, where a value is a word or a list of
//! strings as JSON has them.

/// Keys and values, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options(pub Vec<(String, String)>);

impl Options {
    /// Adds a value that is a word.
    pub fn word(&mut self, key: &str, value: impl std::fmt::Display) {
        self.0.push((key.to_owned(), value.to_string()));
    }

    /// Adds a list of texts.
    pub fn texts<'a>(&mut self, key: &str, texts: impl IntoIterator<Item = &'a String>) {
        let quoted: Vec<String> =
            texts.into_iter().map(|text| serde_json::Value::from(text.as_str()).to_string()).collect();
        self.word(key, quoted.join(","));
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// The texts of a key; none if it is not there.
    pub fn get_texts(&self, key: &str) -> Option<Vec<String>> {
        match self.get(key) {
            None => Some(Vec::new()),
            Some(value) => serde_json::from_str(&format!("[{value}]")).ok(),
        }
    }

    /// Reads what [`Options`] writes.
    pub fn parse(line: &str) -> Option<Options> {
        let mut options = Options::default();
        let mut rest = line;
        while !rest.is_empty() {
            let (key, tail) = rest.split_once('=')?;
            let end = word_end(tail);
            options.word(key, &tail[..end]);
            rest = tail[end..].strip_prefix(' ').unwrap_or("");
        }
        Some(options)
    }
}

/// Where the first blank is that is not between quotes.
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

impl std::fmt::Display for Options {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        for (place, (key, value)) in self.0.iter().enumerate() {
            let blank = if place == 0 { "" } else { " " };
            write!(out, "{blank}{key}={value}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let mut options = Options::default();
        options.word("size", "1280x720");
        let names = ["c".to_owned(), "a \"b\" \\ = ß\n".to_owned(), String::new()];
        options.texts("pair", &names);
        options.word("axis", "x");
        let line = options.to_string();
        assert_eq!(line, r#"size=1280x720 pair="c","a \"b\" \\ = ß\n","" axis=x"#);
        let read = Options::parse(&line).unwrap();
        assert_eq!(read, options);
        assert_eq!(read.get_texts("pair").unwrap(), names);
        assert_eq!(read.get_texts("none").unwrap(), Vec::<String>::new());
    }

    #[test]
    fn what_is_no_option_is_refused() {
        assert_eq!(Options::parse("size"), None);
        assert_eq!(Options::parse("pair=\"a").unwrap().get_texts("pair"), None);
    }
}
