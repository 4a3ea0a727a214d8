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
    /// The colour with these components.
    pub const fn rgb(r: u8, g: u8, b: u8) -> Color {
        Color { r, g, b }
    }

    /// The colour 0xRRGGBB.
    pub const fn hex(value: u32) -> Color {
        Color::rgb((value >> 16) as u8, (value >> 8) as u8, value as u8)
    }

    /// Parses `#rrggbb`, with digits of either case.
    pub fn parse(text: &str) -> Option<Color> {
        let digits = text.strip_prefix('#')?;
        if digits.len() != 6 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return None;
        }
        u32::from_str_radix(digits, 16).ok().map(Color::hex)
    }

    /// Mixes this colour with `percent` % of `other`, in sRGB.
    pub const fn mix(self, other: Color, percent: u8) -> Color {
        Color {
            r: mix_component(self.r, other.r, percent),
            g: mix_component(self.g, other.g, percent),
            b: mix_component(self.b, other.b, percent),
        }
    }

    /// The luma of ITU-R BT.601, 0 to 255.
    pub const fn luma(self) -> u32 {
        (299 * self.r as u32 + 587 * self.g as u32 + 114 * self.b as u32) / 1000
    }
}

impl std::fmt::Display for Color {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(out, "#{:02x}{:02x}{:02x}", self.r, self.g, self.b)
    }
}

const fn mix_component(a: u8, b: u8, percent: u8) -> u8 {
    let percent = percent as u32;
    ((a as u32 * (100 - percent) + b as u32 * percent + 50) / 100) as u8
}
