use super::clip::clock;
use super::collisions::{collision_selector, find_collision};
use super::page::{Names, run_names};
use super::{
    Animation, AnimationFormat, CameraTarget, CollisionFigure, Error, Look, MAX_FRAMES_PER_STEP, Moment, Page,
    PictureOptions, Progress, Quantity, ResolvedPicture, Source, StatesFigure, StepGrid, StepRange, StillFormat,
    Subject, Thinning, Timing, Window,
};
use crate::physics::{Axis, Rect, Vector, larger, smaller};
use crate::picture_options::{ReversedRange, StepOrTime, check_extent};
use crate::recording;
use crate::text::counted;
use std::ops::RangeInclusive;

/// The picture to draw and the format of its file.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub enum SubjectOptions {
    /// One state.
    State {
        /// The step of the state, or the state nearest to a time.
        step: StepOrTime,
        /// The format.
        format: StillFormat,
    },
    /// A lecture figure.
    Figure {
        /// The figure.
        figure: FigureOptions,
        /// The format.
        format: StillFormat,
    },
    /// An animation.
    Animation {
        /// The format.
        format: AnimationFormat,
    },
}

/// The choice of a lecture figure.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub enum FigureOptions {
    /// A figure of one collision of each recording.
    Collision {
        /// The kind of figure.
        figure: CollisionFigure,
        /// Shows the first collision in or after this step.
        step: StepOrTime,
        /// The names of the two bodies; any pair if `None`.
        pair: Option<[String; 2]>,
    },
    /// A figure of many states.
    States(StatesFigure),
    /// Energy and momentum against time.
    Energy,
    /// The distribution of speeds.
    Speeds,
    /// The pressure on walls and pistons.
    Pressure,
    /// Velocities in their own space, of two bodies along this axis.
    VelocitySpace(Axis),
    /// A quantity against time, of all recordings in one diagram.
    Lines(Quantity),
}

/// A folder of still PNG pictures, one per step.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// The first and the last step that may be shown.
    pub steps: RangeInclusive<u64>,
    /// Steps from one picture to the next; only steps that are a multiple of it are shown.
    pub every: u64,
    /// The appearance.
    pub look: Look,
    /// The titles above several recordings; their own titles if empty.
    pub titles: Vec<String>,
}

/// The number of recordings on a page of the default size. A page of more grows with their number.
const RECORDINGS_PER_PAGE: usize = 6;

/// The size of a picture of `count` recordings, px, unless one is given: that of the scene for a few recordings, or
/// else larger by sixteenths.
fn default_size(size: [u32; 2], count: usize) -> [u32; 2] {
    let factor = (count.max(RECORDINGS_PER_PAGE) as f64 / RECORDINGS_PER_PAGE as f64).sqrt();
    let sixteenths = (16.0 * factor).ceil() as u32;
    size.map(|side| side * sixteenths / 16)
}

/// Default frame rate of an animation, frames per second.
const DEFAULT_FPS: f64 = 30.0;

impl PictureOptions {
    /// Resolves a picture of these recordings: gives every open option the value in the `[figure]` table of the first
    /// recording's scene, else its default.
    ///
    /// # Errors
    /// If the recordings do not contain the subject, if options contradict each other, or if finding
    /// a collision requires a replay and that fails.
    pub fn resolve(
        &self,
        subject: &SubjectOptions,
        sources: &[Source],
        progress: Progress,
    ) -> Result<ResolvedPicture, Error> {
        let options = self.clone().or_scene(sources)?;
        let subject = match subject {
            SubjectOptions::State { step, format } => {
                Subject::Page { page: PictureOptions::state(*step, sources)?, format: *format }
            }
            SubjectOptions::Figure { figure, format } => {
                Subject::Page { page: options.figure(figure, sources, progress)?, format: *format }
            }
            SubjectOptions::Animation { format } => {
                let animation = options.animation(sources, format.max_fps())?;
                Subject::Animation { animation, format: *format }
            }
        };
        let look = self.sized_look(&options, sources)?;
        let titles = options.resolved_titles(sources, subject.names())?;
        Ok(ResolvedPicture { subject, look, titles })
    }

