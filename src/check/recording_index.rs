use crate::picture::{Provenance, lacking_states, with_states};
use crate::recording::{self, Health, Identity};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Recordings by identity. Pictures name their recordings by identity.
#[derive(Clone, Debug, Default)]
pub struct RecordingIndex {
    found: BTreeMap<String, Vec<FoundRecording>>,
    /// The recordings whose identity cannot be read, and their health in words.
    unknown: Vec<(PathBuf, String)>,
    indexed: BTreeSet<PathBuf>,
}

/// A recording that was found.
#[derive(Clone, Debug)]
struct FoundRecording {
    path: PathBuf,
    /// Full states are recorded every `every` steps.
    every: u64,
}

impl RecordingIndex {
    /// Indexes recordings. A recording that was replaced since is found by its old and by its new identity.
    pub fn add<'a>(&mut self, recordings: impl IntoIterator<Item = &'a Path>) {
        for path in recordings {
            match identify(path) {
                Ok((identity, recording)) => {
                    let found = self.found.entry(identity).or_default();
                    if found.iter().all(|found| found.path != path) {
                        found.push(recording);
                    }
                }
                Err(_) if self.indexed.contains(path) => {}
                Err(reason) => self.unknown.push((path.into(), reason)),
            }
            self.indexed.insert(path.into());
        }
    }

    /// Finds the recordings that provenance names, in the same order.
    ///
    /// # Errors
    /// A sentence about the first one that is not found.
    pub fn find(&self, provenance: &Provenance) -> Result<Vec<&Path>, String> {
        let recordings = provenance.recordings.iter().zip(&provenance.recorded_every);
        recordings.map(|(identity, &every)| self.find_one(identity, every)).collect()
    }

    fn find_one(&self, identity: &str, every: u64) -> Result<&Path, String> {
        let found = self.found.get(identity).map(Vec::as_slice).unwrap_or_default();
        if let Some(recording) = with_states(found.iter(), every, |found| found.every) {
            return Ok(&recording.path);
        }
        if let [other, ..] = found {
            let (path, lacking) = (other.path.display(), lacking_states(other.every, every));
            return Err(format!("its recording with identity {identity} may be {path}, but that {lacking}"));
        }
        if Identity::from_str(identity).is_err() {
            return Err("its recording was unfinished and has no identity to find it by".into());
        }
        let missing = format!("its recording with identity {identity} was not found in the given paths");
        Err(match self.unknown.as_slice() {
            [] => missing,
            [(path, reason)] => format!("{missing}; it may be {}, which is {reason}", path.display()),
            [(path, _), ..] => {
                format!("{missing}; it may be {} or another one that cannot be read", path.display())
            }
        })
    }

    /// The identities of a recording, as long as it was indexed.
    pub fn identities_of<'a>(&'a self, path: &'a Path) -> impl Iterator<Item = &'a str> {
        let has_path = move |found: &Vec<FoundRecording>| found.iter().any(|found| found.path == path);
        self.found.iter().filter(move |(_, found)| has_path(found)).map(|(identity, _)| identity.as_str())
    }
}

/// Reads the identity of a recording.
fn identify(path: &Path) -> Result<(String, FoundRecording), String> {
    let mut recording = recording::open(path).map_err(|error| error.to_string())?;
    for item in recording.by_ref() {
        item.map_err(|error| error.to_string())?;
    }
    let every = recording.header.every;
    match (recording.trailer(), recording.health()) {
        (Some(end), _) => Ok((end.identity.to_string(), FoundRecording { path: path.into(), every })),
        (None, Health::Whole) => Err("without an end".into()),
        (None, health) => Err(health.word().into()),
    }
}
