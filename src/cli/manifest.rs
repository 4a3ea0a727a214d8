//! Manifests: lists of commands that draw pictures, one per line, with paths relative to the folder of the manifest.

use super::picture_arguments::{FigureCommandOptions, RenderOptions};
use super::render::OutputKind;
use super::{Arguments, Command, arguments, figure};
use crate::check::{CheckError, Recipe, ReferenceImage, normalize};
use crate::picture::{PictureOptions, SubjectOptions};
use clap::Parser;
use std::path::{Path, PathBuf};

/// A parsed line.
struct Line {
    output: PathBuf,
    sources: Vec<PathBuf>,
    subject: SubjectOptions,
    options: PictureOptions,
}

/// Reads the pictures that the manifest at `path` lists.
pub fn read(path: &Path) -> Result<Vec<ReferenceImage>, CheckError> {
    let text = std::fs::read_to_string(path).map_err(|source| CheckError::Unreadable { path: path.into(), source })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut references = Vec::new();
    for (number, line) in lines(&text) {
        let (file, recipe) = match parse(&line) {
            Ok(None) => continue,
            Ok(Some(line)) => {
                let sources = line.sources.iter().map(|source| normalize(&folder.join(source))).collect();
                let recipe = Recipe::Listed { subject: line.subject, options: Box::new(line.options), sources };
                (normalize(&folder.join(line.output)), recipe)
            }
            Err(reason) => (path.into(), Recipe::Invalid { reason: format!("line {number}: {reason}") }),
        };
        references.push(ReferenceImage { file, recipe });
    }
    Ok(references)
}

/// The lines with their numbers, from 1. A line that ends in a backslash continues on the next one.
fn lines(text: &str) -> Vec<(usize, String)> {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let mut is_continued = false;
    for (index, line) in text.lines().enumerate() {
        let continued = line.strip_suffix('\\');
        match lines.last_mut() {
            Some((_, previous)) if is_continued => previous.push_str(continued.unwrap_or(line)),
            Some(_) | None => lines.push((index + 1, continued.unwrap_or(line).to_owned())),
        }
        is_continued = continued.is_some();
    }
    lines
}

fn parse(line: &str) -> Result<Option<Line>, String> {
    let words = shlex::split(line).ok_or("a quotation mark is not closed")?;
    match words.first().map(String::as_str) {
        None => return Ok(None),
        Some("rebond") => {}
        Some(other) => return Err(format!("expected a command that begins with rebond, not with {other}")),
    }
    let arguments = Arguments::try_parse_from(words).map_err(|error| first_paragraph(&error.to_string()))?;
    match &arguments.command {
        Command::Render(options) => render_line(options).map(Some),
        Command::Figure(options) => figure_line(options).map(Some),
        _ => Err("only rebond render and rebond figure draw pictures".into()),
    }
}

fn render_line(options: &RenderOptions) -> Result<Line, String> {
    match OutputKind::from_options(options).map_err(|error| error.to_string())? {
        OutputKind::File(subject) => {
            line(&options.output.output, vec![options.source.clone()], subject, options.picture_options())
        }
        OutputKind::Video(_) | OutputKind::Sequence => Err(
            "expected a single picture or animation: OUT.gif, OUT.apng, or with --at STEP OUT.png, OUT.svg or OUT.pdf"
                .into(),
        ),
    }
}

fn figure_line(options: &FigureCommandOptions) -> Result<Line, String> {
    let subject = figure::subject(options).map_err(|error| error.to_string())?;
    line(&options.output.output, options.sources.clone(), subject, options.picture_options())
}

fn line(
    output: &Path,
    sources: Vec<PathBuf>,
    subject: SubjectOptions,
    options: PictureOptions,
) -> Result<Line, String> {
    if arguments::is_standard_output(output) {
        return Err("expected a file name after -o, not standard output".into());
    }
    Ok(Line { output: output.into(), sources, subject, options })
}

/// The first paragraph of an error of the argument parser. The rest explains how to get help.
fn first_paragraph(text: &str) -> String {
    let paragraph = text.split("\n\n").next().unwrap_or(text);
    let lines: Vec<&str> = paragraph.lines().map(str::trim).collect();
    lines.join(" ").trim_start_matches("error: ").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_has_commands_comments_and_continued_lines() {
        let text = "# all figures\n\nrebond figure strobe \\\n  'a b.mcap' -o out/strobe.svg --theme dark # comment\n";
        let found: Vec<_> = lines(text).into_iter().map(|(number, line)| (number, parse(&line).unwrap())).collect();
        let [(1, None), (2, None), (3, Some(line))] = &found[..] else { panic!("{} lines", found.len()) };
        assert_eq!(
            (line.output.as_path(), line.sources.as_slice()),
            (Path::new("out/strobe.svg"), &["a b.mcap".into()][..])
        );
        assert_eq!(line.options.theme, Some(crate::picture::Theme::Dark));
    }

    #[test]
    fn a_line_that_draws_no_single_picture_is_an_error_of_one_line() {
        for (line, expected) in [
            ("rebond figure strobe a.mcap -o 'b.svg", "not closed"),
            ("convert a.png b.png", "begins with rebond"),
            ("rebond replay a.mcap", "only rebond render"),
            ("rebond render a.mcap -o frames/", "single picture or animation"),
            ("rebond render a.mcap -o a.mp4", "single picture or animation"),
            ("rebond render a.mcap -o a.png", "--at STEP"),
            ("rebond figure strobe a.mcap -o -", "not standard output"),
            ("rebond figure strobe a.mcap -o a.gif", "expected F.png"),
            ("rebond figure strobe a.mcap -o a.svg --themes dark", "unexpected argument '--themes'"),
            ("rebond figure strobe", "required"),
        ] {
            let reason = parse(line).err().unwrap_or_else(|| panic!("{line}: no error"));
            assert!(reason.contains(expected) && !reason.contains('\n'), "{line}: {reason}");
        }
    }
}
