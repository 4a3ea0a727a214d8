use super::clip::clock;
use super::collisions::{find_collision, max_impulse};
use super::encode::{PngEffort, write_apng, write_gif, write_png_sequence};
use super::figures::{
    self, CollisionSubject, EnergyRun, FigureRun, LineRun, LineSubject, Range, SpacetimeRun, SpeedRun, Timeline,
    Velocities, VelocityPath, VelocityRun,
};
use super::layers::lanes::Lanes;
use super::number::TimeFormat;
use super::resimulation::Resimulation;
use super::text::Font;
use super::trace::trace;
use super::{
    Animation, AnimationFormat, AnimationSchedule, Clip, CollisionFigure, ColorBy, DisplayList, EnergySample, Error,
    Frame, Frames, Instant, Look, Overlay, Page, PictureOptions, Progress, Provenance, Quantity, ReadStatus,
    RenderError, ResolvedPicture, SOFTWARE, Sequence, Source, Sprite, Stage, StatesFigure, StepGrid, StepRange,
    StillFormat, Style, Subject, SubjectOptions, Thinning, Timing, Trails, View, compose,
};
use super::{Appearance, Palette, color};
use crate::body_selector::BodySelector;
use crate::physics::{Axis, BodyId, Engine, larger};
use crate::recording::{BodyInfo, Playback, SampledBody, SampledState};
use crate::replay::{Replayer, Verdict};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::num::NonZero;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The result of drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// How completely each recording was read.
    pub statuses: Vec<ReadStatus>,
    /// The steps and times shown by an animation or a sequence.
    pub schedule: Option<AnimationSchedule>,
    /// Sentences about contents that cannot be drawn as they are.
    pub warnings: Vec<String>,
}

/// Draws the picture described by `provenance` and writes it to `output` with the provenance.
///
/// Frames are drawn on `threads` threads; the bytes do not depend on their number.
///
/// # Errors
/// If a recording cannot be read or does not contain the subject, or if writing to `output` fails.
pub fn draw(
    provenance: &Provenance,
    sources: &[Source],
    threads: NonZero<usize>,
    progress: Progress,
    output: &mut dyn Write,
) -> Result<Drawn, Error> {
    let (picture, metadata) = (&provenance.picture, provenance.metadata());
    match &picture.subject {
        Subject::Page { page, format } => {
            let (list, statuses) = compose_page(page, picture, sources, progress)?;
            let effort = match page {
                Page::State { every: Some(_), .. } => PngEffort::Fast,
                _ => PngEffort::Small,
            };
            format.write(&list, &metadata, picture.look.text, effort, output)?;
            Ok(Drawn { statuses, schedule: None, warnings: warnings(picture, sources) })
        }
        Subject::Animation { animation, format } => {
            let clip = Clip::new(animation, &picture.look, &picture.titles, sources, progress)?;
            let Clip { stage, schedule, mut instants, warnings } = clip.with_common_lanes(sources)?;
            let mut done = 0;
            let observed = instants.by_ref().inspect(|_| {
                done += 1;
                progress(done, schedule.count());
            });
            match format {
                AnimationFormat::Gif => write_gif(observed, &stage, &schedule, &metadata, threads, output)?,
                AnimationFormat::Apng => write_apng(observed, &stage, &schedule, &metadata, threads, output)?,
            }
            Ok(Drawn { statuses: instants.read_statuses(), schedule: Some(schedule), warnings })
        }
    }
}

/// Draws a picture on the current thread and returns its file, which carries its provenance.
///
/// ```no_run
/// use rebond::{PictureOptions, Source, StillFormat, SubjectOptions, draw_to_vec};
///
/// let source = Source::open("cradle.mcap".as_ref())?;
/// let subject = SubjectOptions::State { step: 60.into(), format: StillFormat::Png };
/// let png = draw_to_vec(&subject, &PictureOptions::default(), &[source])?;
/// std::fs::write("cradle.png", png)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the options cannot be resolved for the recordings (see [`PictureOptions::resolve`]), or as
/// for [`draw`].
#[doc(alias("render", "screenshot", "plot"))]
pub fn draw_to_vec(subject: &SubjectOptions, options: &PictureOptions, sources: &[Source]) -> Result<Vec<u8>, Error> {
    let mut file = Vec::new();
    draw_options(subject, options, sources, SOFTWARE, NonZero::<usize>::MIN, &mut |_, _| (), &mut file)?;
    Ok(file)
}