    /// The look of a picture with these options, which `options` complete: larger for many recordings, unless a size is
    /// given.
    fn sized_look(&self, options: &PictureOptions, sources: &[Source]) -> Result<Look, Error> {
        let mut look = options.look(options.camera_target(sources)?);
        if self.size.is_none() {
            look.size = default_size(look.size, sources.len());
        }
        Ok(look)
    }

    /// Resolves a sequence of still pictures. The frame rate of the scene applies only to animations and is ignored.
    ///
    /// # Errors
    /// As for [`PictureOptions::resolve`], and if an option requires an animation.
    pub fn resolve_sequence(&self, sources: &[Source]) -> Result<Sequence, Error> {
        if self.slow.is_some() || self.hold.is_some() {
            let reason = "slow motion and freeze frames require an animation: OUT.gif, OUT.apng, OUT.mp4 or OUT.webm";
            return Err(Error::Incompatible { reason: reason.into() });
        }
        let grid = self.grid(sources, self.fps)?;
        let options = self.clone().or_scene(sources)?;
        let (look, titles) = (self.sized_look(&options, sources)?, options.resolved_titles(sources, run_names)?);
        Ok(Sequence { steps: grid.steps, every: grid.every, look, titles })
    }

    /// Resolves a video, whose frame rate is unlimited: its animation, its appearance and the titles of its recordings.
    ///
    /// # Errors
    /// As for [`PictureOptions::resolve`].
    pub fn resolve_video(&self, sources: &[Source]) -> Result<(Animation, Look, Vec<String>), Error> {
        let options = self.clone().or_scene(sources)?;
        let animation = options.animation(sources, f64::INFINITY)?;
        let titles = options.resolved_titles(sources, run_names)?;
        Ok((animation, self.sized_look(&options, sources)?, titles))
    }

    /// These options, with the open ones taken from the scene of the first recording.
    fn or_scene(self, sources: &[Source]) -> Result<PictureOptions, Error> {
        let Some(first) = sources.first() else {
            return Err(Error::NothingToShow { reason: "no recording is given".into() });
        };
        let options = self.or(first.scene.figure.clone());
        let (caption, titles) = (options.caption.as_deref(), options.titles.as_deref());
        check_extent(caption.unwrap_or_default(), titles.unwrap_or_default(), sources.len())
            .map_err(|reason| Error::Incompatible { reason })?;
        Ok(options)
    }

    /// These options with a title for each of several runs that a command records with `--set`: the title of its scene
    /// with the values that are set. Titles that are given are kept.
    #[cfg(feature = "cli")]
    pub(crate) fn with_titles_of_runs(self, sources: &[Source]) -> PictureOptions {
        let has_titles = self.titles.as_ref().is_some_and(|titles| !titles.is_empty());
        if has_titles || sources.len() < 2 {
            return self;
        }
        PictureOptions { titles: Some(sources.iter().map(Source::title_with_settings).collect()), ..self }
    }

    /// The titles of several recordings: those that are given, or `names` if one of these is the name of a file, which
    /// the identity of a recording does not determine.
    fn resolved_titles(&self, sources: &[Source], names: Names) -> Result<Vec<String>, Error> {
        let titles = self.titles.clone().unwrap_or_default();
        if titles.is_empty() && sources.len() > 1 && sources.iter().any(|source| source.scene.title.is_none()) {
            let names = names(&[], sources);
            check_extent("", &names, sources.len()).map_err(|reason| Error::Incompatible { reason })?;
            return Ok(names);
        }
        if titles.is_empty() || titles.len() == sources.len() {
            return Ok(titles);
        }
        let reason = format!(
            "{} given for {}: give one title for each recording",
            counted(titles.len(), "title"),
            counted(sources.len(), "recording"),
        );
        Err(Error::Misused { reason })
    }

