use super::encode::{PngEffort, apng, gif, pdf, png, svg};
use super::{DisplayList, MAX_GIF_FPS, Metadata, Painter, RenderError, TextAs};
use std::io::Write;
use std::path::Path;

/// The file format of a picture or an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One page.
    Still(StillFormat),
    /// An animation.
    Animation(AnimationFormat),
}

/// The file format of one page.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StillFormat {
    /// A raster picture.
    Png,
    /// A vector picture.
    Svg,
    /// A vector picture, one page.
    Pdf,
}

/// The file format of an animation.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    /// At most 256 colours per frame and 50 frames per second.
    Gif,
    /// An animated PNG, with exact colours and times.
    Apng,
}

impl Format {
    /// The format indicated by the extension of a path.
    pub fn from_path(path: &Path) -> Option<Format> {
        match path.extension()?.to_str()? {
            "png" => Some(Format::Still(StillFormat::Png)),
            "svg" => Some(Format::Still(StillFormat::Svg)),
            "pdf" => Some(Format::Still(StillFormat::Pdf)),
            "gif" => Some(Format::Animation(AnimationFormat::Gif)),
            "apng" => Some(Format::Animation(AnimationFormat::Apng)),
            _ => None,
        }
    }

    /// The format of a file, from its first bytes.
    pub fn from_content(file: &[u8]) -> Option<Format> {
        let starts_with = |magic: &[u8]| file.starts_with(magic);
        match () {
            () if starts_with(b"\x89PNG") && apng::is_animated(file) => Some(Format::Animation(AnimationFormat::Apng)),
            () if starts_with(b"\x89PNG") => Some(Format::Still(StillFormat::Png)),
            () if starts_with(b"GIF8") => Some(Format::Animation(AnimationFormat::Gif)),
            () if starts_with(b"%PDF") => Some(Format::Still(StillFormat::Pdf)),
            () if starts_with(b"<svg") || starts_with(b"<?xml") => Some(Format::Still(StillFormat::Svg)),
            () => None,
        }
    }

    /// The name of the format for messages.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Still(StillFormat::Png) => "PNG",
            Format::Still(StillFormat::Svg) => "SVG",
            Format::Still(StillFormat::Pdf) => "PDF",
            Format::Animation(AnimationFormat::Gif) => "GIF",
            Format::Animation(AnimationFormat::Apng) => "animated PNG",
        }
    }

    /// Returns true for vector formats, false for raster formats.
    pub const fn is_vector(self) -> bool {
        matches!(self, Format::Still(StillFormat::Svg | StillFormat::Pdf))
    }

    /// Reads the metadata of a file of this format.
    ///
    /// # Errors
    /// If the file is damaged.
    pub fn metadata(self, file: &[u8]) -> Result<Metadata, RenderError> {
        match self {
            Format::Still(StillFormat::Png) | Format::Animation(AnimationFormat::Apng) => png::metadata(file),
            Format::Still(StillFormat::Svg) => Ok(svg::metadata(file)),
            Format::Still(StillFormat::Pdf) => Ok(pdf::metadata(file)),
            Format::Animation(AnimationFormat::Gif) => Ok(gif::metadata(file)),
        }
    }
}

impl StillFormat {
    /// The format indicated by the extension of a path.
    pub fn from_path(path: &Path) -> Option<StillFormat> {
        match Format::from_path(path)? {
            Format::Still(format) => Some(format),
            Format::Animation(_) => None,
        }
    }

    /// Writes one page. `text` is the form of text in SVG, `effort` that of compressing PNG.
    ///
    /// # Errors
    /// If writing to `output` fails.
    pub fn write(
        self,
        list: &DisplayList,
        metadata: &Metadata,
        text: TextAs,
        effort: PngEffort,
        output: &mut dyn Write,
    ) -> Result<(), RenderError> {
        match self {
            StillFormat::Png => png::encode(&Painter::new().draw(list), metadata, effort, output),
            StillFormat::Svg => svg::encode(list, metadata, text, output),
            StillFormat::Pdf => pdf::encode(list, metadata, output),
        }
    }
}

impl AnimationFormat {
    /// The highest frame rate, frames per second; infinite if unlimited.
    pub const fn max_fps(self) -> f64 {
        match self {
            AnimationFormat::Gif => MAX_GIF_FPS,
            AnimationFormat::Apng => f64::INFINITY,
        }
    }
}
