use super::files::CACHE_TAG;
use super::{CheckResult, Decision, Mismatch, Outcome, Replacement, Severity, ShownPicture};
use crate::picture::{AnimationFormat, Format, StillFormat};
use crate::picture::{Metadata, RenderError, png};
use crate::temporary::TemporaryFolder;
use crate::text::Escaped;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// A folder with a page, `index.html`, that shows every difference: expected, difference and actual. The page loads
/// nothing from outside the folder.
///
/// The folder is created only if there is a difference to show, and appears as a whole.
pub struct Page {
    folder: PathBuf,
    /// The folder until it is complete.
    staging: Option<TemporaryFolder>,
    cards: Vec<String>,
    /// The entries of the index.
    entries: Vec<String>,
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
            let message = "it is not the report of an earlier check";
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
        }
        Ok(Page { folder: folder.into(), staging: None, cards: Vec::new(), entries: Vec::new() })
    }

    /// Adds a result, unless it is [`Severity::Same`]. Returns the files written for it.
    ///
    /// # Errors
    /// If a file cannot be read or written.
    pub fn add(&mut self, result: &CheckResult, decision: &Decision) -> io::Result<Vec<PathBuf>> {
        if result.outcome.severity() == Severity::Same {
            return Ok(Vec::new());
        }
        let staging = match self.staging.take() {
            Some(staging) => staging,
            None => {
                // The nearest folder that exists is on the same disk, so that the page can be renamed.
                let existing = self.folder.ancestors().skip(1).find(|folder| folder.is_dir());
                let staging = TemporaryFolder::create(existing.unwrap_or(Path::new(".")))?;
                fs::write(staging.path().join(CACHE_TAG), TAG)?;
                staging
            }
        };
        let staging = self.staging.insert(staging);
        let name = format!("{:03}-{}", self.cards.len() + 1, file_name_of(&result.path));
        let mut figures = Figures { folder: staging.path(), name, html: String::new(), files: Vec::new() };
        match (&result.outcome, &result.replacement) {
            (Outcome::Differs(mismatch), Some(Replacement::Picture(actual))) => {
                figures.add_difference(mismatch, &result.path, actual)?;
            }
            (_, Some(Replacement::Picture(actual))) => figures.add_actual(actual)?,
            (_, Some(Replacement::Recording(_) | Replacement::Run(_)) | None) => {}
        }
        let Figures { html, files, .. } = figures;
        let [path, word, sentence] =
            [result.path.display().to_string(), result.outcome.word().to_owned(), result.outcome.to_string()]
                .map(|text| Escaped(&text).to_string());
        let details = sentence.strip_prefix(&format!("{word}: ")).unwrap_or(&sentence);
        let note = match decision {
            Decision::NothingToAccept | Decision::Accepted => String::new(),
            Decision::Acceptable(command) => format!("<p>Accept: <code>{}</code></p>\n", Escaped(command)),
            Decision::Refused(reason) => format!("<p>Not acceptable: {}</p>\n", Escaped(reason)),
        };
        let number = self.cards.len() + 1;
        self.entries.push(format!("<li><a href=\"#case-{number}\">{path}</a> <b>{word}</b></li>\n"));
        self.cards.push(format!(
            "<section id=\"case-{number}\">\n<h2>{path} <b>{word}</b></h2>\n<p>{details}</p>\n{note}{html}</section>\n"
        ));
        Ok(files.iter().filter_map(|file| file.file_name()).map(|name| self.folder.join(name)).collect())
    }

    /// Returns the present place of a file of the page, before the page is finished.
    pub fn staged(&self, file: &Path) -> PathBuf {
        let staging = self.staging.as_ref().zip(file.file_name());
        staging.map_or(file.into(), |(staging, name)| staging.path().join(name))
    }

    /// Writes the page, if there is anything to show, and returns its path.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self, summary: &str) -> io::Result<Option<PathBuf>> {
        let Some(staging) = self.staging else { return Ok(None) };
        let page = staging.path().join("index.html");
        let cards: String = self.cards.concat();
        let entries: String = self.entries.concat();
        let title = format!("<h1>rebond check</h1>\n<p>{}</p>\n", Escaped(summary));
        fs::write(&page, format!("{HEAD}{title}<ol>\n{entries}</ol>\n{cards}</html>\n"))?;
        if let Some(parent) = self.folder.parent() {
            fs::create_dir_all(parent)?;
        }
        // An empty folder may be there.
        let _ = fs::remove_dir(&self.folder);
        fs::rename(staging.path(), &self.folder)?;
        Ok(Some(self.folder.join("index.html")))
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
        for (index, ShownPicture { caption, picture }) in mismatch.shown.iter().enumerate() {
            let number = if index == 0 { String::new() } else { format!("-{}", index + 1) };
            let name = format!("{}{number}.png", self.name);
            let file = BufWriter::new(File::create(self.folder.join(&name))?);
            png::encode(picture, &Metadata::default(), png::PngEffort::Fast, file).map_err(to_io_error)?;
            self.files.push(self.folder.join(&name));
            self.html += &format!("<div>{}</div>\n", figure(&name, caption));
        }
        if !mismatch.shown.is_empty() && mismatch.format == Format::Still(StillFormat::Png) {
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
        png::encode(&picture, &Metadata::default(), png::PngEffort::Small, &mut file).unwrap();
        CheckResult {
            path: path.into(),
            replacement: Some(Replacement::Picture(file)),
            ..CheckResult::new(path.into(), Outcome::Missing("it is missing".into()))
        }
    }

    #[test]
    fn a_page_replaces_an_earlier_page_and_nothing_else() {
        let folder = tempfile::TempDir::new().unwrap();
        let report = folder.path().join("report");
        for name in ["a<b.png", "c.png"] {
            let mut page = Page::new(&report).unwrap();
            let files = page.add(&missing(name), &Decision::Accepted).unwrap();
            assert!(page.staged(&files[0]).exists() && !report.exists());
            let index = page.finish("one & all").unwrap().unwrap();
            assert!(files[0].exists());
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
        page.add(&CheckResult::new("a".into(), Outcome::Identical), &Decision::NothingToAccept).unwrap();
        assert_eq!(page.finish("").unwrap(), None);
        assert!(!report.exists());
    }
}
