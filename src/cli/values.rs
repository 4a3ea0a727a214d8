//! Parsers for the values of flags other than plain numbers and paths.

use crate::physics::{Rect, Vector};
use crate::picture::WindowOptions;
use crate::render::MIN_HOLD;
use crate::scene::{ColorBy, Overlay, Theme};

/// The longest pause, s. A longer one would look like the end of the animation.
const MAX_HOLD: f64 = 60.0;

/// A word of `0.5 at collisions`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldWord {
    /// The duration, s.
    Seconds(f64),
    /// The word `at`.
    At,
    /// The word `collisions`.
    Collisions,
}

impl std::str::FromStr for HoldWord {
    type Err = String;

    fn from_str(text: &str) -> Result<HoldWord, String> {
        match text {
            "at" => Ok(HoldWord::At),
            "collisions" => Ok(HoldWord::Collisions),
            text => match text.parse() {
                Ok(seconds) if (MIN_HOLD..=MAX_HOLD).contains(&seconds) => Ok(HoldWord::Seconds(seconds)),
                Ok(_) | Err(_) => Err("expected 0.05 to 60 seconds, for example 0.5 at collisions".into()),
            },
        }
    }
}

/// A list of overlays as the value of one flag.
#[derive(Clone, Debug)]
pub struct Overlays(pub Vec<Overlay>);

/// Parses names of overlays separated by commas, or `none`.
pub fn overlays(text: &str) -> Result<Overlays, String> {
    if text == "none" {
        return Ok(Overlays(Vec::new()));
    }
    text.split(',')
        .map(|name| named(name, Overlay::named, Overlay::ALL, Overlay::name))
        .collect::<Result<_, _>>()
        .map(Overlays)
}

/// Parses the name of a theme.
pub fn theme(text: &str) -> Result<Theme, String> {
    named(text, Theme::named, Theme::ALL, Theme::name)
}

/// Parses what determines the colours of bodies.
pub fn color_by(text: &str) -> Result<ColorBy, String> {
    named(text, ColorBy::named, ColorBy::ALL, ColorBy::name)
}

fn named<T: Copy>(
    text: &str,
    find: impl Fn(&str) -> Option<T>,
    all: &[T],
    name: impl Fn(T) -> &'static str,
) -> Result<T, String> {
    let names = || all.iter().map(|&value| name(value)).collect::<Vec<_>>().join(", ");
    find(text).ok_or_else(|| format!("{text:?} is not one of {}", names()))
}

/// Parses a size in pixels: `1280x720`.
pub fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides
        .filter(|sides: &[u32; 2]| !sides.contains(&0))
        .ok_or_else(|| "expected WIDTHxHEIGHT, for example 1280x720".into())
}

/// Parses the area that a picture shows.
pub fn window(text: &str) -> Result<WindowOptions, String> {
    let lengths = |text: &str, separator: char| {
        text.split(separator).map(|length| length.parse().ok()).collect::<Option<Vec<f64>>>()
    };
    let is_size = |length: &f64| length.is_finite() && *length > 0.0;
    match (text, lengths(text, 'x').as_deref(), lengths(text, ',').as_deref()) {
        ("world", _, _) => Ok(WindowOptions::World),
        ("bodies", _, _) => Ok(WindowOptions::Bodies),
        (_, Some([width, height]), _) if is_size(width) && is_size(height) => {
            Ok(WindowOptions::Size(Vector::new(*width, *height)))
        }
        (_, _, Some([x, y, width, height])) if x.is_finite() && y.is_finite() && is_size(width) && is_size(height) => {
            Ok(WindowOptions::Area(Rect::new(Vector::new(*x, *y), *width, *height)))
        }
        _ => Err("expected world, bodies, X,Y,WIDTH,HEIGHT in metres, or WIDTHxHEIGHT with --follow".into()),
    }
}

/// Parses the names of two bodies: `c,b`.
pub fn pair(text: &str) -> Result<[String; 2], String> {
    let names = text.split_once(',').filter(|(a, b)| !a.is_empty() && !b.is_empty() && !b.contains(','));
    names.map(|(a, b)| [a.to_owned(), b.to_owned()]).ok_or_else(|| "expected two names, for example c,b".into())
}

/// Parses a number greater than 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a positive number".into())
}
