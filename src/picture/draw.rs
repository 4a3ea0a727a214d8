use super::clip::clock;
use super::collisions::{freeze_frames, max_impulse};
use super::encode::{PngEffort, write_apng, write_gif, write_png_sequence};
use super::layers::body_labels::MAX_PLACED;
use super::layers::lanes::Lanes;
use super::number::TimeFormat;
use super::page::compose_page;
use super::resimulation::Resimulation;
use super::text::Font;
use super::visibility::Visibility;
use super::{
    Animation, AnimationFormat, AnimationSchedule, Clip, ColorBy, DisplayList, Error, Instant, Look, MAX_FRAMES,
    Moment, Overlay, Page, PictureOptions, Progress, Provenance, ReadStatus, RenderError, ResolvedPicture, SOFTWARE,
    Sequence, Source, Stage, StatesFigure, StepGrid, StillFormat, Style, Subject, SubjectOptions, Thinning, Timing,
    Trails, View, compose,
};
use super::{Appearance, Color, Palette, color};
use crate::physics::{BodyId, larger};
use crate::recording::{BodyInfo, Playback, SEMANTICS_VERSION};
use crate::scene::WALL_NAMES;
use crate::text::counted;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::num::NonZero;
use std::ops::RangeInclusive;

/// The result of drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// How completely each recording was read.
    pub statuses: Vec<ReadStatus>,
    /// The steps and times shown by an animation or a sequence.
    pub schedule: Option<AnimationSchedule>,
    /// The number of its instants without a picture, because all recordings lack them.
    pub missing: u64,
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
            let mut visibility = Visibility::default();
            let (list, statuses) = compose_page(page, picture, sources, &mut visibility, progress)?;
            let effort = match page {
                Page::State { every: Some(_), .. } => PngEffort::Fast,
                _ => PngEffort::Small,
            };
            format.write(&list, &metadata, picture.look.text, effort, output)?;
            let mut warnings = warnings(picture, sources);
            warnings.extend(visibility.warnings(&picture.look.camera_target));
            Ok(Drawn { statuses, schedule: None, missing: 0, warnings })
        }
        Subject::Animation { animation, format } => {
            animation.check_extent(sources)?;
            let clip = Clip::new(animation, &picture.look, &picture.titles, sources, progress)?;
            let Clip { stage, schedule, mut instants, mut warnings } = clip.with_common_lanes(sources)?;
            let (mut done, mut visibility) = (0, Visibility::default());
            let observed = instants.by_ref().inspect(|instant| {
                done += 1;
                instant.iter().for_each(|instant| stage.add_to(&mut visibility, instant));
                progress(done, schedule.count());
            });
            match format {
                AnimationFormat::Gif => write_gif(observed, &stage, &schedule, &metadata, threads, output)?,
                AnimationFormat::Apng => write_apng(observed, &stage, &schedule, &metadata, threads, output)?,
            }
            warnings.extend(visibility.warnings(&picture.look.camera_target));
            Ok(Drawn { statuses: instants.read_statuses(), schedule: Some(schedule), missing: 0, warnings })
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

/// Resolves a picture, draws it and writes it to `output`. A picture without a given size that is too small for its
/// text is drawn in a sufficient size. `software` is the name and version of the program in the provenance.
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
    let find = |(identity, &every): (&String, &u64)| {
        let found = recordings.iter().filter(|source| source.statistics.identity.as_ref() == Some(identity));
        match (with_states(found.clone(), every, |source| source.header.every), found.clone().next()) {
            (Some(source), _) => Ok(source.clone()),
            (None, None) => {
                Err(Error::CannotRedraw { reason: format!("recording {identity} is not among the given recordings") })
            }
            (None, Some(other)) => {
                let lacking = lacking_states(other.header.every, every);
                Err(Error::CannotRedraw { reason: format!("recording {identity} {lacking}") })
            }
        }
    };
    let recorded = provenance.recordings.iter().zip(&provenance.recorded_every);
    let sources = recorded.map(find).collect::<Result<Vec<Source>, Error>>()?;
    provenance.draw_to_vec(&sources)
}

