use super::Error;
use crate::render::{DisplayList, Metadata, Painter, RenderError, apng, gif, pdf, png, svg};
use std::io::Write;
use std::path::Path;

/// What an illustration is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One picture of pixels.
    Png,
    /// One picture of shapes.
    Svg,
    /// One page of shapes.
    Pdf,
    /// An animation of at most 256 colours a picture and 50 pictures a second.
    Gif,
    /// An animation with every colour and every instant exact.
    Apng,
}

impl Format {
    /// The format that the name of a file asks for.
    pub fn of_name(path: &Path) -> Option<Format> {
        match path.extension()?.to_str()? {
            "png" => Some(Format::Png),
            "svg" => Some(Format::Svg),
            "pdf" => Some(Format::Pdf),
            "gif" => Some(Format::Gif),
            "apng" => Some(Format::Apng),
            _ => None,
        }
    }

    /// The format of a file with this content.
    pub fn of_content(file: &[u8]) -> Option<Format> {
        let begins = |magic: &[u8]| file.starts_with(magic);
        match () {
            () if begins(b"\x89PNG") && apng::is_animated(file) => Some(Format::Apng),
            () if begins(b"\x89PNG") => Some(Format::Png),
            () if begins(b"GIF8") => Some(Format::Gif),
            () if begins(b"%PDF") => Some(Format::Pdf),
            () if begins(b"<svg") || begins(b"<?xml") => Some(Format::Svg),
            () => None,
        }
    }

    /// Its name, as people write it.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Png => "PNG",
            Format::Svg => "SVG",
            Format::Pdf => "PDF",
            Format::Gif => "GIF",
            Format::Apng => "animated PNG",
        }
    }

    /// Whether it is an animation.
    pub const fn is_animated(self) -> bool {
        match self {
            Format::Gif | Format::Apng => true,
            Format::Png | Format::Svg | Format::Pdf => false,
        }
    }

    /// What a file of this format says of itself.
    ///
    /// # Errors
    /// When it is damaged.
    pub fn metadata(self, file: &[u8]) -> Result<Metadata, Error> {
        match self {
            Format::Png | Format::Apng => Ok(png::metadata(file)?),
            Format::Gif => Ok(gif::metadata(file)),
            Format::Svg => Ok(svg::metadata(file)),
            Format::Pdf => Ok(pdf::metadata(file)),
        }
    }

    /// Writes one picture.
    ///
    /// # Errors
    /// When the output takes no more.
    pub fn write(self, list: &DisplayList, metadata: &Metadata, output: &mut dyn Write) -> Result<(), RenderError> {
        match self {
            Format::Png | Format::Gif | Format::Apng => png::encode(&Painter::new().draw(list), metadata, output),
            Format::Svg => svg::encode(list, metadata, output),
            Format::Pdf => pdf::encode(list, metadata, output),
        }
    }
}
