use super::{Picture, RenderError};
use gif::{ColorOutput, DecodeOptions, DisposalMethod, MemoryLimit};
use png::{BlendOp, Decoder, DisposeOp, FrameControl, Limits, Transformations};
use std::io::Cursor;

/// One picture of an animation as a viewer shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exposure {
    /// What is seen, on white where the file is transparent.
    pub picture: Picture,
    /// How long: a number of parts of a second.
    pub parts: u32,
    /// Of which so many make a second.
    pub per_second: u32,
}

impl Exposure {
    /// Whether it is seen as long as another, however that is written.
    pub fn is_as_long_as(&self, other: &Exposure) -> bool {
        let [ours, theirs] =
            [(self, other), (other, self)].map(|(one, two)| u64::from(one.parts) * u64::from(two.per_second));
        ours == theirs
    }
}

/// Shows the pictures of a GIF or (animated) PNG file one after the other, whoever wrote it.
pub enum Projector<'a> {
    /// Of a GIF file.
    Gif(Box<gif::Decoder<&'a [u8]>>, Screen),
    /// Of a PNG file, and how many pictures are still to come.
    Png(Box<png::Reader<Cursor<&'a [u8]>>>, Screen, u32),
}

/// Pixels a picture may have at most: a damaged file may claim any size.
const MOST_PIXELS: u64 = 1 << 26;

impl<'a> Projector<'a> {
    /// For the file with that content.
    ///
    /// # Errors
    /// When it is neither, or damaged at its start.
    pub fn new(file: &'a [u8]) -> Result<Projector<'a>, RenderError> {
        if file.starts_with(b"GIF8") { Projector::gif(file) } else { Projector::png(file) }
    }

    fn gif(file: &'a [u8]) -> Result<Projector<'a>, RenderError> {
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::RGBA);
        options.check_frame_consistency(true);
        options.set_memory_limit(MemoryLimit::Bytes((4 * MOST_PIXELS).try_into().expect("not zero")));
        let decoder = options.read_info(file).map_err(unreadable)?;
        let screen = Screen::new([decoder.width().into(), decoder.height().into()])?;
        Ok(Projector::Gif(Box::new(decoder), screen))
    }

    fn png(file: &'a [u8]) -> Result<Projector<'a>, RenderError> {
        let limits = Limits { bytes: 4 * MOST_PIXELS as usize };
        let mut decoder = Decoder::new_with_limits(Cursor::new(file), limits);
        decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
        let reader = decoder.read_info().map_err(unreadable)?;
        let screen = Screen::new([reader.info().width, reader.info().height])?;
        let count = reader.info().animation_control.map_or(1, |control| control.num_frames);
        Ok(Projector::Png(Box::new(reader), screen, count))
    }

    fn exposure(&mut self) -> Result<Option<Exposure>, RenderError> {
        match self {
            Projector::Gif(decoder, screen) => {
                let Some(frame) = decoder.read_next_frame().map_err(unreadable)? else { return Ok(None) };
                let place = Place::new([frame.left, frame.top, frame.width, frame.height].map(u32::from));
                let after = match frame.dispose {
                    DisposalMethod::Any | DisposalMethod::Keep => After::Keep,
                    DisposalMethod::Background => After::Clear,
                    DisposalMethod::Previous => After::Restore,
                };
                let picture = screen.show(place, frame.buffer.as_chunks().0, after)?;
                Ok(Some(Exposure { picture, parts: frame.delay.into(), per_second: 100 }))
            }
            Projector::Png(_, _, 0) => Ok(None),
            Projector::Png(reader, screen, left) => {
                *left -= 1;
                png_exposure(reader, screen).map(Some)
            }
        }
    }
}

impl Iterator for Projector<'_> {
    type Item = Result<Exposure, RenderError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.exposure().transpose()
    }
}

fn png_exposure(reader: &mut png::Reader<Cursor<&[u8]>>, screen: &mut Screen) -> Result<Exposure, RenderError> {
    let most = 4 * screen.picture.pixels.len();
    let mut bytes = vec![0; reader.output_buffer_size().filter(|&size| size <= most).unwrap_or(most)];
    let frame = reader.next_frame(&mut bytes).map_err(unreadable)?;
    let samples = frame.color_type.samples();
    let control = reader.info().frame_control.unwrap_or(FrameControl {
        width: frame.width,
        height: frame.height,
        ..FrameControl::default()
    });
    let is_laid_over = control.blend_op == BlendOp::Over && reader.info().animation_control.is_some();
    let pixels: Vec<[u8; 4]> = bytes[..frame.buffer_size()].chunks_exact(samples).map(rgba).collect();
    // What replaces is laid on white, which whatever is transparent is seen on.
    let pixels = if is_laid_over { pixels } else { pixels.into_iter().map(|pixel| over(pixel, WHITE)).collect() };
    let after = match control.dispose_op {
        DisposeOp::None => After::Keep,
        DisposeOp::Background => After::Clear,
        DisposeOp::Previous => After::Restore,
    };
    let place = Place::new([control.x_offset, control.y_offset, control.width, control.height]);
    let picture = screen.show(place, &pixels, after)?;
    let per_second = if control.delay_den == 0 { 100 } else { control.delay_den.into() };
    Ok(Exposure { picture, parts: control.delay_num.into(), per_second })
}

/// Grey and alpha, or red, green, blue and alpha.
fn rgba(samples: &[u8]) -> [u8; 4] {
    match *samples {
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b, alpha] => [r, g, b, alpha],
        _ => WHITE,
    }
}

