//! Checking a picture: it must be redrawn the same.

use super::case::{Override, Recipe, ReferenceImage};
use super::files::is_same_place;
use super::{CheckResult, Outcome, RecordingIndex, Replacement, Severity, ShownPicture, mismatch};
use crate::picture::{
    self, Error, Format, Picture, PictureOptions, Provenance, SOFTWARE, Source, StillFormat, Subject, SubjectOptions,
    draw_options, png,
};
use crate::recording::{self, Health};
use crate::replay::{self, NO_LIVE_EVENTS};
use crate::temporary::TemporaryRecording;
use std::fs::File;
use std::io::{Cursor, ErrorKind};
use std::num::NonZero;
use std::path::{Path, PathBuf};

/// Checks a picture.
///
/// For the comparison it is redrawn with the software version of the existing file in its provenance, so that a new
/// version of rebond is not a difference by itself. A replacement contains the current version.
pub fn check_image(reference: &ReferenceImage, index: &RecordingIndex) -> CheckResult {
    let (outcome, replacement) = compare(reference, index);
    let line = reference.line().cloned();
    CheckResult { replacement, line, ..CheckResult::new(reference.file.clone(), outcome) }
}

fn compare(reference: &ReferenceImage, index: &RecordingIndex) -> (Outcome, Option<Replacement>) {
    let expected = match reference.file.metadata() {
        Ok(metadata) if !metadata.is_file() => return (Outcome::Failed("it is no regular file".into()), None),
        Ok(_) => std::fs::read(&reference.file).map(Some),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    };
    let expected = match expected {
        Ok(expected) => expected,
        Err(error) => return (Outcome::Failed(format!("it cannot be read: {error}")), None),
    };
    let software = expected.as_deref().and_then(software).unwrap_or_else(|| SOFTWARE.to_owned());
    let redrawn = match redraw(reference, index, &software) {
        Ok(redrawn) => redrawn,
        Err(outcome) => return (*outcome, None),
    };
    let compared = expected.map(|expected| {
        mismatch(redrawn.format, &expected, &redrawn.file).map(|found| found.map(|mismatch| (expected, mismatch)))
    });
    let mut damage = None;
    let outcome = match compared {
        None => Outcome::Missing("the picture does not exist".into()),
        Some(Ok(None)) => return (Outcome::Identical, None),
        Some(Ok(Some((expected, mismatch)))) => {
            let shown = if redrawn.format.is_vector() { redrawn.show(&expected, index) } else { Vec::new() };
            let shown = [mismatch.shown.clone(), shown].concat();
            damage = reference.recordings(index).into_iter().find_map(damage_of);
            let cause = damage.as_ref().map(|(cause, _)| format!("{cause}; ")).unwrap_or_default();
            let description = format!("{cause}{}", mismatch.description);
            Outcome::Differs(Box::new(super::Mismatch { shown, description, ..mismatch }))
        }
        Some(Err(error)) => Outcome::Failed(error.to_string()),
    };
    // A picture of the readable part of a corrupt recording must not become a reference.
    if matches!(damage, Some((_, Health::Corrupt { .. }))) {
        return (outcome, None);
    }
    let replacement = if software == SOFTWARE { Ok(redrawn) } else { redraw(reference, index, SOFTWARE) };
    (outcome, replacement.ok().map(|redrawn| Replacement::Picture(redrawn.file)))
}

/// The version of rebond that drew a picture.
fn software(file: &[u8]) -> Option<String> {
    Provenance::read(file).ok().map(|provenance| provenance.software)
}

/// A picture that was drawn again.
struct Redrawn {
    file: Vec<u8>,
    format: Format,
    /// The recordings that it was drawn from.
    sources: Vec<Source>,
}

