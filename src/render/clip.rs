use super::in_order::in_order;
use super::patch::Patch;
use super::{Frame, Metadata, Painter, Picture, RenderError, Timeline, View, apng, compose, gif, png};
use std::io::Write;
use std::num::NonZero;

/// Writes one frame as a PNG file.
///
/// # Errors
/// When `output` refuses.
pub fn write_png(frame: &Frame, view: &View, metadata: &Metadata, output: impl Write) -> Result<(), RenderError> {
    png::encode(&Painter::new().draw(&compose(frame, view)), metadata, output)
}

/// Hands the step and the PNG file of each frame to `output`, in order.
///
/// Frames are drawn and encoded on `threads` threads; the bytes do not depend on how many.
/// `metadata` tells what is written into the file of a step.
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
    in_order(frames, threads, worker, |result| {
        let (step, file) = result?;
        output(step, file)
    })
}

/// Hands the picture of each frame to `output`, in order, drawn on `threads` threads.
///
/// # Errors
/// The first error of `frames` or of `output`.
pub fn draw_each<E>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    threads: NonZero<usize>,
    output: impl FnMut(Picture) -> Result<(), E>,
) -> Result<(), E> {
    let worker = || {
        let mut painter = Painter::new();
        move |frame: Frame| painter.draw(&compose(&frame, view))
    };
    in_order(frames, threads, worker, output)
}

/// Frames that one thread draws in a row; the one before them is drawn again to know what
/// changes.
const BATCH: usize = 16;

/// Writes frames as an endless GIF animation, each on screen at its own instant.
///
/// `timeline` says how long each is shown. Frames are
/// drawn on `threads` threads; the bytes do not depend on how many. Memory does not grow with
/// the number of frames.
///
/// # Errors
/// The first error of `frames`, or of the writer.
pub fn write_gif<E: From<RenderError>>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    timeline: &Timeline,
    metadata: &Metadata,
    threads: NonZero<usize>,
    output: impl Write,
) -> Result<(), E> {
    let mut animation = gif::Animation::new(view.camera.size, metadata, output)?;
    let mut shown = 0;
    let compress = |patch: Patch| gif::Compressed::new(&patch);
    each_change(frames, view, threads, compress, |picture| {
        animation.add(picture, timeline.delay(shown))?;
        shown += 1;
        Ok(())
    })?;
    Ok(animation.finish()?)
}

/// Writes frames as an endless animated PNG, with every colour and every instant exact.
///
/// `timeline` says how many frames there are and how long each is shown. Threads and memory are as for [`write_gif`].
///
/// # Errors
/// The first error of `frames`, or of the writer; and when there are fewer frames than the
/// timeline says, which stands at the beginning of the file.
pub fn write_apng<E: From<RenderError>>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    timeline: &Timeline,
    metadata: &Metadata,
    threads: NonZero<usize>,
    output: impl Write,
) -> Result<(), E> {
    let count = timeline.count();
    let mut animation = apng::Animation::new(view.camera.size, count, metadata, output)?;
    let mut shown = 0;
    let compress = |patch: Patch| apng::Compressed::new(&patch);
    each_change(frames, view, threads, compress, |picture| {
        animation.add(&picture?, timeline.exact_delay(shown))?;
        shown += 1;
        Ok(())
    })?;
    Ok(animation.finish(count)?)
}

/// Draws frames on several threads, does `compress` there on what changes from each to the
/// next, and hands the results to `output` in order.
fn each_change<T: Send, E: From<RenderError>>(
    frames: impl Iterator<Item = Result<Frame, E>>,
    view: &View,
    threads: NonZero<usize>,
    compress: impl Fn(Patch) -> T + Sync,
    mut output: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let worker = || {
        let mut painter = Painter::new();
        let compress = &compress;
        move |batch: Batch| batch.changes(view, &mut painter, compress)
    };
    in_order(batches(frames), threads, worker, |changes| changes.into_iter().try_for_each(&mut output))
}

/// Frames in a row, and the one before them unless they are the first.
struct Batch {
    before: Option<Frame>,
    frames: Vec<Frame>,
}

impl Batch {
    fn changes<T>(&self, view: &View, painter: &mut Painter, compress: impl Fn(Patch) -> T) -> Vec<T> {
        let mut draw = |frame: &Frame| painter.draw(&compose(frame, view));
        let mut before: Option<Picture> = self.before.as_ref().map(&mut draw);
        let mut changes = Vec::with_capacity(self.frames.len());
        for frame in &self.frames {
            let picture = draw(frame);
            changes.push(compress(Patch::between(before.as_ref(), &picture)));
            before = Some(picture);
        }
        changes
    }
}

fn batches<E>(mut frames: impl Iterator<Item = Result<Frame, E>>) -> impl Iterator<Item = Result<Batch, E>> {
    let mut before = None;
    std::iter::from_fn(move || {
        let batch: Result<Vec<Frame>, E> = frames.by_ref().take(BATCH).collect();
        let frames = match batch {
            Ok(frames) => frames,
            Err(error) => return Some(Err(error)),
        };
        let last = frames.last()?.clone();
        Some(Ok(Batch { before: before.replace(last), frames }))
    })
}