/// Of recordings of one run, the one that stores every `every`-th state in full, as that of a picture, or else the first
/// one that stores these states, too.
pub(crate) fn with_states<R>(
    mut recordings: impl Iterator<Item = R> + Clone,
    every: u64,
    every_of: impl Fn(&R) -> u64,
) -> Option<R> {
    let same = recordings.clone().find(|recording| every_of(recording) == every);
    same.or_else(|| recordings.find(|recording| every.is_multiple_of(every_of(recording).max(1))))
}

/// The reason why a recording with a full state every `found` steps does not replace one with a full state every `every`
/// steps.
pub(crate) fn lacking_states(found: u64, every: u64) -> String {
    let [found, every] = [found, every].map(|steps| counted(steps, "step"));
    format!("has a full state every {found} and lacks states of the picture, which was drawn from one every {every}")
}

/// Draws each picture of a sequence and passes its step and its PNG file to `output`, in order. Each file carries the
/// provenance of that picture alone, so the files do not depend on how the sequence was divided into shards. A step
/// that all recordings lack has no picture.
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
    let Clip { stage, schedule, mut instants, mut warnings } = Clip::new(&animation, look, titles, sources, progress)?;
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
    let (mut done, mut visibility) = (0, Visibility::default());
    let mut observe = |instant: &Result<Instant, Error>| {
        instant.iter().for_each(|instant| stage.add_to(&mut visibility, instant));
    };
    let result = write_png_sequence(
        instants.by_ref().filter(is_shown).inspect(&mut observe).map(|instant| instant.map_err(Failure::Drawing)),
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
        Ok(()) => {
            let (statuses, missing) = (instants.read_statuses(), schedule.count() - done);
            warnings.extend(visibility.warnings(&look.camera_target));
            Ok(Drawn { statuses, schedule: Some(schedule), missing, warnings })
        }
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
        let color_speed = if look.color_by == ColorBy::Speed { speed_of_most(sources)? } else { None };
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
            color_speed,
            top_momentum,
            top_force: top(|source| source.statistics.top_force),
            top_impulse,
            body_count: sources.iter().map(|source| source.statistics.names.len() as u32).max().unwrap_or(0),
            time_format: TimeFormat::new(1.0 / rate, top(Source::duration), look.language),
            materials,
            gaps: Vec::new(),
            lanes: Lanes::default(),
        })
    }
}

/// The highest speed, m/s, of all but the fastest bodies, if one of these is more than three times as fast as all
/// others; otherwise `None`. The fastest bodies are at most one in 20. Bodies that never move do not count.
///
/// # Errors
/// If the states cannot be read.
pub(super) fn speed_of_most(sources: &[Source]) -> Result<Option<f64>, Error> {
    let mut tops = Vec::new();
    for source in sources.iter().filter(|source| source.statistics.names.len() >= BODIES_PER_FAST_ONE) {
        let mut of_source: BTreeMap<BodyId, f64> = BTreeMap::new();
        for state in Playback::new(source.recording()?) {
            for body in state.map_err(|error| source.read_error(error))?.bodies {
                let top = of_source.entry(body.info.id).or_insert(0.0);
                *top = larger(body.velocity.norm(), *top);
            }
        }
        tops.extend(of_source.into_values().filter(|top| *top > 0.0));
    }
    tops.sort_by(f64::total_cmp);
    let most = tops.len() - tops.len() / BODIES_PER_FAST_ONE;
    let (Some(&end), Some(&top)) = (tops[..most].last(), tops.last()) else { return Ok(None) };
    Ok((top > MUCH_FASTER * end).then_some(end))
}

/// One body in this number may be much faster than all others without changing the colours of these.
const BODIES_PER_FAST_ONE: usize = 20;

