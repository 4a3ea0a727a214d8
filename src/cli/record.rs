use super::arguments::{RecordOptions, RecoverOptions, is_standard_output};
use super::error::CommandError;
use super::output_file::{self, Durability, OutputFile, Overwrite, Placement, RefuseInputs};
use super::replay::replay_with_progress;
use super::{Exit, output};
use crate::physics::{CollisionCount, SolverKind};
use crate::picture;
use crate::recording::{self, ColorFn, Header, Health, Item, RecordedError, Trailer, Versions};
use crate::replay::{self, ALL_STEPS, IdleClicks, LiveEvents, OnBadEvent, Recorded, RunError, Verdict};
use crate::scene::{self, Action, Scene};
use crate::text::counted;
use std::{
    collections::BTreeSet,
    fs::File,
    io::{self, BufRead, BufReader, Write},
    iter,
    path::{Path, PathBuf},
};

/// Runs a scene and records it. If another process records to the same file meanwhile, `--skip-existing` waits for its
/// end and then takes the file as one that has existed before.
pub fn run(options: &RecordOptions) -> Result<Exit, CommandError> {
    let is_repeatable = options.skip_existing && !is_standard_output(&options.scene);
    loop {
        match record_once(options) {
            Err(CommandError::Exists(path) | CommandError::Busy(path)) if is_repeatable && path.is_file() => {
                output_file::wait_for_writer(&path);
            }
            result => return result,
        }
    }
}

fn record_once(options: &RecordOptions) -> Result<Exit, CommandError> {
    let inputs: Vec<&Path> = iter::once(&options.scene).chain(&options.events).map(PathBuf::as_path).collect();
    if is_standard_output(&options.scene) && options.events.as_deref().is_some_and(is_standard_output) {
        return Err(CommandError::TwoFromStandardInput);
    }
    let load = || scene::load_with(&options.scene, &options.set);
    let loaded = options.skip_existing.then(load).transpose()?;
    let overwrite = match loaded.as_ref().map_or(Ok(ExistingRun::None), |scene| ExistingRun::find(options, scene))? {
        ExistingRun::Whole(trailer) => return skip(options, &trailer),
        ExistingRun::Part => Overwrite::Allowed,
        ExistingRun::None => Overwrite::from_force(options.force),
    };
    let mut output = OutputFile::create(&options.output, overwrite, &inputs)?;
    let scene = loaded.map_or_else(load, Ok)?;
    output.refuse_inputs(&scene.image_paths(options.scene.parent().unwrap_or(Path::new(""))))?;
    let plan = plan(options, &scene);
    warn_of_unreached_inputs(&scene, plan.steps);
    if plan.estimates_accuracy && scene.run.solver == SolverKind::Handout {
        output::info(format_args!("the accuracy is not estimated: --accuracy needs the event-driven solver"));
    }
    let on_bad_event = if options.lenient { OnBadEvent::Skip } else { OnBadEvent::Fail };
    let events = options.events.as_deref().map(open_events).transpose()?;
    let mut live = events.map(|lines| LiveEvents::new(lines, on_bad_event, plan.steps));
    let durability = if options.sync { Durability::Disk } else { Durability::Program };
    let placement = if live.is_some() { Placement::SecondFlush } else { Placement::FirstFlush };
    let (output, begun) = output.record(durability, placement)?;
    let recorded = match record(&scene, plan, live.as_mut(), output, &options.output) {
        Err(CommandError::Unwritable { path, source }) if begun.is_in_place() => {
            return Err(CommandError::CutRecording { last: last_readable_step(&path), path, source });
        }
        Err(error) if begun.is_in_place() => {
            let (path, source) = (options.output.clone(), Box::new(error));
            return Err(CommandError::UnfinishedRun { last: last_readable_step(&path), path, source });
        }
        recorded => recorded?,
    };
    print_summary(options, &recorded, live.map_or(0, |live| live.skipped()))?;
    match recorded.error {
        Some(error) => Err(CommandError::Step { path: options.output.clone(), error }),
        None => Ok(Exit::Done),
    }
}

/// The options of the recording that a command asks for.
fn plan(options: &RecordOptions, scene: &Scene) -> replay::RecordOptions {
    replay::RecordOptions {
        steps: options.steps.unwrap_or(scene.run.steps),
        every: options.every,
        estimates_accuracy: options.accuracy,
        has_live_events: options.events.is_some(),
        viewer: options.viewer.then_some(picture::body_color as ColorFn),
    }
}

/// The recording that `--skip-existing` finds at the place of the output.
enum ExistingRun {
    /// None, or one of another run that `--force` replaces.
    None,
    /// The first part of the same run, which was interrupted.
    Part,
    /// The same run.
    Whole(Box<Trailer>),
}

