use std::collections::VecDeque;

use crate::text::counted;

use super::{
    BodyTable, Change, Gap, Header, Keyframe, RecordedEvent, RecordedState, StateBounds, StateDigest, Trailer,
    digest::IdentityChain, limits,
};

/// Checks that the items of a recording form a consistent sequence, and notes the missing ones.
///
/// After damage any later step may follow, and the living bodies are unknown until the next keyframe.
/// Unknown facts are not checked.
pub struct SequenceValidator {
    /// The last planned step.
    planned: u64,
    every: u64,
    has_scene: bool,
    estimates_accuracy: bool,
    last_step: Option<u64>,
    expected: ExpectedStep,
    /// The living bodies, if known.
    table: Option<BodyTable>,
    /// The identity so far.
    identity: IdentityChain,
    /// The bounds so far, if the end record declares them.
    state_bounds: Option<StateBounds>,
    next_id: u32,
    events: u64,
    digest: StateDigest,
    position: Position,
    /// The declared gaps of a recovered recording.
    declared_gaps: Vec<Gap>,
    /// The declared gaps that are still ahead.
    gaps: VecDeque<Gap>,
    /// The gaps found so far, declared or not, up to the keyframes after them.
    found_gaps: Vec<Gap>,
    /// After a loss, until a keyframe makes the living bodies known again: the step of the last state before it, if
    /// any. The states up to the keyframe cannot be used.
    open_gap: Option<Option<u64>>,
    /// True if full states have scene updates; `None` before the first full state.
    has_scene_updates: Option<bool>,
    /// The number of steps between keyframes, if the format has all of them.
    keyframe_interval: Option<u64>,
    /// True if keyframes are recorded; `None` before the first state that should have one.
    has_keyframes: Option<bool>,
    /// The first step without a keyframe although other steps have theirs.
    missing_keyframe: Option<u64>,
}

/// The damage of a recording whose settings, scene, events and digests do not give the identity in its end record.
pub const IDENTITY_MISMATCH: &str = "the recording does not match its identity";

/// The step of the next message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ExpectedStep {
    /// Exactly this step.
    Exactly(u64),
    /// This step or a later one, because data was lost.
    AtLeast(u64),
}

/// The part of the file that was read before the current position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Position {
    /// Everything, apart from declared gaps.
    Complete,
    /// Something is lost directly before the next item.
    Lost,
    /// Something is lost further back.
    Resumed,
    /// Reading has begun somewhere in the file, and nothing was read yet.
    Unknown,
}

impl SequenceValidator {
    /// Creates a validator at the start of a recording. Without the scene the identity is not checked.
    pub fn new(header: &Header) -> SequenceValidator {
        SequenceValidator {
            planned: header.steps,
            every: header.every,
            has_scene: header.scene.is_some(),
            estimates_accuracy: header.estimates_accuracy,
            last_step: None,
            expected: ExpectedStep::Exactly(0),
            table: Some(BodyTable::default()),
            identity: IdentityChain::new(header),
            state_bounds: header.has_state_bounds().then(StateBounds::default),
            next_id: 0,
            events: 0,
            digest: StateDigest::default(),
            position: Position::Complete,
            declared_gaps: header.gaps.clone(),
            gaps: header.gaps.iter().copied().collect(),
            found_gaps: Vec::new(),
            open_gap: None,
            has_scene_updates: None,
            keyframe_interval: (header.versions.format >= FIRST_FORMAT_WITH_ALL_KEYFRAMES)
                .then(|| header.steps_per_second()),
            has_keyframes: None,
            missing_keyframe: None,
        }
    }

    /// The step of the last state.
    pub fn last_step(&self) -> Option<u64> {
        self.last_step
    }

    /// The step of the last state that can be used: after a loss there is none before the next keyframe.
    pub fn last_usable_step(&self) -> Option<u64> {
        self.open_gap.unwrap_or(self.last_step)
    }

    /// The gap that reaches beyond the last item, up to the step that should have the next keyframe.
    pub fn open_gap(&self) -> Option<Gap> {
        let after = self.open_gap?;
        let (ExpectedStep::Exactly(next) | ExpectedStep::AtLeast(next)) = self.expected;
        let keyframe = self.keyframe_interval.and_then(|interval| next.checked_next_multiple_of(interval));
        let before = keyframe.unwrap_or(next).min(self.planned.saturating_add(1));
        Some(Gap { after, before }).filter(|gap| gap.missing_states() > 0)
    }

    /// The living bodies, if known.
    pub fn table(&self) -> Option<&BodyTable> {
        self.table.as_ref()
    }

    /// The gaps found so far, in ascending order.
    pub fn found_gaps(&self) -> &[Gap] {
        &self.found_gaps
    }

