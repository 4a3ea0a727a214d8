use std::collections::VecDeque;

use super::{
    BodyTable, Change, End, Gap, Header, Keyframe, RecordedEvent, RecordedState, StateDigest, identity::IdentityChain,
    limits,
};

/// Follows a recording and says where it contradicts itself.
///
/// After damage it knows less: any later step may come next, and until a keyframe the
/// bodies alive are unknown. It never takes for granted what it cannot know.
pub struct Course {
    every: u64,
    last_step: Option<u64>,
    due: Due,
    /// The bodies alive, as long as they are known.
    table: Option<BodyTable>,
    /// The identity so far, as long as nothing was lost.
    identity: Option<IdentityChain>,
    next_id: u32,
    events: u64,
    digest: StateDigest,
    /// What a recovered recording says is missing, still to come.
    gaps: VecDeque<Gap>,
}

/// Which step the next message has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Due {
    /// This one.
    Exactly(u64),
    /// Something was lost: this one or a later one.
    AtLeast(u64),
}

impl Course {
    /// At the start of the recording with that header, whose scene may be lost.
    pub fn new(header: &Header, has_scene: bool) -> Course {
        Course {
            every: header.every,
            last_step: None,
            due: Due::Exactly(0),
            table: Some(BodyTable::default()),
            identity: has_scene.then(|| IdentityChain::new(header)),
            next_id: 0,
            events: 0,
            digest: StateDigest::default(),
            gaps: header.gaps.iter().copied().collect(),
        }
    }

    /// The last state's step.
    pub fn last_step(&self) -> Option<u64> {
        self.last_step
    }

    /// The bodies alive, if they are known.
    pub fn table(&self) -> Option<&BodyTable> {
        self.table.as_ref()
    }

    /// Something is left out here, and what follows stands for itself.
    pub fn jump(&mut self) {
        self.lose();
        self.last_step = None;
        self.due = Due::AtLeast(0);
    }

    /// Something was lost here.
    pub fn lose(&mut self) {
        self.due = match self.due {
            Due::Exactly(step) | Due::AtLeast(step) => Due::AtLeast(step),
        };
        self.table = None;
        self.identity = None;
    }

    /// The gap that something of step `step` stands behind, if it is the first to.
    pub fn cross_gap(&mut self, step: u64) -> Option<Gap> {
        let gap = *self.gaps.front()?;
        if gap.after != self.last_step || gap.before != step {
            return None;
        }
        self.gaps.pop_front();
        self.due = Due::AtLeast(step);
        self.table = None;
        Some(gap)
    }

    /// Follows an event, encoded as `message`.
    ///
    /// # Errors
    /// In words, if it cannot come here.
    pub fn event(&mut self, event: &RecordedEvent, message: &[u8]) -> Result<(), String> {
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

    /// Follows a keyframe, from which on everything is known again.
    ///
    /// # Errors
    /// In words, if it is not what the events have led to.
    pub fn keyframe(&mut self, keyframe: &Keyframe) -> Result<(), String> {
        self.check_step(keyframe.step, "a keyframe")?;
        let table = keyframe.table();
        match &self.table {
            Some(known) if *known != table || self.next_id != keyframe.next_id => {
                Err(format!("the keyframe of step {} has other bodies than the events made", keyframe.step))
            }
            Some(_) | None => {
                self.table = Some(table);
                self.next_id = keyframe.next_id;
                Ok(())
            }
        }
    }

    /// Follows a state and says what there is to doubt about its numbers.
    ///
    /// # Errors
    /// In words, if it is not a state or cannot come here.
    pub fn state(&mut self, state: &RecordedState) -> Result<Option<String>, String> {
        self.check_step(state.step, "a state")?;
        self.check_shape(state)?;
        let doubt = self.doubt(state);
        self.last_step = Some(state.step);
        self.due = Due::Exactly(state.step + 1);
        if let Some(identity) = &mut self.identity {
            identity.state(state.step, state.digest);
        }
        Ok(doubt)
    }

    /// Whether the end fits what came before it.
    ///
    /// # Errors
    /// In words, if it does not.
    pub fn end(&self, end: &End) -> Result<(), String> {
        let Some(identity) = &self.identity else { return Ok(()) };
        if (end.steps, end.events) != (self.last_step.unwrap_or(0), self.events) {
            return Err(format!("the end tells of {} steps and {} events, which are not there", end.steps, end.events));
        }
        match identity.identity() == end.identity {
            true => Ok(()),
            false => Err("the recording does not fit its identity".into()),
        }
    }

    /// Whether the state of a step is recorded in full.
    pub fn is_full(&self, step: u64) -> bool {
        step.is_multiple_of(self.every)
    }

    /// Why the numbers of a state cannot be what was recorded.
    fn doubt(&mut self, state: &RecordedState) -> Option<String> {
        let step = state.step;
        if [&state.x, &state.y, &state.vx, &state.vy].into_iter().flatten().any(|number| !number.is_finite()) {
            return Some(format!("state {step} has a number that is not finite"));
        }
        if !self.is_full(step) {
            return None;
        }
        self.digest.clear();
        for (known, moved) in self.table.as_ref()?.with_state(state) {
            self.digest.body(known.id, moved.unwrap_or_else(|| known.first_numbers()));
        }
        (self.digest.value() != state.digest).then(|| format!("state {step} does not fit its digest"))
    }

    /// Whether a message of that step may come; all of a step come before those of the next.
    fn check_step(&mut self, step: u64, what: &str) -> Result<(), String> {
        if step > limits::STEPS {
            return Err(format!("{what} of step {step}, beyond any run"));
        }
        let comes = match self.due {
            Due::Exactly(due) => step == due,
            Due::AtLeast(due) => step >= due,
        };
        match (comes, self.due) {
            (true, _) => {
                self.due = Due::Exactly(step);
                Ok(())
            }
            (false, Due::Exactly(due) | Due::AtLeast(due)) => {
                Err(format!("{what} of step {step} stands where step {due} is due"))
            }
        }
    }

    fn check_shape(&self, state: &RecordedState) -> Result<(), String> {
        let RecordedState { step, id, x, y, vx, vy, .. } = state;
        if [x, y, vx, vy].into_iter().any(|column| column.len() != id.len()) {
            return Err(format!("state {step} has columns of different lengths"));
        }
        if id.len() > limits::BODIES || id.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(format!("state {step} has ids out of order"));
        }
        let Some(table) = &self.table else { return Ok(()) };
        let mut listed = 0;
        let mut left_out = table.with_state(state).filter(|(_, moved)| {
            listed += usize::from(moved.is_some());
            moved.is_none()
        });
        let sound = match self.is_full(*step) {
            true => left_out.all(|(known, _)| known.spawn.mass.is_infinite()) && listed == id.len(),
            false => id.is_empty(),
        };
        match sound {
            true => Ok(()),
            false => Err(format!("state {step} has other bodies than the events made")),
        }
    }
}

fn check_change(table: &BodyTable, next_id: u32, change: &Change) -> Result<(), String> {
    match change {
        Change::Spawn { id, .. } if *id != next_id || *id == u32::MAX => {
            Err(format!("body {id} spawns when {next_id} is due"))
        }
        Change::Spawn { .. } if table.bodies().len() >= limits::BODIES => Err("too many bodies are alive".into()),
        Change::Delete { id } if table.body(*id).is_none() => Err(format!("body {id} is deleted and does not live")),
        Change::Spawn { .. } | Change::Delete { .. } => Ok(()),
    }
}
