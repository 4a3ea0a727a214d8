//! Pictures as PNG files.

use super::indexed::Indexed;
use super::{Metadata, Picture, RenderError};
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, Filter};
use std::io::Write;

/// Writes a picture as a PNG file; indexed when it has at most 256 colours.
///
/// # Errors
/// When `output` refuses.
pub fn encode(picture: &Picture, metadata: &Metadata, output: impl Write) -> Result<(), RenderError> {
    let [width, height] = picture.size;
    let mut encoder = Encoder::new(output, width, height);
    encoder.set_depth(BitDepth::Eight);
    // The one level whose bytes no other crate's choice of a deflate library can change.
    encoder.set_compression(Compression::Fast);
    for (key, value) in &metadata.entries {
        encoder.add_itxt_chunk(key.clone(), value.clone()).map_err(refusal)?;
    }
    match Indexed::exact(&picture.pixels) {
        Some(indexed) => {
            encoder.set_color(ColorType::Indexed);
            encoder.set_palette(rgb(&indexed.palette));
            encoder.set_filter(Filter::Up);
            finish(encoder, &indexed.pixels)
        }
        None => {
            encoder.set_color(ColorType::Rgb);
            encoder.set_filter(Filter::Up);
            finish(encoder, &rgb(&picture.pixels))
        }
    }
}

fn finish(encoder: Encoder<impl Write>, pixels: &[u8]) -> Result<(), RenderError> {
    let mut writer = encoder.write_header().map_err(refusal)?;
    writer.write_image_data(pixels).map_err(refusal)?;
    writer.finish().map_err(refusal)
}

fn rgb(pixels: &[[u8; 4]]) -> Vec<u8> {
    pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
}

fn refusal(error: EncodingError) -> RenderError {
    match error {
        EncodingError::IoError(error) => RenderError::Write(error),
        other => RenderError::Write(std::io::Error::other(other)),
    }
}
