use super::{Case, Drawing, Reference};
use crate::illustration::{Evidence, Format};
use crate::recording::{self, Identity};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};
use std::str::FromStr;
use std::{fs, io};

/// How the names of manifests end: files that list references.
pub const MANIFEST_EXTENSION: &str = "check";

/// Why cases cannot be looked for.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// A file or folder cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// Which.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// There is nothing to check.
    #[error("there is nothing to check in {}: no recording (*.mcap), no manifest (*.check), no picture drawn by rebond", paths.join(", "))]
    Nothing {
        /// Where.
        paths: Vec<String>,
    },
}

/// All cases in files and folders: first the recordings, then the pictures, each ordered by name.
///
/// Folders are searched to any depth, but for hidden ones and those that call themselves a cache by
/// a `CACHEDIR.TAG`. `manifest` reads the references that a manifest lists. Any other picture is
/// held by its own evidence; it is orphaned if the recording that names is not among those found.
///
/// # Errors
/// When something cannot be read, or there is nothing.
pub fn find(
    paths: &[PathBuf],
    manifest: impl Fn(&Path) -> Result<Vec<Reference>, CheckError>,
) -> Result<Vec<Case>, CheckError> {
    let files = files(paths)?;
    let with =
        |extension: &'static str| files.iter().filter(move |path| path.extension() == Some(OsStr::new(extension)));
    let mut pictures = Vec::new();
    for path in with(MANIFEST_EXTENSION) {
        pictures.extend(manifest(path)?);
    }
    let listed: BTreeSet<PathBuf> = pictures.iter().map(|reference| identified(&reference.file)).collect();
    let recordings: Vec<&PathBuf> = with("mcap").collect();
    let mut identities = None;
    for file in files.iter().filter(|file| Format::of_name(file).is_some() && !listed.contains(&identified(file))) {
        let content = fs::read(file).map_err(unreadable(file))?;
        if let Ok((format, evidence)) = Evidence::read(&content) {
            let identities = identities.get_or_insert_with(|| Identities::of(&recordings));
            pictures.push(Reference { file: file.clone(), drawing: identities.drawing(evidence, format) });
        }
    }
    pictures.sort_by(|a, b| a.file.cmp(&b.file));
    let recordings = recordings.into_iter().map(|path| Case::Recording { path: path.clone(), scene: scene_of(path) });
    let cases: Vec<Case> = recordings.chain(pictures.into_iter().map(Case::Picture)).collect();
    if cases.is_empty() {
        return Err(CheckError::Nothing { paths: paths.iter().map(|path| path.display().to_string()).collect() });
    }
    Ok(cases)
}

fn scene_of(recording: &Path) -> Option<PathBuf> {
    Some(recording.with_extension("toml")).filter(|scene| scene.is_file())
}

fn unreadable(path: &Path) -> impl FnOnce(io::Error) -> CheckError {
    move |source| CheckError::Unreadable { path: path.into(), source }
}

/// All files below these paths, sorted, each once.
fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, CheckError> {
    let mut found = BTreeMap::new();
    for path in paths {
        match fs::metadata(path).map_err(unreadable(path))?.is_dir() {
            true => walk(path, &mut found)?,
            false => drop(found.insert(identified(path), path.clone())),
        }
    }
    let mut files: Vec<PathBuf> = found.into_values().collect();
    files.sort();
    Ok(files)
}

/// What marks a folder whose content can be made again, by <https://bford.info/cachedir>.
pub(super) const CACHE_TAG: &str = "CACHEDIR.TAG";

fn walk(folder: &Path, found: &mut BTreeMap<PathBuf, PathBuf>) -> Result<(), CheckError> {
    if folder.join(CACHE_TAG).is_file() {
        return Ok(());
    }
    for entry in fs::read_dir(folder).map_err(unreadable(folder))? {
        let entry = entry.map_err(unreadable(folder))?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(unreadable(folder))?);
        match kind.is_dir() {
            _ if entry.file_name().to_string_lossy().starts_with('.') => {}
            true => walk(&path, found)?,
            false => drop(found.insert(identified(&path), plain(&path))),
        }
    }
    Ok(())
}

/// A path by which two names of a file are seen to be one, whether it is there or not.
fn identified(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => plain(path),
    }
}

/// A path as people write it: without `.`, and without `..` behind a name.
pub fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(plain.components().next_back(), Some(Component::Normal(_))) => {
                plain.pop();
            }
            Component::Prefix(_) | Component::RootDir | Component::ParentDir | Component::Normal(_) => {
                plain.push(component);
            }
        }
    }
    plain
}

/// Where recordings are, by what names them in pictures.
struct Identities(BTreeMap<String, Vec<Place>>);

/// A recording that was found.
#[derive(Clone, Debug)]
struct Place {
    path: PathBuf,
    /// States in full are those of every so many steps.
    every: u64,
}

impl Identities {
    /// Those of the recordings that can be read; what is wrong with others their own cases tell.
    fn of(recordings: &[&PathBuf]) -> Identities {
        let mut places: BTreeMap<String, Vec<Place>> = BTreeMap::new();
        for path in recordings {
            if let Some((identity, place)) = identity(path) {
                places.entry(identity).or_default().push(place);
            }
        }
        Identities(places)
    }

    fn drawing(&self, evidence: Evidence, format: Format) -> Drawing {
        let mut sources = Vec::new();
        for recording in &evidence.recordings {
            let places = self.0.get(recording).map(Vec::as_slice).unwrap_or_default();
            let Some(place) = places.iter().find(|place| place.every <= evidence.recorded_every) else {
                let recording = match Identity::from_str(recording) {
                    Ok(_) => format!("its recording {recording}"),
                    Err(_) => "its recording, which was unfinished and had no identity yet,".into(),
                };
                return Drawing::Orphaned { recording };
            };
            sources.push(place.path.clone());
        }
        Drawing::Again { evidence: Box::new(evidence), sources, format }
    }
}

fn identity(path: &Path) -> Option<(String, Place)> {
    let mut recording = recording::open(path).ok()?;
    if recording.by_ref().any(|item| item.is_err()) {
        return None;
    }
    let every = recording.header.every;
    Some((recording.end()?.identity.to_string(), Place { path: path.into(), every }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_told_as_people_write_them() {
        for (given, told) in
            [("a/./b", "a/b"), ("a/b/../c", "a/c"), ("../a", "../a"), ("../../a/../b", "../../b"), ("/a/../b", "/b")]
        {
            assert_eq!(plain(Path::new(given)), Path::new(told), "{given}");
        }
    }

    #[test]
    fn hidden_folders_and_caches_are_left_alone() {
        let folder = tempfile::TempDir::new().unwrap();
        for name in [".git/a.mcap", "target/b.mcap", "deep/er/c.mcap", "d.mcap"] {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        fs::write(folder.path().join("target").join(CACHE_TAG), "").unwrap();
        let found = files(&[folder.path().into(), folder.path().join("d.mcap")]).unwrap();
        let names: Vec<_> = found.iter().map(|path| path.strip_prefix(folder.path()).unwrap()).collect();
        assert_eq!(names, [Path::new("d.mcap"), Path::new("deep/er/c.mcap")]);
    }
}
