use super::error::CommandError;
use super::output::{self, Folder};
use super::output_kind::OutputKind;
use super::picture_arguments::RenderOptions;
use super::shard::Shard;
use super::source::Source;
use super::{Exit, jobs, picture_options, progress, video, warnings};
use crate::picture::{self, Format, PictureOptions, Progress, Provenance, Subject, SubjectOptions};
use std::num::NonZero;

/// Draws a scene or a recording.
pub fn run(options: &RenderOptions) -> Result<Exit, CommandError> {
    let kind = OutputKind::from_options(options)?;
    kind.refuse_existing(&options.output.output, options.output.force)?;
    kind.refuse_shard(&options.output.output, options.shard)?;
    if let OutputKind::Video(_) = kind {
        video::require_ffmpeg(&options.output.output)?;
    }
    let source = Source::open(&options.source)?;
    let bar = progress::bar("drawing", 0);
    let mut on_progress = progress::updater(&bar);
    let recordings = [source.recording.clone()];
    let Some(picture_options) =
        shard_options(picture_options(options, kind), options.shard, recordings[0].summary.last_step)
    else {
        Folder::create(&options.output.output, options.output.force)?.finish()?;
        return Ok(Exit::Done);
    };
    let provenance = Provenance::new(&picture_options.resolve(&recordings, &mut on_progress)?, &recordings);
    let job = Job { options, provenance, source: &recordings[0] };
    let exit = match kind {
        OutputKind::Animation(format) | OutputKind::Picture(format) => job.file(format, &mut on_progress)?,
        OutputKind::Video(container) => job.video(container, &mut on_progress)?,
        OutputKind::Sequence => job.sequence(&mut on_progress)?,
    };
    bar.finish_and_clear();
    job.print_summary(&mut on_progress)?;
    Ok(exit)
}

/// Returns the picture options and the format of an output that is one file and needs no ffmpeg.
pub fn single_file_options(options: &RenderOptions) -> Result<Option<(PictureOptions, Format)>, CommandError> {
    let kind = OutputKind::from_options(options)?;
    Ok(match kind {
        OutputKind::Animation(format) | OutputKind::Picture(format) => Some((picture_options(options, kind), format)),
        OutputKind::Video(_) | OutputKind::Sequence => None,
    })
}

fn picture_options(options: &RenderOptions, kind: OutputKind) -> PictureOptions {
    let subject = match (options.at, kind) {
        (Some(step), _) => SubjectOptions::Still { step },
        (None, OutputKind::Animation(format) | OutputKind::Picture(format)) => {
            SubjectOptions::Animation { max_fps: PictureOptions::max_fps(format) }
        }
        (None, OutputKind::Video(_)) => SubjectOptions::Animation { max_fps: f64::INFINITY },
        (None, OutputKind::Sequence) => SubjectOptions::Sequence,
    };
    PictureOptions {
        from: options.from,
        to: options.to,
        every: options.every,
        fps: options.fps,
        slow: options.slow,
        hold: options.hold_seconds(),
        ..picture_options::from_look(&options.look, subject)
    }
}

/// Restricts the options to the steps of one shard. Returns `None` if the shard has no steps.
fn shard_options(options: PictureOptions, shard: Shard, last_step: Option<u64>) -> Option<PictureOptions> {
    if shard == Shard::WHOLE {
        return Some(options);
    }
    let end = last_step.unwrap_or(0);
    let steps = shard.steps(options.from.unwrap_or(0), options.to.unwrap_or(end).min(end))?;
    Some(PictureOptions { from: Some(*steps.start()), to: Some(*steps.end()), ..options })
}

/// One drawing job.
struct Job<'a> {
    options: &'a RenderOptions,
    provenance: Provenance,
    source: &'a picture::Source,
}

impl Job<'_> {
    fn threads(&self) -> NonZero<usize> {
        jobs::thread_count(self.options.jobs)
    }

    fn file(&self, format: Format, on_progress: Progress) -> Result<Exit, CommandError> {
        let sources = std::slice::from_ref(self.source);
        let mut statuses = Vec::new();
        output::write_file(&self.options.output.output, self.options.output.force, |output| {
            statuses = picture::draw(&self.provenance, sources, format, self.threads(), on_progress, output)?;
            Ok(())
        })?;
        Ok(warnings::warn_all(&statuses))
    }

    fn video(
        &self,
        container: super::output_kind::VideoContainer,
        on_progress: Progress,
    ) -> Result<Exit, CommandError> {
        let output = &self.options.output;
        video::write(&self.provenance, self.source, container, self.threads(), on_progress, output)
    }

    fn sequence(&self, on_progress: Progress) -> Result<Exit, CommandError> {
        let mut folder = Folder::create(&self.options.output.output, self.options.output.force)?;
        let write = |step, file: Vec<u8>| folder.write(format!("{step:06}.png"), &file);
        let status = picture::draw_sequence(&self.provenance, self.source, self.threads(), on_progress, write)?;
        folder.finish()?;
        Ok(warnings::warn_if_damaged(&status))
    }

    /// Prints which steps were drawn: an animation does not show every step of every run.
    fn print_summary(&self, on_progress: Progress) -> Result<(), CommandError> {
        let path = &self.options.output.output;
        let request = &self.provenance.picture;
        let line = match &request.subject {
            Subject::Still { step, .. } => format!("{}: step {step}", path.display()),
            Subject::Animation { .. } | Subject::Figure { .. } | Subject::Collision(_) | Subject::Minkowski(_) => {
                format!("{}: {}", path.display(), picture::schedule(request, self.source, on_progress)?)
            }
        };
        output::print_result(path, &line)
    }
}
