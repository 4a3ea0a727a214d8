use super::case::Problem;
use crate::picture::Format;
use crate::recording;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs::{self, Metadata};
use std::path::{Component, Path, PathBuf};

/// The files found by a search: recordings, pictures, scenes and manifests.
#[derive(Debug, Default)]
pub struct Files {
    /// The files to check by the name that is the same for all of their paths, sorted, without duplicates.
    found: BTreeMap<PathBuf, PathBuf>,
    /// The files that were given as such, by the name that is the same for all of their paths.
    named: BTreeSet<PathBuf>,
    /// Files next to those that were given as such. They are not checked, but others may depend on them.
    context: BTreeMap<PathBuf, PathBuf>,
    /// Files with new content beside them (`NAME.new`).
    pending: Vec<PathBuf>,
    /// The folders that were given, and those of manifests that were given, by the name that is the same for all of
    /// their paths.
    folders: Vec<PathBuf>,
    /// The paths that cannot be checked.
    pub problems: Vec<Problem>,
}

impl Files {
    /// Finds all files below `paths`. A path that cannot be read, and a file that was given as such and cannot be
    /// checked, is one of [`Files::problems`].
    ///
    /// Folders are searched recursively, except hidden ones and those marked as a cache by a `CACHEDIR.TAG`.
    pub fn find(paths: &[PathBuf]) -> Files {
        let mut files = Files::default();
        for path in paths {
            match fs::metadata(path) {
                Ok(metadata) if metadata.is_dir() => {
                    files.folders.extend(path.canonicalize());
                    files.walk(path);
                }
                Ok(metadata) if metadata.is_file() && !is_of_interest(path) => {
                    files.problems.push(Problem::unknown_kind(path));
                }
                Ok(metadata) => {
                    files.add(path, &metadata);
                    files.named.insert(canonical(path));
                    files.add_context(path);
                    if path.extension() == Some(OsStr::new("check")) {
                        files.folders.extend(parent(path).canonicalize());
                    }
                }
                Err(error) if error.kind() == std::io::ErrorKind::NotFound && is_reference(path) => {
                    let reason = "the file does not exist".into();
                    files.problems.push(Problem { path: path.clone(), line: None, reason, is_missing: true });
                    files.add_context(path);
                }
                Err(error) => files.problems.push(Problem::unreadable(path, &error)),
            }
        }
        let given = paths.iter().filter(|path| is_reference(path) && pending_path(path).is_file());
        files.pending.extend(given.cloned());
        files.pending.sort();
        files.pending.dedup();
        let Files { found, context, .. } = &mut files;
        context.retain(|known, _| !found.contains_key(known));
        files
    }

    fn walk(&mut self, folder: &Path) {
        if folder.join(CACHE_TAG).is_file() {
            return;
        }
        let entries = match fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>) {
            Ok(entries) => entries,
            Err(error) => return self.problems.push(Problem::unreadable(folder, &error)),
        };
        for entry in entries {
            let path = normalize(&entry.path());
            let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
            match entry.file_type() {
                _ if is_hidden => {}
                Ok(kind) if kind.is_dir() => self.walk(&path),
                _ if reference_of_pending(&path).is_some() => self.pending.extend(reference_of_pending(&path)),
                _ if !is_of_interest(&path) || is_plot_table(&path) => {}
                _ => match fs::metadata(&path) {
                    Ok(metadata) => self.add(&path, &metadata),
                    Err(error) => self.problems.push(Problem::unreadable(&path, &error)),
                },
            }
        }
    }

    /// Adds a file to check. Devices and named pipes are not read, because that may never end.
    fn add(&mut self, path: &Path, metadata: &Metadata) {
        if metadata.is_file() {
            drop(self.found.insert(canonical(path), path.into()))
        } else {
            self.problems.push(Problem {
                path: path.into(),
                line: None,
                reason: "it is no regular file".into(),
                is_missing: false,
            })
        }
    }

    /// Adds the files in the folder of a file that was given as such.
    fn add_context(&mut self, path: &Path) {
        let folder = parent(path);
        let prefix = path.parent().unwrap_or(Path::new(""));
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = prefix.join(entry.file_name());
            if is_of_interest(&path) && path.is_file() && !is_plot_table(&path) {
                self.context.insert(canonical(&path), path);
            }
        }
    }

    /// The files that have new content beside them, from failed assertions of [`testing`](crate::testing).
    pub fn pending(&self) -> impl Iterator<Item = &PathBuf> {
        self.pending.iter().filter(|path| pending_path(path).is_file())
    }

    /// The manifests (`*.check`): those to check, and those next to files to check.
    pub fn manifests(&self) -> impl Iterator<Item = &PathBuf> {
        let manifests = self.found.values().chain(self.context.values());
        manifests.filter(|path| path.extension() == Some(OsStr::new("check")))
    }

    /// Recordings to find those of pictures among: all that were found, and those next to files to check.
    pub fn recordings(&self) -> impl Iterator<Item = &PathBuf> {
        let recordings = self.found.values().chain(self.context.values());
        recordings.filter(|path| path.extension() == Some(OsStr::new("mcap")))
    }

    /// The pictures to check.
    pub(super) fn pictures(&self) -> impl Iterator<Item = &PathBuf> {
        self.found.values().filter(|path| Format::from_path(path).is_some())
    }

    /// The files to check whose names end so.
    pub(super) fn with_extension(&self, extension: &'static str) -> impl Iterator<Item = &PathBuf> {
        self.found.values().filter(move |path| path.extension() == Some(OsStr::new(extension)))
    }

    /// Returns true if the file is one of those to check, or was given and is missing.
    pub(super) fn contains(&self, path: &Path) -> bool {
        let known = canonical(path);
        self.found.contains_key(&known)
            || self.problems.iter().any(|problem| problem.is_missing && canonical(&problem.path) == known)
    }

    /// Returns true if the file was given as such, and not found in a folder.
    pub(super) fn is_named(&self, path: &Path) -> bool {
        self.named.contains(&canonical(path))
    }

    /// Returns true if the file is one of those that were given, or is in one of the folders or in the folder of one of
    /// the manifests that were given, behind all symbolic links. It need not exist.
    pub fn encloses(&self, path: &Path) -> bool {
        let place = place_of(path);
        self.folders.iter().any(|folder| place.starts_with(folder)) || self.contains(path) && canonical(path) == place
    }
}