/// A body is much faster than others if its speed is this many times theirs.
const MUCH_FASTER: f64 = 3.0;

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

/// Returns the colour of a body in pictures with default options.
pub fn body_color(info: &BodyInfo) -> Color {
    let appearance = Appearance::new(info, None);
    if appearance.is_wall { Palette::of(Look::default().theme).wall } else { color::color_by_body(&appearance) }
}

impl Animation {
    /// The schedule of this animation of recordings, without freeze frames.
    ///
    /// # Errors
    /// If there is no recording.
    pub fn schedule(&self, sources: &[Source]) -> Result<AnimationSchedule, Error> {
        Ok(AnimationSchedule::new(grid(&self.steps, self.every, clock(sources)?), self.timing, &[]))
    }

    /// Checks that the recordings contain the steps, and that the frames are not too many, as for the options of a new
    /// animation.
    ///
    /// # Errors
    /// If there is no recording, or if the animation is longer than the recordings or than [`MAX_FRAMES`].
    fn check_extent(&self, sources: &[Source]) -> Result<(), Error> {
        let (last, end) = (*PictureOptions::default().clock_steps(sources)?.end(), *self.steps.end());
        if end > last {
            let reason = format!("the animation ends with step {end}, but the recording with step {last}");
            return Err(Error::NothingToShow { reason });
        }
        match self.schedule(sources)?.count() {
            frames if frames > MAX_FRAMES => {
                let reason =
                    format!("an animation of {frames} frames cannot be drawn; at most {MAX_FRAMES} are allowed");
                Err(Error::Incompatible { reason })
            }
            _ => Ok(()),
        }
    }

    /// The schedule of this animation of recordings, with its freeze frames, which a replay of each recording finds.
    ///
    /// # Errors
    /// If there is no recording, or a recording cannot be read.
    pub fn schedule_with_freeze_frames(
        &self,
        sources: &[Source],
        progress: Progress,
    ) -> Result<AnimationSchedule, Error> {
        let schedule = self.schedule(sources)?;
        if self.timing.hold == 0.0 {
            return Ok(schedule);
        }
        let mut moments: Vec<Moment> = Vec::new();
        for source in sources {
            moments.extend(freeze_frames(source, &schedule, progress)?);
        }
        moments.sort_by(|a, b| a.step.cmp(&b.step).then(a.offset.total_cmp(&b.offset)));
        Ok(AnimationSchedule::new(schedule.grid, self.timing, &moments))
    }
}

/// The shapes of one state. A single recording is replayed at most once.
pub(super) fn state(
    step: u64,
    every: u64,
    picture: &ResolvedPicture,
    sources: &[Source],
    visibility: &mut Visibility,
    progress: Progress,
) -> Result<(DisplayList, Vec<ReadStatus>), Error> {
    let look = &picture.look;
    if let [source] = sources
        && look.show.contains(Overlay::Impulse)
    {
        // The scale of the arrows needs all impulses of the run, so the frame comes from the same replay.
        let schedule = AnimationSchedule::from(grid(&(step..=step), every, source));
        let trails = look.show.contains(Overlay::Trail).then(|| Trails::of_one_second(schedule.grid.rate));
        let mut run = Resimulation::of_whole_run(source, schedule, trails)?;
        let frame = run.next().transpose()?;
        let top_impulse = run.finish_run()?;
        let frame = frame.ok_or_else(|| source.missing_states(&(step..=step), run.read_status().health))?;
        let style = Style::with_top_impulse(look, sources, top_impulse)?;
        let view = View::new(source.world(), style)?;
        visibility.add(0, &frame, &view);
        return Ok((compose(&frame, &view), vec![run.read_status()]));
    }
    let animation = Animation { steps: step..=step, every, timing: Timing::REAL_TIME };
    let Clip { stage, mut instants, .. } = Clip::new(&animation, look, &picture.titles, sources, progress)?;
    let missing = || Error::NothingToShow { reason: "the step is not recorded".into() };
    let instant = instants.next().transpose()?;
    // Damage directly after this state is found only by reading on, and so is that the state is missing.
    instants.next().transpose()?;
    let instant = instant.ok_or_else(missing)?;
    stage.add_to(visibility, &instant);
    Ok((stage.compose(&instant), instants.read_statuses()))
}

