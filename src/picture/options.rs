use super::find_collision::{collision_selector, find_collision};
use super::{CollisionSelector, Error, Figure, Format, Progress, ResolvedPicture, Source, Subject};
use crate::counted::counted;
use crate::physics::{Rect, Vector};
use crate::render::area::{inset, larger, union};
use crate::render::{CameraTarget, MAX_GIF_FPS, StepGrid, Style, Thinning};
use crate::scene::{ColorBy, Overlay, PictureDefaults, Theme};

/// Options of a picture. A field that is `None` falls back to the `[figure]` table of the first
/// recording's scene, then to the default.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// The kind of picture.
    pub subject: SubjectOptions,
    /// The first step to draw.
    pub from: Option<u64>,
    /// The last step to draw.
    pub to: Option<u64>,
    /// Draw only steps that are a multiple of this number.
    pub every: Option<u64>,
    /// Approximate frame rate, frames per second of playback.
    pub fps: Option<f64>,
    /// Playback speed: simulated seconds per second of playback, so 0.1 is slow motion. 1 if `None`.
    pub slow: Option<f64>,
    /// How long the animation freezes at each new collision, s. No freeze frames if `None`.
    pub hold: Option<f64>,
    /// Width and height, px.
    pub size: Option<[u32; 2]>,
    /// The colour theme.
    pub theme: Option<Theme>,
    /// The overlays drawn in addition to the boxes.
    pub show: Option<Vec<Overlay>>,
    /// The property shown by the colour of a box.
    pub color_by: Option<ColorBy>,
    /// The part of the plane to show.
    pub window: Option<WindowOptions>,
    /// The name of the body that the camera follows.
    pub follow: Option<String>,
    /// The caption below the picture; none if empty.
    pub caption: String,
    /// A title above each recording; the recordings' own titles if empty.
    pub titles: Vec<String>,
}

/// The kind of picture to draw.
#[derive(Clone, Debug, PartialEq)]
pub enum SubjectOptions {
    /// One state.
    Still {
        /// The step of the state.
        step: u64,
    },
    /// One PNG picture per drawn step.
    Sequence,
    /// An animation.
    Animation {
        /// Highest frame rate of the format, frames per second; infinite if it has no limit.
        max_fps: f64,
    },
    /// A figure.
    Figure(FigureChoice),
}

/// The choice of a lecture figure.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureChoice {
    /// Figure 1 of the handout: a collision.
    Collision {
        /// Shows the first collision in or after this step.
        step: u64,
        /// The names of the two bodies; any pair if `None`.
        pair: Option<[String; 2]>,
    },
    /// Figure 2 of the handout: the Minkowski difference at a collision.
    Minkowski {
        /// Shows the first collision in or after this step.
        step: u64,
        /// The names of the two bodies; any pair if `None`.
        pair: Option<[String; 2]>,
    },
    /// A figure of many states.
    States(Figure),
}

/// The part of the plane that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WindowOptions {
    /// The whole world.
    World,
    /// The bounding box of all bodies of finite mass over the whole run.
    Bodies,
    /// A fixed rectangle, m.
    Area(Rect),
    /// Width and height around the followed body, m.
    Size(Vector),
}

/// Default width and height of a picture, px.
const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// Default frame rate of an animation, frames per second.
const DEFAULT_FPS: f64 = 30.0;

impl PictureOptions {
    /// Options that set only the subject.
    pub fn new(subject: SubjectOptions) -> PictureOptions {
        PictureOptions {
            subject,
            from: None,
            to: None,
            every: None,
            fps: None,
            slow: None,
            hold: None,
            size: None,
            theme: None,
            show: None,
            color_by: None,
            window: None,
            follow: None,
            caption: String::new(),
            titles: Vec::new(),
        }
    }

    /// The highest frame rate of animations in `format`, frames per second; infinite if unlimited.
    pub const fn max_fps(format: Format) -> f64 {
        match format {
            Format::Gif => MAX_GIF_FPS,
            Format::Png | Format::Svg | Format::Pdf | Format::Apng => f64::INFINITY,
        }
    }

    /// Fills in every open setting for these recordings.
    ///
    /// # Errors
    /// If the recordings do not contain the subject, if options contradict each other, or if finding
    /// a collision requires a replay and that fails.
    pub fn resolve(&self, sources: &[Source], progress: Progress) -> Result<ResolvedPicture, Error> {
        let Some(first) = sources.first() else {
            return Err(Error::NothingToShow { reason: "no recording is given".into() });
        };
        let figure = &first.scene.figure;
        let default = Style::default();
        let mut show = self.show.clone().or(figure.show.clone()).unwrap_or(default.show);
        show.sort();
        show.dedup();
        Ok(ResolvedPicture {
            subject: self.resolved_subject(sources, figure, progress)?,
            size: self.size.or(figure.size).unwrap_or(DEFAULT_SIZE),
            theme: self.theme.or(figure.theme).unwrap_or(default.theme),
            show,
            color_by: self.color_by.or(figure.color_by).unwrap_or(default.color_by),
            camera_target: self.camera_target(sources)?,
            caption: self.caption.clone(),
            titles: self.resolved_titles(sources)?,
        })
    }