    /// Returns true if everything up to the current position was read, apart from declared gaps.
    pub fn is_complete(&self) -> bool {
        self.position == Position::Complete
    }

    /// Resets the step and the living bodies to unknown, before reading at another place.
    pub fn reset(&mut self) {
        self.mark_lost();
        self.position = Position::Unknown;
        self.last_step = None;
        self.expected = ExpectedStep::AtLeast(0);
        self.gaps = self.declared_gaps.iter().copied().collect();
        self.found_gaps.clear();
        self.open_gap = None;
        self.has_scene_updates = None;
    }

    /// Accepts that data was lost here.
    pub fn mark_lost(&mut self) {
        self.expected = match self.expected {
            ExpectedStep::Exactly(step) | ExpectedStep::AtLeast(step) => ExpectedStep::AtLeast(step),
        };
        self.position = match self.position {
            Position::Unknown => Position::Unknown,
            Position::Complete | Position::Lost | Position::Resumed => {
                self.open_gap.get_or_insert(self.last_step);
                Position::Lost
            }
        };
        self.table = None;
        self.state_bounds = None;
    }

    /// Crosses and returns the next declared gap if an item of step `step` is the first one after it.
    pub fn cross_gap(&mut self, step: u64) -> Option<Gap> {
        let is_lost = matches!(self.expected, ExpectedStep::AtLeast(_));
        if is_lost {
            while self.gaps.front().is_some_and(|gap| gap.before < step) {
                self.gaps.pop_front();
            }
        }
        let gap = *self.gaps.front()?;
        let (ExpectedStep::Exactly(expected) | ExpectedStep::AtLeast(expected)) = self.expected;
        if step < expected || gap.before != step || gap.after != self.last_step && !is_lost {
            return None;
        }
        self.gaps.pop_front();
        self.expected = ExpectedStep::AtLeast(step);
        self.table = None;
        match self.position {
            Position::Unknown | Position::Lost => None, // Noted with the next keyframe, if anything was read before.
            Position::Complete | Position::Resumed => {
                self.open_gap.get_or_insert(gap.after);
                Some(gap)
            }
        }
    }

    fn note_gap(&mut self, gap: Gap) {
        let is_full = self.found_gaps.len() == limits::GAPS;
        match self.found_gaps.last_mut() {
            Some(last) if is_full => last.before = gap.before,
            Some(_) | None => self.found_gaps.push(gap),
        }
    }

    /// Returns a description of the missing states if the step of the next message, `kind`, is later than expected.
    pub fn missing_before(&self, step: u64, kind: &str) -> Option<String> {
        match self.expected {
            ExpectedStep::Exactly(expected) if step > expected && step <= limits::STEPS => {
                Some(format!("{kind} has step {step}, but step {expected} is expected"))
            }
            ExpectedStep::Exactly(_) | ExpectedStep::AtLeast(_) => None,
        }
    }

    /// Returns a description of the problem if the step of the next message, `kind`, is beyond the plan and does not
    /// follow at once. Such a message is skipped: if it were accepted, all later ones would precede it.
    pub fn skipped_beyond_plan(&self, step: u64, kind: &str) -> Option<String> {
        let is_plan_exceeded = self.last_step.is_some_and(|last| last > self.planned);
        let is_next = match self.expected {
            ExpectedStep::Exactly(expected) | ExpectedStep::AtLeast(expected) => step == expected,
        };
        (step > self.planned && !is_plan_exceeded && !is_next)
            .then(|| format!("{kind} has step {step}, but the metadata plan {}", counted(self.planned, "step")))
    }

    /// Adds an event, encoded as `message`.
    ///
    /// # Errors
    /// Returns a description of the contradiction if the event is not possible here.
    pub fn add_event(&mut self, event: &RecordedEvent, message: &[u8]) -> Result<(), String> {
        self.check_step(event.step, "an event")?;
        let next_id = match &event.change {
            Change::Spawn(info) => {
                let id = info.id;
                id.checked_add(1).ok_or_else(|| format!("a body is spawned with id {id}, the greatest number"))?
            }
            Change::Delete { .. } => self.next_id,
        };
        if let Some(table) = &mut self.table {
            check_change(table, self.next_id, &event.change)?;
            table.apply(&event.change);
        }
        self.next_id = next_id;
        self.events += 1;
        self.identity.event(message);
        Ok(())
    }

