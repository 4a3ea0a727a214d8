//! The values of picture options that have names, the same in scenes, in command-line options and in provenance.

#[cfg(feature = "draw")]
use crate::picture_options::OptionText;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

/// Joins names for a message: `"a", "b" or "c"`.
macro_rules! listed {
    ($word:literal, $a:literal, $b:literal) => { concat!("\"", $a, "\" ", $word, " \"", $b, "\"") };
    ($word:literal, $first:literal, $($rest:literal),+) => {
        concat!("\"", $first, "\", ", listed!($word, $($rest),+))
    };
}

/// Declares an enum whose values have names in scenes, in command-line options and in provenance. `accepts`
/// describes the values that a scene accepts; its second part joins the last two names.
macro_rules! named {
    (
        $(#[$doc:meta])* $type:ident { $($(#[$value_doc:meta])* $value:ident = $name:literal,)+ }
        accepts($before:literal, $word:literal, $after:literal)
    ) => {
        $(#[$doc])*
        #[non_exhaustive]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum $type { $($(#[$value_doc])* #[serde(rename = $name)] $value,)+ }

        impl $type {
            /// All values, in the order of the documentation.
            pub const ALL: &'static [$type] = &[$($type::$value,)+];

            /// The values that a scene accepts, for messages.
            #[allow(dead_code, reason = "not every option is a key of scenes")]
            pub(crate) const ACCEPTED: &'static str = concat!($before, listed!($word, $($name),+), $after);

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

        #[cfg(feature = "draw")]
        impl OptionText for $type {
            fn to_text(&self) -> String {
                self.to_string()
            }

            fn from_text(text: &str) -> Option<$type> {
                text.parse().ok()
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
    accepts("", "or", "")
}

named! {
    /// An overlay that can be drawn in addition to the bodies.
    Overlay {
        /// The velocity of each body, as an arrow.
        Velocity = "velocity",
        /// The momentum of each body, as an arrow.
        Momentum = "momentum",
        /// The sum of the weight of each body and its constant force, as an arrow.
        Force = "force",
        /// The unit normal of each collision.
        Normal = "normal",
        /// The impulses of each collision.
        Impulse = "impulse",
        /// The penetration vector of each collision.
        Penetration = "penetration",
        /// The centre of mass of all bodies of finite mass.
        Com = "com",
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
    accepts("a list of ", "and", ", each at most once")
}

impl Overlay {
    /// Returns true if the overlay shows collisions, which only a replay finds.
    #[cfg(feature = "draw")]
    pub(crate) const fn shows_collisions(self) -> bool {
        matches!(self, Overlay::Normal | Overlay::Impulse | Overlay::Penetration)
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
    accepts("", "or", "")
}

named! {
    /// The form of text in SVG files.
    TextAs {
        /// Outlines of glyphs, which look the same everywhere, with the same words as invisible text.
        Outlines = "outlines",
        /// Text in a font of the reader's computer, which can be edited.
        Text = "text",
    }
    accepts("", "or", "")
}

named! {
    /// The quantity of a diagram of lines over time.
    Quantity {
        /// Distance of the left side of a body from the left border of the world, m.
        X = "x",
        /// Distance of the upper side of a body below the upper border of the world, m.
        Y = "y",
        /// Velocity to the right, m/s.
        Vx = "vx",
        /// Velocity downwards, m/s.
        Vy = "vy",
        /// Speed, m/s.
        Speed = "speed",
        /// Height of the lower side of a body above the lower border of the world, m.
        Height = "height",
        /// Kinetic and potential energy, J, of chosen bodies or of all together.
        Energy = "E",
        /// Norm of the momentum, kg·m/s, of chosen bodies or of all together.
        Momentum = "p",
    }
    accepts("", "or", "")
}

impl Quantity {
    /// Its name in the title of a picture.
    #[cfg(feature = "draw")]
    pub(crate) const fn title(self, language: Language) -> &'static str {
        match self {
            Quantity::X => language.of("Position x", "Position x"),
            Quantity::Y => language.of("Position y", "Position y"),
            Quantity::Vx => language.of("Velocity v_x", "Vitesse v_x"),
            Quantity::Vy => language.of("Velocity v_y", "Vitesse v_y"),
            Quantity::Speed => language.of("Speed", "Vitesse"),
            Quantity::Height => language.of("Height", "Hauteur"),
            Quantity::Energy => language.of("Energy", "Énergie"),
            Quantity::Momentum => language.of("Momentum", "Quantité de mouvement"),
        }
    }
}

named! {
    /// The frame of reference in which a figure shows velocities.
    ReferenceFrame {
        /// The frame of the world, in which the walls are at rest.
        Laboratory = "lab",
        /// The frame in which the centre of mass of the colliding bodies is at rest; with an infinite mass, that body.
        CenterOfMass = "com",
    }
    accepts("", "or", "")
}

named! {
    /// The language of the words and numbers in pictures.
    Language {
        /// English.
        English = "en",
        /// French.
        French = "fr",
    }
    accepts("", "or", "")
}

impl Language {
    /// The text in this language, of one in English and one in French.
    #[cfg(feature = "draw")]
    pub(crate) const fn of<T: Copy>(self, english: T, french: T) -> T {
        match self {
            Language::English => english,
            Language::French => french,
        }
    }

    /// A number, or a number with its unit, with the decimal mark of this language in place of the point.
    #[cfg(feature = "draw")]
    pub(crate) fn decimal(self, number: String) -> String {
        match self {
            Language::English => number,
            Language::French => number.replace('.', ","),
        }
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

    /// The help text of `--show`.
    #[cfg(feature = "cli")]
    pub(crate) fn help() -> String {
        let names: Vec<&str> = Overlay::ALL.iter().map(|overlay| overlay.name()).collect();
        format!("Show these overlays: none, or a list of {}", names.join(", "))
    }

    /// Returns true if one of the overlays shows collisions.
    #[cfg(feature = "draw")]
    pub(crate) fn show_collisions(&self) -> bool {
        self.0.iter().any(|overlay| overlay.shows_collisions())
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

#[cfg(feature = "draw")]
impl OptionText for Overlays {
    fn to_text(&self) -> String {
        self.to_string()
    }

    fn from_text(text: &str) -> Option<Overlays> {
        text.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_of_overlays_has_one_text_form() {
        let show: Overlays = "clock,velocity,clock".parse().unwrap();
        assert_eq!(show.to_string(), "velocity,clock");
        assert_eq!("none".parse(), Ok(Overlays::default()));
        assert!("clock,".parse::<Overlays>().is_err());
    }
}