    fn camera_target(&self, sources: &[Source]) -> Result<CameraTarget, Error> {
        match (&self.follow, self.window) {
            (Some(name), window) => follow(name, window, sources),
            (None, Some(Window::World)) => Ok(CameraTarget::World),
            (None, Some(Window::Area(area))) => Ok(CameraTarget::Window(area)),
            (None, Some(Window::Bodies)) => match (body_bounds(sources), sources.first()) {
                (Some(bounds), _) => Ok(CameraTarget::Window(bounds)),
                (None, Some(source)) => Err(source.nothing_to_show("the recording contains no body of finite mass")),
                (None, None) => Err(Error::NothingToShow { reason: "no recording is given".into() }),
            },
            (None, Some(Window::Size(_))) => {
                let reason = "a window WIDTHxHEIGHT needs a body to follow: name it with --follow, or give the window as \
                              X,Y,WIDTH,HEIGHT";
                Err(Error::Incompatible { reason: reason.into() })
            }
            // If no body ever enters the world, a picture of the world would be empty.
            (None, None) => {
                match body_bounds(sources).filter(|_| !sources.iter().any(|source| source.statistics.has_body_in_world))
                {
                    Some(bounds) => Ok(CameraTarget::Window(bounds)),
                    None => Ok(CameraTarget::World),
                }
            }
        }
    }

    fn animation(&self, sources: &[Source], max_fps: f64) -> Result<Animation, Error> {
        let (slow, rate) = (self.slow.unwrap_or(1.0), clock(sources)?.header.config.rate);
        // Frames per simulated second.
        let (desired, max) = (self.fps.unwrap_or(DEFAULT_FPS) / slow, max_fps / slow);
        let grid = restricted(self.grid(sources, Some(desired))?.limit_fps(max), sources)?;
        let has_instants = sources.iter().any(|source| source.header.config.solver.is_continuous());
        let is_subdivided = self.every.is_none() && grid.every == 1 && has_instants;
        let desired = smaller(desired, max);
        let frames_per_step = if is_subdivided {
            ((desired / rate).round() as u64).min((max / rate) as u64).clamp(1, MAX_FRAMES_PER_STEP)
        } else {
            1
        };
        let timing = Timing { slow, frames_per_step, hold: self.hold.unwrap_or(0.0) };
        Ok(Animation { every: within_run(&grid, desired, sources), steps: grid.steps, timing })
    }

    /// The steps to draw, in those of the [`clock`], thinned by `every`, else to `fps` frames per simulated second.
    fn grid(&self, sources: &[Source], fps: Option<f64>) -> Result<StepGrid, Error> {
        let thinning = match (self.every, fps) {
            (Some(every), _) => Thinning::Every(every),
            (None, Some(fps)) => Thinning::FramesPerSecond(fps),
            (None, None) => Thinning::All,
        };
        let rate = clock(sources)?.header.config.rate;
        restricted(StepGrid::new(self.clock_steps(sources)?, rate, thinning), sources)
    }

    /// The steps of the [`clock`] in the time that all recordings contain.
    pub(super) fn clock_steps(&self, sources: &[Source]) -> Result<RangeInclusive<u64>, Error> {
        let rate = clock(sources)?.header.config.rate;
        self.refuse_reversed_range(rate)?;
        let from = self.from.map_or(0, |from| from.step(rate));
        let mut to = self.to.map_or(u64::MAX, |to| to.step(rate));
        for source in sources {
            let last = Moment { step: last_step(source)?, offset: 0.0 };
            to = to.min(last.at_rate(source.header.config.rate, rate).step);
        }
        Ok(from..=to)
    }

    fn refuse_reversed_range(&self, rate: f64) -> Result<(), Error> {
        let reversed = |range: ReversedRange| Error::Incompatible { reason: range.to_string() };
        ReversedRange::refuse(self.from, self.to, rate).map_err(reversed)
    }

    /// The page of one state: a step of the [`clock`], or the one nearest to a time.
    fn state(step: StepOrTime, sources: &[Source]) -> Result<Page, Error> {
        let rate = clock(sources)?.header.config.rate;
        let step = step.step(rate);
        let grid = StepGrid::new(step..=step, rate, Thinning::All);
        for source in sources {
            let last = Moment { step: last_step(source)?, offset: 0.0 }.at_rate(source.header.config.rate, rate).step;
            if last < step || restricted(grid.clone(), std::slice::from_ref(source)).is_err() {
                return Err(no_frames_of(&grid, last, source, sources));
            }
        }
        Ok(Page::State { step, every: None })
    }

