//! The content of pages: states, collisions and traces of recordings, as the figures need them.

use super::collisions::{find_collision, gaps_before};
use super::draw::{grid, speed_of_most, state};
use super::figures::{
    self, CollisionSubject, EnergyRun, FigureRun, LineRun, LineSubject, MissingInstant, PressureRun, Range,
    SpacetimeRun, SpeedRun, SystemSums, Timeline, Velocities, VelocityPath, VelocityRun,
};
use super::trace::{Between, Traced, trace};
use super::visibility::Visibility;
use super::{
    AnimationSchedule, Appearance, CollisionFigure, CollisionSelector, DisplayList, EnergySample, Error, Frame, Frames,
    GapReason, Page, Progress, Quantity, ReadExtent, ReadStatus, ResolvedPicture, Source, Sprite, StatesFigure,
    StepGrid, StepRange, Style, Subject, TraceGap, color,
};
use crate::body_selector::BodySelector;
use crate::physics::{Axis, BodyId, Collision, Engine, Observer, Rect, Vector, larger};
use crate::recording::{Health, Playback, SampledBody, SampledState};
use crate::replay::{Replayer, Verdict};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// A page, and how completely each recording was read.
type Composed = (DisplayList, Vec<ReadStatus>);

/// The shapes of a page.
///
/// # Errors
/// If a recording cannot be read or does not contain the subject, or if the page is too small.
pub fn compose_page(
    page: &Page,
    picture: &ResolvedPicture,
    sources: &[Source],
    visibility: &mut Visibility,
    progress: Progress,
) -> Result<Composed, Error> {
    if let Page::State { step, every } = page {
        return state(*step, every.unwrap_or(1), picture, sources, visibility, progress);
    }
    if cfg!(not(feature = "figures")) {
        return Err(Error::Incompatible {
            reason: "this program draws no figures: build it with the feature figures".into(),
        });
    }
    let style = Style::new(&picture.look, sources, progress)?;
    let mut composer = Composer { picture, sources, style, progress };
    match page {
        Page::State { step, every } => {
            state(*step, every.unwrap_or(1), picture, sources, visibility, composer.progress)
        }
        Page::Collision { figure, collisions } => composer.collision(*figure, collisions),
        Page::States { figure: StatesFigure::Spacetime(axis), steps } => composer.spacetime(*axis, steps),
        Page::States { figure, steps } => composer.instants(*figure, steps),
        Page::Energy { steps } => composer.energy(steps),
        Page::Lines { quantity, steps } => composer.lines(*quantity, steps),
        Page::Pressure { steps } => composer.pressure(steps),
        Page::Speeds { steps } => composer.speeds(steps),
        Page::VelocitySpace { axis, steps } => composer.velocity_space(*axis, steps),
    }
}

/// Composes figures of recordings.
struct Composer<'a> {
    picture: &'a ResolvedPicture,
    sources: &'a [Source],
    style: Style,
    progress: Progress<'a>,
}

