use super::arguments::RenderOptions;
use super::error::CommandError;
use super::frames::Frames;
use super::kind::Kind;
use super::look;
use super::source::{Source, Survey};
use crate::physics::Vector;
use crate::render::{FASTEST_GIF, Metadata, Sampling, Thinning, View};
use std::{num::NonZero, path::PathBuf};

/// Frames per second of an animation nobody gave a rate.
const DEFAULT_FPS: f64 = 30.0;

/// All that is decided before the first frame is drawn.
pub struct Clip {
    /// The recording.
    pub path: PathBuf,
    /// Which steps are drawn.
    pub sampling: Sampling,
    /// How.
    pub view: View,
    /// What the result says of itself.
    pub metadata: Metadata,
    /// How many threads draw.
    pub threads: NonZero<usize>,
}

impl Clip {
    /// Settles what the flags leave open: from the scene, then from defaults.
    pub fn plan(options: &RenderOptions, kind: Kind, source: &Source) -> Result<Clip, CommandError> {
        let survey = Survey::of(&source.path)?;
        let sampling = sampling(options, kind, source, &survey)?;
        let figure = &source.scene.figure;
        let style = look::style(&options.look, figure, &survey);
        let size = look::size(&options.look, figure);
        let [width, height] = source.scene.size;
        let metadata = look::metadata(&survey, steps_in_words(&sampling), &style, size, "");
        let threads = options.jobs.or(std::thread::available_parallelism().ok()).unwrap_or(NonZero::<usize>::MIN);
        Ok(Clip {
            path: source.path.clone(),
            sampling,
            view: View::fit(Vector::new(width, height), size, style)?,
            metadata,
            threads,
        })
    }

    /// What the picture of one step of a sequence says of itself: that step, so that it does
    /// not matter in how many parts a sequence was drawn.
    pub fn metadata_of(&self, step: u64) -> Metadata {
        let mut metadata = self.metadata.clone();
        for (key, value) in &mut metadata.entries {
            if key == look::STEPS {
                *value = step.to_string();
            }
        }
        metadata
    }

    /// The frames to draw, in order.
    pub fn frames(&self) -> Result<Frames, CommandError> {
        Frames::new(&self.path, self.sampling.clone(), &self.view.style.show)
    }
}

/// Animations are thinned to their frame rate, pictures only when asked to be.
fn sampling(options: &RenderOptions, kind: Kind, source: &Source, survey: &Survey) -> Result<Sampling, CommandError> {
    let Some(last) = survey.last_step else {
        return Err(CommandError::NoSuchStep { what: "the recording has no state".into() });
    };
    let [from, to] = match options.at {
        Some(step) => [step, step],
        None => [options.from.unwrap_or(0), options.to.unwrap_or(last)],
    };
    let fps = source.scene.figure.fps.unwrap_or(DEFAULT_FPS);
    let thinning = match (options.every, options.fps, kind) {
        (Some(every), _, _) => Thinning::Every(every),
        (None, Some(fps), _) => Thinning::FramesPerSecond(fps),
        (None, None, Kind::Gif | Kind::Apng) => Thinning::FramesPerSecond(fps),
        (None, None, Kind::Picture | Kind::Sequence) => Thinning::All,
    };
    let steps = from..=if to < last { to } else { last };
    let sampling = Sampling::new(steps, source.header.settings.rate, thinning);
    let sampling = if kind == Kind::Gif { sampling.no_faster_than(FASTEST_GIF) } else { sampling };
    let sampling = sampling.among_every(source.header.every);
    if sampling.count() == 0 {
        let every = sampling.every;
        let asked = if from == to { format!("step {from}") } else { format!("steps {from} to {to} by {every}") };
        let what = format!("{asked} of a recording whose last step is {last}");
        return Err(CommandError::NoSuchStep { what });
    }
    Ok(sampling)
}

/// The steps that are drawn, in canonical form.
pub fn steps_in_words(sampling: &Sampling) -> String {
    let [first, last] = [sampling.steps.start(), sampling.steps.end()];
    if first == last { first.to_string() } else { format!("{first} to {last} every {}", sampling.every) }
}
