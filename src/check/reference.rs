//! Whether a picture comes out again.

use super::{Drawing, Finding, Fresh, Grade, Outcome, Reference, mismatch};
use crate::illustration::{self, Error, Evidence, Format, SOFTWARE, Source, Wish};
use crate::recording;
use crate::run::{self, NO_LIVE_EVENTS};
use crate::scene;
use std::io::ErrorKind;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// Examines a picture.
///
/// It is drawn as if by the program that drew the expected one, so that a new version of the program
/// is no difference by itself; what is to take its place says who drew it.
pub fn examine(reference: &Reference) -> Finding {
    let finding = |outcome, fresh| Finding { path: reference.file.clone(), outcome, fresh };
    let expected = match std::fs::read(&reference.file) {
        Ok(file) => Some(file),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return finding(Outcome::Failed(format!("it cannot be read: {error}")), None),
    };
    let software = expected.as_deref().and_then(software).unwrap_or_else(|| SOFTWARE.to_owned());
    let (drawn, format) = match drawn(reference, &software) {
        Ok(drawn) => drawn,
        Err(outcome) => return finding(*outcome, None),
    };
    let outcome = match expected.map(|expected| mismatch(format, &expected, &drawn)) {
        None => Outcome::Missing,
        Some(Ok(None)) => return finding(Outcome::Drawn, None),
        Some(Ok(Some(mismatch))) => Outcome::Differs(Box::new(mismatch)),
        Some(Err(error)) => Outcome::Failed(error.to_string()),
    };
    let fresh = if software == SOFTWARE { Ok((drawn, format)) } else { self::drawn(reference, SOFTWARE) };
    finding(outcome, fresh.ok().map(|(drawn, _)| Fresh::Picture(drawn)))
}

fn software(file: &[u8]) -> Option<String> {
    Evidence::read(file).ok().map(|(_, evidence)| evidence.software)
}

/// The picture drawn once more in the name of that program, and what it is written as.
fn drawn(reference: &Reference, software: &str) -> Result<(Vec<u8>, Format), Box<Outcome>> {
    let drawn = match &reference.drawing {
        Drawing::Wished { wish, sources, format } => {
            all_there(sources)?;
            wished(wish, sources, *format, software).map(|drawn| (drawn, *format))
        }
        Drawing::Again { evidence, sources, format } => {
            again(evidence, sources, *format, software).map(|drawn| (drawn, *format))
        }
        Drawing::Orphaned { recording } => return Err(Box::new(Outcome::Orphaned { recording: recording.clone() })),
        Drawing::Refused { why } => return Err(Box::new(Outcome::Failed(why.clone()))),
    };
    drawn.map_err(|failure| Box::new(Outcome::Undrawn { why: failure.to_string(), grade: failure.grade() }))
}

fn all_there(sources: &[PathBuf]) -> Result<(), Box<Outcome>> {
    match sources.iter().find(|source| !source.exists()) {
        Some(source) => Err(Box::new(Outcome::Orphaned { recording: format!("its recording {}", source.display()) })),
        None => Ok(()),
    }
}

/// Why a picture cannot be drawn.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("{0}")]
    Illustration(#[from] Error),
    #[error("its scene cannot be recorded: {0}")]
    Run(#[from] run::RunError),
}

impl Failure {
    fn grade(&self) -> Grade {
        match self {
            Failure::Illustration(Error::Diverged { .. }) => Grade::Different,
            Failure::Illustration(Error::Recording { source, .. }) if source.is_damage() => Grade::Damaged,
            Failure::Illustration(_) | Failure::Run(_) => Grade::Failed,
        }
    }
}

fn wished(wish: &Wish, sources: &[PathBuf], format: Format, software: &str) -> Result<Vec<u8>, Failure> {
    let opened = sources.iter().map(|source| Opened::new(source)).collect::<Result<Vec<Opened>, Failure>>()?;
    let recordings: Vec<Source> = opened.iter().map(|opened| opened.source.clone()).collect();
    let request = wish.request(&recordings, &mut |_, _| ())?;
    let evidence = Evidence { software: software.to_owned(), ..Evidence::new(&request, &recordings) };
    Ok(draw(&evidence, &recordings, format)?)
}

/// Draws what a picture says of itself, of the recordings as they are now.
fn again(evidence: &Evidence, sources: &[PathBuf], format: Format, software: &str) -> Result<Vec<u8>, Failure> {
    let recordings = sources.iter().map(|source| Source::open(source)).collect::<Result<Vec<Source>, Error>>()?;
    let now = Evidence::new(&evidence.request, &recordings).recordings;
    let evidence = Evidence { recordings: now, software: software.to_owned(), ..evidence.clone() };
    Ok(draw(&evidence, &recordings, format)?)
}

fn draw(evidence: &Evidence, recordings: &[Source], format: Format) -> Result<Vec<u8>, Error> {
    let mut drawn = Vec::new();
    illustration::draw(evidence, recordings, format, NonZero::<usize>::MIN, &mut |_, _| (), &mut drawn)?;
    Ok(drawn)
}

/// A recording, or one made of a scene.
struct Opened {
    source: Source,
    /// Holds the recording of a scene until it has been drawn.
    _made_here: Option<TempPath>,
}

impl Opened {
    fn new(path: &Path) -> Result<Opened, Failure> {
        if path.extension().is_none_or(|extension| extension != "toml") {
            return Ok(Opened { source: Source::open(path)?, _made_here: None });
        }
        let scene = scene::load(path).map_err(run::RunError::from)?;
        let unwritable = |error| run::RunError::from(recording::Error::Write(error));
        let (file, place) =
            tempfile::Builder::new().prefix("rebond-").suffix(".mcap").tempfile().map_err(unwritable)?.into_parts();
        run::record(&scene, run::RecordOptions::whole(&scene), NO_LIVE_EVENTS, file, |_| ())?;
        Ok(Opened { source: Source::open(&place)?, _made_here: Some(place) })
    }
}
