use super::Exit;
use super::arguments::RenderOptions;
use super::clip::Clip;
use super::error::CommandError;
use super::kind::Kind;
use super::output::{self, Folder};
use super::progress;
use super::source::Source;
use crate::render::{self, Painter};

/// Draws a scene or a recording.
pub fn run(options: &RenderOptions) -> Result<Exit, CommandError> {
    let kind = Kind::of(options)?;
    kind.refuse_existing(&options.output.output, options.output.force)?;
    let source = Source::open(&options.source)?;
    let clip = Clip::plan(options, kind, &source)?;
    let exit = match kind {
        Kind::Gif | Kind::Apng => animation(options, &clip, kind)?,
        Kind::Picture => picture(options, &clip)?,
        Kind::Sequence => sequence(options, &clip)?,
    };
    Ok(exit)
}

fn animation(options: &RenderOptions, clip: &Clip, kind: Kind) -> Result<Exit, CommandError> {
    let mut frames = clip.frames()?;
    let bar = progress::bar("drawing", clip.sampling.count());
    output::write_file(&options.output.output, options.output.force, |output| {
        let frames = bar.wrap_iter(frames.by_ref());
        let Clip { view, sampling, metadata, threads, .. } = clip;
        match kind {
            Kind::Apng => render::write_apng(frames, view, sampling, metadata, *threads, output),
            Kind::Gif | Kind::Picture | Kind::Sequence => {
                render::write_gif(frames, view, sampling, metadata, *threads, output)
            }
        }
    })?;
    bar.finish_and_clear();
    tell(options, clip)?;
    Ok(frames.tell_damage())
}

fn picture(options: &RenderOptions, clip: &Clip) -> Result<Exit, CommandError> {
    let mut frames = clip.frames()?;
    output::write_file(&options.output.output, options.output.force, |output| {
        for frame in frames.by_ref() {
            let picture = Painter::new().draw(&render::compose(&frame?, &clip.view));
            render::png::encode(&picture, &clip.metadata, &mut *output)?;
        }
        Ok(())
    })?;
    tell(options, clip)?;
    Ok(Exit::Done)
}

fn sequence(options: &RenderOptions, clip: &Clip) -> Result<Exit, CommandError> {
    let mut frames = clip.frames()?;
    let mut folder = Folder::create(&options.output.output, options.output.force)?;
    let bar = progress::bar("drawing", clip.sampling.count());
    let metadata = |step| clip.metadata_of(step);
    render::write_png_sequence(bar.wrap_iter(frames.by_ref()), &clip.view, metadata, clip.threads, |step, file| {
        folder.write(format!("{step:06}.png"), &file)
    })?;
    bar.finish_and_clear();
    folder.finish()?;
    tell(options, clip)?;
    Ok(frames.tell_damage())
}

/// Says what was drawn: a clip cannot show every step of every run.
fn tell(options: &RenderOptions, clip: &Clip) -> Result<(), CommandError> {
    let path = &options.output.output;
    let line = match options.at {
        Some(step) => format!("{}: step {step}", path.display()),
        None => format!("{}: {}", path.display(), clip.sampling),
    };
    if output::is_standard_output(path) {
        output::note(format_args!("{line}"));
        return Ok(());
    }
    output::print(format!("{line}\n").as_bytes())
}
