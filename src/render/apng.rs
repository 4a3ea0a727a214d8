//! Pictures as an endless animated PNG: no colour is lost, and 60 frames a second are 60.

use super::patch::Patch;
use super::{Metadata, RenderError, png as still};
use png::chunk::{ChunkType, IDAT, acTL, fcTL, fdAT};
use png::{BitDepth, ColorType, Compression, Encoder, Filter, Writer};
use std::io::Write;

/// An animated PNG file being written, picture by picture.
pub struct Animation<W: Write> {
    writer: Writer<W>,
    /// Numbers fcTL and fdAT chunks together.
    sequence: u32,
    /// Pictures still to come.
    left: u64,
}

/// One picture of an animation, compressed: what takes the time, and any thread can do.
pub struct Compressed {
    at: [u32; 2],
    size: [u32; 2],
    /// A zlib stream.
    data: Vec<u8>,
}

/// How long a picture is shown: a number of parts of a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Delay {
    /// How many.
    pub parts: u16,
    /// Of which so many make a second.
    pub per_second: u16,
}

impl<W: Write> Animation<W> {
    /// Begins an animation of `count` pictures of that many pixels that starts over for ever.
    ///
    /// # Errors
    /// When there are no pictures or more than fit into the format, or `output` refuses.
    pub fn new(size: [u32; 2], count: u64, metadata: &Metadata, output: W) -> Result<Animation<W>, RenderError> {
        let frames = u32::try_from(count).map_err(|_| RenderError::PictureCount { expected: count, found: 0 })?;
        let mut encoder = still::encoder(size, ColorType::Rgba, metadata, output)?;
        encoder.set_animated(frames, 0).map_err(still::refusal)?;
        // The chunks of the pictures are written one by one, compressed elsewhere.
        encoder.validate_sequence(false);
        let writer = encoder.write_header().map_err(still::refusal)?;
        Ok(Animation { writer, sequence: 0, left: count })
    }

    /// Shows the next picture.
    ///
    /// # Errors
    /// When the output refuses.
    pub fn add(&mut self, picture: &Compressed, delay: Delay) -> Result<(), RenderError> {
        let is_first = self.sequence == 0;
        let control = picture.control(self.next_number(), delay);
        self.write(fcTL, &control)?;
        self.left = self.left.saturating_sub(1);
        if is_first {
            return self.write(IDAT, &picture.data);
        }
        let mut data = self.next_number().to_be_bytes().to_vec();
        data.extend(&picture.data);
        self.write(fdAT, &data)
    }

    fn next_number(&mut self) -> u32 {
        self.sequence += 1;
        self.sequence - 1
    }

    fn write(&mut self, kind: ChunkType, data: &[u8]) -> Result<(), RenderError> {
        self.writer.write_chunk(kind, data).map_err(still::refusal)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When fewer pictures came than were announced, or the output refuses.
    pub fn finish(self, count: u64) -> Result<(), RenderError> {
        if self.left != 0 {
            return Err(RenderError::PictureCount { expected: count, found: count - self.left });
        }
        self.writer.finish().map_err(still::refusal)
    }
}

impl Compressed {
    /// Compresses what of a picture differs from the one before it.
    ///
    /// # Errors
    /// None that a memory buffer can have.
    pub fn new(patch: &Patch) -> Result<Compressed, RenderError> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, patch.size[0], patch.size[1]);
        encoder.set_color(ColorType::Rgba);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Fast);
        encoder.set_filter(Filter::Up);
        let mut writer = encoder.write_header().map_err(still::refusal)?;
        writer.write_image_data(patch.pixels.as_flattened()).map_err(still::refusal)?;
        writer.finish().map_err(still::refusal)?;
        Ok(Compressed { at: patch.at, size: patch.size, data: image_data(&file) })
    }

    /// The content of an fcTL chunk: the picture is laid over what is there, and stays.
    fn control(&self, number: u32, delay: Delay) -> Vec<u8> {
        const KEEP: u8 = 0;
        const OVER: u8 = 1;
        let places = [number, self.size[0], self.size[1], self.at[0], self.at[1]];
        let delays = [delay.parts, delay.per_second];
        let mut control: Vec<u8> = places.iter().flat_map(|place| place.to_be_bytes()).collect();
        control.extend(delays.iter().flat_map(|delay| delay.to_be_bytes()));
        control.extend([KEEP, OVER]);
        control
    }
}

/// Whether a PNG file begins like an animation: with an acTL chunk before its first pixels.
pub fn is_animated(file: &[u8]) -> bool {
    let find = |kind: ChunkType| file.windows(4).position(|bytes| bytes == kind.0);
    find(acTL).is_some_and(|control| find(IDAT).is_none_or(|data| control < data))
}

/// The IDAT chunks of a PNG file, joined.
fn image_data(file: &[u8]) -> Vec<u8> {
    const SIGNATURE: usize = 8;
    let mut data = Vec::new();
    let mut rest = &file[SIGNATURE..];
    while let Some((head, tail)) = rest.split_first_chunk::<8>() {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        if head[4..] == IDAT.0 {
            data.extend(&tail[..length]);
        }
        // After the content stands a checksum of 4 bytes.
        rest = &tail[length + 4..];
    }
    data
}
