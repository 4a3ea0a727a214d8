use std::{
    fmt::{self, Display, Formatter},
    io::{Read, Seek, Write},
};

use crate::text::counted;

use super::{
    Error, Gap, Header, Health, Item, Keyframe, Missing, MissingEnd, RecordedEvent, RecordedState, Recording, RunEnd,
    Trailer, batch_writer::BatchWriter, mcap_writer::Profile, restorer::Restorer,
};

/// The result of [`recover`]. `Display` prints a few lines for people.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub struct Recovery {
    /// The end record of the recovered recording.
    pub trailer: Trailer,
    /// The number of recovered states.
    pub states: u64,
    /// The number of these that were altered and have been computed again.
    pub restored: u64,
    /// The gaps.
    pub gaps: Vec<Gap>,
    /// True if the boxes for viewers were left out, because those of some states are missing or damaged.
    pub lost_scene_updates: bool,
    /// The condition of the original recording.
    pub health: Health,
    /// The rate, Hz.
    pub rate: f64,
}

/// Writes the readable part of a damaged or unfinished recording to a new recording.
///
/// The new recording declares its gaps. The rest replays the same, unless values were altered that nothing in the file
/// contradicts. A state that contradicts its digest is computed again from the keyframe before it, and is taken over if
/// the result has its digest or its values. A recording without damage that this version of rebond wrote is reproduced
/// byte for byte. `recording` is read twice, from its start.
///
/// # Errors
/// Returns an error if reading or writing fails, or if no state can be recovered; nothing is written then.
#[doc(alias("repair", "salvage"))]
pub fn recover<R: Read + Seek, W: Write>(recording: &mut Recording<R>, output: W) -> Result<(Recovery, W), Error> {
    let scan = SalvageScan::new(recording)?;
    if scan.states == 0 {
        return Err(Error::NothingToRecover { damage: scan.health.damage().cloned() });
    }
    let steps = recording.header.steps.max(scan.last_step.unwrap_or(0));
    let header = Header { gaps: scan.gaps.clone(), steps, ..recording.header.clone() };
    let lost_scene_updates = scan.lost_scene_updates();
    let profile = if scan.scene_updates > 0 && !lost_scene_updates { Profile::SceneUpdates } else { Profile::Ros2 };
    let mut writer = BatchWriter::new(output, profile, &header)?;
    salvage(recording, |saved| match saved {
        Saved::Event(event) => writer.write_event(&event),
        Saved::Keyframe(keyframe) => writer.write_keyframe(&keyframe),
        Saved::State(state) => writer.write_state(&state),
        Saved::SceneUpdate { .. } if lost_scene_updates => Ok(()),
        Saved::SceneUpdate { time, message } => writer.write_scene_update(time, &message),
        Saved::Gap(_) | Saved::Trailer(_) => Ok(()),
    })?;
    let is_recovered = scan.health != Health::Whole || scan.was_recovered();
    let (trailer, output) = writer.finish(scan.run_end(), is_recovered)?;
    let SalvageScan { states, restored, gaps, health, .. } = scan;
    let rate = header.config.rate;
    Ok((Recovery { trailer, states, restored, gaps, lost_scene_updates, health, rate }, output))
}

/// A recoverable item.
enum Saved {
    Event(RecordedEvent),
    Keyframe(Keyframe),
    State(RecordedState),
    SceneUpdate {
        time: u64,
        message: Vec<u8>,
    },
    /// A gap before the next item.
    Gap(Gap),
    Trailer(Trailer),
}

/// Calls `visit` with all recoverable items, in order. Returns the number of altered states that were computed again.
///
/// Events and keyframes not followed by a state are dropped, so there is at most one gap between two
/// states. After a loss everything up to the next keyframe is dropped except for the events of its step: without the
/// bodies alive, states cannot be used.
fn salvage<R: Read + Seek>(
    recording: &mut Recording<R>,
    mut visit: impl FnMut(Saved) -> Result<(), Error>,
) -> Result<u64, Error> {
    recording.restart()?;
    let mut restorer = Restorer::new(&recording.header);
    let (mut is_lost, mut after, mut pending) = (false, None, Vec::<Saved>::new());
    while let Some(item) = recording.next().transpose()? {
        let (step, saved) = match restorer.follow(item) {
            Item::Event(event) => (event.step, Saved::Event(event)),
            Item::Keyframe(keyframe) => (keyframe.step, Saved::Keyframe(keyframe)),
            Item::State(state) => (state.step, Saved::State(state)),
            Item::SceneUpdate { time, message } => {
                pending.push(Saved::SceneUpdate { time, message });
                continue;
            }
            Item::Damaged(_) if recording.table().is_some() => continue,
            Item::Damaged(_) | Item::SuspectState(_) | Item::Gap(_) => {
                restorer.mark_lost();
                pending.clear();
                is_lost = true;
                continue;
            }
            Item::Trailer(trailer) => {
                visit(Saved::Trailer(trailer))?;
                continue;
            }
        };
        let (is_keyframe, is_state) = (matches!(saved, Saved::Keyframe(_)), matches!(saved, Saved::State(_)));
        if is_lost && is_keyframe {
            is_lost = false;
            pending.insert(0, Saved::Gap(Gap { after, before: step }));
        }
        pending.push(saved);
        if is_lost && is_state {
            pending.clear();
        } else if is_state {
            after = Some(step);
            pending.drain(..).try_for_each(&mut visit)?;
        }
    }
    if is_lost {
        pending.clear();
    }
    pending.into_iter().try_for_each(visit)?;
    Ok(restorer.restored)
}