    /// Adds a keyframe, after which the living bodies are known.
    ///
    /// # Errors
    /// Returns a description of the contradiction if the keyframe does not match the events.
    pub fn add_keyframe(&mut self, keyframe: &Keyframe) -> Result<(), String> {
        self.check_step(keyframe.step, "a keyframe")?;
        let Keyframe { step, next_id, .. } = *keyframe;
        let table = keyframe.table();
        if let Some(known) = &self.table {
            let bodies = known.bodies().iter().zip(table.bodies());
            let differences = bodies.filter_map(|(known, found)| Some((known, found.difference(known)?)));
            if let Some((known, (field, [found, expected]))) = { differences }.next() {
                let name = &known.spawn.name;
                return Err(format!(
                    "the keyframe of step {step} has {field} {found} of body {name:?}, the events {expected}"
                ));
            }
            let [found, expected] = [&table, known].map(|table| table.bodies().len());
            if found != expected {
                let [found, expected] = [found, expected].map(|count| counted(count, "body"));
                return Err(format!("the keyframe of step {step} has {found}, the events {expected}"));
            }
            if next_id != self.next_id {
                return Err(format!("the keyframe of step {step} has next_id {next_id}, the events {}", self.next_id));
            }
        }
        self.table = Some(table);
        self.next_id = next_id;
        if let Some(after) = self.open_gap.take() {
            self.note_gap(Gap { after, before: step });
        }
        Ok(())
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
        self.identity.state(state.step, state.digest);
        self.include_in_bounds(state);
        Ok(suspicion)
    }

    /// Returns a description of the first body whose values in a keyframe differ from those in the state of its step. A
    /// state that does not list its bodies is compared by its digest.
    pub fn compare_keyframe(&mut self, keyframe: &Keyframe, state: &RecordedState) -> Option<String> {
        let step = keyframe.step;
        let table = keyframe.table();
        self.digest.clear();
        let mut first = None;
        for (body, (info, recorded)) in keyframe.bodies.iter().zip(table.join_state(state)) {
            let values = [body.position.x, body.position.y, body.velocity.x, body.velocity.y];
            self.digest.add(info.id, values);
            let recorded = recorded.unwrap_or_else(|| info.initial_state());
            let pairs = ["x", "y", "vx", "vy"].into_iter().zip(values.into_iter().zip(recorded));
            for (field, (value, recorded)) in pairs.filter(|(_, (a, b))| a.to_bits() != b.to_bits()) {
                first.get_or_insert_with(|| {
                    let name = &info.spawn.name;
                    format!(
                        "the keyframe of step {step} has {field} {value:?} of body {name:?}, the state {recorded:?}"
                    )
                });
            }
        }
        if self.digest.value() == state.digest {
            None
        } else {
            first
                .filter(|_| self.is_full(step))
                .or_else(|| Some(format!("the keyframe of step {step} does not match the digest of the state")))
        }
    }

    /// Returns a description of the problem if the presence of a scene update differs from that of the states before.
    pub fn check_presence(&mut self, has_scene_update: bool, state: &RecordedState) -> Option<String> {
        /// Bodies above which a scene update may be too large to be recorded.
        const MANY: usize = limits::MESSAGE_BYTES / 256;
        let step = state.step;
        if !self.is_full(step) {
            return has_scene_update.then(|| format!("state {step} is recorded as a digest, but has a scene update"));
        }
        if self.table.as_ref().is_none_or(|table| table.bodies().len() > MANY) {
            return None;
        }
        match (*self.has_scene_updates.get_or_insert(has_scene_update), has_scene_update) {
            (true, false) => Some(format!("the scene update of state {step} is missing")),
            (false, true) => Some(format!("the scene updates before state {step} are missing")),
            (true, true) | (false, false) => None,
        }
    }

    /// Returns a description of the problem if this is the first state after the planned end.
    pub fn check_plan(&self, state: &RecordedState) -> Option<String> {
        let RecordedState { step, .. } = state;
        (*step == self.planned + 1)
            .then(|| format!("there is a state {step}, but the metadata plan {}", counted(self.planned, "step")))
    }

    /// Notes if the state of a step comes with a keyframe. If it should, but only other states do, the end record
    /// of a recording that was not recovered does not match.
    pub fn note_keyframe(&mut self, step: u64, has_keyframe: bool) {
        if self.keyframe_interval.is_some_and(|interval| step.is_multiple_of(interval))
            && *self.has_keyframes.get_or_insert(has_keyframe) != has_keyframe
        {
            self.missing_keyframe.get_or_insert(if has_keyframe { 0 } else { step });
        }
    }

    /// Returns true if nothing was lost, but no state has the keyframe that it should have.
    pub fn lacks_keyframes(&self) -> bool {
        // If only the keyframe at the start is missing, the topic itself is there.
        self.is_complete() && self.has_keyframes == Some(false) && self.missing_keyframe.is_none()
    }

