use super::case::{Cases, Recipe};
use super::{CheckResult, Files, RecordingIndex, Replacement};
use crate::picture::Provenance;
use crate::recording;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The decision on the new content of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Decision {
    /// There is none: the file is the same, or cannot be made.
    NothingToAccept,
    /// It may be accepted; holds the command.
    Acceptable(String),
    /// It was written.
    Accepted,
    /// It may not be written; holds a sentence about why, and what to do.
    Refused(String),
}

/// The rules by which changed files may be replaced.
///
/// A file is replaced only if it was found to differ, carries the provenance of rebond, and is one of the files or in
/// one of the folders that were given. A picture elsewhere, which a manifest lists, is replaced if its provenance names
/// a recording of that manifest. Missing files are made only in the given folders.
#[derive(Debug)]
pub struct Acceptance<'a> {
    files: &'a Files,
    /// The identities of the recordings of each manifest, before anything was replaced.
    identities: BTreeMap<Arc<Path>, BTreeSet<String>>,
    /// Pictures of recordings that were replaced, next to them.
    followers: BTreeSet<PathBuf>,
}

impl<'a> Acceptance<'a> {
    /// The rules for the cases found in `files`.
    pub fn new(files: &'a Files, cases: &Cases) -> Acceptance<'a> {
        let mut sources: BTreeMap<Arc<Path>, BTreeSet<&Path>> = BTreeMap::new();
        let listed = cases.pictures.iter().filter(|picture| !files.encloses(&picture.file));
        for picture in listed {
            if let Recipe::Listed { line, .. } = &picture.recipe {
                let of_manifest = |recipe: &Recipe| matches!(recipe, Recipe::Listed { line: other, .. } if other.manifest == line.manifest);
                let pictures = cases.pictures.iter().filter(|picture| of_manifest(&picture.recipe));
                let paths = pictures.flat_map(|picture| match &picture.recipe {
                    Recipe::Listed { sources, .. } => sources.as_slice(),
                    Recipe::Embedded(_) | Recipe::Damaged(_) | Recipe::Foreign => &[],
                });
                let recordings = paths.map(PathBuf::as_path);
                let recordings =
                    recordings.filter(|path| path.extension().is_some_and(|extension| extension == "mcap"));
                sources.entry(line.manifest.clone()).or_insert_with(|| recordings.collect());
            }
        }
        let identities = sources.into_iter().map(|(manifest, paths)| {
            let mut index = RecordingIndex::default();
            index.add(paths.iter().copied());
            let known = paths.iter().flat_map(|path| index.identities_of(path).map(str::to_owned).collect::<Vec<_>>());
            (manifest, known.collect())
        });
        Acceptance { files, identities: identities.collect(), followers: BTreeSet::new() }
    }

    /// Lets a picture be replaced because its recording was.
    pub fn follow(&mut self, picture: &Path) {
        self.followers.insert(picture.into());
    }

    /// Returns the new content of the file, if there is any and it may be written.
    ///
    /// # Errors
    /// A sentence about why it may not be written, and what to do.
    pub fn replacement<'r>(&self, result: &'r CheckResult) -> Result<Option<&'r Replacement>, String> {
        let Some(replacement) = &result.replacement else { return Ok(None) };
        self.permit(result, replacement).map(|()| Some(replacement))
    }

    /// Returns an error if new content of the file may not be written.
    fn permit(&self, result: &CheckResult, replacement: &Replacement) -> Result<(), String> {
        let path = &result.path;
        let is_enclosed = self.files.encloses(path) || self.followers.contains(path);
        if path.symlink_metadata().is_err() {
            return if is_enclosed {
                Ok(())
            } else {
                Err("it is outside of the checked paths; make it with the command in the manifest".into())
            };
        }
        let identities = match replacement {
            Replacement::Picture(_) => recordings_of_picture(path),
            Replacement::Recording(_) | Replacement::Run(_) => recording::open(path).ok().map(|_| Vec::new()),
        };
        let Some(identities) = identities else {
            return Err("it carries no rebond provenance; remove it if it may be replaced".into());
        };
        if is_enclosed || self.is_of_manifest(result, replacement, &identities) {
            return Ok(());
        }
        let folder = super::files::parent(path).display();
        Err(format!("it is outside of the checked paths; check {folder}, too, if it may be replaced"))
    }

    /// Returns true if all recordings that the picture names are ones of the manifest that lists it.
    fn is_of_manifest(&self, result: &CheckResult, replacement: &Replacement, identities: &[String]) -> bool {
        let Replacement::Picture(picture) = replacement else { return false };
        let Some(line) = &result.line else { return false };
        let known = self.identities.get(&line.manifest);
        // A scene has no recording; its picture names the run of the scene as it is.
        let drawn = Provenance::read(picture).map(|provenance| provenance.recordings).unwrap_or_default();
        let is_known =
            |identity: &String| known.is_some_and(|known| known.contains(identity)) || drawn.contains(identity);
        !identities.is_empty() && identities.iter().all(is_known)
    }
}

/// Returns true if rebond has made the file.
pub fn carries_provenance(path: &Path) -> bool {
    recordings_of_picture(path).is_some() || recording::open(path).is_ok()
}

/// The identities of the recordings that a picture names. `None` if it carries no provenance.
fn recordings_of_picture(path: &Path) -> Option<Vec<String>> {
    Provenance::read(&std::fs::read(path).ok()?).ok().map(|provenance| provenance.recordings)
}
