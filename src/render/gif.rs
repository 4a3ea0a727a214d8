//! Pictures as an endless GIF animation.

use super::indexed::Indexed;
use super::patch::{Patch, UNCHANGED};
use super::{Metadata, RenderError, lzw};
use gif::{AnyExtension, DisposalMethod, Encoder, EncodingError, Extension, Frame, Repeat};
use std::borrow::Cow;
use std::io::Write;

/// A GIF file being written, picture by picture.
pub struct Animation<W: Write> {
    encoder: Encoder<W>,
}

/// One picture of an animation, compressed: what takes the time, and any thread can do.
pub struct Compressed(Frame<'static>);

/// The longest a GIF can show one image, 1/100 s.
const LONGEST_DELAY: u64 = 65_535;

impl<W: Write> Animation<W> {
    /// Begins an animation of that many pixels that starts over for ever.
    ///
    /// # Errors
    /// When `output` refuses.
    pub fn new(size: [u32; 2], metadata: &Metadata, output: W) -> Result<Animation<W>, RenderError> {
        let [width, height] = size.map(|side| side as u16);
        let mut encoder = Encoder::new(output, width, height, &[]).map_err(refusal)?;
        encoder.set_repeat(Repeat::Infinite).map_err(refusal)?;
        if !metadata.entries.is_empty() {
            let comment = AnyExtension::from(Extension::Comment);
            encoder.write_raw_extension(comment, &[metadata.to_string().as_bytes()]).map_err(refusal)?;
        }
        Ok(Animation { encoder })
    }

    /// Shows the next picture for `delay` hundredths of a second.
    ///
    /// # Errors
    /// When the output refuses.
    pub fn add(&mut self, picture: Compressed, delay: u64) -> Result<(), RenderError> {
        let mut frame = picture.0;
        let mut left = delay;
        loop {
            frame.delay = if left < LONGEST_DELAY { left } else { LONGEST_DELAY } as u16;
            left -= u64::from(frame.delay);
            self.encoder.write_lzw_pre_encoded_frame(&frame).map_err(refusal)?;
            if left == 0 {
                return Ok(());
            }
        }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When the output refuses.
    pub fn finish(self) -> Result<(), RenderError> {
        let mut output = self.encoder.into_inner().map_err(refusal)?;
        Ok(output.flush()?)
    }
}

impl Compressed {
    /// Compresses what of a picture differs from the one before it.
    ///
    /// Exact when that has at most 256 colours, leaving a pixel as it was counted as one; else
    /// each pixel takes the nearest of 256.
    pub fn new(patch: &Patch) -> Compressed {
        let [[left, top], [width, height]] = [patch.at, patch.size].map(|pair| pair.map(|length| length as u16));
        let indexed = Indexed::exact(&patch.pixels).unwrap_or_else(|| Indexed::nearest(&patch.pixels));
        let unchanged = indexed.palette.iter().position(|&color| color == UNCHANGED);
        Compressed(Frame {
            dispose: DisposalMethod::Keep,
            transparent: unchanged.map(|place| place as u8),
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

/// What a GIF file says of itself in its first comment, as [`Animation::new`] writes it.
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

/// The content of a row of blocks, each with its length before it, and what follows the row.
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

fn refusal(error: EncodingError) -> RenderError {
    match error {
        EncodingError::Io(error) => RenderError::Write(error),
        other => RenderError::Write(std::io::Error::other(other)),
    }
}
