use std::io::Write;

use crate::physics::BodyId;

use super::{
    BodyTable, Change, End, Error, Extremes, Header, Keyframe, Outcome, RecordedEvent, RecordedState, StateDigest,
    batch::{Batch, Entry, Row},
    cdr, clock,
    container::Container,
    identity::IdentityChain,
    limits,
    messages::{BodiesMessage, EventMessage},
    metadata,
    topic::Topic,
    view::{self, Paint},
};

/// Makes batches into messages and writes them: the half of a writer that need not run on
/// the stepping thread.
pub struct Recorder<W: Write> {
    header: Header,
    container: Container<W>,
    identity: IdentityChain,
    table: BodyTable,
    steps: u64,
    next_id: BodyId,
    events: u64,
    unflushed_events: bool,
    state: RecordedState,
    digest: StateDigest,
    /// Of the states so far, where the end tells them.
    extremes: Option<Extremes>,
    /// The colours for viewers, if boxes are recorded for them.
    paint: Option<Paint>,
    bytes: Vec<u8>,
}

/// The first format whose end tells the extremes.
const EXTREMES_SINCE: u32 = 2;

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
            next_id: 0,
            events: 0,
            unflushed_events: false,
            state: RecordedState::default(),
            digest: StateDigest::default(),
            extremes: (header.gaps.is_empty() && header.versions.format >= EXTREMES_SINCE).then(Extremes::default),
            paint: None,
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
                Entry::Paint(paint) => self.paint = Some(paint),
                Entry::Event(event) => self.event(&event)?,
                Entry::Snapshot(snapshot) => self.keyframe(&Keyframe::new(snapshot, &self.table))?,
                Entry::State { step, rows: count } => {
                    let (own, rest) = rows.split_at(count);
                    rows = rest;
                    self.rows(step, own)?;
                }
            }
        }
        Ok(())
    }

    /// Writes the end of the recording and its index.
    ///
    /// # Errors
    /// If writing fails; the file is then readable up to its last flush.
    pub fn finish(self, outcome: Outcome, recovered: bool) -> Result<(End, W), Error> {
        let end = End {
            steps: self.steps,
            collisions: outcome.collisions,
            bodies: self.next_id.into(),
            events: self.events,
            error: outcome.error,
            recovered,
            extremes: self.extremes,
            identity: self.identity.identity(),
        };
        let write = self.container.finish(metadata::of_end(&self.header, &end))?;
        Ok((end, write))
    }

    /// Writes an event.
    ///
    /// # Errors
    /// If writing fails.
    pub fn event(&mut self, event: &RecordedEvent) -> Result<(), Error> {
        self.table.apply(&event.change);
        self.events += 1;
        self.unflushed_events = true;
        if let Change::Spawn { id, .. } = event.change {
            self.next_id = id + 1;
        }
        cdr::encode(&EventMessage::new(event), &mut self.bytes);
        self.identity.event(&self.bytes);
        self.put(Topic::Events, event.step)
    }

    /// Writes a keyframe. One too large for a record is left out: a seek then starts before
    /// it.
    ///
    /// # Errors
    /// If writing fails.
    pub fn keyframe(&mut self, keyframe: &Keyframe) -> Result<(), Error> {
        self.next_id = keyframe.next_id;
        cdr::encode(&BodiesMessage::new(keyframe, self.header.versions.format), &mut self.bytes);
        match self.bytes.len() <= limits::KEYFRAME_BYTES {
            true => self.put(Topic::Bodies, keyframe.step),
            false => Ok(()),
        }
    }

    /// Writes a state, and hands everything down at the end of a second and after events.
    ///
    /// # Errors
    /// If writing fails.
    pub fn state(&mut self, state: &RecordedState) -> Result<(), Error> {
        self.steps = state.step;
        self.identity.state(state.step, state.digest);
        self.see(state);
        state.encode(&mut self.bytes);
        self.put(Topic::States, state.step)?;
        if self.unflushed_events || clock::ends_second(state.step, self.header.settings.rate) {
            self.unflushed_events = false;
            self.container.flush()?;
        }
        Ok(())
    }

    /// Writes what viewers draw, encoded as `message`, at a time in simulated nanoseconds. One
    /// too large for a record is left out.
    ///
    /// # Errors
    /// If writing fails.
    pub fn view(&mut self, time: u64, message: &[u8]) -> Result<(), Error> {
        match message.len() <= limits::MESSAGE_BYTES {
            true => self.container.message(Topic::Scene, time, message),
            false => Ok(()),
        }
    }

    fn see(&mut self, state: &RecordedState) {
        if let Some(extremes) = &mut self.extremes
            && state.step.is_multiple_of(self.header.every)
        {
            for (known, moved) in self.table.with_state(state) {
                extremes.see(known, moved.unwrap_or_else(|| known.first_numbers()));
            }
        }
    }

    fn boxes(&mut self, step: u64, rows: &[Row]) -> Result<(), Error> {
        let Some(paint) = self.paint.filter(|_| step.is_multiple_of(self.header.every)) else { return Ok(()) };
        let time = clock::nanoseconds(step, self.header.settings.rate);
        let mut message = std::mem::take(&mut self.bytes);
        let bodies = self.table.bodies().iter().zip(rows).map(|(known, row)| (known, row.numbers));
        view::encode(time, bodies, paint, &mut message);
        let written = self.view(time, &message);
        self.bytes = message;
        written
    }

    fn rows(&mut self, step: u64, rows: &[Row]) -> Result<(), Error> {
        if rows.len() != self.table.bodies().len() {
            return Err(Error::Unrecorded { step });
        }
        self.boxes(step, rows)?;
        let mut state = std::mem::take(&mut self.state);
        self.sample(step, rows, &mut state);
        let written = self.state(&state);
        self.state = state;
        written
    }

    fn sample(&mut self, step: u64, rows: &[Row], state: &mut RecordedState) {
        let full = step.is_multiple_of(self.header.every);
        state.clear();
        self.digest.clear();
        for (row, known) in rows.iter().zip(self.table.bodies()) {
            self.digest.body(row.id, row.numbers);
            if full && !(row.infinite && known.stands_at(row.numbers)) {
                state.push(row.id, row.numbers);
            }
        }
        state.step = step;
        state.digest = self.digest.value();
    }

    fn put(&mut self, topic: Topic, step: u64) -> Result<(), Error> {
        self.container.message(topic, clock::nanoseconds(step, self.header.settings.rate), &self.bytes)
    }
}
