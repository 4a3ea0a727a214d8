use std::io::Write;

use crate::physics::Snapshot;

use super::{
    BodyTable, Change, End, Error, Header, Keyframe, Outcome, RecordedEvent, RecordedState, StateDigest,
    batch::{Batch, Entry, Row},
    cdr, clock,
    container::Container,
    identity::IdentityChain,
    limits,
    messages::{BodiesMessage, EventMessage},
    metadata,
    topic::Topic,
};

/// Makes batches into messages and writes them: the half of a writer that need not run on
/// the stepping thread.
pub struct Recorder<W: Write> {
    header: Header,
    container: Container<W>,
    identity: IdentityChain,
    table: BodyTable,
    steps: u64,
    spawns: u64,
    events: u64,
    state: RecordedState,
    digest: StateDigest,
    bytes: Vec<u8>,
}

impl<W: Write> Recorder<W> {
    /// Writes the head of a recording.
    ///
    /// # Errors
    /// If writing fails.
    pub fn new(write: W, header: &Header) -> Result<Recorder<W>, Error> {
        Ok(Recorder {
            header: header.clone(),
            container: Container::new(write, metadata::of_header(header), &header.scene)?,
            identity: IdentityChain::new(header),
            table: BodyTable::default(),
            steps: 0,
            spawns: 0,
            events: 0,
            state: RecordedState::default(),
            digest: StateDigest::default(),
            bytes: Vec::new(),
        })
    }

    /// Writes what is in a batch.
    ///
    /// # Errors
    /// If writing fails, or the world has bodies whose spawn is not in the batches.
    pub fn write(&mut self, batch: &mut Batch) -> Result<(), Error> {
        let mut rows = batch.rows.as_slice();
        for entry in batch.entries.drain(..) {
            match entry {
                Entry::Event(event) => self.event(&event)?,
                Entry::Snapshot(snapshot) => self.keyframe(snapshot)?,
                Entry::State { step, rows: count } => {
                    let (own, rest) = rows.split_at(count);
                    rows = rest;
                    self.state(step, own)?;
                }
                Entry::Flush => self.container.flush()?,
            }
        }
        Ok(())
    }

    /// Writes the end of the recording and its index.
    ///
    /// # Errors
    /// If writing fails; the file is then readable up to its last flush.
    pub fn finish(self, outcome: &Outcome) -> Result<(End, W), Error> {
        let end = End {
            steps: self.steps,
            collisions: outcome.collisions,
            bodies: self.spawns,
            events: self.events,
            error: outcome.error.clone(),
            identity: self.identity.identity(),
        };
        let write = self.container.finish(metadata::of_end(&self.header, &end))?;
        Ok((end, write))
    }

    fn event(&mut self, event: &RecordedEvent) -> Result<(), Error> {
        self.table.apply(&event.change);
        self.events += 1;
        self.spawns += u64::from(matches!(event.change, Change::Spawn { .. }));
        cdr::encode(&EventMessage::new(event), &mut self.bytes);
        self.identity.event(&self.bytes);
        self.put(Topic::Events, event.step)
    }

    /// A keyframe too large for one record is left out: a seek then starts before it.
    fn keyframe(&mut self, snapshot: Snapshot) -> Result<(), Error> {
        let step = snapshot.step;
        let keyframe = Keyframe::new(snapshot, &self.table);
        cdr::encode(&BodiesMessage::new(&keyframe), &mut self.bytes);
        match self.bytes.len() <= limits::MESSAGE_BYTES {
            true => self.put(Topic::Bodies, step),
            false => Ok(()),
        }
    }

    fn state(&mut self, step: u64, rows: &[Row]) -> Result<(), Error> {
        if rows.len() != self.table.bodies().len() {
            return Err(Error::Unrecorded { step });
        }
        self.steps = step;
        self.sample(step, rows);
        self.identity.state(step, self.state.digest);
        self.state.encode(&mut self.bytes);
        self.put(Topic::States, step)
    }

    fn sample(&mut self, step: u64, rows: &[Row]) {
        let full = step.is_multiple_of(self.header.every);
        self.state.clear();
        self.digest.clear();
        for (row, known) in rows.iter().zip(self.table.bodies()) {
            self.digest.body(row.id, row.numbers);
            if full && !(row.infinite && known.stands_at(row.numbers)) {
                self.state.push(row.id, row.numbers);
            }
        }
        self.state.step = step;
        self.state.digest = self.digest.value();
    }

    fn put(&mut self, topic: Topic, step: u64) -> Result<(), Error> {
        self.container.message(topic, clock::nanoseconds(step, self.header.settings.rate), &self.bytes)
    }
}
