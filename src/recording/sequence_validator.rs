use std::collections::VecDeque;

use crate::text::counted;

use super::{
    BodyTable, Change, Gap, Header, Keyframe, RecordedEvent, RecordedState, StateDigest, Trailer,
    digest::IdentityChain, limits,
};

/// Checks that the items of a recording form a consistent sequence.
///
/// After damage any later step may follow, and the living bodies are unknown until the next keyframe.
/// Unknown facts are not checked.
pub struct SequenceValidator {
    every: u64,
    last_step: Option<u64>,
    expected: ExpectedStep,
    /// The living bodies, if known.
    table: Option<BodyTable>,
    /// The identity so far, if nothing was lost.
    identity: Option<IdentityChain>,
    next_id: u32,
    events: u64,
    digest: StateDigest,
    /// The declared gaps of a recovered recording that are still ahead.
    gaps: VecDeque<Gap>,
}

/// The step of the next message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ExpectedStep {
    /// Exactly this step.
    Exactly(u64),
    /// This step or a later one, because data was lost.
    AtLeast(u64),
}

impl SequenceValidator {
    /// Creates a validator at the start of a recording. Without the scene the identity is not checked.
    pub fn new(header: &Header) -> SequenceValidator {
        SequenceValidator {
            every: header.every,
            last_step: None,
            expected: ExpectedStep::Exactly(0),
            table: Some(BodyTable::default()),
            identity: header.scene.is_some().then(|| IdentityChain::new(header)),
            next_id: 0,
            events: 0,
            digest: StateDigest::default(),
            gaps: header.gaps.iter().copied().collect(),
        }
    }

    /// The step of the last state.
    pub fn last_step(&self) -> Option<u64> {
        self.last_step
    }

    /// The living bodies, if known.
    pub fn table(&self) -> Option<&BodyTable> {
        self.table.as_ref()
    }

    /// Resets the step and the living bodies to unknown, before reading at another place.
    pub fn reset(&mut self) {
        self.mark_lost();
        self.last_step = None;
        self.expected = ExpectedStep::AtLeast(0);
    }

    /// Accepts that data was lost here.
    pub fn mark_lost(&mut self) {
        self.expected = match self.expected {
            ExpectedStep::Exactly(step) | ExpectedStep::AtLeast(step) => ExpectedStep::AtLeast(step),
        };
        self.table = None;
        self.identity = None;
    }

    /// Crosses and returns the next declared gap if an item of step `step` is the first one after it.
    pub fn cross_gap(&mut self, step: u64) -> Option<Gap> {
        let gap = *self.gaps.front()?;
        if gap.after != self.last_step || gap.before != step {
            return None;
        }
        self.gaps.pop_front();
        self.expected = ExpectedStep::AtLeast(step);
        self.table = None;
        Some(gap)
    }

    /// Adds an event, encoded as `message`.
    ///
    /// # Errors
    /// Returns a description of the contradiction if the event is not possible here.
    pub fn add_event(&mut self, event: &RecordedEvent, message: &[u8]) -> Result<(), String> {
        self.check_step(event.step, "an event")?;
        if let Some(table) = &mut self.table {
            check_change(table, self.next_id, &event.change)?;
            table.apply(&event.change);
        }
        if let Change::Spawn { id, .. } = event.change {
            self.next_id = id.saturating_add(1);
        }
        self.events += 1;
        if let Some(identity) = &mut self.identity {
            identity.event(message);
        }
        Ok(())
    }

    /// Adds a keyframe, after which the living bodies are known.
    ///
    /// # Errors
    /// Returns a description of the contradiction if the keyframe does not match the events.
    pub fn add_keyframe(&mut self, keyframe: &Keyframe) -> Result<(), String> {
        self.check_step(keyframe.step, "a keyframe")?;
        let table = keyframe.table();
        match &self.table {
            Some(known) if *known != table || self.next_id != keyframe.next_id => {
                Err(format!("the bodies in the keyframe of step {} do not match the events", keyframe.step))
            }
            Some(_) | None => {
                self.table = Some(table);
                self.next_id = keyframe.next_id;
                Ok(())
            }
        }
    }

    /// Adds a state, and returns a description if its values are suspect.
    ///
    /// # Errors
    /// Returns a description of the contradiction if the state is malformed or not possible here.
    pub fn add_state(&mut self, state: &RecordedState) -> Result<Option<String>, String> {
        self.check_step(state.step, "a state")?;
        self.check_shape(state)?;
        let suspicion = self.check_values(state);
        self.last_step = Some(state.step);
        self.expected = ExpectedStep::Exactly(state.step + 1);
        if let Some(identity) = &mut self.identity {
            identity.state(state.step, state.digest);
        }
        Ok(suspicion)
    }

