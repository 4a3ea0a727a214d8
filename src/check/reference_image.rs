//! Checking a picture: it must be redrawn the same.

use super::{CheckResult, Outcome, Recipe, ReferenceImage, Replacement, Severity, TemporaryRecording, mismatch};
use crate::picture::{Error, Format, PictureOptions, Provenance, SOFTWARE, Source, SubjectOptions, draw_options};
use crate::recording;
use crate::replay::{self, NO_LIVE_EVENTS};
use crate::scene;
use std::fs::File;
use std::io::ErrorKind;
use std::num::NonZero;
use std::path::{Path, PathBuf};

/// Checks a picture.
///
/// For the comparison it is redrawn with the software version of the existing file in its provenance, so that a new
/// version of rebond is not a difference by itself. A replacement contains the current version.
pub fn check_image(reference: &ReferenceImage) -> CheckResult {
    let result = |outcome, replacement| CheckResult { path: reference.file.clone(), outcome, replacement };
    let expected = match std::fs::read(&reference.file) {
        Ok(file) => Some(file),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return result(Outcome::Failed(format!("cannot read the file: {error}")), None),
    };
    let software = expected.as_deref().and_then(software).unwrap_or_else(|| SOFTWARE.to_owned());
    let (redrawn, format) = match redraw(reference, &software) {
        Ok(redrawn) => redrawn,
        Err(outcome) => return result(*outcome, None),
    };
    let outcome = match expected.map(|expected| mismatch(format, &expected, &redrawn)) {
        None => Outcome::Missing,
        Some(Ok(None)) => return result(Outcome::Identical, None),
        Some(Ok(Some(mismatch))) => Outcome::Differs(Box::new(mismatch)),
        Some(Err(error)) => Outcome::Failed(error.to_string()),
    };
    let replacement = if software == SOFTWARE { Ok((redrawn, format)) } else { redraw(reference, SOFTWARE) };
    result(outcome, replacement.ok().map(|(redrawn, _)| Replacement::Picture(redrawn)))
}

/// The version of rebond that drew a picture.
fn software(file: &[u8]) -> Option<String> {
    Provenance::read(file).ok().map(|provenance| provenance.software)
}

/// Redraws a picture with `software` in its provenance. Returns the file and its format.
fn redraw(reference: &ReferenceImage, software: &str) -> Result<(Vec<u8>, Format), Box<Outcome>> {
    let redrawn = match &reference.recipe {
        Recipe::Listed { subject, options, sources } => {
            require_sources(sources)?;
            draw_listed(subject, options, sources, software)
        }
        Recipe::Embedded { provenance, sources } => draw_embedded(provenance, sources, software),
        Recipe::Orphaned { reason } => return Err(Box::new(Outcome::Orphaned { reason: reason.clone() })),
        Recipe::Invalid { reason } => return Err(Box::new(Outcome::Failed(reason.clone()))),
    };
    redrawn.map_err(|failure| {
        Box::new(Outcome::Unrenderable { reason: failure.to_string(), severity: failure.severity() })
    })
}

fn require_sources(sources: &[PathBuf]) -> Result<(), Box<Outcome>> {
    match sources.iter().find(|source| !source.exists()) {
        Some(source) => {
            let reason = format!("its recording {} does not exist", source.display());
            Err(Box::new(Outcome::Orphaned { reason }))
        }
        None => Ok(()),
    }
}

/// The error of drawing a picture.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("{0}")]
    Picture(#[from] Error),
    #[error("its scene cannot be run: {0}")]
    Run(#[from] replay::RunError),
}

impl Failure {
    fn severity(&self) -> Severity {
        match self {
            Failure::Picture(Error::Diverged { .. }) => Severity::Different,
            Failure::Picture(Error::Recording { source, .. }) if source.is_damage() => Severity::Damaged,
            Failure::Picture(_) | Failure::Run(_) => Severity::Failed,
        }
    }
}

fn draw_listed(
    subject: &SubjectOptions,
    options: &PictureOptions,
    sources: &[PathBuf],
    software: &str,
) -> Result<(Vec<u8>, Format), Failure> {
    let opened =
        sources.iter().map(|source| OpenedSource::open(source)).collect::<Result<Vec<OpenedSource>, Failure>>()?;
    let recordings: Vec<Source> = opened.iter().map(|opened| opened.source.clone()).collect();
    let (mut file, threads) = (Vec::new(), NonZero::<usize>::MIN);
    let (provenance, _) = draw_options(subject, options, &recordings, software, threads, &mut |_, _| (), &mut file)?;
    Ok((file, provenance.picture.format()))
}

/// Redraws a picture from its provenance and the recordings as they are now.
fn draw_embedded(provenance: &Provenance, sources: &[PathBuf], software: &str) -> Result<(Vec<u8>, Format), Failure> {
    let recordings = sources.iter().map(|source| Source::open(source)).collect::<Result<Vec<Source>, Error>>()?;
    let current = Provenance::new(&provenance.picture, &recordings).recordings;
    let provenance = Provenance { recordings: current, software: software.to_owned(), ..provenance.clone() };
    Ok((provenance.draw_to_vec(&recordings)?, provenance.picture.format()))
}

/// A recording to draw, possibly a temporary one made from a scene.
struct OpenedSource {
    source: Source,
    /// The temporary recording; it is removed when this is dropped.
    _temporary: Option<TemporaryRecording>,
}

impl OpenedSource {
    fn open(path: &Path) -> Result<OpenedSource, Failure> {
        // A file that cannot be read is reported by the attempt to open it.
        if Source::is_recording(path).unwrap_or(true) {
            return Ok(OpenedSource { source: Source::open(path)?, _temporary: None });
        }
        let scene = scene::load(path).map_err(replay::RunError::from)?;
        let unwritable = |error| replay::RunError::from(recording::Error::Write(error));
        let temporary = TemporaryRecording::create().map_err(unwritable)?;
        let file = File::create_new(temporary.path()).map_err(unwritable)?;
        replay::record(&scene, replay::RecordOptions::complete(&scene), NO_LIVE_EVENTS, file, |_| ())?;
        Ok(OpenedSource { source: Source::open(&temporary.path())?, _temporary: Some(temporary) })
    }
}
