use super::recording_index::RecordingIndex;
use crate::picture::{Format, PictureOptions, Provenance, SubjectOptions};
use crate::recording;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::de::{DeTable, DeValue};

use super::files::{Files, canonical, is_same_place, parent};

/// A file to check.
#[derive(Clone, Debug)]
pub enum Case {
    /// A recording, which must replay the same.
    Recording(ReferenceRecording),
    /// A picture, which must be redrawn the same.
    Picture(ReferenceImage),
    /// A path or a line of a manifest that cannot be checked.
    Problem(Problem),
}

impl Case {
    /// The path of the file.
    pub fn path(&self) -> &Path {
        match self {
            Case::Recording(reference) => &reference.file,
            Case::Picture(reference) => &reference.file,
            Case::Problem(problem) => &problem.path,
        }
    }

    /// The files that its check reads.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let inputs = match self {
            Case::Recording(reference) => reference.inputs(),
            Case::Picture(reference) => reference.inputs(),
            Case::Problem(_) => Vec::new(),
        };
        let images = |scene: &&Path| {
            let images = super::recording::load(scene, &[]).map(|loaded| loaded.image_paths(parent(scene)));
            images.unwrap_or_default() // A file that is no scene has no images.
        };
        let images = inputs.iter().flat_map(images);
        [self.path()].into_iter().chain(inputs.iter().copied()).map(PathBuf::from).chain(images).collect()
    }

    /// The line of a manifest that lists the file.
    pub fn line(&self) -> Option<&ManifestLine> {
        match self {
            Case::Recording(reference) => reference.line(),
            Case::Picture(reference) => reference.line(),
            Case::Problem(problem) => problem.line.as_ref(),
        }
    }
}

/// A line of a manifest.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ManifestLine {
    /// The manifest.
    pub manifest: Arc<Path>,
    /// The number of the line, from 1.
    pub number: usize,
}

/// A path or a line of a manifest that cannot be checked.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The path of the file.
    pub path: PathBuf,
    /// The line, in a manifest.
    pub line: Option<ManifestLine>,
    /// The error.
    pub reason: String,
    /// True if the file is a reference that does not exist, false if it cannot be read.
    pub is_missing: bool,
}

/// A recording to check.
#[derive(Clone, Debug)]
pub struct ReferenceRecording {
    /// The file; it may be missing.
    pub file: PathBuf,
    /// The run that it must match.
    pub recipe: RecordingRecipe,
}

/// The run that a recording must match.
#[derive(Clone, Debug)]
pub enum RecordingRecipe {
    /// Its own events, because there is no scene.
    OwnEvents,
    /// A run of the scene next to it: `NAME.toml` next to `NAME.mcap`.
    Scene(PathBuf),
    /// A run that a manifest lists.
    Listed {
        /// The command.
        command: RecordCommand,
        /// The place of the command.
        line: ManifestLine,
    },
}

/// A value of a scene that a command overrides.
#[cfg(feature = "cli")]
pub use crate::scene::Override;
/// There are no commands, and so no overridden values.
#[cfg(not(feature = "cli"))]
#[derive(Clone, Debug)]
pub enum Override {}

/// A command `rebond record`.
#[derive(Clone, Debug)]
pub struct RecordCommand {
    /// The scene.
    pub scene: PathBuf,
    /// The values of the scene that the command overrides.
    pub overrides: Vec<Override>,
    /// The file of live events.
    pub events: Option<PathBuf>,
    /// The number of steps, if it is not that of the scene.
    pub steps: Option<u64>,
    /// Every `every`-th state is recorded in full.
    pub every: u64,
    /// True to record boxes for viewers.
    pub viewer: bool,
    /// True to estimate the accuracy.
    pub accuracy: bool,
    /// True to skip invalid lines of events.
    pub lenient: bool,
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
        /// The values that each run of a scene overrides.
        runs: Vec<Vec<Override>>,
        /// The place of the command.
        line: ManifestLine,
    },
    /// Redraw it from the provenance that it contains.
    Embedded(Box<Provenance>),
    /// It cannot be drawn again: it is damaged, or has lost its provenance.
    Damaged(String),
    /// It carries no provenance. It was drawn by another program, or its provenance was removed.
    Foreign,
}

