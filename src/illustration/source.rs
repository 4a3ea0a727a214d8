use super::{Error, Survey};
use crate::physics::Vector;
use crate::recording::{self, Header, Recording};
use crate::scene::{self, Scene};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// A recording that is drawn.
#[derive(Clone, Debug)]
pub struct Source {
    /// The recording.
    pub path: PathBuf,
    /// What it starts with.
    pub header: Header,
    /// The scene in it.
    pub scene: Scene,
    /// What there is in all of it.
    pub survey: Survey,
}

impl Source {
    /// Looks through the recording at `path`.
    ///
    /// # Errors
    /// When it cannot be read, or the scene in it.
    pub fn open(path: &Path) -> Result<Source, Error> {
        let header = open(path)?.header;
        let scene = scene::parse(&header.scene.file_name, &header.scene.text)?;
        let survey = Survey::of(path, Vector::new(scene.size[0], scene.size[1]))?;
        Ok(Source { path: path.into(), header, scene, survey })
    }

    /// Width and height of its world, m.
    pub fn world(&self) -> Vector {
        Vector::new(self.scene.size[0], self.scene.size[1])
    }

    /// What it is called where several are shown.
    pub fn title(&self) -> &str {
        let file = &self.header.scene.file_name;
        self.scene.title.as_deref().unwrap_or(file.strip_suffix(".toml").unwrap_or(file))
    }

    /// The error of reading it.
    pub(super) fn unreadable(&self, source: recording::Error) -> Error {
        Error::Recording { path: self.path.clone(), source }
    }
}

/// Opens a recording to read.
pub fn open(path: &Path) -> Result<Recording<BufReader<File>>, Error> {
    recording::open(path).map_err(|source| Error::Recording { path: path.into(), source })
}
