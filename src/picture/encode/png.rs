//! Reads and writes PNG files.

use super::MAX_PIXELS;
use crate::picture::encode::quantize::IndexedImage;
use crate::picture::raster::color::blend;
use crate::picture::{Bitmap, Metadata, Picture, RenderError};
use crate::recording::limits;
use miniz_oxide::deflate::compress_to_vec_zlib;
use png::{
    BitDepth, ColorType, Compression, Decoder, DecodingError, Encoder, EncodingError, Filter, Info, PixelDimensions,
    Transformations, Unit, chunk::IDAT, text_metadata::ITXtChunk,
};
use std::io::{BufRead, Cursor, Seek, Write};

/// The effort of compressing a PNG file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PngEffort {
    /// For one of many pictures: 960×540 pixels in about a millisecond.
    Fast,
    /// For a single picture: 2.5 to 4.5 times smaller, in about ten times as long.
    Small,
}

/// Writes a picture as a PNG file, with a palette if it has at most 256 colours.
///
/// # Errors
/// If writing to `output` fails.
pub fn encode(
    picture: &Picture,
    metadata: &Metadata,
    effort: PngEffort,
    output: impl Write,
) -> Result<(), RenderError> {
    match IndexedImage::exact(&picture.pixels) {
        Some(indexed) => {
            let mut encoder = encoder(picture.size, ColorType::Indexed, metadata, output)?;
            encoder.set_palette(rgb(&indexed.palette));
            finish(encoder, &indexed.pixels, picture.size, effort)
        }
        None => {
            let encoder = encoder(picture.size, ColorType::Rgb, metadata, output)?;
            finish(encoder, &rgb(&picture.pixels), picture.size, effort)
        }
    }
}

/// The resolution of pictures in print, as in SVG and PDF: 96 pixels per inch.
const PIXELS_PER_METRE: u32 = 3780;

/// An encoder with size, colour type and metadata set.
pub(super) fn encoder<'a, W: Write>(
    [width, height]: [u32; 2],
    color: ColorType,
    metadata: &Metadata,
    output: W,
) -> Result<Encoder<'a, W>, RenderError> {
    let mut encoder = Encoder::new(output, width, height);
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_pixel_dims(Some(PixelDimensions { xppu: PIXELS_PER_METRE, yppu: PIXELS_PER_METRE, unit: Unit::Meter }));
    for (key, value) in &metadata.entries {
        encoder.add_itxt_chunk(key.clone(), value.clone()).map_err(write_error)?;
    }
    Ok(encoder)
}

/// Reads the pixels of a PNG file, blended over white, and its metadata.
///
/// # Errors
/// If `input` cannot be read or is not a valid PNG file.
pub fn decode(input: impl BufRead + Seek) -> Result<(Picture, Metadata), RenderError> {
    let mut decoder = Decoder::new_with_limits(input, png::Limits { bytes: 4 * MAX_PIXELS });
    decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(read_error)?;
    let size = reader.output_buffer_size().filter(|&size| size <= 4 * MAX_PIXELS);
    let size = size.ok_or_else(|| RenderError::Unreadable(format!("it declares more than {MAX_PIXELS} pixels")))?;
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes).map_err(read_error)?;
    reader.finish().map_err(read_error)?;
    let samples = bytes[..frame.buffer_size()].chunks_exact(frame.color_type.samples());
    let pixels = samples.map(|samples| over(rgba(samples), WHITE)).collect();
    Ok((Picture { size: [frame.width, frame.height], pixels }, text_chunks(reader.info())))
}