/// Sentences about the contents of a picture that cannot be drawn as they are.
fn warnings(picture: &ResolvedPicture, sources: &[Source]) -> Vec<String> {
    let is_of_pair = matches!(&picture.subject, Subject::Page { page: Page::Collision { .. }, .. });
    let is_of_lines = matches!(&picture.subject, Subject::Page { page: Page::Lines { .. }, .. });
    let titles = match sources.len() {
        0 | 1 => Vec::new(),
        _ => picture.subject.names()(&picture.titles, sources),
    };
    let is_of_pressure = matches!(&picture.subject, Subject::Page { page: Page::Pressure { .. }, .. });
    let names = if is_of_pair || is_of_lines || is_of_pressure { BodyNames::Shown } else { BodyNames::IfOverlay };
    let mut warnings = text_warnings(&picture.look, &titles, sources, names);
    if matches!(
        &picture.subject,
        Subject::Page {
            page: Page::State { .. } | Page::States { figure: StatesFigure::Strobe | StatesFigure::Filmstrip, .. },
            ..
        }
    ) {
        warnings.extend(label_warning(&picture.look, sources));
    }
    let is_over_time = matches!(
        &picture.subject,
        Subject::Page {
            page: Page::Energy { .. } | Page::Lines { .. } | Page::States { figure: StatesFigure::Spacetime(_), .. },
            ..
        }
    );
    let is_older = |source: &&Source| {
        source.header.versions.semantics != SEMANTICS_VERSION && source.header.config.solver.is_continuous()
    };
    warnings.extend(sources.iter().filter(|_| is_over_time).filter(is_older).map(|source| {
        format!(
            "{} is of another version of the engine, which cannot be replayed: collisions between its states are not \
             drawn; record its scene again",
            source.path.display()
        )
    }));
    let rests = |source: &Source| source.statistics.top_force > 0.0 && source.header.config.solver.is_continuous();
    if is_of_pressure && sources.iter().any(rests) {
        warnings.push(
            "bodies that rest on a wall press on it without collisions: their weight is no part of the pressure".into(),
        );
    }
    warnings
}

/// The names of bodies in a picture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum BodyNames {
    /// Shown with the overlay `name`.
    IfOverlay,
    /// Always shown.
    Shown,
}

/// A sentence about the labels of boxes that are left out because there are too many boxes, if a picture may have them.
pub(super) fn label_warning(look: &Look, sources: &[Source]) -> Option<String> {
    let is_labelled = look.show.contains(Overlay::Name) || look.show.contains(Overlay::Mass);
    let boxes = |source: &Source| {
        let is_wall = |name: &str| source.scene.walls.is_some() && WALL_NAMES.contains(&name);
        let names = source.statistics.names.iter();
        names.filter(|name| !is_wall(name) && look.bodies.contains(name)).count()
    };
    let boxes = sources.iter().map(boxes).max()?;
    (is_labelled && boxes > MAX_PLACED).then(|| {
        format!(
            "where more than {MAX_PLACED} boxes are visible, only labels that fit into their boxes are drawn: \
             choose a part with --window, or a larger --size"
        )
    })
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
        "the font has no glyphs for {listed:?}{more}; each is drawn as an empty box: use Latin, Greek or Cyrillic names"
    )]
}

pub(super) fn grid(steps: &RangeInclusive<u64>, every: u64, source: &Source) -> StepGrid {
    StepGrid::new(steps.clone(), source.header.config.rate, Thinning::Every(every))
}
