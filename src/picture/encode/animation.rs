use super::ordered_parallel_map::ordered_parallel_map;
use super::png::PngEffort;
use crate::picture::{
    AnimationSchedule, Frame, Instant, Metadata, Painter, Picture, RenderError, Stage, View, apng, compose, gif, png,
};
use std::io::Write;
use std::num::NonZero;

/// Writes one frame as a PNG file.
///
/// # Errors
/// If writing to `output` fails.
pub fn write_png(frame: &Frame, view: &View, metadata: &Metadata, output: impl Write) -> Result<(), RenderError> {
    png::encode(&Painter::new().draw(&compose(frame, view)), metadata, PngEffort::Small, output)
}

/// Encodes each instant as a PNG file and passes its step and content to `output`, in order.
///
/// Instants are drawn and encoded on `threads` threads; the bytes do not depend on their number.
/// `metadata` returns the metadata of the file of a step.
///
/// # Errors
/// The first error of `instants` or of `output`.
pub fn write_png_sequence<E: From<RenderError>>(
    instants: impl Iterator<Item = Result<Instant, E>>,
    stage: &Stage,
    metadata: impl Fn(u64) -> Metadata + Sync,
    threads: NonZero<usize>,
    mut output: impl FnMut(u64, Vec<u8>) -> Result<(), E>,
) -> Result<(), E> {
    let worker = || {
        let mut painter = Painter::new();
        let metadata = &metadata;
        move |instant: Instant| {
            let picture = painter.draw(&stage.compose(&instant));
            let mut file = Vec::new();
            png::encode(&picture, &metadata(instant.step), PngEffort::Fast, &mut file).map(|()| (instant.step, file))
        }
    };
    ordered_parallel_map(instants, threads, worker, |result| {
        let (step, file) = result?;
        output(step, file)
    })
}

/// Draws instants on `threads` threads and passes the pictures to `output`, in order.
///
/// # Errors
/// The first error of `instants` or of `output`.
pub fn draw_frames<E>(
    instants: impl Iterator<Item = Result<Instant, E>>,
    stage: &Stage,
    threads: NonZero<usize>,
    output: impl FnMut(Picture) -> Result<(), E>,
) -> Result<(), E> {
    let worker = || {
        let mut painter = Painter::new();
        move |instant: Instant| painter.draw(&stage.compose(&instant))
    };
    ordered_parallel_map(instants, threads, worker, output)
}

/// Consecutive frames that one thread encodes. The frame before them is drawn once more to find the
/// difference of the first one.
const BATCH: usize = 16;

/// The number of bodies and collisions after which a batch has no further frame, so that the memory of the queued
/// batches is bounded for crowded frames, too.
const BATCH_ITEMS: usize = 20_000;

/// Writes instants as an endlessly repeating GIF animation.
///
/// `schedule` gives the display time of each frame. Frames are drawn on `threads` threads; the bytes do
/// not depend on their number. Memory use does not depend on the number of frames.
///
/// # Errors
/// The first error of `instants` or of writing to `output`.
pub fn write_gif<E: From<RenderError>>(
    instants: impl Iterator<Item = Result<Instant, E>>,
    stage: &Stage,
    schedule: &AnimationSchedule,
    metadata: &Metadata,
    threads: NonZero<usize>,
    output: impl Write,
) -> Result<(), E> {
    let mut writer = gif::GifWriter::new(stage.size(), metadata, output)?;
    let mut written = 0;
    let encode = |delta: FrameDelta| gif::EncodedFrame::new(&delta);
    encode_deltas(instants, stage, threads, encode, |encoded| {
        writer.add(encoded, schedule.gif_delay(written))?;
        written += 1;
        Ok(())
    })?;
    Ok(writer.finish()?)
}

/// Writes instants as an endlessly repeating animated PNG, with exact colours and times.
///
/// `schedule` gives the number of frames and the display time of each. Threads and memory are as for
/// [`write_gif`].
///
/// # Errors
/// The first error of `instants` or of writing to `output`. Also if there are fewer frames than in the
/// schedule, because the file begins with their number.
pub fn write_apng<E: From<RenderError>>(
    instants: impl Iterator<Item = Result<Instant, E>>,
    stage: &Stage,
    schedule: &AnimationSchedule,
    metadata: &Metadata,
    threads: NonZero<usize>,
    output: impl Write,
) -> Result<(), E> {
    let count = schedule.count();
    let mut writer = apng::ApngWriter::new(stage.size(), count, metadata, output)?;
    let mut written = 0;
    let encode = |delta: FrameDelta| apng::EncodedFrame::new(&delta);
    encode_deltas(instants, stage, threads, encode, |encoded| {
        writer.add(&encoded?, schedule.apng_delay(written))?;
        written += 1;
        Ok(())
    })?;
    Ok(writer.finish(count)?)
}

