use super::Error;
use crate::render::{DisplayList, Metadata, Painter, RenderError, apng, gif, pdf, png, svg};
use std::io::Write;
use std::path::Path;

/// The file format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A raster picture.
    Png,
    /// A vector picture.
    Svg,
    /// A vector picture, one page.
    Pdf,
    /// An animation of at most 256 colours per frame and 50 frames per second.
    Gif,
    /// An animated PNG, with exact colours and times.
    Apng,
}

impl Format {
    /// The format indicated by the extension of a path.
    pub fn from_path(path: &Path) -> Option<Format> {
        match path.extension()?.to_str()? {
            "png" => Some(Format::Png),
            "svg" => Some(Format::Svg),
            "pdf" => Some(Format::Pdf),
            "gif" => Some(Format::Gif),
            "apng" => Some(Format::Apng),
            _ => None,
        }
    }

    /// The format of a file, from its first bytes.
    pub fn from_content(file: &[u8]) -> Option<Format> {
        let starts_with = |magic: &[u8]| file.starts_with(magic);
        match () {
            () if starts_with(b"\x89PNG") && apng::is_animated(file) => Some(Format::Apng),
            () if starts_with(b"\x89PNG") => Some(Format::Png),
            () if starts_with(b"GIF8") => Some(Format::Gif),
            () if starts_with(b"%PDF") => Some(Format::Pdf),
            () if starts_with(b"<svg") || starts_with(b"<?xml") => Some(Format::Svg),
            () => None,
        }
    }

    /// The name of the format for messages.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Png => "PNG",
            Format::Svg => "SVG",
            Format::Pdf => "PDF",
            Format::Gif => "GIF",
            Format::Apng => "animated PNG",
        }
    }

    /// Returns true for formats of animations.
    pub const fn is_animated(self) -> bool {
        match self {
            Format::Gif | Format::Apng => true,
            Format::Png | Format::Svg | Format::Pdf => false,
        }
    }

    /// Reads the metadata of a file of this format.
    ///
    /// # Errors
    /// If the file is damaged.
    pub fn metadata(self, file: &[u8]) -> Result<Metadata, Error> {
        match self {
            Format::Png | Format::Apng => Ok(png::metadata(file)?),
            Format::Gif => Ok(gif::metadata(file)),
            Format::Svg => Ok(svg::metadata(file)),
            Format::Pdf => Ok(pdf::metadata(file)),
        }
    }

    /// Writes one picture. Animated formats write it as a still PNG.
    ///
    /// # Errors
    /// If writing to `output` fails.
    pub fn write(self, list: &DisplayList, metadata: &Metadata, output: &mut dyn Write) -> Result<(), RenderError> {
        match self {
            Format::Png | Format::Gif | Format::Apng => png::encode(&Painter::new().draw(list), metadata, output),
            Format::Svg => svg::encode(list, metadata, output),
            Format::Pdf => pdf::encode(list, metadata, output),
        }
    }
}
