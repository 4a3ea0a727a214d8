use crate::picture::{Appearance, Sprite, Style};
use crate::picture::{ColorBy, Theme};

pub use crate::color::Color;

impl Color {
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

    /// The relative luminance as WCAG 2 defines it, 0 to 1.
    pub fn luminance(self) -> f64 {
        let linear = |component: u8| f64::from(LINEAR[usize::from(component)]) / 65_535.0;
        0.2126 * linear(self.r) + 0.7152 * linear(self.g) + 0.0722 * linear(self.b)
    }

    /// The contrast ratio of two colours as WCAG 2 defines it, 1 to 21.
    pub fn contrast(self, other: Color) -> f64 {
        let (a, b) = (self.luminance() + 0.05, other.luminance() + 0.05);
        if a > b { a / b } else { b / a }
    }
}

/// The linear intensity of each sRGB component, 0 to 65535. A table, because powers differ between platforms.
#[rustfmt::skip]
const LINEAR: [u16; 256] = [
    0, 20, 40, 60, 80, 99, 119, 139, 159, 179, 199, 219, 241, 264, 288, 313,
    340, 367, 396, 427, 458, 491, 526, 562, 599, 637, 677, 718, 761, 805, 851, 898,
    947, 997, 1048, 1101, 1156, 1212, 1270, 1330, 1391, 1453, 1517, 1583, 1651, 1720, 1790, 1863,
    1937, 2013, 2090, 2170, 2250, 2333, 2418, 2504, 2592, 2681, 2773, 2866, 2961, 3058, 3157, 3258,
    3360, 3464, 3570, 3678, 3788, 3900, 4014, 4129, 4247, 4366, 4488, 4611, 4736, 4864, 4993, 5124,
    5257, 5392, 5530, 5669, 5810, 5953, 6099, 6246, 6395, 6547, 6700, 6856, 7014, 7174, 7335, 7500,
    7666, 7834, 8004, 8177, 8352, 8528, 8708, 8889, 9072, 9258, 9445, 9635, 9828, 10022, 10219, 10417,
    10619, 10822, 11028, 11235, 11446, 11658, 11873, 12090, 12309, 12530, 12754, 12980, 13209, 13440, 13673, 13909,
    14146, 14387, 14629, 14874, 15122, 15371, 15623, 15878, 16135, 16394, 16656, 16920, 17187, 17456, 17727, 18001,
    18277, 18556, 18837, 19121, 19407, 19696, 19987, 20281, 20577, 20876, 21177, 21481, 21787, 22096, 22407, 22721,
    23038, 23357, 23678, 24002, 24329, 24658, 24990, 25325, 25662, 26001, 26344, 26688, 27036, 27386, 27739, 28094,
    28452, 28813, 29176, 29542, 29911, 30282, 30656, 31033, 31412, 31794, 32179, 32567, 32957, 33350, 33745, 34143,
    34544, 34948, 35355, 35764, 36176, 36591, 37008, 37429, 37852, 38278, 38706, 39138, 39572, 40009, 40449, 40891,
    41337, 41785, 42236, 42690, 43147, 43606, 44069, 44534, 45002, 45473, 45947, 46423, 46903, 47385, 47871, 48359,
    48850, 49344, 49841, 50341, 50844, 51349, 51858, 52369, 52884, 53401, 53921, 54445, 54971, 55500, 56032, 56567,
    57105, 57646, 58190, 58737, 59287, 59840, 60396, 60955, 61517, 62082, 62650, 63221, 63795, 64372, 64952, 65535,
];

/// The contrast of text with its background that WCAG 2 demands (level AA).
pub const TEXT_CONTRAST: f64 = 4.5;

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
    /// Momenta.
    pub momentum: Color,
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

/// The colours of curves, the most distinct ones first, on light and dark backgrounds.
pub const CURVE_COLORS: [Color; 7] = {
    let [sky, orange, pink, yellow, blue, vermilion, green] = BODY_COLORS;
    [blue, vermilion, green, orange, pink, sky, yellow]
};

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
    impulse: Color::hex(0x0050c8),
    force: Color::hex(0x006b4f),
    momentum: Color::hex(0x5c10e8),
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
    impulse: Color::hex(0x58a6ff),
    force: Color::hex(0x56d4a8),
    momentum: Color::hex(0xffd84d),
};

impl Palette {
    /// The palette of a theme.
    pub const fn of(theme: Theme) -> Palette {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }

    /// A text colour of sufficient contrast with `fill`: dark grey, else white, else black. One of white and black
    /// always suffices, because their contrasts with a colour multiply to 21.
    pub fn text_on(&self, fill: Color) -> Color {
        let candidates = [Color::hex(0x1f2328), Color::hex(0xffffff)];
        let sufficient = candidates.into_iter().find(|text| text.contrast(fill) >= TEXT_CONTRAST);
        sufficient.unwrap_or(Color::hex(0x000000))
    }

    /// A colour for text on all of these colours: the given one, mixed with the ink, white or black until its contrast
    /// with each suffices. `None` if no such colour is found.
    pub fn legible(&self, color: Color, grounds: &[Color]) -> Option<Color> {
        let inks = [self.ink, Color::hex(0xffffff), Color::hex(0x000000)];
        let mixed = inks.into_iter().flat_map(|ink| (0..=100).step_by(10).map(move |percent| color.mix(ink, percent)));
        let suffices = |text: &Color| grounds.iter().all(|ground| text.contrast(*ground) >= TEXT_CONTRAST);
        mixed.into_iter().find(suffices)
    }