impl Composer<'_> {
    /// Reads one run of each recording. `read` receives the recording, its title and the grid of its steps.
    fn runs<R>(
        &mut self,
        steps: &[StepRange],
        mut read: impl FnMut(&mut Self, &Source, String, StepGrid) -> Result<(R, ReadStatus), Error>,
    ) -> Result<(Vec<R>, Vec<ReadStatus>), Error> {
        let sources = self.sources;
        let (mut runs, mut statuses) = (Vec::new(), Vec::new());
        for ((source, title), grid) in
            sources.iter().zip(titles(&self.picture.titles, sources)).zip(grids(steps, sources))
        {
            let (run, status) = read(self, source, title, grid)?;
            runs.push(run);
            statuses.push(status);
        }
        Ok((runs, statuses))
    }

    fn collision(&mut self, figure: CollisionFigure, collisions: &[CollisionSelector]) -> Result<Composed, Error> {
        let sources = self.sources;
        let (mut subjects, mut statuses) = (Vec::new(), Vec::new());
        for ((source, selector), title) in sources.iter().zip(collisions).zip(titles(&self.picture.titles, sources)) {
            let start = selector.step.into();
            let (collision, health) = find_collision(source, start, Some(&selector.pair), self.progress)?;
            subjects.push(CollisionSubject { title, ..collision });
            self.style.gaps.extend(gaps_before(source, selector.step)?);
            let declared = source.declared_health()?;
            // Only the index gives the end of the recording, and only reading finds damaged records.
            statuses.push(match (&health, &declared.health) {
                (Health::Corrupt { .. }, _) | (_, Health::Whole) => ReadStatus { health, ..declared },
                (Health::Whole | Health::Incomplete(_), _) => declared,
            });
        }
        let list = match figure {
            CollisionFigure::Stages(frame) => figures::collision(&subjects, frame, &self.style)?,
            CollisionFigure::Minkowski => figures::minkowski(&subjects, &self.style)?,
        };
        Ok((list, statuses))
    }

    fn spacetime(&mut self, axis: Axis, steps: &[StepRange]) -> Result<Composed, Error> {
        let (runs, statuses) = self.runs(steps, |all, source, title, grid| {
            let (bodies, column) = (source.appearances()?, column(&grid, &all.style));
            let is_chosen = |body: &&Arc<Appearance>| body.is_wall || all.picture.look.bodies.contains(&body.name);
            let mut run = SpacetimeRun::new(title, source.world(), axis, column);
            let trace = trace(source, &grid, column, Between::Collisions, all.progress, |part| match part {
                Traced::World(point) => {
                    if point.is_after_gap {
                        run.interrupt();
                    }
                    for body in &point.world.bodies {
                        if let Some(appearance) = bodies.get(&body.id).filter(is_chosen) {
                            run.push(point.time, &sprite(appearance, body.rect, body.velocity), &all.style);
                        }
                    }
                }
                Traced::Impacts(impacts) => {
                    for impact in impacts.bodies.values().filter(|impact| is_chosen(&&impact.appearance)) {
                        let sprite = sprite(&impact.appearance, impact.rect, impact.after);
                        run.push(impacts.time, &sprite, &all.style);
                    }
                }
            })?;
            run.timeline = Timeline { changes: trace.changes, gaps: trace.gaps };
            Ok((run, trace.status))
        })?;
        Ok((figures::spacetime(&runs, time_range(steps, self.sources), axis, &self.style)?, statuses))
    }

    fn instants(&mut self, figure: StatesFigure, steps: &[StepRange]) -> Result<Composed, Error> {
        let (runs, statuses) = self.runs(steps, |all, source, title, grid| {
            let (steps, all_steps, look) = (grid.steps.clone(), grid.clone(), &all.picture.look);
            let mut read = Frames::new(source, &AnimationSchedule::from(grid), &look.show)?;
            let mut frames = read.by_ref().collect::<Result<Vec<Frame>, Error>>()?;
            let status = read.read_status();
            if frames.is_empty() {
                return Err(source.missing_states(&steps, status.health));
            }
            let gaps = source.missing_in(&steps, &status.health);
            let missing = missing_instants(&all_steps, &frames, &gaps);
            all.style.gaps.extend(gaps);
            let is_chosen =
                |sprite: &Sprite| sprite.appearance.is_wall || look.bodies.contains(&sprite.appearance.name);
            frames.iter_mut().for_each(|frame| frame.sprites.retain(is_chosen));
            Ok((FigureRun { title, world: source.world(), frames, missing }, status))
        })?;
        let list = match figure {
            StatesFigure::Strobe => figures::strobe(&runs, &self.style)?,
            StatesFigure::Filmstrip | StatesFigure::Spacetime(_) => figures::filmstrip(&runs, &self.style)?,
        };
        Ok((list, statuses))
    }

    fn energy(&mut self, steps: &[StepRange]) -> Result<Composed, Error> {
        let (runs, statuses) = self.runs(steps, |all, source, title, grid| {
            let column = column(&grid, &all.style);
            let mut run = EnergyRun::new(title, column, source.statistics.top_force > 0.0);
            let mut sums = SystemSums::default();
            let trace = trace(source, &grid, column, Between::Collisions, all.progress, |part| match part {
                Traced::World(point) => {
                    if point.is_after_gap {
                        run.interrupt();
                    }
                    if point.is_after_gap || point.is_after_change {
                        run.restart_account();
                    }
                    let sample = EnergySample::of(point.world, point.time);
                    sums.set(point.world, sample);
                    run.push(&sample);
                }
                Traced::Impacts(impacts) => {
                    sums.collide(impacts).iter().flatten().for_each(|sample| run.push(sample));
                }
            })?;
            if run.has_overflow() {
                return Err(overflow());
            }
            run.timeline = Timeline { changes: trace.changes, gaps: trace.gaps };
            Ok((run, trace.status))
        })?;
        Ok((figures::energy(&runs, time_range(steps, self.sources), &self.style)?, statuses))
    }

    fn lines(&mut self, quantity: Quantity, steps: &[StepRange]) -> Result<Composed, Error> {
        let mut names = run_names(&self.picture.titles, self.sources).into_iter();
        let (runs, statuses) = self.runs(steps, |all, source, title, grid| {
            let column = column(&grid, &all.style);
            let subject = line_subject(quantity, &all.picture.look.bodies, source)?;
            let name = names.next().unwrap_or(title);
            let mut run = LineRun::new(name, quantity, subject, source.world().y, column);
            let trace = trace(source, &grid, column, Between::Collisions, all.progress, |part| match part {
                Traced::World(point) => {
                    if point.is_after_gap {
                        run.interrupt();
                    }
                    run.push(point.time, point.world);
                }
                Traced::Impacts(impacts) => run.push_impacts(impacts),
            })?;
            if run.has_overflow() {
                return Err(overflow());
            }
            run.timeline = Timeline { changes: trace.changes, gaps: trace.gaps };
            Ok((run, trace.status))
        })?;
        Ok((figures::lines(&runs, time_range(steps, self.sources), quantity, &self.style)?, statuses))
    }

    fn speeds(&mut self, steps: &[StepRange]) -> Result<Composed, Error> {
        let top = self.sources.iter().map(|source| source.statistics.top_speed).fold(f64::MIN_POSITIVE, larger);
        let top = speed_of_most(self.sources)?.unwrap_or(top);
        let (runs, statuses) = self.runs(steps, |all, source, title, grid| {
            let bodies = chosen_bodies(&all.picture.look.bodies, source)?;
            let mut run = SpeedRun::new(title, top);
            let trace = trace(source, &grid, f64::INFINITY, Between::Nothing, all.progress, |part| {
                let Traced::World(point) = part else { return };
                for body in point.world.bodies.iter().filter(|body| bodies.contains_key(&body.id)) {
                    run.push(body.velocity.norm(), body.mass);
                }
            })?;
            if !run.has_motion() {
                let reason = "all chosen bodies are at rest, so there is no distribution of speeds";
                return Err(source.nothing_to_show(reason));
            }
            if run.has_overflow() {
                return Err(overflow());
            }
            all.style.gaps.extend(trace.gaps);
            Ok((run, trace.status))
        })?;
        Ok((figures::speeds(&runs, &self.style)?, statuses))
    }

    fn velocity_space(&mut self, axis: Axis, steps: &[StepRange]) -> Result<Composed, Error> {
        let (runs, statuses) = self.runs(steps, |all, source, title, grid| {
            let bodies = chosen_bodies(&all.picture.look.bodies, source)?;
            let (velocities, status) = match bodies.len() {
                2 => {
                    let (path, health) = velocity_path(source, &bodies, axis, &grid, all.progress)?;
                    let status = ReadStatus { path: source.path.clone(), health, extent: ReadExtent::End };
                    (Velocities::Pair(Box::new(path)), status)
                }
                _ => (velocity_cloud(source, &bodies, &grid, &all.style)?, source.declared_health()?),
            };
            all.style.gaps.extend(source.missing_in(&grid.steps, &status.health));
            Ok((VelocityRun { title, velocities }, status))
        })?;
        Ok((figures::velocity_space(&runs, &self.style)?, statuses))
    }

    /// The pressure: impulses from a replay, volume and energy from the states.
    fn pressure(&mut self, steps: &[StepRange]) -> Result<Composed, Error> {
        let (runs, statuses) = self.runs(steps, |all, source, title, grid| {
            let time = [*grid.steps.start(), *grid.steps.end()].map(|step| step as f64 / grid.rate);
            let walls = pressed_bodies(&all.picture.look.bodies, source)?;
            let mut run = PressureRun::new(title, source.world(), Range { from: time[0], to: time[1] }, walls);
            add_impulses(&mut run, source, &grid, all.progress)?;
            let column = column(&grid, &all.style);
            let trace = trace(source, &grid, column, Between::Worlds, all.progress, |part| {
                let Traced::World(point) = part else { return };
                if point.is_after_gap {
                    run.interrupt();
                }
                run.push(point.time, point.world);
            })?;
            run.timeline = Timeline { changes: trace.changes, gaps: trace.gaps };
            Ok((run, trace.status))
        })?;
        Ok((figures::pressure(&runs, time_range(steps, self.sources), &self.style)?, statuses))
    }
}

