use super::case::CACHE_TAG;
use super::{CheckResult, Mismatch, Outcome, Replacement, Severity};
use crate::picture::{AnimationFormat, Format, StillFormat};
use crate::picture::{Metadata, RenderError, png};
use crate::text::Escaped;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// A folder with a page, `index.html`, that shows every difference: expected, difference and actual. The page loads
/// nothing from outside the folder.
///
/// The folder is created only if there is a difference to show.
pub struct Page {
    folder: PathBuf,
    cards: Vec<String>,
}

/// The content of the file that marks the folder as a cache, which backups and [`Files`](super::Files) skip, and as a
/// report of `rebond check`, which a later check may delete. Reports of all versions have this content.
const TAG: &str = "Signature: 8a477f597d28d172789f06886806bc55\n# What `rebond check` found to differ.\n";

const HEAD: &str = include_str!("page.html");

impl Page {
    /// Prepares a page in `folder`, and removes an earlier page there.
    ///
    /// # Errors
    /// If the earlier page cannot be removed, or the folder contains anything else.
    pub fn new(folder: &Path) -> io::Result<Page> {
        let is_empty = || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
        if fs::read_to_string(folder.join(CACHE_TAG)).is_ok_and(|tag| tag == TAG) {
            fs::remove_dir_all(folder)?;
        } else if folder.symlink_metadata().is_ok() && !is_empty() {
            let message = "it is not the report of an earlier check; choose another folder with --report";
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
        }
        Ok(Page { folder: folder.into(), cards: Vec::new() })
    }

    /// Adds a result, unless it is [`Severity::Same`]. Returns the files written for it.
    ///
    /// # Errors
    /// If a file cannot be read or written.
    pub fn add(&mut self, result: &CheckResult) -> io::Result<Vec<PathBuf>> {
        if result.outcome.severity() == Severity::Same {
            return Ok(Vec::new());
        }
        if self.cards.is_empty() {
            fs::create_dir_all(&self.folder)?;
            fs::write(self.folder.join(CACHE_TAG), TAG)?;
        }
        let name = format!("{:03}-{}", self.cards.len() + 1, file_name_of(&result.path));
        let mut figures = Figures { folder: &self.folder, name, html: String::new(), files: Vec::new() };
        match (&result.outcome, &result.replacement) {
            (Outcome::Differs(mismatch), Some(Replacement::Picture(actual))) => {
                figures.add_difference(mismatch, &result.path, actual)?;
            }
            (_, Some(Replacement::Picture(actual))) => figures.add_actual(actual)?,
            (_, Some(Replacement::Recording(_)) | None) => {}
        }
        let Figures { html, files, .. } = figures;
        let [path, word, sentence] =
            [result.path.display().to_string(), result.outcome.word().to_owned(), result.outcome.to_string()]
                .map(|text| Escaped(&text).to_string());
        let details = sentence.strip_prefix(&format!("{word}: ")).unwrap_or(&sentence);
        self.cards.push(format!("<section>\n<h2>{path} <b>{word}</b></h2>\n<p>{details}</p>\n{html}</section>\n"));
        Ok(files)
    }

    /// Writes the page, if there is anything to show, and returns its path.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self, summary: &str) -> io::Result<Option<PathBuf>> {
        if self.cards.is_empty() {
            return Ok(None);
        }
        let page = self.folder.join("index.html");
        let cards: String = self.cards.concat();
        fs::write(&page, format!("{HEAD}<h1>rebond check</h1>\n<p>{}</p>\n{cards}</html>\n", Escaped(summary)))?;
        Ok(Some(page))
    }
}

/// The pictures of one result: the files written, and the HTML that shows them.
struct Figures<'a> {
    folder: &'a Path,
    name: String,
    html: String,
    files: Vec<PathBuf>,
}