/// The result of the first pass over the recording.
struct SalvageScan {
    states: u64,
    restored: u64,
    /// The number of states that list bodies.
    full_states: u64,
    scene_updates: u64,
    /// Every how many steps the states list bodies.
    every: u64,
    last_step: Option<u64>,
    gaps: Vec<Gap>,
    trailer: Option<Trailer>,
    health: Health,
}

impl SalvageScan {
    fn new<R: Read + Seek>(recording: &mut Recording<R>) -> Result<SalvageScan, Error> {
        let mut scan = SalvageScan {
            states: 0,
            restored: 0,
            full_states: 0,
            scene_updates: 0,
            every: recording.header.every,
            last_step: None,
            gaps: Vec::new(),
            trailer: None,
            health: Health::Whole,
        };
        scan.restored = salvage(recording, |saved| {
            scan.add(saved);
            Ok(())
        })?;
        scan.health = recording.health();
        Ok(scan)
    }

    fn add(&mut self, saved: Saved) {
        match saved {
            Saved::Event(_) | Saved::Keyframe(_) => {}
            Saved::SceneUpdate { .. } => self.scene_updates += 1,
            Saved::State(state) => {
                self.states += 1;
                self.full_states += u64::from(state.step.is_multiple_of(self.every));
                self.last_step = Some(state.step);
            }
            Saved::Gap(gap) => self.gaps.push(gap),
            Saved::Trailer(trailer) => self.trailer = Some(trailer),
        }
    }

    /// Returns the end of the original run, if its last step was recovered.
    fn run_end(&self) -> RunEnd {
        match &self.trailer {
            Some(trailer) if Some(trailer.steps) == self.last_step => {
                RunEnd { collisions: trailer.collisions, error: trailer.error.clone(), accuracy: trailer.accuracy }
            }
            Some(_) | None => RunEnd::default(),
        }
    }

    /// Returns true if only some states have boxes for viewers, because of damage.
    fn lost_scene_updates(&self) -> bool {
        self.health.damage().is_some() && self.scene_updates > 0 && self.scene_updates != self.full_states
    }

    fn was_recovered(&self) -> bool {
        self.trailer.as_ref().is_some_and(|trailer| trailer.recovered)
    }
}

impl Recovery {
    /// Returns true if the new recording has everything that was recorded.
    pub fn is_everything(&self) -> bool {
        let Recovery { gaps, health, lost_scene_updates, .. } = self;
        gaps.is_empty()
            && !lost_scene_updates
            && health.missing().is_none_or(|missing| {
                let Missing { end, scene, keyframes, images, .. } = missing;
                !end.is_some_and(MissingEnd::has_states) && !scene && !keyframes && images.is_empty()
            })
    }

    fn write_gap(&self, gap: &Gap, f: &mut Formatter<'_>) -> fmt::Result {
        let (first, states) = (gap.first_missing(), gap.missing_states());
        let time = seconds(states as f64 / self.rate);
        match states {
            0 => write!(f, "\nlost no state, but possibly events at step {}", gap.before),
            1 => write!(f, "\nlost step {first}: 1 state, {time}"),
            _ => write!(f, "\nlost steps {first} to {}: {states} states, {time}", gap.before - 1),
        }
    }
}

impl Display for Recovery {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "recovered {} up to step {}", counted(self.states, "state"), self.trailer.steps)?;
        self.gaps.iter().try_for_each(|gap| self.write_gap(gap, f))?;
        if self.restored > 0 {
            let states = counted(self.restored, "altered state");
            write!(f, "\ncomputed {states} again; the result has the recorded digest or the recorded values")?;
        }
        if self.lost_scene_updates {
            write!(f, "\nlost the topic /scene: viewers of MCAP files show no boxes")?;
        }
        match &self.health {
            Health::Whole => write!(f, "\nnothing was lost; the states were read, not replayed")?,
            Health::Incomplete(missing) | Health::Corrupt { missing, .. } => {
                match missing.end {
                    Some(end) if !end.has_states() => write!(f, "\nlost no state at the end of the file")?,
                    Some(end) if end.is_cut => {
                        write!(f, "\nlost all later steps: the end of the recording is missing")?;
                    }
                    Some(end) => self.write_gap(&Gap { after: end.after, before: end.last + 1 }, f)?,
                    None => {}
                }
                if missing.scene {
                    write!(f, "\nlost the text of the scene")?;
                }
                if missing.keyframes {
                    write!(f, "\nlost the topic /bodies: reading can begin only at the start")?;
                }
                missing.images.iter().try_for_each(|name| write!(f, "\nlost the image {name:?}"))?;
            }
        }
        match self.health.damage() {
            Some(damage) => write!(f, "\nfirst damage: {damage}"),
            None => Ok(()),
        }
    }
}

/// Formats a time span (s) with three significant digits, or as an integer from 100 s.
fn seconds(time: f64) -> String {
    let scientific = format!("{time:e}");
    let exponent = scientific.rsplit('e').next().and_then(|exponent| exponent.parse::<i32>().ok()).unwrap_or(0);
    let decimals = (2 - exponent).clamp(0, 9) as usize;
    let text = format!("{time:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_spans_have_three_significant_digits() {
        assert_eq!([1.0 / 60.0, 2.0, 12.34, 1234.5].map(seconds), ["0.0167 s", "2 s", "12.3 s", "1234 s"]);
    }
}
