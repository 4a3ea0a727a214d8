use super::Exit;
use super::arguments::{Shard, is_standard_output};
use super::error::CommandError;
use super::output;
use super::output_file::{OutputFile, OutputFolder, Overwrite};
use super::picture_arguments::RenderOptions;
use super::source::{OpenedSource, SourceArgument, Verification};
use super::video::{self, VideoContainer};
use crate::picture::{self, AnimationFormat, Format, PictureOptions, SOFTWARE, StillFormat, Subject, SubjectOptions};
use crate::picture_options::StepOrTime;
use crate::text::counted;
use std::path::Path;

/// Draws a scene or a recording.
pub fn run(options: &RenderOptions) -> Result<Exit, CommandError> {
    let (path, overwrite) = (&options.output.output, Overwrite::from_force(options.output.force));
    let kind = OutputKind::from_options(options)?;
    kind.refuse_shard(path, options.shard)?;
    let output = kind.open(path, overwrite, &options.source)?;
    let verification = if options.at.is_some() { Verification::None } else { Verification::Replay };
    let source = OpenedSource::open(&SourceArgument::one(&options.source, &options.set)?, verification)?;
    let recording = &source.recording;
    let picture_options = options.picture_options();
    let threads = options.jobs.threads();
    let bar = output::progress_bar("drawing frames", 0);
    let mut on_progress = output::progress_updater(&bar);
    let drawn = match output {
        Output::File(subject, file) => {
            let sources = std::slice::from_ref(recording);
            let picture = picture_options.resolve(&subject, sources, &mut on_progress)?;
            if let Subject::Animation { animation, .. } = &picture.subject {
                let schedule = animation.schedule(recording);
                refuse_long(schedule.count(), schedule.start_time(schedule.count()), options)?;
            }
            let drawn = file.write(|output| {
                let (options, progress) = (&picture_options, &mut on_progress);
                Ok(picture::draw_options(&subject, options, sources, SOFTWARE, threads, progress, output)?)
            })?;
            drawn.1
        }
        Output::Video(container, file) => {
            let (clip, provenance) = picture::Clip::video(&picture_options, recording, &mut on_progress)?;
            if let Subject::Animation { animation, .. } = &provenance.picture.subject {
                let schedule = animation.schedule(recording);
                refuse_long(schedule.count(), schedule.start_time(schedule.count()), options)?;
            }
            video::write(clip, &provenance, container, threads, &mut on_progress, file)?
        }
        Output::Sequence(mut folder) => {
            let Some(shard) = shard_options(picture_options, options.shard, recording) else {
                folder.finish()?;
                return Ok(Exit::Done);
            };
            let sequence = shard.resolve_sequence(recording)?;
            refuse_long((sequence.steps.end() - sequence.steps.start()) / sequence.every, 0.0, options)?;
            let write = |step, file: Vec<u8>| folder.write(format!("{step:06}.png"), &file);
            let drawn = picture::draw_sequence(&sequence, recording, threads, &mut on_progress, write)?;
            folder.finish()?;
            drawn
        }
    };
    let exit = source.file.exit(output::warn_of_damage(&drawn.statuses));
    drawn.warnings.iter().for_each(|warning| output::info(format_args!("{warning}")));
    bar.finish_and_clear();
    // The message names the steps shown, because an animation may skip steps.
    let shown = match (drawn.schedule, options.at) {
        (Some(schedule), _) => format!("{}, {schedule}", counted(schedule.count(), "frame")),
        (None, at) => format!("step {}", at.map_or(0, |at| at.step(recording.header.config.rate))),
    };
    output::print_result(path, &format!("{}: {shown}", path.display()))?;
    Ok(exit)
}

/// The longest clip that needs no confirmation, s, and its largest number of frames.
const MAX_CLIP: (f64, u64) = (3600.0, 100_000);

/// The longest clip, s, and its largest number of frames, so that no file grows without bound.
const MAX_LONG_CLIP: (f64, u64) = (1e7, 10_000_000);

/// Returns an error for a long clip, which is usually a mistake, unless it is allowed.
fn refuse_long(frames: u64, seconds: f64, options: &RenderOptions) -> Result<(), CommandError> {
    let exceeds = |(max_seconds, max_frames): (f64, u64)| frames > max_frames || seconds > max_seconds;
    let ((max_seconds, max_frames), is_allowed) = (MAX_LONG_CLIP, options.long);
    match (exceeds(MAX_LONG_CLIP), exceeds(MAX_CLIP)) {
        (true, _) => Err(CommandError::TooLongClip { frames, seconds, max_frames, max_seconds }),
        (false, true) if !is_allowed => Err(CommandError::LongClip { frames, seconds }),
        (false, _) => Ok(()),
    }
}

