use super::{
    diagnostics::Reported,
    tree::{Key, Node, Table},
};

/// The `[figure]` table of a scene: defaults of its pictures, which command-line options override.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureDefaults {
    /// Width and height, px.
    pub size: Option<[u32; 2]>,
    /// Colour theme.
    pub theme: Option<Theme>,
    /// Frames per second of animations.
    pub fps: Option<f64>,
    /// Overlays drawn in addition to the bodies.
    pub show: Option<Vec<Overlay>>,
    /// The property that determines the colours of bodies.
    pub color_by: Option<ColorBy>,
}

/// The largest width and height of a picture, px.
const MAX_PIXELS: u64 = 8192;

const SIZE: Key = Key { name: "size", accepts: "width and height, px: two whole numbers from 1 to 8192" };
const THEME: Key = Key { name: "theme", accepts: "\"light\" or \"dark\"" };
const FPS: Key = Key { name: "fps", accepts: "a positive number of frames per second, at most 1000" };
const SHOW: Key = Key {
    name: "show",
    accepts: "a list of \"velocity\", \"force\", \"normal\", \"impulse\", \"penetration\", \"trail\", \"name\", \"mass\", \"grid\", \"axes\", \"scale\" and \"clock\", each at most once",
};
const COLOR_BY: Key = Key { name: "color_by", accepts: "\"body\", \"material\" or \"speed\"" };

/// The keys of `[figure]`.
pub(super) const KEYS: &[Key] = &[SIZE, THEME, FPS, SHOW, COLOR_BY];

/// Reads `[figure]`.
pub(super) fn read(table: &Table) -> Result<PictureDefaults, Reported> {
    let size = table.optional(SIZE, |node| node.each(pixels));
    let theme = table.optional(THEME, |node| Theme::named(node.text()?).ok_or(node));
    let fps = table.optional(FPS, |node| node.number_where(|fps| 0.0 < fps && fps <= 1000.0));
    let show = table.optional(SHOW, overlays);
    let color_by = table.optional(COLOR_BY, |node| ColorBy::named(node.text()?).ok_or(node));
    Ok(PictureDefaults { size: size?, theme: theme?, fps: fps?, show: show?, color_by: color_by? })
}

fn pixels(node: &Node) -> Result<u32, &Node> {
    node.count_in(1..=MAX_PIXELS).map(|count| count as u32)
}

fn overlays(node: &Node) -> Result<Vec<Overlay>, &Node> {
    let mut overlays = Vec::new();
    for node in node.nodes()? {
        let overlay = Overlay::named(node.text()?).ok_or(node)?;
        if overlays.contains(&overlay) {
            return Err(node);
        }
        overlays.push(overlay);
    }
    Ok(overlays)
}

/// Declares an enum whose values have names in scenes and in command-line options.
macro_rules! named {
    ($(#[$doc:meta])* $type:ident { $($(#[$value_doc:meta])* $value:ident = $name:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum $type { $($(#[$value_doc])* $value,)+ }

        impl $type {
            /// All values, in the order of the documentation.
            pub const ALL: &'static [$type] = &[$($type::$value,)+];

            /// The value with that name.
            pub fn named(name: &str) -> Option<$type> {
                $type::ALL.iter().copied().find(|value| value.name() == name)
            }

            /// Its name in scenes and in command-line options.
            pub const fn name(self) -> &'static str {
                match self { $($type::$value => $name,)+ }
            }
        }
    };
}

named! {
    /// The colour theme of a picture.
    Theme {
        /// Dark shapes on white, for print and bright rooms.
        Light = "light",
        /// Light shapes on black, for dark rooms.
        Dark = "dark",
    }
}

named! {
    /// An overlay that can be drawn in addition to the bodies.
    Overlay {
        /// The velocity of each body, as an arrow.
        Velocity = "velocity",
        /// The sum of the weight of each body and its constant force, as an arrow.
        Force = "force",
        /// The unit normal of each collision.
        Normal = "normal",
        /// The impulses of each collision.
        Impulse = "impulse",
        /// The penetration vector of each collision.
        Penetration = "penetration",
        /// The past path of each body.
        Trail = "trail",
        /// The name of each body.
        Name = "name",
        /// The mass of each body, kg.
        Mass = "mass",
        /// Grid lines at round distances.
        Grid = "grid",
        /// Axes in metres.
        Axes = "axes",
        /// A scale bar.
        Scale = "scale",
        /// The simulated time.
        Clock = "clock",
    }
}

named! {
    /// The property that determines the colour of a body.
    ColorBy {
        /// One colour per body.
        Body = "body",
        /// One colour per material.
        Material = "material",
        /// A scale from slow to fast.
        Speed = "speed",
    }
}
