use super::energies::energies;
use super::meeting::meeting;
use super::stops::stops;
use super::style::style;
use super::{Condition, Encounter, Error, Evidence, Figure, Format, Frames, Progress, Request, Source, Subject, Wish};
use crate::figure::{self, EnergyRun, FigureOptions, Meeting, Run};
use crate::render::{
    DisplayList, Frame, Metadata, Pace, Sampling, Thinning, Timeline, View, compose, write_apng, write_gif,
    write_png_sequence,
};
use std::io::Write;
use std::num::NonZero;

/// Writes the illustration that was asked for, with its evidence, and says how the recordings
/// were found to be.
///
/// Frames are drawn on `threads` threads; the bytes do not depend on how many.
///
/// # Errors
/// When a recording cannot be read, has not what is to be shown, the format cannot show it, or
/// `output` refuses.
pub fn draw(
    evidence: &Evidence,
    sources: &[Source],
    format: Format,
    threads: NonZero<usize>,
    progress: Progress,
    output: &mut dyn Write,
) -> Result<Vec<Condition>, Error> {
    let request = &evidence.request;
    let is_clip = matches!(request.subject, Subject::Clip { .. });
    if is_clip != format.is_animated() {
        let what = if is_clip { "an animation is GIF or animated PNG" } else { "one picture is PNG, SVG or PDF" };
        return Err(Error::Unfit { what: format!("{what}, not {}", format.name()) });
    }
    let metadata = evidence.metadata();
    if let Subject::Clip { .. } = request.subject {
        return clip(request, &sources[0], &metadata, format, threads, progress, output);
    }
    let (list, conditions) = picture(request, sources, progress)?;
    format.write(&list, &metadata, output)?;
    Ok(conditions)
}

/// The file of what somebody wishes for, with its evidence, drawn on this thread.
///
/// ```no_run
/// use rebond::illustration::{Format, Source, Wish, WishedSubject, drawn};
///
/// let source = Source::open("cradle.mcap".as_ref())?;
/// let png = drawn(&Wish::new(WishedSubject::Still { step: 60 }), &[source], Format::Png)?;
/// std::fs::write("cradle.png", png)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When there is nothing such to show in the recordings, or as for [`draw`].
pub fn drawn(wish: &Wish, sources: &[Source], format: Format) -> Result<Vec<u8>, Error> {
    let evidence = Evidence::new(&wish.request(sources, &mut |_, _| ())?, sources);
    let mut file = Vec::new();
    draw(&evidence, sources, format, NonZero::<usize>::MIN, &mut |_, _| (), &mut file)?;
    Ok(file)
}

/// Hands the step and the PNG file of each frame of a clip to `output`, in order. The evidence in
/// each is of that picture alone, so that it does not matter in how many parts they were drawn.
///
/// # Errors
/// As for [`draw`]; the first error of `output`.
pub fn draw_sequence<E: From<Error>>(
    evidence: &Evidence,
    source: &Source,
    threads: NonZero<usize>,
    progress: Progress,
    mut output: impl FnMut(u64, Vec<u8>) -> Result<(), E>,
) -> Result<Condition, E> {
    let request = &evidence.request;
    let view = view(request, source, progress)?;
    let timeline = timeline(request, source, progress)?;
    let mut frames = frames(request, source, &timeline)?;
    let (count, every) = (timeline.count(), timeline.sampling.every);
    let metadata = |step| {
        let subject = Subject::Still { step, every };
        Evidence { request: Request { subject, ..request.clone() }, ..evidence.clone() }.metadata()
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
        Ok(()) => Ok(frames.condition()),
        Err(Failure::Drawing(error)) => Err(error.into()),
        Err(Failure::Output(error)) => Err(error),
    }
}

/// Whose fault it was.
enum Failure<E> {
    Drawing(Error),
    Output(E),
}

impl<E> From<crate::render::RenderError> for Failure<E> {
    fn from(error: crate::render::RenderError) -> Failure<E> {
        Failure::Drawing(error.into())
    }
}

fn clip(
    request: &Request,
    source: &Source,
    metadata: &Metadata,
    format: Format,
    threads: NonZero<usize>,
    progress: Progress,
    output: &mut dyn Write,
) -> Result<Vec<Condition>, Error> {
    let view = view(request, source, progress)?;
    let timeline = timeline(request, source, progress)?;
    let mut frames = frames(request, source, &timeline)?;
    let (mut done, count) = (0, timeline.count());
    let counted = frames.by_ref().inspect(|_| {
        done += 1;
        progress(done, count);
    });
    match format {
        Format::Apng => write_apng(counted, &view, &timeline, metadata, threads, output)?,
        Format::Gif | Format::Png | Format::Svg | Format::Pdf => {
            write_gif(counted, &view, &timeline, metadata, threads, output)?;
        }
    }
    Ok(vec![frames.condition()])
}

/// How frames of a request are seen.
///
/// # Errors
/// When there is no such view, or the recording has to be replayed to find scales and cannot be.
pub fn view(request: &Request, source: &Source, progress: Progress) -> Result<View, Error> {
    let style = style(request, std::slice::from_ref(source), progress)?;
    Ok(View::new(source.world(), request.size, &request.aim, style)?)
}

