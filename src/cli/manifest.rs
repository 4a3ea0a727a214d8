//! Manifests: lists of commands that record scenes and draw pictures, one per line, with paths relative to the folder
//! of the manifest.

use super::arguments::RecordOptions;
use super::picture_arguments::{FigureCommandOptions, RenderOptions};
use super::render::OutputKind;
use super::{Arguments, Command, arguments, figure};
use crate::check::{
    Manifest, ManifestLine, Problem, Recipe, RecordCommand, RecordingRecipe, ReferenceImage, ReferenceRecording,
    normalize,
};
use crate::picture::{PictureOptions, SubjectOptions};
use crate::scene::{Override, Sweep};
use clap::Parser;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A parsed line.
#[derive(Debug)]
enum Line {
    /// Blank, or a comment.
    Empty,
    /// `skip SCENE…`: no recording of these scenes is kept.
    Skip(Vec<PathBuf>),
    Record {
        output: PathBuf,
        command: Box<RecordCommand>,
    },
    Draw {
        output: PathBuf,
        sources: Vec<PathBuf>,
        runs: Vec<Vec<Override>>,
        subject: SubjectOptions,
        options: Box<PictureOptions>,
    },
}

/// Reads the manifest at `path`.
pub fn read(path: &Path) -> Result<Manifest, Problem> {
    let bytes = std::fs::read(path).map_err(|error| Problem::unreadable(path, &error))?;
    let text = String::from_utf8(bytes).map_err(|_| {
        let error = std::io::Error::new(std::io::ErrorKind::InvalidData, "it is not UTF-8");
        Problem::unreadable(path, &error)
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let folder = path.parent().unwrap_or(Path::new(""));
    let in_folder = |path: &Path| normalize(&folder.join(path));
    let mut manifest = Manifest {
        path: path.into(),
        recordings: Vec::new(),
        pictures: Vec::new(),
        skipped: Vec::new(),
        problems: Vec::new(),
    };
    for (number, text) in lines(text) {
        let line = ManifestLine { manifest: Arc::clone(&manifest.path), number };
        match parse(&text) {
            Ok(Line::Empty) => {}
            Ok(Line::Skip(scenes)) => {
                for scene in scenes.iter().map(|scene| in_folder(scene)) {
                    if scene.is_file() {
                        manifest.skipped.push(scene)
                    } else {
                        manifest.problems.push(Problem {
                            path: path.into(),
                            line: Some(line.clone()),
                            reason: format!("line {number}: the scene {} does not exist", scene.display()),
                            is_missing: false,
                        })
                    }
                }
            }
            Ok(Line::Record { output, mut command }) => {
                command.scene = in_folder(&command.scene);
                command.events = command.events.as_deref().map(in_folder);
                let recipe = RecordingRecipe::Listed { command: *command, line };
                manifest.recordings.push(ReferenceRecording { file: in_folder(&output), recipe });
            }
            Ok(Line::Draw { output, sources, runs, subject, options }) => {
                let sources = sources.iter().map(|source| in_folder(source)).collect();
                let recipe = Recipe::Listed { subject, options, sources, runs, line };
                manifest.pictures.push(ReferenceImage { file: in_folder(&output), recipe });
            }
            Err(reason) => {
                let reason = format!("line {number}: {reason}");
                manifest.problems.push(Problem { path: path.into(), line: Some(line), reason, is_missing: false });
            }
        }
    }
    Ok(manifest)
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

fn parse(line: &str) -> Result<Line, String> {
    let words = shlex::split(line).ok_or("a quotation mark is not closed")?;
    match words.split_first() {
        None => return Ok(Line::Empty),
        Some((word, _)) if word == "rebond" => {}
        Some((word, scenes)) if word == "skip" && !scenes.is_empty() => {
            return Ok(Line::Skip(scenes.iter().map(PathBuf::from).collect()));
        }
        Some((word, _)) if word == "skip" => return Err("expected the names of scenes after skip".into()),
        Some((other, _)) => return Err(format!("expected a command that begins with rebond, not with {other}")),
    }
    let arguments = Arguments::try_parse_from(words).map_err(|error| first_paragraph(&error.to_string()))?;
    match arguments.command {
        Command::Record(options) => record_line(options),
        Command::Render(options) => render_line(&options),
        Command::Figure(options) => figure_line(&options),
        _ => Err("only rebond record, rebond render and rebond figure make files to check".into()),
    }
}

fn record_line(options: RecordOptions) -> Result<Line, String> {
    let RecordOptions { scene, output, events, set, steps, every, viewer, accuracy, lenient, .. } = options;
    if [Some(&scene), Some(&output), events.as_ref()]
        .into_iter()
        .flatten()
        .any(|path| arguments::is_standard_output(path))
    {
        return Err("expected file names, not - for standard input and output".into());
    }
    if output.extension().is_none_or(|extension| extension != "mcap") {
        return Err(format!("expected a name that ends in .mcap after -o, not {}", output.display()));
    }
    let command = RecordCommand { scene, overrides: set, events, steps, every, viewer, accuracy, lenient };
    Ok(Line::Record { output, command: Box::new(command) })
}

fn render_line(options: &RenderOptions) -> Result<Line, String> {
    match OutputKind::from_options(options).map_err(|error| error.to_string())? {
        OutputKind::File(subject) => {
            let runs = Sweep::combinations(&options.set)?;
            draw_line(&options.output.output, options.sources.clone(), runs, subject, options.picture_options())
        }
        OutputKind::Video(_) | OutputKind::Sequence => Err(
            "expected a single picture or animation: OUT.gif, OUT.apng, or with --at STEP OUT.png, OUT.svg or OUT.pdf"
                .into(),
        ),
    }
}

fn figure_line(options: &FigureCommandOptions) -> Result<Line, String> {
    let subject = figure::subject(options).map_err(|error| error.to_string())?;
    let runs = Sweep::combinations(&options.set)?;
    draw_line(&options.output.output, options.sources.clone(), runs, subject, options.picture_options())
}

fn draw_line(
    output: &Path,
    sources: Vec<PathBuf>,
    runs: Vec<Vec<Override>>,
    subject: SubjectOptions,
    options: PictureOptions,
) -> Result<Line, String> {
    if arguments::is_standard_output(output) {
        return Err("expected a file name after -o, not standard output".into());
    }
    Ok(Line::Draw { output: output.into(), sources, runs, subject, options: Box::new(options) })
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
    use clap::CommandFactory;

    #[test]
    fn the_example_in_the_help_is_a_manifest() {
        let help = Arguments::command().find_subcommand("check").unwrap().get_after_help().unwrap().to_string();
        let (_, example) = help.split_once("relative to its folder:\n").unwrap();
        let (example, _) = example.split_once("Exit codes").unwrap();
        let found: Vec<_> = lines(example).into_iter().map(|(_, line)| parse(&line).unwrap()).collect();
        let [Line::Record { .. }, Line::Draw { .. }, Line::Skip(scenes)] = &found[..] else { panic!("{found:?}") };
        assert_eq!(scenes, &[PathBuf::from("large.toml")]);
    }

    #[test]
    fn a_manifest_has_commands_comments_and_continued_lines() {
        let text = "# all figures\n\nrebond figure strobe \\\n  'a b.mcap' -o out/strobe.svg --theme dark # comment\n";
        let found: Vec<_> = lines(text).into_iter().map(|(number, line)| (number, parse(&line).unwrap())).collect();
        let [(1, Line::Empty), (2, Line::Empty), (3, Line::Draw { output, sources, options, .. })] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!((output.as_path(), sources.as_slice()), (Path::new("out/strobe.svg"), &["a b.mcap".into()][..]));
        assert_eq!(options.theme, Some(crate::picture::Theme::Dark));
    }

    #[test]
    fn a_byte_order_mark_before_a_manifest_is_skipped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("all.check");
        std::fs::write(&path, "\u{feff}rebond figure strobe a.mcap -o a.svg\n").unwrap();
        let manifest = read(&path).unwrap();
        assert_eq!((manifest.pictures.len(), manifest.problems.len()), (1, 0));
    }

    #[test]
    fn a_line_that_makes_no_file_to_check_is_an_error_of_one_line() {
        for (line, expected) in [
            ("rebond figure strobe a.mcap -o 'b.svg", "not closed"),
            ("convert a.png b.png", "begins with rebond"),
            ("rebond replay a.mcap", "only rebond record"),
            ("rebond record a.toml -o -", "file names"),
            ("rebond record a.toml -o a.toml", "ends in .mcap"),
            ("skip", "names of scenes"),
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
