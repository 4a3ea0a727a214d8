/// The metadata of a picture file: keys and values in the order in which they are written.
///
/// They contain no path, no date and nothing about threads or shards, so that a picture drawn again has
/// the same bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Keys are 1 to 79 printable ASCII characters; values are any text.
    pub entries: Vec<(String, String)>,
}

impl Metadata {
    /// Parses text with one `key: value` per line; other lines are ignored.
    pub fn parse(text: &str) -> Metadata {
        let entry = |line: &str| line.split_once(": ").map(|(key, value)| (key.to_owned(), value.to_owned()));
        Metadata { entries: text.lines().filter_map(entry).collect() }
    }
}

impl std::fmt::Display for Metadata {
    /// One `key: value` per line, the form of GIF comments and SVG metadata.
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        self.entries.iter().try_for_each(|(key, value)| writeln!(out, "{key}: {value}"))
    }
}
