use super::frame_delta::FrameDelta;
use super::ordered_parallel_map::ordered_parallel_map;
use super::{AnimationSchedule, Frame, Metadata, Painter, Picture, RenderError, View, apng, compose, gif, png};
use std::io::Write;
use std::num::NonZero;

/// Writes one frame as a PNG file.
///
/// # Errors
/// If writing to `output` fails.
pub fn write_png(frame: &Frame, view: &View, metadata: &Metadata, output: impl Write) -> Result<(), RenderError> {
    png::encode(&Painter::new().draw(&compose(frame, view)), metadata, output)
}

/// Encodes each frame as a PNG file and passes its step and content to `output`, in order.
///
/// Frames are drawn and encoded on `threads` threads; the bytes do not depend on their number.
/// `metadata` returns the metadata of the file of a step.
///
/// # Errors
/// The first error of `frames` or of `output`.
pub fn write_png_sequence<E: From<RenderError>>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    metadata: impl Fn(u64) -> Metadata + Sync,
    threads: NonZero<usize>,
    mut output: impl FnMut(u64, Vec<u8>) -> Result<(), E>,
) -> Result<(), E> {
    let worker = || {
        let mut painter = Painter::new();
        let metadata = &metadata;
        move |frame: Frame| {
            let picture = painter.draw(&compose(&frame, view));
            let mut file = Vec::new();
            png::encode(&picture, &metadata(frame.step), &mut file).map(|()| (frame.step, file))
        }
    };
    ordered_parallel_map(frames, threads, worker, |result| {
        let (step, file) = result?;
        output(step, file)
    })
}

/// Draws frames on `threads` threads and passes the pictures to `output`, in order.
///
/// # Errors
/// The first error of `frames` or of `output`.
pub fn draw_frames<E>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    threads: NonZero<usize>,
    output: impl FnMut(Picture) -> Result<(), E>,
) -> Result<(), E> {
    let worker = || {
        let mut painter = Painter::new();
        move |frame: Frame| painter.draw(&compose(&frame, view))
    };
    ordered_parallel_map(frames, threads, worker, output)
}

/// Consecutive frames that one thread encodes. The frame before them is drawn once more to find the
/// difference of the first one.
const BATCH: usize = 16;

/// Writes frames as an endlessly repeating GIF animation.
///
/// `schedule` gives the display time of each frame. Frames are drawn on `threads` threads; the bytes do
/// not depend on their number. Memory use does not depend on the number of frames.
///
/// # Errors
/// The first error of `frames` or of writing to `output`.
pub fn write_gif<E: From<RenderError>>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    schedule: &AnimationSchedule,
    metadata: &Metadata,
    threads: NonZero<usize>,
    output: impl Write,
) -> Result<(), E> {
    let mut writer = gif::GifWriter::new(view.camera.size, metadata, output)?;
    let mut written = 0;
    let encode = |delta: FrameDelta| gif::EncodedFrame::new(&delta);
    encode_deltas(frames, view, threads, encode, |encoded| {
        writer.add(encoded, schedule.gif_delay(written))?;
        written += 1;
        Ok(())
    })?;
    Ok(writer.finish()?)
}

/// Writes frames as an endlessly repeating animated PNG, with exact colours and times.
///
/// `schedule` gives the number of frames and the display time of each. Threads and memory are as for
/// [`write_gif`].
///
/// # Errors
/// The first error of `frames` or of writing to `output`. Also if there are fewer frames than in the
/// schedule, because the file begins with their number.
pub fn write_apng<E: From<RenderError>>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    schedule: &AnimationSchedule,
    metadata: &Metadata,
    threads: NonZero<usize>,
    output: impl Write,
) -> Result<(), E> {
    let count = schedule.count();
    let mut writer = apng::ApngWriter::new(view.camera.size, count, metadata, output)?;
    let mut written = 0;
    let encode = |delta: FrameDelta| apng::EncodedFrame::new(&delta);
    encode_deltas(frames, view, threads, encode, |encoded| {
        writer.add(&encoded?, schedule.apng_delay(written))?;
        written += 1;
        Ok(())
    })?;
    Ok(writer.finish(count)?)
}

/// Draws frames and calls `encode` with the difference of each one to the previous one, both on several
/// threads, and passes the results to `output` in order.
fn encode_deltas<T: Send, E: From<RenderError>>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    threads: NonZero<usize>,
    encode: impl Fn(FrameDelta) -> T + Sync,
    mut output: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let worker = || {
        let mut painter = Painter::new();
        let encode = &encode;
        move |batch: Batch| batch.encode(view, &mut painter, encode)
    };
    ordered_parallel_map(batches(frames), threads, worker, |encoded| encoded.into_iter().try_for_each(&mut output))
}

/// Consecutive frames, and the frame before them unless they are the first.
struct Batch {
    previous: Option<Frame>,
    frames: Vec<Frame>,
}

impl Batch {
    /// Draws the frames and encodes the difference of each one to the previous one.
    fn encode<T>(&self, view: &View, painter: &mut Painter, encode: impl Fn(FrameDelta) -> T) -> Vec<T> {
        let mut draw = |frame: &Frame| painter.draw(&compose(frame, view));
        let mut previous: Option<Picture> = self.previous.as_ref().map(&mut draw);
        let mut encoded = Vec::with_capacity(self.frames.len());
        for frame in &self.frames {
            let picture = draw(frame);
            encoded.push(encode(FrameDelta::between(previous.as_ref(), &picture)));
            previous = Some(picture);
        }
        encoded
    }
}

/// Divides frames into batches of [`BATCH`] frames.
fn batches<E>(mut frames: impl Iterator<Item = Result<Frame, E>>) -> impl Iterator<Item = Result<Batch, E>> {
    let mut previous = None;
    std::iter::from_fn(move || {
        let batch: Result<Vec<Frame>, E> = frames.by_ref().take(BATCH).collect();
        let frames = match batch {
            Ok(frames) => frames,
            Err(error) => return Some(Err(error)),
        };
        let last = frames.last()?.clone();
        Some(Ok(Batch { previous: previous.replace(last), frames }))
    })
}
