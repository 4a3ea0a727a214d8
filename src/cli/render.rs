use super::arguments::Shard;
use super::error::CommandError;
use super::output::{self, Folder};
use super::output_kind::OutputKind;
use super::picture_arguments::RenderOptions;
use super::source::Source;
use super::{Exit, video};
use crate::picture::{self, PictureOptions, Provenance};

/// Draws a scene or a recording.
pub fn run(options: &RenderOptions) -> Result<Exit, CommandError> {
    let (path, force) = (&options.output.output, options.output.force);
    let kind = OutputKind::from_options(options)?;
    kind.refuse_existing(path, force)?;
    kind.refuse_shard(path, options.shard)?;
    if let OutputKind::Video(_) = kind {
        video::require_ffmpeg(path)?;
    }
    let source = Source::open(&options.source)?;
    let recording = &source.recording;
    let picture_options = options.picture_options();
    let threads = options.jobs.threads();
    let bar = output::progress_bar("drawing", 0);
    let mut on_progress = output::progress_updater(&bar);
    let drawn = match kind {
        OutputKind::File(subject) => {
            let sources = std::slice::from_ref(recording);
            let picture = picture_options.resolve(&subject, sources, &mut on_progress)?;
            let provenance = Provenance::new(&picture, sources);
            output::write_file(path, force, |output| {
                Ok(picture::draw(&provenance, sources, threads, &mut on_progress, output)?)
            })?
        }
        OutputKind::Video(container) => {
            let (clip, provenance) = picture::Clip::video(&picture_options, recording, &mut on_progress)?;
            video::write(clip, &provenance, container, threads, &mut on_progress, &options.output)?
        }
        OutputKind::Sequence => {
            let Some(shard) = shard_options(picture_options, options.shard, recording.summary.last_step) else {
                Folder::create(path, force)?.finish()?;
                return Ok(Exit::Done);
            };
            let sequence = shard.resolve_sequence(recording)?;
            let mut folder = Folder::create(path, force)?;
            let write = |step, file: Vec<u8>| folder.write(format!("{step:06}.png"), &file);
            let drawn = picture::draw_sequence(&sequence, recording, threads, &mut on_progress, write)?;
            folder.finish()?;
            drawn
        }
    };
    let exit = output::warn_of_damage(&drawn.statuses);
    bar.finish_and_clear();
    // An animation does not show every step of every run.
    let shown = match (drawn.schedule, options.at) {
        (Some(schedule), _) => schedule.to_string(),
        (None, step) => format!("step {}", step.unwrap_or_default()),
    };
    output::print_result(path, &format!("{}: {shown}", path.display()))?;
    Ok(exit)
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
