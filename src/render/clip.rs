use super::{Frame, Metadata, RenderError, Sampling, View};
use std::io::Write;
use std::num::NonZero;

/// Writes frames as an endless GIF animation, each on screen at its own instant.
///
/// Frames are drawn on `threads` threads; the bytes do not depend on how many. Memory does
/// not grow with the number of frames.
///
/// # Errors
/// The first error of `frames`, or of the writer.
pub fn write_gif<E: From<RenderError>>(
    _frames: impl Iterator<Item = Result<Frame, E>> + Send,
    _view: &View,
    _sampling: &Sampling,
    _metadata: &Metadata,
    _threads: NonZero<usize>,
    _output: impl Write,
) -> Result<(), E> {
    todo!("first pictures follow")
}

/// Hands the step and the PNG file of each frame to `output`, in order.
///
/// Frames are drawn and encoded on `threads` threads; the bytes do not depend on how many.
/// `metadata` tells what is written into the file of a step.
///
/// # Errors
/// The first error of `frames` or of `output`.
pub fn write_png_sequence<E: From<RenderError>>(
    _frames: impl Iterator<Item = Result<Frame, E>> + Send,
    _view: &View,
    _metadata: impl Fn(u64) -> Metadata + Sync,
    _threads: NonZero<usize>,
    _output: impl FnMut(u64, Vec<u8>) -> Result<(), E>,
) -> Result<(), E> {
    todo!("first pictures follow")
}