/// Draws frames and calls `encode` with the difference of each one to the previous one, both on several
/// threads, and passes the results to `output` in order.
fn encode_deltas<T: Send, E: From<RenderError>>(
    instants: impl Iterator<Item = Result<Instant, E>>,
    stage: &Stage,
    threads: NonZero<usize>,
    encode: impl Fn(FrameDelta) -> T + Sync,
    mut output: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let worker = || {
        let mut painter = Painter::new();
        let encode = &encode;
        move |batch: Batch| batch.encode(stage, &mut painter, encode)
    };
    ordered_parallel_map(batches(instants), threads, worker, |encoded| encoded.into_iter().try_for_each(&mut output))
}

/// Consecutive instants, and the one before them unless they are the first.
struct Batch {
    previous: Option<Instant>,
    instants: Vec<Instant>,
}

impl Batch {
    /// Draws the instants and encodes the difference of each one to the previous one.
    fn encode<T>(&self, stage: &Stage, painter: &mut Painter, encode: impl Fn(FrameDelta) -> T) -> Vec<T> {
        let mut draw = |instant: &Instant| painter.draw(&stage.compose(instant));
        let mut previous: Option<Picture> = self.previous.as_ref().map(&mut draw);
        let mut encoded = Vec::with_capacity(self.instants.len());
        for instant in &self.instants {
            let picture = draw(instant);
            encoded.push(encode(FrameDelta::between(previous.as_ref(), &picture)));
            previous = Some(picture);
        }
        encoded
    }
}

/// Divides instants into batches of at most [`BATCH`], fewer if these have many bodies or collisions.
fn batches<E>(mut instants: impl Iterator<Item = Result<Instant, E>>) -> impl Iterator<Item = Result<Batch, E>> {
    let mut previous = None;
    std::iter::from_fn(move || {
        let (mut batch, mut items) = (Vec::new(), 0);
        while batch.len() < BATCH && items < BATCH_ITEMS {
            match instants.next() {
                Some(Ok(instant)) => {
                    items += instant.frames().map(|frame| frame.sprites.len() + frame.collisions.len()).sum::<usize>();
                    batch.push(instant);
                }
                Some(Err(error)) => return Some(Err(error)),
                None => break,
            }
        }
        let last = batch.last()?.clone();
        Some(Ok(Batch { previous: previous.replace(last), instants: batch }))
    })
}

/// The difference of a picture to the previous one: the bounding rectangle of all changed pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameDelta {
    /// The upper-left corner of the rectangle in the picture, px.
    pub at: [u32; 2],
    /// Width and height, px.
    pub size: [u32; 2],
    /// The new pixels row by row; [`UNCHANGED`] where a pixel keeps its value.
    pub pixels: Vec<[u8; 4]>,
}

/// Marks a pixel that does not change. Pixels of pictures are opaque and never have this value.
pub const UNCHANGED: [u8; 4] = [0; 4];

impl FrameDelta {
    /// The difference of `after` to `before`, which has the same size, or all of `after` if there is no
    /// previous picture.
    pub fn between(before: Option<&Picture>, after: &Picture) -> FrameDelta {
        let Some(before) = before else {
            return FrameDelta { at: [0, 0], size: after.size, pixels: after.pixels.clone() };
        };
        let Some(area) = changed_area(before, after) else { return FrameDelta::unchanged() };
        let width = after.size[0] as usize;
        let mut pixels = Vec::with_capacity((area.right - area.left) * (area.bottom - area.top));
        for row in area.top..area.bottom {
            let span = row * width + area.left..row * width + area.right;
            let both = before.pixels[span.clone()].iter().zip(&after.pixels[span]);
            pixels.extend(both.map(|(before, after)| if before == after { UNCHANGED } else { *after }));
        }
        let at = [area.left, area.top].map(|at| at as u32);
        let size = [area.right - area.left, area.bottom - area.top].map(|side| side as u32);
        FrameDelta { at, size, pixels }
    }

    /// One unchanged pixel, because every frame of an animation needs an image.
    fn unchanged() -> FrameDelta {
        FrameDelta { at: [0, 0], size: [1, 1], pixels: vec![UNCHANGED] }
    }
}

/// A rectangle of pixels; `right` and `bottom` are exclusive.
struct Area {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

/// The bounding rectangle of all differing pixels.
fn changed_area(before: &Picture, after: &Picture) -> Option<Area> {
    let mut changed: Option<Area> = None;
    for (row, (a, b)) in before.rows().zip(after.rows()).enumerate() {
        let Some([left, right]) = changed_columns(a, b) else { continue };
        let area = changed.unwrap_or(Area { left, top: row, right, bottom: row });
        changed = Some(Area { left: area.left.min(left), right: area.right.max(right), bottom: row + 1, ..area });
    }
    changed
}

/// The first column in which two rows differ, and the one after the last such column.
fn changed_columns(a: &[[u8; 4]], b: &[[u8; 4]]) -> Option<[usize; 2]> {
    if a == b {
        return None;
    }
    let first = a.iter().zip(b).position(|(a, b)| a != b)?;
    let last = a.iter().zip(b).rposition(|(a, b)| a != b)?;
    Some([first, last + 1])
}