/// The commands of a manifest: a file `NAME.check` that lists recordings and pictures.
#[derive(Clone, Debug)]
pub struct Manifest {
    /// The manifest.
    pub path: Arc<Path>,
    /// The recordings that it lists.
    pub recordings: Vec<ReferenceRecording>,
    /// The pictures that it lists.
    pub pictures: Vec<ReferenceImage>,
    /// Scenes whose recordings are not kept.
    pub skipped: Vec<PathBuf>,
    /// Its invalid lines.
    pub problems: Vec<Problem>,
}

impl Manifest {
    /// The scenes and recordings that its pictures are drawn from.
    fn picture_sources(&self) -> impl Iterator<Item = (&PathBuf, &ManifestLine)> {
        self.pictures.iter().flat_map(|picture| match &picture.recipe {
            Recipe::Listed { sources, line, .. } => sources.iter().map(|source| (source, line)).collect(),
            Recipe::Embedded(_) | Recipe::Damaged(_) | Recipe::Foreign => Vec::new(),
        })
    }
}

/// All cases of a check.
#[derive(Debug, Default)]
pub struct Cases {
    /// Paths and lines of manifests that cannot be checked.
    pub problems: Vec<Problem>,
    /// The recordings, ordered by name.
    pub recordings: Vec<ReferenceRecording>,
    /// The pictures, ordered by name.
    pub pictures: Vec<ReferenceImage>,
    /// The number of scenes whose recordings are not kept, as a manifest says.
    pub skipped: usize,
}

impl Cases {
    /// Returns the cases of files that were found, and of the manifests among them, which `read` reads.
    pub fn find(files: &Files, read: impl Fn(&Path) -> Result<Manifest, Problem>) -> Cases {
        let (mut manifests, mut problems) = (Vec::new(), Vec::new());
        for path in files.manifests() {
            match read(path) {
                Ok(manifest) => manifests.push(manifest),
                Err(problem) => problems.push(problem),
            }
        }
        let mut cases = Cases::new(files, manifests);
        cases.problems.extend(problems);
        cases
    }

    /// Returns the cases of `files`: recordings, those that are missing, and pictures, ordered by name.
    ///
    /// A picture that no manifest lists is checked by its own provenance. Of manifests that are only next to a file to
    /// check, the lines of that file alone count.
    fn new(files: &Files, manifests: Vec<Manifest>) -> Cases {
        let mut cases = Cases { problems: files.problems.clone(), ..Cases::default() };
        let mut outputs = BTreeSet::new();
        let mut skipped = BTreeSet::new();
        let mut sources = Vec::new();
        for manifest in manifests {
            let is_checked = files.contains(&manifest.path);
            if is_checked {
                sources.extend(manifest.picture_sources().map(|(path, line)| (path.clone(), line.clone())));
                skipped.extend(manifest.skipped.iter().map(|scene| canonical(scene)));
                cases.problems.extend(manifest.problems);
            }
            for recording in manifest.recordings {
                if is_checked || files.contains(&recording.file) {
                    match refusal(&recording.file, recording.line(), &recording.inputs(), &mut outputs) {
                        None => cases.recordings.push(recording),
                        Some(problem) => cases.problems.push(problem),
                    }
                }
            }
            for picture in manifest.pictures {
                if is_checked || files.contains(&picture.file) {
                    match refusal(&picture.file, picture.line(), &picture.inputs(), &mut outputs) {
                        None => cases.pictures.push(picture),
                        Some(problem) => cases.problems.push(problem),
                    }
                }
            }
        }
        cases.add_recordings(files, &mut outputs, &skipped, &sources);
        // A file that was given and is missing is made by the command in a manifest or from the scene next to it.
        let mut recordings = Vec::new();
        cases.problems.retain(|problem| {
            let found = ReferenceRecording::found(&problem.path);
            let has_scene = problem.is_missing && problem.line.is_none() && found.scene().is_some();
            let is_listed = problem.is_missing && problem.line.is_none() && outputs.contains(&canonical(&problem.path));
            recordings.extend((has_scene && !is_listed).then_some(found));
            !has_scene && !is_listed
        });
        cases.recordings.extend(recordings);
        cases.add_pictures(files, &outputs);
        cases.recordings.sort_by(|a, b| a.file.cmp(&b.file));
        cases.pictures.sort_by(|a, b| a.file.cmp(&b.file));
        cases
    }