/// The instants of a grid without a frame, each with the gap that it is in.
fn missing_instants(grid: &StepGrid, frames: &[Frame], gaps: &[TraceGap]) -> Vec<MissingInstant> {
    let (first, every) = (grid.steps.start().div_ceil(grid.every), grid.every);
    let steps = (0..grid.count()).map(|number| (first + number) * every);
    let is_missing = |step: &u64| frames.binary_search_by_key(step, |frame| frame.step).is_err();
    let instant = |step: u64| {
        let unknown = TraceGap { steps: step..=step, times: [0.0; 2], reason: GapReason::Unreadable };
        let gap = gaps.iter().find(|gap| gap.steps.contains(&step)).cloned().unwrap_or(unknown);
        MissingInstant { time: step as f64 / grid.rate, gap }
    };
    steps.filter(is_missing).map(instant).collect()
}

/// A body at an instant, without a trail.
fn sprite(appearance: &Arc<Appearance>, rect: Rect, velocity: Vector) -> Sprite {
    Sprite { appearance: appearance.clone(), rect, velocity, trail: Vec::new() }
}

/// The bodies of a diagram of lines: the chosen ones of finite mass. Energy and momentum are those of all bodies
/// together, unless bodies are chosen.
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
        return Err(source.nothing_to_show("no body of finite mass is chosen"));
    }
    Ok(bodies)
}

