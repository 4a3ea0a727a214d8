use super::meeting::{encounter, meeting};
use super::{Encounter, Error, Figure, Format, Progress, Request, Source, Subject};
use crate::physics::{Rect, Vector};
use crate::render::area::{inset, larger, union};
use crate::render::{Aim, FASTEST_GIF, Sampling, Style, Thinning};
use crate::scene::{ColorBy, FigureOptions, Overlay, Theme};

/// What somebody asks for; what it leaves open the first scene's `[figure]` says, and then the
/// defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// What is to be drawn.
    pub subject: WishedSubject,
    /// The first step to draw.
    pub from: Option<u64>,
    /// The last step to draw.
    pub to: Option<u64>,
    /// Draw every so many steps, counted from step 0.
    pub every: Option<u64>,
    /// Draw about that many frames for each second on the screen.
    pub fps: Option<f64>,
    /// Simulated seconds for each second on the screen.
    pub slow: Option<f64>,
    /// Seconds for which an animation stops at collisions.
    pub hold: Option<f64>,
    /// Width and height, px.
    pub size: Option<[u32; 2]>,
    /// Light or dark.
    pub theme: Option<Theme>,
    /// What to draw beside the boxes.
    pub show: Option<Vec<Overlay>>,
    /// What colours tell.
    pub color_by: Option<ColorBy>,
    /// What part of the plane is seen.
    pub window: Option<WishedWindow>,
    /// The body that the camera follows.
    pub follow: Option<String>,
    /// What is written below.
    pub caption: String,
    /// What is written above each recording; their own titles if empty.
    pub titles: Vec<String>,
}

/// What is to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum WishedSubject {
    /// One state.
    Still {
        /// Its step.
        step: u64,
    },
    /// A picture for each step.
    Sequence,
    /// An animation of at most so many frames a second.
    Animation {
        /// Infinity where nothing limits it.
        fastest: f64,
    },
    /// A figure.
    Figure(WishedFigure),
}

/// Which figure.
#[derive(Clone, Debug, PartialEq)]
pub enum WishedFigure {
    /// The handout's figure 1, of the first collision from a step on.
    Collision {
        /// The step.
        step: u64,
        /// Of which two bodies; of any if none.
        pair: Option<[String; 2]>,
    },
    /// The handout's figure 2, likewise.
    Minkowski {
        /// The step.
        step: u64,
        /// Of which two bodies; of any if none.
        pair: Option<[String; 2]>,
    },
    /// A figure of states.
    States(Figure),
}

/// What part of the plane is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WishedWindow {
    /// The world, whole.
    World,
    /// All places where bodies of finite mass ever are.
    Bodies,
    /// This part, m.
    Area(Rect),
    /// So much around the body that is followed, m.
    Size(Vector),
}

/// Width and height of a picture nobody gave a size, px.
const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// Frames per second of an animation nobody gave a rate.
const DEFAULT_FPS: f64 = 30.0;