    /// Returns an error if bodies are chosen for a figure that shows all, or if a name belongs to no body.
    fn check_bodies(&self, figure: &FigureOptions, sources: &[Source]) -> Result<(), Error> {
        let Some(selector) = &self.bodies else { return Ok(()) };
        match figure {
            FigureOptions::States(_) | FigureOptions::Lines(_) => {}
            FigureOptions::Speeds | FigureOptions::VelocitySpace(_) | FigureOptions::Pressure => {}
            FigureOptions::Collision { .. } | FigureOptions::Energy => {
                let reason = "this figure shows a pair or all bodies: choose bodies with --pair, or use the figures lines, \
                              speeds, pressure, velocity-space, spacetime, strobe or filmstrip";
                return Err(Error::Incompatible { reason: reason.into() });
            }
        }
        for source in sources {
            if let Some(part) = selector.first_unmatched(&source.statistics.names) {
                return Err(source.unknown_body(&part).of_source(source, sources));
            }
        }
        Ok(())
    }

    fn figure(&self, figure: &FigureOptions, sources: &[Source], progress: Progress) -> Result<Page, Error> {
        self.check_bodies(figure, sources)?;
        match figure {
            FigureOptions::Collision { figure, step, pair } => {
                let mut collisions = Vec::new();
                for source in sources {
                    last_step(source)?;
                    let found = find_collision(source, *step, pair.as_ref(), progress);
                    let (found, _) = found.map_err(|error| error.of_source(source, sources))?;
                    collisions.push(collision_selector(&found));
                }
                Ok(Page::Collision { figure: *figure, collisions })
            }
            // A filmstrip or strobe shows few instants; a diagram keeps all states that its page can show.
            FigureOptions::States(figure) => {
                let steps = match figure {
                    StatesFigure::Filmstrip => self.common_steps(ShownStates::Instants(6), sources),
                    StatesFigure::Strobe => self.common_steps(ShownStates::Instants(16), sources),
                    StatesFigure::Spacetime(_) => self.common_steps(ShownStates::OfRun, sources),
                };
                Ok(Page::States { figure: *figure, steps: steps? })
            }
            FigureOptions::Energy => Ok(Page::Energy { steps: self.common_steps(ShownStates::OfRun, sources)? }),
            FigureOptions::Speeds => Ok(Page::Speeds { steps: self.common_steps(ShownStates::Full, sources)? }),
            FigureOptions::Pressure => Ok(Page::Pressure { steps: self.common_steps(ShownStates::Full, sources)? }),
            FigureOptions::VelocitySpace(axis) => {
                Ok(Page::VelocitySpace { axis: *axis, steps: self.common_steps(ShownStates::Full, sources)? })
            }
            FigureOptions::Lines(quantity) => {
                Ok(Page::Lines { quantity: *quantity, steps: self.common_steps(ShownStates::OfRun, sources)? })
            }
        }
    }