/// Resolves a picture, draws it and writes it to `output`. A picture without a given size that is too small for its text
/// is drawn in a sufficient size. `software` is the name and version of the program in the provenance.
///
/// # Errors
/// As for [`PictureOptions::resolve`] and [`draw`].
pub fn draw_options(
    subject: &SubjectOptions,
    options: &PictureOptions,
    sources: &[Source],
    software: &str,
    threads: NonZero<usize>,
    progress: Progress,
    output: &mut dyn Write,
) -> Result<(Provenance, Drawn), Error> {
    let mut options = options.clone();
    loop {
        let resolved = options.resolve(subject, sources, progress)?;
        let provenance = Provenance { software: software.to_owned(), ..Provenance::new(&resolved, sources) };
        // A picture that is too small is refused before anything is written.
        match draw(&provenance, sources, threads, progress, output) {
            Err(Error::Render(RenderError::TooSmall { needed: Some(needed), .. })) if options.size.is_none() => {
                options.size = Some(needed);
            }
            drawn => return Ok((provenance, drawn?)),
        }
    }
}

impl Provenance {
    /// Draws the picture on the current thread and returns its file.
    ///
    /// # Errors
    /// As for [`draw`].
    pub fn draw_to_vec(&self, sources: &[Source]) -> Result<Vec<u8>, Error> {
        let mut file = Vec::new();
        draw(self, sources, NonZero::<usize>::MIN, &mut |_, _| (), &mut file)?;
        Ok(file)
    }
}

/// Draws a picture file again from its provenance and returns the new file, which has the same bytes.
///
/// `recordings` must contain the recordings of the picture, in any order, and may contain others.
///
/// # Errors
/// If the file has no provenance or one of its recordings is missing, or as for [`draw`].
pub fn redraw(file: &[u8], recordings: &[Source]) -> Result<Vec<u8>, Error> {
    let provenance = Provenance::read(file)?;
    let find = |identity: &String| {
        let found = recordings.iter().filter(|source| source.statistics.identity.as_ref() == Some(identity));
        let usable = found.clone().find(|source| source.header.every <= provenance.recorded_every);
        match (usable, found.count()) {
            (Some(source), _) => Ok(source.clone()),
            (None, 0) => {
                Err(Error::CannotRedraw { reason: format!("recording {identity} is not among the given recordings") })
            }
            (None, _) => Err(Error::CannotRedraw {
                reason: format!("recording {identity} stores fewer full states than the one that was drawn"),
            }),
        }
    };
    let sources = provenance.recordings.iter().map(find).collect::<Result<Vec<Source>, Error>>()?;
    provenance.draw_to_vec(&sources)
}