    /// The colour of a line of this colour: mixed with the ink until it has a contrast of 3 with the page, which WCAG 2
    /// demands of graphics.
    pub fn line(&self, color: Color) -> Color {
        let mixed = (0..=100).step_by(10).map(|percent| color.mix(self.ink, percent));
        mixed.into_iter().find(|line| line.contrast(self.background) >= 3.0).unwrap_or(self.ink)
    }

    /// The colour of a label about something of this colour: mixed with the ink until its contrast with the page
    /// suffices.
    pub fn label(&self, color: Color) -> Color {
        let mixed = (0..=100).step_by(10).map(|percent| color.mix(self.ink, percent));
        mixed.into_iter().find(|label| label.contrast(self.background) >= TEXT_CONTRAST).unwrap_or(self.ink)
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
        ColorBy::Speed => color_by_speed(sprite.velocity.norm(), style.color_speed.unwrap_or(style.top_speed)),
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
pub fn contrasting(fill: Color) -> Color {
    let (black, white) = (Color::hex(0x000000), Color::hex(0xffffff));
    let line = if fill.contrast(black) > fill.contrast(white) { black } else { white };
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

#[cfg(test)]
mod tests {
    use super::*;

    const THEMES: [Palette; 2] = [LIGHT, DARK];

    /// The colours of arrows, with their names.
    fn arrow_colors(palette: &Palette) -> [(&'static str, Color); 6] {
        [
            ("velocity", palette.ink),
            ("momentum", palette.momentum),
            ("force", palette.force),
            ("normal", palette.normal),
            ("penetration", palette.penetration),
            ("impulse", palette.impulse),
        ]
    }

    #[test]
    #[expect(clippy::disallowed_methods, reason = "the comparison has a tolerance")]
    fn the_linear_intensities_are_those_of_srgb() {
        for (component, &linear) in LINEAR.iter().enumerate() {
            let value = component as f64 / 255.0;
            let exact = if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) };
            assert!((f64::from(linear) - exact * 65_535.0).abs() <= 0.5001, "{component}");
        }
        assert_eq!(Color::hex(0x000000).contrast(Color::hex(0xffffff)), 21.0);
    }

    #[test]
    fn arrows_contrast_with_their_halo_at_3_to_1_and_their_labels_at_4_5_to_1() {
        for palette in THEMES {
            for (name, color) in arrow_colors(&palette) {
                assert!(color.contrast(palette.background) >= 3.0, "{name}");
                assert!(palette.label(color).contrast(palette.background) >= TEXT_CONTRAST, "{name}");
            }
        }
    }

    #[test]
    fn labels_are_legible_on_the_page_and_on_every_fill() {
        for palette in THEMES {
            for text in [palette.ink, palette.muted] {
                assert!(text.contrast(palette.background) >= TEXT_CONTRAST, "{text} on the page");
            }
            let fills = BODY_COLORS.into_iter().chain(SPEED_COLORS).chain([DEFAULT_COLOR, palette.wall]);
            for fill in fills.clone().flat_map(|fill| [0, 15, 45, 65].map(|part| fill.mix(palette.background, part))) {
                let contrast = palette.text_on(fill).contrast(fill);
                assert!(contrast >= TEXT_CONTRAST, "{contrast} on {fill}");
                let contrast = palette.label(fill).contrast(palette.background);
                assert!(contrast >= TEXT_CONTRAST, "{contrast} of the label of {fill}");
            }
            // Every colour that a scene can assign.
            for value in (0..1 << 24).step_by(4099) {
                let fill = Color::hex(value);
                assert!(palette.text_on(fill).contrast(fill) >= TEXT_CONTRAST, "{fill}");
            }
        }
    }

    /// A colour in CIE L*a*b* as seen with the colour vision that `matrix` simulates in linear sRGB.
    #[expect(clippy::disallowed_methods, reason = "the comparison has a tolerance")]
    fn seen([red, green, blue]: [[f64; 3]; 3], color: Color) -> [f64; 3] {
        let linear = [color.r, color.g, color.b].map(|component| f64::from(LINEAR[usize::from(component)]) / 65_535.0);
        let dot = |row: [f64; 3], column: [f64; 3]| row.iter().zip(column).map(|(a, b)| a * b).sum::<f64>();
        let rgb = [red, green, blue].map(|row| dot(row, linear).clamp(0.0, 1.0));
        let xyz = [
            dot([0.412_456_4, 0.357_576_1, 0.180_437_5], rgb) / 0.950_47,
            dot([0.212_672_9, 0.715_152_2, 0.072_175_0], rgb),
            dot([0.019_333_9, 0.119_192_0, 0.950_304_1], rgb) / 1.088_83,
        ];
        let [x, y, z] =
            xyz.map(|part| if part > 216.0 / 24_389.0 { part.cbrt() } else { (24_389.0 / 27.0 * part + 16.0) / 116.0 });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// The matrices are those of complete deuteranopia and protanopia in Machado, Oliveira, Fernandes, "A
    /// physiologically-based model for simulation of color vision deficiency", 2009.
    #[test]
    fn arrows_of_collisions_differ_for_every_kind_of_colour_vision() {
        let normal = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let deuteranope =
            [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]];
        let protanope = [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ];
        for palette in THEMES {
            for vision in [normal, deuteranope, protanope] {
                let colors = arrow_colors(&palette).map(|(name, color)| (name, seen(vision, color)));
                for (at, (name, color)) in colors.iter().enumerate() {
                    for (other_name, other) in &colors[..at] {
                        let difference = color.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
                        // Ten times what is just noticeable; penetration and impulse differ far more.
                        let is_named_pair = (*other_name, *name) == ("penetration", "impulse");
                        let least = if is_named_pair { 50.0 } else { 15.0 };
                        assert!(difference > least, "{other_name} and {name}: {difference}");
                    }
                }
            }
        }
    }
}