    /// The steps of each recording in the time that all of them contain. Returns one range if it applies to all.
    fn common_steps(&self, shown: ShownStates, sources: &[Source]) -> Result<Vec<StepRange>, Error> {
        // Runs shown side by side end with the one that is the shortest in time.
        // Steps are those of the clock, as in animations.
        let rate = clock(sources)?.header.config.rate;
        self.refuse_reversed_range(rate)?;
        let from = self.from.map_or(0, |from| from.step(rate)) as f64 / rate;
        let mut to = self.to.map_or(f64::INFINITY, |to| to.step(rate) as f64 / rate);
        let mut shortest = clock(sources)?;
        for source in sources {
            let end = shown.last_step(source)? as f64 / source.header.config.rate;
            if end < to {
                (to, shortest) = (end, source);
            }
        }
        let steps = |rate: f64| (from * rate - 1e-9).ceil() as u64..=(to * rate * (1.0 + 1e-12) + 1e-9) as u64;
        let rate = shortest.header.config.rate;
        if steps(rate).is_empty() {
            let grid = StepGrid::new(steps(rate), rate, Thinning::All);
            return Err(no_frames_of(&grid, shown.last_step(shortest)?, shortest, sources));
        }
        let slowest = sources.iter().map(|source| source.header.config.rate).fold(f64::INFINITY, smaller);
        let interval = |count: u64| {
            let steps = ((to - from) * slowest / (count - 1) as f64 - 1e-9).ceil();
            larger(steps, 1.0) / slowest
        };
        let mut ranges = Vec::new();
        for source in sources {
            let rate = source.header.config.rate;
            let every = match (self.every, shown) {
                (Some(every), _) => every,
                (None, ShownStates::Instants(count)) => (interval(count) * rate).round() as u64,
                (None, ShownStates::Full | ShownStates::OfRun) => 1,
            };
            let grid = StepGrid::new(steps(rate), rate, Thinning::Every(every));
            let grid = grid.restrict_to_every(shown.recorded_every(source));
            if grid.count() == 0 {
                let last = shown.last_step(source)?;
                return Err(match shown.recorded_every(source) {
                    1 => too_coarse(&grid, last).of_source(source, sources),
                    _ => no_frames_of(&grid, last, source, sources),
                });
            }
            if matches!(shown, ShownStates::Instants(_)) && grid.count() > MAX_INSTANTS {
                return Err(too_many_instants(&grid));
            }
            let StepGrid { steps, every, .. } = grid;
            ranges.push(StepRange { steps, every });
        }
        if ranges.iter().all(|range| *range == ranges[0]) {
            ranges.truncate(1);
        }
        Ok(ranges)
    }
}

/// The states that a figure shows, unless `every` is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ShownStates {
    /// About this many at common instants, of those that are recorded in full.
    Instants(u64),
    /// All that are recorded in full.
    Full,
    /// All states of the run, which is replayed if possible.
    OfRun,
}

impl ShownStates {
    /// The last step that a figure can show.
    ///
    /// # Errors
    /// If no state is readable.
    fn last_step(self, source: &Source) -> Result<u64, Error> {
        match self {
            ShownStates::OfRun if source.is_replayable() => {
                source.statistics.end_step.ok_or_else(|| source.read_error(recording::Error::NoReadableState))
            }
            ShownStates::Instants(_) | ShownStates::Full | ShownStates::OfRun => last_step(source),
        }
    }

    /// The interval of the states that a figure can show.
    fn recorded_every(self, source: &Source) -> u64 {
        match self {
            ShownStates::OfRun if source.is_replayable() => 1,
            ShownStates::Instants(_) | ShownStates::Full | ShownStates::OfRun => source.header.every,
        }
    }
}

/// The largest number of instants of a strobe or filmstrip, which bounds its memory. More shades of a colour or panels
/// on a page could not be distinguished.
const MAX_INSTANTS: u64 = 256;

fn too_many_instants(grid: &StepGrid) -> Error {
    let (count, every) = (grid.count(), grid.every.saturating_mul(grid.count().div_ceil(MAX_INSTANTS)));
    let reason =
        format!("a picture of {count} instants shows too many: at most {MAX_INSTANTS}, as with --every {every}");
    Error::Incompatible { reason }
}

fn follow(name: &str, window: Option<Window>, sources: &[Source]) -> Result<CameraTarget, Error> {
    let is_missing = |source: &&Source| !source.statistics.names.iter().any(|existing| existing == name);
    if let Some(source) = sources.iter().find(is_missing) {
        return Err(source.unknown_body(name).of_source(source, sources));
    }
    let size = match window {
        Some(Window::Size(size)) => size,
        Some(Window::Area(area)) => Vector::new(area.width(), area.height()),
        Some(Window::World | Window::Bodies) | None => sources[0].world(),
    };
    Ok(CameraTarget::Follow { name: name.to_owned(), size })
}

/// The grid without the steps that a recording does not store, of those with the rate of the grid. Others are shown at
/// instants between their steps, for which they are replayed.
///
/// # Errors
/// If there is no step.
fn restricted(grid: StepGrid, sources: &[Source]) -> Result<StepGrid, Error> {
    let rate = grid.rate;
    let alike = sources.iter().filter(|source| source.header.config.rate == rate);
    let grid = alike.fold(grid, |grid, source| grid.restrict_to_every(source.header.every));
    let last = sources.iter().filter_map(|source| source.statistics.last_step).min().unwrap_or(0);
    match grid.count() {
        0 => Err(no_frames(&grid, last, sources)),
        _ => Ok(grid),
    }
}

