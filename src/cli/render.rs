use super::Exit;
use super::arguments::{Shard, is_standard_output};
use super::error::CommandError;
use super::output;
use super::output_file::{OutputFile, OutputFolder, Overwrite, RefuseInputs};
use super::picture_arguments::RenderOptions;
use super::source::{OpenedSource, SourceArgument, Verification};
use super::video::{self, VideoContainer};
use crate::physics::larger;
use crate::picture::{
    self, Animation, AnimationFormat, Drawn, Format, MAX_FRAMES, Page, Progress, SOFTWARE, SPEEDS, Sequence,
    StillFormat, Subject, SubjectOptions,
};
use crate::text::counted;
use std::path::{Path, PathBuf};

/// Draws scenes or recordings.
pub fn run(options: &RenderOptions) -> Result<Exit, CommandError> {
    let (path, overwrite) = (&options.output.output, Overwrite::from_force(options.output.force));
    let kind = OutputKind::from_options(options)?;
    kind.refuse_shard(path, options.shard)?;
    let inputs: Vec<&Path> = options.sources.iter().map(PathBuf::as_path).collect();
    let mut output = kind.open(path, overwrite, &inputs)?;
    let verification = if options.at.is_some() { Verification::None } else { Verification::Replay };
    let sources = SourceArgument::all(&options.sources, &options.set)?;
    let opened = OpenedSource::open_all(&sources, verification, &mut output)?;
    let sources: Vec<picture::Source> = opened.iter().map(|source| source.recording.clone()).collect();
    let mut picture_options = options.picture_options();
    if !options.set.is_empty() {
        picture_options = picture_options.with_titles_of_runs(&sources);
    }
    let threads = options.jobs.threads();
    let bar = output::progress_bar("drawing frames", 0);
    let mut on_progress = output::progress_updater(&bar);
    let mut step = 0;
    let drawn = match output {
        Output::File(subject, file) => {
            let picture = picture_options.resolve(&subject, &sources, &mut on_progress)?;
            match &picture.subject {
                Subject::Animation { animation, .. } => {
                    refuse_long_animation(animation, &sources, options, &mut on_progress)?;
                }
                Subject::Page { page: Page::State { step: shown, .. }, .. } => step = *shown,
                Subject::Page { .. } => {}
            }
            let drawn = file.write(|output| {
                let (options, progress) = (&picture_options, &mut on_progress);
                Ok(picture::draw_options(&subject, options, &sources, SOFTWARE, threads, progress, output)?)
            })?;
            drawn.1
        }
        Output::Video(container, file) => {
            let (animation, ..) = picture_options.resolve_video(&sources)?;
            refuse_long_animation(&animation, &sources, options, &mut on_progress)?;
            let (clip, provenance) = picture::Clip::video(&picture_options, &sources, &mut on_progress)?;
            video::write(clip, &provenance, container, threads, &mut on_progress, file)?
        }
        Output::Sequence(folder) => {
            let sequence = picture_options.resolve_sequence(&sources)?;
            match draw_shard(sequence, folder, &sources, options, &mut on_progress)? {
                Some(drawn) => drawn,
                None => return Ok(Exit::Done),
            }
        }
    };
    let exit = opened.iter().fold(output::warn_of_damage(&drawn.statuses), |exit, source| source.file.exit(exit));
    drawn.warnings.iter().for_each(|warning| output::info(format_args!("{warning}")));
    bar.finish_and_clear();
    // The message names the steps shown, because an animation may skip steps.
    let shown = match drawn.schedule {
        Some(schedule) => format!("{}, {schedule}", counted(schedule.count() - drawn.missing, "frame")),
        None => format!("step {step}"),
    };
    output::print_result(path, &format!("{}: {shown}", path.display()))?;
    Ok(exit)
}