/// Reads the pixels of an image for boxes, with their opacity: of an animation the first picture.
///
/// # Errors
/// A description of the problem if the file is damaged, has too many pixels along a side, or is no PNG file.
pub fn decode_bitmap(file: &[u8]) -> Result<Bitmap, String> {
    const MAX_BYTES: usize = 4 * limits::IMAGES_PIXELS as usize;
    let mut decoder = Decoder::new_with_limits(Cursor::new(file), png::Limits { bytes: 2 * MAX_BYTES });
    decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let unreadable = |error: DecodingError| format!("it is not a valid PNG file: {error}");
    let mut reader = decoder.read_info().map_err(unreadable)?;
    let size @ [width, height] = [reader.info().width, reader.info().height];
    if size.iter().any(|side| *side > limits::IMAGE_SIDE)
        || u64::from(width) * u64::from(height) > limits::IMAGES_PIXELS
    {
        return Err(format!(
            "it has {width} × {height} pixels, but at most {} along each side and {} in all are allowed",
            limits::IMAGE_SIDE,
            limits::IMAGES_PIXELS
        ));
    }
    let bytes = reader.output_buffer_size().ok_or_else(|| "it has too many pixels".to_owned())?;
    let mut samples = vec![0; bytes];
    let frame = reader.next_frame(&mut samples).map_err(unreadable)?;
    let pixels = samples[..frame.buffer_size()].chunks_exact(frame.color_type.samples()).map(rgba).collect();
    Ok(Bitmap { size: [frame.width, frame.height], pixels })
}

/// Writes an image for boxes as a PNG file.
pub(super) fn encode_bitmap(bitmap: &Bitmap) -> Result<Vec<u8>, RenderError> {
    let mut file = Vec::new();
    let encoder = encoder(bitmap.size, ColorType::Rgba, &Metadata::default(), &mut file)?;
    finish(encoder, bitmap.pixels.as_flattened(), bitmap.size, PngEffort::Small)?;
    Ok(file)
}

/// Reads the metadata of a PNG file without its pixels.
///
/// # Errors
/// If `file` is not a valid PNG file up to its pixels.
pub fn metadata(file: &[u8]) -> Result<Metadata, RenderError> {
    let decoder = Decoder::new_with_limits(Cursor::new(file), png::Limits { bytes: 4 * MAX_PIXELS });
    let reader = decoder.read_info().map_err(read_error)?;
    Ok(text_chunks(reader.info()))
}

/// The background of every picture.
pub(super) const WHITE: [u8; 4] = [255; 4];

/// Converts grey and alpha, or red, green, blue and alpha.
pub(super) fn rgba(samples: &[u8]) -> [u8; 4] {
    match *samples {
        [gray, alpha] => [gray, gray, gray, alpha],
        [r, g, b, alpha] => [r, g, b, alpha],
        _ => WHITE,
    }
}

/// Blends a pixel over an opaque one.
pub(super) fn over([r, g, b, alpha]: [u8; 4], below: [u8; 4]) -> [u8; 4] {
    let blended = |below, over| blend(below, over, alpha.into(), 255);
    [blended(below[0], r), blended(below[1], g), blended(below[2], b), 255]
}

/// The largest size of a text that is compressed, bytes. Pictures are written with texts that are not.
const MAX_COMPRESSED_TEXT: usize = 16 << 20;

fn text_chunks(info: &Info) -> Metadata {
    let entry = |chunk: &ITXtChunk| {
        let mut chunk = chunk.clone();
        chunk.decompress_text_with_limit(MAX_COMPRESSED_TEXT).ok()?;
        Some((chunk.keyword.clone(), chunk.get_text().ok()?))
    };
    Metadata { entries: info.utf8_text.iter().filter_map(entry).collect() }
}

fn read_error(error: DecodingError) -> RenderError {
    match error {
        DecodingError::IoError(error) => RenderError::Read(error),
        other => RenderError::Unreadable(other.to_string()),
    }
}

/// Writes the samples of all pixels. No level depends on the deflate library that other crates select.
fn finish(
    mut encoder: Encoder<impl Write>,
    samples: &[u8],
    [_, height]: [u32; 2],
    effort: PngEffort,
) -> Result<(), RenderError> {
    // This level is made for runs of zeros, which most pixels become under the Up filter.
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Up);
    let mut writer = encoder.write_header().map_err(write_error)?;
    match effort {
        PngEffort::Fast => writer.write_image_data(samples).map_err(write_error)?,
        PngEffort::Small => {
            // Without a filter: drawings consist of areas of one colour and of repeated glyphs, in which the
            // compression finds more than a filter leaves.
            const NO_FILTER: [u8; 1] = [0];
            const LEVEL: u8 = 9;
            let rows = samples.chunks_exact(samples.len() / height as usize);
            let filtered: Vec<u8> = rows.flat_map(|row| NO_FILTER.iter().chain(row)).copied().collect();
            writer.write_chunk(IDAT, &compress_to_vec_zlib(&filtered, LEVEL)).map_err(write_error)?;
        }
    }
    writer.finish().map_err(write_error)
}