impl ExistingRun {
    /// Compares the scene with its values, the settings and versions of the run with those of an existing recording.
    ///
    /// # Errors
    /// Without `--force`, an error that names the difference.
    fn find(options: &RecordOptions, scene: &Scene) -> Result<ExistingRun, CommandError> {
        let path = &options.output;
        if !path.is_file() {
            return Ok(ExistingRun::None);
        }
        let expected = replay::header(scene, plan(options, scene));
        let found = recording::open(path).map_err(CommandError::in_recording(path));
        let difference = match found {
            Ok(mut found) => match difference(&found.header, &expected) {
                None => {
                    let mut has_scene_updates = false;
                    let mut is_readable = true;
                    for item in found.by_ref() {
                        has_scene_updates |= matches!(item, Ok(Item::SceneUpdate { .. }));
                        is_readable &= item.is_ok();
                    }
                    match found.trailer().cloned().filter(|_| is_readable && found.health() == Health::Whole) {
                        None => return Ok(ExistingRun::Part),
                        Some(trailer) if has_scene_updates == options.viewer => {
                            return Ok(ExistingRun::Whole(Box::new(trailer)));
                        }
                        Some(_) if options.viewer => "it was recorded without --viewer".to_owned(),
                        Some(_) => "it was recorded with --viewer".to_owned(),
                    }
                }
                Some(difference) => difference,
            },
            Err(error) => error.to_string(),
        };
        if options.force {
            Ok(ExistingRun::None)
        } else {
            Err(CommandError::OtherRun { path: path.clone(), difference })
        }
    }
}

/// Returns the first setting in which a recording is not the expected one, in words.
fn difference(header: &Header, expected: &Header) -> Option<String> {
    let text = |header: &Header| header.scene.as_ref().map(|scene| scene.text.clone());
    let versions = |Versions { format, semantics }: Versions| format!("format {format}, semantics {semantics}");
    let set = |header: &Header| {
        let values: Vec<String> = header.overrides.iter().map(|[key, value]| format!("{key}={value}")).collect();
        if values.is_empty() { "none".to_owned() } else { values.join(", ") }
    };
    let images = |header: &Header| {
        let images = header.images.iter().map(|image| format!("{} {:016x}", image.name, image.digest));
        images.collect::<Vec<String>>().join(", ")
    };
    let yes = |value: bool| if value { "yes" } else { "no" }.to_owned();
    let settings = [
        ("version", versions(header.versions), versions(expected.versions)),
        ("values of --set", set(header), set(expected)),
        ("images", images(header), images(expected)),
        ("live events", yes(header.has_live_events), yes(expected.has_live_events)),
        ("steps", header.steps.to_string(), expected.steps.to_string()),
        ("--every", header.every.to_string(), expected.every.to_string()),
        ("--accuracy", yes(header.estimates_accuracy), yes(expected.estimates_accuracy)),
    ];
    let different = settings.into_iter().find(|(_, found, expected)| found != expected);
    let different = different.map(|(name, found, expected)| format!("{name}: {found} recorded, {expected} asked for"));
    different.or_else(|| (text(header) != text(expected)).then(|| "its scene has another text".to_owned()))
}

/// Says that the run is recorded already. A run that ended in an error ends in it again.
fn skip(options: &RecordOptions, trailer: &Trailer) -> Result<Exit, CommandError> {
    let recorded = Recorded { trailer: trailer.clone(), error: None, idle_clicks: IdleClicks::default() };
    if options.json {
        print_summary(options, &recorded, 0)?;
    } else {
        let line = format!("{}: skipped, it has this run, identity {}", options.output.display(), trailer.identity);
        output::print_result(&options.output, &line)?;
    }
    match &trailer.error {
        Some(RecordedError::Step(error)) => {
            Err(CommandError::Step { path: options.output.clone(), error: error.clone() })
        }
        Some(RecordedError::Text(_)) => Ok(Exit::Error),
        None => Ok(Exit::Done),
    }
}

/// Records with a progress bar. `path` is the name of the output in errors.
pub fn record<W: Write + Send + 'static>(
    scene: &Scene,
    plan: replay::RecordOptions,
    live: Option<&mut LiveEvents<impl BufRead>>,
    output: W,
    path: &Path,
) -> Result<Recorded, CommandError> {
    if live.is_none() {
        warn_of_unused_pairs(scene);
    }
    let bar = output::progress_bar("recording", plan.steps);
    let recorded = replay::record(scene, plan, live, output, |step| bar.set_position(step));
    bar.finish_and_clear();
    if let Ok(Recorded { idle_clicks, .. }) = &recorded
        && idle_clicks.count > 0
    {
        output::info(format_args!("{idle_clicks}"));
    }
    recorded.map_err(|error| match error {
        RunError::Recording(error) => CommandError::in_recording(path)(error),
        error => error.into(),
    })
}

/// The last step of the readable part of an unfinished recording.
fn last_readable_step(path: &Path) -> u64 {
    let items = recording::open(path).into_iter().flatten();
    let steps = items.filter_map(|item| if let Ok(Item::State(state)) = item { Some(state.step) } else { None });
    steps.last().unwrap_or(0)
}