/// Draws the pictures of a sequence that belong to the shard; returns `None` if there are none.
fn draw_shard(
    mut sequence: Sequence,
    mut folder: OutputFolder,
    sources: &[picture::Source],
    options: &RenderOptions,
    progress: Progress,
) -> Result<Option<Drawn>, CommandError> {
    let Some(steps) = options.shard.steps(*sequence.steps.start(), *sequence.steps.end()) else {
        folder.finish()?;
        return Ok(None);
    };
    sequence.steps = steps;
    let frames = (sequence.steps.end() - sequence.steps.start()) / sequence.every;
    ClipLength { frames, simulated: 0.0, slow: 1.0, frozen: 0.0 }.refuse_long(options)?;
    let write = |step, file: Vec<u8>| folder.write(format!("{step:06}.png"), &file);
    let drawn = picture::draw_sequence(&sequence, sources, options.jobs.threads(), progress, write)?;
    let others = folder.other_frames("png");
    folder.finish()?;
    if options.output.force && options.shard == Shard::WHOLE {
        warn_of_other_frames(&options.output.output, &others);
    }
    Ok(Some(drawn))
}

/// Names the frames in a folder that were there before and are not replaced, because they may be of another run. They
/// are kept, because a run may be drawn in several ranges of steps.
fn warn_of_other_frames(folder: &Path, others: &[String]) {
    if let [first, ..] = others
        && let Some(last) = others.last()
    {
        let count = counted(others.len() as u64, "other picture");
        let range = if others.len() == 1 { first.clone() } else { format!("{first} to {last}") };
        output::info(format_args!(
            "{} has {count} from before, {range}; if these are frames of another run, remove them",
            folder.display()
        ));
    }
}

/// Returns an error for an animation that is long, which is usually a mistake, unless it is allowed.
fn refuse_long_animation(
    animation: &Animation,
    sources: &[picture::Source],
    options: &RenderOptions,
    progress: Progress,
) -> Result<(), CommandError> {
    let schedule = animation.schedule(sources)?;
    let (frames, slow, hold) = (schedule.count(), animation.timing.slow, animation.timing.hold);
    let length = ClipLength { frames, simulated: schedule.start_time(frames) * slow, slow, frozen: 0.0 };
    length.refuse_long(options)?;
    // At most one freeze frame follows each frame. Only if that could be too long, they are counted by a replay.
    let longest = ClipLength { frames: 2 * frames, frozen: hold * frames as f64, ..length };
    if hold > 0.0 && longest.refuse_long(options).is_err() {
        let schedule = animation.schedule_with_freeze_frames(sources, progress)?;
        let frozen = hold * schedule.freeze_count() as f64;
        ClipLength { frames: schedule.count(), frozen, ..length }.refuse_long(options)?;
    }
    Ok(())
}

/// The longest clip that needs no confirmation, s, and its largest number of frames.
const MAX_CLIP: (f64, u64) = (3600.0, 100_000);

/// The longest clip, s, and its largest number of frames, so that no file grows without bound.
const MAX_LONG_CLIP: (f64, u64) = (1e7, MAX_FRAMES);

/// The length of a clip.
#[derive(Clone, Copy)]
struct ClipLength {
    frames: u64,
    /// The simulated time that is shown, s.
    simulated: f64,
    /// Simulated seconds per second of playback.
    slow: f64,
    /// The time of all freeze frames, s.
    frozen: f64,
}

impl ClipLength {
    fn seconds(&self) -> f64 {
        self.simulated / self.slow + self.frozen
    }

    fn exceeds(&self, (max_seconds, max_frames): (f64, u64)) -> bool {
        self.frames > max_frames || self.seconds() > max_seconds
    }

    /// Returns an error for a long clip, which is usually a mistake, unless it is allowed.
    fn refuse_long(&self, options: &RenderOptions) -> Result<(), CommandError> {
        let (frames, seconds, (max_seconds, max_frames)) = (self.frames, self.seconds(), MAX_LONG_CLIP);
        let limit = if options.long { MAX_LONG_CLIP } else { MAX_CLIP };
        let mut cures = self.cures(limit, options.picture.every);
        match (self.exceeds(MAX_LONG_CLIP), self.exceeds(MAX_CLIP)) {
            (true, _) => {
                let cures = enumerated(&cures);
                Err(CommandError::TooLongClip { frames, seconds, max_frames, max_seconds, cures })
            }
            (false, true) if !options.long => {
                cures.push("allow it with --long".to_owned());
                Err(CommandError::LongClip { frames, seconds, cures: enumerated(&cures) })
            }
            (false, _) => Ok(()),
        }
    }