/// Draws each picture of a sequence and passes its step and its PNG file to `output`, in order. Each file carries the
/// provenance of that picture alone, so the files do not depend on how the sequence was divided into shards. A step that
/// all recordings lack has no picture.
///
/// # Errors
/// As for [`draw`], and the first error of `output`.
pub fn draw_sequence<E: From<Error>>(
    sequence: &Sequence,
    sources: &[Source],
    threads: NonZero<usize>,
    progress: Progress,
    mut output: impl FnMut(u64, Vec<u8>) -> Result<(), E>,
) -> Result<Drawn, E> {
    let Sequence { steps, every, look, titles } = sequence;
    let animation = Animation { steps: steps.clone(), every: *every, timing: Timing::REAL_TIME };
    let Clip { stage, schedule, mut instants, warnings } = Clip::new(&animation, look, titles, sources, progress)?;
    let stage = match (stage, sources) {
        // Each picture is that of its step alone, which lacks nothing.
        (Stage::One(view), [source]) => {
            let style = Style { gaps: Vec::new(), ..view.style };
            Stage::One(View::new(source.world(), style).map_err(Error::from)?)
        }
        (stage, _) => stage,
    };
    let metadata = |step| {
        let subject = Subject::Page { page: Page::State { step, every: Some(*every) }, format: StillFormat::Png };
        let picture = ResolvedPicture { subject, look: look.clone(), titles: titles.clone() };
        Provenance::new(&picture, sources).metadata()
    };
    let is_shown = |instant: &Result<Instant, Error>| !instant.as_ref().is_ok_and(Instant::is_missing);
    let mut done = 0;
    let result = write_png_sequence(
        instants.by_ref().filter(is_shown).map(|instant| instant.map_err(Failure::Drawing)),
        &stage,
        metadata,
        threads,
        |step, file| {
            done += 1;
            progress(done, schedule.count());
            output(step, file).map_err(Failure::Output)
        },
    );
    match result {
        Ok(()) => Ok(Drawn { statuses: instants.read_statuses(), schedule: Some(schedule), warnings }),
        Err(Failure::Drawing(error)) => Err(error.into()),
        Err(Failure::Output(error)) => Err(error),
    }
}

/// Separates errors of drawing from errors of the caller's `output`.
enum Failure<E> {
    Drawing(Error),
    Output(E),
}

impl<E> From<RenderError> for Failure<E> {
    fn from(error: RenderError) -> Failure<E> {
        Failure::Drawing(error.into())
    }
}

impl Style {
    /// The style of a picture of these recordings, with scales common to all of them.
    ///
    /// # Errors
    /// If the scale of impulse arrows requires a replay and that fails.
    pub fn new(look: &Look, sources: &[Source], progress: Progress) -> Result<Style, Error> {
        let mut top_impulse = 0.0;
        if look.show.contains(Overlay::Impulse) {
            for source in sources {
                top_impulse = larger(max_impulse(source, progress)?, top_impulse);
            }
        }
        Style::with_top_impulse(look, sources, top_impulse)
    }

    /// The style of a picture of these recordings, whose largest impulse is known, N·s.
    ///
    /// # Errors
    /// If the scale of momentum arrows requires all states and they cannot be read.
    fn with_top_impulse(look: &Look, sources: &[Source], top_impulse: f64) -> Result<Style, Error> {
        let mut top_momentum = 0.0;
        if look.show.contains(Overlay::Momentum) {
            for source in sources {
                top_momentum = larger(max_momentum(source)?, top_momentum);
            }
        }
        let top = |of: fn(&Source) -> f64| sources.iter().map(of).fold(0.0, larger);
        let mut materials: Vec<String> =
            sources.iter().flat_map(|source| source.statistics.materials.clone()).collect();
        materials.sort();
        materials.dedup();
        // The shortest step of all runs, and the longest run.
        let rate = top(|source| source.header.config.rate);
        Ok(Style {
            look: look.clone(),
            top_speed: top(|source| source.statistics.top_speed),
            top_momentum,
            top_force: top(|source| source.statistics.top_force),
            top_impulse,
            body_count: sources.iter().map(|source| source.statistics.names.len() as u32).max().unwrap_or(0),
            time_format: TimeFormat::new(1.0 / rate, top(Source::duration)),
            materials,
            gaps: Vec::new(),
            lanes: Lanes::default(),
        })
    }
}

/// The largest momentum of a body in any recorded state, kg·m/s. The end record has only the highest speed.
fn max_momentum(source: &Source) -> Result<f64, Error> {
    let mut max = 0.0;
    for state in Playback::new(source.recording()?) {
        let state = state.map_err(|error| source.read_error(error))?;
        let finite = state.bodies.iter().filter(|body| body.info.spawn.mass.is_finite());
        max = finite.map(|body| body.velocity.norm() * body.info.spawn.mass).fold(max, larger);
    }
    Ok(max)
}

