//! Writes animated PNG files that repeat endlessly, with exact colours and frame times.

use super::MAX_PIXELS;
use crate::picture::encode::animation::FrameDelta;
use crate::picture::{Metadata, RenderError, png as still};
use png::chunk::{ChunkType, IDAT, fcTL, fdAT};
use png::{BitDepth, ColorType, Compression, Decoder, Encoder, Filter, Writer};
use std::io::Write;

/// Writes an animated PNG file, frame by frame.
pub struct ApngWriter<W: Write> {
    writer: Writer<W>,
    /// The next sequence number of fcTL and fdAT chunks, which share one sequence.
    sequence: u32,
    /// Frames not yet added.
    remaining: u64,
}

/// An encoded frame. Encoding takes most of the time and can be done on any thread.
pub struct EncodedFrame {
    at: [u32; 2],
    size: [u32; 2],
    /// A zlib stream.
    data: Vec<u8>,
}

/// The display time of a frame as a fraction of a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Delay {
    /// The numerator: a number of ticks.
    pub ticks: u16,
    /// The denominator.
    pub ticks_per_second: u16,
}

impl<W: Write> ApngWriter<W> {
    /// Starts an endlessly repeating animation of `count` frames of `size` pixels.
    ///
    /// # Errors
    /// If `count` is 0 or too large for the format, or writing to `output` fails.
    pub fn new(size: [u32; 2], count: u64, metadata: &Metadata, output: W) -> Result<ApngWriter<W>, RenderError> {
        let frames = u32::try_from(count).map_err(|_| RenderError::PictureCount { expected: count, found: 0 })?;
        let mut encoder = still::encoder(size, ColorType::Rgba, metadata, output)?;
        encoder.set_animated(frames, 0).map_err(still::write_error)?;
        // The chunks are encoded elsewhere and written one by one.
        encoder.validate_sequence(false);
        let writer = encoder.write_header().map_err(still::write_error)?;
        Ok(ApngWriter { writer, sequence: 0, remaining: count })
    }

    /// Adds the next frame.
    ///
    /// # Errors
    /// If writing to the output fails.
    pub fn add(&mut self, frame: &EncodedFrame, delay: Delay) -> Result<(), RenderError> {
        let is_first = self.sequence == 0;
        let control = frame.control(self.next_sequence_number(), delay);
        self.write(fcTL, &control)?;
        self.remaining = self.remaining.saturating_sub(1);
        if is_first {
            return self.write(IDAT, &frame.data);
        }
        let mut data = self.next_sequence_number().to_be_bytes().to_vec();
        data.extend(&frame.data);
        self.write(fdAT, &data)
    }

    fn next_sequence_number(&mut self) -> u32 {
        self.sequence += 1;
        self.sequence - 1
    }

    fn write(&mut self, kind: ChunkType, data: &[u8]) -> Result<(), RenderError> {
        self.writer.write_chunk(kind, data).map_err(still::write_error)
    }

    /// Finishes the file. `count` is the number of frames given to [`ApngWriter::new`].
    ///
    /// # Errors
    /// If fewer than `count` frames were added, or writing to the output fails.
    pub fn finish(self, count: u64) -> Result<(), RenderError> {
        if self.remaining != 0 {
            return Err(RenderError::PictureCount { expected: count, found: count - self.remaining });
        }
        self.writer.finish().map_err(still::write_error)
    }
}

impl EncodedFrame {
    /// Encodes the difference of a frame to the previous one.
    ///
    /// # Errors
    /// If the encoder fails, which it does not when it writes to memory.
    pub fn new(delta: &FrameDelta) -> Result<EncodedFrame, RenderError> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, delta.size[0], delta.size[1]);
        encoder.set_color(ColorType::Rgba);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Fast);
        encoder.set_filter(Filter::Up);
        let mut writer = encoder.write_header().map_err(still::write_error)?;
        writer.write_image_data(delta.pixels.as_flattened()).map_err(still::write_error)?;
        writer.finish().map_err(still::write_error)?;
        Ok(EncodedFrame { at: delta.at, size: delta.size, data: image_data(&file) })
    }

    /// The content of the fcTL chunk: the frame is blended over the previous ones and kept.
    fn control(&self, number: u32, delay: Delay) -> Vec<u8> {
        const KEEP: u8 = 0;
        const OVER: u8 = 1;
        let rectangle = [number, self.size[0], self.size[1], self.at[0], self.at[1]];
        let delays = [delay.ticks, delay.ticks_per_second];
        let mut control: Vec<u8> = rectangle.iter().flat_map(|field| field.to_be_bytes()).collect();
        control.extend(delays.iter().flat_map(|delay| delay.to_be_bytes()));
        control.extend([KEEP, OVER]);
        control
    }
}

/// Returns true if a PNG file is animated: it has an animation control chunk before its pixels.
pub fn is_animated(file: &[u8]) -> bool {
    let decoder = Decoder::new_with_limits(std::io::Cursor::new(file), png::Limits { bytes: 4 * MAX_PIXELS });
    decoder.read_info().is_ok_and(|reader| reader.info().animation_control.is_some())
}

/// The joined content of the IDAT chunks of a PNG file.
fn image_data(file: &[u8]) -> Vec<u8> {
    const SIGNATURE: usize = 8;
    let mut data = Vec::new();
    let mut rest = &file[SIGNATURE..];
    while let Some((head, tail)) = rest.split_first_chunk::<8>() {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        if head[4..] == IDAT.0 {
            data.extend(&tail[..length]);
        }
        // A CRC of 4 bytes follows the content.
        rest = &tail[length + 4..];
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Picture;

    #[test]
    fn a_still_whose_caption_contains_the_name_of_the_chunk_is_not_an_animation() {
        let metadata = Metadata { entries: vec![("Caption".into(), "acTL".into())] };
        let picture = Picture { size: [2, 1], pixels: vec![[1, 2, 3, 255]; 2] };
        let (mut file, mut animation) = (Vec::new(), Vec::new());
        still::encode(&picture, &metadata, still::PngEffort::Small, &mut file).unwrap();
        assert!(file.windows(4).any(|bytes| bytes == b"acTL"));
        let mut writer = ApngWriter::new(picture.size, 1, &metadata, &mut animation).unwrap();
        let frame = EncodedFrame::new(&FrameDelta::between(None, &picture)).unwrap();
        writer.add(&frame, Delay { ticks: 1, ticks_per_second: 60 }).unwrap();
        writer.finish(1).unwrap();
        assert_eq!([is_animated(&file), is_animated(&animation), is_animated(b"acTL")], [false, true, false]);
    }
}
