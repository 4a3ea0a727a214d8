use crate::picture::{Appearance, Sprite, Style};
use crate::picture::{ColorBy, Theme};

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
            r: blend(self.r, other.r, percent as u32, 100),
            g: blend(self.g, other.g, percent as u32, 100),
            b: blend(self.b, other.b, percent as u32, 100),
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

/// Blends a colour component over another with an opacity of `part` / `whole`, rounded to nearest.
pub const fn blend(below: u8, over: u8, part: u32, whole: u32) -> u8 {
    ((below as u32 * (whole - part) + over as u32 * part + whole / 2) / whole) as u8
}

/// The colours of a theme, without those of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Background of the page.
    pub background: Color,
    /// Text and arrows.
    pub ink: Color,
    /// Secondary text.
    pub muted: Color,
    /// Grid lines.
    pub grid: Color,
    /// Walls.
    pub wall: Color,
    /// Hatching and edges of walls.
    pub wall_edge: Color,
    /// Mixed into the fill colour of a body for its border.
    pub border: Color,
    /// Normals of collisions.
    pub normal: Color,
    /// Penetration of collisions.
    pub penetration: Color,
    /// Impulses of collisions.
    pub impulse: Color,
    /// Forces.
    pub force: Color,
}

/// The palette of Okabe and Ito without its black, distinguishable with all common kinds of colour vision. A body's
/// number selects its colour; after four walls, the first box is blue.
pub const BODY_COLORS: [Color; 7] = [
    Color::hex(0x56b4e9),
    Color::hex(0xe69f00),
    Color::hex(0xcc79a7),
    Color::hex(0xf0e442),
    Color::hex(0x0072b2),
    Color::hex(0xd55e00),
    Color::hex(0x009e73),
];

/// The colour of bodies without a material.
const DEFAULT_COLOR: Color = Color::hex(0x999999);

/// The Viridis colour map at 16 equally spaced points, dark to bright: brightness alone shows the order.
pub const SPEED_COLORS: [Color; 16] = [
    Color::hex(0x440154),
    Color::hex(0x481a6c),
    Color::hex(0x472f7d),
    Color::hex(0x414487),
    Color::hex(0x39568c),
    Color::hex(0x31688e),
    Color::hex(0x2a788e),
    Color::hex(0x23888e),
    Color::hex(0x1f988b),
    Color::hex(0x22a884),
    Color::hex(0x35b779),
    Color::hex(0x54c568),
    Color::hex(0x7ad151),
    Color::hex(0xa5db36),
    Color::hex(0xd2e21b),
    Color::hex(0xfde725),
];

const LIGHT: Palette = Palette {
    background: Color::hex(0xffffff),
    ink: Color::hex(0x1f2328),
    muted: Color::hex(0x6a737d),
    grid: Color::hex(0xe4e7eb),
    wall: Color::hex(0xdfe2e6),
    wall_edge: Color::hex(0x6a737d),
    border: Color::hex(0x000000),
    normal: Color::hex(0x9b2f8f),
    penetration: Color::hex(0xc81e1e),
    impulse: Color::hex(0xb34700),
    force: Color::hex(0x006b4f),
};

const DARK: Palette = Palette {
    background: Color::hex(0x14181d),
    ink: Color::hex(0xe8eaed),
    muted: Color::hex(0x9aa3ad),
    grid: Color::hex(0x272d35),
    wall: Color::hex(0x2f363f),
    wall_edge: Color::hex(0x8b949e),
    border: Color::hex(0xffffff),
    normal: Color::hex(0xe59adb),
    penetration: Color::hex(0xff7b72),
    impulse: Color::hex(0xffa657),
    force: Color::hex(0x56d4a8),
};

impl Palette {
    /// The palette of a theme.
    pub const fn of(theme: Theme) -> Palette {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }

    /// The text colour, dark or white, that contrasts more with `fill`.
    pub fn text_on(&self, fill: Color) -> Color {
        if fill.luma() > 128 { Color::hex(0x1f2328) } else { Color::hex(0xffffff) }
    }
}

/// The fill colour of a body in `style`.
pub fn body_color(sprite: &Sprite, style: &Style) -> Color {
    let appearance = &sprite.appearance;
    match style.look.color_by {
        ColorBy::Body => color_by_body(appearance),
        ColorBy::Material => color_by_material(&appearance.material, style),
        // The speed of a static body never changes, so it is not coloured by speed.
        ColorBy::Speed if appearance.mass == f64::INFINITY => appearance.color.unwrap_or(DEFAULT_COLOR),
        ColorBy::Speed => color_by_speed(sprite.velocity.norm(), style.top_speed),
    }
}

/// The colour that identifies a body: the one its scene assigns, or else a palette colour by its number.
pub fn color_by_body(appearance: &Appearance) -> Color {
    appearance.color.unwrap_or_else(|| cycle_body_colors(u64::from(appearance.id)))
}

/// The colour of a material: a palette colour by its index in the style's list.
pub fn color_by_material(material: &str, style: &Style) -> Color {
    match style.materials.iter().position(|listed| listed == material) {
        Some(index) => cycle_body_colors(index as u64 + 4),
        None => DEFAULT_COLOR,
    }
}

/// Black or white, whichever contrasts more with `fill`, mixed with it.
pub const fn contrasting(fill: Color) -> Color {
    let line = if fill.luma() > 128 { Color::hex(0x000000) } else { Color::hex(0xffffff) };
    line.mix(fill, 25)
}

fn cycle_body_colors(index: u64) -> Color {
    BODY_COLORS[(index % BODY_COLORS.len() as u64) as usize]
}

/// The colour of a speed on a scale from 0 to `top`, both m/s.
pub fn color_by_speed(speed: f64, top: f64) -> Color {
    let index = (speed / top * SPEED_COLORS.len() as f64) as usize;
    SPEED_COLORS[if index < SPEED_COLORS.len() { index } else { SPEED_COLORS.len() - 1 }]
}
