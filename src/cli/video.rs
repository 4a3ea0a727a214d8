//! MP4 and WebM: frames are drawn here and compressed by the ffmpeg on the user's PATH.

use super::error::CommandError;
use super::output_file::OutputFile;
use crate::picture::{
    self, AnimationSchedule, Clip, Drawn, Instant, Palette, Picture, Progress, Provenance, Stage, draw_frames,
};
use std::io::{self, BufWriter, Read, Write};
use std::num::NonZero;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// The file format that ffmpeg writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VideoContainer {
    /// H.264 in MP4, for slides and browsers.
    Mp4,
    /// VP9 in WebM.
    Webm,
}

/// The name of the program, searched on the PATH.
const FFMPEG: &str = "ffmpeg";

/// Returns an error before any work is done if ffmpeg cannot be run.
pub fn require_ffmpeg(path: &Path) -> Result<(), CommandError> {
    let mut command = Command::new(FFMPEG);
    command.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    match command.status() {
        Ok(_) => Ok(()),
        Err(source) => Err(CommandError::NoFfmpeg { path: path.into(), source }),
    }
}

/// Draws a clip and compresses it with ffmpeg.
pub fn write(
    clip: Clip,
    provenance: &Provenance,
    container: VideoContainer,
    threads: NonZero<usize>,
    progress: Progress,
    output: OutputFile,
) -> Result<Drawn, CommandError> {
    let Clip { stage, schedule, mut instants, warnings } = clip;
    let name = output.name().to_owned();
    output.write_by_path(|temp_path| {
        let mut ffmpeg = start(&stage, &schedule, container, &provenance.metadata().to_string(), temp_path)
            .map_err(|source| CommandError::NoFfmpeg { path: name.clone(), source })?;
        let sent = send(&mut ffmpeg, instants.by_ref(), &stage, &schedule, threads, progress);
        finish(ffmpeg, sent, &name)
    })?;
    Ok(Drawn { statuses: instants.read_statuses(), schedule: Some(schedule), missing: 0, warnings })
}

/// Starts ffmpeg, which reads raw RGBA frames on its standard input.
fn start(
    stage: &Stage,
    schedule: &AnimationSchedule,
    container: VideoContainer,
    comment: &str,
    output: &Path,
) -> io::Result<Child> {
    let [width, height] = stage.size();
    let rate = schedule.frames_per_second();
    let background = Palette::of(stage.style().look.theme).background;
    let even = format!("pad=ceil(iw/2)*2:ceil(ih/2)*2:color={background},scale=out_color_matrix=bt709:out_range=tv");
    let codec: &[&str] = match container {
        VideoContainer::Mp4 => &["-c:v", "libx264", "-crf", "18", "-movflags", "+faststart", "-f", "mp4"],
        VideoContainer::Webm => &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-f", "webm"],
    };
    Command::new(FFMPEG)
        .args(["-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgba"])
        .args(["-s", &format!("{width}x{height}"), "-r", &rate.to_string(), "-i", "-", "-an"])
        // Most players need an even number of pixels along each side. Without tags, players guess the colours.
        .args(["-vf", &even, "-pix_fmt", "yuv420p"])
        .args(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv"])
        .args(["-metadata", &format!("comment={comment}")])
        .args(codec)
        .arg(output)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
}

/// Sends each picture to ffmpeg, repeated for the number of frames for which it is shown.
fn send(
    ffmpeg: &mut Child,
    instants: impl Iterator<Item = Result<Instant, picture::Error>>,
    stage: &Stage,
    schedule: &AnimationSchedule,
    threads: NonZero<usize>,
    progress: Progress,
) -> Result<(), CommandError> {
    let Some(input) = ffmpeg.stdin.take() else { return Ok(()) };
    let mut input = BufWriter::new(input);
    let (rate, count) = (schedule.frames_per_second(), schedule.count());
    let mut shown = 0;
    let instants = instants.map(|instant| instant.map_err(CommandError::from));
    draw_frames(instants, stage, threads, |picture: Picture| {
        for _ in 0..schedule.ticks_shown(shown, rate) {
            input.write_all(picture.pixels.as_flattened()).map_err(CommandError::Pipe)?;
        }
        shown += 1;
        progress(shown, count);
        Ok(())
    })?;
    input.flush().map_err(CommandError::Pipe)
}

/// Waits for ffmpeg. If ffmpeg failed, its own message takes precedence over the broken pipe.
fn finish(mut ffmpeg: Child, sent: Result<(), CommandError>, path: &Path) -> Result<(), CommandError> {
    let mut messages = String::new();
    if let Some(mut errors) = ffmpeg.stderr.take() {
        let _ = errors.read_to_string(&mut messages); // Without its messages, the exit status is reported.
    }
    let status = ffmpeg.wait().map_err(|source| CommandError::NoFfmpeg { path: path.into(), source })?;
    if status.success() {
        return sent;
    }
    match sent {
        Ok(()) | Err(CommandError::Pipe(_)) => {
            let lines: Vec<&str> = messages.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
            let message = if lines.is_empty() { status.to_string() } else { lines.join("; ") };
            Err(CommandError::Ffmpeg { path: path.into(), message })
        }
        Err(error) => Err(error),
    }
}
