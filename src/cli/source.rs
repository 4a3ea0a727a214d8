use super::error::CommandError;
use super::output_file::RefuseInputs;
use super::{Exit, output, record, replay};
use crate::physics::{CollisionCount, StepError};
use crate::picture;
use crate::recording;
use crate::replay::{ALL_STEPS, NO_LIVE_EVENTS, RecordOptions, Verdict};
use crate::scene::{self, Override, Sweep};
use crate::temporary::TemporaryRecording;
use crate::text::steps_up_to;
use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};
use std::io::Read;
use std::sync::Arc;
use std::{fs, fs::File, path::Path, path::PathBuf};

/// A recording or a scene, as a command names it.
#[derive(Clone, Debug)]
pub struct SourceArgument {
    /// The path as given.
    pub path: PathBuf,
    /// The values to set in the scene; none for a recording.
    pub overrides: Vec<Override>,
    content: Content,
}

/// The content of a source, as far as it was read to determine its kind.
#[derive(Clone, Debug)]
enum Content {
    /// A recording.
    Recording,
    /// A scene in a file, which is read when it is run.
    SceneFile,
    /// The text of a scene from a pipe or a device, which can be read only once.
    SceneText(Arc<str>),
}

impl Content {
    fn read(path: &Path) -> Result<Content, CommandError> {
        if path.metadata().is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir()) {
            return Content::read_once(path);
        }
        let is_recording = picture::Source::is_recording(path).map_err(CommandError::unreadable(path))?;
        Ok(if is_recording { Content::Recording } else { Content::SceneFile })
    }

    /// Reads a scene from a pipe or a device. A recording is refused, because it is read at any position.
    fn read_once(path: &Path) -> Result<Content, CommandError> {
        let unreadable = CommandError::unreadable(path);
        let mut file = File::open(path).map_err(&unreadable)?;
        let mut start = Vec::new();
        file.by_ref().take(mcap::MAGIC.len() as u64).read_to_end(&mut start).map_err(&unreadable)?;
        if start == mcap::MAGIC || path.extension().is_some_and(|extension| extension == "mcap") {
            return Err(CommandError::RecordingFile(recording::Error::NotARegularFile { path: path.into() }));
        }
        let text = scene::read_text_of(path, start.as_slice().chain(file))?;
        Ok(Content::SceneText(text.into()))
    }
}

impl SourceArgument {
    /// Returns the sources that `paths` and `--set` name: each recording, and each scene once for every combination of
    /// the values. `--set` needs a scene among the paths.
    pub fn all(paths: &[PathBuf], set: &[Sweep]) -> Result<Vec<SourceArgument>, CommandError> {
        let runs = Sweep::combinations(set).map_err(CommandError::Set)?;
        let mut contents: BTreeMap<&Path, Content> = BTreeMap::new();
        let mut sources = Vec::new();
        for path in paths {
            let content = match contents.get(path.as_path()) {
                Some(known) => known.clone(),
                None => Content::read(path)?,
            };
            contents.insert(path, content.clone());
            let overrides = if matches!(content, Content::Recording) { vec![Vec::new()] } else { runs.clone() };
            let source = |overrides| SourceArgument { path: path.clone(), overrides, content: content.clone() };
            sources.extend(overrides.into_iter().map(source));
        }
        match sources.iter().all(|source| source.overrides.is_empty()) {
            true if !set.is_empty() => Err(CommandError::SetOfRecordings { path: paths[0].clone() }),
            _ => Ok(sources),
        }
    }
}

/// Replaces each folder by the recordings in it, sorted by name. Tables for plotting are left out.
pub fn with_recordings_of_folders(paths: &[PathBuf]) -> Result<Vec<PathBuf>, CommandError> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries = fs::read_dir(path).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
        let mut found: Vec<PathBuf> = entries.map_err(CommandError::unreadable(path))?;
        found.retain(|file| file.extension().is_some_and(|extension| extension == "mcap") && file.is_file());
        found.retain(|file| !recording::is_plot_table(file));
        if found.is_empty() {
            return Err(CommandError::NoRecordings(path.clone()));
        }
        found.sort();
        files.extend(found);
    }
    Ok(files)
}

/// The path with the values that are set, for messages: `scene.toml --set restitution.default=0.5`.
impl Display for SourceArgument {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        write!(out, "{}", self.path.display())?;
        self.overrides.iter().try_for_each(|value| write!(out, " --set {value}"))
    }
}

