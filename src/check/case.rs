use crate::picture::{self, Format, PictureOptions, Provenance, SubjectOptions};
use crate::recording::{self, Identity};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};
use std::str::FromStr;
use std::{fs, io};

/// A file to check.
#[derive(Clone, Debug)]
pub enum Case {
    /// A recording, which must replay the same.
    Recording {
        /// The recording.
        path: PathBuf,
        /// The scene next to it (`NAME.toml` next to `NAME.mcap`), a new run of which must match the recording.
        scene: Option<PathBuf>,
    },
    /// A picture, which must be redrawn the same.
    Picture(ReferenceImage),
}

impl Case {
    /// The path of the file.
    pub fn path(&self) -> &Path {
        match self {
            Case::Recording { path, .. } => path,
            Case::Picture(reference) => &reference.file,
        }
    }
}

/// A picture to check, and the recipe for drawing it.
#[derive(Clone, Debug)]
pub struct ReferenceImage {
    /// The file; it may be missing.
    pub file: PathBuf,
    /// The recipe for drawing it.
    pub recipe: Recipe,
}

/// The recipe for drawing a picture.
#[derive(Clone, Debug)]
pub enum Recipe {
    /// Draw it with a command that a manifest lists.
    Listed {
        /// The picture and its format.
        subject: SubjectOptions,
        /// The options of the command.
        options: Box<PictureOptions>,
        /// Scenes or recordings.
        sources: Vec<PathBuf>,
    },
    /// Redraw it from the provenance that it contains.
    Embedded {
        /// The provenance.
        provenance: Box<Provenance>,
        /// The recordings that the provenance names, in the same order.
        sources: Vec<PathBuf>,
    },
    /// It cannot be drawn: a recording that its provenance names was not found.
    Orphaned {
        /// The recording and why it is missing.
        reason: String,
    },
    /// It cannot be drawn: its provenance, or the line of the manifest, is invalid.
    Invalid {
        /// The error, with the line number in a manifest.
        reason: String,
    },
}

/// The error of searching for cases.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// A file or folder cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// No case was found.
    #[error(
        "nothing to check in {}: expected recordings (*.mcap), manifests (*.check) or pictures drawn by rebond",
        paths.join(", ")
    )]
    NothingFound {
        /// The files and folders searched.
        paths: Vec<String>,
    },
}

/// The files found by a search: recordings, pictures, scenes and manifests.
pub struct Files {
    /// The files and folders that were searched.
    searched: Vec<PathBuf>,
    /// All files found, sorted and without duplicates.
    found: Vec<PathBuf>,
}

impl Files {
    /// Finds all files below `paths`.
    ///
    /// Folders are searched recursively, except hidden ones and those marked as a cache by a `CACHEDIR.TAG`.
    ///
    /// # Errors
    /// If a file or folder cannot be read.
    pub fn find(paths: &[PathBuf]) -> Result<Files, CheckError> {
        let mut found = BTreeMap::new();
        for path in paths {
            if fs::metadata(path).map_err(unreadable(path))?.is_dir() {
                walk(path, &mut found)?;
            } else {
                found.insert(canonical(path), path.clone());
            }
        }
        let mut found: Vec<PathBuf> = found.into_values().collect();
        found.sort();
        Ok(Files { searched: paths.to_vec(), found })
    }

    /// The manifests (`*.check`), which list reference images.
    pub fn manifests(&self) -> impl Iterator<Item = &PathBuf> {
        self.with_extension("check")
    }

    /// Returns all cases: first the recordings, then the pictures, both ordered by name. `listed` are the pictures that
    /// the manifests list. A picture that no manifest lists is checked by its own provenance; it is orphaned if its
    /// recording is not among the files found.
    ///
    /// # Errors
    /// If a file cannot be read, or there is no case.
    pub fn cases(&self, listed: Vec<ReferenceImage>) -> Result<Vec<Case>, CheckError> {
        let listed_files: BTreeSet<PathBuf> = listed.iter().map(|reference| canonical(&reference.file)).collect();
        let mut pictures = listed;
        let recordings: Vec<&PathBuf> = self.with_extension("mcap").collect();
        let mut index = None;
        for file in &self.found {
            if Format::from_path(file).is_none() || listed_files.contains(&canonical(file)) {
                continue;
            }
            let content = fs::read(file).map_err(unreadable(file))?;
            let recipe = match Provenance::read(&content) {
                Ok(provenance) => index.get_or_insert_with(|| RecordingIndex::new(&recordings)).recipe(provenance),
                Err(error @ picture::Error::DamagedProvenance { .. }) => Recipe::Invalid { reason: error.to_string() },
                Err(_) => continue, // A picture of another program.
            };
            pictures.push(ReferenceImage { file: file.clone(), recipe });
        }
        pictures.sort_by(|a, b| a.file.cmp(&b.file));
        let recordings =
            recordings.into_iter().map(|path| Case::Recording { path: path.clone(), scene: scene_of(path) });
        let cases: Vec<Case> = recordings.chain(pictures.into_iter().map(Case::Picture)).collect();
        if cases.is_empty() {
            let paths = self.searched.iter().map(|path| path.display().to_string()).collect();
            return Err(CheckError::NothingFound { paths });
        }
        Ok(cases)
    }