impl Redrawn {
    /// Shows the difference to a vector picture: both are drawn as pixels from their provenance, as far as the
    /// recordings of the expected one are found.
    fn show(&self, expected: &[u8], index: &RecordingIndex) -> Vec<ShownPicture> {
        let Ok(actual) = Provenance::read(&self.file) else { return Vec::new() };
        let Some(drawn) = rasterize(&actual, &self.sources) else { return Vec::new() };
        let expected = Provenance::read(expected).ok().and_then(|provenance| {
            if provenance.recordings == actual.recordings {
                return rasterize(&provenance, &self.sources);
            }
            let paths = index.find(&provenance).ok()?;
            let sources = paths.into_iter().map(Source::open).collect::<Result<Vec<Source>, Error>>().ok()?;
            let current = sources.iter().map(|source| source.statistics.identity.clone());
            // The recording may have been replaced since.
            let is_as_drawn = current.eq(provenance.recordings.iter().cloned().map(Some));
            is_as_drawn.then(|| rasterize(&provenance, &sources)).flatten()
        });
        match expected {
            Some(expected) if expected == drawn => {
                vec![ShownPicture { caption: "expected and actual, which look the same", picture: drawn }]
            }
            Some(expected) => ShownPicture::of(&expected, &drawn),
            None => vec![ShownPicture { caption: "actual", picture: drawn }],
        }
    }
}

/// Draws the page of a vector picture as pixels.
fn rasterize(provenance: &Provenance, sources: &[Source]) -> Option<Picture> {
    const MAX_PIXELS: u64 = 1 << 24;
    let [width, height] = provenance.picture.look.size.map(u64::from);
    if width.saturating_mul(height) > MAX_PIXELS {
        return None;
    }
    let mut provenance = provenance.clone();
    if let Subject::Page { format, .. } = &mut provenance.picture.subject {
        *format = StillFormat::Png;
    }
    let file = provenance.draw_to_vec(sources).ok()?;
    png::decode(Cursor::new(file)).ok().map(|(picture, _)| picture)
}

/// Redraws a picture with `software` in its provenance.
fn redraw(reference: &ReferenceImage, index: &RecordingIndex, software: &str) -> Result<Redrawn, Box<Outcome>> {
    let redrawn = match &reference.recipe {
        Recipe::Listed { subject, options, sources, runs, .. } => {
            require_sources(sources)?;
            open_all(sources, runs, &reference.file).and_then(|sources| {
                let options = PictureOptions::clone(options);
                // As the commands do; without them there is no `--set`.
                #[cfg(feature = "cli")]
                let options =
                    if runs.iter().all(Vec::is_empty) { options } else { options.with_titles_of_runs(&sources) };
                draw_listed(subject, &options, sources, software)
            })
        }
        Recipe::Embedded(provenance) => {
            let sources = index.find(provenance).map_err(|reason| Box::new(Outcome::Orphaned { reason }))?;
            draw_embedded(provenance, &sources, software)
        }
        Recipe::Damaged(reason) => return Err(Box::new(Outcome::Failed(reason.clone()))),
        Recipe::Foreign => return Err(Box::new(Outcome::Foreign)),
    };
    redrawn.map_err(|failure| {
        let is_explained = matches!(failure, Failure::Recording { .. } | Failure::Picture(Error::Diverged { .. }));
        let paths = if is_explained { Vec::new() } else { reference.recordings(index) };
        let damage = paths.into_iter().find_map(damage_of);
        let cause = damage.map(|(cause, _)| format!("{cause}; ")).unwrap_or_default();
        Box::new(Outcome::Unrenderable { reason: format!("{cause}{failure}"), severity: failure.severity() })
    })
}

/// A sentence about a recording that is not whole, and its health.
fn damage_of(path: &Path) -> Option<(String, Health)> {
    let mut recording = recording::open(path).ok()?;
    recording.by_ref().find(Result::is_err);
    let health = recording.health();
    (health != Health::Whole).then(|| (format!("its recording {} is {}", path.display(), health.word()), health))
}

fn require_sources(sources: &[PathBuf]) -> Result<(), Box<Outcome>> {
    match sources.iter().find(|source| !source.exists()) {
        Some(source) => {
            let is_scene = source.extension().is_some_and(|extension| extension == "toml");
            let kind = if is_scene { "scene" } else { "recording" };
            let reason = format!("its {kind} {} does not exist", source.display());
            Err(Box::new(Outcome::Orphaned { reason }))
        }
        None => Ok(()),
    }
}

