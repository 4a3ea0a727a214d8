use crate::physics::{Body, BodyId, Engine, Snapshot};

use super::{RecordedEvent, limits, view::Paint};

/// What the stepping thread hands over in one go, in the order in which it happened.
///
/// It is all copied out of the world at once, so that encoding, digesting and compressing
/// cost the stepping thread nothing.
#[derive(Debug, Default)]
pub struct Batch {
    /// What happened.
    pub entries: Vec<Entry>,
    /// The rows of all states in it, one after the other.
    pub rows: Vec<Row>,
}

/// One thing to be recorded.
#[derive(Debug)]
pub enum Entry {
    /// From now on viewers are to see boxes in these colours.
    Paint(Paint),
    /// An event.
    Event(RecordedEvent),
    /// Everything about a step, for a keyframe.
    Snapshot(Snapshot),
    /// A state.
    State {
        /// Its number.
        step: u64,
        /// How many of the rows not yet used are its own.
        rows: usize,
    },
}

/// A body as a state sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Which body.
    pub id: BodyId,
    /// x, y (m), vx, vy (m/s).
    pub numbers: [f64; 4],
    /// Whether it has infinite mass.
    pub infinite: bool,
}

/// Bytes of a row in the file; its size in memory is not the same on every machine.
const RECORDED_BYTES: usize = 36;

impl Batch {
    /// Adds the state of the engine's present step.
    pub fn push_state(&mut self, engine: &Engine) {
        let bodies = &engine.world().bodies;
        self.entries.push(Entry::State { step: engine.present_step(), rows: bodies.len() });
        self.rows.extend(bodies.iter().map(Row::new));
    }

    /// Whether it is worth handing over: as much as keeps the other thread busy for longer
    /// than waking it takes.
    pub fn is_large(&self) -> bool {
        self.rows.len() * RECORDED_BYTES > limits::CHUNK_BYTES / 16
    }

    /// Takes everything out, keeping the memory.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.rows.clear();
    }
}

impl Row {
    fn new(body: &Body) -> Row {
        Row { id: body.id, numbers: numbers(body), infinite: body.is_infinite() }
    }
}

/// What a state says of a body: x, y (m), vx, vy (m/s).
pub fn numbers(body: &Body) -> [f64; 4] {
    let (position, velocity) = (body.rect.origin, body.velocity);
    [position.x, position.y, velocity.x, velocity.y]
}