    /// Advice that brings the clip within limits. A faster clip has fewer frames unless their interval, `every`, is
    /// given.
    fn cures(&self, (max_seconds, max_frames): (f64, u64), every: Option<u64>) -> Vec<String> {
        let (is_too_long, has_too_many) = (self.seconds() > max_seconds, self.frames > max_frames);
        let by_duration = self.simulated / (max_seconds - self.frozen);
        let by_frames = if has_too_many { self.slow * self.frames as f64 / max_frames as f64 } else { 0.0 };
        let slow = rounded_up(larger(by_duration, by_frames));
        let faster = format!("play it faster with --slow {slow}");
        let mut cures = Vec::new();
        if self.frozen >= max_seconds {
            cures.push("freeze it for a shorter time with --hold".to_owned());
        } else if is_too_long && SPEEDS.contains(&slow) {
            let is_enough = !has_too_many || every.is_none();
            cures.push(if is_enough { faster } else { format!("{faster} and draw fewer frames with --every") });
        } else if has_too_many {
            cures.push("draw fewer frames with --fps or --every".to_owned());
        }
        cures.push("draw a part with --from and --to".to_owned());
        cures
    }
}

/// Alternatives as an English enumeration.
fn enumerated(alternatives: &[String]) -> String {
    match alternatives {
        [] => String::new(),
        [only] => only.clone(),
        [rest @ .., last] => format!("{}, or {last}", rest.join(", ")),
    }
}

/// The next larger number with one significant digit.
fn rounded_up(number: f64) -> f64 {
    let scientific = format!("{number:e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return number };
    let digit = mantissa.parse().map_or(number, f64::ceil);
    format!("{digit}e{exponent}").parse().unwrap_or(number)
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

impl RefuseInputs for Output {
    fn refuse_inputs(&mut self, inputs: &[PathBuf]) -> Result<(), CommandError> {
        match self {
            Output::File(_, file) | Output::Video(_, file) => file.refuse_inputs(inputs),
            Output::Sequence(folder) => folder.refuse_inputs(inputs),
        }
    }
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
    fn open(self, path: &Path, overwrite: Overwrite, sources: &[&Path]) -> Result<Output, CommandError> {
        Ok(match self {
            OutputKind::File(subject) => Output::File(subject, OutputFile::create(path, overwrite, sources)?),
            OutputKind::Video(container) => {
                video::require_ffmpeg(path)?;
                Output::Video(container, OutputFile::create(path, overwrite, sources)?)
            }
            OutputKind::Sequence => Output::Sequence(OutputFolder::create(path, overwrite, sources)?),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_number_of_one_digit_is_not_smaller() {
        let numbers = [(8611.1, 9000.0), (9000.0, 9000.0), (9500.0, 1e4), (3.3e-4, 4e-4), (1.0, 1.0), (0.12, 0.2)];
        for (number, expected) in numbers {
            assert_eq!(rounded_up(number), expected, "{number}");
        }
        assert!(rounded_up(f64::INFINITY).is_infinite());
    }

    #[test]
    fn the_cures_of_a_long_clip_work() {
        let length = ClipLength { frames: 31, simulated: 3.1e7, slow: 1.0, frozen: 0.0 };
        let (faster, part) = ("play it faster with --slow 9000", "draw a part with --from and --to");
        assert_eq!(length.cures(MAX_CLIP, Some(100)), [faster, part]);
        assert_eq!(enumerated(&length.cures(MAX_CLIP, None)), format!("{faster}, or {part}"));
        assert!(length.exceeds(MAX_CLIP) && !ClipLength { slow: 9000.0, ..length }.exceeds(MAX_CLIP));
        let many = ClipLength { frames: 200_000, simulated: 60.0, ..length };
        assert_eq!(many.cures(MAX_CLIP, None), ["draw fewer frames with --fps or --every", part]);
        // At 30 frames per second, 3600 s would still be too many.
        let both = ClipLength { frames: 930_000_000, ..length };
        assert_eq!(both.cures(MAX_CLIP, None), ["play it faster with --slow 10000", part]);
        let thinned = "play it faster with --slow 10000 and draw fewer frames with --every";
        assert_eq!(both.cures(MAX_CLIP, Some(1)), [thinned, part]);
        let frozen = ClipLength { frozen: 5000.0, ..length };
        assert_eq!(frozen.cures(MAX_CLIP, None), ["freeze it for a shorter time with --hold", part]);
        // No speed is high enough.
        let endless = ClipLength { simulated: 1e300, ..length };
        assert_eq!(endless.cures(MAX_CLIP, None), [part]);
    }
}