    /// Adds the recordings that no manifest lists: those found, those of scenes without a recording, and those that
    /// pictures are drawn from.
    fn add_recordings(
        &mut self,
        files: &Files,
        outputs: &mut BTreeSet<PathBuf>,
        skipped: &BTreeSet<PathBuf>,
        sources: &[(PathBuf, ManifestLine)],
    ) {
        let used: BTreeSet<PathBuf> = sources.iter().map(|(path, _)| canonical(path)).collect();
        for file in files.with_extension("mcap") {
            if outputs.insert(canonical(file)) {
                self.recordings.push(ReferenceRecording::found(file));
            }
        }
        self.add_recordings_of_scenes(files, outputs, skipped, &used);
        self.add_recordings_of_pictures(outputs, sources);
    }

    /// Adds the recordings of scenes that have none, except scenes that manifests use or skip.
    fn add_recordings_of_scenes(
        &mut self,
        files: &Files,
        outputs: &mut BTreeSet<PathBuf>,
        skipped: &BTreeSet<PathBuf>,
        used: &BTreeSet<PathBuf>,
    ) {
        let recorded: BTreeSet<PathBuf> =
            self.recordings.iter().filter_map(|recording| recording.scene().map(canonical)).collect();
        let mut recorded_by_name: Option<BTreeSet<PathBuf>> = None;
        let mut has_recording = |scene: &PathBuf| {
            let scene_of = |file: &PathBuf| {
                let scene = recording::open(file).ok()?.header.scene?;
                Some(canonical(&file.with_file_name(scene.file_name)))
            };
            let all = || files.with_extension("mcap").filter_map(scene_of).collect();
            recorded_by_name.get_or_insert_with(all).contains(scene)
        };
        for scene in files.with_extension("toml") {
            let (file, known) = (scene.with_extension("mcap"), canonical(scene));
            if skipped.contains(&known) {
                self.skipped += 1;
            } else if !used.contains(&known)
                && !recorded.contains(&known)
                && (files.is_named(scene) || is_scene(scene))
                && (file.exists() || !has_recording(&known))
                && outputs.insert(canonical(&file))
            {
                self.recordings.push(ReferenceRecording { file, recipe: RecordingRecipe::Scene(scene.clone()) });
            }
        }
    }

    /// Adds the recordings that pictures are drawn from and that do not exist.
    fn add_recordings_of_pictures(&mut self, outputs: &mut BTreeSet<PathBuf>, sources: &[(PathBuf, ManifestLine)]) {
        for (source, line) in sources {
            let is_recording = source.extension().is_some_and(|extension| extension == "mcap");
            if is_recording && !source.exists() && outputs.insert(canonical(source)) {
                let found = ReferenceRecording::found(source);
                match found.recipe {
                    RecordingRecipe::OwnEvents => self.problems.push(Problem {
                        path: source.clone(),
                        line: Some(line.clone()),
                        reason: "the recording does not exist, and there is no scene next to it to record it from"
                            .into(),
                        is_missing: true,
                    }),
                    RecordingRecipe::Scene(_) | RecordingRecipe::Listed { .. } => self.recordings.push(found),
                }
            }
        }
    }