/// What is seen of all pictures up to now.
pub struct Screen {
    picture: Picture,
    /// What the next picture is laid on.
    ground: Vec<[u8; 4]>,
}

const WHITE: [u8; 4] = [255; 4];

/// Where on the screen a picture is laid, px.
#[derive(Clone, Copy)]
struct Place {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Place {
    fn new(numbers: [u32; 4]) -> Place {
        let [left, top, width, height] = numbers.map(|number| number as usize);
        Place { left, top, width, height }
    }
}

/// What becomes of a picture when the next one comes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum After {
    Keep,
    Clear,
    Restore,
}

impl Screen {
    fn new(size: [u32; 2]) -> Result<Screen, RenderError> {
        let count = u64::from(size[0]) * u64::from(size[1]);
        if !(1..=MOST_PIXELS).contains(&count) {
            return Err(RenderError::Unreadable(format!("it claims {}×{} pixels", size[0], size[1])));
        }
        let ground = vec![WHITE; count as usize];
        Ok(Screen { picture: Picture { size, pixels: ground.clone() }, ground })
    }

    fn show(&mut self, place: Place, pixels: &[[u8; 4]], after: After) -> Result<Picture, RenderError> {
        let [width, height] = self.picture.size.map(|side| side as usize);
        if place.left + place.width > width || place.top + place.height > height {
            return Err(RenderError::Unreadable("a picture of it leaves the screen".into()));
        }
        self.picture.pixels.copy_from_slice(&self.ground);
        let rows = pixels.chunks_exact(place.width.max(1)).take(place.height);
        for (row, from) in rows.enumerate() {
            let start = (place.top + row) * width + place.left;
            for (to, from) in self.picture.pixels[start..][..place.width].iter_mut().zip(from) {
                *to = over(*from, *to);
            }
        }
        match after {
            After::Keep => self.ground.copy_from_slice(&self.picture.pixels),
            After::Restore => {}
            After::Clear => {
                for row in place.top..place.top + place.height {
                    self.ground[row * width + place.left..][..place.width].fill(WHITE);
                }
            }
        }
        Ok(self.picture.clone())
    }
}

/// A pixel laid on an opaque one.
fn over([r, g, b, alpha]: [u8; 4], below: [u8; 4]) -> [u8; 4] {
    let mixed = |value: u8, below: u8| {
        let sum = u32::from(value) * u32::from(alpha) + u32::from(below) * (255 - u32::from(alpha));
        ((sum + 127) / 255) as u8
    };
    [mixed(r, below[0]), mixed(g, below[1]), mixed(b, below[2]), 255]
}

fn unreadable(error: impl std::fmt::Display) -> RenderError {
    RenderError::Unreadable(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Metadata;
    use crate::render::png::encode;

    fn encoded(picture: &Picture) -> Vec<u8> {
        let mut file = Vec::new();
        encode(picture, &Metadata::default(), &mut file).unwrap();
        file
    }

    #[test]
    fn a_still_is_one_exposure() {
        let picture = Picture { size: [2, 1], pixels: vec![[1, 2, 3, 255], [4, 5, 6, 255]] };
        let file = encoded(&picture);
        let shown: Vec<Exposure> = Projector::new(&file).unwrap().map(Result::unwrap).collect();
        assert_eq!(shown.len(), 1);
        assert_eq!(shown[0].picture, picture);
    }

    #[test]
    fn what_is_laid_over_and_cleared_is_seen_so() {
        let mut screen = Screen::new([2, 2]).unwrap();
        let whole = Place::new([0, 0, 2, 2]);
        let corner = Place::new([1, 1, 1, 1]);
        let (red, black, none) = ([255, 0, 0, 255], [0, 0, 0, 255], [0; 4]);
        screen.show(whole, &[red; 4], After::Keep).unwrap();
        assert_eq!(screen.show(corner, &[black], After::Restore).unwrap().pixels, [red, red, red, black]);
        assert_eq!(screen.show(corner, &[none], After::Clear).unwrap().pixels, [red; 4]);
        assert_eq!(screen.show(corner, &[none], After::Keep).unwrap().pixels, [red, red, red, WHITE]);
        assert!(screen.show(Place::new([1, 1, 2, 1]), &[red; 2], After::Keep).is_err());
    }

    #[test]
    fn half_a_file_is_an_error_and_no_crash() {
        let file = encoded(&Picture { size: [9, 9], pixels: vec![[7, 7, 7, 255]; 81] });
        for length in 0..file.len() - 12 {
            let seen = Projector::new(&file[..length]).map(|shown| shown.collect::<Result<Vec<_>, _>>());
            assert!(!matches!(seen, Ok(Ok(shown)) if shown.is_empty()), "{length}");
        }
        assert!(Projector::new(b"GIF89a").is_err());
    }

    #[test]
    fn times_are_compared_as_fractions() {
        let exposure =
            |parts, per_second| Exposure { picture: Picture { size: [1, 1], pixels: vec![WHITE] }, parts, per_second };
        assert!(exposure(1, 50).is_as_long_as(&exposure(2, 100)));
        assert!(!exposure(1, 60).is_as_long_as(&exposure(2, 100)));
    }
}