/// The bodies on which a figure shows the pressure: the chosen ones, or all of infinite mass.
fn pressed_bodies(selector: &BodySelector, source: &Source) -> Result<BTreeMap<BodyId, Arc<Appearance>>, Error> {
    let mut bodies = source.appearances()?;
    bodies.retain(|_, body| if selector.is_all() { body.mass == f64::INFINITY } else { selector.contains(&body.name) });
    let (count, most) = (bodies.len(), figures::MAX_PRESSURE_BODIES);
    if count > most {
        let reason =
            format!("the pressure on {count} bodies is more than a figure shows: choose up to {most} with --bodies");
        return Err(Error::Incompatible { reason });
    }
    Ok(bodies)
}

/// Adds the impulses of the collisions in the steps of a grid, from a replay.
fn add_impulses(run: &mut PressureRun, source: &Source, grid: &StepGrid, progress: Progress) -> Result<(), Error> {
    let (first, last) = (*grid.steps.start(), *grid.steps.end());
    if first == last {
        let reason = "a pressure is an impulse per time, which requires more than one state".into();
        return Err(Error::NothingToShow { reason });
    }
    let replayer = Replayer::new(source.recording()?, first..=last).map_err(|error| source.read_error(error))?;
    let verdict = replayer.run(run, |step| progress(step, last)).map_err(|error| source.read_error(error))?;
    is_same(verdict, source)?;
    match (run.side_count(), figures::MAX_PRESSURE_SIDES) {
        (0, _) => {
            let reason = "no body hits a wall in these steps: choose the bodies that are hit with --bodies";
            Err(source.nothing_to_show(reason))
        }
        (count, most) if count > most => {
            let reason = format!(
                "{count} sides of bodies are hit, more than the {most} that a figure shows: choose with --bodies"
            );
            Err(Error::Incompatible { reason })
        }
        _ => Ok(()),
    }
}

/// Returns an error if a replay diverged.
fn is_same(verdict: Verdict, source: &Source) -> Result<(), Error> {
    match verdict {
        verdict @ Verdict::Diverged(_) => {
            Err(Error::Diverged { path: source.path.clone(), verdict: Box::new(verdict) })
        }
        _ => Ok(()),
    }
}

