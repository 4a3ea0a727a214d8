use super::find::CACHE_TAG;
use super::{Finding, Fresh, Grade, Mismatch, Outcome};
use crate::illustration::Format;
use crate::render::{Metadata, RenderError, png};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// A folder with a page, `index.html`, that shows all that is not as it should be: expected,
/// difference and actual. It opens from disk and needs nothing else.
///
/// The folder is there only once there is something to show.
pub struct Page {
    folder: PathBuf,
    cards: Vec<String>,
}

/// Marks a folder as a cache, which backups and [`find`](super::find()) leave alone, and as ours.
const TAG: &str = "Signature: 8a477f597d28d172789f06886806bc55\n# What `rebond check` found to differ.\n";

const HEAD: &str = include_str!("page.html");

impl Page {
    /// A page in that folder, where an earlier one is taken away.
    ///
    /// # Errors
    /// When it cannot be, or something else stands there.
    pub fn new(folder: &Path) -> io::Result<Page> {
        let is_empty = || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
        if fs::read_to_string(folder.join(CACHE_TAG)).is_ok_and(|tag| tag == TAG) {
            fs::remove_dir_all(folder)?;
        } else if folder.symlink_metadata().is_ok() && !is_empty() {
            let what =
                "something that is no report of an earlier check stands there; name another folder with --report";
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, what));
        }
        Ok(Page { folder: folder.into(), cards: Vec::new() })
    }

    /// Shows a finding, if it is not as it should be. Gives the files written for it.
    ///
    /// # Errors
    /// When a file cannot be read or written.
    pub fn add(&mut self, finding: &Finding) -> io::Result<Vec<PathBuf>> {
        if finding.outcome.grade() == Grade::Same {
            return Ok(Vec::new());
        }
        if self.cards.is_empty() {
            fs::create_dir_all(&self.folder)?;
            fs::write(self.folder.join(CACHE_TAG), TAG)?;
        }
        let name = format!("{:03}-{}", self.cards.len() + 1, flat(&finding.path));
        let mut figures = Figures { folder: &self.folder, name, html: String::new(), files: Vec::new() };
        match (&finding.outcome, &finding.fresh) {
            (Outcome::Differs(mismatch), Some(Fresh::Picture(actual))) => {
                figures.differing(mismatch, &finding.path, actual)?;
            }
            (_, Some(Fresh::Picture(actual))) => figures.actual(actual)?,
            (_, Some(Fresh::Recording(_)) | None) => {}
        }
        let Figures { html, files, .. } = figures;
        let [path, word, what] =
            [finding.path.display().to_string(), finding.outcome.word().to_owned(), finding.outcome.to_string()]
                .map(|text| escaped(&text));
        let what = what.strip_prefix(&format!("{word}: ")).unwrap_or(&what);
        self.cards.push(format!("<section>\n<h2>{path} <b>{word}</b></h2>\n<p>{what}</p>\n{html}</section>\n"));
        Ok(files)
    }

    /// Writes the page, if there is anything to show, and says where it is.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(self, summary: &str) -> io::Result<Option<PathBuf>> {
        if self.cards.is_empty() {
            return Ok(None);
        }
        let page = self.folder.join("index.html");
        let cards: String = self.cards.concat();
        fs::write(&page, format!("{HEAD}<h1>rebond check</h1>\n<p>{}</p>\n{cards}</html>\n", escaped(summary)))?;
        Ok(Some(page))
    }
}

/// The pictures of one finding, written and as HTML.
struct Figures<'a> {
    folder: &'a Path,
    name: String,
    html: String,
    files: Vec<PathBuf>,
}

