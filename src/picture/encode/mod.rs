//! Writes pictures and animations as files, and reads and compares them.

mod animation;
pub mod apng;
pub mod compare;
mod decode;
pub mod gif;
pub mod lzw;
mod ordered_parallel_map;
pub mod pdf;
pub mod png;
pub mod quantize;
pub mod svg;

pub use animation::{draw_frames, write_apng, write_gif, write_png, write_png_sequence};
pub use decode::{AnimationDecoder, DecodedFrame};
pub(crate) use ordered_parallel_map::ordered_parallel_map;
pub use png::PngEffort;

use crate::picture_options::MAX_SIDE;
use crate::text::counted;

/// The largest number of pixels of a picture that is decoded, that of the largest picture that is drawn. A damaged file
/// may declare any size.
const MAX_PIXELS: usize = (MAX_SIDE as usize).pow(2);

/// The metadata of a picture file: keys and values in the order in which they are written.
///
/// They contain no path, no date and nothing about threads or shards, so that a picture drawn again has
/// the same bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Keys are 1 to 79 printable ASCII characters; values are any text.
    pub entries: Vec<(String, String)>,
}

impl Metadata {
    /// The key of the title, in every format.
    pub const TITLE: &'static str = "Title";
    /// The key of the description, in every format.
    pub const DESCRIPTION: &'static str = "Description";

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&str> {
        self.entries.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    /// Parses text with one `key: value` per line; other lines are ignored.
    pub fn parse(text: &str) -> Metadata {
        let entry = |line: &str| line.split_once(": ").map(|(key, value)| (key.to_owned(), value.to_owned()));
        Metadata { entries: text.lines().filter_map(entry).collect() }
    }
}

impl std::fmt::Display for Metadata {
    /// One `key: value` per line, the form of GIF comments and SVG metadata.
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        self.entries.iter().try_for_each(|(key, value)| writeln!(out, "{key}: {value}"))
    }
}

/// An error of drawing, encoding or decoding a picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The size of the picture is zero or too large.
    #[error("a picture of {width}×{height} pixels cannot be drawn: each side must be 1 to {max_side} pixels")]
    PictureSize {
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
        /// Maximum width and height, px.
        max_side: u32,
    },
    /// The picture is too small for its text.
    #[error(
        "a picture of {width}×{height} pixels is too small for its text: {}",
        match needed {
            Some([width, height]) => format!("use --size {width}x{height} or larger"),
            None => "no size is sufficient, so show less: fewer recordings, or shorter texts".to_owned(),
        }
    )]
    TooSmall {
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
        /// A sufficient size, px; `None` if no size is sufficient.
        needed: Option<[u32; 2]>,
    },
    /// The visible part of the world is empty or not finite.
    #[error("an area of {width} m × {height} m cannot be shown: width and height must be finite and positive")]
    WorldSize {
        /// Width, m.
        width: f64,
        /// Height, m.
        height: f64,
    },
    /// An animation has fewer frames than the number in its header.
    #[error(
        "only {found} of {} can be drawn, because states are missing or damaged, and an animated PNG starts with their \
         number: recover the recording first, or draw a GIF",
        counted(*.expected, "frame")
    )]
    PictureCount {
        /// Number in the header.
        expected: u64,
        /// Number of frames written.
        found: u64,
    },
    /// Writing the output failed.
    #[error(transparent)]
    Write(#[from] std::io::Error),
    /// Reading the input failed.
    #[error(transparent)]
    Read(std::io::Error),
    /// The picture file is damaged or has another format.
    #[error("the picture file cannot be read: {0}")]
    Unreadable(String),
}

impl RenderError {
    /// The error for a picture of `size` pixels that is too small, with the smallest larger one that `fits`: in
    /// proportion, as far as the longest side allows.
    pub(crate) fn too_small(size: [u32; 2], fits: impl Fn([u32; 2]) -> bool) -> RenderError {
        let [width, height] = size;
        // Each is a tenth larger than the one before.
        let scaled = |factor: f64| size.map(|side| ((f64::from(side) * factor).ceil() as u32).min(MAX_SIDE));
        let mut sizes = std::iter::successors(Some(1.1), |factor| Some(factor * 1.1)).map(scaled);
        let needed = loop {
            match sizes.next() {
                Some(size) if fits(size) => break Some(size),
                Some([MAX_SIDE, MAX_SIDE]) | None => break None,
                Some(_) => {}
            }
        };
        RenderError::TooSmall { width, height, needed }
    }
}
