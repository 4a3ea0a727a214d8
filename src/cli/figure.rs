use super::arguments::{FigureAxis, FigureCommandOptions, FigureKind};
use super::error::CommandError;
use super::source::{Source, Survey};
use super::{Exit, clip, figure_data, look, output};
use crate::figure::{self, Axis, FigureOptions};
use crate::physics::Vector;
use crate::render::{DisplayList, Metadata, Painter, Sampling, Thinning, pdf, png, svg};
use std::path::Path;

/// Draws one lecture figure.
pub fn run(options: &FigureCommandOptions) -> Result<Exit, CommandError> {
    let path = &options.output.output;
    let format = Format::of(path)?;
    if !output::is_standard_output(path) {
        output::refuse_existing(path, options.output.force)?;
    }
    let source = Source::open(&options.source)?;
    let survey = Survey::of(&source.path)?;
    let drawn = draw(options, &source, &survey)?;
    output::write_file(path, options.output.force, |output| Ok(format.write(&drawn.list, &drawn.metadata, output)?))?;
    Ok(drawn.exit)
}

/// A figure, what it says of itself, and how the recording was found to be.
struct Drawn {
    list: DisplayList,
    metadata: Metadata,
    exit: Exit,
}

fn draw(options: &FigureCommandOptions, source: &Source, survey: &Survey) -> Result<Drawn, CommandError> {
    let [width, height] = source.scene.size;
    let figure_options = FigureOptions {
        size: look::size(&options.look, &source.scene.figure),
        world: Vector::new(width, height),
        style: look::style(&options.look, &source.scene.figure, survey),
        caption: options.caption.clone(),
    };
    match options.kind {
        FigureKind::Collision | FigureKind::Minkowski => of_collision(options, source, survey, &figure_options),
        FigureKind::Strobe | FigureKind::Spacetime | FigureKind::Energy | FigureKind::Filmstrip => {
            of_states(options, source, survey, &figure_options)
        }
    }
}

fn of_collision(
    options: &FigureCommandOptions,
    source: &Source,
    survey: &Survey,
    figure_options: &FigureOptions,
) -> Result<Drawn, CommandError> {
    let found = figure_data::collision(&source.path, options.step, options.pair.as_ref())?;
    let bodies = [&*found.bodies[0], &*found.bodies[1]];
    let list = match options.kind {
        FigureKind::Minkowski => figure::minkowski(&found.collision, bodies, figure_options),
        FigureKind::Collision
        | FigureKind::Strobe
        | FigureKind::Spacetime
        | FigureKind::Energy
        | FigureKind::Filmstrip => figure::collision(&found.collision, bodies, figure_options),
    };
    let more = format!(" pair={},{}", bodies[0].name, bodies[1].name);
    let metadata = metadata(options, survey, found.collision.step.to_string(), figure_options, &more);
    Ok(Drawn { list, metadata, exit: Exit::Done })
}

fn of_states(
    options: &FigureCommandOptions,
    source: &Source,
    survey: &Survey,
    figure_options: &FigureOptions,
) -> Result<Drawn, CommandError> {
    let sampling = sampling(options, source, survey)?;
    let metadata = |more: &str| metadata(options, survey, clip::steps_in_words(&sampling), figure_options, more);
    if options.kind == FigureKind::Energy {
        let (samples, exit) = figure_data::energies(&source.path, &sampling)?;
        return Ok(Drawn { list: figure::energy(&samples, figure_options), metadata: metadata(""), exit });
    }
    let (frames, exit) = figure_data::frames(&source.path, &sampling, &figure_options.style.show)?;
    let (list, more) = match options.kind {
        FigureKind::Spacetime => {
            let more = format!(" axis={:?}", options.axis).to_lowercase();
            (figure::spacetime(&frames, axis(options.axis), figure_options), more)
        }
        FigureKind::Strobe => (figure::strobe(&frames, figure_options), String::new()),
        FigureKind::Filmstrip | FigureKind::Collision | FigureKind::Minkowski | FigureKind::Energy => {
            (figure::filmstrip(&frames, figure_options), String::new())
        }
    };
    Ok(Drawn { list, metadata: metadata(&more), exit })
}

const fn axis(axis: FigureAxis) -> Axis {
    match axis {
        FigureAxis::X => Axis::X,
        FigureAxis::Y => Axis::Y,
    }
}

/// As many states as suit the kind: a strobe shows a few instants, a diagram a line.
fn sampling(options: &FigureCommandOptions, source: &Source, survey: &Survey) -> Result<Sampling, CommandError> {
    let Some(last) = survey.last_step else {
        return Err(CommandError::NoSuchStep { what: "the recording has no state".into() });
    };
    let from = options.from.unwrap_or(0);
    let to = options.to.map_or(last, |to| if to < last { to } else { last });
    let wanted = match options.kind {
        FigureKind::Filmstrip | FigureKind::Collision | FigureKind::Minkowski => 6,
        FigureKind::Strobe => 16,
        FigureKind::Spacetime | FigureKind::Energy => 2000,
    };
    let fitting = to.saturating_sub(from).div_ceil(wanted - 1).max(1);
    let every = Thinning::Every(options.every.unwrap_or(fitting));
    let sampling = Sampling::new(from..=to, source.header.settings.rate, every).among_every(source.header.every);
    if sampling.count() == 0 {
        let what = format!("steps {from} to {to} by {} of a recording whose last step is {last}", sampling.every);
        return Err(CommandError::NoSuchStep { what });
    }
    Ok(sampling)
}

fn metadata(
    options: &FigureCommandOptions,
    survey: &Survey,
    steps: String,
    figure_options: &FigureOptions,
    more: &str,
) -> Metadata {
    let caption = options.caption.as_ref().map_or(String::new(), |caption| format!(" caption={caption:?}"));
    let more = format!(" figure={:?}{more}{caption}", options.kind);
    look::metadata(survey, steps, &figure_options.style, figure_options.size, &more)
}

/// What a figure is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Svg,
    Pdf,
}

impl Format {
    fn of(path: &Path) -> Result<Format, CommandError> {
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("png") => Ok(Format::Png),
            Some("svg") => Ok(Format::Svg),
            Some("pdf") => Ok(Format::Pdf),
            None if output::is_standard_output(path) => Ok(Format::Png),
            None | Some(_) => {
                let expected = "a figure is F.png, F.svg, F.pdf, or - for PNG on standard output";
                Err(CommandError::UnknownKind { path: path.into(), expected })
            }
        }
    }

    fn write(
        self,
        list: &DisplayList,
        metadata: &Metadata,
        output: &mut dyn std::io::Write,
    ) -> Result<(), crate::render::RenderError> {
        match self {
            Format::Png => png::encode(&Painter::new().draw(list), metadata, output),
            Format::Svg => svg::encode(list, metadata, output),
            Format::Pdf => pdf::encode(list, metadata, output),
        }
    }
}