    fn resolved_titles(&self, sources: &[Source]) -> Result<Vec<String>, Error> {
        if self.titles.is_empty() || self.titles.len() == sources.len() {
            return Ok(self.titles.clone());
        }
        let reason = format!(
            "{} given for {}: give one title for each recording",
            counted(self.titles.len(), "title"),
            counted(sources.len(), "recording"),
        );
        Err(Error::Incompatible { reason })
    }

    fn camera_target(&self, sources: &[Source]) -> Result<CameraTarget, Error> {
        match (&self.follow, self.window) {
            (Some(name), window) => self.follow(name, window, sources),
            (None, Some(WindowOptions::World)) => Ok(CameraTarget::World),
            (None, Some(WindowOptions::Area(area))) => Ok(CameraTarget::Window(area)),
            (None, Some(WindowOptions::Bodies)) => body_bounds(sources)
                .map(CameraTarget::Window)
                .ok_or_else(|| Error::NothingToShow { reason: "the recording contains no body of finite mass".into() }),
            (None, Some(WindowOptions::Size(_))) => {
                let reason = "a window WIDTHxHEIGHT needs a body to follow: name it with --follow, or give the window as \
                              X,Y,WIDTH,HEIGHT";
                Err(Error::Incompatible { reason: reason.into() })
            }
            // If no body ever enters the world, a picture of the world would be empty.
            (None, None) => {
                match body_bounds(sources).filter(|_| !sources.iter().any(|source| source.summary.has_body_in_world)) {
                    Some(bounds) => Ok(CameraTarget::Window(bounds)),
                    None => Ok(CameraTarget::World),
                }
            }
        }
    }

    fn follow(&self, name: &str, window: Option<WindowOptions>, sources: &[Source]) -> Result<CameraTarget, Error> {
        let is_missing = |source: &&Source| !source.summary.names.iter().any(|existing| existing == name);
        if let Some(source) = sources.iter().find(is_missing) {
            return Err(unknown_body(name, source));
        }
        let size = match window {
            Some(WindowOptions::Size(size)) => size,
            Some(WindowOptions::Area(area)) => Vector::new(area.width(), area.height()),
            Some(WindowOptions::World | WindowOptions::Bodies) | None => sources[0].world(),
        };
        Ok(CameraTarget::Follow { name: name.to_owned(), size })
    }

    fn resolved_subject(
        &self,
        sources: &[Source],
        figure: &PictureDefaults,
        progress: Progress,
    ) -> Result<Subject, Error> {
        match &self.subject {
            SubjectOptions::Figure(figure) => self.figure(figure, sources, progress),
            SubjectOptions::Still { step } => still(*step, only_source(sources)?),
            SubjectOptions::Sequence => self.sequence(only_source(sources)?),
            SubjectOptions::Animation { max_fps } => self.animation(only_source(sources)?, figure, *max_fps),
        }
    }

    fn sequence(&self, source: &Source) -> Result<Subject, Error> {
        if self.slow.is_some() || self.hold.is_some() {
            let reason = "slow motion and freeze frames require an animation: OUT.gif, OUT.apng, OUT.mp4 or OUT.webm";
            return Err(Error::Incompatible { reason: reason.into() });
        }
        let grid = self.grid(source, self.thinning(None))?;
        Ok(Subject::Animation { steps: grid.steps, every: grid.every, frames_per_step: 1, slow: 1.0, hold: 0.0 })
    }

    fn animation(&self, source: &Source, figure: &PictureDefaults, max_fps: f64) -> Result<Subject, Error> {
        let (slow, rate) = (self.slow.unwrap_or(1.0), source.header.config.rate);
        let fps = self.fps.or(figure.fps).unwrap_or(DEFAULT_FPS);
        // Frames per simulated second.
        let (desired, max) = (fps / slow, max_fps / slow);
        let grid = self.grid(source, self.thinning(Some(desired)))?.limit_fps(max);
        let grid = non_empty(grid.restrict_to_every(source.header.every), source)?;
        let is_subdivided = self.every.is_none() && grid.every == 1 && source.header.config.solver.is_continuous();
        let desired = if desired < max { desired } else { max };
        let frames_per_step =
            if is_subdivided { ((desired / rate).round() as u64).min((max / rate) as u64).max(1) } else { 1 };
        let hold = self.hold.unwrap_or(0.0);
        Ok(Subject::Animation { steps: grid.steps, every: grid.every, frames_per_step, slow, hold })
    }

    /// The thinning of steps by `every`, else by `desired` frames per second, else by `fps`.
    fn thinning(&self, desired: Option<f64>) -> Thinning {
        match (self.every, desired.or(self.fps)) {
            (Some(every), _) => Thinning::Every(every),
            (None, Some(fps)) => Thinning::FramesPerSecond(fps),
            (None, None) => Thinning::All,
        }
    }

