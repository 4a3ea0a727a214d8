use super::error::CommandError;
use super::kind::Kind;
use super::output::{self, Folder};
use super::picture_arguments::RenderOptions;
use super::shard::Shard;
use super::source::Source;
use super::{Exit, damage, jobs, progress, video, wish};
use crate::illustration::{self, Evidence, Format, Progress, Subject, Wish, WishedSubject};
use std::num::NonZero;

/// Draws a scene or a recording.
pub fn run(options: &RenderOptions) -> Result<Exit, CommandError> {
    let kind = Kind::of(options)?;
    kind.refuse_existing(&options.output.output, options.output.force)?;
    kind.refuse_shard(&options.output.output, options.shard)?;
    if let Kind::Video(_) = kind {
        video::refuse_without_ffmpeg(&options.output.output)?;
    }
    let source = Source::open(&options.source)?;
    let bar = progress::bar("drawing", 0);
    let mut heard = progress::listener(&bar);
    let recordings = [source.recording.clone()];
    let Some(wish) = part(wish(options, kind), options.shard, recordings[0].survey.last_step) else {
        Folder::create(&options.output.output, options.output.force)?.finish()?;
        return Ok(Exit::Done);
    };
    let evidence = Evidence::new(&wish.request(&recordings, &mut heard)?, &recordings);
    let job = Job { options, evidence, source: &recordings[0] };
    let exit = match kind {
        Kind::Animation(format) | Kind::Picture(format) => job.file(format, &mut heard)?,
        Kind::Video(container) => job.video(container, &mut heard)?,
        Kind::Sequence => job.sequence(&mut heard)?,
    };
    bar.finish_and_clear();
    job.tell(&mut heard)?;
    Ok(exit)
}

/// What is asked for and its format, where that is one file that is drawn here.
pub fn picture_wish(options: &RenderOptions) -> Result<Option<(Wish, Format)>, CommandError> {
    let kind = Kind::of(options)?;
    Ok(match kind {
        Kind::Animation(format) | Kind::Picture(format) => Some((wish(options, kind), format)),
        Kind::Video(_) | Kind::Sequence => None,
    })
}

fn wish(options: &RenderOptions, kind: Kind) -> Wish {
    let subject = match (options.at, kind) {
        (Some(step), _) => WishedSubject::Still { step },
        (None, Kind::Animation(format) | Kind::Picture(format)) => {
            WishedSubject::Animation { fastest: Wish::fastest(format) }
        }
        (None, Kind::Video(_)) => WishedSubject::Animation { fastest: f64::INFINITY },
        (None, Kind::Sequence) => WishedSubject::Sequence,
    };
    Wish {
        from: options.from,
        to: options.to,
        every: options.every,
        fps: options.fps,
        slow: options.slow,
        hold: options.hold_seconds(),
        ..wish::of(&options.look, subject)
    }
}

/// Of what is asked for the part that is a shard's; none if there are too few steps for it.
fn part(wish: Wish, shard: Shard, last_step: Option<u64>) -> Option<Wish> {
    if shard == Shard::WHOLE {
        return Some(wish);
    }
    let end = last_step.unwrap_or(0);
    let own = shard.steps(wish.from.unwrap_or(0), wish.to.unwrap_or(end).min(end))?;
    Some(Wish { from: Some(*own.start()), to: Some(*own.end()), ..wish })
}

/// One thing to be drawn.
struct Job<'a> {
    options: &'a RenderOptions,
    evidence: Evidence,
    source: &'a illustration::Source,
}

impl Job<'_> {
    fn threads(&self) -> NonZero<usize> {
        jobs::threads(self.options.jobs)
    }

    fn file(&self, format: Format, heard: Progress) -> Result<Exit, CommandError> {
        let sources = std::slice::from_ref(self.source);
        let mut conditions = Vec::new();
        output::write_file(&self.options.output.output, self.options.output.force, |output| {
            conditions = illustration::draw(&self.evidence, sources, format, self.threads(), heard, output)?;
            Ok(())
        })?;
        Ok(damage::tell_all(&conditions))
    }

    fn video(&self, container: super::kind::Container, heard: Progress) -> Result<Exit, CommandError> {
        let output = &self.options.output;
        video::write(&self.evidence, self.source, container, self.threads(), heard, output)
    }

    fn sequence(&self, heard: Progress) -> Result<Exit, CommandError> {
        let mut folder = Folder::create(&self.options.output.output, self.options.output.force)?;
        let write = |step, file: Vec<u8>| folder.write(format!("{step:06}.png"), &file);
        let condition = illustration::draw_sequence(&self.evidence, self.source, self.threads(), heard, write)?;
        folder.finish()?;
        Ok(damage::tell(&condition))
    }

    /// Says what was drawn: a clip cannot show every step of every run.
    fn tell(&self, heard: Progress) -> Result<(), CommandError> {
        let path = &self.options.output.output;
        let request = &self.evidence.request;
        let line = match &request.subject {
            Subject::Still { step, .. } => format!("{}: step {step}", path.display()),
            Subject::Clip { .. } | Subject::Figure { .. } | Subject::Collision(_) | Subject::Minkowski(_) => {
                format!("{}: {}", path.display(), illustration::timeline(request, self.source, heard)?)
            }
        };
        output::tell(path, &line)
    }
}