/// Reports values of `--set` for pairs of materials that no body has, such as misspelt ones: they change
/// nothing.
fn warn_of_unused_pairs(scene: &Scene) {
    let materials = scene.inputs.iter().filter_map(|input| match &input.action {
        Action::Wall(request) | Action::Spawn(request) => Some(&request.blueprint.material),
        Action::Click { spawn, .. } => spawn.as_ref().map(|blueprint| &blueprint.material),
        Action::Delete { .. } => None,
    });
    let used: BTreeSet<&str> = materials.map(String::as_str).collect();
    for [key, value] in &scene.source.overrides {
        let pair = key.strip_prefix("restitution.").and_then(|pair| pair.trim_matches('"').split_once('/'));
        let Some(unused) = pair.and_then(|(a, b)| [a, b].into_iter().find(|name| !used.contains(name))) else {
            continue;
        };
        output::info(format_args!("--set {key}={value} changes nothing: no body has the material {unused:?}"));
    }
}

fn warn_of_unreached_inputs(scene: &Scene, steps: u64) {
    let unreached = scene.inputs.iter().filter(|input| input.step > steps).count();
    if unreached > 0 {
        let events = counted(unreached as u64, "event");
        output::info(format_args!("ignored {events} of the scene after step {steps}, the last step"));
    }
}

fn open_events(path: &Path) -> Result<Box<dyn BufRead>, CommandError> {
    if path == Path::new("-") {
        return Ok(Box::new(BufReader::new(io::stdin())));
    }
    let file = File::open(path).and_then(|file| match file.metadata() {
        Ok(metadata) if metadata.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(_) | Err(_) => Ok(file),
    });
    Ok(Box::new(BufReader::new(file.map_err(CommandError::unreadable(path))?)))
}

fn print_summary(options: &RecordOptions, recorded: &Recorded, skipped: u64) -> Result<(), CommandError> {
    if skipped > 0 {
        output::info(format_args!("skipped {}", counted(skipped, "event line")));
    }
    let end = &recorded.trailer;
    let collisions = end.collisions.unwrap_or_default();
    if options.json {
        let object = serde_json::json!({
            "path": options.output.display().to_string(), "steps": end.steps, "bodies": end.bodies,
            "collisions": collisions, "identity": end.identity.to_string(), "accuracy": end.accuracy.map(|accuracy| accuracy.to_string()), "error": end.error.as_ref().map(RecordedError::to_string),
        });
        return output::print_beside(&options.output, &object.to_string());
    }
    let accuracy = end.accuracy.map(|accuracy| format!(", accuracy {accuracy}")).unwrap_or_default();
    let line = format!(
        "{}: {}, {}, {}{accuracy}, identity {}",
        options.output.display(),
        counted(end.steps, "step"),
        counted(end.bodies, "body"),
        counted(collisions, "collision"),
        end.identity
    );
    output::print_result(&options.output, &line)
}

/// Writes the readable part of a damaged recording to a new one, replays that, and prints the lost parts and the first
/// damage. The exit code is that of the damaged recording.
pub fn recover(options: &RecoverOptions) -> Result<Exit, CommandError> {
    let path = &options.recording;
    let overwrite = Overwrite::from_force(options.output.force);
    let output = OutputFile::create(&options.output.output, overwrite, &[path])?;
    let mut recording = recording::open(path).map_err(CommandError::in_recording(path))?;
    let recovery = output.write(|output| match recording::recover(&mut recording, output) {
        Ok((recovery, _)) => Ok(recovery),
        Err(recording::Error::Write(error)) => Err(CommandError::unwritable(&options.output.output)(error)),
        Err(error) => Err(CommandError::in_recording(path)(error)),
    })?;
    let exit = if recovery.health == Health::Whole { Exit::Done } else { Exit::Damaged };
    let problem = if exit == Exit::Damaged { replay_problem(&options.output.output) } else { None };
    let result: Vec<String> = iter::once(recovery.to_string()).chain(problem).collect();
    if output::is_quiet() && exit == Exit::Damaged {
        output::print_to_stderr(&format!("{}\n", result.join("\n")))
    } else {
        output::print_result(&options.output.output, &result.join("\n"))?
    }
    Ok(exit)
}

/// Replays a recovered recording, if it is a file, and says that it does not replay the same or cannot be replayed:
/// values may have been altered that nothing else in the file contradicts.
fn replay_problem(path: &Path) -> Option<String> {
    if !path.is_file() || output_file::goes_to_standard_output(path) {
        return None;
    }
    match replay_with_progress(path, |_| Ok(ALL_STEPS), &mut CollisionCount::default()) {
        Ok(verdict @ (Verdict::Diverged(_) | Verdict::Corrupt { .. })) => {
            Some(format!("the new recording does not replay the same: {verdict}"))
        }
        Ok(Verdict::Same { .. } | Verdict::Incomplete { .. }) => None,
        Err(error) => Some(format!("the new recording cannot be replayed: {error}")),
    }
}