    /// Adds the pictures that no manifest lists, except images that scenes draw into bodies.
    fn add_pictures(&mut self, files: &Files, outputs: &BTreeSet<PathBuf>) {
        let mut images: Option<BTreeSet<PathBuf>> = None;
        for file in files.pictures().filter(|file| !outputs.contains(&canonical(file))) {
            match std::fs::read(file).map(|content| Recipe::of_file(file, &content)) {
                Ok(Recipe::Foreign) if images.get_or_insert_with(|| images_of(files)).contains(&canonical(file)) => {}
                Ok(recipe) => self.pictures.push(ReferenceImage { file: file.clone(), recipe }),
                Err(error) => self.problems.push(Problem::unreadable(file, &error)),
            }
        }
    }

    /// All cases, in the order in which they are checked.
    pub fn iter(&self) -> impl Iterator<Item = Case> {
        let problems = self.problems.iter().cloned().map(Case::Problem);
        let recordings = self.recordings.iter().cloned().map(Case::Recording);
        problems.chain(recordings).chain(self.pictures.iter().cloned().map(Case::Picture))
    }

    /// True if there is nothing to check.
    pub fn is_empty(&self) -> bool {
        self.problems.is_empty()
            && self.recordings.is_empty()
            && self.pictures.iter().all(|picture| matches!(picture.recipe, Recipe::Foreign))
    }
}

/// The images of the scenes among some files.
fn images_of(files: &Files) -> BTreeSet<PathBuf> {
    let images = |scene: &PathBuf| {
        let text = std::fs::read_to_string(scene).unwrap_or_default();
        let parsed = crate::scene::parse("", &text).map(|parsed| parsed.image_paths(parent(scene)));
        parsed.unwrap_or_default() // A file that is no scene has no images.
    };
    files.with_extension("toml").flat_map(images).map(|image| canonical(&image)).collect()
}

/// Adds the file that a line of a manifest writes to the `outputs`. Returns the problem of a line that writes the file
/// of another line or one of its own `inputs`.
fn refusal(
    file: &Path,
    line: Option<&ManifestLine>,
    inputs: &[&Path],
    outputs: &mut BTreeSet<PathBuf>,
) -> Option<Problem> {
    let line = line?;
    let reason = if inputs.iter().any(|input| is_same_place(input, file)) {
        format!("line {}: the command reads {}; choose another name after -o", line.number, file.display())
    } else if !outputs.insert(canonical(file)) {
        format!("line {}: another line writes {}, too", line.number, file.display())
    } else {
        return None;
    };
    Some(Problem { path: line.manifest.to_path_buf(), line: Some(line.clone()), reason, is_missing: false })
}

impl Problem {
    /// The problem of a file that cannot be read.
    pub fn unreadable(path: &Path, error: &std::io::Error) -> Problem {
        let reason = format!("it cannot be read: {error}");
        Problem { path: path.into(), line: None, reason, is_missing: false }
    }

    /// The problem of a file that is named, but of no kind that is checked.
    pub fn unknown_kind(path: &Path) -> Problem {
        let reason = "only recordings (.mcap), scenes (.toml), manifests (.check) and pictures (.png, .svg, .pdf, .gif or \
                      .apng) are checked; rename the file, or leave it out";
        Problem { path: path.into(), line: None, reason: reason.into(), is_missing: false }
    }
}

impl ReferenceRecording {
    /// The case of a recording that no manifest lists.
    fn found(file: &Path) -> ReferenceRecording {
        let is_recording = file.extension().is_some_and(|extension| extension == "mcap");
        let scene = Some(file.with_extension("toml")).filter(|scene| is_recording && scene.is_file());
        let recipe = scene.map_or(RecordingRecipe::OwnEvents, RecordingRecipe::Scene);
        ReferenceRecording { file: file.into(), recipe }
    }

    /// The scene that it must match.
    pub fn scene(&self) -> Option<&Path> {
        match &self.recipe {
            RecordingRecipe::OwnEvents => None,
            RecordingRecipe::Scene(scene) => Some(scene),
            RecordingRecipe::Listed { command, .. } => Some(&command.scene),
        }
    }