/// The velocities of two bodies along an axis in the steps of a grid, from a replay, and the health of the recording as
/// far as it was read.
fn velocity_path(
    source: &Source,
    bodies: &BTreeMap<BodyId, Arc<Appearance>>,
    axis: Axis,
    grid: &StepGrid,
    progress: Progress,
) -> Result<(VelocityPath, Health), Error> {
    let last = *grid.steps.end();
    let state = first_common_state(source, bodies, &grid.steps)?;
    let mut chosen = state.bodies.iter().filter_map(|body| Some((bodies.get(&body.info.id)?, body)));
    let (Some(a), Some(b)) = (chosen.next(), chosen.next()) else {
        return Err(Error::NothingToShow { reason: "two bodies are required".into() });
    };
    let body = |(appearance, body): (&Arc<Appearance>, &SampledBody)| {
        (appearance.name.clone(), body.info.id, appearance.mass, body.velocity)
    };
    let mut path = VelocityPath::new([body(a), body(b)], axis);
    let steps = source.steps_to_read(state.step, last);
    let mut replayer = Replayer::new(source.recording()?, steps).map_err(|error| source.read_error(error))?;
    let mut expected = state.step;
    loop {
        let mut shown = InSteps { steps: state.step..last, path: &mut path };
        let Some(step) = replayer.next_state(&mut shown).map_err(|error| source.read_error(error))? else { break };
        // The rest of the file is read for its health alone.
        if step > last {
            continue;
        }
        if let Some(world) = replayer.engine().map(Engine::world) {
            let velocities = world.bodies.iter().filter(|body| bodies.contains_key(&body.id));
            let velocities = velocities.map(|body| (body.id, body.velocity));
            if step == expected {
                path.advance(velocities, 1.0 / grid.rate);
            } else {
                // Collisions in a gap are unknown, so the path goes on where the bodies are after it.
                path.restart(velocities);
            }
        }
        expected = step + 1;
        progress(step, last);
    }
    let verdict = replayer.verdict();
    match verdict.health() {
        Some(health) => Ok((path, health)),
        None => Err(Error::Diverged { path: source.path.clone(), verdict: Box::new(verdict) }),
    }
}

/// Returns the first state in which both bodies are alive.
fn first_common_state(
    source: &Source,
    bodies: &BTreeMap<BodyId, Arc<Appearance>>,
    steps: &RangeInclusive<u64>,
) -> Result<SampledState, Error> {
    let (first, last) = (*steps.start(), *steps.end());
    let mut playback = Playback::new(source.recording()?);
    playback.seek(first).map_err(|error| source.read_error(error))?;
    let mut has_states = false;
    for state in playback.by_ref() {
        let state = state.map_err(|error| source.read_error(error))?;
        if state.step > last {
            break;
        }
        has_states = true;
        if bodies_alive(&state, bodies) == 2 {
            return Ok(state);
        }
    }
    if !has_states {
        return Err(source.missing_states(steps, playback.health()));
    }
    let reason = format!("the two chosen bodies are never alive at the same time in the steps {first} to {last}");
    Err(source.nothing_to_show(reason))
}

/// Passes on the collisions between the states of a range. A replay also has those since the keyframe before, and those
/// in the rest of the file.
struct InSteps<'a> {
    /// From the first state to the last one, in which no collision is shown any more.
    steps: std::ops::Range<u64>,
    path: &'a mut VelocityPath,
}

impl Observer for InSteps<'_> {
    fn collision(&mut self, collision: &Collision) {
        if self.steps.contains(&collision.step) {
            self.path.collision(collision);
        }
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
    for state in playback.by_ref() {
        let state = state.map_err(|error| source.read_error(error))?;
        if state.step > *grid.steps.end() {
            break;
        }
        last = Some(state);
    }
    let end = *grid.steps.end();
    let last = last.ok_or_else(|| source.missing_states(&(end..=end), playback.health()))?;
    let Some(state) = Some(last).filter(|state| bodies_alive(state, bodies) > 0) else {
        return Err(source.nothing_to_show("no chosen body is alive in the last state: use --to"));
    };
    let of_body = |body: &SampledBody| {
        let sprite = sprite(bodies.get(&body.info.id)?, body.info.spawn.rect, body.velocity);
        Some((body.velocity, color::body_color(&sprite, style)))
    };
    let time = state.step as f64 / grid.rate;
    Ok(Velocities::Cloud { time, bodies: state.bodies.iter().filter_map(of_body).collect() })
}

/// Names recordings in a picture, given the titles that the user chose, if any.
pub type Names = fn(&[String], &[Source]) -> Vec<String>;

impl Subject {
    /// The names of several recordings in a picture of this subject: short ones in a legend and above states, and
    /// titles above figures.
    pub(super) const fn names(&self) -> Names {
        match self {
            Subject::Animation { .. } | Subject::Page { page: Page::Lines { .. } | Page::State { .. }, .. } => {
                run_names
            }
            Subject::Page { .. } => titles,
        }
    }
}

