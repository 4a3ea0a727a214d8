use std::{
    fmt::{self, Display, Formatter},
    io::{Read, Seek, Write},
};

use super::{
    End, Error, Gap, Header, Health, Item, Keyframe, Outcome, RecordedEvent, RecordedState, Recording,
    recorder::Recorder,
};

/// What [`recover`] has saved and what not. It prints as a few lines for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovery {
    /// How the recovered recording ends.
    pub end: End,
    /// States saved.
    pub states: u64,
    /// Where something is missing.
    pub gaps: Vec<Gap>,
    /// In which state the recording was found.
    pub health: Health,
    /// Steps per second, Hz.
    pub rate: f64,
}

/// Writes all that can be read of a damaged or unfinished recording into a new one.
///
/// It invents nothing: where something is missing the new recording says so, and it
/// replays the same for what is there. A recording that was whole comes out byte for byte.
/// `recording` is read twice, from its start.
///
/// # Errors
/// If the system cannot read or write.
pub fn recover<R: Read + Seek, W: Write>(recording: &mut Recording<R>, write: W) -> Result<(Recovery, W), Error> {
    let survey = Survey::of(recording)?;
    let header = Header { gaps: survey.gaps.clone(), ..recording.header.clone() };
    let mut recorder = Recorder::new(write, &header)?;
    salvage(recording, |saved| match saved {
        Saved::Event(event) => recorder.event(&event),
        Saved::Keyframe(keyframe) => recorder.keyframe(&keyframe),
        Saved::State(state) => recorder.state(&state),
        Saved::View { time, message } => recorder.view(time, &message),
        Saved::Gap(_) | Saved::End(_) => Ok(()),
    })?;
    let recovered = survey.health != Health::Whole || survey.was_recovered();
    let (end, write) = recorder.finish(survey.outcome(), recovered)?;
    let Survey { states, gaps, health, .. } = survey;
    Ok((Recovery { end, states, gaps, health, rate: header.settings.rate }, write))
}

/// What is worth saving of a recording, in order.
enum Saved {
    Event(RecordedEvent),
    Keyframe(Keyframe),
    State(RecordedState),
    View {
        time: u64,
        message: Vec<u8>,
    },
    /// Something is missing before what comes next.
    Gap(Gap),
    End(End),
}

/// Hands out what is worth saving.
///
/// Events and keyframes that lead to no state because something is missing behind them are
/// not: so there is one gap between two states at most, and no doubt where it lies.
fn salvage<R: Read + Seek>(
    recording: &mut Recording<R>,
    mut take: impl FnMut(Saved) -> Result<(), Error>,
) -> Result<(), Error> {
    recording.restart()?;
    let (mut lost, mut after, mut since) = (false, None, Vec::new());
    while let Some(item) = recording.next() {
        let (step, saved) = match item? {
            Item::Event(event) => (event.step, Saved::Event(event)),
            Item::Keyframe(keyframe) => (keyframe.step, Saved::Keyframe(keyframe)),
            Item::State(state) => (state.step, Saved::State(state)),
            Item::View { time, message } => {
                since.push(Saved::View { time, message });
                continue;
            }
            Item::Damaged(_) if recording.table().is_some() => continue,
            Item::Damaged(_) | Item::Doubtful(_) | Item::Gap(_) => {
                since.clear();
                lost = true;
                continue;
            }
            Item::End(end) => {
                take(Saved::End(end))?;
                continue;
            }
        };
        if std::mem::take(&mut lost) {
            since.push(Saved::Gap(Gap { after, before: step }));
        }
        let is_state = matches!(saved, Saved::State(_));
        since.push(saved);
        if is_state {
            after = Some(step);
            since.drain(..).try_for_each(&mut take)?;
        }
    }
    since.into_iter().try_for_each(take)
}

/// What a first look through the recording shows.
struct Survey {
    states: u64,
    last_step: Option<u64>,
    gaps: Vec<Gap>,
    end: Option<End>,
    health: Health,
}

impl Survey {
    fn of<R: Read + Seek>(recording: &mut Recording<R>) -> Result<Survey, Error> {
        let mut survey = Survey { states: 0, last_step: None, gaps: Vec::new(), end: None, health: Health::Whole };
        salvage(recording, |saved| {
            survey.count(saved);
            Ok(())
        })?;
        survey.health = recording.health();
        Ok(survey)
    }

    fn count(&mut self, saved: Saved) {
        match saved {
            Saved::Event(_) | Saved::Keyframe(_) | Saved::View { .. } => {}
            Saved::State(state) => {
                self.states += 1;
                self.last_step = Some(state.step);
            }
            Saved::Gap(gap) => self.gaps.push(gap),
            Saved::End(end) => self.end = Some(end),
        }
    }

    /// What the run's own end said, if that is where the recording still ends.
    fn outcome(&self) -> Outcome {
        match &self.end {
            Some(end) if Some(end.steps) == self.last_step => {
                Outcome { collisions: end.collisions, error: end.error.clone() }
            }
            Some(_) | None => Outcome::default(),
        }
    }

    fn was_recovered(&self) -> bool {
        self.end.as_ref().is_some_and(|end| end.recovered)
    }
}

impl Display for Recovery {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "recovered {} states up to step {}", self.states, self.end.steps)?;
        for gap in &self.gaps {
            let from = gap.first_missing();
            match gap.missing_states() {
                0 => write!(f, "\nlost events at step {} at most", gap.before)?,
                states => {
                    let seconds = states as f64 / self.rate;
                    write!(f, "\nlost steps {from} to {}: {states} states, {seconds} s", gap.before - 1)?;
                }
            }
        }
        match &self.health {
            Health::Whole if self.gaps.is_empty() => write!(f, "\nnothing was lost"),
            Health::Whole => Ok(()),
            Health::Truncated { .. } => write!(f, "\nlost what came after: the end is missing"),
            Health::Corrupt(damage) => write!(f, "\nfirst damage: {damage}"),
        }
    }
}
