use crate::physics::{Body, BodyId, Engine, Snapshot};

use super::{RecordedEvent, limits, scene_update::ColorFn};

/// A batch of entries that the stepping thread hands to the writer thread, in chronological order.
///
/// The data is copied out of the world, so that encoding, digesting and compressing cost the
/// stepping thread nothing.
#[derive(Debug, Default)]
pub struct Batch {
    /// The entries.
    pub entries: Vec<Entry>,
    /// The rows of all states of the batch, concatenated.
    pub rows: Vec<Row>,
}

/// One thing to record.
#[derive(Debug)]
pub enum Entry {
    /// Record scene updates for viewers from now on, in these colours.
    Colors(ColorFn),
    /// An event.
    Event(RecordedEvent),
    /// The snapshot of a step, for a keyframe.
    Snapshot(Snapshot),
    /// A state.
    State {
        /// The step.
        step: u64,
        /// The number of its rows, which are the next unused ones of the batch.
        rows: usize,
    },
}

/// One body in a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The body.
    pub id: BodyId,
    /// x, y (m), vx, vy (m/s).
    pub state: [f64; 4],
    /// True if the body has infinite mass.
    pub is_static: bool,
}

/// Bytes of a row in the file. (The size in memory differs between machines.)
const RECORDED_BYTES: usize = 36;

impl Batch {
    /// Adds the state of the engine's current step.
    pub fn push_state(&mut self, engine: &Engine) {
        let bodies = &engine.world().bodies;
        self.entries.push(Entry::State { step: engine.current_step(), rows: bodies.len() });
        self.rows.extend(bodies.iter().map(Row::new));
    }

    /// Returns true if the batch is large enough to hand over: it keeps the writer thread busy for
    /// longer than waking the thread takes.
    pub fn is_large(&self) -> bool {
        self.rows.len() * RECORDED_BYTES > limits::CHUNK_BYTES / 16
    }

    /// Removes all entries and keeps the allocated memory.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.rows.clear();
    }
}

impl Row {
    fn new(body: &Body) -> Row {
        Row { id: body.id, state: body_state(body), is_static: body.is_infinite() }
    }
}

/// Returns x, y (m), vx, vy (m/s) of a body.
pub fn body_state(body: &Body) -> [f64; 4] {
    let (position, velocity) = (body.rect.origin, body.velocity);
    [position.x, position.y, velocity.x, velocity.y]
}