/// The colour of a body in pictures with default options: red, green, blue.
pub fn body_color(info: &BodyInfo) -> [u8; 3] {
    let appearance = Appearance::new(info.id, &info.spawn, info.color.as_deref(), None);
    let color = match appearance.is_wall {
        true => Palette::of(Look::default().theme).wall,
        false => color::color_by_body(&appearance),
    };
    [color.r, color.g, color.b]
}

impl Animation {
    /// The schedule of this animation of recordings, without freeze frames.
    ///
    /// # Errors
    /// If there is no recording.
    pub fn schedule(&self, sources: &[Source]) -> Result<AnimationSchedule, Error> {
        Ok(AnimationSchedule::new(grid(&self.steps, self.every, clock(sources)?), self.timing, &[]))
    }
}

/// The shapes of a page, and how completely each recording was read.
fn compose_page(
    page: &Page,
    picture: &ResolvedPicture,
    sources: &[Source],
    progress: Progress,
) -> Result<(DisplayList, Vec<ReadStatus>), Error> {
    match page {
        Page::State { step, every } => state(*step, every.unwrap_or(1), picture, sources, progress),
        Page::Collision { figure, collisions } => {
            let style = Style::new(&picture.look, sources, progress)?;
            let mut subjects = Vec::new();
            for ((source, selector), title) in sources.iter().zip(collisions).zip(titles(&picture.titles, sources)) {
                let collision = find_collision(source, selector.step, Some(&selector.pair), progress)?;
                subjects.push(CollisionSubject { title, ..collision });
            }
            let list = match figure {
                CollisionFigure::Stages => figures::collision(&subjects, &style)?,
                CollisionFigure::Minkowski => figures::minkowski(&subjects, &style)?,
            };
            let statuses = sources.iter().map(Source::declared_health).collect::<Result<_, Error>>()?;
            Ok((list, statuses))
        }
        Page::States { figure: StatesFigure::Spacetime(axis), steps } => {
            let (mut runs, mut statuses) = (Vec::new(), Vec::new());
            let style = Style::new(&picture.look, sources, progress)?;
            for ((source, title), grid) in
                sources.iter().zip(titles(&picture.titles, sources)).zip(grids(steps, sources))
            {
                let bodies = source.appearances()?;
                let is_chosen = |body: &&Arc<Appearance>| body.is_wall || picture.look.bodies.contains(&body.name);
                let column = column(&grid, &style);
                let mut run = SpacetimeRun::new(title, source.world(), *axis, column);
                let trace = trace(source, &grid, column, progress, |point| {
                    if point.is_after_gap {
                        run.lift();
                    }
                    for body in &point.world.bodies {
                        if let Some(appearance) = bodies.get(&body.id).filter(is_chosen).cloned() {
                            let (rect, velocity) = (body.rect, body.velocity);
                            run.push(point.time, &Sprite { appearance, rect, velocity, trail: Vec::new() }, &style);
                        }
                    }
                })?;
                run.timeline = Timeline { changes: trace.changes, gaps: trace.gaps };
                runs.push(run);
                statuses.push(trace.status);
            }
            Ok((figures::spacetime(&runs, time_range(steps, sources), *axis, &style)?, statuses))
        }
        Page::States { figure, steps } => {
            let mut style = Style::new(&picture.look, sources, progress)?;
            let (mut runs, mut statuses) = (Vec::new(), Vec::new());
            for ((source, title), grid) in
                sources.iter().zip(titles(&picture.titles, sources)).zip(grids(steps, sources))
            {
                style.gaps.extend(source.gaps_in(&grid.steps));
                let schedule = AnimationSchedule::from(grid);
                let mut frames = Frames::new(source, &schedule, &picture.look.show)?;
                let mut drawn = frames.by_ref().collect::<Result<Vec<Frame>, Error>>()?;
                let is_chosen = |sprite: &Sprite| {
                    sprite.appearance.is_wall || picture.look.bodies.contains(&sprite.appearance.name)
                };
                drawn.iter_mut().for_each(|frame| frame.sprites.retain(is_chosen));
                runs.push(FigureRun { title, world: source.world(), frames: drawn });
                statuses.push(frames.read_status());
            }
            let list = match figure {
                StatesFigure::Strobe => figures::strobe(&runs, &style)?,
                StatesFigure::Filmstrip | StatesFigure::Spacetime(_) => figures::filmstrip(&runs, &style)?,
            };
            Ok((list, statuses))
        }
        Page::Speeds { steps } => {
            let mut style = Style::new(&picture.look, sources, progress)?;
            let top = sources.iter().map(|source| source.statistics.top_speed).fold(f64::MIN_POSITIVE, larger);
            let (mut runs, mut statuses) = (Vec::new(), Vec::new());
            for ((source, title), grid) in
                sources.iter().zip(titles(&picture.titles, sources)).zip(grids(steps, sources))
            {
                let bodies = chosen_bodies(&picture.look.bodies, source)?;
                let mut run = SpeedRun::new(title, top);
                // No instants between the states.
                let trace = trace(source, &grid, f64::INFINITY, progress, |point| {
                    for body in point.world.bodies.iter().filter(|body| bodies.contains_key(&body.id)) {
                        run.push(body.velocity.norm(), body.mass);
                    }
                })?;
                if !run.has_motion() {
                    let reason = "all chosen bodies are at rest, so there is no distribution of speeds".into();
                    return Err(Error::NothingToShow { reason });
                }
                runs.push(run);
                style.gaps.extend(trace.gaps);
                statuses.push(trace.status);
            }
            Ok((figures::speeds(&runs, &style)?, statuses))
        }
        Page::VelocitySpace { axis, steps } => {
            let mut style = Style::new(&picture.look, sources, progress)?;
            let (mut runs, mut statuses) = (Vec::new(), Vec::new());
            for ((source, title), grid) in
                sources.iter().zip(titles(&picture.titles, sources)).zip(grids(steps, sources))
            {
                let bodies = chosen_bodies(&picture.look.bodies, source)?;
                style.gaps.extend(source.gaps_in(&grid.steps));
                let velocities = match bodies.len() {
                    2 => Velocities::Pair(velocity_path(source, &bodies, *axis, &grid, progress)?),
                    _ => velocity_cloud(source, &bodies, &grid, &style)?,
                };
                runs.push(VelocityRun { title, velocities });
                statuses.push(source.declared_health()?);
            }
            Ok((figures::velocity_space(&runs, &style)?, statuses))
        }
        Page::Lines { quantity, steps } => {
            let style = Style::new(&picture.look, sources, progress)?;
            let (mut runs, mut statuses) = (Vec::new(), Vec::new());
            for ((source, title), grid) in
                sources.iter().zip(run_names(&picture.titles, sources)).zip(grids(steps, sources))
            {
                let column = column(&grid, &style);
                let subject = line_subject(*quantity, &picture.look.bodies, source)?;
                let mut run = LineRun::new(title, *quantity, subject, source.world().y, column);
                let trace = trace(source, &grid, column, progress, |point| {
                    if point.is_after_gap {
                        run.lift();
                    }
                    run.push(point.time, point.world);
                })?;
                run.timeline = Timeline { changes: trace.changes, gaps: trace.gaps };
                runs.push(run);
                statuses.push(trace.status);
            }
            Ok((figures::lines(&runs, time_range(steps, sources), *quantity, &style)?, statuses))
        }
        Page::Energy { steps } => {
            let style = Style::new(&picture.look, sources, progress)?;
            let (mut runs, mut statuses) = (Vec::new(), Vec::new());
            for ((source, title), grid) in
                sources.iter().zip(titles(&picture.titles, sources)).zip(grids(steps, sources))
            {
                let column = column(&grid, &style);
                let mut run = EnergyRun::new(title, column, source.statistics.top_force > 0.0);
                let trace = trace(source, &grid, column, progress, |point| {
                    if point.is_after_gap {
                        run.lift();
                    }
                    if point.is_after_gap || point.is_after_change {
                        run.restart_account();
                    }
                    run.push(&EnergySample::of(point.world, point.time));
                })?;
                run.timeline = Timeline { changes: trace.changes, gaps: trace.gaps };
                runs.push(run);
                statuses.push(trace.status);
            }
            Ok((figures::energy(&runs, time_range(steps, sources), &style)?, statuses))
        }
    }
}

