use super::error::CommandError;
use super::{frames, output, record, replay};
use crate::physics::CollisionCount;
use crate::recording::{Frame, Header, Playback};
use crate::replay::Verdict;
use crate::run;
use crate::scene::{self, Scene};
use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// The recording that is drawn, and the scene it tells it was made of.
pub struct Source {
    /// The recording.
    pub path: PathBuf,
    /// What it starts with.
    pub header: Header,
    /// The scene in it.
    pub scene: Scene,
    /// Holds the recording of a scene until it has been drawn.
    _made_here: Option<TempDir>,
}

impl Source {
    /// Opens a recording; or records a scene and makes sure that it replays the same.
    pub fn open(path: &Path) -> Result<Source, CommandError> {
        if is_recording(path)? {
            let header = frames::open(path)?.header;
            let scene = scene::parse(&header.scene.file_name, &header.scene.text)?;
            return Ok(Source { path: path.into(), header, scene, _made_here: None });
        }
        let scene = scene::load(path)?;
        let folder = TempDir::with_prefix("rebond-").map_err(CommandError::unwritable(&std::env::temp_dir()))?;
        let recording = folder.path().join("scene.mcap");
        record_and_replay(&scene, &recording)?;
        let header = frames::open(&recording)?.header;
        Ok(Source { path: recording, header, scene, _made_here: Some(folder) })
    }
}

fn is_recording(path: &Path) -> Result<bool, CommandError> {
    let unreadable = |source| CommandError::Unreadable { path: path.into(), source };
    let mut magic = Vec::new();
    File::open(path).and_then(|file| file.take(8).read_to_end(&mut magic)).map_err(unreadable)?;
    Ok(magic.starts_with(mcap::MAGIC) || path.extension().is_some_and(|extension| extension == "mcap"))
}

/// Records a scene and replays it; a verdict other than `same` is told and ends the work.
fn record_and_replay(scene: &Scene, path: &Path) -> Result<(), CommandError> {
    let file = File::create(path).map_err(CommandError::unwritable(path))?;
    let plan = run::RecordOptions { steps: scene.run.steps, every: 1, viewer: None };
    let recorded = record::record(scene, plan, run::NO_LIVE_EVENTS, file, path)?;
    if let Some(error) = &recorded.error {
        output::note(format_args!("{error}; drawing what came before"));
    }
    let verdict = replay::judge(path, 0..=u64::MAX, &mut CollisionCount::default())?;
    output::note(format_args!("{verdict}"));
    match verdict {
        Verdict::Same { .. } => Ok(()),
        Verdict::Diverged(_) | Verdict::Truncated { .. } | Verdict::Corrupt { .. } => Err(CommandError::NotTheSame),
    }
}

/// What has to be known of the whole recording before a part of it is drawn.
pub struct Survey {
    /// The last state in it; none if there is none.
    pub last_step: Option<u64>,
    /// The highest speed in any state, m/s.
    pub top_speed: f64,
    /// The materials of its bodies, sorted.
    pub materials: Vec<String>,
    /// What names it in pictures; none if it is unfinished.
    pub identity: Option<String>,
}

impl Survey {
    /// Looks through the recording once.
    pub fn of(path: &Path) -> Result<Survey, CommandError> {
        let mut playback = Playback::new(frames::open(path)?);
        let mut survey = Survey { last_step: None, top_speed: 0.0, materials: Vec::new(), identity: None };
        for frame in playback.by_ref() {
            survey.see(&frame.map_err(|error| CommandError::recording(path, error))?);
        }
        survey.materials.sort();
        survey.identity = playback.end().map(|end| end.identity.to_string());
        Ok(survey)
    }

    fn see(&mut self, frame: &Frame) {
        self.last_step = Some(frame.step);
        for body in &frame.bodies {
            let speed = body.velocity.norm();
            if speed > self.top_speed {
                self.top_speed = speed;
            }
            let material = &body.known.spawn.material;
            if !material.is_empty() && !self.materials.contains(material) {
                self.materials.push(material.clone());
            }
        }
    }
}
