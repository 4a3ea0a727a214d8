use super::MAX_PIXELS;
use super::png::{WHITE, over, rgba};
use crate::picture::{Picture, RenderError};
use gif::{ColorOutput, DecodeOptions, DisposalMethod, MemoryLimit};
use png::{BlendOp, Decoder, DisposeOp, FrameControl, Limits, Transformations};
use std::io::Cursor;

/// A frame of an animation as a viewer shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodedFrame {
    /// The composited picture, over white where the file is transparent.
    pub picture: Picture,
    /// The display time, in ticks.
    pub ticks: u32,
    /// Ticks per second.
    pub ticks_per_second: u32,
}

impl DecodedFrame {
    /// Returns true if both frames have the same display time, also in different units.
    pub fn has_same_duration_as(&self, other: &DecodedFrame) -> bool {
        u64::from(self.ticks) * u64::from(other.ticks_per_second)
            == u64::from(other.ticks) * u64::from(self.ticks_per_second)
    }
}

/// Decodes and composites the frames of a GIF, PNG or animated PNG file from any encoder, in order.
pub enum AnimationDecoder<'a> {
    /// The decoder of a GIF file.
    Gif(Box<gif::Decoder<&'a [u8]>>, Compositor),
    /// The decoder of a PNG file, and the number of remaining frames.
    Png(Box<png::Reader<Cursor<&'a [u8]>>>, Compositor, u32),
}

impl<'a> AnimationDecoder<'a> {
    /// Starts decoding `file`.
    ///
    /// # Errors
    /// If it is neither a GIF nor a PNG file, or its header is damaged.
    pub fn new(file: &'a [u8]) -> Result<AnimationDecoder<'a>, RenderError> {
        if file.starts_with(b"GIF8") { AnimationDecoder::gif(file) } else { AnimationDecoder::png(file) }
    }

    fn gif(file: &'a [u8]) -> Result<AnimationDecoder<'a>, RenderError> {
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::RGBA);
        options.check_frame_consistency(true);
        options.set_memory_limit(MemoryLimit::Bytes((4 * MAX_PIXELS as u64).try_into().expect("not zero")));
        let decoder = options.read_info(file).map_err(read_error)?;
        let compositor = Compositor::new([decoder.width().into(), decoder.height().into()])?;
        Ok(AnimationDecoder::Gif(Box::new(decoder), compositor))
    }

    fn png(file: &'a [u8]) -> Result<AnimationDecoder<'a>, RenderError> {
        let limits = Limits { bytes: 4 * MAX_PIXELS };
        let mut decoder = Decoder::new_with_limits(Cursor::new(file), limits);
        decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
        let reader = decoder.read_info().map_err(read_error)?;
        let compositor = Compositor::new([reader.info().width, reader.info().height])?;
        let count = reader.info().animation_control.map_or(1, |control| control.num_frames);
        Ok(AnimationDecoder::Png(Box::new(reader), compositor, count))
    }

    fn decode_frame(&mut self) -> Result<Option<DecodedFrame>, RenderError> {
        match self {
            AnimationDecoder::Gif(decoder, compositor) => {
                let Some(frame) = decoder.read_next_frame().map_err(read_error)? else { return Ok(None) };
                let area = Area::new([frame.left, frame.top, frame.width, frame.height].map(u32::from));
                let disposal = match frame.dispose {
                    DisposalMethod::Any | DisposalMethod::Keep => Disposal::Keep,
                    DisposalMethod::Background => Disposal::Clear,
                    DisposalMethod::Previous => Disposal::Restore,
                };
                let picture = compositor.draw(area, frame.buffer.as_chunks().0, disposal)?;
                Ok(Some(DecodedFrame { picture, ticks: frame.delay.into(), ticks_per_second: 100 }))
            }
            AnimationDecoder::Png(_, _, 0) => Ok(None),
            AnimationDecoder::Png(reader, compositor, remaining) => {
                *remaining -= 1;
                decode_png_frame(reader, compositor).map(Some)
            }
        }
    }
}

impl Iterator for AnimationDecoder<'_> {
    type Item = Result<DecodedFrame, RenderError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.decode_frame().transpose()
    }
}

fn decode_png_frame(
    reader: &mut png::Reader<Cursor<&[u8]>>,
    compositor: &mut Compositor,
) -> Result<DecodedFrame, RenderError> {
    let max = 4 * compositor.picture.pixels.len();
    let mut bytes = vec![0; reader.output_buffer_size().filter(|&size| size <= max).unwrap_or(max)];
    let frame = reader.next_frame(&mut bytes).map_err(read_error)?;
    let samples = frame.color_type.samples();
    let control = reader.info().frame_control.unwrap_or(FrameControl {
        width: frame.width,
        height: frame.height,
        ..FrameControl::default()
    });
    let is_blended = control.blend_op == BlendOp::Over && reader.info().animation_control.is_some();
    let pixels: Vec<[u8; 4]> = bytes[..frame.buffer_size()].chunks_exact(samples).map(rgba).collect();
    // Pixels that replace others are blended over white, the background of every picture.
    let pixels = if is_blended { pixels } else { pixels.into_iter().map(|pixel| over(pixel, WHITE)).collect() };
    let disposal = match control.dispose_op {
        DisposeOp::None => Disposal::Keep,
        DisposeOp::Background => Disposal::Clear,
        DisposeOp::Previous => Disposal::Restore,
    };
    let area = Area::new([control.x_offset, control.y_offset, control.width, control.height]);
    let picture = compositor.draw(area, &pixels, disposal)?;
    let ticks_per_second = if control.delay_den == 0 { 100 } else { control.delay_den.into() };
    Ok(DecodedFrame { picture, ticks: control.delay_num.into(), ticks_per_second })
}

/// Composites frames in order.
pub struct Compositor {
    picture: Picture,
    /// The pixels that the next frame is blended over.
    base: Vec<[u8; 4]>,
}

/// The part of the picture that a frame covers, px.
#[derive(Clone, Copy)]
struct Area {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Area {
    fn new(left_top_width_height: [u32; 4]) -> Area {
        let [left, top, width, height] = left_top_width_height.map(|length| length as usize);
        Area { left, top, width, height }
    }
}

/// The treatment of a frame's area before the next frame is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Disposal {
    /// The frame stays.
    Keep,
    /// The area is cleared.
    Clear,
    /// The area is restored to its content before the frame.
    Restore,
}

impl Compositor {
    fn new(size: [u32; 2]) -> Result<Compositor, RenderError> {
        let count = u64::from(size[0]) * u64::from(size[1]);
        if !(1..=MAX_PIXELS as u64).contains(&count) {
            return Err(RenderError::Unreadable(format!("it declares {}×{} pixels", size[0], size[1])));
        }
        let base = vec![WHITE; count as usize];
        Ok(Compositor { picture: Picture { size, pixels: base.clone() }, base })
    }

    /// Draws a frame over the base and returns the resulting picture.
    fn draw(&mut self, area: Area, pixels: &[[u8; 4]], disposal: Disposal) -> Result<Picture, RenderError> {
        let [width, height] = self.picture.size.map(|side| side as usize);
        if area.left + area.width > width || area.top + area.height > height {
            return Err(RenderError::Unreadable("a frame exceeds the size of the animation".into()));
        }
        self.picture.pixels.copy_from_slice(&self.base);
        let rows = pixels.chunks_exact(area.width.max(1)).take(area.height);
        for (row, from) in rows.enumerate() {
            let start = (area.top + row) * width + area.left;
            for (to, from) in self.picture.pixels[start..][..area.width].iter_mut().zip(from) {
                *to = over(*from, *to);
            }
        }
        match disposal {
            Disposal::Keep => self.base.copy_from_slice(&self.picture.pixels),
            Disposal::Restore => {}
            Disposal::Clear => {
                for row in area.top..area.top + area.height {
                    self.base[row * width + area.left..][..area.width].fill(WHITE);
                }
            }
        }
        Ok(self.picture.clone())
    }
}

fn read_error(error: impl std::fmt::Display) -> RenderError {
    RenderError::Unreadable(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Metadata;
    use crate::picture::encode::png::{PngEffort, encode};

    fn encoded(picture: &Picture) -> Vec<u8> {
        let mut file = Vec::new();
        encode(picture, &Metadata::default(), PngEffort::Small, &mut file).unwrap();
        file
    }

    #[test]
    fn a_still_picture_is_one_frame() {
        let picture = Picture { size: [2, 1], pixels: vec![[1, 2, 3, 255], [4, 5, 6, 255]] };
        let file = encoded(&picture);
        let frames: Vec<DecodedFrame> = AnimationDecoder::new(&file).unwrap().map(Result::unwrap).collect();
        assert_eq!(frames.len(), 1);
        assert_eq!(frames[0].picture, picture);
    }

    #[test]
    fn frames_are_blended_and_disposed_of_as_the_format_says() {
        let mut compositor = Compositor::new([2, 2]).unwrap();
        let whole = Area::new([0, 0, 2, 2]);
        let corner = Area::new([1, 1, 1, 1]);
        let (red, black, none) = ([255, 0, 0, 255], [0, 0, 0, 255], [0; 4]);
        compositor.draw(whole, &[red; 4], Disposal::Keep).unwrap();
        assert_eq!(compositor.draw(corner, &[black], Disposal::Restore).unwrap().pixels, [red, red, red, black]);
        assert_eq!(compositor.draw(corner, &[none], Disposal::Clear).unwrap().pixels, [red; 4]);
        assert_eq!(compositor.draw(corner, &[none], Disposal::Keep).unwrap().pixels, [red, red, red, WHITE]);
        assert!(compositor.draw(Area::new([1, 1, 2, 1]), &[red; 2], Disposal::Keep).is_err());
    }

    #[test]
    fn a_cut_file_is_an_error() {
        let file = encoded(&Picture { size: [9, 9], pixels: vec![[7, 7, 7, 255]; 81] });
        for length in 0..file.len() - 12 {
            let decoded = AnimationDecoder::new(&file[..length]).map(|frames| frames.collect::<Result<Vec<_>, _>>());
            assert!(!matches!(decoded, Ok(Ok(frames)) if frames.is_empty()), "{length}");
        }
        assert!(AnimationDecoder::new(b"GIF89a").is_err());
    }

    #[test]
    fn display_times_are_compared_as_fractions() {
        let frame = |ticks, ticks_per_second| {
            let picture = Picture { size: [1, 1], pixels: vec![WHITE] };
            DecodedFrame { picture, ticks, ticks_per_second }
        };
        assert!(frame(1, 50).has_same_duration_as(&frame(2, 100)));
        assert!(!frame(1, 60).has_same_duration_as(&frame(2, 100)));
    }
}
