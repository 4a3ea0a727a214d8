//! Pictures as PNG files.

use super::indexed::Indexed;
use super::{Metadata, Picture, RenderError};
use png::{
    BitDepth, ColorType, Compression, Decoder, DecodingError, Encoder, EncodingError, Filter, Info, Transformations,
};
use std::io::{BufRead, Seek, Write};

/// Writes a picture as a PNG file; indexed when it has at most 256 colours.
///
/// # Errors
/// When `output` refuses.
pub fn encode(picture: &Picture, metadata: &Metadata, output: impl Write) -> Result<(), RenderError> {
    match Indexed::exact(&picture.pixels) {
        Some(indexed) => {
            let mut encoder = encoder(picture.size, ColorType::Indexed, metadata, output)?;
            encoder.set_palette(rgb(&indexed.palette));
            finish(encoder, &indexed.pixels)
        }
        None => finish(encoder(picture.size, ColorType::Rgb, metadata, output)?, &rgb(&picture.pixels)),
    }
}

/// A PNG file with its metadata, ready for its pixels.
pub(super) fn encoder<'a, W: Write>(
    [width, height]: [u32; 2],
    color: ColorType,
    metadata: &Metadata,
    output: W,
) -> Result<Encoder<'a, W>, RenderError> {
    let mut encoder = Encoder::new(output, width, height);
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Eight);
    // The one level whose bytes no other crate's choice of a deflate library can change; it
    // looks for zeros, which most pixels are when those above them are taken away.
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Up);
    for (key, value) in &metadata.entries {
        encoder.add_itxt_chunk(key.clone(), value.clone()).map_err(refusal)?;
    }
    Ok(encoder)
}

/// Pixels a picture may have at most to be read: a damaged file may claim any size.
const MOST_PIXELS: usize = 1 << 26;

/// Reads a PNG file: its pixels, laid on white where they are not opaque, and its metadata.
///
/// # Errors
/// When `input` cannot be read or is no sound PNG file.
pub fn decode(input: impl BufRead + Seek) -> Result<(Picture, Metadata), RenderError> {
    let mut decoder = Decoder::new_with_limits(input, png::Limits { bytes: 4 * MOST_PIXELS });
    decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(unreadable)?;
    let size = reader.output_buffer_size().filter(|&size| size <= 4 * MOST_PIXELS);
    let size = size.ok_or_else(|| RenderError::Unreadable(format!("it claims more than {MOST_PIXELS} pixels")))?;
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes).map_err(unreadable)?;
    reader.finish().map_err(unreadable)?;
    let pixels = opaque(&bytes[..frame.buffer_size()], frame.color_type.samples());
    Ok((Picture { size: [frame.width, frame.height], pixels }, texts(reader.info())))
}

/// What a PNG file says of itself, its pixels unread.
///
/// # Errors
/// When `file` is no sound PNG file up to its pixels.
pub fn metadata(file: &[u8]) -> Result<Metadata, RenderError> {
    let decoder = Decoder::new_with_limits(std::io::Cursor::new(file), png::Limits { bytes: 4 * MOST_PIXELS });
    let reader = decoder.read_info().map_err(unreadable)?;
    Ok(texts(reader.info()))
}

/// Pixels of grey and alpha, or of red, green, blue and alpha, on white.
fn opaque(bytes: &[u8], samples: usize) -> Vec<[u8; 4]> {
    let on_white = |value: u8, alpha: u8| {
        let sum = u32::from(value) * u32::from(alpha) + 255 * (255 - u32::from(alpha));
        ((sum + 127) / 255) as u8
    };
    let pixel = |pixel: &[u8]| {
        let alpha = pixel[samples - 1];
        let [r, g, b] = if samples == 2 { [pixel[0]; 3] } else { [pixel[0], pixel[1], pixel[2]] };
        [on_white(r, alpha), on_white(g, alpha), on_white(b, alpha), 255]
    };
    bytes.chunks_exact(samples).map(pixel).collect()
}

fn texts(info: &Info) -> Metadata {
    let entries = info.utf8_text.iter().filter_map(|chunk| Some((chunk.keyword.clone(), chunk.get_text().ok()?)));
    Metadata { entries: entries.collect() }
}

fn unreadable(error: DecodingError) -> RenderError {
    match error {
        DecodingError::IoError(error) => RenderError::Read(error),
        other => RenderError::Unreadable(other.to_string()),
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

pub(super) fn refusal(error: EncodingError) -> RenderError {
    match error {
        EncodingError::IoError(error) => RenderError::Write(error),
        other => RenderError::Write(std::io::Error::other(other)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn shades(colors: u32) -> Picture {
        let pixels = (0..64 * 32).map(|at| [(at % colors) as u8, ((at % colors) >> 8) as u8, 7, 255]);
        Picture { size: [64, 32], pixels: pixels.collect() }
    }

    fn encoded(picture: &Picture) -> Vec<u8> {
        let mut file = Vec::new();
        encode(picture, &Metadata::default(), &mut file).unwrap();
        file
    }

    #[test]
    fn what_is_written_is_read() {
        for colors in [1, 2, 255, 256, 257, 1000] {
            let (picture, metadata) = decode(Cursor::new(encoded(&shades(colors)))).unwrap();
            assert_eq!(picture, shades(colors), "{colors} colours");
            assert_eq!(metadata, Metadata::default());
        }
    }

    #[test]
    fn up_to_256_colours_make_an_indexed_file() {
        let color_type = |colors| encoded(&shades(colors))[25];
        assert_eq!([color_type(256), color_type(257)], [ColorType::Indexed as u8, ColorType::Rgb as u8]);
    }

    #[test]
    fn metadata_goes_with_the_picture() {
        let entries = [("rebond steps", "0 to 600"), ("Title", "v⃗ = −Δx/Δt")];
        let metadata = Metadata { entries: entries.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec() };
        let mut file = Vec::new();
        encode(&shades(3), &metadata, &mut file).unwrap();
        assert_eq!(decode(Cursor::new(file)).unwrap().1, metadata);
    }

    #[test]
    fn a_damaged_file_is_an_error() {
        let file = encoded(&shades(300));
        for length in [0, 7, 20, file.len() / 2, file.len() - 20] {
            assert!(decode(Cursor::new(&file[..length])).is_err(), "{length} bytes");
        }
        let mut flipped = file.clone();
        flipped[60] ^= 1;
        assert!(decode(Cursor::new(flipped)).is_err());
    }

    #[test]
    fn a_file_that_claims_a_giant_picture_is_an_error() {
        let mut file = encoded(&shades(300));
        file[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        assert!(decode(Cursor::new(file)).is_err());
    }
}
