/// What a picture says of where it comes from: keys and values, in the order they are written.
///
/// Never a path, a date, or how the work was split, so that a picture made again is the same.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Keys are 1 to 79 printable ASCII characters; values are any text.
    pub entries: Vec<(String, String)>,
}

impl std::fmt::Display for Metadata {
    /// One `key: value` a line, which is how a GIF comment holds it.
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        self.entries.iter().try_for_each(|(key, value)| writeln!(out, "{key}: {value}"))
    }
}
