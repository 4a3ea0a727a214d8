use super::energies::energies;
use super::find_collision::find_collision;
use super::freeze_frames::freeze_frames;
use super::style::style;
use super::{
    CollisionSelector, Error, Figure, Format, Frames, PictureOptions, Progress, Provenance, ReadStatus,
    ResolvedPicture, Source, Subject,
};
use crate::figure::{self, CollisionSubject, EnergyRun, FigureOptions, FigureRun};
use crate::render::{
    AnimationSchedule, DisplayList, Frame, Metadata, StepGrid, Thinning, Timing, View, compose, write_apng, write_gif,
    write_png_sequence,
};
use std::io::Write;
use std::num::NonZero;

/// Draws the picture described by `provenance`, writes it to `output` with the provenance, and
/// returns how completely each recording was read.
///
/// Frames are drawn on `threads` threads; the bytes do not depend on their number.
///
/// # Errors
/// If a recording cannot be read or does not contain the subject, if the format cannot hold it, or
/// if writing to `output` fails.
pub fn draw(
    provenance: &Provenance,
    sources: &[Source],
    format: Format,
    threads: NonZero<usize>,
    progress: Progress,
    output: &mut dyn Write,
) -> Result<Vec<ReadStatus>, Error> {
    let picture = &provenance.picture;
    let is_animation = matches!(picture.subject, Subject::Animation { .. });
    if is_animation != format.is_animated() {
        let expected =
            if is_animation { "an animation is GIF or animated PNG" } else { "one picture is PNG, SVG or PDF" };
        return Err(Error::Incompatible { reason: format!("{expected}, not {}", format.name()) });
    }
    let metadata = provenance.metadata();
    if is_animation {
        return animation(picture, &sources[0], &metadata, format, threads, progress, output);
    }
    let (list, statuses) = compose_picture(picture, sources, progress)?;
    format.write(&list, &metadata, output)?;
    Ok(statuses)
}

/// Draws a picture on the current thread and returns its file, which carries its provenance.
///
/// ```no_run
/// use rebond::picture::{Format, PictureOptions, Source, SubjectOptions, draw_to_vec};
///
/// let source = Source::open("cradle.mcap".as_ref())?;
/// let png = draw_to_vec(&PictureOptions::new(SubjectOptions::Still { step: 60 }), &[source], Format::Png)?;
/// std::fs::write("cradle.png", png)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the options cannot be resolved for the recordings (see [`PictureOptions::resolve`]), or as
/// for [`draw`].
pub fn draw_to_vec(options: &PictureOptions, sources: &[Source], format: Format) -> Result<Vec<u8>, Error> {
    let provenance = Provenance::new(&options.resolve(sources, &mut |_, _| ())?, sources);
    let mut file = Vec::new();
    draw(&provenance, sources, format, NonZero::<usize>::MIN, &mut |_, _| (), &mut file)?;
    Ok(file)
}

/// Draws each frame of a sequence as a PNG file and passes its step and content to `output`, in
/// order. Each file carries the provenance of that picture alone, so the files do not depend on how
/// the sequence was divided into shards.
///
/// # Errors
/// As for [`draw`], and the first error of `output`.
pub fn draw_sequence<E: From<Error>>(
    provenance: &Provenance,
    source: &Source,
    threads: NonZero<usize>,
    progress: Progress,
    mut output: impl FnMut(u64, Vec<u8>) -> Result<(), E>,
) -> Result<ReadStatus, E> {
    let picture = &provenance.picture;
    let view = view(picture, source, progress)?;
    let schedule = schedule(picture, source, progress)?;
    let mut frames = frames(picture, source, &schedule)?;
    let (count, every) = (schedule.count(), schedule.grid.every);
    let metadata = |step| {
        let subject = Subject::Still { step, every };
        Provenance { picture: ResolvedPicture { subject, ..picture.clone() }, ..provenance.clone() }.metadata()
    };
    let mut done = 0;
    let result = write_png_sequence(
        frames.by_ref().map(|frame| frame.map_err(Failure::Drawing)),
        &view,
        metadata,
        threads,
        |step, file| {
            done += 1;
            progress(done, count);
            output(step, file).map_err(Failure::Output)
        },
    );
    match result {
        Ok(()) => Ok(frames.read_status()),
        Err(Failure::Drawing(error)) => Err(error.into()),
        Err(Failure::Output(error)) => Err(error),
    }
}