/// The bodies of a diagram of lines: the chosen ones of finite mass. Energy and momentum are those of all bodies together,
/// unless bodies are chosen.
fn line_subject(quantity: Quantity, selector: &BodySelector, source: &Source) -> Result<LineSubject, Error> {
    if matches!(quantity, Quantity::Energy | Quantity::Momentum) && selector.is_all() {
        return Ok(LineSubject::System);
    }
    Ok(LineSubject::Bodies(chosen_bodies(selector, source)?))
}

/// The chosen bodies of finite mass.
fn chosen_bodies(selector: &BodySelector, source: &Source) -> Result<BTreeMap<BodyId, Arc<Appearance>>, Error> {
    let mut bodies = source.appearances()?;
    bodies.retain(|_, body| body.mass.is_finite() && selector.contains(&body.name));
    if bodies.is_empty() {
        return Err(Error::NothingToShow { reason: "no body of finite mass is chosen".into() });
    }
    Ok(bodies)
}

/// The velocities of two bodies along an axis in the steps of a grid, from a replay.
fn velocity_path(
    source: &Source,
    bodies: &BTreeMap<BodyId, Arc<Appearance>>,
    axis: Axis,
    grid: &StepGrid,
    progress: Progress,
) -> Result<VelocityPath, Error> {
    let (first, last) = (*grid.steps.start(), *grid.steps.end());
    let state = Playback::new(source.recording()?)
        .find(|state| state.as_ref().map_or(true, |state| state.step >= first && bodies_alive(state, bodies) == 2));
    let Some(state) = state.transpose().map_err(|error| source.read_error(error))? else {
        let reason = "the two chosen bodies are never alive at the same time".into();
        return Err(Error::NothingToShow { reason });
    };
    let mut chosen = state.bodies.iter().filter_map(|body| Some((bodies.get(&body.info.id)?, body)));
    let (Some(a), Some(b)) = (chosen.next(), chosen.next()) else {
        return Err(Error::NothingToShow { reason: "two bodies are required".into() });
    };
    let body = |(appearance, body): (&Arc<Appearance>, &SampledBody)| {
        (appearance.name.clone(), body.info.id, appearance.mass, body.velocity)
    };
    let mut path = VelocityPath::new([body(a), body(b)], axis);
    let mut replayer =
        Replayer::new(source.recording()?, state.step..=last).map_err(|error| source.read_error(error))?;
    let mut expected = state.step;
    while let Some(step) = replayer.next_state(&mut path).map_err(|error| source.read_error(error))? {
        if step != expected {
            // Collisions in a gap are unknown, so the path goes on where the bodies are after it.
            let world = replayer.engine().map(Engine::world);
            path.restart(world.iter().flat_map(|world| &world.bodies).map(|body| (body.id, body.velocity)));
        }
        expected = step + 1;
        progress(step, last);
    }
    match replayer.verdict() {
        verdict @ Verdict::Diverged(_) => {
            Err(Error::Diverged { path: source.path.clone(), verdict: Box::new(verdict) })
        }
        _ => Ok(path),
    }
}

