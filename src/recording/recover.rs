use std::{
    fmt::{self, Display, Formatter},
    io::{Read, Seek, Write},
};

use super::{End, Error, Gap, Header, Health, Item, Outcome, Recording, recorder::Recorder};

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
    recording.restart()?;
    for item in recording.by_ref() {
        match item? {
            Item::Event(event) => recorder.event(&event)?,
            Item::Keyframe(keyframe) => recorder.keyframe(&keyframe)?,
            Item::State(state) => recorder.state(&state)?,
            Item::Doubtful(_) | Item::Gap(_) | Item::Damaged(_) | Item::End(_) => {}
        }
    }
    let recovered = survey.health != Health::Whole || survey.was_recovered();
    let (end, write) = recorder.finish(survey.outcome(), recovered)?;
    let Survey { states, gaps, health, .. } = survey;
    Ok((Recovery { end, states, gaps, health, rate: header.settings.rate }, write))
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
        recording.restart()?;
        let mut survey = Survey { states: 0, last_step: None, gaps: Vec::new(), end: None, health: Health::Whole };
        let mut lost = false;
        while let Some(item) = recording.next() {
            let (step, is_state) = match item? {
                Item::Event(event) => (event.step, false),
                Item::Keyframe(keyframe) => (keyframe.step, false),
                Item::State(state) => (state.step, true),
                Item::Damaged(_) => {
                    lost |= recording.table().is_none();
                    continue;
                }
                Item::Doubtful(_) | Item::Gap(_) => {
                    lost = true;
                    continue;
                }
                Item::End(end) => {
                    survey.end = Some(end);
                    continue;
                }
            };
            if std::mem::take(&mut lost) {
                survey.gaps.push(Gap { after: survey.last_step, before: step });
            }
            if is_state {
                survey.states += 1;
                survey.last_step = Some(step);
            }
        }
        survey.health = recording.health();
        Ok(survey)
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
            let from = gap.after.map_or(0, |after| after + 1);
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
