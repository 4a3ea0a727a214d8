use super::{Error, RunSummary};
use crate::physics::Vector;
use crate::recording::{self, Header, Recording};
use crate::scene::{self, Scene};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// A recording to draw.
#[derive(Clone, Debug)]
pub struct Source {
    /// The path of the recording.
    pub path: PathBuf,
    /// The header of the recording.
    pub header: Header,
    /// The scene stored in the recording.
    pub scene: Scene,
    /// A summary of the whole run.
    pub summary: RunSummary,
}

impl Source {
    /// Opens the recording at `path` and summarises it.
    ///
    /// # Errors
    /// If the recording cannot be read or its scene is invalid.
    pub fn open(path: &Path) -> Result<Source, Error> {
        let header = open(path)?.header;
        let scene = scene::parse(&header.scene.file_name, &header.scene.text)?;
        let summary = RunSummary::read(path, Vector::new(scene.size[0], scene.size[1]))?;
        Ok(Source { path: path.into(), header, scene, summary })
    }

    /// Width and height of the world, m.
    pub fn world(&self) -> Vector {
        Vector::new(self.scene.size[0], self.scene.size[1])
    }

    /// The title of the recording in pictures of several: that of its scene, else the scene's file name.
    pub fn title(&self) -> &str {
        let file = &self.header.scene.file_name;
        self.scene.title.as_deref().unwrap_or(file.strip_suffix(".toml").unwrap_or(file))
    }

    /// Adds the path of the recording to an error of reading it.
    pub(super) fn read_error(&self, source: recording::Error) -> Error {
        Error::Recording { path: self.path.clone(), source }
    }
}

/// Opens the recording at `path`.
pub fn open(path: &Path) -> Result<Recording<BufReader<File>>, Error> {
    recording::open(path).map_err(|source| Error::Recording { path: path.into(), source })
}