    fn grid(&self, source: &Source, thinning: Thinning) -> Result<StepGrid, Error> {
        let last = last_step(source)?;
        let to = self.to.map_or(last, |to| to.min(last));
        let grid = StepGrid::new(self.from.unwrap_or(0)..=to, source.header.config.rate, thinning);
        non_empty(grid.restrict_to_every(source.header.every), source)
    }

    fn figure(&self, figure: &FigureChoice, sources: &[Source], progress: Progress) -> Result<Subject, Error> {
        let mut find = |step: u64, pair: Option<&[String; 2]>| -> Result<Vec<CollisionSelector>, Error> {
            sources
                .iter()
                .map(|source| Ok(collision_selector(&find_collision(source, step, pair, progress)?)))
                .collect()
        };
        match figure {
            FigureChoice::Collision { step, pair } => Ok(Subject::Collision(find(*step, pair.as_ref())?)),
            FigureChoice::Minkowski { step, pair } => Ok(Subject::Minkowski(find(*step, pair.as_ref())?)),
            FigureChoice::States(figure) => self.states(*figure, sources),
        }
    }

    /// Chooses the number of states by the figure: a strobe shows few instants, a diagram a dense line.
    fn states(&self, figure: Figure, sources: &[Source]) -> Result<Subject, Error> {
        // Runs side by side end with the shortest.
        let mut last = u64::MAX;
        for source in sources {
            last = last_step(source)?.min(last);
        }
        let from = self.from.unwrap_or(0);
        let to = self.to.map_or(last, |to| to.min(last));
        let count = match figure {
            Figure::Filmstrip => 6,
            Figure::Strobe => 16,
            Figure::Spacetime(_) | Figure::Energy => 2000,
        };
        let every = to.saturating_sub(from).div_ceil(count - 1).max(1);
        let mut grid = StepGrid::new(from..=to, 1.0, Thinning::Every(self.every.unwrap_or(every)));
        for source in sources {
            grid = grid.restrict_to_every(source.header.every);
        }
        let grid = non_empty(grid, &sources[0])?;
        Ok(Subject::Figure { figure, steps: grid.steps, every: grid.every })
    }
}

/// The error for a body that does not exist in `source`.
pub fn unknown_body(name: &str, source: &Source) -> Error {
    const MAX_LISTED: usize = 8;
    let names = &source.summary.names;
    let count = names.len();
    let names = names.iter().take(MAX_LISTED).map(|name| format!("{name:?}")).collect::<Vec<String>>().join(", ");
    let reason = match count {
        0 => format!("no body is named {name:?}, because the recording contains no bodies"),
        1 => format!("no body is named {name:?}; the only body is {names}"),
        2..=MAX_LISTED => format!("no body is named {name:?}; the bodies are {names}"),
        _ => format!("no body is named {name:?}; the first of {} are {names}", counted(count, "body")),
    };
    Error::NothingToShow { reason }
}

/// The recording of a picture that shows exactly one.
fn only_source(sources: &[Source]) -> Result<&Source, Error> {
    match sources {
        [source] => Ok(source),
        [] | [..] => {
            let reason = "a picture or animation shows one recording; only figures show several side by side";
            Err(Error::Incompatible { reason: reason.into() })
        }
    }
}

fn still(step: u64, source: &Source) -> Result<Subject, Error> {
    let grid = StepGrid::new(step..=step, source.header.config.rate, Thinning::All);
    if last_step(source)? < step || grid.restrict_to_every(source.header.every).count() == 0 {
        return Err(no_frames(step, step, source.header.every, source));
    }
    Ok(Subject::Still { step, every: 1 })
}

fn last_step(source: &Source) -> Result<u64, Error> {
    source.summary.last_step.ok_or_else(|| Error::NothingToShow { reason: "the recording contains no state".into() })
}

/// Returns `grid` if it contains a step.
fn non_empty(grid: StepGrid, source: &Source) -> Result<StepGrid, Error> {
    match grid.count() {
        0 => Err(no_frames(*grid.steps.start(), *grid.steps.end(), grid.every, source)),
        _ => Ok(grid),
    }
}

fn no_frames(from: u64, to: u64, every: u64, source: &Source) -> Error {
    let last = source.summary.last_step.unwrap_or(0);
    let steps = if from == to { format!("at step {from}") } else { format!("in steps {from} to {to} by {every}") };
    Error::NothingToShow { reason: format!("the recording has no state {steps}; its last step is {last}") }
}

/// The bounding box of all bodies of finite mass over all runs, with a margin of 5 %, m.
fn body_bounds(sources: &[Source]) -> Option<Rect> {
    let all = sources.iter().filter_map(|source| source.summary.bounds).reduce(|a, b| union(&a, &b))?;
    Some(inset(&all, -0.05 * larger(all.width(), all.height())))
}