/// The error of drawing a picture.
#[derive(Debug, thiserror::Error)]
enum Failure {
    /// A recording cannot be read because of its damage.
    #[error("its recording {} is {}: {source}", path.display(), if source.is_damage() { "corrupt" } else { "unreadable" })]
    Recording { path: PathBuf, source: recording::Error },
    #[error("{0}")]
    Picture(Error),
    #[error("its scene cannot be run: {0}")]
    Run(#[from] replay::RunError),
    #[error("it is an image of its scene {}; choose another name after -o", .0.display())]
    IsImage(PathBuf),
    #[error("--set changes values of a scene, but it is drawn from recordings; list the recording with --set")]
    SetOfRecordings,
}

impl From<Error> for Failure {
    fn from(error: Error) -> Failure {
        match error {
            Error::Recording { path, source } => Failure::Recording { path, source },
            error => Failure::Picture(error),
        }
    }
}

impl Failure {
    fn severity(&self) -> Severity {
        match self {
            Failure::Picture(Error::Diverged { .. }) => Severity::Different,
            Failure::Recording { source, .. } if source.is_damage() => Severity::Damaged,
            Failure::Recording { .. }
            | Failure::Picture(_)
            | Failure::Run(_)
            | Failure::IsImage(_)
            | Failure::SetOfRecordings => Severity::Failed,
        }
    }
}

fn draw_listed(
    subject: &SubjectOptions,
    options: &PictureOptions,
    sources: Vec<Source>,
    software: &str,
) -> Result<Redrawn, Failure> {
    let (mut file, threads) = (Vec::new(), NonZero::<usize>::MIN);
    let (provenance, _) = draw_options(subject, options, &sources, software, threads, &mut |_, _| (), &mut file)?;
    let format = provenance.picture.format();
    Ok(Redrawn { file, format, sources })
}

/// Redraws a picture from its provenance and the recordings as they are now.
fn draw_embedded(provenance: &Provenance, sources: &[&Path], software: &str) -> Result<Redrawn, Failure> {
    let recordings = sources.iter().map(|source| Source::open(source)).collect::<Result<Vec<Source>, Error>>()?;
    let current = Provenance::new(&provenance.picture, &recordings).recordings;
    let provenance = Provenance { recordings: current, software: software.to_owned(), ..provenance.clone() };
    let (mut file, threads) = (Vec::new(), NonZero::<usize>::MIN);
    picture::draw(&provenance, &recordings, threads, &mut |_, _| (), &mut file)?;
    let format = provenance.picture.format();
    Ok(Redrawn { file, format, sources: recordings })
}

/// Opens each recording, and each scene once for every run, to draw `picture`.
fn open_all(paths: &[PathBuf], runs: &[Vec<Override>], picture: &Path) -> Result<Vec<Source>, Failure> {
    let mut sources = Vec::new();
    let mut has_scene = false;
    for path in paths {
        // A file that cannot be read is reported by the attempt to open it.
        if Source::is_recording(path).unwrap_or(true) {
            sources.push(Source::open(path)?);
            continue;
        }
        has_scene = true;
        for overrides in runs {
            sources.push(record(path, overrides, picture)?);
        }
    }
    if has_scene || runs.iter().all(Vec::is_empty) { Ok(sources) } else { Err(Failure::SetOfRecordings) }
}

/// Records a run of the scene at `path`, to draw `picture`.
fn record(path: &Path, overrides: &[Override], picture: &Path) -> Result<Source, Failure> {
    let scene = super::recording::load(path, overrides)?;
    let images = scene.image_paths(path.parent().unwrap_or(Path::new("")));
    if images.iter().any(|image| is_same_place(image, picture)) {
        return Err(Failure::IsImage(path.into()));
    }
    let unwritable = |error| replay::RunError::from(recording::Error::Write(error));
    let temporary = TemporaryRecording::create().map_err(unwritable)?;
    let file = File::create_new(temporary.path()).map_err(unwritable)?;
    replay::record(&scene, replay::RecordOptions::complete(&scene), NO_LIVE_EVENTS, file, |_| ())?;
    Ok(Source::from_temporary(temporary)?)
}
