//! The options of pictures, from whichever source: the `[figure]` table of a scene, command-line flags, or code.

use crate::physics::{Rect, Vector};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

/// Options of a picture. An option that is `None` is open: `PictureOptions::resolve` takes it from the `[figure]` table
/// of the scene, else from the defaults.
///
/// To add an option, add it here, to the resolved picture and to the provenance, and as a flag if it is to have one.
#[non_exhaustive]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct PictureOptions {
    /// Width and height, px.
    #[cfg_attr(feature = "cli", arg(long, value_name = "WxH", value_parser = parse_size))]
    #[cfg_attr(feature = "cli", arg(help = "Set width and height in pixels"))]
    pub size: Option<[u32; 2]>,
    /// The colour theme.
    #[cfg_attr(feature = "cli", arg(long, help = "Use the light or dark theme"))]
    pub theme: Option<Theme>,
    /// Approximate frame rate, frames per second of playback.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub fps: Option<f64>,
    /// The overlays drawn in addition to the bodies.
    #[cfg_attr(feature = "cli", arg(long, value_name = "LIST", help = SHOW_HELP))]
    pub show: Option<Overlays>,
    /// The property that determines the colours of bodies.
    #[cfg_attr(feature = "cli", arg(long, value_name = "KEY", help = "Colour bodies by body, material or speed"))]
    pub color_by: Option<ColorBy>,
    /// The part of the plane to show.
    #[cfg_attr(feature = "cli", arg(long, value_name = "AREA", allow_hyphen_values = true))]
    #[cfg_attr(feature = "cli", arg(help = "Show world, bodies, or X,Y,WIDTH,HEIGHT in metres"))]
    pub window: Option<Window>,
    /// The name of the body that the camera follows.
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME"))]
    #[cfg_attr(feature = "cli", arg(help = "Keep this body centred; --window WxH sets the area"))]
    pub follow: Option<String>,
    /// The caption below the picture.
    #[cfg_attr(feature = "cli", arg(long, value_name = "TEXT", help = "Write this text below the picture"))]
    pub caption: Option<String>,
    /// The first step to draw.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub from: Option<u64>,
    /// The last step to draw.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub to: Option<u64>,
    /// Draw only steps that are a multiple of this number.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub every: Option<u64>,
    /// Playback speed: simulated seconds per second of playback, so 0.1 is slow motion. 1 if `None`.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub slow: Option<f64>,
    /// The time for which an animation freezes at each new collision, s. No freeze frames if `None`.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub hold: Option<f64>,
    /// A title above each recording; the recordings' own titles if `None`.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub titles: Option<Vec<String>>,
}

#[cfg(feature = "cli")]
const SHOW_HELP: &str = "\
    Show these overlays: none, or a list of velocity, force, normal, impulse, penetration, trail, name, mass, grid, \
    axes, scale, clock";

impl PictureOptions {
    /// These options, with the open ones taken from `fallback`.
    pub fn or(self, fallback: PictureOptions) -> PictureOptions {
        PictureOptions {
            size: self.size.or(fallback.size),
            theme: self.theme.or(fallback.theme),
            fps: self.fps.or(fallback.fps),
            show: self.show.or(fallback.show),
            color_by: self.color_by.or(fallback.color_by),
            window: self.window.or(fallback.window),
            follow: self.follow.or(fallback.follow),
            caption: self.caption.or(fallback.caption),
            from: self.from.or(fallback.from),
            to: self.to.or(fallback.to),
            every: self.every.or(fallback.every),
            slow: self.slow.or(fallback.slow),
            hold: self.hold.or(fallback.hold),
            titles: self.titles.or(fallback.titles),
        }
    }
}

/// Parses a size in pixels: `1280x720`.
#[cfg(feature = "draw")]
pub(crate) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides
        .filter(|sides: &[u32; 2]| !sides.contains(&0))
        .ok_or_else(|| "expected WIDTHxHEIGHT, for example 1280x720".into())
}