fn rgb(pixels: &[[u8; 4]]) -> Vec<u8> {
    pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
}

pub(super) fn write_error(error: EncodingError) -> RenderError {
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

    /// A small file may hold a text of any length.
    #[test]
    fn a_compressed_text_is_read_up_to_a_limit() {
        for (length, is_read) in [(MAX_COMPRESSED_TEXT, true), (MAX_COMPRESSED_TEXT + 1, false)] {
            let text = compress_to_vec_zlib(&vec![b' '; length], 9);
            let body = [b"iTXtkey\0\x01\0\0\0", text.as_slice()].concat();
            let checksum = crc32fast::hash(&body).to_be_bytes();
            let chunk = [&(body.len() as u32 - 4).to_be_bytes()[..], &body, &checksum].concat();
            let mut file = encoded(&shades(2));
            const AFTER_HEADER: usize = 8 + 12 + 13;
            file.splice(AFTER_HEADER..AFTER_HEADER, chunk);
            let found = metadata(&file).unwrap().entries;
            assert_eq!(found.iter().any(|(key, text)| key == "key" && text.len() == length), is_read, "{length}");
        }
    }

    fn encoded(picture: &Picture) -> Vec<u8> {
        let mut file = Vec::new();
        encode(picture, &Metadata::default(), PngEffort::Small, &mut file).unwrap();
        file
    }

    #[test]
    fn every_effort_gives_the_same_pixels_and_a_single_picture_is_not_larger() {
        for colors in [2, 200, 1000] {
            let [small, fast] = [PngEffort::Small, PngEffort::Fast].map(|effort| {
                let mut file = Vec::new();
                encode(&shades(colors), &Metadata::default(), effort, &mut file).unwrap();
                assert_eq!(decode(Cursor::new(&file)).unwrap().0, shades(colors), "{colors} colours");
                file.len()
            });
            assert!(small <= fast, "{colors} colours: {small} and {fast} bytes");
        }
    }

    #[test]
    fn a_written_picture_is_read_back() {
        for colors in [1, 2, 255, 256, 257, 1000] {
            let (picture, metadata) = decode(Cursor::new(encoded(&shades(colors)))).unwrap();
            assert_eq!(picture, shades(colors), "{colors} colours");
            assert_eq!(metadata, Metadata::default());
        }
    }

    #[test]
    fn up_to_256_colors_are_written_with_a_palette() {
        let color_type = |colors| encoded(&shades(colors))[25];
        assert_eq!([color_type(256), color_type(257)], [ColorType::Indexed as u8, ColorType::Rgb as u8]);
    }

    #[test]
    fn a_picture_is_printed_at_96_pixels_per_inch() {
        let file = encoded(&shades(3));
        let reader = Decoder::new(Cursor::new(file)).read_info().unwrap();
        let dimensions = reader.info().pixel_dims.unwrap();
        assert_eq!((dimensions.xppu, dimensions.yppu, dimensions.unit), (3780, 3780, Unit::Meter));
    }

    #[test]
    fn metadata_is_read_back() {
        let entries = [("rebond steps", "0 to 600"), ("Title", "v⃗ = −Δx/Δt")];
        let metadata = Metadata { entries: entries.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec() };
        let mut file = Vec::new();
        encode(&shades(3), &metadata, PngEffort::Small, &mut file).unwrap();
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
    fn a_file_that_declares_a_giant_picture_is_an_error() {
        let mut file = encoded(&shades(300));
        file[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        assert!(decode(Cursor::new(file)).is_err());
    }
}
