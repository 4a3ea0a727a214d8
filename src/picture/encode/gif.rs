//! Writes GIF animations that repeat endlessly.

use super::lzw;
use crate::picture::encode::animation::{FrameDelta, UNCHANGED};
use crate::picture::encode::quantize::IndexedImage;
use crate::picture::{Metadata, RenderError};
use gif::{AnyExtension, DisposalMethod, Encoder, EncodingError, Extension, Frame, Repeat};
use std::borrow::Cow;
use std::io::Write;

/// Writes a GIF file, frame by frame.
pub struct GifWriter<W: Write> {
    encoder: Encoder<W>,
}

/// An encoded frame. Encoding takes most of the time and can be done on any thread.
pub struct EncodedFrame(Frame<'static>);

/// The longest delay of one GIF image, 1/100 s.
const MAX_DELAY: u64 = 65_535;

impl<W: Write> GifWriter<W> {
    /// Starts an endlessly repeating animation of `size` pixels.
    ///
    /// # Errors
    /// If writing to `output` fails.
    pub fn new(size: [u32; 2], metadata: &Metadata, output: W) -> Result<GifWriter<W>, RenderError> {
        let [width, height] = size.map(|side| side as u16);
        let mut encoder = Encoder::new(output, width, height, &[]).map_err(write_error)?;
        encoder.set_repeat(Repeat::Infinite).map_err(write_error)?;
        if !metadata.entries.is_empty() {
            let comment = AnyExtension::from(Extension::Comment);
            encoder.write_raw_extension(comment, &[metadata.to_string().as_bytes()]).map_err(write_error)?;
        }
        Ok(GifWriter { encoder })
    }

    /// Adds the next frame, shown for `delay` hundredths of a second. A delay that is too long for the
    /// format is divided among copies of the frame.
    ///
    /// # Errors
    /// If writing to the output fails.
    pub fn add(&mut self, encoded: EncodedFrame, delay: u64) -> Result<(), RenderError> {
        let mut frame = encoded.0;
        let mut remaining = delay;
        loop {
            frame.delay = if remaining < MAX_DELAY { remaining } else { MAX_DELAY } as u16;
            remaining -= u64::from(frame.delay);
            self.encoder.write_lzw_pre_encoded_frame(&frame).map_err(write_error)?;
            if remaining == 0 {
                return Ok(());
            }
        }
    }

    /// Finishes the file.
    ///
    /// # Errors
    /// If writing to the output fails.
    pub fn finish(self) -> Result<(), RenderError> {
        let mut output = self.encoder.into_inner().map_err(write_error)?;
        Ok(output.flush()?)
    }
}

impl EncodedFrame {
    /// Encodes the difference of a frame to the previous one.
    ///
    /// The result is exact if the difference has at most 256 colours, counting "unchanged" as one;
    /// otherwise the colours are quantized to 256.
    pub fn new(delta: &FrameDelta) -> EncodedFrame {
        let [[left, top], [width, height]] = [delta.at, delta.size].map(|pair| pair.map(|length| length as u16));
        let indexed = IndexedImage::exact(&delta.pixels).unwrap_or_else(|| IndexedImage::quantized(&delta.pixels));
        let unchanged = indexed.palette.iter().position(|&color| color == UNCHANGED);
        EncodedFrame(Frame {
            dispose: DisposalMethod::Keep,
            transparent: unchanged.map(|index| index as u8),
            left,
            top,
            width,
            height,
            palette: Some(indexed.palette.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()),
            buffer: Cow::Owned(lzw::compress(&indexed.pixels)),
            ..Frame::default()
        })
    }
}

/// Reads the metadata from the first comment of a GIF file, where [`GifWriter::new`] writes it.
pub fn metadata(file: &[u8]) -> Metadata {
    const EXTENSION: u8 = 0x21;
    const COMMENT: u8 = 0xfe;
    const SCREEN: usize = 13;
    let flags = file.get(10).copied().unwrap_or(0);
    let palette = if flags & 0x80 == 0 { 0 } else { 3 << ((flags & 7) + 1) };
    let mut rest = file.get(SCREEN + palette..).unwrap_or_default();
    while let [EXTENSION, label, blocks @ ..] = rest {
        let (content, after) = joined_blocks(blocks);
        if *label == COMMENT {
            return Metadata::parse(&String::from_utf8_lossy(&content));
        }
        rest = after;
    }
    Metadata::default()
}

/// The joined content of a series of length-prefixed sub-blocks, and the bytes after the series.
fn joined_blocks(mut rest: &[u8]) -> (Vec<u8>, &[u8]) {
    let mut content = Vec::new();
    while let [length, after @ ..] = rest {
        let Some((block, after)) = after.split_at_checked(usize::from(*length)) else { return (content, &[]) };
        content.extend(block);
        rest = after;
        if *length == 0 {
            break;
        }
    }
    (content, rest)
}

fn write_error(error: EncodingError) -> RenderError {
    match error {
        EncodingError::Io(error) => RenderError::Write(error),
        other => RenderError::Write(std::io::Error::other(other)),
    }
}