/// The names of recordings in a common legend or side by side in an animation: titles, or the values given with `--set`
/// if the recordings have the same title.
pub fn run_names(given: &[String], sources: &[Source]) -> Vec<String> {
    let values = |source: &Source| {
        let values = source.header.overrides.iter().map(|[key, value]| format!("{key} = {value}"));
        values.collect::<Vec<String>>().join(", ")
    };
    let is_study = sources.windows(2).all(|pair| pair[0].title() == pair[1].title())
        && sources.iter().all(|source| !source.header.overrides.is_empty());
    let all_values: Vec<String> = sources.iter().map(values).collect();
    let is_distinct = (1..all_values.len()).all(|at| !all_values[..at].contains(&all_values[at]));
    let has_own_title = |at: usize| sources[..at].iter().all(|earlier| earlier.title() != sources[at].title());
    let solvers = |at: usize| sources[at].header.config.solver;
    match given.is_empty() {
        true if is_study && is_distinct && sources.len() > 1 => all_values,
        true if (1..sources.len()).all(|at| solvers(at) == solvers(0) && has_own_title(at)) => {
            sources.iter().map(|source| source.title().to_owned()).collect()
        }
        _ => titles(given, sources),
    }
}

/// The columns of the curves of a figure, s: half a pixel of the page.
fn column(grid: &StepGrid, style: &Style) -> f64 {
    (grid.steps.end() - grid.steps.start()) as f64 / grid.rate / (2.0 * f64::from(style.look.size[0]))
}

/// The time of all runs, s. A single state is in the middle of ten steps, as far as there are steps before it.
fn time_range(steps: &[StepRange], sources: &[Source]) -> Range {
    const HALF: u64 = 5;
    let time = |step: u64, grid: &StepGrid| step as f64 / grid.rate;
    let range = |grid: StepGrid| {
        let (first, last) = (*grid.steps.start(), *grid.steps.end());
        let (first, last) = match last - first {
            0 => (first.saturating_sub(HALF), last.saturating_add(HALF)),
            _ => (first, last),
        };
        [time(first, &grid), time(last, &grid)]
    };
    Range::of(grids(steps, sources).flat_map(range)).unwrap_or(Range { from: 0.0, to: 1.0 })
}

/// The error of a diagram with values beyond the range of numbers, which would be empty.
fn overflow() -> Error {
    let reason = "a value of the diagram exceeds the range of numbers (1.8e308): choose other steps or bodies, or run the \
                  scene with smaller masses and speeds";
    Error::NothingToShow { reason: reason.into() }
}

/// The grid of each recording.
fn grids<'a>(steps: &'a [StepRange], sources: &'a [Source]) -> impl Iterator<Item = StepGrid> + 'a {
    let range = |at: usize| steps.get(at).or(steps.first());
    sources
        .iter()
        .enumerate()
        .filter_map(move |(at, source)| range(at).map(|range| grid(&range.steps, range.every, source)))
}

/// The titles of recordings shown side by side: those that are given, or the recordings' own with the
/// properties that distinguish recordings of one title.
pub fn titles(given: &[String], sources: &[Source]) -> Vec<String> {
    if given.len() == sources.len() {
        return given.to_vec();
    }
    let title = |source: &Source| {
        let name = |source: &Source| (source.title().to_owned(), source.header.config.solver);
        let namesakes: Vec<&Source> = sources.iter().filter(|other| name(other) == name(source)).collect();
        let mut details = vec![source.header.config.solver.name().to_owned()];
        details.extend(differences(source, &namesakes));
        format!("{} ({})", source.title(), details.join(", "))
    };
    sources.iter().map(title).collect()
}

/// The rate and the values given with `--set` of a recording that others do not have.
fn differences(source: &Source, others: &[&Source]) -> Vec<String> {
    const RATE: &str = "run.rate";
    let rate = source.header.config.rate;
    let has_own_rate = others.iter().any(|other| other.header.config.rate != rate);
    let is_own = |setting: &&[String; 2]| {
        setting[0] != RATE && others.iter().any(|other| !other.header.overrides.contains(*setting))
    };
    let settings = source.header.overrides.iter().filter(is_own).map(|[key, value]| format!("{key} = {value}"));
    has_own_rate.then(|| format!("{rate} Hz")).into_iter().chain(settings).collect()
}