/// Declares an enum whose values have names in scenes, in command-line options and in provenance.
macro_rules! named {
    ($(#[$doc:meta])* $type:ident { $($(#[$value_doc:meta])* $value:ident = $name:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum $type { $($(#[$value_doc])* #[serde(rename = $name)] $value,)+ }

        impl $type {
            /// All values, in the order of the documentation.
            pub const ALL: &'static [$type] = &[$($type::$value,)+];

            /// The value with that name.
            pub fn named(name: &str) -> Option<$type> {
                $type::ALL.iter().copied().find(|value| value.name() == name)
            }

            /// Its name in scenes, in command-line options and in provenance.
            pub const fn name(self) -> &'static str {
                match self { $($type::$value => $name,)+ }
            }
        }

        impl fmt::Display for $type {
            fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
                out.write_str(self.name())
            }
        }

        impl FromStr for $type {
            type Err = String;

            fn from_str(name: &str) -> Result<$type, String> {
                let all = [$($name,)+].join(", ");
                $type::named(name).ok_or_else(|| format!("{name:?} is not one of {all}"))
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

/// A set of overlays. Its text form is `none`, or names separated by commas.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Overlays(BTreeSet<Overlay>);

impl Overlays {
    /// All overlays.
    pub fn all() -> Overlays {
        Overlay::ALL.iter().copied().collect()
    }

    /// Returns true if `overlay` is in the set.
    pub fn contains(&self, overlay: Overlay) -> bool {
        self.0.contains(&overlay)
    }

    /// Adds an overlay. Returns false if it was in the set before.
    pub fn insert(&mut self, overlay: Overlay) -> bool {
        self.0.insert(overlay)
    }
}

impl FromIterator<Overlay> for Overlays {
    fn from_iter<I: IntoIterator<Item = Overlay>>(overlays: I) -> Overlays {
        Overlays(overlays.into_iter().collect())
    }
}

impl<const N: usize> From<[Overlay; N]> for Overlays {
    fn from(overlays: [Overlay; N]) -> Overlays {
        overlays.into_iter().collect()
    }
}

impl fmt::Display for Overlays {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let names: Vec<&str> = self.0.iter().map(|overlay| overlay.name()).collect();
        out.write_str(if names.is_empty() { "none".into() } else { names.join(",") }.as_str())
    }
}

impl FromStr for Overlays {
    type Err = String;

    fn from_str(text: &str) -> Result<Overlays, String> {
        if text == "none" { Ok(Overlays::default()) } else { text.split(',').map(str::parse).collect() }
    }
}

/// The part of the plane that a picture shows. Its text form is `world`, `bodies`, `X,Y,WIDTH,HEIGHT` or
/// `WIDTHxHEIGHT`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Window {
    /// The whole world.
    World,
    /// The bounding box of all bodies of finite mass over the whole run.
    Bodies,
    /// A fixed rectangle, m.
    Area(Rect),
    /// Width and height around the followed body, m.
    Size(Vector),
}

impl fmt::Display for Window {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Window::World => out.write_str("world"),
            Window::Bodies => out.write_str("bodies"),
            Window::Area(area) => {
                write!(out, "{},{},{},{}", area.origin.x, area.origin.y, area.width(), area.height())
            }
            Window::Size(size) => write!(out, "{}x{}", size.x, size.y),
        }
    }
}

impl FromStr for Window {
    type Err = String;

    fn from_str(text: &str) -> Result<Window, String> {
        let lengths =
            |separator: char| text.split(separator).map(|length| length.parse().ok()).collect::<Option<Vec<f64>>>();
        let is_size = |length: &f64| length.is_finite() && *length > 0.0;
        match (text, lengths('x').as_deref(), lengths(',').as_deref()) {
            ("world", _, _) => Ok(Window::World),
            ("bodies", _, _) => Ok(Window::Bodies),
            (_, Some([width, height]), _) if is_size(width) && is_size(height) => {
                Ok(Window::Size(Vector::new(*width, *height)))
            }
            (_, _, Some([x, y, width, height]))
                if x.is_finite() && y.is_finite() && is_size(width) && is_size(height) =>
            {
                Ok(Window::Area(Rect::new(Vector::new(*x, *y), *width, *height)))
            }
            _ => Err("expected world, bodies, X,Y,WIDTH,HEIGHT in metres, or WIDTHxHEIGHT with --follow".into()),
        }
    }
}

impl From<Window> for String {
    fn from(window: Window) -> String {
        window.to_string()
    }
}

impl TryFrom<String> for Window {
    type Error = String;

    fn try_from(text: String) -> Result<Window, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_back_from_their_serialized_form() {
        let options = PictureOptions {
            size: Some([640, 360]),
            theme: Some(Theme::Dark),
            show: Some(Overlays::from([Overlay::Clock, Overlay::Velocity])),
            window: Some(Window::Area(Rect::new(Vector::new(-1e6, 0.1), 16.0, 1e-3))),
            titles: Some(vec!["one".into()]),
            ..PictureOptions::default()
        };
        let text = toml::to_string(&options).unwrap();
        assert_eq!(toml::from_str::<PictureOptions>(&text).unwrap(), options, "{text}");
        assert_eq!(toml::from_str::<PictureOptions>("").unwrap(), PictureOptions::default());
        assert!(toml::from_str::<PictureOptions>("shows = []").is_err());
    }

    #[test]
    fn given_options_come_before_fallbacks() {
        let given = PictureOptions { theme: Some(Theme::Dark), ..PictureOptions::default() };
        let fallback = PictureOptions { theme: Some(Theme::Light), fps: Some(25.0), ..PictureOptions::default() };
        let merged = given.or(fallback);
        assert_eq!((merged.theme, merged.fps, merged.size), (Some(Theme::Dark), Some(25.0), None));
    }

    #[test]
    fn a_set_of_overlays_has_one_text_form() {
        let show: Overlays = "clock,velocity,clock".parse().unwrap();
        assert_eq!(show.to_string(), "velocity,clock");
        assert_eq!("none".parse(), Ok(Overlays::default()));
        assert!("clock,".parse::<Overlays>().is_err());
    }
}