    /// Checks the end record against the items before it.
    ///
    /// # Errors
    /// Returns a description of the contradiction if they do not match.
    pub fn check_trailer(&self, trailer: &Trailer) -> Result<(), String> {
        let Some(identity) = &self.identity else { return Ok(()) };
        let found = (self.last_step.unwrap_or(0), self.events);
        if (trailer.steps, trailer.events) != found {
            return Err(format!(
                "the end record declares {} and {}, but the recording has {} and {}",
                counted(trailer.steps, "step"),
                counted(trailer.events, "event"),
                counted(found.0, "step"),
                counted(found.1, "event"),
            ));
        }
        match identity.identity() == trailer.identity {
            true => Ok(()),
            false => Err("the recording does not match its identity".into()),
        }
    }

    /// Returns true if the state of a step is recorded in full.
    pub fn is_full(&self, step: u64) -> bool {
        step.is_multiple_of(self.every)
    }

    /// Returns a description of the problem if the values of a state cannot be those that were recorded.
    fn check_values(&mut self, state: &RecordedState) -> Option<String> {
        let step = state.step;
        if [&state.x, &state.y, &state.vx, &state.vy].into_iter().flatten().any(|number| !number.is_finite()) {
            return Some(format!("state {step} contains a value that is not finite"));
        }
        if !self.is_full(step) {
            return None;
        }
        self.digest.clear();
        for (info, recorded) in self.table.as_ref()?.join_state(state) {
            self.digest.add(info.id, recorded.unwrap_or_else(|| info.initial_state()));
        }
        (self.digest.value() != state.digest).then(|| format!("state {step} does not match its digest"))
    }

    /// Checks the step of a message. All messages of a step come before those of the next step.
    fn check_step(&mut self, step: u64, kind: &str) -> Result<(), String> {
        if step > limits::STEPS {
            return Err(format!("{kind} has step {step}, but steps go up to {}", limits::STEPS));
        }
        let is_possible = match self.expected {
            ExpectedStep::Exactly(expected) => step == expected,
            ExpectedStep::AtLeast(expected) => step >= expected,
        };
        match (is_possible, self.expected) {
            (true, _) => {
                self.expected = ExpectedStep::Exactly(step);
                Ok(())
            }
            (false, ExpectedStep::Exactly(expected)) => {
                Err(format!("{kind} has step {step}, but step {expected} is expected"))
            }
            (false, ExpectedStep::AtLeast(expected)) => {
                Err(format!("{kind} has step {step}, but step {expected} or later is expected"))
            }
        }
    }

    fn check_shape(&self, state: &RecordedState) -> Result<(), String> {
        let RecordedState { step, id, x, y, vx, vy, .. } = state;
        if [x, y, vx, vy].into_iter().any(|column| column.len() != id.len()) {
            return Err(format!("state {step} has columns of different lengths"));
        }
        if id.len() > limits::BODIES {
            return Err(format!("state {step} has {} bodies, but at most {} are allowed", id.len(), limits::BODIES));
        }
        if id.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(format!("the ids in state {step} are not in ascending order"));
        }
        let Some(table) = &self.table else { return Ok(()) };
        let mut listed = 0;
        let mut omitted = table.join_state(state).filter(|(_, recorded)| {
            listed += usize::from(recorded.is_some());
            recorded.is_none()
        });
        let matches = match self.is_full(*step) {
            true => omitted.all(|(info, _)| info.spawn.mass.is_infinite()) && listed == id.len(),
            false => id.is_empty(),
        };
        match matches {
            true => Ok(()),
            false => Err(format!("the bodies in state {step} do not match the events")),
        }
    }
}

fn check_change(table: &BodyTable, next_id: u32, change: &Change) -> Result<(), String> {
    match change {
        Change::Spawn { id, .. } if *id != next_id || *id == u32::MAX => {
            Err(format!("a body is spawned with id {id}, but id {next_id} is expected"))
        }
        Change::Spawn { .. } if table.bodies().len() >= limits::BODIES => Err("too many bodies are alive".into()),
        Change::Delete { id } if table.body(*id).is_none() => Err(format!("body {id} is deleted, but is not alive")),
        Change::Spawn { .. } | Change::Delete { .. } => Ok(()),
    }
}
