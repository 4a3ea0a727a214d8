use super::Exit;
use super::arguments::RenderOptions;
use super::clip::Clip;
use super::error::CommandError;
use super::output::{self, Folder};
use super::progress;
use super::source::Source;
use crate::render::{self, Painter};
use std::path::Path;

/// Draws a scene or a recording.
pub fn run(options: &RenderOptions) -> Result<Exit, CommandError> {
    let kind = Kind::of(options)?;
    kind.refuse_existing(&options.output.output, options.output.force)?;
    let source = Source::open(&options.source)?;
    let clip = Clip::plan(options, kind, &source)?;
    let exit = match kind {
        Kind::Gif => gif(options, &clip)?,
        Kind::Picture => picture(options, &clip)?,
        Kind::Sequence => sequence(options, &clip)?,
    };
    Ok(exit)
}

/// What is to be made, as the name of the result says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One animation.
    Gif,
    /// One state.
    Picture,
    /// A folder with a picture a step.
    Sequence,
}

impl Kind {
    fn of(options: &RenderOptions) -> Result<Kind, CommandError> {
        let path = &options.output.output;
        let unknown = |expected| Err(CommandError::UnknownKind { path: path.clone(), expected });
        let extension = path.extension().and_then(|extension| extension.to_str());
        match (extension, options.at) {
            (Some("png"), Some(_)) => Ok(Kind::Picture),
            (Some("png"), None) => unknown("one picture needs --at STEP; a folder of pictures has a name without .png"),
            (Some("gif"), None) => Ok(Kind::Gif),
            (None, Some(_)) if output::is_standard_output(path) => Ok(Kind::Picture),
            (None, None) if output::is_standard_output(path) => Ok(Kind::Gif),
            (None, None) => Ok(Kind::Sequence),
            (_, Some(_)) => unknown("--at STEP makes one picture, OUT.png"),
            (Some(_), None) if path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/') => Ok(Kind::Sequence),
            (Some(_), None) => unknown("OUT.gif, OUT.png with --at STEP, or a folder OUT/"),
        }
    }

    /// Refuses early what would be refused after all the work.
    fn refuse_existing(self, path: &Path, force: bool) -> Result<(), CommandError> {
        match self {
            Kind::Sequence => Ok(()),
            Kind::Gif | Kind::Picture if output::is_standard_output(path) => Ok(()),
            Kind::Gif | Kind::Picture => output::refuse_existing(path, force),
        }
    }
}

fn gif(options: &RenderOptions, clip: &Clip) -> Result<Exit, CommandError> {
    let mut frames = clip.frames()?;
    let bar = progress::bar("drawing", clip.sampling.count());
    output::write_file(&options.output.output, options.output.force, |output| {
        let frames = bar.wrap_iter(frames.by_ref());
        render::write_gif(frames, &clip.view, &clip.sampling, &clip.metadata, clip.threads, output)
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
    let line = format!("{}: {}", path.display(), clip.sampling);
    if output::is_standard_output(path) {
        output::note(format_args!("{line}"));
        return Ok(());
    }
    output::print(format!("{line}\n").as_bytes())
}
