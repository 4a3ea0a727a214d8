/// What a picture says of where it comes from: keys and values, in the order they are written.
///
/// Never a path, a date, or how the work was split, so that a picture made again is the same.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Keys are 1 to 79 printable ASCII characters; values are any text.
    pub entries: Vec<(String, String)>,
}

impl Metadata {
    /// Reads one `key: value` a line; other lines are passed over.
    pub fn parse(text: &str) -> Metadata {
        let entry = |line: &str| line.split_once(": ").map(|(key, value)| (key.to_owned(), value.to_owned()));
        Metadata { entries: text.lines().filter_map(entry).collect() }
    }
}

impl std::fmt::Display for Metadata {
    /// One `key: value` a line, which is how a GIF comment holds it.
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        self.entries.iter().try_for_each(|(key, value)| writeln!(out, "{key}: {value}"))
    }
}
