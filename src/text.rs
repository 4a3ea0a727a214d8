//! Text of messages and tables: numbers with their nouns, and CSV fields.

#[cfg(feature = "report")]
use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};

/// A number with its noun, which takes the plural unless the number is 1.
pub(crate) struct Counted<N> {
    number: N,
    noun: &'static str,
}

/// Formats `number` with `noun` in the right form: `counted(1, "body")` is "1 body",
/// `counted(2, "body")` is "2 bodies". `noun` is an English singular with a regular plural.
pub(crate) fn counted<N>(number: N, noun: &'static str) -> Counted<N> {
    Counted { number, noun }
}

impl<N: Display + PartialEq + From<u8>> Display for Counted<N> {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let Counted { number, noun } = self;
        if *number == N::from(1) {
            return write!(out, "{number} {noun}");
        }
        match noun.strip_suffix('y') {
            Some(stem) if !stem.ends_with(['a', 'e', 'o', 'u']) => write!(out, "{number} {stem}ies"),
            _ if noun.ends_with(['s', 'x', 'z']) || noun.ends_with("ch") => write!(out, "{number} {noun}es"),
            _ => write!(out, "{number} {noun}s"),
        }
    }
}

/// A CSV field, quoted as in RFC 4180 if necessary.
#[cfg(feature = "report")]
pub(crate) fn csv_field(text: &str) -> Cow<'_, str> {
    if text.contains(['"', ',', '\n', '\r']) {
        return format!("\"{}\"", text.replace('"', "\"\"")).into();
    }
    text.into()
}

/// Text escaped for XML and HTML, in content and in attributes. Characters that XML does not allow are omitted.
#[cfg(feature = "draw")]
pub(crate) struct Escaped<'a>(pub &'a str);

#[cfg(feature = "draw")]
impl Display for Escaped<'_> {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        for character in self.0.chars() {
            match character {
                '&' => out.write_str("&amp;")?,
                '<' => out.write_str("&lt;")?,
                '>' => out.write_str("&gt;")?,
                '"' => out.write_str("&quot;")?,
                '\n' | '\t' | ' '.. => write!(out, "{character}")?,
                _ => {}
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nouns_take_the_form_of_their_number() {
        assert_eq!(counted(1_u64, "collision").to_string(), "1 collision");
        assert_eq!(counted(0_u64, "collision").to_string(), "0 collisions");
        assert_eq!(counted(2_usize, "body").to_string(), "2 bodies");
        assert_eq!(counted(3_u32, "key").to_string(), "3 keys");
        assert_eq!(counted(1.5, "box").to_string(), "1.5 boxes");
    }

    #[test]
    #[cfg(feature = "report")]
    fn fields_with_commas_or_quotes_are_quoted() {
        assert_eq!(csv_field("#1"), "#1");
        assert_eq!(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
