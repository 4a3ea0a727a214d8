//! A manifest is a list of commands: each line is one that draws a picture, as it would be typed in
//! the manifest's folder.

use crate::check::{CheckError, Drawing, Reference, plain};
use crate::cli::arguments::{Arguments, Command};
use crate::cli::picture_arguments::{FigureCommandOptions, RenderOptions};
use crate::cli::{figure, output, render};
use crate::illustration::Wish;
use clap::Parser;
use std::path::{Path, PathBuf};

/// What is read of a line: the file it draws, of what, and how.
struct Line {
    output: PathBuf,
    sources: Vec<PathBuf>,
    wish: Wish,
    format: crate::illustration::Format,
}

/// The pictures that the manifest at `path` lists.
pub fn read(path: &Path) -> Result<Vec<Reference>, CheckError> {
    let text = std::fs::read_to_string(path).map_err(|source| CheckError::Unreadable { path: path.into(), source })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let reference = |(number, line): (usize, String)| match parse(&line) {
        Ok(None) => None,
        Ok(Some(line)) => {
            let sources = line.sources.iter().map(|source| plain(&folder.join(source))).collect();
            let drawing = Drawing::Wished { wish: Box::new(line.wish), sources, format: line.format };
            Some(Reference { file: plain(&folder.join(line.output)), drawing })
        }
        Err(why) => {
            Some(Reference { file: path.into(), drawing: Drawing::Refused { why: format!("line {number}: {why}") } })
        }
    };
    Ok(lines(&text).into_iter().filter_map(reference).collect())
}

/// The lines with their numbers from 1; one that ends in a backslash goes on in the next.
fn lines(text: &str) -> Vec<(usize, String)> {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let mut goes_on = false;
    for (place, line) in text.lines().enumerate() {
        let begin = line.strip_suffix('\\');
        match lines.last_mut() {
            Some((_, before)) if goes_on => before.push_str(begin.unwrap_or(line)),
            Some(_) | None => lines.push((place + 1, begin.unwrap_or(line).to_owned())),
        }
        goes_on = begin.is_some();
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
        Command::Render(options) => rendered(options).map(Some),
        Command::Figure(options) => drawn(options).map(Some),
        _ => Err("only rebond render and rebond figure draw pictures".into()),
    }
}

fn rendered(options: &RenderOptions) -> Result<Line, String> {
    let (wish, format) = render::picture_wish(options)
        .map_err(|error| error.to_string())?
        .ok_or("a reference is one picture or animation: OUT.gif, OUT.apng, or --at STEP and OUT.png, .svg or .pdf")?;
    line(&options.output.output, vec![options.source.clone()], wish, format)
}

fn drawn(options: &FigureCommandOptions) -> Result<Line, String> {
    let format = figure::format(&options.output.output).map_err(|error| error.to_string())?;
    line(&options.output.output, options.sources.clone(), figure::wish(options), format)
}

fn line(output: &Path, sources: Vec<PathBuf>, wish: Wish, format: crate::illustration::Format) -> Result<Line, String> {
    if output::is_standard_output(output) {
        return Err("a reference is a file: give it a name with -o".into());
    }
    Ok(Line { output: output.into(), sources, wish, format })
}

/// What the argument parser says first; the rest is how to ask for help.
fn first_paragraph(text: &str) -> String {
    let paragraph = text.split("\n\n").next().unwrap_or(text);
    let lines: Vec<&str> = paragraph.lines().map(str::trim).collect();
    lines.join(" ").trim_start_matches("error: ").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_commands_and_comments() {
        let text = "# all of it\n\nrebond figure strobe \\\n  'a b.mcap' -o out/strobe.svg --theme dark # why\n";
        let found: Vec<_> = lines(text).into_iter().map(|(number, line)| (number, parse(&line).unwrap())).collect();
        let [(1, None), (2, None), (3, Some(line))] = &found[..] else { panic!("{} lines", found.len()) };
        assert_eq!(
            (line.output.as_path(), line.sources.as_slice()),
            (Path::new("out/strobe.svg"), &["a b.mcap".into()][..])
        );
        assert_eq!(line.wish.theme, Some(crate::scene::Theme::Dark));
    }

    #[test]
    fn what_draws_no_reference_is_refused_in_one_line() {
        for (line, reason) in [
            ("rebond figure strobe a.mcap -o 'b.svg", "not closed"),
            ("convert a.png b.png", "begins with rebond"),
            ("rebond replay a.mcap", "only rebond render"),
            ("rebond render a.mcap -o frames/", "one picture or animation"),
            ("rebond render a.mcap -o a.mp4", "one picture or animation"),
            ("rebond render a.mcap -o a.png", "--at STEP"),
            ("rebond figure strobe a.mcap -o -", "is a file"),
            ("rebond figure strobe a.mcap -o a.gif", "a figure is"),
            ("rebond figure strobe a.mcap -o a.svg --themes dark", "unexpected argument '--themes'"),
            ("rebond figure strobe", "required"),
        ] {
            let why = parse(line).err().unwrap_or_else(|| panic!("{line}: no error"));
            assert!(why.contains(reason) && !why.contains('\n'), "{line}: {why}");
        }
    }
}