/// Separates errors of drawing from errors of the caller's `output`.
enum Failure<E> {
    Drawing(Error),
    Output(E),
}

impl<E> From<crate::render::RenderError> for Failure<E> {
    fn from(error: crate::render::RenderError) -> Failure<E> {
        Failure::Drawing(error.into())
    }
}

fn animation(
    picture: &ResolvedPicture,
    source: &Source,
    metadata: &Metadata,
    format: Format,
    threads: NonZero<usize>,
    progress: Progress,
    output: &mut dyn Write,
) -> Result<Vec<ReadStatus>, Error> {
    let view = view(picture, source, progress)?;
    let schedule = schedule(picture, source, progress)?;
    let mut frames = frames(picture, source, &schedule)?;
    let (mut done, count) = (0, schedule.count());
    let observed_frames = frames.by_ref().inspect(|_| {
        done += 1;
        progress(done, count);
    });
    match format {
        Format::Apng => write_apng(observed_frames, &view, &schedule, metadata, threads, output)?,
        Format::Gif | Format::Png | Format::Svg | Format::Pdf => {
            write_gif(observed_frames, &view, &schedule, metadata, threads, output)?;
        }
    }
    Ok(vec![frames.read_status()])
}

/// The view of the frames of a still picture or an animation.
///
/// # Errors
/// If the picture is too small for its content, or if the scale of impulse arrows requires a replay
/// and that fails.
pub fn view(picture: &ResolvedPicture, source: &Source, progress: Progress) -> Result<View, Error> {
    let style = style(picture, std::slice::from_ref(source), progress)?;
    Ok(View::new(source.world(), picture.size, &picture.camera_target, style)?)
}

/// The time at which each frame of a still picture or an animation is shown.
///
/// # Errors
/// If freeze frames at collisions require a replay and that fails.
pub fn schedule(picture: &ResolvedPicture, source: &Source, progress: Progress) -> Result<AnimationSchedule, Error> {
    let rate = source.header.config.rate;
    let (steps, every, timing) = match &picture.subject {
        Subject::Animation { steps, every, frames_per_step, slow, hold } => {
            (steps.clone(), *every, Timing { slow: *slow, frames_per_step: *frames_per_step, hold: *hold })
        }
        Subject::Still { step, every } => (*step..=*step, *every, Timing::REAL_TIME),
        Subject::Figure { steps, every, .. } => (steps.clone(), *every, Timing::REAL_TIME),
        Subject::Collision(_) | Subject::Minkowski(_) => (0..=0, 1, Timing::REAL_TIME),
    };
    let grid = StepGrid::new(steps, rate, Thinning::Every(every));
    let moments = if timing.hold > 0.0 { freeze_frames(source, &grid, progress)? } else { Vec::new() };
    Ok(AnimationSchedule::new(grid, timing, &moments))
}

/// The frames of `schedule`, with the data that the overlays of the picture need.
///
/// # Errors
/// If the recording cannot be read.
pub fn frames(picture: &ResolvedPicture, source: &Source, schedule: &AnimationSchedule) -> Result<Frames, Error> {
    Frames::new(source, schedule, &picture.show)
}