    fn with_extension(&self, extension: &'static str) -> impl Iterator<Item = &PathBuf> {
        self.found.iter().filter(move |path| path.extension() == Some(OsStr::new(extension)))
    }
}

fn scene_of(recording: &Path) -> Option<PathBuf> {
    Some(recording.with_extension("toml")).filter(|scene| scene.is_file())
}

fn unreadable(path: &Path) -> impl FnOnce(io::Error) -> CheckError {
    move |source| CheckError::Unreadable { path: path.into(), source }
}

/// The file that marks a folder as a cache, see <https://bford.info/cachedir>.
pub(super) const CACHE_TAG: &str = "CACHEDIR.TAG";

fn walk(folder: &Path, found: &mut BTreeMap<PathBuf, PathBuf>) -> Result<(), CheckError> {
    if folder.join(CACHE_TAG).is_file() {
        return Ok(());
    }
    for entry in fs::read_dir(folder).map_err(unreadable(folder))? {
        let entry = entry.map_err(unreadable(folder))?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(unreadable(folder))?);
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if kind.is_dir() {
            walk(&path, found)?;
        } else {
            found.insert(canonical(&path), normalize(&path));
        }
    }
    Ok(())
}

/// Returns a path that is the same for all names of a file, even if the file does not exist.
fn canonical(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => normalize(path),
    }
}

/// Removes `.` from a path, and `..` after a name.
pub fn normalize(path: &Path) -> PathBuf {
    let mut normalized = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(normalized.components().next_back(), Some(Component::Normal(_))) => {
                normalized.pop();
            }
            Component::Prefix(_) | Component::RootDir | Component::ParentDir | Component::Normal(_) => {
                normalized.push(component);
            }
        }
    }
    normalized
}

/// The recordings that were found, by identity. Pictures name their recordings by identity.
struct RecordingIndex(BTreeMap<String, Vec<FoundRecording>>);

/// A recording that was found.
#[derive(Clone, Debug)]
struct FoundRecording {
    path: PathBuf,
    /// Full states are recorded every `every` steps.
    every: u64,
}

impl RecordingIndex {
    /// Indexes all readable recordings. Unreadable ones are reported by their own cases.
    fn new(recordings: &[&PathBuf]) -> RecordingIndex {
        let mut found: BTreeMap<String, Vec<FoundRecording>> = BTreeMap::new();
        for path in recordings {
            if let Some((identity, recording)) = identify(path) {
                found.entry(identity).or_default().push(recording);
            }
        }
        RecordingIndex(found)
    }

    fn recipe(&self, provenance: Provenance) -> Recipe {
        let mut sources = Vec::new();
        for identity in &provenance.recordings {
            let found = self.0.get(identity).map(Vec::as_slice).unwrap_or_default();
            let Some(recording) = found.iter().find(|found| found.every <= provenance.recorded_every) else {
                let reason = match Identity::from_str(identity) {
                    Ok(_) => format!("its recording with identity {identity} was not found in the given paths"),
                    Err(_) => "its recording was unfinished and has no identity to find it by".into(),
                };
                return Recipe::Orphaned { reason };
            };
            sources.push(recording.path.clone());
        }
        Recipe::Embedded { provenance: Box::new(provenance), sources }
    }
}

/// Reads the identity of a recording. `None` if it is unfinished or cannot be read.
fn identify(path: &Path) -> Option<(String, FoundRecording)> {
    let mut recording = recording::open(path).ok()?;
    if recording.by_ref().any(|item| item.is_err()) {
        return None;
    }
    let every = recording.header.every;
    Some((recording.trailer()?.identity.to_string(), FoundRecording { path: path.into(), every }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_normalized() {
        for (given, expected) in
            [("a/./b", "a/b"), ("a/b/../c", "a/c"), ("../a", "../a"), ("../../a/../b", "../../b"), ("/a/../b", "/b")]
        {
            assert_eq!(normalize(Path::new(given)), Path::new(expected), "{given}");
        }
    }

    #[test]
    fn hidden_folders_and_caches_are_skipped() {
        let folder = tempfile::TempDir::new().unwrap();
        for name in [".git/a.mcap", "target/b.mcap", "deep/er/c.mcap", "d.mcap"] {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        fs::write(folder.path().join("target").join(CACHE_TAG), "").unwrap();
        let files = Files::find(&[folder.path().into(), folder.path().join("d.mcap")]).unwrap();
        let names: Vec<_> = files.found.iter().map(|path| path.strip_prefix(folder.path()).unwrap()).collect();
        assert_eq!(names, [Path::new("d.mcap"), Path::new("deep/er/c.mcap")]);
    }
}
