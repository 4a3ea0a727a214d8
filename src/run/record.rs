use super::{LiveEvents, Run, RunError, settings};
use crate::physics::{CollisionCount, StepError};
use crate::recording::{End, Header, Outcome, Paint, SceneText, Versions, Writer};
use crate::scene::{Scene, SceneError};
use std::io::{BufRead, Write};

/// How a scene is to be recorded.
#[derive(Clone, Copy, Debug)]
pub struct RecordOptions {
    /// The last step; the scene's own is in its [`RunOptions`](crate::scene::RunOptions).
    pub steps: u64,
    /// States of every `every`-th step are recorded in full, those between as digests; at least 1.
    pub every: u64,
    /// The colours in which viewers such as Foxglove are to show the boxes, if they are to.
    pub viewer: Option<Paint>,
}

impl RecordOptions {
    /// All of a scene, every state in full, and nothing for viewers.
    pub const fn whole(scene: &Scene) -> RecordOptions {
        RecordOptions { steps: scene.run.steps, every: 1, viewer: None }
    }
}

/// What came of recording a scene.
#[derive(Debug)]
pub struct Recorded {
    /// How the recording ended.
    pub end: End,
    /// The step the engine could not complete, if the run ended there.
    pub error: Option<StepError>,
}

/// Runs `scene` and writes it to `output`, and to nowhere else. Memory does not grow with the
/// number of steps. `progress` hears the number of each state recorded.
///
/// A step the engine cannot complete ends the run; the recording is then finished, tells the
/// error, and is readable up to there.
///
/// # Errors
/// When an input is refused or the output cannot be written. What was flushed to the output
/// before stays readable.
pub fn record<W: Write + Send + 'static>(
    scene: &Scene,
    options: RecordOptions,
    mut live: Option<&mut LiveEvents<impl BufRead>>,
    output: W,
    mut progress: impl FnMut(u64),
) -> Result<Recorded, RunError> {
    let mut run = Run::new(scene);
    let mut writer = Writer::new(output, &header(scene, options))?;
    if let Some(paint) = options.viewer {
        writer.show(paint);
    }
    let mut collisions = CollisionCount::default();
    let mut error = None;
    for step in 0..=options.steps {
        let due = live.as_mut().map(|live| live.due(step)).transpose()?;
        let refused = |error: SceneError| match &mut live {
            Some(live) => live.refuse(error.into()),
            None => Err(error.into()),
        };
        for event in run.happen(due.unwrap_or_default(), refused)? {
            writer.event(&event)?;
        }
        writer.state(run.engine())?;
        progress(step);
        if step < options.steps {
            error = run.step(&mut collisions).err();
        }
        if error.is_some() {
            break;
        }
    }
    let outcome = Outcome { collisions: Some(collisions.0), error: error.as_ref().map(StepError::to_string) };
    Ok(Recorded { end: writer.finish(outcome)?.end, error })
}

fn header(scene: &Scene, options: RecordOptions) -> Header {
    let text = SceneText { file_name: scene.source.file_name().to_owned(), text: scene.source.text.clone() };
    Header {
        versions: Versions::CURRENT,
        settings: settings(scene),
        steps: options.steps,
        every: options.every,
        scene: text,
        gaps: Vec::new(),
    }
}