impl Figures<'_> {
    fn differing(&mut self, mismatch: &Mismatch, expected: &Path, actual: &[u8]) -> io::Result<()> {
        if let Some(shown) = &mismatch.shown {
            let name = format!("{}.png", self.name);
            let file = BufWriter::new(File::create(self.folder.join(&name))?);
            png::encode(shown, &Metadata::default(), file).map_err(refusal)?;
            self.files.push(self.folder.join(&name));
            self.html += &format!("<div>{}</div>\n", picture(&name, "expected · difference · actual"));
        }
        if mismatch.shown.is_some() && mismatch.format == Format::Png {
            return Ok(());
        }
        let was = self.put("expected", &fs::read(expected)?)?;
        let is = self.put("actual", actual)?;
        let [left, right] = [picture(&was, "expected"), picture(&is, "actual")];
        self.html += &match mismatch.format {
            Format::Svg => format!("<div>{left}{}{right}</div>\n", laid_over(&was, &is)),
            Format::Png | Format::Pdf | Format::Gif | Format::Apng => format!("<div>{left}{right}</div>\n"),
        };
        Ok(())
    }

    fn actual(&mut self, actual: &[u8]) -> io::Result<()> {
        let name = self.put("actual", actual)?;
        self.html += &format!("<div>{}</div>\n", picture(&name, "actual"));
        Ok(())
    }

    fn put(&mut self, which: &str, content: &[u8]) -> io::Result<String> {
        let extension = match Format::of_content(content) {
            Some(Format::Png | Format::Apng) => "png",
            Some(Format::Gif) => "gif",
            Some(Format::Svg) => "svg",
            Some(Format::Pdf) => "pdf",
            None => "bin",
        };
        let name = format!("{}-{which}.{extension}", self.name);
        fs::write(self.folder.join(&name), content)?;
        self.files.push(self.folder.join(&name));
        Ok(name)
    }
}

fn picture(name: &str, caption: &str) -> String {
    let name = escaped(name);
    let shown = match Path::new(&name).extension().and_then(OsStr::to_str) {
        Some("pdf") => format!("<object data=\"{name}\" type=\"application/pdf\">{name}</object>"),
        Some(_) | None => format!("<img src=\"{name}\" alt=\"{caption}\" loading=\"lazy\">"),
    };
    format!("<figure><a href=\"{name}\">{shown}</a><figcaption>{caption}</figcaption></figure>")
}

/// What differs of two drawings of shapes the browser shows by itself: what is the same is black.
fn laid_over(expected: &str, actual: &str) -> String {
    let [expected, actual] = [expected, actual].map(escaped);
    format!(
        "<figure><span class=\"over\"><img src=\"{expected}\" alt=\"\"><img src=\"{actual}\" alt=\"\"></span>\
         <figcaption>difference</figcaption></figure>"
    )
}

/// A path as the name of one file.
fn flat(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |character: char| character.is_ascii_alphanumeric() || character == '-' || character == '_';
    let flat: String = text.chars().map(|character| if is_plain(character) { character } else { '-' }).collect();
    flat.trim_matches('-').to_owned()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn refusal(error: RenderError) -> io::Error {
    match error {
        RenderError::Write(error) => error,
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Picture;

    fn missing(path: &str) -> Finding {
        let picture = Picture { size: [1, 1], pixels: vec![[1, 2, 3, 255]] };
        let mut file = Vec::new();
        png::encode(&picture, &Metadata::default(), &mut file).unwrap();
        Finding { path: path.into(), outcome: Outcome::Missing, fresh: Some(Fresh::Picture(file)) }
    }

    #[test]
    fn a_page_takes_the_place_of_an_earlier_one_and_of_nothing_else() {
        let folder = tempfile::TempDir::new().unwrap();
        let place = folder.path().join("report");
        for name in ["a<b.png", "c.png"] {
            let mut page = Page::new(&place).unwrap();
            let files = page.add(&missing(name)).unwrap();
            assert!(files[0].exists());
            let index = page.finish("one & all").unwrap().unwrap();
            let html = fs::read_to_string(index).unwrap();
            assert!(html.contains(&format!("<h2>{} <b>missing</b>", escaped(name))) && html.contains("one &amp; all"));
            assert_eq!(fs::read_dir(&place).unwrap().count(), 3, "tag, picture, page");
        }
        Page::new(&place).unwrap();
        assert!(!place.exists());
        fs::create_dir(&place).unwrap();
        fs::write(place.join("thesis.txt"), "").unwrap();
        assert!(Page::new(&place).is_err() && place.join("thesis.txt").exists());
    }

    #[test]
    fn what_is_as_it_should_be_leaves_nothing() {
        let folder = tempfile::TempDir::new().unwrap();
        let place = folder.path().join("report");
        let mut page = Page::new(&place).unwrap();
        page.add(&Finding { path: "a".into(), outcome: Outcome::Drawn, fresh: None }).unwrap();
        assert_eq!(page.finish("").unwrap(), None);
        assert!(!place.exists());
    }
}
