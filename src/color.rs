use std::{
    fmt::{Display, Formatter, Result},
    str::FromStr,
};

/// An opaque colour in sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Color {
    /// Red.
    pub r: u8,
    /// Green.
    pub g: u8,
    /// Blue.
    pub b: u8,
}

impl Color {
    /// Returns the colour with these components.
    pub const fn rgb(r: u8, g: u8, b: u8) -> Color {
        Color { r, g, b }
    }

    /// Returns the colour 0xRRGGBB.
    pub const fn hex(value: u32) -> Color {
        Color::rgb((value >> 16) as u8, (value >> 8) as u8, value as u8)
    }
}

/// The text is not `#rrggbb`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotAColor;

impl FromStr for Color {
    type Err = NotAColor;

    /// Parses `#rrggbb`, with digits of either case.
    fn from_str(text: &str) -> std::result::Result<Color, NotAColor> {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6).ok_or(NotAColor)?;
        // `from_str_radix` accepts a sign, too.
        if !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
            return Err(NotAColor);
        }
        u32::from_str_radix(digits, 16).map(Color::hex).map_err(|_| NotAColor)
    }
}

impl Display for Color {
    /// Writes `#rrggbb` with lower-case digits.
    fn fmt(&self, out: &mut Formatter) -> Result {
        write!(out, "#{:02x}{:02x}{:02x}", self.r, self.g, self.b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parsing_accepts_six_hexadecimal_digits_of_either_case() {
        assert_eq!("#3366Cc".parse(), Ok(Color::rgb(0x33, 0x66, 0xcc)));
        assert_eq!(Color::rgb(0x03, 0x66, 0xcc).to_string(), "#0366cc");
        for text in ["", "#", "3366cc", "#3366c", "#3366cc0", "#+366cc", "#3366cg", "#3366é", "##366cc"] {
            assert_eq!(text.parse::<Color>(), Err(NotAColor), "{text}");
        }
    }
}