fn compose_picture(
    picture: &ResolvedPicture,
    sources: &[Source],
    progress: Progress,
) -> Result<(DisplayList, Vec<ReadStatus>), Error> {
    let style = style(picture, sources, progress)?;
    let options = FigureOptions { size: picture.size, camera_target: picture.camera_target.clone(), style };
    match &picture.subject {
        Subject::Still { .. } | Subject::Animation { .. } => still(picture, &sources[0], progress),
        Subject::Collision(selectors) => {
            let collisions = collisions(picture, selectors, sources, progress)?;
            Ok((figure::collision(&collisions, &options), Vec::new()))
        }
        Subject::Minkowski(selectors) => {
            let collisions = collisions(picture, selectors, sources, progress)?;
            Ok((figure::minkowski(&collisions, &options), Vec::new()))
        }
        Subject::Figure { figure, steps, every } => {
            let grid =
                |source: &Source| StepGrid::new(steps.clone(), source.header.config.rate, Thinning::Every(*every));
            if *figure == Figure::Energy {
                return energy(picture, sources, grid, &options);
            }
            let (runs, statuses) = runs(picture, sources, grid)?;
            let list = match figure {
                Figure::Strobe => figure::strobe(&runs, &options),
                Figure::Spacetime(axis) => figure::spacetime(&runs, *axis, &options),
                Figure::Filmstrip | Figure::Energy => figure::filmstrip(&runs, &options),
            };
            Ok((list, statuses))
        }
    }
}

fn still(
    picture: &ResolvedPicture,
    source: &Source,
    progress: Progress,
) -> Result<(DisplayList, Vec<ReadStatus>), Error> {
    let view = view(picture, source, progress)?;
    let mut frames = frames(picture, source, &schedule(picture, source, progress)?)?;
    let frame = frames.next().transpose()?;
    let frame = frame.ok_or_else(|| Error::NothingToShow { reason: "the step is not recorded".into() })?;
    // Damage directly after this state is found only by reading on.
    frames.next().transpose()?;
    Ok((compose(&frame, &view), vec![frames.read_status()]))
}

fn collisions(
    picture: &ResolvedPicture,
    selectors: &[CollisionSelector],
    sources: &[Source],
    progress: Progress,
) -> Result<Vec<CollisionSubject>, Error> {
    let titles = titles(picture, sources);
    let mut collisions = Vec::new();
    for ((source, selector), title) in sources.iter().zip(selectors).zip(titles) {
        let collision = find_collision(source, selector.step, Some(&selector.pair), progress)?;
        collisions.push(CollisionSubject { title, ..collision });
    }
    Ok(collisions)
}

fn runs(
    picture: &ResolvedPicture,
    sources: &[Source],
    grid: impl Fn(&Source) -> StepGrid,
) -> Result<(Vec<FigureRun>, Vec<ReadStatus>), Error> {
    let (mut runs, mut statuses) = (Vec::new(), Vec::new());
    for (source, title) in sources.iter().zip(titles(picture, sources)) {
        let mut frames = frames(picture, source, &AnimationSchedule::from(grid(source)))?;
        let drawn = frames.by_ref().collect::<Result<Vec<Frame>, Error>>()?;
        runs.push(FigureRun { title, world: source.world(), frames: drawn });
        statuses.push(frames.read_status());
    }
    Ok((runs, statuses))
}

fn energy(
    picture: &ResolvedPicture,
    sources: &[Source],
    grid: impl Fn(&Source) -> StepGrid,
    options: &FigureOptions,
) -> Result<(DisplayList, Vec<ReadStatus>), Error> {
    let (mut runs, mut statuses) = (Vec::new(), Vec::new());
    for (source, title) in sources.iter().zip(titles(picture, sources)) {
        let (samples, status) = energies(source, &grid(source))?;
        runs.push(EnergyRun { title, samples });
        statuses.push(status);
    }
    Ok((figure::energy(&runs, options), statuses))
}

/// The titles of recordings shown side by side: those of the picture, or the recordings' own.
fn titles(picture: &ResolvedPicture, sources: &[Source]) -> Vec<String> {
    if picture.titles.len() == sources.len() {
        return picture.titles.clone();
    }
    let title = |source: &Source| format!("{} ({})", source.title(), source.header.config.solver.name());
    sources.iter().map(title).collect()
}