/// The number of these bodies in a state.
fn bodies_alive(state: &SampledState, bodies: &BTreeMap<BodyId, Arc<Appearance>>) -> usize {
    state.bodies.iter().filter(|body| bodies.contains_key(&body.info.id)).count()
}

/// The velocities of bodies in the last state of a grid.
fn velocity_cloud(
    source: &Source,
    bodies: &BTreeMap<BodyId, Arc<Appearance>>,
    grid: &StepGrid,
    style: &Style,
) -> Result<Velocities, Error> {
    let mut last = None;
    let mut playback = Playback::new(source.recording()?);
    playback.seek(*grid.steps.end()).map_err(|error| source.read_error(error))?;
    for state in playback {
        let state = state.map_err(|error| source.read_error(error))?;
        if state.step > *grid.steps.end() {
            break;
        }
        last = Some(state);
    }
    let Some(state) = last.filter(|state| bodies_alive(state, bodies) > 0) else {
        return Err(Error::NothingToShow { reason: "no chosen body is alive in the last state: use --to".into() });
    };
    let of_body = |body: &SampledBody| {
        let appearance = bodies.get(&body.info.id)?.clone();
        let rect = body.info.spawn.rect;
        let sprite = Sprite { appearance, rect, velocity: body.velocity, trail: Vec::new() };
        Some((body.velocity, color::body_color(&sprite, style)))
    };
    let time = state.step as f64 / grid.rate;
    Ok(Velocities::Cloud { time, bodies: state.bodies.iter().filter_map(of_body).collect() })
}