impl Figures<'_> {
    fn add_difference(&mut self, mismatch: &Mismatch, expected: &Path, actual: &[u8]) -> io::Result<()> {
        if let Some(comparison) = &mismatch.comparison {
            let name = format!("{}.png", self.name);
            let file = BufWriter::new(File::create(self.folder.join(&name))?);
            png::encode(comparison, &Metadata::default(), file).map_err(to_io_error)?;
            self.files.push(self.folder.join(&name));
            self.html += &format!("<div>{}</div>\n", figure(&name, "expected · difference · actual"));
        }
        if mismatch.comparison.is_some() && mismatch.format == Format::Still(StillFormat::Png) {
            return Ok(());
        }
        let expected = self.write("expected", &fs::read(expected)?)?;
        let actual = self.write("actual", actual)?;
        let [left, right] = [figure(&expected, "expected"), figure(&actual, "actual")];
        self.html += &match mismatch.format {
            Format::Still(StillFormat::Svg) => {
                format!("<div>{left}{}{right}</div>\n", overlay(&expected, &actual))
            }
            Format::Still(StillFormat::Png | StillFormat::Pdf) | Format::Animation(_) => {
                format!("<div>{left}{right}</div>\n")
            }
        };
        Ok(())
    }

    fn add_actual(&mut self, actual: &[u8]) -> io::Result<()> {
        let name = self.write("actual", actual)?;
        self.html += &format!("<div>{}</div>\n", figure(&name, "actual"));
        Ok(())
    }

    fn write(&mut self, role: &str, content: &[u8]) -> io::Result<String> {
        let extension = match Format::from_content(content) {
            Some(Format::Still(StillFormat::Png) | Format::Animation(AnimationFormat::Apng)) => "png",
            Some(Format::Animation(AnimationFormat::Gif)) => "gif",
            Some(Format::Still(StillFormat::Svg)) => "svg",
            Some(Format::Still(StillFormat::Pdf)) => "pdf",
            None => "bin",
        };
        let name = format!("{}-{role}.{extension}", self.name);
        fs::write(self.folder.join(&name), content)?;
        self.files.push(self.folder.join(&name));
        Ok(name)
    }
}

fn figure(name: &str, caption: &str) -> String {
    let name = Escaped(name).to_string();
    let content = match Path::new(&name).extension().and_then(OsStr::to_str) {
        Some("pdf") => format!("<object data=\"{name}\" type=\"application/pdf\">{name}</object>"),
        Some(_) | None => format!("<img src=\"{name}\" alt=\"{caption}\" loading=\"lazy\">"),
    };
    format!("<figure><a href=\"{name}\">{content}</a><figcaption>{caption}</figcaption></figure>")
}

/// An overlay of two images in CSS difference mode: identical pixels are black.
fn overlay(expected: &str, actual: &str) -> String {
    let [expected, actual] = [expected, actual].map(|name| Escaped(name).to_string());
    format!(
        "<figure><span class=\"over\"><img src=\"{expected}\" alt=\"\"><img src=\"{actual}\" alt=\"\"></span>\
         <figcaption>difference</figcaption></figure>"
    )
}

/// Converts a path to a file name.
fn file_name_of(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |character: char| character.is_ascii_alphanumeric() || character == '-' || character == '_';
    let name: String = text.chars().map(|character| if is_plain(character) { character } else { '-' }).collect();
    name.trim_matches('-').to_owned()
}

fn to_io_error(error: RenderError) -> io::Error {
    match error {
        RenderError::Write(error) => error,
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Picture;

    fn missing(path: &str) -> CheckResult {
        let picture = Picture { size: [1, 1], pixels: vec![[1, 2, 3, 255]] };
        let mut file = Vec::new();
        png::encode(&picture, &Metadata::default(), &mut file).unwrap();
        CheckResult { path: path.into(), outcome: Outcome::Missing, replacement: Some(Replacement::Picture(file)) }
    }

    #[test]
    fn a_page_replaces_an_earlier_page_and_nothing_else() {
        let folder = tempfile::TempDir::new().unwrap();
        let report = folder.path().join("report");
        for name in ["a<b.png", "c.png"] {
            let mut page = Page::new(&report).unwrap();
            let files = page.add(&missing(name)).unwrap();
            assert!(files[0].exists());
            let index = page.finish("one & all").unwrap().unwrap();
            let html = fs::read_to_string(index).unwrap();
            assert!(html.contains(&format!("<h2>{} <b>missing</b>", Escaped(name))) && html.contains("one &amp; all"));
            assert_eq!(fs::read_dir(&report).unwrap().count(), 3, "tag, picture, page");
        }
        Page::new(&report).unwrap();
        assert!(!report.exists());
        fs::create_dir(&report).unwrap();
        fs::write(report.join("thesis.txt"), "").unwrap();
        assert!(Page::new(&report).is_err() && report.join("thesis.txt").exists());
    }

    #[test]
    fn a_check_without_differences_leaves_no_page() {
        let folder = tempfile::TempDir::new().unwrap();
        let report = folder.path().join("report");
        let mut page = Page::new(&report).unwrap();
        page.add(&CheckResult { path: "a".into(), outcome: Outcome::Identical, replacement: None }).unwrap();
        assert_eq!(page.finish("").unwrap(), None);
        assert!(!report.exists());
    }
}