/// When the frames of a still or a clip are on the screen.
///
/// # Errors
/// When the recording has to be replayed to find collisions and cannot be.
pub fn timeline(request: &Request, source: &Source, progress: Progress) -> Result<Timeline, Error> {
    let rate = source.header.settings.rate;
    let (steps, every, pace) = match &request.subject {
        Subject::Clip { steps, every, parts, slow, hold } => {
            (steps.clone(), *every, Pace { slow: *slow, parts: *parts, hold: *hold })
        }
        Subject::Still { step, every } => (*step..=*step, *every, Pace::TRUE),
        Subject::Figure { steps, every, .. } => (steps.clone(), *every, Pace::TRUE),
        Subject::Collision(_) | Subject::Minkowski(_) => (0..=0, 1, Pace::TRUE),
    };
    let sampling = Sampling::new(steps, rate, Thinning::Every(every));
    let moments = if pace.hold > 0.0 { stops(source, &sampling, progress)? } else { Vec::new() };
    Ok(Timeline::new(sampling, pace, &moments))
}

/// The frames on a timeline, with what the request shows.
///
/// # Errors
/// When the recording cannot be read.
pub fn frames(request: &Request, source: &Source, timeline: &Timeline) -> Result<Frames, Error> {
    Frames::new(source, timeline, &request.show)
}

fn picture(request: &Request, sources: &[Source], progress: Progress) -> Result<(DisplayList, Vec<Condition>), Error> {
    let style = style(request, sources, progress)?;
    let options = FigureOptions { size: request.size, aim: request.aim.clone(), style };
    match &request.subject {
        Subject::Still { .. } | Subject::Clip { .. } => still(request, &sources[0], progress),
        Subject::Collision(encounters) => {
            let meetings = meetings(request, encounters, sources, progress)?;
            Ok((figure::collision(&meetings, &options), Vec::new()))
        }
        Subject::Minkowski(encounters) => {
            let meetings = meetings(request, encounters, sources, progress)?;
            Ok((figure::minkowski(&meetings, &options), Vec::new()))
        }
        Subject::Figure { figure, steps, every } => {
            let sampling =
                |source: &Source| Sampling::new(steps.clone(), source.header.settings.rate, Thinning::Every(*every));
            if *figure == Figure::Energy {
                return energy(request, sources, sampling, &options);
            }
            let (runs, conditions) = runs(request, sources, sampling)?;
            let list = match figure {
                Figure::Strobe => figure::strobe(&runs, &options),
                Figure::Spacetime(axis) => figure::spacetime(&runs, *axis, &options),
                Figure::Filmstrip | Figure::Energy => figure::filmstrip(&runs, &options),
            };
            Ok((list, conditions))
        }
    }
}

fn still(request: &Request, source: &Source, progress: Progress) -> Result<(DisplayList, Vec<Condition>), Error> {
    let view = view(request, source, progress)?;
    let mut frames = frames(request, source, &timeline(request, source, progress)?)?;
    let frame = frames.next().transpose()?;
    let frame = frame.ok_or_else(|| Error::Nothing { what: "the step is not recorded".into() })?;
    // The recording is known to be sound up to here only once more was asked for.
    frames.next().transpose()?;
    Ok((compose(&frame, &view), vec![frames.condition()]))
}

fn meetings(
    request: &Request,
    encounters: &[Encounter],
    sources: &[Source],
    progress: Progress,
) -> Result<Vec<Meeting>, Error> {
    let titles = titles(request, sources);
    let mut meetings = Vec::new();
    for ((source, encounter), title) in sources.iter().zip(encounters).zip(titles) {
        let found = meeting(source, encounter.step, Some(&encounter.pair), progress)?;
        meetings.push(Meeting { title, ..found });
    }
    Ok(meetings)
}

fn runs(
    request: &Request,
    sources: &[Source],
    sampling: impl Fn(&Source) -> Sampling,
) -> Result<(Vec<Run>, Vec<Condition>), Error> {
    let (mut runs, mut conditions) = (Vec::new(), Vec::new());
    for (source, title) in sources.iter().zip(titles(request, sources)) {
        let mut frames = frames(request, source, &Timeline::from(sampling(source)))?;
        let shown = frames.by_ref().collect::<Result<Vec<Frame>, Error>>()?;
        runs.push(Run { title, world: source.world(), frames: shown });
        conditions.push(frames.condition());
    }
    Ok((runs, conditions))
}

fn energy(
    request: &Request,
    sources: &[Source],
    sampling: impl Fn(&Source) -> Sampling,
    options: &FigureOptions,
) -> Result<(DisplayList, Vec<Condition>), Error> {
    let (mut runs, mut conditions) = (Vec::new(), Vec::new());
    for (source, title) in sources.iter().zip(titles(request, sources)) {
        let (samples, condition) = energies(source, &sampling(source))?;
        runs.push(EnergyRun { title, samples });
        conditions.push(condition);
    }
    Ok((figure::energy(&runs, options), conditions))
}

/// What is written above each of several recordings: what was asked for, or their own titles.
fn titles(request: &Request, sources: &[Source]) -> Vec<String> {
    if request.titles.len() == sources.len() {
        return request.titles.clone();
    }
    let title = |source: &Source| format!("{} ({})", source.title(), source.header.settings.solver.name());
    sources.iter().map(title).collect()
}
