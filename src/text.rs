//! Text of messages and tables: numbers with their nouns, and CSV fields.

#[cfg(any(feature = "draw", feature = "report"))]
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

/// The steps from 0 to the last one: "the steps 0 to 5", or "only the step 0".
pub(crate) fn steps_up_to(last: u64) -> String {
    match last {
        0 => "only the step 0".into(),
        last => format!("the steps 0 to {last}"),
    }
}

/// A CSV field, quoted as in RFC 4180 if necessary. The crate csv, which reads tables, is a dependency of the command
/// alone; tables are also written by the library and by the live page.
#[cfg(any(feature = "draw", feature = "report"))]
pub(crate) fn csv_field(text: &str) -> Cow<'_, str> {
    if text.contains(['"', ',', '\n', '\r']) {
        return format!("\"{}\"", text.replace('"', "\"\"")).into();
    }
    text.into()
}

/// Text for a terminal. Control characters, which could control the terminal or hide parts of the text, are written as
/// `\u001b`, as in JSON; line breaks and tabs stay.
#[cfg(feature = "cli")]
pub(crate) struct Printable<'a>(pub &'a str);

#[cfg(feature = "cli")]
impl Display for Printable<'_> {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        for part in self.0.split_inclusive(is_unprintable) {
            match part.chars().next_back().filter(|&last| is_unprintable(last)) {
                Some(last) => write!(out, "{}\\u{:04x}", &part[..part.len() - last.len_utf8()], u32::from(last))?,
                None => out.write_str(part)?,
            }
        }
        Ok(())
    }
}

/// Returns true for control characters and for those that change the direction of the text.
#[cfg(feature = "cli")]
pub(crate) fn is_unprintable(character: char) -> bool {
    let reorders = matches!(character, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    reorders || (character.is_control() && !matches!(character, '\n' | '\t'))
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
                '\u{fffe}' | '\u{ffff}' => {}
                '\n' | '\t' | ' '.. => write!(out, "{character}")?,
                _ => {}
            }
        }
        Ok(())
    }
}

/// A JSON string. The two characters that JSON allows but XML does not are written as `\ufffe` and `\uffff`, so that
/// [`Escaped`] omits nothing of it.
#[cfg(feature = "draw")]
pub(crate) fn json_string(text: &str) -> String {
    serde_json::Value::from(text).to_string().replace('\u{fffe}', "\\ufffe").replace('\u{ffff}', "\\uffff")
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
    #[cfg(feature = "cli")]
    fn printable_text_has_no_control_characters_but_line_breaks_and_tabs() {
        let text = "a\u{1b}[31mb\tc\nd\u{9b}e\u{7f}\u{202e}\r";
        assert_eq!(Printable(text).to_string(), "a\\u001b[31mb\tc\nd\\u009be\\u007f\\u202e\\u000d");
        assert_eq!(Printable("Größe ✓").to_string(), "Größe ✓");
    }

    /// The production `Char` of XML 1.0, without the carriage return, which parsers replace.
    #[test]
    #[cfg(feature = "draw")]
    fn escaped_text_has_exactly_the_characters_that_xml_allows() {
        let ranges = [' '..='\u{d7ff}', '\u{e000}'..='\u{fffd}', '\u{10000}'..=char::MAX];
        let is_allowed = |at: char| matches!(at, '\t' | '\n') || ranges.iter().any(|range| range.contains(&at));
        for character in '\0'..=char::MAX {
            let escaped = Escaped(character.encode_utf8(&mut [0; 4])).to_string();
            assert_eq!(!escaped.is_empty(), is_allowed(character), "{character:?}");
        }
        assert_eq!(Escaped("<\"&\u{1}\u{fffe}\">").to_string(), "&lt;&quot;&amp;&quot;&gt;");
    }

    #[test]
    #[cfg(feature = "draw")]
    fn json_strings_survive_in_xml() {
        let text = "a\"\\ \u{1}\u{fffe}\u{ffff}\u{7f}é😀\r";
        let json = json_string(text);
        assert_eq!(Escaped(&json).to_string(), json.replace('"', "&quot;"));
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), text);
    }

    #[test]
    #[cfg(feature = "report")]
    fn fields_with_commas_or_quotes_are_quoted() {
        assert_eq!(csv_field("#1"), "#1");
        assert_eq!(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
