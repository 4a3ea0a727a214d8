use super::figures::EnergySample;
use super::{Error, ReadExtent, ReadStatus, RunStatistics, StepGrid};
use crate::physics::{Body, EngineConfig, Material, Vector, World};
use crate::recording::{self, Header, Playback, Recording, SampledBody, SampledState};
use crate::scene::{self, Scene};
use std::fs::File;
use std::io::{self, BufReader, Read};
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
    /// Statistics of the whole run.
    pub statistics: RunStatistics,
}

impl Source {
    /// Opens the recording at `path` and reads statistics of its run.
    ///
    /// # Errors
    /// If the recording cannot be read or its scene is invalid.
    pub fn open(path: &Path) -> Result<Source, Error> {
        let header = open(path)?.header;
        let text = header.scene.clone().unwrap_or_default();
        let scene = scene::parse(&text.file_name, &text.text)?;
        let statistics = RunStatistics::read(path, Vector::new(scene.size[0], scene.size[1]))?;
        Ok(Source { path: path.into(), header, scene, statistics })
    }

    /// Returns true if the file at `path` is a recording, false if it is a scene. A file is a recording if it begins
    /// with the MCAP magic or its extension is `mcap`.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn is_recording(path: &Path) -> io::Result<bool> {
        let mut magic = Vec::new();
        File::open(path)?.take(mcap::MAGIC.len() as u64).read_to_end(&mut magic)?;
        Ok(magic == mcap::MAGIC || path.extension().is_some_and(|extension| extension == "mcap"))
    }

    /// Width and height of the world, m.
    pub fn world(&self) -> Vector {
        Vector::new(self.scene.size[0], self.scene.size[1])
    }

    /// The title of the recording in a picture of several recordings: that of its scene, else the scene's file name.
    pub fn title(&self) -> &str {
        let file = self.header.scene.as_ref().map_or("", |scene| &scene.file_name);
        self.scene.title.as_deref().unwrap_or(file.strip_suffix(".toml").unwrap_or(file))
    }

    /// Energy and momentum of the recorded states on `grid`, and the health of the recording.
    ///
    /// # Errors
    /// If the recording cannot be read.
    pub(super) fn energies(&self, grid: &StepGrid) -> Result<(Vec<EnergySample>, ReadStatus), Error> {
        let mut playback = Playback::new(open(&self.path)?);
        playback.seek(*grid.steps.start()).map_err(|error| self.read_error(error))?;
        let config = &self.header.config;
        let mut samples = Vec::new();
        let mut extent = ReadExtent::End;
        for state in playback.by_ref() {
            let state = state.map_err(|error| self.read_error(error))?;
            if state.step > *grid.steps.end() {
                extent = ReadExtent::LastStep;
                break;
            }
            if grid.contains(state.step) {
                samples.push(EnergySample::of(&recorded_world(&state, config), state.time));
            }
        }
        Ok((samples, ReadStatus { path: self.path.clone(), health: playback.health(), extent }))
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

/// The world in a recorded state, as far as energy and momentum depend on it: names and materials are missing.
pub fn recorded_world(state: &SampledState, config: &EngineConfig) -> World {
    let body = |recorded: &SampledBody| {
        let spawn = &recorded.info.spawn;
        let mut rect = spawn.rect;
        rect.origin = recorded.position;
        Body {
            id: recorded.info.id,
            name: String::new(),
            rect,
            mass: spawn.mass,
            inverse_mass: 1.0 / spawn.mass,
            velocity: recorded.velocity,
            force: Vector::ZERO,
            constant_force: spawn.force,
            material: Material::default(),
        }
    };
    let bodies = state.bodies.iter().map(body).collect();
    World { bodies, gravity: config.gravity, restitution: config.restitution.clone() }
}