/// The names of recordings in a common legend or side by side in an animation: titles, or the values given with `--set` if the recordings have the same
/// title.
pub(super) fn run_names(given: &[String], sources: &[Source]) -> Vec<String> {
    let values = |source: &Source| {
        let values = source.header.overrides.iter().map(|[key, value]| format!("{key} = {value}"));
        values.collect::<Vec<String>>().join(", ")
    };
    let is_study = sources.windows(2).all(|pair| pair[0].title() == pair[1].title())
        && sources.iter().all(|source| !source.header.overrides.is_empty());
    let all_values: Vec<String> = sources.iter().map(values).collect();
    let is_distinct = (1..all_values.len()).all(|at| !all_values[..at].contains(&all_values[at]));
    let solvers = |at: usize| sources[at].header.config.solver;
    match given.is_empty() {
        true if is_study && is_distinct && sources.len() > 1 => all_values,
        true if (1..sources.len()).all(|at| solvers(at) == solvers(0) && sources[at].title() != sources[0].title()) => {
            sources.iter().map(|source| source.title().to_owned()).collect()
        }
        _ => titles(given, sources),
    }
}

/// The shapes of one state. A single recording is replayed at most once.
fn state(
    step: u64,
    every: u64,
    picture: &ResolvedPicture,
    sources: &[Source],
    progress: Progress,
) -> Result<(DisplayList, Vec<ReadStatus>), Error> {
    let missing = || Error::NothingToShow { reason: "the step is not recorded".into() };
    let look = &picture.look;
    if let [source] = sources
        && look.show.contains(Overlay::Impulse)
    {
        // The scale of the arrows needs all impulses of the run, so the frame comes from the same replay.
        let schedule = AnimationSchedule::from(grid(&(step..=step), every, source));
        let trails = look.show.contains(Overlay::Trail).then(|| Trails::of_one_second(schedule.grid.rate));
        let mut run = Resimulation::of_whole_run(source, schedule, trails)?;
        let frame = run.next().transpose()?.ok_or_else(missing)?;
        let top_impulse = run.finish_run()?;
        let style = Style::with_top_impulse(look, sources, top_impulse)?;
        return Ok((compose(&frame, &View::new(source.world(), style)?), vec![run.read_status()]));
    }
    let animation = Animation { steps: step..=step, every, timing: Timing::REAL_TIME };
    let Clip { stage, mut instants, .. } = Clip::new(&animation, look, &picture.titles, sources, progress)?;
    let instant = instants.next().transpose()?.filter(|instant| !instant.is_missing()).ok_or_else(missing)?;
    // Damage directly after this state is found only by reading on.
    instants.next().transpose()?;
    Ok((stage.compose(&instant), instants.read_statuses()))
}