    /// The scene and the live events that it must match, without the images of the scene.
    fn inputs(&self) -> Vec<&Path> {
        let events = match &self.recipe {
            RecordingRecipe::Listed { command, .. } => command.events.as_deref(),
            RecordingRecipe::OwnEvents | RecordingRecipe::Scene(_) => None,
        };
        self.scene().into_iter().chain(events).collect()
    }

    /// The line that lists it.
    pub fn line(&self) -> Option<&ManifestLine> {
        match &self.recipe {
            RecordingRecipe::Listed { line, .. } => Some(line),
            RecordingRecipe::OwnEvents | RecordingRecipe::Scene(_) => None,
        }
    }
}

impl ReferenceImage {
    /// The line that lists it.
    pub fn line(&self) -> Option<&ManifestLine> {
        match &self.recipe {
            Recipe::Listed { line, .. } => Some(line),
            Recipe::Embedded(_) | Recipe::Damaged(_) | Recipe::Foreign => None,
        }
    }

    /// The scenes and recordings that a manifest draws it from, without the images of the scenes.
    fn inputs(&self) -> Vec<&Path> {
        match &self.recipe {
            Recipe::Listed { sources, .. } => sources.iter().map(PathBuf::as_path).collect(),
            Recipe::Embedded(_) | Recipe::Damaged(_) | Recipe::Foreign => Vec::new(),
        }
    }

    /// Returns the recordings that it is drawn from, as far as they are known. `index` finds those that provenance
    /// names.
    pub fn recordings<'a>(&'a self, index: &'a RecordingIndex) -> Vec<&'a Path> {
        match &self.recipe {
            Recipe::Embedded(provenance) => index.find(provenance).unwrap_or_default(),
            Recipe::Listed { .. } | Recipe::Damaged(_) | Recipe::Foreign => self.inputs(),
        }
    }
}

impl Recipe {
    /// The recipe in the content of a picture.
    pub fn of_file(file: &Path, content: &[u8]) -> Recipe {
        use crate::picture::Error;
        match Provenance::read(content) {
            Ok(provenance) => Recipe::Embedded(Box::new(provenance)),
            Err(error @ Error::DamagedProvenance { .. }) => Recipe::Damaged(error.to_string()),
            Err(Error::NoProvenance { .. }) => match damage(file, content) {
                Some(damage) => Recipe::Damaged(damage.into()),
                None => Recipe::Foreign,
            },
            Err(error) => Recipe::Damaged(format!("it is damaged: {error}")),
        }
    }
}

/// Returns the damage of a picture without provenance, if it is not whole or was drawn by rebond.
fn damage(file: &Path, content: &[u8]) -> Option<&'static str> {
    const LOST: &str = "another program has removed the provenance that rebond stored in it";
    let contains = |text: &[u8]| content.windows(text.len()).any(|window| window == text);
    let end = &content[content.len().saturating_sub(1024)..];
    let ends_with = |text: &[u8]| end.windows(text.len()).any(|window| window == text);
    if content.iter().all(u8::is_ascii_whitespace) {
        return Some("it is empty");
    }
    match Format::from_path(file)?.name() {
        "PNG" | "animated PNG" if content.starts_with(b"\x89PNG") && !ends_with(b"IEND") => Some("its end is missing"),
        "GIF" if content.starts_with(b"GIF8") && content.last() != Some(&0x3b) => Some("its end is missing"),
        "PDF" if content.starts_with(b"%PDF") && !ends_with(b"%%EOF") => Some("its end is missing"),
        "SVG" if contains(b"<svg") && !ends_with(b"</svg>") && !ends_with(b"/>") => Some("its end is missing"),
        // Diagrams of `rebond report` have no recording and no provenance, but say which program drew them.
        "SVG" if contains(b"<metadata>Software: rebond ") => None,
        // Text that is drawn as outlines lies invisibly above them, so that it can be searched and copied.
        "SVG" if contains(b"lengthAdjust=\"spacingAndGlyphs\"") && contains(b"fill-opacity=\"0\"") => Some(LOST),
        "PDF" if contains(b"/Producer(rebond") || contains(b"/Producer (rebond") => Some(LOST),
        _ => None,
    }
}

