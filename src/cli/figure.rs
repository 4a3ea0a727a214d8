use super::error::CommandError;
use super::picture_arguments::{FigureAxis, FigureCommandOptions, FigureKind};
use super::source::Source;
use super::{Exit, damage, output, progress, wish};
use crate::figure::Axis;
use crate::illustration::{self, Evidence, Figure, Format, Wish, WishedFigure, WishedSubject};
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
    let recordings: Vec<illustration::Source> = sources.iter().map(|source| source.recording.clone()).collect();
    let bar = progress::bar("drawing", 0);
    let mut heard = progress::listener(&bar);
    let evidence = Evidence::new(&wish(options).request(&recordings, &mut heard)?, &recordings);
    let mut conditions = Vec::new();
    output::write_file(path, options.output.force, |output| {
        conditions = illustration::draw(&evidence, &recordings, format, NonZero::<usize>::MIN, &mut heard, output)?;
        Ok(())
    })?;
    bar.finish_and_clear();
    Ok(damage::tell_all(&conditions))
}

/// What is asked for.
pub fn wish(options: &FigureCommandOptions) -> Wish {
    Wish {
        from: options.from,
        to: options.to,
        every: options.every,
        titles: options.title.clone(),
        ..wish::of(&options.look, WishedSubject::Figure(figure(options)))
    }
}

fn figure(options: &FigureCommandOptions) -> WishedFigure {
    let (step, pair) = (options.step, options.pair.clone());
    match options.kind {
        FigureKind::Collision => WishedFigure::Collision { step, pair },
        FigureKind::Minkowski => WishedFigure::Minkowski { step, pair },
        FigureKind::Strobe => WishedFigure::States(Figure::Strobe),
        FigureKind::Spacetime => WishedFigure::States(Figure::Spacetime(axis(options.axis))),
        FigureKind::Energy => WishedFigure::States(Figure::Energy),
        FigureKind::Filmstrip => WishedFigure::States(Figure::Filmstrip),
    }
}

const fn axis(axis: FigureAxis) -> Axis {
    match axis {
        FigureAxis::X => Axis::X,
        FigureAxis::Y => Axis::Y,
    }
}

/// What the name of the result asks for.
pub fn format(path: &Path) -> Result<Format, CommandError> {
    match Format::of_name(path) {
        Some(format) if !format.is_animated() => Ok(format),
        None if output::is_standard_output(path) => Ok(Format::Png),
        Some(_) | None => {
            let expected = "a figure is F.png, F.svg, F.pdf, or - for PNG on standard output";
            Err(CommandError::UnknownKind { path: path.into(), expected })
        }
    }
}
