//! MP4 and WebM: frames are drawn here and compressed by the user's own ffmpeg.

use super::arguments::OutputOptions;
use super::error::CommandError;
use super::kind::Container;
use super::{Exit, damage, output};
use crate::illustration::{self, Evidence, Progress, Source};
use crate::render::{Picture, Timeline, View, draw_each};
use std::io::{self, BufWriter, Read, Write};
use std::num::NonZero;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// The program, as it is found on the PATH.
const FFMPEG: &str = "ffmpeg";

/// Refuses early what would be refused after all the work.
pub fn refuse_without_ffmpeg(path: &Path) -> Result<(), CommandError> {
    let mut asked = Command::new(FFMPEG);
    asked.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    match asked.status() {
        Ok(_) => Ok(()),
        Err(source) => Err(CommandError::NoFfmpeg { path: path.into(), source }),
    }
}

/// Draws a clip and has it compressed. It appears whole or not at all.
pub fn write(
    evidence: &Evidence,
    source: &Source,
    container: Container,
    threads: NonZero<usize>,
    progress: Progress,
    options: &OutputOptions,
) -> Result<Exit, CommandError> {
    let request = &evidence.request;
    let view = illustration::view(request, source, progress)?;
    let timeline = illustration::timeline(request, source, progress)?;
    let mut frames = illustration::frames(request, source, &timeline)?;
    output::write_beside(&options.output, options.force, |place| {
        let mut ffmpeg = start(&view, &timeline, container, &evidence.metadata().to_string(), place)
            .map_err(|source| CommandError::NoFfmpeg { path: options.output.clone(), source })?;
        let sent = send(&mut ffmpeg, frames.by_ref(), &view, &timeline, threads, progress);
        finish(ffmpeg, sent, &options.output)
    })?;
    Ok(damage::tell(&frames.condition()))
}

/// ffmpeg, waiting for pixels on its standard input.
fn start(view: &View, timeline: &Timeline, container: Container, comment: &str, place: &Path) -> io::Result<Child> {
    let [width, height] = view.camera.size;
    let rate = timeline.frames_per_second();
    let codec: &[&str] = match container {
        Container::Mp4 => &["-c:v", "libx264", "-crf", "18", "-movflags", "+faststart", "-f", "mp4"],
        Container::Webm => &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-f", "webm"],
    };
    Command::new(FFMPEG)
        .args(["-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgba"])
        .args(["-s", &format!("{width}x{height}"), "-r", &rate.to_string(), "-i", "-", "-an"])
        // What most players can show has an even number of pixels along each side.
        .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"])
        .args(["-metadata", &format!("comment={comment}")])
        .args(codec)
        .arg(place)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
}

/// Sends each picture as often as it is to be seen.
fn send(
    ffmpeg: &mut Child,
    frames: impl Iterator<Item = Result<crate::render::Frame, illustration::Error>>,
    view: &View,
    timeline: &Timeline,
    threads: NonZero<usize>,
    progress: Progress,
) -> Result<(), CommandError> {
    let Some(input) = ffmpeg.stdin.take() else { return Ok(()) };
    let mut input = BufWriter::new(input);
    let (rate, count) = (timeline.frames_per_second(), timeline.count());
    let mut shown = 0;
    let frames = frames.map(|frame| frame.map_err(CommandError::from));
    draw_each(frames, view, threads, |picture: Picture| {
        for _ in 0..timeline.parts_shown(shown, rate) {
            input.write_all(picture.pixels.as_flattened()).map_err(CommandError::Pipe)?;
        }
        shown += 1;
        progress(shown, count);
        Ok(())
    })?;
    input.flush().map_err(CommandError::Pipe)
}

/// Waits for ffmpeg; if it failed, what it says is the error rather than that it took no more.
fn finish(mut ffmpeg: Child, sent: Result<(), CommandError>, path: &Path) -> Result<(), CommandError> {
    let mut said = String::new();
    if let Some(mut errors) = ffmpeg.stderr.take() {
        let _ = errors.read_to_string(&mut said); // What cannot be read cannot be told.
    }
    let status = ffmpeg.wait().map_err(|source| CommandError::NoFfmpeg { path: path.into(), source })?;
    if status.success() {
        return sent;
    }
    match sent {
        Ok(()) | Err(CommandError::Pipe(_)) => {
            let said = said.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<&str>>().join("; ");
            let what = if said.is_empty() { status.to_string() } else { said };
            Err(CommandError::Ffmpeg { path: path.into(), what })
        }
        Err(error) => Err(error),
    }
}