/// Restricts the options to the steps of one shard. Returns `None` if the shard has no steps.
fn shard_options(options: PictureOptions, shard: Shard, recording: &picture::Source) -> Option<PictureOptions> {
    if shard == Shard::WHOLE {
        return Some(options);
    }
    let (rate, end) = (recording.header.config.rate, recording.statistics.last_step.unwrap_or(0));
    let (from, to) = (options.from.map_or(0, |from| from.step(rate)), options.to.map_or(end, |to| to.step(rate)));
    let steps = shard.steps(from, to.min(end))?;
    let (from, to) = (StepOrTime::Step(*steps.start()), StepOrTime::Step(*steps.end()));
    Some(PictureOptions { from: Some(from), to: Some(to), ..options })
}

/// The kind of output of `render`.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputKind {
    /// One file that is drawn without ffmpeg.
    File(SubjectOptions),
    /// One animation, compressed by ffmpeg.
    Video(VideoContainer),
    /// A folder with one picture per step.
    Sequence,
}

/// An output of `render` that can be written.
enum Output {
    File(SubjectOptions, OutputFile),
    Video(VideoContainer, OutputFile),
    Sequence(OutputFolder),
}

impl OutputKind {
    /// Determines the kind from the name of the output and `--at`.
    pub fn from_options(options: &RenderOptions) -> Result<OutputKind, CommandError> {
        let path = &options.output.output;
        let unsupported = |expected| Err(CommandError::UnsupportedOutput { path: path.clone(), expected });
        let state = |step, format| Ok(OutputKind::File(SubjectOptions::State { step, format }));
        let animation = |format| Ok(OutputKind::File(SubjectOptions::Animation { format }));
        let is_folder = path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/');
        let extension = path.extension().and_then(|extension| extension.to_str());
        match (extension, Format::from_path(path), options.at) {
            (_, Some(Format::Still(format)), Some(step)) => state(step, format),
            (_, Some(Format::Animation(format)), None) => animation(format),
            (_, Some(Format::Still(_)), None) => {
                unsupported("a single picture needs --at STEP; a folder of pictures needs a name without an extension")
            }
            (Some("mp4"), _, None) => Ok(OutputKind::Video(VideoContainer::Mp4)),
            (Some("webm"), _, None) => Ok(OutputKind::Video(VideoContainer::Webm)),
            (None, None, Some(step)) if is_standard_output(path) => state(step, StillFormat::Png),
            (None, None, None) if is_standard_output(path) => animation(AnimationFormat::Gif),
            (None, None, None) => Ok(OutputKind::Sequence),
            (_, _, Some(_)) => unsupported("--at STEP draws a single picture: OUT.png, OUT.svg or OUT.pdf"),
            (Some(_), None, None) if is_folder => Ok(OutputKind::Sequence),
            (Some(_), None, None) => unsupported(
                "expected OUT.gif, OUT.apng, OUT.mp4, OUT.webm, a folder OUT/, or with --at STEP OUT.png, OUT.svg or \
                     OUT.pdf",
            ),
        }
    }

    /// Returns an error if a shard is requested of an output that cannot be divided.
    pub fn refuse_shard(&self, path: &Path, shard: Shard) -> Result<(), CommandError> {
        match self {
            OutputKind::Sequence => Ok(()),
            OutputKind::File(_) | OutputKind::Video(_) if shard == Shard::WHOLE => Ok(()),
            OutputKind::File(_) | OutputKind::Video(_) => Err(CommandError::UnsupportedOutput {
                path: path.into(),
                expected: "--shard needs a folder OUT/ as output; a single file has no parts",
            }),
        }
    }

    /// Opens the output, or returns an error before any work is done if it cannot be written.
    fn open(self, path: &Path, overwrite: Overwrite, source: &Path) -> Result<Output, CommandError> {
        Ok(match self {
            OutputKind::File(subject) => Output::File(subject, OutputFile::create(path, overwrite, &[source])?),
            OutputKind::Video(container) => {
                video::require_ffmpeg(path)?;
                Output::Video(container, OutputFile::create(path, overwrite, &[source])?)
            }
            OutputKind::Sequence => Output::Sequence(OutputFolder::create(path, overwrite)?),
        })
    }
}