/// The interval of a grid. If it shows step 0 alone, that is shown as long as the run, or as the interval of `fps`
/// frames per simulated second if that is longer.
fn within_run(grid: &StepGrid, fps: f64, sources: &[Source]) -> u64 {
    if grid.every <= *grid.steps.end() {
        return grid.every;
    }
    let duration = sources.iter().map(Source::duration).fold(f64::INFINITY, smaller);
    let run = (duration * grid.rate).round() as u64;
    grid.every.min(run.max(*grid.steps.end() + 1).max((grid.rate / fps).round() as u64))
}

/// The step of the last full state.
///
/// # Errors
/// If no state is readable.
fn last_step(source: &Source) -> Result<u64, Error> {
    source.statistics.last_step.ok_or_else(|| source.read_error(recording::Error::NoReadableState))
}

/// The error for a grid without a state of `source`, which is one of `sources` and whose last one is `last`.
fn no_frames_of(grid: &StepGrid, last: u64, source: &Source, sources: &[Source]) -> Error {
    no_frames(grid, last, std::slice::from_ref(source)).of_source(source, sources)
}

/// The error for a grid without a full state, of recordings whose common last one is `last`. If the end of one of them
/// is missing, or the grid is too coarse, that is the reason.
fn no_frames(grid: &StepGrid, last: u64, sources: &[Source]) -> Error {
    let (from, to) = (*grid.steps.start(), *grid.steps.end());
    let lacks = |source: &&Source| {
        let ends = [source.statistics.last_step, source.statistics.end_step];
        ends.contains(&Some(last)) && (last + 1..=source.header.steps).contains(&from)
    };
    let cut = sources.iter().find(lacks).and_then(|source| Some((source, source.declared_health().ok()?.health)));
    if let Some((source, health)) = cut.filter(|(_, health)| *health != recording::Health::Whole) {
        return source.missing_states(&(from..=to.max(from)), health);
    }
    let alike = sources.iter().filter(|source| source.header.config.rate == grid.rate);
    let every_step = StepGrid { every: 1, ..grid.clone() };
    let recorded = alike.fold(every_step, |grid, source| grid.restrict_to_every(source.header.every));
    if from <= last && recorded.count() > 0 {
        return too_coarse(grid, last);
    }
    let is_in_run = sources.iter().any(|source| source.statistics.end_step >= Some(from));
    let steps = match recorded.every {
        every if from == to && every > 1 && is_in_run => format!("at step {from}, but one every {every} steps"),
        _ if from == to => format!("at step {from}"),
        _ if from > last => format!("from step {from} on"),
        1 => format!("in the steps {from} to {to}"),
        every => format!("in the steps {from} to {to} by {every}"),
    };
    let is_full = sources.iter().any(|source| source.statistics.last_step == Some(last));
    let state = if is_full { "full state" } else { "state" };
    Error::NothingToShow { reason: format!("the recording has no {state} {steps}; its last one is at step {last}") }
}

/// The error for a grid between whose steps all chosen steps are.
fn too_coarse(StepGrid { every, steps, .. }: &StepGrid, last: u64) -> Error {
    let (from, to) = (*steps.start(), *steps.end());
    let chosen =
        if from == to { format!("step {from} is not one") } else { format!("none is in the steps {from} to {to}") };
    let next = to.div_ceil(*every).saturating_mul(*every);
    let near = if next <= last { next } else { from / every * every };
    let reason = format!(
        "only multiples of {every} are drawn, counted from step 0, and {chosen}; include step {near}, or choose another \
         interval with --every"
    );
    Error::NothingToShow { reason }
}

/// The bounding box of all bodies of finite mass over all runs, with a margin of 5 %, m.
fn body_bounds(sources: &[Source]) -> Option<Rect> {
    let all = sources.iter().filter_map(|source| source.statistics.bounds).reduce(|a, b| a.union(&b))?;
    Some(all.inset(-0.05 * larger(all.width(), all.height())))
}