    /// Checks the end record against the items before it.
    ///
    /// # Errors
    /// Returns a description of the contradiction if they do not match.
    pub fn check_trailer(&self, trailer: &Trailer) -> Result<(), String> {
        // Only a recovery may have lost these.
        if trailer.collisions.is_none() && !trailer.recovered {
            return Err("the end record has no number of collisions".into());
        }
        match (self.estimates_accuracy, trailer.accuracy) {
            (true, None) if !trailer.recovered => return Err("the end record has no accuracy".into()),
            (false, Some(_)) => return Err("the end record has an accuracy, but the metadata announce none".into()),
            (true | false, _) => {}
        }
        if trailer.steps > self.planned {
            let (taken, planned) = (counted(trailer.steps, "step"), counted(self.planned, "step"));
            return Err(format!("the end record declares {taken}, but the metadata plan {planned}"));
        }
        if !self.is_complete() {
            return Ok(());
        }
        if let Some(step) = self.missing_keyframe.filter(|_| !trailer.recovered) {
            return Err(format!("the keyframe of step {step} is missing"));
        }
        let last_step = self.last_step.unwrap_or(0);
        if !self.has_scene && !trailer.recovered && trailer.steps > last_step {
            return Ok(()); // The missing states are reported by the health.
        }
        let counts = [
            ("step", trailer.steps, last_step),
            ("event", trailer.events, self.events),
            ("body", trailer.bodies, self.next_id.into()),
        ];
        if let Some((noun, declared, found)) = counts.into_iter().find(|(_, declared, found)| declared != found) {
            return Err(format!(
                "the end record declares {}, but the recording has {}",
                counted(declared, noun),
                counted(found, noun),
            ));
        }
        if let Some(gap) = self.gaps.front() {
            return Err(format!("the metadata declares the gap {gap}, but nothing is missing there"));
        }
        self.check_bounds(trailer)?;
        let is_identity_known = self.has_scene || trailer.recovered;
        if !is_identity_known || self.identity.identity() == trailer.identity {
            Ok(())
        } else {
            Err(IDENTITY_MISMATCH.into())
        }
    }

    fn check_bounds(&self, trailer: &Trailer) -> Result<(), String> {
        let found = self.state_bounds.filter(|bounds| bounds.top_speed.is_finite());
        let numbers = |bounds: &StateBounds| {
            let corners = bounds.bounds.map(|bounds| [bounds.near.x, bounds.near.y, bounds.far.x, bounds.far.y]);
            (bounds.top_speed.to_bits(), corners.map(|corners| corners.map(f64::to_bits)))
        };
        match (&trailer.state_bounds, &found) {
            (Some(declared), Some(found)) if numbers(declared) != numbers(found) => {
                if declared.top_speed.to_bits() == found.top_speed.to_bits() {
                    Err("the end record declares other bounds (reach) than the states have".into())
                } else {
                    Err(format!(
                        "the end record declares a top speed of {:?} m/s, but the states have {:?} m/s",
                        declared.top_speed, found.top_speed
                    ))
                }
            }
            (None, Some(_)) => Err("the end record has no top speed".into()),
            (Some(_), None) if self.state_bounds.is_some() => {
                Err("the end record declares a top speed, but that of the states is not finite".into())
            }
            (Some(_), Some(_) | None) | (None, None) => Ok(()),
        }
    }

    fn include_in_bounds(&mut self, state: &RecordedState) {
        if let (Some(bounds), Some(table)) = (&mut self.state_bounds, &self.table)
            && state.step.is_multiple_of(self.every)
        {
            bounds.include_state(table, state);
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
                self.resume();
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

    /// Notes that an item was read.
    fn resume(&mut self) {
        self.position = match self.position {
            Position::Complete => Position::Complete,
            Position::Unknown | Position::Lost | Position::Resumed => Position::Resumed,
        };
    }

    fn check_shape(&self, state: &RecordedState) -> Result<(), String> {
        let RecordedState { step, id, .. } = state;
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
        let matches = if self.is_full(*step) {
            omitted.all(|(info, _)| info.spawn.mass.is_infinite()) && listed == id.len()
        } else {
            id.is_empty()
        };
        if matches { Ok(()) } else { Err(format!("the ids in state {step} do not match the events")) }
    }
}

/// The first format version in which large keyframes are not left out.
const FIRST_FORMAT_WITH_ALL_KEYFRAMES: u32 = 3;

fn check_change(table: &BodyTable, next_id: u32, change: &Change) -> Result<(), String> {
    match change {
        Change::Spawn(info) if info.id != next_id => {
            Err(format!("a body is spawned with id {}, but id {next_id} is expected", info.id))
        }
        Change::Spawn(_) if table.bodies().len() >= limits::BODIES => Err("too many bodies are alive".into()),
        Change::Delete { id } if table.body(*id).is_none() => Err(format!("body {id} is deleted, but is not alive")),
        Change::Spawn(_) | Change::Delete { .. } => Ok(()),
    }
}
