use super::{Appearance, Color, Sprite, Style};
use crate::scene::{ColorBy, Theme};

/// The colours of a theme; bodies have their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// The page.
    pub background: Color,
    /// Text, arrows.
    pub ink: Color,
    /// Text that stands back.
    pub muted: Color,
    /// Grid lines.
    pub grid: Color,
    /// Walls.
    pub wall: Color,
    /// The hatching of walls, and their edge.
    pub wall_edge: Color,
    /// What a body's border is mixed with.
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

/// Okabe and Ito's colours, told apart by all common kinds of colour vision; their black is
/// left to text. With four walls the first box is blue.
pub const BODIES: [Color; 7] = [
    Color::hex(0x56b4e9),
    Color::hex(0xe69f00),
    Color::hex(0xcc79a7),
    Color::hex(0xf0e442),
    Color::hex(0x0072b2),
    Color::hex(0xd55e00),
    Color::hex(0x009e73),
];

/// What has no material has no colour either.
const PLAIN: Color = Color::hex(0x999999);

/// Viridis at 16 even places, dark to bright: brightness alone tells the order.
pub const SPEEDS: [Color; 16] = [
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
    /// The colours of that theme.
    pub const fn of(theme: Theme) -> Palette {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }

    /// The colour that reads better on `fill`.
    pub fn text_on(&self, fill: Color) -> Color {
        if fill.luma() > 128 { Color::hex(0x1f2328) } else { Color::hex(0xffffff) }
    }
}

/// The colour of a box.
pub fn body_color(sprite: &Sprite, style: &Style) -> Color {
    let appearance = &sprite.appearance;
    match style.color_by {
        ColorBy::Body => box_color(appearance),
        ColorBy::Material => material_color(&appearance.material, style),
        // What is never pushed keeps its speed for life: a colour for that would tell nothing.
        ColorBy::Speed if appearance.mass == f64::INFINITY => appearance.color.unwrap_or(PLAIN),
        ColorBy::Speed => speed_color(sprite.velocity.norm(), style.top_speed),
    }
}

/// The colour of a box that tells it from others: its scene's, or one of its own.
pub fn box_color(appearance: &Appearance) -> Color {
    appearance.color.unwrap_or_else(|| cycled(u64::from(appearance.id)))
}

/// The colour of a material; materials go round the palette in the order the style lists them.
pub fn material_color(material: &str, style: &Style) -> Color {
    match style.materials.iter().position(|known| known == material) {
        Some(place) => cycled(place as u64 + 4),
        None => PLAIN,
    }
}

fn cycled(number: u64) -> Color {
    BODIES[(number % BODIES.len() as u64) as usize]
}

/// The colour of a speed on a scale that ends at `top`, both m/s.
pub fn speed_color(speed: f64, top: f64) -> Color {
    let place = (speed / top * SPEEDS.len() as f64) as usize;
    SPEEDS[if place < SPEEDS.len() { place } else { SPEEDS.len() - 1 }]
}
