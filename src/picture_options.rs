//! The options of pictures, from whichever source: the `[figure]` table of a scene, command-line flags, or code.

use crate::body_selector::BodySelector;
use crate::physics::{Rect, Vector};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

pub use crate::picture_choices::{ColorBy, Language, Overlay, Overlays, Quantity, ReferenceFrame, TextAs, Theme};

/// Declares [`PictureOptions`] and the [`Look`] to which they are resolved, each option once.
///
/// An option of `look` has a flag, a default and a text form ([`OptionText`]) in provenance; see [`Written`]. An option
/// of `other` determines the camera, or the steps and times that are drawn; see `PictureOptions::resolve`.
macro_rules! picture_options {
    (
        $(#[$options_doc:meta])* options;
        $(#[$look_doc:meta])* look {
            $($(#[$doc:meta])* flag($($flag:tt)*) $name:ident: $type:ty = $default:expr, $written:ident;)+
        }
        other { $($(#[$other_doc:meta])* flag($($other_flag:tt)*) $other:ident: $other_type:ty;)+ }
    ) => {
        $(#[$options_doc])*
        pub struct PictureOptions {
            $($(#[$doc])* #[cfg_attr(feature = "cli", arg($($flag)*))] pub $name: Option<$type>,)+
            $($(#[$other_doc])* #[cfg_attr(feature = "cli", arg($($other_flag)*))] pub $other: Option<$other_type>,)+
        }

        impl PictureOptions {
            /// These options, with the open ones taken from `fallback`.
            pub fn or(self, fallback: PictureOptions) -> PictureOptions {
                PictureOptions {
                    $($name: self.$name.or(fallback.$name),)+
                    $($other: self.$other.or(fallback.$other),)+
                }
            }

            /// The look that these options describe, with defaults for the open ones.
            #[cfg(feature = "draw")]
            pub(crate) fn look(&self, camera_target: CameraTarget) -> Look {
                Look { $($name: self.$name.clone().unwrap_or_else(|| $default),)+ camera_target }
            }
        }

        $(#[$look_doc])*
        #[cfg(feature = "draw")]
        #[derive(Clone, Debug, PartialEq)]
        pub struct Look {
            $($(#[$doc])* pub $name: $type,)+
            /// The part of the world that the camera shows.
            pub camera_target: CameraTarget,
        }

        #[cfg(feature = "draw")]
        impl Look {
            /// Keys and texts of the options that provenance contains under this condition, in order.
            pub(crate) fn texts(&self, written: Written) -> Vec<(&'static str, String)> {
                let default = Look::default();
                let mut texts = Vec::new();
                $(if written == Written::$written && (written == Written::Always || self.$name != default.$name) {
                    texts.push((stringify!($name), self.$name.to_text()));
                })+
                texts
            }

            /// The look whose options have the texts that `get` returns. `None` if a text cannot be parsed, or if one
            /// that is always written is missing.
            pub(crate) fn from_texts<'a>(
                get: impl Fn(&str) -> Option<&'a str>,
                camera_target: CameraTarget,
            ) -> Option<Look> {
                Some(Look {
                    $($name: match (get(stringify!($name)), Written::$written) {
                        (Some(text), _) => OptionText::from_text(text)?,
                        (None, Written::IfChanged) => $default,
                        (None, Written::Always) => return None,
                    },)+
                    camera_target,
                })
            }
        }
    };
}

/// The condition under which provenance contains an option.
#[cfg(feature = "draw")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Written {
    /// In every picture: the options of the first version.
    Always,
    /// If it differs from its default. Every later option is written so, because older pictures do not contain it.
    IfChanged,
}

picture_options! {
    /// Options of a picture. An option that is `None` is open: `PictureOptions::resolve` takes it from the `[figure]`
    /// table of the scene, else from the defaults.
    #[non_exhaustive]
    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    #[cfg_attr(feature = "cli", derive(clap::Args))]
    options;

    /// The appearance of a picture.
    look {
        /// Width and height, px.
        flag(long, value_name = "WxH", value_parser = parse_size, help = "Set width and height in pixels")
        size: [u32; 2] = [1280, 720], Always;

        /// The colour theme.
        flag(long, help = "Use the light or dark theme")
        theme: Theme = Theme::Light, Always;

        /// The overlays drawn in addition to the bodies.
        flag(long, value_name = "LIST", help = Overlays::help())
        show: Overlays = Overlays::from([Overlay::Name, Overlay::Clock]), Always;

        /// The property that determines the colours of bodies.
        flag(long, value_name = "KEY", help = "Colour bodies by body, material or speed")
        color_by: ColorBy = ColorBy::Body, Always;

        /// The caption below the picture; none if empty.
        flag(long, value_name = "TEXT", help = "Write this text below the picture")
        caption: String = String::new(), IfChanged;

        /// The form of text in SVG files. In PDF files text is always text, in raster files always pixels.
        flag(long, value_name = "FORM", help = "Write the text of SVG files as outlines or as text")
        text: TextAs = TextAs::Outlines, IfChanged;

        /// The language of the words in figures and legends. Numbers keep the decimal point, as in tables and scenes.
        flag(long, value_name = "CODE", help = "Write words in en (English) or fr (French)")
        language: Language = Language::English, IfChanged;

        /// The bodies that a figure shows; see [`BodySelector`].
        flag(skip)
        bodies: BodySelector = BodySelector::default(), IfChanged;
    }

    other {
        /// The part of the plane to show.
        flag(
            long, value_name = "AREA", allow_hyphen_values = true,
            help = "Show world, bodies, or X,Y,WIDTH,HEIGHT in metres"
        )
        window: Window;

        /// The name of the body that the camera follows.
        flag(long, value_name = "NAME", help = "Keep this body centred; --window WxH sets the area")
        follow: String;

        /// The first step to draw.
        flag(
            long, value_name = "STEP", allow_hyphen_values = true,
            help = "Start at this step, or at a time such as 1.5s"
        )
        from: StepOrTime;

        /// The last step to draw.
        flag(long, value_name = "STEP", allow_hyphen_values = true, help = "Stop after this step or time")
        to: StepOrTime;

        /// Draw only steps that are a multiple of this number. By default, animations have `fps` frames per second,
        /// folders have all steps, and figures as many as suit them.
        flag(
            long, value_name = "N", allow_negative_numbers = true,
            value_parser = clap::value_parser!(u64).range(1..=crate::recording::limits::STEPS),
            help = "Draw every N-th step, counted from step 0"
        )
        every: u64;

        /// Approximate frame rate, frames per second of playback.
        flag(skip)
        fps: f64;

        /// Playback speed: simulated seconds per second of playback, so 0.1 is slow motion. 1 if `None`.
        flag(skip)
        slow: f64;

        /// The time for which an animation freezes at each new collision, s. No freeze frames if `None`.
        flag(skip)
        hold: f64;

        /// A title above each recording; the recordings' own titles if `None`.
        flag(skip)
        titles: Vec<String>;
    }
}

#[cfg(feature = "draw")]
impl Default for Look {
    /// The defaults of all pictures: 1280 × 720 px, the light theme with names and clock, coloured by body.
    fn default() -> Look {
        PictureOptions::default().look(CameraTarget::World)
    }
}

/// The part of the world that a camera shows: the options `window` and `follow`, resolved.
#[cfg(feature = "draw")]
#[derive(Clone, Debug, PartialEq)]
pub enum CameraTarget {
    /// The whole world.
    World,
    /// A rectangle of the plane, m. More is visible if the picture has a different aspect ratio.
    Window(Rect),
    /// The surroundings of a body, which stays in the middle.
    Follow {
        /// Name of the body.
        name: String,
        /// Width and height of the visible area around it, m.
        size: Vector,
    },
}

#[cfg(feature = "draw")]
impl CameraTarget {
    /// The name of the body that the camera follows, if any.
    pub fn followed_body(&self) -> Option<&str> {
        match self {
            CameraTarget::Follow { name, .. } => Some(name),
            CameraTarget::World | CameraTarget::Window(_) => None,
        }
    }
}

/// The text form of an option in provenance, which contains no blank outside quotes.
#[cfg(feature = "draw")]
pub(crate) trait OptionText: Sized {
    fn to_text(&self) -> String;
    fn from_text(text: &str) -> Option<Self>;
}

#[cfg(feature = "draw")]
impl OptionText for [u32; 2] {
    fn to_text(&self) -> String {
        let [width, height] = self;
        format!("{width}x{height}")
    }

    fn from_text(text: &str) -> Option<[u32; 2]> {
        sides(text).filter(|sides| !sides.contains(&0))
    }
}

#[cfg(feature = "draw")]
impl OptionText for String {
    fn to_text(&self) -> String {
        crate::text::json_string(self)
    }

    fn from_text(text: &str) -> Option<String> {
        serde_json::from_str(text).ok()
    }
}

#[cfg(feature = "draw")]
impl OptionText for BodySelector {
    fn to_text(&self) -> String {
        self.to_string().to_text()
    }

    fn from_text(text: &str) -> Option<BodySelector> {
        String::from_text(text)?.parse().ok()
    }
}

/// The largest width and height of a picture, px: in scenes and options, and of files that are drawn or read.
pub(crate) const MAX_SIDE: u32 = 16_384;

/// The largest size of the caption and of each title of a picture, bytes.
#[cfg(feature = "draw")]
pub(crate) const MAX_TEXT_BYTES: usize = 4096;

/// The largest number of recordings in a picture.
#[cfg(feature = "draw")]
pub(crate) const MAX_RECORDINGS: usize = 10_000;

/// Checks the caption, the titles and the number of recordings of a picture: laying them out takes time, however small
/// the picture is.
///
/// # Errors
/// A sentence that names the part which is too large, and the limit.
#[cfg(feature = "draw")]
pub(crate) fn check_extent(caption: &str, titles: &[String], recordings: usize) -> Result<(), String> {
    let longest_title = titles.iter().map(String::len).max().unwrap_or(0);
    for (name, bytes) in [("the caption", caption.len()), ("a title", longest_title)] {
        if bytes > MAX_TEXT_BYTES {
            return Err(format!("{name} has {bytes} bytes; at most {MAX_TEXT_BYTES} are allowed"));
        }
    }
    let count = recordings.max(titles.len());
    if count > MAX_RECORDINGS {
        return Err(format!("a picture of {count} recordings cannot be drawn; at most {MAX_RECORDINGS} are allowed"));
    }
    Ok(())
}

/// The largest frame rate, frames per second of playback.
pub const MAX_FPS: f64 = 1000.0;

/// The longest time of a run, s.
const MAX_TIME: f64 = crate::recording::limits::SECONDS;

/// A state of a run: its step, or a time since step 0. Its text form is `90`, respectively `1.5s`, `20ms` or `3us`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum StepOrTime {
    /// The step.
    Step(u64),
    /// Seconds since step 0.
    Time(f64),
}

impl StepOrTime {
    /// The step, or the one nearest to the time, in a run at `rate` Hz.
    pub fn step(self, rate: f64) -> u64 {
        match self {
            StepOrTime::Step(step) => step,
            StepOrTime::Time(time) => (time * rate).round() as u64,
        }
    }

    /// The step, or the first one that can have a collision at or after the time, in a run at `rate` Hz.
    pub fn first_collision_step(self, rate: f64) -> u64 {
        match self {
            StepOrTime::Step(step) => step,
            // A collision at the time of a state happens in the step before it.
            StepOrTime::Time(time) => ((time * rate) as u64).saturating_sub(1),
        }
    }

    /// The step, or the last one that can have a collision at or before the time, in a run at `rate` Hz.
    pub fn last_collision_step(self, rate: f64) -> u64 {
        match self {
            StepOrTime::Step(step) => step,
            // A time that is a step up to rounding is that step.
            StepOrTime::Time(time) => (time * rate * (1.0 + 1e-12)) as u64,
        }
    }

    /// The time, s; `None` for a step.
    pub const fn time(self) -> Option<f64> {
        match self {
            StepOrTime::Step(_) => None,
            StepOrTime::Time(time) => Some(time),
        }
    }
}

/// A range of steps or times that ends before it starts.
#[cfg(feature = "draw")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no step is in the range --from {from} --to {to}; exchange the two")]
pub struct ReversedRange {
    from: StepOrTime,
    to: StepOrTime,
}

#[cfg(feature = "draw")]
impl ReversedRange {
    /// Returns an error if a range ends before it starts in a run at `rate` Hz.
    pub fn refuse(from: Option<StepOrTime>, to: Option<StepOrTime>, rate: f64) -> Result<(), ReversedRange> {
        let Some((from, to)) = from.zip(to) else { return Ok(()) };
        let ends_before = from.time().zip(to.time()).is_some_and(|(from, to)| from > to);
        if ends_before || from.step(rate) > to.step(rate) { Err(ReversedRange { from, to }) } else { Ok(()) }
    }
}

impl From<u64> for StepOrTime {
    fn from(step: u64) -> StepOrTime {
        StepOrTime::Step(step)
    }
}

impl fmt::Display for StepOrTime {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            StepOrTime::Step(step) => write!(out, "{step}"),
            StepOrTime::Time(time) => write!(out, "{time}s"),
        }
    }
}

impl FromStr for StepOrTime {
    type Err = String;

    fn from_str(text: &str) -> Result<StepOrTime, String> {
        let seconds = |number: &str, unit: f64| number.trim_end().parse::<f64>().ok().map(|number| number * unit);
        let units = [("ms", 1e-3), ("us", 1e-6), ("µs", 1e-6), ("s", 1.0)];
        let time =
            units.iter().find_map(|(name, unit)| text.strip_suffix(name).and_then(|number| seconds(number, *unit)));
        match (text.parse(), time) {
            (Ok(step), _) => Ok(StepOrTime::Step(step)),
            (Err(_), Some(time)) if (0.0..=MAX_TIME).contains(&time) => Ok(StepOrTime::Time(time)),
            (Err(_), Some(time)) if time > MAX_TIME => Err(format!("a run has at most {MAX_TIME} s")),
            (Err(_), _) => Err("expected a step such as 90, or a time such as 1.5s or 20ms".into()),
        }
    }
}

impl From<StepOrTime> for String {
    fn from(point: StepOrTime) -> String {
        point.to_string()
    }
}

impl TryFrom<String> for StepOrTime {
    type Error = String;

    fn try_from(text: String) -> Result<StepOrTime, String> {
        text.parse()
    }
}

/// The two numbers of a size.
#[cfg(feature = "draw")]
fn sides(text: &str) -> Option<[u32; 2]> {
    let (width, height) = text.split_once('x')?;
    Some([width.parse().ok()?, height.parse().ok()?])
}

/// Parses a size in pixels: `1280x720`.
#[cfg(feature = "cli")]
pub(crate) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    sides(text)
        .filter(|sides: &[u32; 2]| sides.iter().all(|side| (1..=MAX_SIDE).contains(side)))
        .ok_or_else(|| format!("expected WIDTHxHEIGHT, each from 1 to {MAX_SIDE} pixels, for example 1280x720"))
}

/// The part of the plane that a picture shows. Its text form is `world`, `bodies`, `X,Y,WIDTH,HEIGHT` or
/// `WIDTHxHEIGHT`.
#[non_exhaustive]
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
    fn times_are_the_nearest_steps() {
        let step = |text: &str, rate| text.parse::<StepOrTime>().map(|point| point.step(rate));
        assert_eq!(step("90", 60.0), Ok(90));
        assert_eq!([step("1.5s", 60.0), step("20ms", 1000.0), step("3us", 1e6)], [Ok(90), Ok(20), Ok(3)]);
        assert_eq!(step("0.1 s", 30.0), Ok(3));
        for wrong in ["", "s", "-1", "-1s", "1.5", "1e400s", "nans", "5m"] {
            assert!(step(wrong, 60.0).is_err(), "{wrong}");
        }
        let time: StepOrTime = "0.3s".parse().unwrap();
        assert_eq!([time.first_collision_step(10.0), time.last_collision_step(10.0)], [2, 3]);
        assert_eq!("0.39s".parse::<StepOrTime>().unwrap().to_string(), "0.39s");
    }

    #[test]
    fn given_options_come_before_fallbacks() {
        let given = PictureOptions { theme: Some(Theme::Dark), ..PictureOptions::default() };
        let fallback = PictureOptions { theme: Some(Theme::Light), fps: Some(25.0), ..PictureOptions::default() };
        let merged = given.or(fallback);
        assert_eq!((merged.theme, merged.fps, merged.size), (Some(Theme::Dark), Some(25.0), None));
    }
}