/// Tables that scenes have.
const SCENE_TABLES: [&str; 6] = ["run", "world", "spawn", "scatter", "click", "delete"];

/// Returns true if a TOML file is a scene, valid or not, and not the configuration of another program.
fn is_scene(path: &Path) -> bool {
    let text = std::fs::read(path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    let text = text.trim_start_matches('\u{feff}');
    match DeTable::parse(text) {
        Ok(document) => document.get_ref().iter().any(|(key, value)| {
            let is_table = matches!(value.get_ref(), DeValue::Table(_) | DeValue::Array(_));
            is_table && SCENE_TABLES.contains(&key.get_ref().as_ref())
        }),
        Err(_) => text.lines().any(begins_scene_table),
    }
}

/// Returns true if a line of a text that is no valid TOML begins a table of a scene.
fn begins_scene_table(line: &str) -> bool {
    let is_kept = |character: &char| !character.is_whitespace() && !"\"'".contains(*character);
    let line: String = line.chars().filter(is_kept).collect();
    let name = line.trim_start_matches('[');
    SCENE_TABLES.iter().filter_map(|table| name.strip_prefix(table)).any(|rest| rest.starts_with([']', '.', '=']))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn configurations_of_other_programs_are_no_scenes() {
        let folder = tempfile::TempDir::new().unwrap();
        let is_scene_with = |text: &str| {
            let path = folder.path().join("a.toml");
            fs::write(&path, text).unwrap();
            is_scene(&path)
        };
        for scene in [
            "[run]\nsteps = 5\n",
            "\u{feff}run={steps=5}\n",
            "[ \"run\" ]\nsteps = 5\n",
            "run . steps = 5\n",
            "spawn = [{ mass = 1 }]\n",
        ] {
            assert!(is_scene_with(scene), "{scene}");
        }
        for invalid in
            ["[world]\nwals = true\n", "[[spawn]] # wrong\n", "[ run ]\nsteps = \n", "run={steps=5\n", "[run]\n[run]\n"]
        {
            assert!(is_scene_with(invalid), "an invalid scene is a scene: {invalid}");
        }
        assert!(!is_scene_with("run = \"make\"\n") && !is_scene_with("[tool]\nrun = { steps = 5 }\n"));
        assert!(!is_scene_with("[package]\nname = \"a\"\n") && !is_scene_with("") && !is_scene_with("\u{0}\u{1}"));
    }

    #[test]
    fn a_picture_that_is_cut_or_emptied_is_damaged_and_a_foreign_one_is_not() {
        let recipe = |name: &str, content: &[u8]| Recipe::of_file(Path::new(name), content);
        for (name, content) in [
            ("a.png", &b""[..]),
            ("a.pdf", b"%PDF-1.7\n1 0 obj"),
            ("a.svg", b"<svg xmlns=\"http://www.w3.org/2000/svg\"><g"),
            ("a.gif", b"GIF89a"),
            ("a.svg", b"<svg><text lengthAdjust=\"spacingAndGlyphs\" fill-opacity=\"0\">a</text></svg>"),
        ] {
            assert!(matches!(recipe(name, content), Recipe::Damaged(_)), "{name}: {:?}", recipe(name, content));
        }
        for (name, content) in [("a.svg", &b"<svg><g/></svg>\n"[..]), ("a.pdf", b"%PDF-1.7\n%%EOF\n"), ("a.png", b"?")]
        {
            assert!(matches!(recipe(name, content), Recipe::Foreign), "{name}: {:?}", recipe(name, content));
        }
    }
}