/// Sentences about the contents of a picture that cannot be drawn as they are.
fn warnings(picture: &ResolvedPicture, sources: &[Source]) -> Vec<String> {
    let is_of_pair = matches!(&picture.subject, Subject::Page { page: Page::Collision { .. }, .. });
    let is_of_lines = matches!(&picture.subject, Subject::Page { page: Page::Lines { .. }, .. });
    let is_of_state = matches!(&picture.subject, Subject::Page { page: Page::State { .. }, .. });
    let titles = match sources.len() {
        0 | 1 => Vec::new(),
        _ if is_of_lines || is_of_state => run_names(&picture.titles, sources),
        _ => titles(&picture.titles, sources),
    };
    text_warnings(
        &picture.look,
        &titles,
        sources,
        if is_of_pair || is_of_lines { BodyNames::Shown } else { BodyNames::IfOverlay },
    )
}

/// The names of bodies in a picture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum BodyNames {
    /// Shown with the overlay `name`.
    IfOverlay,
    /// Always shown.
    Shown,
}

/// Warns of characters in the texts of a picture that the font lacks.
pub(super) fn text_warnings(look: &Look, titles: &[String], sources: &[Source], names: BodyNames) -> Vec<String> {
    let mut missing: BTreeSet<char> = BTreeSet::new();
    let mut add = |text: &str| {
        let is_missing = |character: &char| !character.is_whitespace() && Font::embedded().glyph(*character) == 0;
        missing.extend(text.chars().filter(is_missing));
    };
    add(&look.caption);
    titles.iter().for_each(|title| add(title));
    for source in sources {
        if names == BodyNames::Shown || look.show.contains(Overlay::Name) {
            source.statistics.names.iter().for_each(|name| add(name));
        }
        if look.color_by == ColorBy::Material {
            source.statistics.materials.iter().for_each(|material| add(material));
        }
    }
    if missing.is_empty() {
        return Vec::new();
    }
    const MAX_LISTED: usize = 30;
    let listed: String = missing.iter().take(MAX_LISTED).collect();
    let more = missing.len().saturating_sub(MAX_LISTED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    vec![format!(
        "the font has no glyphs for {listed:?}{more}; each is drawn as an empty box: use Latin or Greek names"
    )]
}

/// The columns of the curves of a figure, s: half a pixel of the page.
fn column(grid: &StepGrid, style: &Style) -> f64 {
    (grid.steps.end() - grid.steps.start()) as f64 / grid.rate / (2.0 * f64::from(style.look.size[0]))
}

/// The time of all runs, s.
fn time_range(steps: &[StepRange], sources: &[Source]) -> Range {
    let times = grids(steps, sources)
        .flat_map(|grid| [*grid.steps.start(), *grid.steps.end()].map(|step| step as f64 / grid.rate));
    Range::of(times).unwrap_or(Range { from: 0.0, to: 1.0 })
}

/// The grid of each recording.
fn grids<'a>(steps: &'a [StepRange], sources: &'a [Source]) -> impl Iterator<Item = StepGrid> + 'a {
    let range = |at: usize| steps.get(at).or(steps.first());
    sources
        .iter()
        .enumerate()
        .filter_map(move |(at, source)| range(at).map(|range| grid(&range.steps, range.every, source)))
}

pub(super) fn grid(steps: &RangeInclusive<u64>, every: u64, source: &Source) -> StepGrid {
    StepGrid::new(steps.clone(), source.header.config.rate, Thinning::Every(every))
}

/// The titles of recordings shown side by side: those that are given, or the recordings' own.
fn titles(given: &[String], sources: &[Source]) -> Vec<String> {
    if given.len() == sources.len() {
        return given.to_vec();
    }
    let title = |source: &Source| format!("{} ({})", source.title(), source.header.config.solver.name());
    sources.iter().map(title).collect()
}
