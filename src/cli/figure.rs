use super::error::CommandError;
use super::picture_arguments::{FigureAxis, FigureCommandOptions, FigureKind};
use super::source::Source;
use super::{Exit, output, picture_options, progress, warnings};
use crate::figure::Axis;
use crate::picture::{self, Figure, FigureChoice, Format, PictureOptions, Provenance, SubjectOptions};
use std::num::NonZero;
use std::path::Path;

/// Draws one lecture figure.
pub fn run(options: &FigureCommandOptions) -> Result<Exit, CommandError> {
    let path = &options.output.output;
    let format = format(path)?;
    if !output::is_standard_output(path) {
        output::refuse_existing(path, options.output.force)?;
    }
    let sources =
        options.sources.iter().map(|path| Source::open(path)).collect::<Result<Vec<Source>, CommandError>>()?;
    let recordings: Vec<picture::Source> = sources.iter().map(|source| source.recording.clone()).collect();
    let bar = progress::bar("drawing", 0);
    let mut on_progress = progress::updater(&bar);
    let provenance = Provenance::new(&picture_options(options).resolve(&recordings, &mut on_progress)?, &recordings);
    let mut statuses = Vec::new();
    output::write_file(path, options.output.force, |output| {
        statuses = picture::draw(&provenance, &recordings, format, NonZero::<usize>::MIN, &mut on_progress, output)?;
        Ok(())
    })?;
    bar.finish_and_clear();
    Ok(warnings::warn_all(&statuses))
}

/// Converts the command-line options to picture options.
pub fn picture_options(options: &FigureCommandOptions) -> PictureOptions {
    PictureOptions {
        from: options.from,
        to: options.to,
        every: options.every,
        titles: options.title.clone(),
        ..picture_options::from_look(&options.look, SubjectOptions::Figure(figure(options)))
    }
}

fn figure(options: &FigureCommandOptions) -> FigureChoice {
    let (step, pair) = (options.step, options.pair.clone());
    match options.kind {
        FigureKind::Collision => FigureChoice::Collision { step, pair },
        FigureKind::Minkowski => FigureChoice::Minkowski { step, pair },
        FigureKind::Strobe => FigureChoice::States(Figure::Strobe),
        FigureKind::Spacetime => FigureChoice::States(Figure::Spacetime(axis(options.axis))),
        FigureKind::Energy => FigureChoice::States(Figure::Energy),
        FigureKind::Filmstrip => FigureChoice::States(Figure::Filmstrip),
    }
}

const fn axis(axis: FigureAxis) -> Axis {
    match axis {
        FigureAxis::X => Axis::X,
        FigureAxis::Y => Axis::Y,
    }
}

/// Determines the format from the name of the output.
pub fn format(path: &Path) -> Result<Format, CommandError> {
    match Format::from_path(path) {
        Some(format) if !format.is_animated() => Ok(format),
        None if output::is_standard_output(path) => Ok(Format::Png),
        Some(_) | None => {
            let expected = "expected F.png, F.svg or F.pdf, or - for PNG on standard output";
            Err(CommandError::UnsupportedOutput { path: path.into(), expected })
        }
    }
}
