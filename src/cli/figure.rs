use super::arguments::is_standard_output;
use super::error::CommandError;
use super::output_file::{OutputFile, Overwrite};
use super::picture_arguments::FigureCommandOptions;
use super::source::{OpenedSource, SourceArgument, Verification};
use super::{Exit, output};
use crate::picture::{self, SOFTWARE, StillFormat, SubjectOptions};
use std::num::NonZero;
use std::path::{Path, PathBuf};

/// Draws one lecture figure.
pub fn run(options: &FigureCommandOptions) -> Result<Exit, CommandError> {
    let path = &options.output.output;
    let subject = subject(options)?;
    let inputs: Vec<&Path> = options.sources.iter().map(PathBuf::as_path).collect();
    let mut output = OutputFile::create(path, Overwrite::from_force(options.output.force), &inputs)?;
    let sources = SourceArgument::all(&options.sources, &options.set)?;
    let sources = OpenedSource::open_all(&sources, Verification::None, &mut output)?;
    let recordings: Vec<picture::Source> = sources.iter().map(|source| source.recording.clone()).collect();
    let bar = output::progress_bar("drawing", 0);
    let mut on_progress = output::progress_updater(&bar);
    let (mut picture_options, threads) = (options.picture_options(), NonZero::<usize>::MIN);
    if !options.set.is_empty() {
        picture_options = picture_options.with_titles_of_runs(&recordings);
    }
    let (_, drawn) = output.write(|output| {
        let (options, progress) = (&picture_options, &mut on_progress);
        Ok(picture::draw_options(&subject, options, &recordings, SOFTWARE, threads, progress, output)?)
    })?;
    bar.finish_and_clear();
    drawn.warnings.iter().for_each(|warning| output::info(format_args!("{warning}")));
    Ok(sources.iter().fold(output::warn_of_damage(&drawn.statuses), |exit, source| source.file.exit(exit)))
}

/// The figure, and the format that the name of the output indicates.
pub fn subject(options: &FigureCommandOptions) -> Result<SubjectOptions, CommandError> {
    let path: &Path = &options.output.output;
    let format = match StillFormat::from_path(path) {
        None if is_standard_output(path) => Some(StillFormat::Png),
        format => format,
    };
    match format {
        Some(format) => Ok(SubjectOptions::Figure { figure: options.figure()?, format }),
        None => {
            let expected = "expected F.png, F.svg or F.pdf, or - for PNG on standard output";
            Err(CommandError::UnsupportedOutput { path: path.into(), expected })
        }
    }
}
