use super::{
    refusal::Refusal,
    tree::{Key, Node, Table},
};

/// How pictures of a scene look unless flags say otherwise: the scene's `[figure]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigureOptions {
    /// Width and height, px.
    pub size: Option<[u32; 2]>,
    /// Light or dark.
    pub theme: Option<Theme>,
    /// Frames per second of GIF and APNG.
    pub fps: Option<f64>,
    /// What is drawn beside the boxes.
    pub show: Option<Vec<Overlay>>,
    /// What the colour of a box tells.
    pub color_by: Option<ColorBy>,
}

/// The widest and highest picture, px.
const LARGEST: u64 = 8192;

const SIZE: Key = Key { name: "size", accepts: "width and height, px: two whole numbers from 1 to 8192" };
const THEME: Key = Key { name: "theme", accepts: "\"light\" or \"dark\"" };
const FPS: Key = Key { name: "fps", accepts: "a positive number of frames per second, at most 1000" };
const SHOW: Key = Key {
    name: "show",
    accepts: "a list of \"velocity\", \"force\", \"normal\", \"impulse\", \"penetration\", \"trail\", \"name\", \"mass\", \"grid\", \"axes\", \"scale\" and \"clock\", each at most once",
};
const COLOR_BY: Key = Key { name: "color_by", accepts: "\"body\", \"material\" or \"speed\"" };

/// The scene's `[figure]`.
pub(super) fn read(node: &Node) -> Result<FigureOptions, Refusal> {
    let table = Table::open("figure", node, &[SIZE, THEME, FPS, SHOW, COLOR_BY])?;
    Ok(FigureOptions {
        size: table.optional(SIZE, |node| node.each(pixels))?,
        theme: table.optional(THEME, |node| Theme::named(node.text()?).ok_or(node))?,
        fps: table.optional(FPS, |node| node.number_where(|fps| 0.0 < fps && fps <= 1000.0))?,
        show: table.optional(SHOW, overlays)?,
        color_by: table.optional(COLOR_BY, |node| ColorBy::named(node.text()?).ok_or(node))?,
    })
}

fn pixels(node: &Node) -> Result<u32, &Node> {
    node.count_in(1..=LARGEST).map(|count| count as u32)
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

/// Declares a plain enum whose values have names in scenes and flags.
macro_rules! named {
    ($(#[$doc:meta])* $type:ident { $($(#[$value_doc:meta])* $value:ident = $name:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum $type { $($(#[$value_doc])* $value,)+ }

        impl $type {
            /// Every value, in the order of the documentation.
            pub const ALL: &'static [$type] = &[$($type::$value,)+];

            /// The value of that name.
            pub fn named(name: &str) -> Option<$type> {
                $type::ALL.iter().copied().find(|value| value.name() == name)
            }

            /// Its name in scenes and flags.
            pub const fn name(self) -> &'static str {
                match self { $($type::$value => $name,)+ }
            }
        }
    };
}

named! {
    /// The colours of a picture.
    Theme {
        /// Dark on white, for print and bright rooms.
        Light = "light",
        /// Light on black, for dark rooms.
        Dark = "dark",
    }
}

named! {
    /// What can be drawn beside the boxes.
    Overlay {
        /// An arrow for each velocity.
        Velocity = "velocity",
        /// An arrow for the weight of each box and the constant force on it, taken together.
        Force = "force",
        /// The unit normal of each collision.
        Normal = "normal",
        /// The impulses of each collision.
        Impulse = "impulse",
        /// The penetration vector of each collision.
        Penetration = "penetration",
        /// Where each box was.
        Trail = "trail",
        /// The name of each box.
        Name = "name",
        /// The mass of each box, kg.
        Mass = "mass",
        /// Lines every metre, or every few.
        Grid = "grid",
        /// Scales in metres beside the picture.
        Axes = "axes",
        /// A bar as long as it says.
        Scale = "scale",
        /// The simulated time.
        Clock = "clock",
    }
}

named! {
    /// What the colour of a box tells.
    ColorBy {
        /// Which body it is.
        Body = "body",
        /// What it is made of.
        Material = "material",
        /// How fast it is.
        Speed = "speed",
    }
}
