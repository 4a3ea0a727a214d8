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
    /// The colour of those components.
    pub const fn rgb(r: u8, g: u8, b: u8) -> Color {
        Color { r, g, b }
    }

    /// The colour 0xRRGGBB.
    pub const fn hex(value: u32) -> Color {
        Color::rgb((value >> 16) as u8, (value >> 8) as u8, value as u8)
    }

    /// The colour written as `#rrggbb`, letters of either case.
    pub fn parse(text: &str) -> Option<Color> {
        let digits = text.strip_prefix('#')?;
        if digits.len() != 6 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return None;
        }
        u32::from_str_radix(digits, 16).ok().map(Color::hex)
    }

    /// This colour with `part` hundredths of it replaced by `other`.
    pub const fn mix(self, other: Color, part: u8) -> Color {
        Color {
            r: mix_component(self.r, other.r, part),
            g: mix_component(self.g, other.g, part),
            b: mix_component(self.b, other.b, part),
        }
    }

    /// How bright it looks beside others, 0 to 255: the luma of ITU-R BT.601.
    pub const fn luma(self) -> u32 {
        (299 * self.r as u32 + 587 * self.g as u32 + 114 * self.b as u32) / 1000
    }
}

impl std::fmt::Display for Color {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(out, "#{:02x}{:02x}{:02x}", self.r, self.g, self.b)
    }
}

const fn mix_component(a: u8, b: u8, part: u8) -> u8 {
    let part = part as u32;
    ((a as u32 * (100 - part) + b as u32 * part + 50) / 100) as u8
}
