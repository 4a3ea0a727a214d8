use std::mem;

use crate::physics::{CollisionCount, Engine, EngineConfig};

use super::{Header, Item, Keyframe, RecordedEvent, RecordedState, SEMANTICS_VERSION, StateDigest, state::body_state};

/// Computes altered states again, from the keyframe and the events before them.
pub struct Restorer {
    config: EngineConfig,
    start: Start,
    /// The events since the start that the engine has not applied.
    events: Vec<RecordedEvent>,
    /// The number of states that were computed again.
    pub restored: u64,
}

/// The state from which others can be computed.
enum Start {
    /// The start of the run.
    Beginning,
    Keyframe(Keyframe),
    /// The engine after the last state that was restored.
    Running(Box<Engine>),
    /// No state is known until the next keyframe.
    Lost,
    /// No state can be computed, because the recording was made with other engine semantics.
    OtherSemantics,
}

/// The largest number of events between a keyframe and the state to be restored, which are kept in memory.
const MAX_EVENTS: usize = 4096;

impl Restorer {
    /// Creates a restorer at the start of a recording.
    pub fn new(header: &Header) -> Restorer {
        let is_same = header.versions.semantics == SEMANTICS_VERSION;
        let start = if is_same { Start::Beginning } else { Start::OtherSemantics };
        Restorer { config: header.config.clone(), start, events: Vec::new(), restored: 0 }
    }

    /// Follows the recording by one item, and returns it. An altered state that can be computed again becomes a state.
    pub fn follow(&mut self, item: Item) -> Item {
        match (&item, &self.start) {
            (_, Start::OtherSemantics) => {}
            (Item::Keyframe(keyframe), _) => {
                self.events.clear();
                self.start = Start::Keyframe(keyframe.clone());
            }
            (Item::Event(event), Start::Beginning | Start::Keyframe(_) | Start::Running(_)) => {
                if self.events.len() < MAX_EVENTS {
                    self.events.push(event.clone());
                } else {
                    self.mark_lost();
                }
            }
            (Item::SuspectState(state), _) => {
                if let Some(state) = self.restore(state) {
                    self.restored += 1;
                    return Item::State(state);
                }
            }
            (Item::Event(_), Start::Lost) | (Item::State(_) | Item::SceneUpdate { .. }, _) => {}
            (Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_), _) => {}
        }
        item
    }

    /// Notes that events may be missing until the next keyframe.
    pub fn mark_lost(&mut self) {
        self.events.clear();
        if !matches!(self.start, Start::OtherSemantics) {
            self.start = Start::Lost;
        }
    }

    /// Computes an altered state again. Returns `None` if that is impossible, or if the result has neither the digest
    /// nor the values of the recorded state, so that nothing confirms it.
    fn restore(&mut self, state: &RecordedState) -> Option<RecordedState> {
        let engine = self.engine_at(state.step)?;
        let restored = state_of(&engine, state);
        self.start = Start::Running(engine);
        restored
    }

    /// Takes the engine, at a step.
    fn engine_at(&mut self, step: u64) -> Option<Box<Engine>> {
        let mut engine = match mem::replace(&mut self.start, Start::Lost) {
            Start::Beginning => Box::new(Engine::new(self.config.clone())),
            Start::Keyframe(keyframe) => {
                Box::new(Engine::restore(self.config.clone(), keyframe.snapshot(&self.config)).ok()?)
            }
            Start::Running(engine) => engine,
            start @ (Start::Lost | Start::OtherSemantics) => {
                self.start = start;
                return None;
            }
        };
        for event in mem::take(&mut self.events) {
            run_to(&mut engine, event.step)?;
            engine.apply(&event.change.event());
        }
        run_to(&mut engine, step)?;
        Some(engine)
    }
}

/// Returns `None` if the engine fails before the step.
fn run_to(engine: &mut Engine, step: u64) -> Option<()> {
    while engine.current_step() < step {
        engine.step(&mut CollisionCount::default()).ok()?;
    }
    Some(())
}

/// Returns the state of the engine with the bodies that `recorded` lists, if it has the same digest or the same values.
fn state_of(engine: &Engine, recorded: &RecordedState) -> Option<RecordedState> {
    let mut digest = StateDigest::default();
    for body in &engine.world().bodies {
        digest.add(body.id, body_state(body));
    }
    let mut state = RecordedState { step: recorded.step, digest: digest.value(), ..RecordedState::default() };
    let mut has_same_values = true;
    for (index, id) in recorded.id.iter().enumerate() {
        let values = body_state(engine.world().body(*id)?);
        has_same_values &= values.map(f64::to_bits) == recorded.body_state(index).map(f64::to_bits);
        state.push(*id, values);
    }
    (state.digest == recorded.digest || has_same_values).then_some(state)
}
