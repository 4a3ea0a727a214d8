//! What flags take beside plain numbers and paths, read with a message for what they do not.

use crate::illustration::WishedWindow;
use crate::physics::{Rect, Vector};
use crate::render::SHORTEST_HOLD;
use crate::scene::{ColorBy, Overlay, Theme};

/// Longer stops, s, would be taken for the end.
const LONGEST_HOLD: f64 = 60.0;

/// A word of `0.5 at collisions`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldWord {
    /// How long.
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
                Ok(seconds) if (SHORTEST_HOLD..=LONGEST_HOLD).contains(&seconds) => Ok(HoldWord::Seconds(seconds)),
                Ok(_) | Err(_) => Err("expected 0.05 to 60 seconds, such as 0.5 at collisions".into()),
            },
        }
    }
}

/// A list of overlays as one flag gives it.
#[derive(Clone, Debug)]
pub struct Overlays(pub Vec<Overlay>);

/// Names of overlays with commas between, or `none`.
pub fn overlays(text: &str) -> Result<Overlays, String> {
    if text == "none" {
        return Ok(Overlays(Vec::new()));
    }
    text.split(',')
        .map(|name| named(name, Overlay::named, Overlay::ALL, Overlay::name))
        .collect::<Result<_, _>>()
        .map(Overlays)
}

/// A theme's name.
pub fn theme(text: &str) -> Result<Theme, String> {
    named(text, Theme::named, Theme::ALL, Theme::name)
}

/// What colours tell.
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
    find(text).ok_or_else(|| format!("{text:?} is none of {}", names()))
}

/// `1280x720`.
pub fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides.filter(|sides: &[u32; 2]| !sides.contains(&0)).ok_or_else(|| "expected WIDTHxHEIGHT, such as 1280x720".into())
}

/// What is seen.
pub fn window(text: &str) -> Result<WishedWindow, String> {
    let lengths =
        |text: &str, mark: char| text.split(mark).map(|length| length.parse().ok()).collect::<Option<Vec<f64>>>();
    let is_size = |length: &f64| length.is_finite() && *length > 0.0;
    match (text, lengths(text, 'x').as_deref(), lengths(text, ',').as_deref()) {
        ("world", _, _) => Ok(WishedWindow::World),
        ("bodies", _, _) => Ok(WishedWindow::Bodies),
        (_, Some([width, height]), _) if is_size(width) && is_size(height) => {
            Ok(WishedWindow::Size(Vector::new(*width, *height)))
        }
        (_, _, Some([x, y, width, height])) if x.is_finite() && y.is_finite() && is_size(width) && is_size(height) => {
            Ok(WishedWindow::Area(Rect::new(Vector::new(*x, *y), *width, *height)))
        }
        _ => Err("expected world, bodies, X,Y,WIDTH,HEIGHT in metres, or WIDTHxHEIGHT with --follow".into()),
    }
}

/// `c,b`.
pub fn pair(text: &str) -> Result<[String; 2], String> {
    let names = text.split_once(',').filter(|(a, b)| !a.is_empty() && !b.is_empty() && !b.contains(','));
    names.map(|(a, b)| [a.to_owned(), b.to_owned()]).ok_or_else(|| "expected two names, such as c,b".into())
}

/// A number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a positive number".into())
}