/// The file that marks a folder as a cache, see <https://bford.info/cachedir>.
pub(super) const CACHE_TAG: &str = "CACHEDIR.TAG";

/// The file beside a reference that holds its new content until it is accepted or rejected: `NAME.new`.
pub fn pending_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    name.into()
}

/// The reference beside which a file holds its new content.
fn reference_of_pending(path: &Path) -> Option<PathBuf> {
    let reference = path.with_extension("");
    (path.extension() == Some(OsStr::new("new")) && is_reference(&reference)).then_some(reference)
}

/// Returns true for the name of a recording or a picture.
fn is_reference(path: &Path) -> bool {
    path.extension() == Some(OsStr::new("mcap")) || Format::from_path(path).is_some()
}

/// Returns true for the name of a recording, a picture, a scene or a manifest.
fn is_of_interest(path: &Path) -> bool {
    is_reference(path) || path.extension().is_some_and(|extension| extension == "toml" || extension == "check")
}

/// Returns true for a table for plotting, which has the extension of a recording.
fn is_plot_table(path: &Path) -> bool {
    path.extension() == Some(OsStr::new("mcap")) && recording::is_plot_table(path)
}

/// The folder of a file.
pub(super) fn parent(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Returns a path that is the same for all names of a file, even if the file does not exist.
pub(super) fn canonical(path: &Path) -> PathBuf {
    match (parent(path).canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => normalize(path),
    }
}

/// Returns the place of a file behind all symbolic links. Folders on the way need not exist.
fn place_of(path: &Path) -> PathBuf {
    let path = normalize(path);
    let mut missing = Vec::new();
    let mut existing = path.as_path();
    loop {
        let name = if existing.as_os_str().is_empty() { Path::new(".") } else { existing };
        if let Ok(place) = name.canonicalize() {
            return missing.iter().rev().fold(place, |place, name| place.join(name));
        }
        match (existing.file_name(), existing.parent()) {
            // A link that leads nowhere is no place.
            (Some(name), Some(parent)) if existing.symlink_metadata().is_err() => {
                missing.push(name.to_owned());
                existing = parent;
            }
            _ => return path.clone(),
        }
    }
}

/// Returns true if two paths lead to the same place, behind all symbolic links.
pub fn is_same_place(a: &Path, b: &Path) -> bool {
    place_of(a) == place_of(b)
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
        let files = Files::find(&[folder.path().into(), folder.path().join("d.mcap")]);
        let names: Vec<_> = files.found.values().map(|path| path.strip_prefix(folder.path()).unwrap()).collect();
        assert_eq!(names, [Path::new("d.mcap"), Path::new("deep/er/c.mcap")]);
    }

    #[test]
    fn a_file_given_as_such_is_checked_with_the_files_next_to_it_as_context() {
        let folder = tempfile::TempDir::new().unwrap();
        for name in ["a.mcap", "b.mcap", "c.check", "d.png"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let files = Files::find(&[folder.path().join("d.png"), folder.path().join("e.png")]);
        assert_eq!((files.found.len(), files.problems.len()), (1, 1));
        assert_eq!((files.recordings().count(), files.manifests().count()), (2, 1));
        assert!(files.encloses(&folder.path().join("e.png")) && !files.encloses(&folder.path().join("a.mcap")));
    }
}