/// A recording given as such, or a temporary one made from a scene.
pub struct SourceFile {
    /// The path of the recording.
    pub path: PathBuf,
    /// The error that ended the run of the scene; its steps before it are used.
    failure: Option<StepError>,
    /// The recording of the scene; it is removed when this is dropped.
    _temporary: Option<TemporaryRecording>,
}

impl SourceFile {
    /// Takes a recording as it is, or records a scene, with or without verifying that it replays the same. An `output`
    /// that is an image of the scene is refused.
    pub fn open(
        source: &SourceArgument,
        verification: Verification,
        output: &mut dyn RefuseInputs,
    ) -> Result<SourceFile, CommandError> {
        SourceFile::open_as("", source, verification, output)
    }

    /// Takes a recording or records a scene as [`SourceFile::open`], with `prefix` before messages about it.
    fn open_as(
        prefix: &str,
        source: &SourceArgument,
        verification: Verification,
        output: &mut dyn RefuseInputs,
    ) -> Result<SourceFile, CommandError> {
        let SourceArgument { path, overrides, content } = source;
        let scene = match content {
            Content::Recording => return Ok(SourceFile { path: path.clone(), failure: None, _temporary: None }),
            Content::SceneFile => scene::load_with(path, overrides)?,
            Content::SceneText(text) => scene::load_text(path, text, overrides)?,
        };
        output.refuse_inputs(&scene.image_paths(path.parent().unwrap_or(Path::new(""))))?;
        let temporary = TemporaryRecording::create().map_err(CommandError::TemporaryFiles)?;
        let recording = temporary.path();
        let file = File::create(&recording).map_err(CommandError::unwritable(&recording))?;
        let recorded = record::record(&scene, RecordOptions::complete(&scene), NO_LIVE_EVENTS, file, &recording)?;
        if let Some(error) = &recorded.error {
            output::print_line_to_stderr(format_args!("{prefix}{error}; using {}", steps_up_to(error.step())));
        }
        if verification == Verification::Replay {
            verify(prefix, &recording)?;
        }
        let failure = recorded.error;
        Ok(SourceFile { path: recording, failure, _temporary: Some(temporary) })
    }

    /// The exit code of a command that has used the source and would return `exit`: an error if the run of the scene
    /// ended in one, as `record` returns for it.
    pub fn exit(&self, exit: Exit) -> Exit {
        if self.failure.is_some() { Exit::Error } else { exit }
    }
}

/// The verification of a recording that was made from a scene just now. Recordings of files are verified by the
/// commands that replay them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verification {
    /// The recording is replayed once, and a verdict other than `same` is an error.
    Replay,
    /// For a single picture, which takes less time than a replay: the scene is simulated once, unless the picture
    /// itself needs a replay, which compares every state.
    None,
}

/// A recording to draw.
pub struct OpenedSource {
    /// The recording, with its summary.
    pub recording: picture::Source,
    /// The file of the recording.
    pub file: SourceFile,
}

impl OpenedSource {
    /// Opens recordings and records scenes, with or without verifying that these replay the same. Messages about one of
    /// several name it. An `output` that is an image of a scene is refused.
    pub fn open_all(
        sources: &[SourceArgument],
        verification: Verification,
        output: &mut dyn RefuseInputs,
    ) -> Result<Vec<OpenedSource>, CommandError> {
        let open = |source: &SourceArgument| {
            let prefix = if sources.len() > 1 { format!("{source}: ") } else { String::new() };
            let file = SourceFile::open_as(&prefix, source, verification, output)?;
            let recording = picture::Source::open(&file.path)?.named(source.to_string().as_ref());
            Ok(OpenedSource { recording, file })
        };
        sources.iter().map(open).collect()
    }
}

/// Replays a recording. A verdict other than `same` is an error.
fn verify(prefix: &str, recording: &Path) -> Result<(), CommandError> {
    let verdict = replay::replay_with_progress(recording, |_| Ok(ALL_STEPS), &mut CollisionCount::default())?;
    output::info(format_args!("{prefix}{verdict}"));
    match verdict {
        Verdict::Same { .. } => Ok(()),
        Verdict::Diverged(_) | Verdict::Incomplete { .. } | Verdict::Corrupt { .. } => {
            Err(CommandError::NotReproducible)
        }
    }
}
