use super::arguments::{RecordOptions, RecoverOptions};
use super::error::CommandError;
use super::output_file::{Durability, OutputFile, Overwrite};
use super::{Exit, output};
use crate::physics::SolverKind;
use crate::picture;
use crate::recording::{self, ColorFn, RecordedError};
use crate::replay::{self, LiveEvents, OnBadEvent, Recorded, RunError};
use crate::scene::{self, Scene};
use crate::text::counted;
use std::{
    fs::File,
    io::{self, BufRead, BufReader, Write},
    iter,
    path::{Path, PathBuf},
};

/// Runs a scene and records it.
pub fn run(options: &RecordOptions) -> Result<Exit, CommandError> {
    let inputs: Vec<&Path> = iter::once(&options.scene).chain(&options.events).map(PathBuf::as_path).collect();
    let output = OutputFile::create(&options.output, Overwrite::from_force(options.force), &inputs)?;
    let scene = match options.set.as_slice() {
        [] => scene::load(&options.scene)?,
        overrides => scene::load_with(&options.scene, overrides)?,
    };
    let plan = replay::RecordOptions {
        steps: options.steps.unwrap_or(scene.run.steps),
        every: options.every,
        estimates_accuracy: options.accuracy,
        has_live_events: options.events.is_some(),
        viewer: options.viewer.then_some(picture::body_color as ColorFn),
    };
    warn_of_unreached_inputs(&scene, plan.steps);
    if plan.estimates_accuracy && scene.run.solver == SolverKind::Handout {
        output::info(format_args!("the accuracy is not estimated: --accuracy needs the event-driven solver"));
    }
    let on_bad_event = if options.lenient { OnBadEvent::Skip } else { OnBadEvent::Fail };
    let events = options.events.as_deref().map(open_events).transpose()?;
    let mut live = events.map(|lines| LiveEvents::new(lines, on_bad_event, plan.steps));
    let durability = if options.sync { Durability::Disk } else { Durability::Program };
    let recorded = record(&scene, plan, live.as_mut(), output.record(durability)?, &options.output)?;
    print_summary(options, &recorded, live.map_or(0, |live| live.skipped()))?;
    match recorded.error {
        Some(error) => Err(CommandError::Step { path: options.output.clone(), error }),
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
    let bar = output::progress_bar("recording", plan.steps);
    let recorded = replay::record(scene, plan, live, output, |step| bar.set_position(step));
    bar.finish_and_clear();
    recorded.map_err(|error| match error {
        RunError::Recording(error) => CommandError::in_recording(path)(error),
        error => error.into(),
    })
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
    Ok(Box::new(BufReader::new(File::open(path).map_err(CommandError::unreadable(path))?)))
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
        return output::print_result(&options.output, &object.to_string());
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

/// Writes the readable part of a damaged recording to a new one, and prints what was lost. The exit code says whether
/// anything was.
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
    output::print_result(&options.output.output, &recovery.to_string())?;
    Ok(if recovery.is_everything() { Exit::Done } else { Exit::Damaged })
}