impl Wish {
    /// A wish that leaves all but its subject open.
    pub fn new(subject: WishedSubject) -> Wish {
        Wish {
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

    /// The fastest an animation of that format is.
    pub const fn fastest(format: Format) -> f64 {
        match format {
            Format::Gif => FASTEST_GIF,
            Format::Png | Format::Svg | Format::Pdf | Format::Apng => f64::INFINITY,
        }
    }

    /// What that comes to for these recordings.
    ///
    /// # Errors
    /// When there is nothing such to show in them.
    pub fn request(&self, sources: &[Source], progress: Progress) -> Result<Request, Error> {
        let Some(first) = sources.first() else {
            return Err(Error::Nothing { what: "there is no recording".into() });
        };
        let figure = &first.scene.figure;
        let default = Style::default();
        let mut show = self.show.clone().or(figure.show.clone()).unwrap_or(default.show);
        show.sort();
        show.dedup();
        Ok(Request {
            subject: self.resolved_subject(sources, figure, progress)?,
            size: self.size.or(figure.size).unwrap_or(DEFAULT_SIZE),
            theme: self.theme.or(figure.theme).unwrap_or(default.theme),
            show,
            color_by: self.color_by.or(figure.color_by).unwrap_or(default.color_by),
            aim: self.aim(sources)?,
            caption: self.caption.clone(),
            titles: self.resolved_titles(sources)?,
        })
    }

    fn resolved_titles(&self, sources: &[Source]) -> Result<Vec<String>, Error> {
        if self.titles.is_empty() || self.titles.len() == sources.len() {
            return Ok(self.titles.clone());
        }
        let what =
            format!("{} titles were given for {} recordings; give one for each", self.titles.len(), sources.len());
        Err(Error::Unfit { what })
    }

    fn aim(&self, sources: &[Source]) -> Result<Aim, Error> {
        match (&self.follow, self.window) {
            (Some(name), window) => self.following(name, window, sources),
            (None, Some(WishedWindow::World)) => Ok(Aim::World),
            (None, Some(WishedWindow::Area(area))) => Ok(Aim::Window(area)),
            (None, Some(WishedWindow::Bodies)) => reach(sources)
                .map(Aim::Window)
                .ok_or_else(|| Error::Nothing { what: "there is never a body of finite mass".into() }),
            (None, Some(WishedWindow::Size(_))) => {
                let what =
                    "a window of WIDTHxHEIGHT is seen around a body: name it with --follow, or give X,Y,WIDTH,HEIGHT";
                Err(Error::Unfit { what: what.into() })
            }
            // What is never in its world would leave an empty picture.
            (None, None) => match reach(sources).filter(|_| !sources.iter().any(|source| source.survey.is_in_world)) {
                Some(reach) => Ok(Aim::Window(reach)),
                None => Ok(Aim::World),
            },
        }
    }

    fn following(&self, name: &str, window: Option<WishedWindow>, sources: &[Source]) -> Result<Aim, Error> {
        if !sources.iter().all(|source| source.survey.names.iter().any(|known| known == name)) {
            return Err(unknown(name, sources));
        }
        let size = match window {
            Some(WishedWindow::Size(size)) => size,
            Some(WishedWindow::Area(area)) => Vector::new(area.width(), area.height()),
            Some(WishedWindow::World | WishedWindow::Bodies) | None => sources[0].world(),
        };
        Ok(Aim::Follow { name: name.to_owned(), size })
    }

    fn resolved_subject(
        &self,
        sources: &[Source],
        figure: &FigureOptions,
        progress: Progress,
    ) -> Result<Subject, Error> {
        match &self.subject {
            WishedSubject::Figure(figure) => self.figure(figure, sources, progress),
            WishedSubject::Still { step } => still(*step, only(sources)?),
            WishedSubject::Sequence => self.sequence(only(sources)?),
            WishedSubject::Animation { fastest } => self.clip(only(sources)?, figure, *fastest),
        }
    }

    fn sequence(&self, source: &Source) -> Result<Subject, Error> {
        if self.slow.is_some() || self.hold.is_some() {
            let what = "slow motion and stops are for animations: OUT.gif, OUT.apng, OUT.mp4";
            return Err(Error::Unfit { what: what.into() });
        }
        let sampling = self.sampling(source, self.thinning(None))?;
        Ok(Subject::Clip { steps: sampling.steps, every: sampling.every, parts: 1, slow: 1.0, hold: 0.0 })
    }

    fn clip(&self, source: &Source, figure: &FigureOptions, fastest: f64) -> Result<Subject, Error> {
        let (slow, rate) = (self.slow.unwrap_or(1.0), source.header.settings.rate);
        let fps = self.fps.or(figure.fps).unwrap_or(DEFAULT_FPS);
        // Frames for each simulated second.
        let (wanted, most) = (fps / slow, fastest / slow);
        let sampling = self.sampling(source, self.thinning(Some(wanted)))?.no_faster_than(most);
        let sampling = counted(sampling.among_every(source.header.every), source)?;
        let is_between = self.every.is_none() && sampling.every == 1 && source.header.settings.solver.is_continuous();
        let wanted = if wanted < most { wanted } else { most };
        let parts = if is_between { ((wanted / rate).round() as u64).min((most / rate) as u64).max(1) } else { 1 };
        let hold = self.hold.unwrap_or(0.0);
        Ok(Subject::Clip { steps: sampling.steps, every: sampling.every, parts, slow, hold })
    }

    fn thinning(&self, wanted: Option<f64>) -> Thinning {
        match (self.every, wanted.or(self.fps)) {
            (Some(every), _) => Thinning::Every(every),
            (None, Some(fps)) => Thinning::FramesPerSecond(fps),
            (None, None) => Thinning::All,
        }
    }

    fn sampling(&self, source: &Source, thinning: Thinning) -> Result<Sampling, Error> {
        let last = last_step(source)?;
        let to = self.to.map_or(last, |to| to.min(last));
        let sampling = Sampling::new(self.from.unwrap_or(0)..=to, source.header.settings.rate, thinning);
        counted(sampling.among_every(source.header.every), source)
    }

    fn figure(&self, figure: &WishedFigure, sources: &[Source], progress: Progress) -> Result<Subject, Error> {
        let mut encounters = |step: u64, pair: Option<&[String; 2]>| -> Result<Vec<Encounter>, Error> {
            sources.iter().map(|source| Ok(encounter(&meeting(source, step, pair, progress)?))).collect()
        };
        match figure {
            WishedFigure::Collision { step, pair } => Ok(Subject::Collision(encounters(*step, pair.as_ref())?)),
            WishedFigure::Minkowski { step, pair } => Ok(Subject::Minkowski(encounters(*step, pair.as_ref())?)),
            WishedFigure::States(figure) => self.states(*figure, sources),
        }
    }

    /// As many states as suit the figure: a strobe shows a few instants, a diagram a line.
    fn states(&self, figure: Figure, sources: &[Source]) -> Result<Subject, Error> {
        // Side by side runs are shown as far as the shortest goes.
        let mut last = u64::MAX;
        for source in sources {
            last = last_step(source)?.min(last);
        }
        let from = self.from.unwrap_or(0);
        let to = self.to.map_or(last, |to| to.min(last));
        let wanted = match figure {
            Figure::Filmstrip => 6,
            Figure::Strobe => 16,
            Figure::Spacetime(_) | Figure::Energy => 2000,
        };
        let fitting = to.saturating_sub(from).div_ceil(wanted - 1).max(1);
        let mut sampling = Sampling::new(from..=to, 1.0, Thinning::Every(self.every.unwrap_or(fitting)));
        for source in sources {
            sampling = sampling.among_every(source.header.every);
        }
        let sampling = counted(sampling, &sources[0])?;
        Ok(Subject::Figure { figure, steps: sampling.steps, every: sampling.every })
    }
}

/// The error of a body that is not in all of the recordings.
pub fn unknown(name: &str, sources: &[Source]) -> Error {
    let known = sources.iter().flat_map(|source| &source.survey.names).take(8);
    let known: Vec<String> = known.map(|name| format!("{name:?}")).collect();
    Error::Nothing { what: format!("no body is ever called {name:?}; there are {}", known.join(", ")) }
}

/// The recording of what shows one only.
fn only(sources: &[Source]) -> Result<&Source, Error> {
    match sources {
        [source] => Ok(source),
        [] | [..] => {
            let what = "one picture or animation shows one recording; figures show several side by side";
            Err(Error::Unfit { what: what.into() })
        }
    }
}

fn still(step: u64, source: &Source) -> Result<Subject, Error> {
    let sampling = Sampling::new(step..=step, source.header.settings.rate, Thinning::All);
    if last_step(source)? < step || sampling.among_every(source.header.every).count() == 0 {
        return Err(nothing(step, step, source.header.every, source));
    }
    Ok(Subject::Still { step, every: 1 })
}

fn last_step(source: &Source) -> Result<u64, Error> {
    source.survey.last_step.ok_or_else(|| Error::Nothing { what: "the recording has no state".into() })
}

fn counted(sampling: Sampling, source: &Source) -> Result<Sampling, Error> {
    match sampling.count() {
        0 => Err(nothing(*sampling.steps.start(), *sampling.steps.end(), sampling.every, source)),
        _ => Ok(sampling),
    }
}

fn nothing(from: u64, to: u64, every: u64, source: &Source) -> Error {
    let last = source.survey.last_step.unwrap_or(0);
    let asked = if from == to { format!("step {from}") } else { format!("steps {from} to {to} by {every}") };
    Error::Nothing { what: format!("{asked} of a recording whose last step is {last}") }
}

/// Where bodies ever are, with a margin, m.
fn reach(sources: &[Source]) -> Option<Rect> {
    let all = sources.iter().filter_map(|source| source.survey.reach).reduce(|a, b| union(&a, &b))?;
    Some(inset(&all, -0.05 * larger(all.width(), all.height())))
}
